"""Many scenes as jobs: how many to draw at a time, by whom (this process, several, a cluster), and their results in order.

A scene depends neither on the job that it is drawn in nor on who draws it, so that the sizes of jobs may follow the time that they take.
The only file that imports dask's distributed.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, Future, InvalidStateError, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import connection, resource_tracker
from multiprocessing.process import BaseProcess
from types import FrameType
from typing import TypeVar

from ....interpreter.runtime.optional_packages import missing_package_error
from ....semantics.store.errors import AttemptsExhausted, InternalError, UsageError
from ...rejection import DEFAULT_ATTEMPTS, how_often, no_scene_error
from ..block_rejection import Batch, Block

Asked = TypeVar("Asked")
Given = TypeVar("Given")

SMALLEST, LARGEST = 16, 1 << 14
MOST_OBJECTS = 1 << 16
"""The most objects in all scenes of a job: their text is what takes memory."""
FIRST, GROWTH = 512, 4
QUICK, SLOW = 1.0, 4.0
"""Jobs that take fewer seconds of a processor are followed by larger ones, those that take more by smaller ones."""


# Sizes


class Pace:
    """How many scenes a job has: few at first, then as many as are drawn in a few seconds, so that results keep coming."""

    def __init__(self, size: int = FIRST, objects: int = 1) -> None:
        self.largest = max(1, min(LARGEST, MOST_OBJECTS // max(objects, 1)))
        self.size = max(1, min(size, self.largest))

    def parts(self, start: int, stop: int) -> Iterator[tuple[int, int]]:
        """The scenes from `start` to `stop - 1`, in order, as pairs of the first of a job and the one after its last."""
        while start < stop:
            end = min(start + self.size, stop)
            yield start, end
            start = end

    def took(self, scenes: int, seconds: float) -> None:
        """Learn how long a job took; one smaller than those that are made now says nothing."""
        if seconds < QUICK and scenes >= self.size:
            self.size = min(GROWTH * self.size, self.largest)
        elif seconds > SLOW and scenes <= self.size:
            self.size = max(self.size // 2, min(SMALLEST, self.size))


def block_of(batch: Batch, seed: int, start: int, stop: int, max_attempts: int = DEFAULT_ATTEMPTS, ahead: int = 0) -> Block:
    """Scenes `start` to `stop - 1`; where attempts are exhausted, the error tells of the attempts at that scene alone, as the interpreter's does."""
    block = batch.block(seed, start, stop, max_attempts=max_attempts, ahead=ahead)
    if not isinstance(block.error, AttemptsExhausted):
        return block
    index = block.start + len(block.attempts)
    alone = batch.block(seed, index, index + 1, max_attempts=max_attempts)
    worst, count = alone.stuck.most_common(1)[0]
    told = f"no scene in {max_attempts:,} attempts: {how_often(count, max_attempts)} this failed: {worst.text}"
    return block._replace(error=no_scene_error(told, max_attempts, alone.stuck, seldom=True))


def jobs(batch: Batch, n: int, seed: int, start: int, max_attempts: int) -> Generator[Block]:
    """Scenes `start` to `start + n - 1` by this process, in jobs, one after the other. Raises the error that ends one, after its block."""
    pace = Pace(objects=len(batch.template.objects))
    for first, stop in pace.parts(start, start + n):
        begun = time.thread_time()
        block = block_of(batch, seed, first, stop, max_attempts, start + n - stop)
        pace.took(stop - first, time.thread_time() - begun)
        yield block
        if block.error is not None:
            raise block.error


# Results


def run_jobs_in_order(
    pool: Executor, work: Callable[[Asked], Given], jobs: Iterable[Asked], most: int, unread: list[object] | None = None,
    look: Callable[[], object] = bool,
) -> Generator[Given]:  # fmt: skip
    """The results of the jobs, in order; at most `most` of them run at a time. Raises `InternalError` if a worker dies, and what `work` raises.

    `unread` gets the results that are there when no more are asked for; `look` is called once a second while one is waited for.
    """
    waiting: deque[Future[Given]] = deque()
    try:
        for job in jobs:
            with delay_interrupts():  # the process that this may start inherits the mask: only this one answers Ctrl-C
                waiting.append(pool.submit(work, job))
            if len(waiting) >= most:
                yield await_job_result(waiting.popleft(), look)
        while waiting:
            yield await_job_result(waiting.popleft(), look)
    except (BrokenProcessPool, CancelledError):
        raise InternalError("a worker process ended without an answer", hint="was there enough memory? try fewer --workers") from None
    finally:
        for future in waiting:
            if not future.cancel() and unread is not None and future.done() and future.exception() is None:
                unread.append(future.result())


