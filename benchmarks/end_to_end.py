"""`scenic-ref run` as a user starts it, with a file at its end: the seconds of the processor that it uses for each further scene.

Each measurement runs the command twice, for n and for 2 n scenes. What the second takes more is n scenes, drawn and written; the rest of the first is
the start, with what it compiles: n is so large that both runs do. The process answers as `own_sampler` does.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..interpreter.extras import is_installed
from ..scenario import load
from .contenders import MeasuredProgram, on_one_thread, python_that_runs
from .own_sampler import Skipped, serve

try:
    import resource
except ImportError:  # pragma: no cover (Windows)
    resource = None

FORMATS = ("jsonl", "npz", "parquet", "arrow", "csv")
NEED_ARROW = ("parquet", "arrow")
FIRST, LARGEST, GROWTH = 1_000, 1_024_000, 4
LEAST = 1e-9
"""Seconds that scenes take at least."""
COUNTED = 100
"""Scenes of which the numbers are counted."""
KNOWN, TWICE = 0.5, 2
"""Seconds of drawing on columns after which its pace is known; so many times as long as compiling may take, the smaller run would draw on columns."""

Cost = Callable[[int], float]
"""The seconds of the processor that a run of so many scenes takes."""


@dataclass(frozen=True, slots=True)
class RunToFile:
    """The command, with a file in this format."""

    format: str

    @property
    def name(self) -> str:
        """What tables call it."""
        return f"run to {self.format}"

    def command(self, program: MeasuredProgram, seed: int) -> list[str]:
        """Starts the process that starts the command."""
        task = WritingTask(program.path, self.format, program.trust, seed)
        return python_that_runs(__name__, json.dumps(asdict(task)))

    def environment(self) -> Mapping[str, str]:
        """The variables of its process."""
        return on_one_thread()


@dataclass(frozen=True, slots=True)
class WritingTask:
    """What a process measures."""

    program: str
    format: str
    trust: bool = False
    seed: int = 0


def run(task: WritingTask, count: int, folder: str) -> float:
    """The seconds of the processor that the command takes, with the processes that it starts. Raises `Skipped`."""
    path = Path(folder) / f"scenes.{task.format}"
    words = ["run", task.program, "-n", str(count), "--seed", str(task.seed), "-o", str(path), *(["--trust"] if task.trust else [])]
    before = os.times()
    command = python_that_runs(f"{__name__.rpartition('.benchmarks')[0]}.cli", *words)
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    after = os.times()
    path.unlink(missing_ok=True)
    if done.returncode:
        said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        raise Skipped(said[0][:300] if said else f"the command ended with {done.returncode}")
    return after.children_user + after.children_system - before.children_user - before.children_system


class TimedCommand:
    """Runs for n and 2 n scenes; n grows until n scenes take long enough, later only where the noise took more than they did."""

    def __init__(self, cost: Cost, compiled: Callable[[], int] = lambda: FIRST) -> None:
        self.cost = cost
        self.compiled = compiled
        self.count = FIRST
        self.growing = True

    def sample(self, seconds: float) -> dict[str, Any]:
        """What the further scenes took, at least `seconds` seconds if there is an end to it; from a second on, so many that both runs compile."""
        if self.growing and seconds >= 1:
            self.count = max(self.count, self.compiled())
        while True:
            once, twice = self.cost(self.count), self.cost(2 * self.count)
            took = twice - once
            if took >= (seconds if self.growing else LEAST) or self.count >= LARGEST:
                self.growing = False
                return {"scenes": self.count, "seconds": max(took, LEAST), "start": once - took, "peak": peak_of_children()}
            self.count *= GROWTH


def peak_of_children() -> int:
    """The most memory of any of the commands, in bytes; 0 where the system does not tell."""
    if resource is None:
        return 0
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def numbers_of(task: WritingTask) -> float:
    """The numbers, truth values included, in the rows of the table of a scene."""
    columns = load(task.program, trust=task.trust).sample_columns(COUNTED, task.seed)
    return sum(column.size for column in columns.values() if column.dtype.kind in "bif") / COUNTED


def compiled_from(task: WritingTask) -> int:
    """The scenes from which on a run of the program compiles what draws them; `FIRST` if it never does."""
    scenario = load(task.program, trust=task.trust)
    batch = None if scenario.not_lifted is not None or not is_installed("numba") else scenario.batch
    if batch is None:
        return FIRST
    batch.may_compile = False
    count = FIRST
    while batch.spent < KNOWN and count < LARGEST:
        batch.block(task.seed, 0, count)
        count *= 2
    return min(LARGEST, max(FIRST, math.ceil(TWICE * batch.compiling / batch.pace)))


def main() -> None:
    """The process; the task is its argument."""
    task = WritingTask(**json.loads(sys.argv[1]))
    with tempfile.TemporaryDirectory() as folder:
        serve(lambda: ({"numbers": numbers_of(task)}, TimedCommand(lambda count: run(task, count, folder), lambda: compiled_from(task)).sample))
