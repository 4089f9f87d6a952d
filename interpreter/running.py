"""Runs: the machine driven to the scene that it gives, and once beforehand to find every error."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from ..semantics.kernel.config import Config, Stack, State, Value
from ..semantics.kernel.driving import Chooser, Unfinished, Witness, drive_machine, taken_over
from ..semantics.kernel.errors import FuelExhausted, RandomBranch, ScenicError
from ..semantics.kernel.outcome import Act, Done, Draw, Fault, Finish, Next, Outcome, Requirement, Stuck
from ..semantics.space.regions import EmptyRegion
from ..semantics.space.vectors import Vector
from ..semantics.step import place, step
from .walls import within

DEFAULT_FUEL = 5_000_000


class Accepted(NamedTuple):
    """A run that ended with a scene; `state` holds (π, O)."""

    state: State
    steps: int


class Rejected(NamedTuple):
    """A run that got stuck at `requirement`."""

    requirement: Requirement
    steps: int


Run = Accepted | Rejected


@within
def drive(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> tuple[Done | Act | Finish | Stuck, int]:
    """Drive the machine until it has something to say, and in how many steps; `config` is taken over, and cannot be stepped again.

    Raises the program's error, or `FuelExhausted` after `fuel` steps.
    """
    config.state.settings.door.budget.renew()
    end, steps = drive_machine(step, taken_over(config), choose, fuel, witness=witness)
    if isinstance(end, Fault):
        raise end.error
    if isinstance(end, Unfinished):
        timeless = "" if end.config.state.simulation is None else "time passes only where something is taken, waited for or done; "
        raise endless(end.config, fuel, f"{timeless}raise --fuel if it really takes that long")
    return end, steps  # type: ignore[return-value]


def endless(config: Config, fuel: int, hint: str = "") -> FuelExhausted:
    """The error of a run that takes too many steps."""
    return FuelExhausted(f"the program took {fuel:,} steps without ending: is this an endless loop?", place(config), hint=hint)


def run(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> Run:
    """Drive the generation of a scene to its end. Raises the program's error, or `FuelExhausted` after `fuel` steps."""
    outcome, steps = drive(config, choose, fuel=fuel, witness=witness)
    if isinstance(outcome, Stuck):
        return Rejected(outcome.requirement, steps)
    assert isinstance(outcome, Done)
    return Accepted(outcome.state, steps)


@within
def rehearse(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL) -> None:
    """One run that goes on where others get stuck, to find every branch on a random value (reading `random-branch`).

    Which values are random does not depend on what is drawn, so that one run is enough. Raises `RandomBranch`; before
    the first requirement that fails it raises any other error of the program as well, afterwards none.
    """
    Rehearsal(choose, fuel, stuck=False).run(config)


class Rehearsal:
    """A run that goes on where others get stuck; `stuck` says whether others would be by now."""

    def __init__(self, choose: Chooser, fuel: int, *, stuck: bool) -> None:
        self.choose = choose
        self.fuel = fuel
        self.stuck = stuck

    def run(self, config: Config, end: Stack | None = None) -> None:
        """Rehearse until the control is back at `end`, if there is one."""
        until = None if end is None else partial(is_back, end)
        ended, _ = drive_machine(
            step, taken_over(config) if end is None else config, self.answer, self.fuel, witness=self.watch, beyond=self.beyond, until=until,
        )
        if isinstance(ended, Fault) and (not self.stuck or isinstance(ended.error, RandomBranch)):
            raise ended.error
        if isinstance(ended, Unfinished) and not self.stuck:
            raise endless(ended.config, self.fuel)

    def answer(self, draw: Draw) -> object:
        """The value of a draw; heads for a coin, so that its condition is run through as well."""
        if draw.otherwise and can_be_true(draw):
            return True
        try:
            return self.choose(draw)
        except EmptyRegion:
            self.stuck = True
            return Vector(0.0, 0.0)

    def watch(self, outcome: Outcome, drawn: object) -> None:
        """Rehearse operands that this run does not need (reading `boolean-random`), as if it were stuck."""
        if isinstance(outcome, Next) and outcome.beyond is not None:
            Rehearsal(self.choose, self.fuel, stuck=True).run(outcome.beyond, outcome.beyond.stack)

    def beyond(self, outcome: Stuck) -> Config | None:
        """Where a run goes on that is stuck."""
        self.stuck = True
        return outcome.beyond


def is_back(end: Stack, config: Config) -> bool:
    """Whether something was reduced to a value in the context `end`."""
    return config.stack is end and type(config.control) is Value


def can_be_true(coin: Draw) -> bool:
    """Whether a coin ever shows heads; the condition of `require[0]` is never evaluated."""
    return any(value for value, _ in coin.distribution.support() or ())


__all__ = ["DEFAULT_FUEL", "Accepted", "Chooser", "Rejected", "Run", "ScenicError", "Witness", "drive", "rehearse", "run"]
