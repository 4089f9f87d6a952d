"""Findings that have one cause are told once: by the smallest program that shows it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from .examination import OUR_FAULT, FuzzedProgram
from .shrinking import shrink_order

OUR_BUG = "our bug"
"""The class of what is a fault of this reference."""
OFTEN = 4
"""How many programs that differ in the same words are made small; those after them are counted only."""
ENDED = ("crashed", "timed out", "garbled")
"""What ends the other's process is a verdict of its own."""


@dataclass(slots=True)
class Cause:
    """The common cause of several findings: the smallest program of them, and the numbers of all."""

    smallest: FuzzedProgram
    numbers: list[int]

    @property
    def class_(self) -> str:
        """A known reading, a fault of ours, or what nobody has looked into."""
        return OUR_BUG if self.smallest.kind == OUR_FAULT else "reading" if self.smallest.reading else "undecided"


def causes_of(findings: Iterable[FuzzedProgram]) -> list[Cause]:
    """The causes, those that most programs show first.

    Two findings have one cause if they differ in the same words, and the rules and properties of one are among those of the other.
    """
    made_small = sorted((f for f in findings if f.confirmed), key=lambda f: (len(f.rules), shrink_order(f.minimal)))
    causes: list[Cause] = []
    for finding in made_small:
        same = next((cause for cause in causes if is_among(cause.smallest, finding)), None)
        if same is None:
            causes.append(Cause(finding, [finding.number]))
        else:
            same.numbers.append(finding.number)
    return sorted(causes, key=lambda cause: (-len(cause.numbers), cause.smallest.number))


def is_among(small: FuzzedProgram, large: FuzzedProgram) -> bool:
    """Whether the larger finding shows nothing that the smaller one does not."""
    alike = (small.kind, small.words) == (large.kind, large.words)
    return alike and set(small.rules) <= set(large.rules) and set(small.properties) <= set(large.properties)


def seen_often(examined: Iterable[FuzzedProgram]) -> frozenset[tuple[str, str]]:
    """The ways to differ of which enough programs were made small."""
    counts = Counter((e.kind, e.words) for e in examined if e.minimal or e.confirmed)
    return frozenset(way for way, count in counts.items() if count >= OFTEN)
