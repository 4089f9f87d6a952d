"""Rejection sampling of simulations: the first run, scene and policy, that violates no requirement (reading `rejected-simulation`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from ..data.simulation import Simulated
from ..interpreter.runtime.answerers import from_stream
from ..interpreter.runtime.program_run import DEFAULT_FUEL, Beginnings, Chooser, Witness
from ..pictures.notebook_views import count_phrase
from ..semantics.dynamics.coroutines import DYNAMIC
from ..semantics.machine.config import Config, State
from ..semantics.machine.outcome import Requirement
from ..semantics.store.errors import AttemptsExhausted
from ..simulators.behaviors.compiled_library import Library
from ..simulators.behaviors.fallback import LeftToMachine
from ..simulators.behaviors.policy import CompiledPolicy
from ..simulators.loop import Failed, Settled, simulate_once
from ..simulators.protocol import Simulator
from .rejection import DEFAULT_ATTEMPTS, PATIENCE, how_often, watch_first_draw

RETRIES = 100
"""Simulations of one scene under the reading `rejected-simulation=retry`, as in the released implementations."""


class SampledRun(NamedTuple):
    """A simulation, the runs that it took, and what failed in the others: requirements, with the time step (None: in the scene)."""

    simulation: Simulated
    attempts: int
    stuck: Counter[Failed]

    def __repr__(self) -> str:
        return f"<{count_phrase(self.attempts, 'attempt')}, the last one accepted: {self.simulation!r}>"


class NextScene(NamedTuple):
    """The first attempt from some number on whose scene is accepted (or the most attempts there may be), and what failed in those before it."""

    attempt: int
    stuck: Counter[Requirement]


SceneFinder = Callable[[int], NextScene | None]
"""Gives, for the number of an attempt, the next one whose scene is accepted; None where that cannot be found faster than attempt by attempt."""


def sample_simulation(
    start: Callable[[], Config], simulator: Simulator, steps: int, seed: int, index: int, *, max_attempts: int = DEFAULT_ATTEMPTS,
    fuel: int = DEFAULT_FUEL, retry: bool = False, on_attempt: Callable[[int], None] | None = None,
    on_failed: Callable[[Failed], None] | None = None, witnessed: Callable[[int], Witness | None] | None = None, library: Library | None = None,
    next_scene: SceneFinder | None = None, settled: Settled | None = None,
) -> SampledRun:  # fmt: skip
    """Simulation number `index` of `seed`, of at most `steps` time steps. Raises `AttemptsExhausted`, and the errors of the program and simulator.

    Behaviors run compiled where there is a `library` for them, else by the machine; the simulations are the same.
    `on_attempt` is told how many attempts failed so far, `on_failed` of each. With `retry`, a scene keeps its numbers while its simulations are
    rejected, up to `RETRIES` times; each ends where its outcome is `settled`. After `PATIENCE` attempts without a scene `next_scene` is asked which
    attempt gives the next one.
    """
    stuck: Counter[Failed] = Counter()

    def note(failed: Failed, attempts: int) -> None:
        stuck[failed] += 1
        if on_attempt is not None:
            on_attempt(attempts)
        if on_failed is not None:
            on_failed(failed)

    tried = attempts_at(
        start, simulator, steps, seed, index, fuel=fuel, retry=retry, witnessed=witnessed, library=library, next_scene=next_scene, settled=settled
    )  # fmt: skip
    for attempt, found, drawn in tried:
        if isinstance(found, Simulated):
            return SampledRun(found, attempt + 1, stuck)
        if isinstance(found, NextScene):
            for requirement in found.stuck.elements():
                note(Failed(requirement, None), found.attempt)
        else:
            note(found, attempt + 1)
        if attempt + 1 >= max_attempts:
            break
        if isinstance(found, NextScene):
            continue
        if not drawn and (found.step is None or not simulator.random):
            text = f"no simulation is possible, since this fails {found.place} whatever is drawn: {found.requirement.text}"
            raise no_simulation_error(text, attempt + 1, stuck)
    worst, often = stuck.most_common(1)[0]
    text = f"no simulation in {max_attempts:,} attempts: {how_often(often, max_attempts)} this failed {worst.place}: {worst.requirement.text}"
    raise no_simulation_error(text, max_attempts, stuck)


def attempts_at(
    start: Callable[[], Config], simulator: Simulator, steps: int, seed: int, index: int, *, fuel: int = DEFAULT_FUEL, retry: bool = False,
    witnessed: Callable[[int], Witness | None] | None = None, library: Library | None = None, next_scene: SceneFinder | None = None,
    settled: Settled | None = None,
) -> Iterator[tuple[int, Simulated | Failed | NextScene, bool]]:  # fmt: skip
    """One run of simulation number `index` after the other, without end: its number, and whether anything was drawn in it.

    Arguments are those of `sample_simulation`. Where `next_scene` skips attempts, what it found stands for them, with the number of the last.
    """
    scene, first = 0, 0  # the attempt that the scene's numbers are of, and the one with which its simulations began
    attempt, without = 0, 0  # without: attempts in a row that made no scene
    begin = start if witnessed is not None else Beginnings(start, fuel)
    while True:
        if without >= PATIENCE and next_scene is not None and scene == attempt:
            found = next_scene(attempt)
            if found is None:
                next_scene = None
            elif found.attempt > attempt:
                scene = first = attempt = found.attempt
                yield attempt - 1, found, True

        def number(address: tuple[int, ...], scene: int = scene, attempt: int = attempt) -> int:
            return attempt if address[:1] == (DYNAMIC,) else scene

        witness = None if witnessed is None else witnessed(attempt)
        chooser, drawn = watch_first_draw(from_stream(seed, index, number))
        simulate = partial(simulate_once, seed=seed, index=index, attempt=scene, tried=attempt, fuel=fuel, witness=witness, settled=settled)
        found = run_compiled(simulate, begin, chooser, simulator, steps, library if witness is None else None, fuel)
        yield attempt, found, bool(drawn)
        without = without + 1 if isinstance(found, Failed) and found.step is None else 0
        attempt += 1
        if isinstance(found, Simulated) or not retry or found.step is None or attempt - first >= RETRIES:
            scene = first = attempt


def run_compiled(
    simulate: Callable[..., Simulated | Failed], start: Callable[[], Config], choose: Chooser, simulator: Simulator, steps: int,
    library: Library | None, fuel: int,
) -> Simulated | Failed:  # fmt: skip
    """One run with what is compiled of the program, from its beginning by the machine where that cannot go on.

    Of less fuel than the default only the machine knows how far it goes.
    """
    if library is not None and fuel < DEFAULT_FUEL:
        library.wholes["less fuel than by default"] += 1
        library = None
    while library is not None and library.usable:

        def policy(state: State, witness: Witness) -> CompiledPolicy:
            assert library is not None
            return CompiledPolicy(state, choose, library, witness, fuel)

        try:
            return simulate(start(), choose, simulator, steps, by=policy)
        except LeftToMachine as left:
            if not left.again:
                library.wholes[left.reason] += 1
                break
    return simulate(start(), choose, simulator, steps)


def no_simulation_error(text: str, attempts: int, stuck: Counter[Failed]) -> AttemptsExhausted:
    """The error when no simulation was found; it counts requirements, whatever the time step."""
    counted: Counter[object] = Counter()
    for failed, often in stuck.items():
        counted[failed.requirement] += often
    place = stuck.most_common(1)[0][0].requirement.span
    return AttemptsExhausted(text, place, attempts=attempts, stuck=tuple(counted.most_common()))


def require_accepted_replay(found: Simulated | Failed) -> Simulated:
    """A simulation that is played again, in one attempt. Raises `AttemptsExhausted` if the simulator rejects it."""
    if isinstance(found, Failed):
        raise no_simulation_error(f"the replay fails {found.place}: {found.requirement.text}", 1, Counter([found]))
    return found