def await_job_result(future: Future[Given], look: Callable[[], object]) -> Given:
    """The result of a job, once it is there; `look` is called once a second until then."""
    while not wait([future], LOOK).done:
        look()
    return future.result()


LOOK = 1.0


@dataclass(frozen=True)
class Workers:
    """The workers that do jobs, and how many they do at a time; `here` if all are processes of this machine.

    `unread` gets the results that are there when no more are asked for; `look` is called once a second while
    one is waited for.
    """

    pool: Executor
    count: int
    here: bool = False
    unread: list[object] | None = None
    look: Callable[[], object] = bool

    def draw(self, work: Callable[[Asked], Given], jobs: Iterable[Asked]) -> Generator[Given]:
        """The results of the jobs, in order."""
        return run_jobs_in_order(self.pool, work, jobs, 2 * self.count + 1, self.unread, self.look)


# Who does them


@contextmanager
def processes(count: int, unread: list[object] | None = None) -> Iterator[Workers]:
    """Processes of this machine; they end with this one, however it ends."""
    pool = ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"), initializer=end_with_parent)
    before = set(multiprocessing.active_children())
    finished = False
    started = set[BaseProcess]()

    def end_the_others() -> None:
        """End all processes if one has ended: where it did so while it sent a result, the pool would wait for the rest, and they for the pool."""
        started.update(set(multiprocessing.active_children()) - before)
        if any(process.exitcode is not None for process in started):
            for process in started:
                process.terminate()
            give_up_reading(getattr(pool, "_result_queue", None))

    try:
        yield Workers(pool, count, here=True, unread=unread, look=end_the_others)
        finished = True
    finally:
        results = getattr(pool, "_result_queue", None)
        if not finished:
            threading.excepthook = without_cancelled(threading.excepthook)
        pool.shutdown(wait=finished, cancel_futures=True)
        if not finished:
            for process in set(multiprocessing.active_children()) - before:
                process.terminate()
            give_up_reading(results)


def without_cancelled(before: Callable[[threading.ExceptHookArgs], object]) -> Callable[[threading.ExceptHookArgs], object]:
    """Report exceptions in threads, except that of a pool's thread whose jobs are already cancelled when its processes are ended."""

    def told(problem: threading.ExceptHookArgs) -> object:
        return None if problem.exc_type is InvalidStateError else before(problem)

    return told


def give_up_reading(results: object) -> None:
    """Keep a pool's thread from waiting for the rest of a result whose process was ended while it sent it: nobody else will write it."""
    writer = getattr(results, "_writer", None)
    if isinstance(writer, connection.Connection):
        writer.close()


@contextmanager
def cluster(address: str, count: int | None = None, unread: list[object] | None = None) -> Iterator[Workers]:
    """The workers of the Dask cluster at `address`, or for "local" of one that is started here, with `count` processes (None: one for each core).

    Raises `UsageError` if distributed is not installed or there is no cluster.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError as problem:
        raise missing_package_error("a cluster", "distributed", problem) from None
    if os.name == "posix":
        resource_tracker.ensure_running()  # begun later, it would take the mask off the thread that starts processes
    try:
        with delay_interrupts():  # a thread that starts processes is made here
            options = {"n_workers": count, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
            started = LocalCluster(**options) if address == "local" else None
            client = Client(started or address, timeout=10)
    except (OSError, ValueError) as error:
        raise UsageError(f"there is no cluster at {address}: {error}") from None
    try:
        at_once = sum(client.nthreads().values())  # type: ignore[union-attr]
        if not at_once:
            raise UsageError(f"the cluster at {address} has no workers")
        yield Workers(client.get_executor(pure=False), at_once, unread=unread)
    finally:
        client.close()
        if started is not None:
            started.close()


def end_with_parent() -> None:
    """Make this process end when the one that started it ends, however it does."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def delay_interrupts() -> Iterator[None]:
    """Delay Ctrl-C until afterwards, whichever thread the system tells of it; processes that are started meanwhile may not be told."""
    answer = signal.getsignal(signal.SIGINT)
    if not callable(answer) or threading.current_thread() is not threading.main_thread():
        with mask_interrupts():
            yield
        return
    came = list[FrameType | None]()
    signal.signal(signal.SIGINT, lambda _, frame: came.append(frame))
    try:
        with mask_interrupts():
            yield
    finally:
        signal.signal(signal.SIGINT, answer)
        if came:
            answer(signal.SIGINT, came[0])


@contextmanager
def mask_interrupts() -> Iterator[None]:
    """Keep Ctrl-C from this thread, and from processes that it starts, where the system can do that."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
