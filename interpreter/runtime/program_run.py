"""Runs: the machine driven to the scene that it gives, and once beforehand to find every error."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import NamedTuple

from ...semantics.machine.config import Config, Stack, State, Value
from ...semantics.machine.outcome import (
    Act,
    Done,
    Draw,
    Fault,
    Finish,
    Next,
    Observe,
    Outcome,
    Requirement,
    Stuck,
)
from ...semantics.machine.run_loop import Chooser, Unfinished, Witness, drive_machine, taken_over
from ...semantics.space.regions import EmptyRegion
from ...semantics.space.vectors import Vector
from ...semantics.step import place, step
from ...semantics.store.errors import FuelExhausted, RandomBranch, ScenicError
from .process_sandbox import guard_run

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


@guard_run
def drive(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> tuple[Done | Act | Finish | Stuck, int]:
    """Drive the machine until it has something to say, and in how many steps; `config` is taken over, and cannot be stepped again, but where it
    is one that many runs begin with (`Beginnings`).

    Raises the program's error, or `FuelExhausted` after `fuel` steps.
    """
    budget, version = config.state.settings.door.budget, config.state.version
    budget.renew()
    begun = 0
    if version.beginning is config:
        budget.left -= version.work
        begun = version.steps
    else:
        config = taken_over(config)
    end, steps = drive_machine(step, config, choose, fuel - begun, witness=witness)
    steps += begun
    if isinstance(end, Fault):
        raise end.error
    if isinstance(end, Unfinished):
        timeless = "" if end.config.state.simulation is None else "time passes only where something is taken, waited for or done; "
        raise endless(end.config, fuel, f"{timeless}raise --fuel if it really takes that long")
    return end, steps  # type: ignore[return-value]


class Beginnings:
    """The beginnings of a program's attempts: the first attempt begins with the program, the others at its
    first draw, since everything before is equal.

    Only for attempts without a witness, one after the other: a configuration is gone back to.
    """

    def __init__(self, start: Callable[[], Config], fuel: int) -> None:
        self.start = start
        self.fuel = fuel
        self.attempts = 0
        self.kept: Config | None = None

    @property
    def shared_steps(self) -> int:
        """The steps that the next attempt does not take, since an earlier one has."""
        return 0 if self.kept is None else self.kept.state.version.steps

    def __call__(self) -> Config:
        """The configuration with which the next attempt begins."""
        self.attempts += 1
        if self.kept is None or not self.kept.state.version.within_reach:
            config = self.start()
            trusted = config.state.settings.trusted  # Python code of others may draw at random, or change
            if self.attempts == 1 or trusted:
                return config
            self.kept = first_draw(config, self.fuel)
        return self.kept


@guard_run
def first_draw(config: Config, fuel: int) -> Config:
    """The configuration in which a run first says something else than how it goes on."""
    budget = config.state.settings.door.budget
    budget.renew()
    available = budget.left
    reached, steps = taken_over(config), 0

    def note(outcome: Outcome, drawn: object) -> None:
        nonlocal reached, steps
        if isinstance(outcome, (Next, Observe)):
            reached, steps = outcome.config, steps + 1

    with suppress(AtFirstDraw):
        drive_machine(step, reached, stop, fuel, witness=note)
    version = reached.state.version
    version.beginning, version.steps, version.work = reached, steps, available - budget.left
    return reached


class AtFirstDraw(Exception):
    """A run has come to its first draw."""


def stop(draw: Draw) -> object:
    """Answer no draw. Raises `AtFirstDraw`."""
    raise AtFirstDraw


def endless(config: Config, fuel: int, hint: str = "") -> FuelExhausted:
    """The error of a run that takes too many steps."""
    return FuelExhausted(f"the program took {fuel:,} steps without ending: is this an endless loop?", place(config), hint=hint)


def generate_scene(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> Run:
    """Drive the generation of a scene to its end. Raises the program's error, or `FuelExhausted` after `fuel` steps."""
    outcome, steps = drive(config, choose, fuel=fuel, witness=witness)
    if isinstance(outcome, Stuck):
        return Rejected(outcome.requirement, steps)
    assert isinstance(outcome, Done)
    return Accepted(outcome.state, steps)


@guard_run
def rehearse(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> None:
    """One run that goes on where others get stuck, to find every branch on a random value (reading `random-branch`).

    Which values are random does not depend on what is drawn, so that one run is enough. Raises `RandomBranch`; before
    the first requirement that fails it raises any other error of the program as well, afterwards none. A `witness` sees the steps
    up to there.
    """
    Rehearsal(choose, fuel, stuck=False, witness=witness).run(config)


class Rehearsal:
    """A run that goes on where others get stuck; `stuck` says whether others would be by now."""

    def __init__(self, choose: Chooser, fuel: int, *, stuck: bool, witness: Witness | None = None) -> None:
        self.choose = choose
        self.fuel = fuel
        self.stuck = stuck
        self.witness = witness

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
        if self.witness is not None and not self.stuck:
            self.witness(outcome, drawn)
        if isinstance(outcome, Next) and outcome.beyond is not None:
            Rehearsal(self.choose, self.fuel, stuck=True).run(outcome.beyond, outcome.beyond.stack)

    def beyond(self, outcome: Stuck) -> Config | None:
        """Note that the run was stuck, and return the point at which it goes on."""
        self.stuck = True
        return outcome.beyond


def is_back(end: Stack, config: Config) -> bool:
    """Whether something was reduced to a value in the context `end`."""
    return config.stack is end and type(config.control) is Value


def can_be_true(coin: Draw) -> bool:
    """Whether a coin ever shows heads; the condition of `require[0]` is never evaluated."""
    return any(value for value, _ in coin.distribution.support() or ())


__all__ = ["DEFAULT_FUEL", "Accepted", "Chooser", "Rejected", "Run", "ScenicError", "Witness", "drive", "generate_scene", "rehearse"]
