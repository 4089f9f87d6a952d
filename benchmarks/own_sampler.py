"""Draws scenes with this package, in a process of its own: one program by one backend, for as long as is asked for.

The process prints {"prepare": seconds, ...} once the program is ready, or {"skipped": why}; then it answers each line of standard input, a number of
seconds, by {"scenes": ..., "attempts": ..., "seconds": ..., "peak": bytes}, as `released_sampler` does for a released implementation.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from ..api import Scenario, load
from ..inference.batch import Batch
from ..inference.batch.jobs.worker_pools import GROWTH, LARGEST, QUICK
from ..semantics.store.errors import ScenicError
from .released_sampler import peak

SMALLEST = 256

Sample = Callable[[float], dict[str, Any]]
"""Takes seconds of the processor; draws for so long, and gives what it drew."""
Draw = Callable[[int, int], tuple[int, int]]
"""Takes the number of the first scene and a count; draws the scenes, and gives how many it drew, in how many attempts."""


@dataclass(frozen=True, slots=True)
class SamplingTask:
    """The task of a process that draws: a program, by "interpreter", "numpy", "numba" or "torch", with or
    without pruning.
    """

    program: str
    backend: str
    prune: bool = False
    trust: bool = False
    seed: int = 0

    def text(self) -> str:
        """The task as an argument of a process."""
        return json.dumps(asdict(self))


class Skipped(Exception):
    """A program cannot be drawn by this backend; the text says why."""


def one_by_one(scenario: Scenario, seed: int) -> Draw:
    """Return the function that draws scenes with the interpreter, one by one."""

    def draw(start: int, count: int) -> tuple[int, int]:
        return count, sum(scenario.sampled(seed, index).scene.attempts for index in range(start, start + count))

    return draw


def by_blocks(batch: Batch, seed: int) -> Draw:
    """The batch backend, without making scenes of its columns."""

    def draw(start: int, count: int) -> tuple[int, int]:
        block = batch.block(seed, start, start + count)
        if block.error is not None:
            raise block.error
        return count, int(block.attempts.sum()) + count

    return draw


def prepare(task: SamplingTask) -> tuple[Draw, dict[str, float]]:
    """The program ready to be drawn, and the seconds that its parts took. Raises `Skipped`, and the program's errors."""
    times = [time.process_time()]
    scenario = load(task.program, trust=task.trust)
    scenario.rehearse()
    times.append(time.process_time())
    if task.prune:
        scenario = scenario.pruned()
    times.append(time.process_time())
    if task.backend == "interpreter":
        return one_by_one(scenario, task.seed), seconds_by_part(times, "load", "prune")
    batch = scenario.batch
    times.append(time.process_time())
    if batch is None:
        raise Skipped(f"the batch backend cannot draw from this program: {scenario.not_lifted}")
    if task.backend == "numba":
        if not batch.compile():
            raise Skipped(batch.not_compiled)
    else:
        batch.may_compile = False
    if task.backend == "torch":
        batch.use_tensors("cpu")
    draw = by_blocks(batch, task.seed)
    draw(0, 1)
    times.append(time.process_time())
    return draw, seconds_by_part(times, "load", "prune", "trace", "compile" if task.backend == "numba" else "first")


def seconds_by_part(times: list[float], *names: str) -> dict[str, float]:
    """The seconds of each part between points in time."""
    return {name: after - before for name, before, after in zip(names, times, times[1:])}


class TimedSampler:
    """Draws for some seconds at a time, each time other scenes; blocks grow until they take long enough."""

    def __init__(self, draw: Draw, blocks: bool) -> None:
        self.draw = draw
        self.size = SMALLEST if blocks else 1
        self.growing = blocks
        self.next = 1

    def block(self) -> tuple[int, int, float]:
        """The next block: its scenes, attempts and seconds."""
        begun = time.process_time()
        scenes, attempts = self.draw(self.next, self.size)
        self.next += self.size
        return scenes, attempts, time.process_time() - begun

    def warm_up(self) -> None:
        """Find the size of the blocks."""
        while self.growing and self.size < LARGEST and self.block()[2] < QUICK:
            self.size *= GROWTH
        self.growing = False

    def sample(self, seconds: float) -> dict[str, float]:
        """Draw for about `seconds` seconds, and return the numbers of scenes and attempts."""
        self.warm_up()
        scenes = attempts = 0
        used = 0.0
        while not scenes or used < seconds:
            more, tried, took = self.block()
            scenes, attempts, used = scenes + more, attempts + tried, used + took
        return {"scenes": scenes, "attempts": attempts, "seconds": used, "block": self.size, "peak": peak()}


def ready(task: SamplingTask) -> tuple[dict[str, object], Sample]:
    """Return the cost of preparing, and what draws. Raises `Skipped`, and the program's errors."""
    draw, times = prepare(task)
    return {"prepare": sum(times.values()), "parts": times}, TimedSampler(draw, task.backend != "interpreter").sample


def answer_sample_requests(begin: Callable[[], tuple[dict[str, object], Sample]]) -> None:
    """Say that it is ready, then answer the lines of standard input; or why it is skipped."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the program prints is not an answer

    def say(answer: object) -> None:
        print(json.dumps(answer), file=out, flush=True)

    try:
        prepared, sample = begin()
        say(prepared)
        for line in sys.stdin:
            say(sample(float(line)))
    except Skipped as reason:
        say({"skipped": str(reason)})
    except ScenicError as error:
        say({"skipped": f"{error.kind}: {error.message}"})


def main() -> None:
    """The process; the task is its argument."""
    task = SamplingTask(**json.loads(sys.argv[1]))
    answer_sample_requests(lambda: ready(task))
