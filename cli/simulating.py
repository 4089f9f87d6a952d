"""What `scenic-ref simulate` does once its options are understood."""

from __future__ import annotations

import sys
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from ..inference.simulation import SampledRun
from ..interpreter.recordings import to_line
from ..interpreter.simulating import Failed
from ..semantics.errors import InternalError, UsageError
from ..semantics.outcome import Requirement
from ..simulators import by_name
from .drawing import Drawn, drawing_of
from .files import check_place
from .options import Source
from .outputs import Output, open_output
from .production import rehearse
from .progress import Progress
from .replaying import MOST, write_page
from .reports import requirement_lines
from .session import Session, tell


class Request(NamedTuple):
    """Simulations `start` to `stop - 1`, in which simulator, and where they go."""

    start: int
    stop: int
    seed: int
    max_attempts: int
    simulator: str
    steps: int
    timestep: float | None
    output: str | None
    html: str | None = None


def produce_simulations(source: Source, request: Request, session: Session) -> None:
    """Run the simulations, write or show them, say how it went. Raises the errors of the program and simulator, `AttemptsExhausted`, `UsageError`."""
    if request.output is not None and request.output != "-":
        check_place(request.output, {"the program itself": source.file})
        if request.output.endswith((".parquet", ".npz")):
            raise UsageError("simulations are written as JSON Lines", hint="-o PATH.jsonl")
    if request.html is not None:
        check_place(request.html, {"the program itself": source.file, "the output": request.output})
    simulator = by_name(request.simulator, request.timestep)
    drawing = drawing_of(source)
    rehearse(drawing)
    shown = request.output is None and sys.stdout.isatty()
    begun = time.perf_counter()
    stuck: Counter[Failed] = Counter()
    attempts = 0
    kept: list[SampledRun] = []
    with ExitStack() as stack:
        output = None if shown else stack.enter_context(open_output(request.output, resume=False))
        progress = stack.enter_context(Progress(request.stop - request.start, what="simulations"))
        for index in range(request.start, request.stop):
            run = drawing.scenario.simulate(
                simulator, request.steps, request.seed, index, max_attempts=request.max_attempts, on_attempt=progress.stuck,
            )  # fmt: skip
            write(output, run, index)
            if request.html is not None and len(kept) < MOST:
                kept.append(run)
            progress.drawn(run.attempts)
            stuck += run.stuck
            attempts += run.attempts
        if output is not None:
            output.finish()
    if request.html is not None:
        write_page(request.html, Path(source.file).name, kept)
    for line in summary(request, attempts, stuck, time.perf_counter() - begun, session):
        tell(line)


def write(output: Output | None, run: SampledRun, index: int) -> None:
    """A simulation as a line of JSON; on a terminal, how it went. Raises `InternalError` for numbers that JSON does not have."""
    if output is None:
        simulation = run.simulation
        steps = len(simulation.moments) - 1
        print(f"simulation {index}: {simulation.result} after {steps:,} time steps ({steps * simulation.timestep:g} s): {simulation.reason}")
        return
    try:
        line = to_line(run.simulation, run.attempts)
    except ValueError as problem:
        raise InternalError(f"simulation {index} cannot be written: {problem}") from None
    output.write(Drawn(index, run.attempts, line, Counter(), (), ()))


def summary(request: Request, attempts: int, stuck: Counter[Failed], seconds: float, session: Session) -> list[str]:
    """The lines that follow: how many, and the requirements that rejected most, with the time steps in which they failed."""
    count = request.stop - request.start
    runs = "1 simulation" if count == 1 else f"{count:,} simulations"
    tries = "1 attempt" if attempts == 1 else f"{attempts:,} attempts"
    lines = [f"{runs} of seed {request.seed} in {tries}, {seconds:.1f} s"]
    if stuck:
        lines += requirement_lines(when(stuck).most_common(), session.texts, limit=5)
    return lines


def when(stuck: Counter[Failed]) -> Counter[Requirement]:
    """The requirements that failed, each with the time steps in which it did."""
    steps: dict[Requirement, list[int]] = {}
    counts: Counter[Requirement] = Counter()
    for failed, often in stuck.items():
        counts[failed.requirement] += often
        if failed.step is not None:
            steps.setdefault(failed.requirement, []).append(failed.step)
    return Counter({r._replace(text=f"{r.text} ({told(steps.get(r, []))})"): often for r, often in counts.items()})


def told(steps: list[int]) -> str:
    """Time steps in words."""
    if not steps:
        return "in the scene"
    return f"in time step {steps[0]}" if len(set(steps)) == 1 else f"in time steps {min(steps)} to {max(steps)}"
