"""A vector: a program, and what the paper says about its scenes or simulations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from .implementations.protocol import Implementation, Task
from .verdict import VectorVerdict


class Matcher(Protocol):
    """A claim about the scenes or simulations of a program; `conformance.matchers` holds the closed table of
    them.
    """

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Whether the implementation agrees. What it raises besides `Refused` and `NeverAccepted` goes through."""
        ...


@dataclass(frozen=True, slots=True)
class ConformanceVector:
    """One vector, with the chapter and the file it stands in.

    `fires` must fire and `avoids` must not, where the implementation reports which rules fire. `texts` maps each dialect in which
    the program is given to its text. `steps` is the number of time steps that simulations may have, None where the vector is about scenes.
    `files` are the modules beside the program, by their paths.
    """

    name: str
    chapter: str
    file: str
    paper: str
    fires: frozenset[str]
    avoids: frozenset[str]
    readings: Mapping[str, str]
    texts: Mapping[str, str]
    kind: str
    matcher: Matcher
    steps: int | None = None
    files: Mapping[str, str] = field(default_factory=dict)

    def task(self, dialect: str) -> Task:
        """The program in that dialect. KeyError if it is not given in it."""
        return Task(self.texts[dialect], dialect, self.readings, files=self.files)
