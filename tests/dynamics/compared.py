"""One simulation by compiled code and by the machine: what both say, to the byte."""

from __future__ import annotations

from collections.abc import Iterator

import scenic_ref
from scenic_ref.api.simulations import SimulationBackend
from scenic_ref.data.simulation import to_line
from scenic_ref.semantics.store.errors import ScenicError
from scenic_ref.simulators.loop import Failed

STEPS, ATTEMPTS = 14, 60


def said(scenario: scenic_ref.Scenario, backend: SimulationBackend, seed: int, simulator: str = "still", steps: int = STEPS) -> tuple[object, ...]:
    """The recording, or the error with all that is told of it; and what was rejected, in its order."""
    rejected: list[Failed] = []
    try:
        run = scenario.simulate(simulator, steps, seed, max_attempts=ATTEMPTS, backend=backend, on_failed=rejected.append)
    except ScenicError as error:
        return type(error), str(error), error.span, error.hint, error.rule, tuple(rejected)
    try:
        return to_line(run.simulation, run.attempts), tuple(rejected)
    except ValueError:  # numbers that JSON does not have
        return repr(run.simulation.moments), tuple(rejected)


def differences(scenario: scenic_ref.Scenario, seeds: range, simulator: str = "still", steps: int = STEPS) -> Iterator[str]:
    """The seeds with which compiled code says something else than the machine, and what."""
    for seed in seeds:
        compiled, machine = (said(scenario, backend, seed, simulator, steps) for backend in ("compiled", "interpreter"))
        if compiled != machine:
            yield f"seed {seed}:\n  compiled: {compiled}\n  machine:  {machine}"
