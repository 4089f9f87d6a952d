"""What `scenic-ref simulate` does with its options."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from ..formats.recordings import to_line
from ..inference.simulation import SampledRun
from ..semantics.kernel.driving import Witness
from ..semantics.kernel.errors import InternalError
from ..semantics.kernel.outcome import Requirement
from ..simulators import by_name
from ..simulators.simulating import Failed
from .drawing import Drawing, DrawnScene, drawing_of, listen
from .files import LINES, check_ending, check_place
from .options import Source
from .outputs import Output, open_output
from .pages import MOST, write_movie, write_page
from .production import rehearse
from .progress import Progress
from .replay import Replays, check_recordings
from .reports import requirement_lines
from .session import Session, escaped, tell


class SimulationRequest(NamedTuple):
    """Simulations `start` to `stop - 1`, or those of the file `replay`, in which simulator, and where they go."""

    start: int
    stop: int
    seed: int
    max_attempts: int
    simulator: str
    steps: int
    timestep: float | None
    output: str | None
    html: str | None = None
    gif: str | None = None
    replay: str | None = None


@dataclass
class SimulationTally:
    """What is kept of the simulations: how many there were, and those that a page or an animation shows."""

    count: int = 0
    attempts: int = 0
    stuck: Counter[Failed] = field(default_factory=Counter)
    kept: list[SampledRun] = field(default_factory=list)

    def failed(self, how: Failed) -> None:
        """An attempt was rejected."""
        self.attempts += 1
        self.stuck[how] += 1


def produce_simulations(source: Source, request: SimulationRequest, session: Session) -> None:
    """Run or replay the simulations, write or show them, report on them.

    Raises the errors of the program and simulator, `AttemptsExhausted`, `UsageError`.
    """
    check_places(source, request)
    by_name(request.simulator, request.timestep)
    total = request.stop - request.start if request.replay is None else check_recordings(request.replay)
    drawing = drawing_of(source)
    rehearse(drawing)
    replays = None if request.replay is None else Replays(request.replay, drawing.scenario, request.simulator, request.timestep)
    begun = time.perf_counter()
    tally = SimulationTally()
    interrupted: KeyboardInterrupt | None = None
    with ExitStack() as stack:
        output = None if shown_only(request) else stack.enter_context(open_output(request.output, resume=False))
        progress = stack.enter_context(Progress(total, what="simulations"))
        try:
            for run in simulations(drawing, request, tally, progress) if replays is None else replays:
                write(output, run)
                tally.count += 1
                if len(tally.kept) < (MOST if request.html is not None else 1 if request.gif is not None else 0):
                    tally.kept.append(run)
                session.finished = told_so_far(tally.count, output)
                progress.drawn(run.attempts if replays is None else 0)
        except KeyboardInterrupt as stop:
            interrupted = stop
        if output is not None:
            output.finish()
    show(source, request, tally, replays, time.perf_counter() - begun, session)
    if interrupted is not None:
        raise interrupted


def show(source: Source, request: SimulationRequest, tally: SimulationTally, replays: Replays | None, seconds: float, session: Session) -> None:
    """Make a page and an animation of the finished simulations, and report on all."""
    for line in replays.lines(seconds) if replays is not None else summary(request, tally, seconds, session):
        tell(line)
    if not tally.kept:
        return
    if request.html is not None:
        write_page(request.html, Path(source.file).name, tally.kept)
    if request.gif is not None:
        write_movie(request.gif, Path(source.file).name, tally.kept[0].simulation)
    if request.gif is not None and tally.count > 1:
        tell(f"{request.gif} shows the first simulation")


def check_places(source: Source, request: SimulationRequest) -> None:
    """Find wrong paths before the work begins. Raises `UsageError`."""
    read = {"the program itself": source.file, "the recording": request.replay}
    if request.output is not None and request.output != "-":
        check_place(request.output, read)
        check_ending("-o", request.output, "simulations", LINES)
    if request.html is not None:
        check_place(request.html, {**read, "the output": request.output})
        check_ending("--html", request.html, "pages", (".html", ".htm"))
    if request.gif is not None:
        check_place(request.gif, {**read, "the output": request.output, "the page": request.html})
        check_ending("--gif", request.gif, "animations", (".gif",))


def shown_only(request: SimulationRequest) -> bool:
    """Whether simulations are shown on a terminal, and not written as JSON."""
    return request.output is None and sys.stdout.isatty()


def told_so_far(count: int, output: Output | None) -> str:
    """What is said of the simulations that are finished when the rest is interrupted."""
    return f"{count:,} {'simulation was' if count == 1 else 'simulations were'} finished" + ("" if output is None else ", written as whole lines")


def simulations(drawing: Drawing, request: SimulationRequest, tally: SimulationTally, progress: Progress) -> Iterator[SampledRun]:
    """The simulations that are asked for, one after the other; attempts are counted as they are made.

    What the latest attempt at each printed goes to standard error, also if that ends with an error.
    """
    simulator = by_name(request.simulator, request.timestep)
    printed: list[str] = []

    def listening(attempt: int) -> Witness:
        printed.clear()
        return lambda outcome, drawn: listen(outcome, printed)

    for index in range(request.start, request.stop):
        try:
            run = drawing.scenario.simulate(
                simulator, request.steps, request.seed, index, max_attempts=request.max_attempts, on_attempt=progress.stuck,
                on_failed=tally.failed, witnessed=listening if drawing.prints else None,
            )  # fmt: skip
        finally:
            for text in printed:
                progress.say(text)
        tally.attempts += 1
        yield run


def write(output: Output | None, run: SampledRun) -> None:
    """A simulation as a line of JSON; on a terminal, how it went. Raises `InternalError` for numbers that JSON does not have."""
    index = run.simulation.scene.index
    if output is None:
        simulation = run.simulation
        steps = len(simulation.moments) - 1
        told = f"simulation {index}: {simulation.result} after {steps:,} time steps ({steps * simulation.timestep:g} s): {simulation.reason}"
        print(escaped(told))
        return
    try:
        line = to_line(run.simulation, run.attempts)
    except ValueError as problem:
        raise InternalError(f"simulation {index} cannot be written: {problem}") from None
    output.write(DrawnScene(index, run.attempts, line, Counter(), (), ()))


def summary(request: SimulationRequest, tally: SimulationTally, seconds: float, session: Session) -> list[str]:
    """The lines that follow: how many, and the requirements that rejected most, with the time steps in which they failed."""
    runs = "1 simulation" if tally.count == 1 else f"{tally.count:,} simulations"
    tries = "1 attempt" if tally.attempts == 1 else f"{tally.attempts:,} attempts"
    lines = [f"{runs} of seed {request.seed} in {tries}, {seconds:.1f} s"]
    if tally.stuck:
        lines += requirement_lines(when(tally.stuck).most_common(), session.texts, limit=5)
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
