"""Simulates with this package, in a process of its own: one program by one backend, for as long as is asked for.

The process answers as `own_sampler` does, with time steps in place of scenes. What the scenes take is taken away: that of a simulation without time
steps, which has the same scene.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict, dataclass

from ..api import Scenario, load
from ..simulators.loop import Failed
from .own_sampler import Sample, answer_sample_requests
from .released_sampler import peak


@dataclass(frozen=True, slots=True)
class DrivingTask:
    """The program that a process simulates in the kinematic simulator, its backend ("compiled" or "interpreter") and its time steps."""

    program: str
    backend: str
    steps: int
    trust: bool = False
    seed: int = 0

    def text(self) -> str:
        """The task as an argument of a process."""
        return json.dumps(asdict(self))


class Driver:
    """Simulates for some seconds at a time, each time other scenes."""

    def __init__(self, scenario: Scenario, task: DrivingTask) -> None:
        self.scenario, self.task = scenario, task
        self.next = 0

    def simulate(self, steps: int) -> tuple[int, float]:
        """The next simulation: how many time steps passed in it, and in those that were rejected before it, and how many seconds it took."""
        failed: list[Failed] = []
        begun = time.process_time()
        run = self.scenario.simulate("kinematic", steps, self.task.seed, self.next, backend=self.task.backend, on_failed=failed.append)  # type: ignore[arg-type]
        took = time.process_time() - begun
        return len(run.simulation.moments) - 1 + sum(one.step or 0 for one in failed), took

    def sample(self, seconds: float) -> dict[str, float]:
        """The time steps ("scenes") simulated in about `seconds` seconds, the seconds that they took, and the peak memory in bytes."""
        passed, used = 0, 0.0
        while not passed or used < seconds:
            _, scene = self.simulate(0)
            steps, took = self.simulate(self.task.steps)
            self.next += 1
            passed, used = passed + steps, used + max(0.0, took - scene)
        return {"scenes": passed, "seconds": max(used, 1e-9), "peak": peak()}


def ready(task: DrivingTask) -> tuple[dict[str, object], Sample]:
    """The seconds of loading and compiling a program, and the function that simulates it. Raises the program's errors."""
    begun = time.process_time()
    driver = Driver(load(task.program, trust=task.trust), task)
    driver.simulate(min(task.steps, 5))
    return {"prepare": time.process_time() - begun}, driver.sample


def main() -> None:
    """The process; the task is its argument."""
    task = DrivingTask(**json.loads(sys.argv[1]))
    answer_sample_requests(lambda: ready(task))
