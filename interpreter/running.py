"""The loop that drives the machine: it asks `step` what comes next and answers its draws, until the run ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..semantics.kernel.config import Config, Stack, State, Value
from ..semantics.kernel.errors import FuelExhausted, RandomBranch, RunError, ScenicError
from ..semantics.kernel.nesting import too_deep
from ..semantics.kernel.outcome import Act, Done, Draw, Fault, Finish, Next, Observe, Outcome, Requirement, Stuck
from ..semantics.space.regions import EmptyRegion, UnboundedRegion
from ..semantics.space.vectors import Vector
from ..semantics.step import place, step
from .walls import within

Chooser = Callable[[Draw], object]
"""Answers a draw with a value of its distribution; may raise `EmptyRegion`, which makes the run stuck."""

Witness = Callable[[Outcome, object], None]
"""Is shown every outcome of a run, and the value that a draw was answered with (None for other outcomes)."""

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


@within()
def drive(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> tuple[Done | Act | Finish | Stuck, int]:
    """Drive the machine until it has something to say, and in how many steps. Raises the program's error, or `FuelExhausted` after `fuel` steps."""
    config.state.settings.door.budget.renew()
    for steps in range(fuel):
        outcome = step(config)
        kind = type(outcome)
        if kind is Next or kind is Observe:
            config = outcome.config  # type: ignore[union-attr]
            if witness is not None:
                witness(outcome, None)
        elif kind is Draw:
            try:
                drawn = choose(outcome)  # type: ignore[arg-type]
            except EmptyRegion as empty:
                outcome = Stuck(outcome.rule, Requirement("region", outcome.node.span, str(empty)))  # type: ignore[union-attr]
                if witness is not None:
                    witness(outcome, None)
                return outcome, steps
            except UnboundedRegion as unbounded:
                raise RunError(str(unbounded), outcome.node.span, rule=outcome.rule) from None  # type: ignore[union-attr]
            if witness is not None:
                witness(outcome, drawn)
            config = resumed(outcome, drawn)  # type: ignore[arg-type]
        elif kind is Fault:
            raise outcome.error  # type: ignore[union-attr]
        else:
            if witness is not None:
                witness(outcome, None)
            return outcome, steps  # type: ignore[return-value]
    raise FuelExhausted(
        f"the program took {fuel:,} steps without ending: is this an endless loop?", place(config), hint="raise --fuel if it really takes that long"
    )


def resumed(draw: Draw, drawn: object) -> Config:
    """What follows a draw that is answered. Raises the program's error for a value that contains itself."""
    try:
        return draw.resume(drawn)
    except RecursionError:
        raise too_deep(draw.node.span) from None


def run(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL, witness: Witness | None = None) -> Run:
    """Drive the generation of a scene to its end. Raises the program's error, or `FuelExhausted` after `fuel` steps."""
    outcome, steps = drive(config, choose, fuel=fuel, witness=witness)
    if isinstance(outcome, Stuck):
        return Rejected(outcome.requirement, steps)
    assert isinstance(outcome, Done)
    return Accepted(outcome.state, steps)


@within()
def rehearse(config: Config, choose: Chooser, *, fuel: int = DEFAULT_FUEL) -> None:
    """One run that goes on where others get stuck, to find every branch on a random value (reading `random-branch`).

    Which values are random does not depend on what is drawn, so that one run is enough. Raises `RandomBranch`; before
    the first requirement that fails it raises any other error of the program as well, afterwards none.
    """
    _rehearse(config, None, choose, fuel, stuck=False)


def _rehearse(config: Config, end: Stack | None, choose: Chooser, fuel: int, *, stuck: bool) -> None:
    """Rehearse until the control is back at `end`; in operands that this run does not need (reading `boolean-random`), as if it were stuck."""
    for _ in range(fuel):
        if end is not None and config.stack is end and type(config.control) is Value:
            return
        match step(config):
            case Next(config=after, beyond=beyond):
                if beyond is not None:
                    _rehearse(beyond, beyond.stack, choose, fuel, stuck=True)
                config = after
            case Observe(config=after):
                config = after
            case Draw() as draw:
                try:
                    drawn = True if draw.otherwise and can_be_true(draw) else choose(draw)  # so that the condition is run through as well
                except EmptyRegion:
                    drawn, stuck = Vector(0.0, 0.0), True
                except UnboundedRegion as unbounded:
                    raise RunError(str(unbounded), draw.node.span, rule=draw.rule) from None
                config = resumed(draw, drawn)
            case Stuck(beyond=beyond):
                stuck = True
                if beyond is None:
                    return
                config = beyond
            case Fault(error=error):
                if not stuck or isinstance(error, RandomBranch):
                    raise error
                return
            case Done():
                return
    if not stuck:
        raise FuelExhausted(f"the program took {fuel:,} steps without ending: is this an endless loop?", place(config))


def can_be_true(coin: Draw) -> bool:
    """Whether a coin ever shows heads; the condition of `require[0]` is never evaluated."""
    return any(value for value, _ in coin.distribution.support() or ())


__all__ = ["DEFAULT_FUEL", "Accepted", "Chooser", "Rejected", "Run", "ScenicError", "Witness", "drive", "rehearse", "run"]
