"""The work of `scenic-ref simulate`."""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from collections.abc import Generator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from ..api.simulations import SimulationBackend
from ..pictures.notebook_views import count_phrase
from ..sampling.program_source import Source
from ..sampling.scene_sampler import Drawing, DrawnScene, drawing_of
from ..sampling.simulation_sampler import (
    Listeners,
    ReportedRun,
    SimulationJob,
    report_simulation,
    simulate_here,
    simulated_by,
)
from ..semantics.machine.outcome import Requirement
from ..semantics.store.errors import UsageError
from ..simulators import by_name
from ..simulators.loop import Failed
from ..simulators.protocol import Simulator
from .output_paths import LINES, check_ending, check_place
from .progress_bar import Progress
from .replay import Replays, check_recordings
from .replay_page import MOST, PageRun, write_movie, write_page
from .run_report import requirement_lines
from .scene_outputs import SIMULATIONS, Output, Resumed, open_output
from .scene_run import printed_first, rehearse, workers_of
from .session import Session, escape_controls, tell


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
    workers: int = 1
    backend: SimulationBackend = "compiled"
    resume: bool = False
    cluster: str | None = None


@dataclass
class SimulationTally:
    """The tally of simulations: their number, those that a page or an animation shows, and the reasons for
    which work was left to the machine.
    """

    count: int = 0
    attempts: int = 0
    stuck: Counter[Failed] = field(default_factory=Counter)
    kept: list[ReportedRun] = field(default_factory=list)
    parts: dict[str, None] = field(default_factory=dict)
    functions: dict[str, str] = field(default_factory=dict)
    wholes: Counter[str] = field(default_factory=Counter)
    in_functions: Counter[str] = field(default_factory=Counter)
    nanoseconds: int = 0

    def failed(self, how: Failed) -> None:
        """An attempt was rejected."""
        self.attempts += 1
        self.stuck[how] += 1


def produce_simulations(source: Source, request: SimulationRequest, session: Session) -> None:
    """Run or replay the simulations, write or show them, report on them.

    Raises the errors of the program and simulator, `AttemptsExhausted`, `UsageError`.
    """
    check_places(source, request)
    simulator = by_name(request.simulator, request.timestep)
    total = request.stop - request.start if request.replay is None else check_recordings(request.replay)
    drawing = drawing_of(source)
    rehearse(drawing)
    replays = None if request.replay is None else Replays(request.replay, drawing.scenario, request.simulator, request.timestep, simulator)
    begun = time.perf_counter()
    tally = SimulationTally()
    interrupted: KeyboardInterrupt | None = None
    with ExitStack() as stack:
        output = None if shown_only(request) else stack.enter_context(open_output(request.output, resume=request.resume, kind=SIMULATIONS))
        if output is not None and request.resume:
            earlier = output.earlier(request.seed)
            check_earlier(drawing, request, simulator, earlier)
            request = request._replace(start=min(earlier.count, request.stop))
            if earlier.count:
                tell(f"{'1 simulation was' if earlier.count == 1 else f'{earlier.count:,} simulations were'} there already")
            total = request.stop - request.start
        progress = stack.enter_context(Progress(total, what="simulations"))
        wanted = output is not None or request.html is not None
        found = simulations(
            source, drawing, simulator, request, tally, progress, wanted
        ) if replays is None else reported_replays(replays, request, wanted)
        stack.callback(found.close)
        try:
            for run in found:
                write(output, run)
                tally.count += 1
                tally.parts.update(dict.fromkeys(run.left.parts))
                tally.functions.update(run.left.functions)
                tally.wholes.update(run.left.wholes)
                tally.in_functions.update(run.left.in_functions)
                tally.nanoseconds += run.left.nanoseconds
                if len(tally.kept) < (MOST if request.html is not None else 1 if request.gif is not None else 0):
                    tally.kept.append(run)
                session.finished = told_so_far(tally.count, output)
                progress.drawn(run.attempts if replays is None else 0)
        except KeyboardInterrupt as stop:
            interrupted = stop
        if output is not None:
            output.finish()
    show_simulations(source, drawing, request, tally, replays, time.perf_counter() - begun, session)
    if interrupted is not None:
        raise interrupted
    if replays is not None:
        replays.check_any()


def show_simulations(
    source: Source, drawing: Drawing, request: SimulationRequest, tally: SimulationTally, replays: Replays | None, seconds: float, session: Session
) -> None:
    """Make a page and an animation of the finished simulations, and report on all."""
    for line in replays.lines(seconds) if replays is not None else summary(request, tally, seconds, session):
        tell(line)
    for line in left_to_machine(tally) if request.backend == "compiled" and replays is None else ():
        tell(line)
    if not tally.kept:
        return
    if request.html is not None:
        write_page(request.html, Path(source.file).name, [PageRun(json.loads(run.line), run.land) for run in tally.kept], drawing.scenario)
    if request.gif is not None:
        first = tally.kept[0].run or drawing.scenario.simulate(  # once more, if another process ran it
            by_name(request.simulator, request.timestep), request.steps, request.seed, request.start, max_attempts=request.max_attempts
        )
        write_movie(request.gif, Path(source.file).name, first.simulation)
    if request.gif is not None and tally.count > 1:
        tell(f"{request.gif} shows the first simulation")


