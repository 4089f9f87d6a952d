"""What runs: objects, scenarios, and whose code it is; the ways in which control leaves a block."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Generator, Iterable, MutableMapping
from dataclasses import dataclass, field
from functools import cache
from types import CodeType
from typing import Any


class Discarded(Exception):
    """The simulation is rejected: what kind of condition failed."""


class GuardBroken(Exception):
    """A guard was violated: `args[0]` says which kind of exception that is."""


class Left(Exception):
    """A block is left by `terminate`, `abort`, `return`, `break` or `continue`."""


@dataclass(eq=False)
class WorldObject:
    """An object: its properties `x` and `behavior`, each with the values that overrides have laid above it, and whose these are."""

    place: int
    layers: dict[str, list[tuple[object, Any]]]

    @property
    def x(self) -> Any:
        """The value on top."""
        return self.layers["x"][-1][1]

    @x.setter
    def x(self, value: object) -> None:
        self.layers["x"][-1] = (self.layers["x"][-1][0], value)


@dataclass(eq=False)
class Whose:
    """Whose code it is: a behavior, a monitor, or a scenario in its setup or compose block; its variables and invariants."""

    kind: str
    names: MutableMapping[str, Any]
    scenario: RunningScenario | None = None
    invariants: tuple[str, ...] = ()


@dataclass(eq=False)
class RunningScenario:
    """A scenario that runs, with what it has declared."""

    names: MutableMapping[str, Any]
    top: bool = False
    conditions: dict[str, list[tuple[str, Whose]]] = field(default_factory=lambda: defaultdict(list))
    monitors: list[Steps] = field(default_factory=list)
    held: set[int] = field(default_factory=set)
    invariants: tuple[str, ...] = ()
    compose: Steps | None = None
    ran: bool = False
    over: bool = False


Steps = Generator[tuple[tuple[Any, ...], Whose | None], None, None]
"""What a behavior, monitor or compose block does, time step by time step: its actions, and whose own code waits (None: several, or scenarios)."""


@cache
def compiled(expression: str) -> CodeType:
    """An expression, ready to be evaluated."""
    return compile(expression, expression, "eval")


def close(given_up: Iterable[Steps]) -> None:
    """What was suspended will not go on: the scenarios that it was running end."""
    for steps in given_up:
        steps.close()
