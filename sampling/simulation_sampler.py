"""Simulations one after the other, by this process or by several: results come in their order, whatever the number of processes."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Generator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import NamedTuple

from ..api.simulations import SimulationBackend
from ..data.simulation import to_line
from ..inference.batch.jobs.failures import FailedDraw, parts, record_failed_draw
from ..inference.batch.jobs.worker_pools import Workers
from ..inference.simulation_rejection import SampledRun
from ..pictures.replay_pages import land_below
from ..semantics.machine.run_loop import Witness
from ..semantics.store.errors import InternalError, ScenicError
from ..simulators import by_name
from ..simulators.loop import Failed
from ..simulators.protocol import Simulator
from .program_source import Source
from .scene_sampler import Drawing, done_by, drawing_of, listen


class SimulationJob(NamedTuple):
    """Simulations `start` to `stop - 1` of `seed`, for one process, where the first of all is `begun`.

    Lines of JSON are only made if they are `wanted`, and the land below the objects for the first ones, as many as are `shown` on a page.
    """

    source: Source
    seed: int
    begun: int
    start: int
    stop: int
    max_attempts: int
    simulator: str
    timestep: float | None
    steps: int
    wanted: bool = True
    shown: int = 0
    backend: SimulationBackend = "compiled"


class Uncompiled(NamedTuple):
    """Why the machine ran what is not compiled: behaviors and monitors, functions (by what they are), and how many attempts as a whole, by reason.

    Also how long it ran which function, and how long all took, in nanoseconds of the processor.
    """

    parts: tuple[str, ...]
    functions: Mapping[str, str]
    wholes: Counter[str]
    in_functions: Counter[str]
    nanoseconds: int


ALL_COMPILED = Uncompiled((), {}, Counter(), Counter(), 0)


@dataclass(frozen=True)
class ReportedRun:
    """A simulation as its line of JSON ("" if none was wanted) and in a few words, what failed in other attempts, what the accepted one printed.

    `land` is what lies below the objects, for a page (`pictures.replay_pages`); `left` what was left to the machine in its process so far;
    `run` the simulation itself, in the process that ran it.
    """

    index: int
    attempts: int
    line: str
    told: str
    stuck: Counter[Failed]
    printed: tuple[str, ...]
    land: Mapping[str, object] | None
    left: Uncompiled
    run: SampledRun | None

    def __reduce__(self) -> tuple[Callable[..., ReportedRun], tuple[object, ...]]:
        """Reduce the run for pickling, without what another process cannot use."""
        return ReportedRun, (self.index, self.attempts, self.line, self.told, self.stuck, self.printed, self.land, self.left, None)


class Listeners(NamedTuple):
    """Who is told of each attempt as it fails: how many did so far, and how."""

    attempt: Callable[[int], None] | None = None
    failed: Callable[[Failed], None] | None = None


def report_simulation(
    run: SampledRun, wanted: bool, printed: tuple[str, ...] = (), *, shown: bool, left: Uncompiled = ALL_COMPILED
) -> ReportedRun:
    """A simulation that has ended, and whether it is shown on a page. Raises `InternalError` for numbers that JSON does not have."""
    simulation = run.simulation
    index, steps = simulation.scene.index, len(simulation.moments) - 1
    told = f"simulation {index}: {simulation.result} after {steps:,} time steps ({steps * simulation.timestep:g} s): {simulation.reason}"
    try:
        line = to_line(simulation, run.attempts) if wanted else ""
    except ValueError as problem:
        raise InternalError(f"simulation {index} cannot be written: {problem}") from None
    land = land_below(simulation.scene, json.loads(line)) if shown and line else None
    return ReportedRun(index, run.attempts, line, told, run.stuck, printed, land, left, run)


NOBODY = Listeners()


def simulate_here(drawing: Drawing, job: SimulationJob, simulator: Simulator, tell: Listeners = NOBODY) -> Generator[ReportedRun | FailedDraw]:
    """The simulations of a job, in this process; an error is the last."""
    printed: list[str] = []
    library = drawing.scenario.compiled

    def listening(attempt: int) -> Witness:
        printed.clear()
        return lambda outcome, drawn: listen(outcome, printed)

    for index in range(job.start, job.stop):
        printed.clear()
        wholes, before, begun = library.wholes.copy(), library.nanoseconds.copy(), time.thread_time_ns()
        try:
            run = drawing.scenario.simulate(
                simulator, job.steps, job.seed, index, max_attempts=job.max_attempts, on_attempt=tell.attempt, on_failed=tell.failed,
                witnessed=listening if drawing.prints else None, backend=job.backend,
            )  # fmt: skip
            left = Uncompiled(
                tuple(library.left.values()), dict(library.functions_left), library.wholes - wholes, library.nanoseconds - before,
                time.thread_time_ns() - begun,
            )
            found = report_simulation(run, job.wanted, tuple(printed), shown=index < job.begun + job.shown, left=left)
        except ScenicError as error:
            yield record_failed_draw(error, printed)
            return
        yield found


def simulation_work(job: SimulationJob) -> list[ReportedRun | FailedDraw]:
    """The simulations of a job; an error is the last."""
    try:
        return list(simulate_here(drawing_of(job.source), job, by_name(job.simulator, job.timestep)))
    except ScenicError as error:
        return [record_failed_draw(error, [])]


def simulated_by(workers: AbstractContextManager[Workers], job: SimulationJob, count: int) -> Generator[ReportedRun | FailedDraw]:
    """The simulations of a job, by about `count` processes."""
    jobs = (job._replace(start=start, stop=stop) for start, stop in parts(job.start, job.stop, count))
    yield from done_by(workers, simulation_work, jobs)
