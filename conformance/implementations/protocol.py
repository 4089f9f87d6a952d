"""The interface between vectors and an implementation under test."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Protocol, runtime_checkable

SceneRecord = Mapping[str, object]
"""A scene in the JSON format of `docs/formats.md`, as decoded JSON."""
SimulationRecord = Mapping[str, object]
"""A simulation in the JSON format of `docs/formats.md`, as decoded JSON; of it `steps` (with `actions` and `objects`) and `result` are looked at."""


SEED = 20
"""The pinned seed, so that a green commit stays green."""


@dataclass(frozen=True, slots=True)
class Task:
    """A program text in a dialect, the readings under which it is to be run (all others are those of the paper), and the seed.

    `files` are Scenic modules in the folder of the program, in the same dialect: their texts by their paths, such as "lib/roads.scenic".
    Without `prune`, the attempts that scenes take are to be those of the program: none is spared.
    """

    program: str
    dialect: str
    readings: Mapping[str, str] = field(default_factory=dict)
    seed: int = SEED
    files: Mapping[str, str] = field(default_factory=dict)
    prune: bool = True


class Unsupported(Exception):
    """The implementation says that it cannot do this, and why: it is not asked for it."""


class Refused(Exception):
    """The program is an error: `phase` is parse, check, resolve or run; what the implementation does not report is None.

    `also` are phases that it does not tell from this one.
    """

    def __init__(
        self, phase: str | None, message: str, *, class_name: str | None = None, rule: str | None = None, line: int | None = None,
        also: frozenset[str] = frozenset(),
    ) -> None:  # fmt: skip
        super().__init__(message)
        self.phase = phase
        self.message = message
        self.class_name = class_name
        self.rule = rule
        self.line = line
        self.also = also

    @property
    def when(self) -> str:
        """A text that says that the program was refused, and in which phase."""
        return "refused" if self.phase is None else f"refused in phase {self.phase}"

    def may_be_in(self, phases: Sequence[str]) -> bool:
        """Whether the error may be one of these phases, by what is reported."""
        return self.phase is None or self.phase in phases or not self.also.isdisjoint(phases)


class NeverAccepted(Exception):
    """No run was accepted; `requirements` are the kinds of those that failed, None if the implementation does not report them."""

    def __init__(self, requirements: frozenset[str] | None = None) -> None:
        super().__init__("no run was accepted")
        self.requirements = requirements


class Implementation(Protocol):
    """An implementation of Scenic under test."""

    @property
    def name(self) -> str:
        """The name and version of the implementation."""
        ...

    @property
    def dialects(self) -> tuple[str, ...]:
        """The dialects that it reads, the preferred one first."""
        ...

    def follows(self, reading: str, alternative: str) -> bool:
        """Whether it can be made to follow that alternative of a reading."""
        ...

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        """`count` independent scenes. Raises `Refused` for a program in error, `NeverAccepted` after `attempts` attempts at one scene."""
        ...


@runtime_checkable
class CountingAttempts(Protocol):
    """An implementation whose scenes say how many attempts they took."""

    @property
    def counts_attempts(self) -> bool:
        """Whether its scenes have the number of attempts."""
        ...


@runtime_checkable
class Tracing(Protocol):
    """An implementation that reports which rules fire."""

    def fired(self, task: Task, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        """The ids of the rules that fired in a few runs, until all `wanted` ones were seen and one run was accepted."""
        ...


@dataclass(frozen=True, slots=True)
class Enumerated:
    """The exact distribution of a finite program: scenes, or simulations, with their probabilities given acceptance, which has its own."""

    outcomes: tuple[tuple[Fraction, SceneRecord], ...]
    acceptance: Fraction


@runtime_checkable
class Enumerating(Protocol):
    """An implementation that can enumerate finite programs."""

    def enumerated(self, task: Task) -> Enumerated | None:
        """The exact distribution, None if the program is not finite. Raises `Refused`."""
        ...


@runtime_checkable
class Measuring(Protocol):
    """An implementation that says how likely a run is."""

    def density(self, task: Task, draws: Sequence[object]) -> float:
        """The product of the probabilities, or densities, of what a run draws, in this order; points are pairs. Raises `Refused`."""
        ...


@runtime_checkable
class Simulating(Protocol):
    """An implementation that simulates in a world in which nothing moves, a time step takes one second, and any value is an action.

    A further argument `world` is a recorded world, in which objects are where it says (`docs/harness.md`); it can be left out of the method.
    """

    def simulations(self, task: Task, steps: int, count: int, *, seed: int, attempts: int) -> Iterator[SimulationRecord]:
        """`count` independent simulations of at most `steps` time steps. Raises `Refused` and `NeverAccepted` as `scenes` does."""
        ...


@runtime_checkable
class EnumeratingSimulations(Protocol):
    """An implementation that can enumerate the simulations of finite programs in that world."""

    def enumerated_simulations(self, task: Task, steps: int) -> Enumerated | None:
        """The exact distribution, None if the program is not finite. Raises `Refused`, and `NeverAccepted` if no simulation is possible."""
        ...


@runtime_checkable
class TracingSimulations(Protocol):
    """An implementation that reports which rules fire in simulations, including those of the scene."""

    def fired_in_simulations(self, task: Task, steps: int, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        """The ids of the rules that fired in a few simulations, until all `wanted` ones were seen and one was accepted."""
        ...
