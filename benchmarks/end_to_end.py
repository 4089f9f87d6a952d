"""`scenic-ref run` as a user starts it, with a file at its end: the seconds of the processor that it uses for each further scene.

One process answers the command again and again, which keeps the program between them: the first run loads it, and compiles what draws its scenes;
what the later ones take is scenes, drawn and written. The process that measures answers as `own_sampler` does.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

from ..api import load
from .implementations import MeasuredProgram, on_one_thread, python_that_runs
from .own_sampler import Skipped, answer_sample_requests
from .processes import end

FORMATS = ("jsonl", "npz", "parquet", "arrow", "csv")
NEED_ARROW = ("parquet", "arrow")
FEWEST, FIRST, LARGEST, GROWTH = 10, 1_000, 1_024_000, 4
COUNTED = 100
"""Scenes of which the numbers are counted."""
AGAIN = """
import json, sys, time
sys.path[:] = {path!r}
from {package}.benchmarks.released_sampler import peak
from {package}.cli import run_command_line
from {package}.inference.batch.block_rejection import Batch
from {package}.inference.batch.jobs import scene_lines as lines
Batch.compiling = lines.COMPILE = lines.PACE_KNOWN = 0.0
draw, drawing = Batch.block, 0.0
def timed(*given, **named):
    global drawing
    begun = time.process_time()
    try:
        return draw(*given, **named)
    finally:
        drawing += time.process_time() - begun
Batch.block = timed
for line in sys.stdin:
    begun, drawing = time.process_time(), 0.0
    code = run_command_line(json.loads(line))
    print(json.dumps([code, time.process_time() - begun, drawing, peak()]), flush=True)
"""
"""Answers command lines, each a list on a line of its own; what can be compiled is compiled at once."""


class RunCost(NamedTuple):
    """The seconds of the processor that a run takes, those of them in which blocks are drawn, and the most memory of its process so far, in bytes."""

    seconds: float
    drawing: float
    memory: int


@dataclass(frozen=True, slots=True)
class RunToFile:
    """The command, with a file in this format."""

    format: str

    @property
    def name(self) -> str:
        """The name in tables."""
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
    """The task that a process measures."""

    program: str
    format: str
    trust: bool = False
    seed: int = 0


class Commands:
    """A process that answers the command for a task, with a file in `folder`; used in a `with`."""

    def __init__(self, task: WritingTask, folder: str) -> None:
        self.task = task
        self.path = Path(folder) / f"scenes.{task.format}"
        self.errors = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115 (closed with the process)
        script = AGAIN.format(path=sys.path, package=__name__.rpartition(".benchmarks")[0])
        command = [sys.executable, "-c", script]
        self.running = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, text=True)

    def __enter__(self) -> Commands:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        end(self.running, self.errors)

    def cost(self, count: int) -> RunCost:
        """Return the cost of a run of `count` scenes. Raises `Skipped`."""
        task = self.task
        words = ["run", task.program, "-n", str(count), "--seed", str(task.seed), "-o", str(self.path), *(["--trust"] if task.trust else [])]
        assert self.running.stdin is not None and self.running.stdout is not None
        self.errors.seek(0)
        self.errors.truncate()
        with contextlib.suppress(BrokenPipeError):  # it ended, and says why
            print(json.dumps(words), file=self.running.stdin, flush=True)
        line = self.running.stdout.readline()
        self.path.unlink(missing_ok=True)
        code, seconds, drawing, memory = json.loads(line) if line else (self.running.wait(), 0.0, 0.0, 0)
        if code or not line:
            self.errors.seek(0)
            said = [text.strip() for text in self.errors if text.strip()]
            raise Skipped(said[0][:300] if said else f"the command ended with {code}")
        return RunCost(seconds, drawing, memory)


class TimedCommand:
    """Runs for n scenes, after one that compiles; n grows until they take long enough. What a run of `FEWEST` scenes takes does not count."""

    def __init__(self, cost: Callable[[int], RunCost]) -> None:
        self.cost = cost
        self.count = FIRST
        self.growing = True
        self.start = cost(FIRST).seconds
        self.least = min(cost(FEWEST), cost(FEWEST))

    def sample(self, seconds: float) -> dict[str, Any]:
        """Measure the time of further scenes, more and more of them until it is `seconds` seconds, if there
        is an end to it.
        """
        while True:
            took = self.cost(self.count)
            further, drawing = took.seconds - self.least.seconds, took.drawing - self.least.drawing
            if further >= seconds or self.count >= LARGEST or not self.growing:
                self.growing = False
                return {"scenes": self.count - FEWEST, "seconds": further, "drawing": drawing, "start": self.start, "peak": took.memory}
            self.count *= GROWTH


def numbers_of(task: WritingTask) -> float:
    """The numbers, truth values included, in the rows of the table of a scene."""
    columns = load(task.program, trust=task.trust).sample_columns(COUNTED, task.seed)
    return sum(column.size for column in columns.values() if column.dtype.kind in "bif") / COUNTED


def main() -> None:
    """The process; the task is its argument."""
    task = WritingTask(**json.loads(sys.argv[1]))
    with tempfile.TemporaryDirectory() as folder, Commands(task, folder) as commands:
        answer_sample_requests(lambda: ({"numbers": numbers_of(task)}, TimedCommand(commands.cost).sample))
