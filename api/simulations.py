"""Simulations of a scenario: many of them, by this process or by several, and those that are played again."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import is_dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

from ..data.recording_reader import Recording, recording_of
from ..data.simulation import Simulated
from ..inference.batch.jobs.failures import FailedDraw, parts, record_failed_draw
from ..inference.batch.jobs.worker_pools import processes
from ..inference.simulation_rejection import SampledRun, require_accepted_replay
from ..semantics.store.errors import ScenicError, UsageError
from ..simulators import by_name
from ..simulators.actions import ACTIONS
from ..simulators.protocol import Simulator
from ..simulators.replay import replay_once

if TYPE_CHECKING:
    from .scenario import Scenario

SimulationBackend = Literal["compiled", "interpreter"]
"""What runs behaviors: Python code made from them, or the machine."""


def check_simulation_backend(backend: str) -> None:
    """Raise `UsageError` for what is none."""
    if backend not in get_args(SimulationBackend):
        raise UsageError(f"there is no backend {backend!r} of simulations", hint=f"choose among {', '.join(get_args(SimulationBackend))}")


Told = Callable[[int, int], None]
"""Is told how many simulations there are so far, and how many attempts they took."""


class SimulationRange(NamedTuple):
    """Simulations `start` to `stop - 1` of `seed`, of at most `steps` time steps."""

    start: int
    stop: int
    seed: int
    steps: int
    timestep: float | None
    max_attempts: int
    backend: SimulationBackend


class SimulationsJob(NamedTuple):
    """Some simulations for another process, of a scenario that is pickled."""

    scenario: bytes
    simulator: str
    which: SimulationRange


def simulate_many(
    scenario: Scenario, which: SimulationRange, simulator: str | Simulator, workers: int, progress: Told | None
) -> Iterator[SampledRun]:
    """The simulations, in order, by this process or `workers` others. Raises `UsageError` where a simulator cannot be sent to these."""
    count = min(workers, which.stop - which.start)
    if count <= 1:
        return report_run_progress(
            simulate_range(scenario, which, by_name(simulator, which.timestep) if isinstance(simulator, str) else simulator), progress
        )
    if not isinstance(simulator, str):
        raise UsageError("other processes make their own simulators", hint='name it: simulator="package.module:Class", or workers=1')
    by_name(simulator, which.timestep)
    data = pickle.dumps(scenario)
    jobs = (SimulationsJob(data, simulator, which._replace(start=start, stop=stop)) for start, stop in parts(which.start, which.stop, count))
    return report_run_progress(simulate_in_processes(jobs, count), progress)


def simulate_range(scenario: Scenario, which: SimulationRange, simulator: Simulator) -> Generator[SampledRun]:
    """The simulations, by this process."""
    for index in range(which.start, which.stop):
        yield scenario.simulate(simulator, which.steps, which.seed, index, max_attempts=which.max_attempts, backend=which.backend)


def simulate_in_processes(jobs: Iterator[SimulationsJob], count: int) -> Generator[SampledRun]:
    """The simulations, by other processes. Raises the error that ends one, after those before it."""
    with processes(count) as several:
        for found in several.draw(run_simulations_job, jobs):
            for one in found:
                if isinstance(one, FailedDraw):
                    raise one.error
                yield pickle.loads(one)


def run_simulations_job(job: SimulationsJob) -> list[bytes | FailedDraw]:
    """The simulations of a job, pickled; an error is the last."""
    runs: list[bytes | FailedDraw] = []
    try:
        runs.extend(map(pickle_run, simulate_range(unpickle_scenario(job.scenario), job.which, by_name(job.simulator, job.which.timestep))))
    except ScenicError as error:
        runs.append(record_failed_draw(error, []))
    return runs


def pickle_run(run: SampledRun) -> bytes:
    """A simulation for another process. Raises `UsageError` where it has actions, or values that it recorded, that cannot be pickled."""
    try:
        return pickle.dumps(run)
    except Exception as problem:  # whatever a foreign value does when it is pickled
        raise UsageError(f"simulation {run.simulation.scene.index} cannot be sent by another process: {problem}", hint="use workers=1") from None


@lru_cache(maxsize=1)
def unpickle_scenario(data: bytes) -> Scenario:
    """A scenario that was sent to this process."""
    return pickle.loads(data)


def report_run_progress(runs: Generator[SampledRun], progress: Told | None) -> Generator[SampledRun]:
    """The simulations, each of which is told to `progress`."""
    attempts = 0
    for number, run in enumerate(runs, 1):
        attempts += run.attempts
        if progress is not None:
            progress(number, attempts)
        yield run


def replay_recording(scenario: Scenario, record: Mapping[str, object] | Recording, simulator: str | Simulator, timestep: float | None) -> Simulated:
    """Replay a recorded simulation, as `Scenario.replay` does."""
    recording = record if isinstance(record, Recording) else recording_of(record)
    found = by_name(simulator, recording.timestep if timestep is None else timestep) if isinstance(simulator, str) else simulator
    return require_accepted_replay(replay_once(scenario.start(), recording, found, action_classes(scenario), fuel=scenario.fuel))


def action_classes(scenario: Scenario) -> dict[str, type]:
    """The classes of actions by name: ours, and the dataclasses of the Python modules that the program imports."""
    modules = [m for m in scenario.settings.library.values() if isinstance(m, Mapping)]
    return {v.__name__: v for m in modules for v in m.values() if isinstance(v, type) and is_dataclass(v)} | ACTIONS
