"""Several processes that draw scenes: results come in the order of the scenes, whatever the number of processes."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import AbstractContextManager
from typing import NamedTuple, TypeVar

from ..inference.batch.jobs.failures import FailedDraw, parts, record_failed_draw
from ..inference.batch.jobs.worker_pools import Workers, processes
from ..inference.rejection import patiently
from ..semantics.store.errors import ScenicError
from .options import Source
from .scene_sampler import Drawing, DrawnScene, drawing_of

AnyJob = TypeVar("AnyJob")
Found = TypeVar("Found")
Listener = Callable[[int], None]


class Job(NamedTuple):
    """Scenes `start` to `stop - 1` of `seed`, for one process."""

    source: Source
    seed: int
    start: int
    stop: int
    max_attempts: int


def work(job: Job) -> list[DrawnScene | FailedDraw]:
    """The scenes of a job; a program's error is the last."""
    return list(draw_here(drawing_of(job.source), job))


def draw_here(
    drawing: Drawing, job: Job, on_attempt: Listener | None = None, *, patient: bool = True
) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, in this process; a program's error is the last. Raises `OutOfPatience`, unless it is `patient`."""
    printed: list[str] = []
    for index in range(job.start, job.stop):
        try:
            yield drawing.draw(job.seed, index, job.max_attempts, printed, on_attempt if patient else patiently(job.max_attempts, on_attempt))
        except ScenicError as error:
            yield record_failed_draw(error, printed)
            return


def drawn_by(workers: AbstractContextManager[Workers], job: Job, count: int) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, drawn by about `count` processes."""
    jobs = (job._replace(start=start, stop=stop) for start, stop in parts(job.start, job.stop, count))
    yield from done_by(workers, work, jobs)


def done_by(workers: AbstractContextManager[Workers], work: Callable[[AnyJob], list[Found]], jobs: Iterable[AnyJob]) -> Generator[Found]:
    """What jobs give, in their order, whichever process does them."""
    with workers as several:
        for found in several.draw(work, jobs):
            yield from found


def draw_in_processes(job: Job, count: int) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, drawn by `count` processes of this machine."""
    return drawn_by(processes(count), job, count)
