"""The loop that drives the machine: it asks what comes next and has draws answered, until there is something else to say.

It is the only one. Who runs a program says what answers, what watches, what happens where a run gets stuck, and where to stop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..space.regions import EmptyRegion, UnboundedRegion
from ..store.errors import RunError
from .config import Config
from .outcome import Act, Done, Draw, Fault, Finish, Next, Observe, Outcome, Stuck, in_version
from .stuck_runs import unmet_requirement
from .value_nesting import too_deep

Machine = Callable[[Config], Outcome]
"""What one step of the machine says: `step`, or what does something besides."""

Chooser = Callable[[Draw], object]
"""Answers a draw with a value of its distribution; may raise `EmptyRegion`, which makes the run stuck."""

Witness = Callable[[Outcome, object], None]
"""Is shown every outcome of a run but an error, and the value that a draw was answered with (None for other outcomes)."""


class Arrived(NamedTuple):
    """The run has come where it was to stop."""

    config: Config


class Unfinished(NamedTuple):
    """The run has taken all the steps that it may take, and stands here."""

    config: Config


End = Done | Act | Finish | Stuck | Fault | Arrived | Unfinished
"""How driving ends."""


def drive_machine(
    machine: Machine, config: Config, choose: Chooser, fuel: int, *, witness: Witness | None = None,
    beyond: Callable[[Stuck], Config | None] | None = None, until: Callable[[Config], bool] | None = None,
) -> tuple[End, int]:  # fmt: skip
    """How the run from `config` ends, and after how many steps: at most `fuel`.

    `beyond` says where a run that is stuck goes on, if it does, and `until` where to stop. Raises `RunError` for a region that no point can be drawn
    from, and for a value that contains itself.
    """
    for steps in range(fuel):
        if until is not None and until(config):  # pyright: ignore[reportUnknownArgumentType]
            return Arrived(config), steps
        outcome = machine(config)  # pyright: ignore[reportUnknownArgumentType]
        kind = type(outcome)
        if kind is Next or kind is Observe:
            config = outcome.config  # type: ignore[union-attr]
            if witness is not None:
                witness(outcome, None)
            continue
        if kind is Draw:
            try:
                drawn = choose(outcome)  # type: ignore[arg-type]
            except EmptyRegion as empty:
                outcome = Stuck(outcome.rule, unmet_requirement(empty, outcome.node.span))  # type: ignore[union-attr]
            except UnboundedRegion as unbounded:
                raise RunError(str(unbounded), outcome.node.span, rule=outcome.rule) from None  # type: ignore[union-attr]
            else:
                if witness is not None:
                    witness(outcome, drawn)
                config = resume_draw(outcome, drawn)  # type: ignore[arg-type]
                continue
        if witness is not None and not isinstance(outcome, Fault):
            witness(outcome, None)
        after = beyond(outcome) if isinstance(outcome, Stuck) and beyond is not None else None
        if after is None:
            return outcome, steps  # type: ignore[return-value]
        config = after
    return Unfinished(config), fuel


def taken_over(config: Config) -> Config:
    """The configuration from which a run is driven on: whoever still holds it, or older ones of its run, can step these no more.

    Otherwise what it takes to go back would be kept as long as they are.
    """
    return in_version(config, config.state.version.begun_anew())


def resume_draw(draw: Draw, drawn: object) -> Config:
    """Return the configuration after a draw that is answered. Raises the program's error for a value that
    contains itself.
    """
    try:
        return draw.resume(drawn)
    except RecursionError:
        raise too_deep(draw.node.span) from None
