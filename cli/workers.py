"""Several processes that draw scenes: the results come in the order of the scenes, whatever the number of processes."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import connection
from typing import NamedTuple

from ..semantics.errors import InternalError, ScenicError
from .drawing import Drawing, Drawn, drawing_of
from .options import Source

LARGEST_CHUNK = 16
Listener = Callable[[int], None]


class Job(NamedTuple):
    """Scenes `start` to `stop - 1` of `seed`, for one process."""

    source: Source
    seed: int
    start: int
    stop: int
    max_attempts: int


class Failed(NamedTuple):
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


def failed(error: ScenicError, printed: list[str]) -> Failed:
    """The error as a record; attributes that cannot be sent are described in words."""
    attributes: dict[str, object] = {name: value if _can_be_sent(value) else RuntimeError(repr(value)) for name, value in vars(error).items()}
    return Failed(type(error), attributes, tuple(printed))


def _can_be_sent(value: object) -> bool:
    try:
        pickle.loads(pickle.dumps(value))
    except Exception:  # whatever a foreign object does when it is pickled, it then cannot be sent
        return False
    return True


def work(job: Job) -> list[Drawn | Failed]:
    """The scenes of a job; a program's error is the last."""
    return list(draw_here(drawing_of(job.source), job))


def draw_here(drawing: Drawing, job: Job, on_attempt: Listener | None = None) -> Generator[Drawn | Failed]:
    """The scenes of a job, in this process; a program's error is the last."""
    printed: list[str] = []
    for index in range(job.start, job.stop):
        try:
            yield drawing.draw(job.seed, index, job.max_attempts, printed, on_attempt)
        except ScenicError as error:
            yield failed(error, printed)
            return


def end_with_parent() -> None:
    """Let this process end when the one that started it does, however that ends."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def draw_in_processes(job: Job, count: int) -> Generator[Drawn | Failed]:
    """The scenes of a job, drawn by `count` processes."""
    chunk = max(1, min(LARGEST_CHUNK, (job.stop - job.start) // (4 * count)))
    jobs = (job._replace(start=start, stop=min(start + chunk, job.stop)) for start in range(job.start, job.stop, chunk))
    pool = ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"), initializer=end_with_parent)
    waiting: deque[Future[list[Drawn | Failed]]] = deque()
    finished = False
    try:
        for next_job in jobs:
            with uninterrupted():  # the process that this may start inherits the mask: only this one answers Ctrl-C
                waiting.append(pool.submit(work, next_job))
            if len(waiting) >= 3 * count:
                yield from waiting.popleft().result()
        while waiting:
            yield from waiting.popleft().result()
        finished = True
    except BrokenProcessPool:
        raise InternalError("a worker process ended without an answer", hint="was there enough memory? try fewer --workers") from None
    finally:
        pool.shutdown(wait=finished, cancel_futures=True)
        if not finished:
            for process in multiprocessing.active_children():
                process.terminate()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Ctrl-C inside has its effect afterwards, where the system can do that."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