def check_earlier(drawing: Drawing, request: SimulationRequest, simulator: Simulator, earlier: Resumed) -> None:
    """Check that the last simulation of a resumed file is the one that this program gives. Raises `UsageError`."""
    last = earlier.last
    if last is None:
        return
    run = drawing.scenario.simulate(
        simulator, request.steps, request.seed, last.index, max_attempts=request.max_attempts, backend=request.backend,
    )  # fmt: skip
    if report_simulation(run, True, shown=False).line != last.line:
        raise UsageError(
            f"{request.output} cannot be resumed: its simulation {last.index} is not the one that this program and these options give",
            hint="write to another file, or leave out --resume to overwrite this one",
        )


def check_places(source: Source, request: SimulationRequest) -> None:
    """Find wrong paths before the work begins. Raises `UsageError`."""
    if request.resume and (request.output is None or request.output == "-"):
        raise UsageError("--resume needs a file to continue: -o PATH")
    if request.resume and request.start:
        raise UsageError("--resume continues with all simulations, so it cannot be combined with --run")
    if request.resume and (request.html is not None or request.gif is not None):
        raise UsageError("a page or an animation shows what one command simulates: --html and --gif cannot be given with --resume")
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
    """Return the message about finished simulations when the rest is interrupted."""
    return f"{count:,} {'simulation was' if count == 1 else 'simulations were'} finished" + ("" if output is None else ", written as whole lines")


def simulations(
    source: Source, drawing: Drawing, simulator: Simulator, request: SimulationRequest, tally: SimulationTally, progress: Progress, wanted: bool
) -> Generator[ReportedRun]:
    """The simulations that are asked for, in order; attempts are counted as they are made, or when a process tells of them.

    What the latest attempt at each printed goes to standard error, also if that ends with an error.
    """
    job = SimulationJob(
        source, request.seed, request.start, request.start, request.stop, request.max_attempts, request.simulator, request.timestep, request.steps,
        wanted, MOST if request.html is not None else 0, request.backend,
    )  # fmt: skip
    workers = workers_of(request.workers, request.cluster, request.stop - request.start)
    found = (
        simulate_here(drawing, job, simulator, Listeners(progress.stuck, tally.failed)) if workers is None
        else simulated_by(workers, job, request.workers)
    )  # fmt: skip
    try:
        for run in printed_first(found, progress):
            tally.attempts += 1
            if workers is not None:
                tally.attempts += run.attempts - 1
                tally.stuck.update(run.stuck)
            yield run
    finally:
        found.close()


def reported_replays(replays: Replays, request: SimulationRequest, wanted: bool) -> Generator[ReportedRun]:
    """The replays. Raises `UsageError`, and the simulator's errors."""
    for number, run in enumerate(replays):
        yield report_simulation(run, wanted, shown=request.html is not None and number < MOST)


def write(output: Output | None, run: ReportedRun) -> None:
    """A simulation as a line of JSON; on a terminal, how it went."""
    if output is None:
        print(escape_controls(run.told))
        return
    output.write(DrawnScene(run.index, run.attempts, run.line, Counter(), (), ()))


def summary(request: SimulationRequest, tally: SimulationTally, seconds: float, session: Session) -> list[str]:
    """The lines that follow: how many, and the requirements that rejected most, with the time steps in which they failed."""
    runs = "1 simulation" if tally.count == 1 else f"{tally.count:,} simulations"
    tries = "1 attempt" if tally.attempts == 1 else f"{tally.attempts:,} attempts"
    lines = [f"{runs} of seed {request.seed} in {tries}, {seconds:.1f} s"]
    if tally.stuck:
        lines += requirement_lines(when(tally.stuck).most_common(), session.texts, limit=5)
    return lines


MOST_LEFT = 5
"""So many reasons are told."""


def left_to_machine(tally: SimulationTally) -> list[str]:
    """Return the lines that say which work was left to the machine, and why."""
    lines = [f"not compiled, so that the machine ran all of the behavior or monitor, more slowly: {reason}" for reason in tally.parts]
    for function, reason in tally.functions.items():
        share = tally.in_functions[function] / max(1, tally.nanoseconds)
        lines.append(f"not compiled, so that the machine ran the function {function}, in {share:.0%} of the time: {reason}")
    lines += [f"the machine ran {count_phrase(often, 'attempt')} from the beginning: {reason}" for reason, often in tally.wholes.most_common()]
    return lines[:MOST_LEFT] + ([f"... and {len(lines) - MOST_LEFT} more reasons"] if len(lines) > MOST_LEFT else [])


def when(stuck: Counter[Failed]) -> Counter[Requirement]:
    """The requirements that failed, each with the time steps in which it did."""
    steps: dict[Requirement, list[int]] = {}
    counts: Counter[Requirement] = Counter()
    for failed, often in stuck.items():
        counts[failed.requirement] += often
        if failed.step is not None:
            steps.setdefault(failed.requirement, []).append(failed.step)
    return Counter({r._replace(text=f"{r.text} ({time_steps_in_words(steps.get(r, []))})"): often for r, often in counts.items()})


def time_steps_in_words(steps: list[int]) -> str:
    """Time steps in words."""
    if not steps:
        return "in the scene"
    return f"in time step {steps[0]}" if len(set(steps)) == 1 else f"in time steps {min(steps)} to {max(steps)}"
