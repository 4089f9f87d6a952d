"""Several processes that draw scenes: results come in the order of the scenes, whatever the number of processes."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager
from typing import NamedTuple, TypeVar

from ..inference.batch.jobs.blocks import Workers, processes
from ..semantics.kernel.errors import ScenicError
from .drawing import Drawing, DrawnScene, drawing_of
from .options import Source

AnyJob = TypeVar("AnyJob")
Found = TypeVar("Found")
LARGEST_CHUNK = 16
Listener = Callable[[int], None]


class Job(NamedTuple):
    """Scenes `start` to `stop - 1` of `seed`, for one process."""

    source: Source
    seed: int
    start: int
    stop: int
    max_attempts: int


class FailedDraw(NamedTuple):
    """A program's error that ended a run of scenes, with what its attempt had printed; can be sent between processes."""

    kind: type[ScenicError]
    attributes: dict[str, object]
    printed: tuple[str, ...]

    @property
    def error(self) -> ScenicError:
        """The error itself."""
        found = self.kind.__new__(self.kind, self.attributes["message"])
        found.__dict__.update(self.attributes)
        return found


def failed(error: ScenicError, printed: list[str]) -> FailedDraw:
    """The error as a record; attributes that cannot be sent are described in words."""
    attributes: dict[str, object] = {name: value if _can_be_sent(value) else RuntimeError(repr(value)) for name, value in vars(error).items()}
    return FailedDraw(type(error), attributes, tuple(printed))


def _can_be_sent(value: object) -> bool:
    try:
        pickle.loads(pickle.dumps(value))
    except Exception:  # whatever a foreign object does when it is pickled, it then cannot be sent
        return False
    return True


def work(job: Job) -> list[DrawnScene | FailedDraw]:
    """The scenes of a job; a program's error is the last."""
    return list(draw_here(drawing_of(job.source), job))


def draw_here(drawing: Drawing, job: Job, on_attempt: Listener | None = None) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, in this process; a program's error is the last."""
    printed: list[str] = []
    for index in range(job.start, job.stop):
        try:
            yield drawing.draw(job.seed, index, job.max_attempts, printed, on_attempt)
        except ScenicError as error:
            yield failed(error, printed)
            return


def drawn_by(workers: AbstractContextManager[Workers], job: Job, count: int) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, drawn by about `count` processes."""
    jobs = (job._replace(start=start, stop=stop) for start, stop in parts(job.start, job.stop, count))
    yield from done_by(workers, work, jobs)


def parts(start: int, stop: int, count: int) -> Iterator[tuple[int, int]]:
    """A range in parts for about `count` processes, in order."""
    chunk = max(1, min(LARGEST_CHUNK, (stop - start) // (4 * count)))
    return ((begin, min(begin + chunk, stop)) for begin in range(start, stop, chunk))


def done_by(workers: AbstractContextManager[Workers], work: Callable[[AnyJob], list[Found]], jobs: Iterable[AnyJob]) -> Generator[Found]:
    """What jobs give, in their order, whichever process does them."""
    with workers as several:
        for found in several.draw(work, jobs):
            yield from found


def draw_in_processes(job: Job, count: int) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, drawn by `count` processes of this machine."""
    return drawn_by(processes(count), job, count)
