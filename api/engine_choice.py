"""The choice of an engine for scenes: the interpreter, one scene after the other, or the batch backend, many at a time.

1. The engine that was asked for by its name draws the scenes, if it can.
2. By default the batch backend draws `FEW` scenes or more, of a program that has a graph: making the graph pays from then on.
3. The interpreter begins with fewer scenes. It hands over to the batch backend where a scene needs hundreds of attempts or more time than
   a graph takes (`inference.rejection.patiently`), or where a single attempt takes long (`is_slow`).

Every engine gives the same scenes, so that the choice decides nothing but the time. Simulations choose in the same way: after `PATIENCE`
attempts without a scene the batch backend finds the attempt that gives the next one (`inference.simulation_rejection`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

from .argument_checks import no_backend

if TYPE_CHECKING:
    from .scenario import Scenario

Backend = Literal["auto", "interpreter", "batch"]
FEW = 10
"""For fewer scenes than this a graph is not worth its time."""
SLOW_RUN = 1.0
"""Where an attempt takes more seconds of a processor than this, the batch backend is quicker from the third scene on: it runs the program once."""


class EngineChoice(NamedTuple):
    """The engine that draws some scenes: the interpreter for a reason, or the batch backend, if there is none.

    `hands_over`: the interpreter leaves the rest to the batch backend as soon as a scene takes long.
    """

    why_interpreted: str | None
    hands_over: bool = False


def choose_engine(scenario: Scenario, count: int, backend: str) -> EngineChoice:
    """Return what draws `count` scenes. Raises `UsageError` for an unknown backend, and `AttemptsExhausted` if no scene is possible."""
    if backend not in get_args(Backend):
        raise no_backend(backend, get_args(Backend), elsewhere=("importance", "smc", "mcmc"), there="`infer`")
    if backend == "interpreter":
        return EngineChoice("as asked for")
    if backend == "auto" and count < FEW:
        return EngineChoice(f"since fewer than {FEW} scenes were asked for", hands_over=True)
    if scenario.impossible is not None:
        raise scenario.impossible
    reason = scenario.not_lifted
    return EngineChoice(None if reason is None else f"since the batch backend cannot draw from this program: {reason}")


def is_slow(seconds: float, attempts: int, left: int) -> bool:
    """Whether the batch backend is quicker for the `left` scenes behind one whose attempts took so many seconds of a processor."""
    return left > 1 and seconds > SLOW_RUN * attempts
