"""The work of `scenic-ref run`."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack
from typing import NamedTuple, Protocol, TypeVar

from ..api.engine_choice import choose_engine, is_slow
from ..data.table_files import SUFFIXES
from ..inference.batch.jobs.failures import FailedDraw
from ..inference.batch.jobs.worker_pools import Workers, cluster, processes
from ..inference.batch.numpy_evaluator import leavers
from ..inference.rejection import PATIENCE, InterruptedDraw, OutOfPatience
from ..inference.smc import guess
from ..pictures.notebook_views import count_phrase
from ..sampling.batch_sampler import Portion, portions
from ..sampling.program_source import Source
from ..sampling.scene_sampler import Drawing, DrawnScene, Job, draw_here, drawing_of, drawn_by
from ..semantics.store.errors import AttemptsExhausted, ScenicError, UsageError
from .diagnostic_formats import tell_notes, tell_warnings
from .error_messages import WORST
from .output_paths import LINES, PICTURES, check_ending, check_file, check_place
from .progress_bar import Progress, running_once
from .run_report import Tally, processor_seconds, requirement_lines, summary, write_report
from .scene_outputs import Output, Resumed, open_output, prepare_output
from .session import Session, tell

MOST_PLOTTED = 16
MOST_FINDINGS, MOST_PARTS = 16, 16
LOOKED, MOST_LEAVERS = 512, 3
"""Runs that are looked at for what leaves some to the interpreter, and how much of that is told."""


class SceneRequest(NamedTuple):
    """Which scenes to draw, with what, and what to do with them."""

    start: int
    stop: int
    seed: int
    max_attempts: int
    output: str | None
    plot: str | None
    workers: int
    resume: bool
    backend: str = "auto"
    cluster: str | None = None
    report: str | None = None
    stream: str = "jsonl"


def produce(source: Source, request: SceneRequest, session: Session) -> None:
    """Draw the scenes, write them, report on them. Raises the program's errors, `AttemptsExhausted` and `UsageError`."""
    check_paths(source, request)
    prepare_output(request.output, request.stream)
    drawing = drawing_of(source)
    rehearse(drawing)
    begun, used = time.perf_counter(), processor_seconds()
    tally, unread, output = Tally(), list[object](), None
    start = request.start
    try:
        with ExitStack() as stack:
            output = open_output(request.output, resume=request.resume, stream=request.stream)
            stack.push(output)
            earlier = output.earlier(request.seed) if request.resume else Resumed()
            check_earlier(drawing, request, earlier)
            start = max(request.start, earlier.count)
            job = Job(source, request.seed, start, max(start, request.stop), request.max_attempts)
            interpreted, hands_over = choose_engine(drawing.scenario, request.stop - request.start, request.backend)
            progress = stack.enter_context(Progress(request.stop - request.start, start - request.start, foresight=BatchForesight(drawing, request)))
            known = list(earlier.first)
            if interpreted is None:
                produce_by_batch(job, request, output, tally, progress, known, unread, stack)
            elif hands_over and not drawing.prints:
                interpreted = produce_few(drawing, job, request, output, tally, progress, known, unread, stack, interpreted)
            else:
                produce_one_by_one(drawing, job, request, output, tally, progress, known, unread, stack)
            output.finish()
    except KeyboardInterrupt as stop:
        if start > request.start:
            tell(f"{start - request.start:,} scenes were there already")
        for line in lines_so_far(drawing, tally, 0 if output is None else output.written, unread, start, stop, session):
            tell(line)
        raise
    if source.prune:
        for line in pruning_lines(drawing):
            tell(line)
    if request.start == request.stop:
        tell("no scenes were asked for, and none was drawn; the program has no error")
    if earlier.count:
        tell(f"{earlier.count:,} scenes were there already")
    for line in summary(tally, request.seed, time.perf_counter() - begun, session.texts, backend_lines(interpreted, tally, drawing)):
        tell(line)
    if drawing.about_time:
        tell(f"note: conditions over time are not checked in a scene (`scenic-ref simulate` does): {', '.join(drawing.about_time)}")
    if request.report is not None:
        seconds = None if request.cluster is not None else processor_seconds() - used
        write_report(request.report, drawing, tally, "batch" if interpreted is None else "interpreter", earlier.count, seconds)
    if request.plot is not None:
        plot(drawing, request, known[: request.stop])


def lines_so_far(
    drawing: Drawing, tally: Tally, written: int, unread: list[object], start: int, stop: KeyboardInterrupt, session: Session
) -> list[str]:
    """Return the report of an interrupted run from scene `start`, including the attempts at scenes that were
    not yet found.

    Of the scenes of the tally so many were `written`. `unread` is what other processes had found behind a
    scene that was still missing.
    """
    behind = tally_of(unread)
    stuck = tally.stuck + behind.stuck
    batch = drawing.scenario.batch if "_lifted" in vars(drawing.scenario) else None
    block = None if batch is None else batch.drawing
    if isinstance(stop, InterruptedDraw):
        stuck.update(stop.stuck)
    elif block is not None and block.start >= start + tally.scenes:
        stuck.update(block.stuck)
    head = f"{count_phrase(written, 'scene')} so far, and {count_phrase(stuck.total(), 'stuck attempt')}"
    if more := tally.scenes - written + behind.scenes:
        head += f"; {count_phrase(more, 'scene')} more were drawn, and not written"
    return [head, *(requirement_lines(stuck.most_common(), session.texts, limit=WORST) if stuck else [])]


def tally_of(results: Iterable[object]) -> Tally:
    """The statistics of what other processes gave: portions, or lists of scenes."""
    tally = Tally()
    for one in results:
        if isinstance(one, Portion):
            tally.add_portion(one)
        elif isinstance(one, list):
            for drawn in one:
                if isinstance(drawn, DrawnScene):
                    tally.add(drawn)
    return tally


class BatchForesight:
    """Estimates about a run from the graph of its program."""

    def __init__(self, drawing: Drawing, request: SceneRequest) -> None:
        self.drawing = drawing
        self.here = request.workers == 1 and request.cluster is None

    def runs(self) -> int:
        """Return the number of runs in the block that this process is drawing."""
        batch = self.drawing.scenario.batch if self.here and "_lifted" in vars(self.drawing.scenario) else None
        if batch is None or batch.drawing is None:
            return 0
        return batch.drawing.runs + (batch.compiled.runs if batch.compiled is not None else 0)

    def probability(self) -> float | None:
        """By splitting; of the program as it is, unpruned."""
        batch = None if self.drawing.scenario.not_lifted is not None else self.drawing.scenario.batch
        if batch is None:
            return None
        return guess(batch)


def backend_lines(interpreted: str | None, tally: Tally, drawing: Drawing) -> list[str]:
    """Which backend drew the scenes, and why not the batch backend, or not torch."""
    if interpreted is not None:
        return [f"drawn by the interpreter, {interpreted}"]
    runs = "1 run was" if tally.left == 1 else f"{tally.left:,} runs were"
    left = f"{runs} left to the interpreter"
    batch, device = drawing.batch, drawing.scenario.device
    if device is None:
        why = leavers(batch.graph, LOOKED).most_common(MOST_LEAVERS) if tally.left else []
        return [f"drawn by the batch backend; {left}", *(f"left at {one} (so are {often:,} of {LOOKED} other runs)" for one, often in why)]
    if batch.tensors is None:
        return [f"drawn by the batch backend, without torch: parts of a scene are drawn apart; {left}"]
    lines = [f"drawn by the batch backend with torch on {device}; {left}, {tally.doubtful:,} to NumPy, since rounding might decide"]
    reasons = batch.tensors.kit.reasons
    return [*lines, f"by NumPy, with all that it is made of, since torch does not have it: {', '.join(reasons)}"] if reasons else lines


def pruning_lines(drawing: Drawing) -> list[str]:
    """The report on pruning: for each object what it did or which assumption fails, and what was drawn apart."""
    pruning, batch = drawing.scenario.pruning, drawing.scenario.batch
    on = [str(f) for f in pruning.findings if f.after is not None]
    reasons: dict[tuple[str, str], list[str]] = {}
    for finding in pruning.findings:
        if finding.after is None:
            reasons.setdefault((finding.objects, finding.reason), []).append(finding.technique)
    off = [f"{objects}: {', '.join(techniques)} off: {reason}" for (objects, reason), techniques in reasons.items()]
    changed = pruning.pruned or drawing.scenario.in_parts
    head = "pruning was on: other scenes than without it, with the same distribution" if changed else "pruning found nothing to prune"
    parts = batch.parts if batch is not None else []
    shown = [*first_lines([*on, *off], MOST_FINDINGS), *first_lines(parts, MOST_PARTS)]
    if drawing.scenario.in_parts:
        shown.append("the attempts of a scene are the most of any part; stuck attempts are counted for each part")
    return [head, *(f"  {line}" for line in shown)]


def first_lines(lines: list[str], most: int) -> list[str]:
    """The first lines, and how many more there are."""
    return lines if len(lines) <= most else [*lines[: most - 1], f"... and {len(lines) - most + 1} more lines; `scenario.pruning` has all"]


def workers_of(count: int, address: str | None, results: int, unread: list[object] | None = None) -> AbstractContextManager[Workers] | None:
    """Who finds so many scenes or simulations, if not this process: the cluster at `address`, or `count` processes.

    `unread` gets what was found and not asked for.
    """
    if address is not None:
        return cluster(address, count if count > 1 else None, unread)
    return processes(min(count, results), unread) if count > 1 and results > 1 else None


def produce_by_batch(
    job: Job, request: SceneRequest, output: Output, tally: Tally, progress: Progress, known: list[tuple[int, int]], unread: list[object],
    stack: ExitStack,
) -> None:
    """Draw many scenes at a time; `known` gets the attempts of the first ones, `unread` what was drawn in vain. Raises the error that ends them."""
    workers = workers_of(request.workers, request.cluster, job.stop - job.start, unread)
    found = portions(job.source, job, output.form, workers, request.workers)
    stack.callback(found.close)
    for portion in found:
        tally.add_portion(portion)
        output.write_many(portion)
        progress.drawn(int(portion.attempts.sum()), len(portion.attempts))
        known += enumerate(portion.attempts[: max(0, MOST_PLOTTED + 1 - len(known))].tolist(), portion.start)
        if portion.failed is not None:
            raise portion.failed.error


def produce_one_by_one(
    drawing: Drawing, job: Job, request: SceneRequest, output: Output, tally: Tally, progress: Progress, known: list[tuple[int, int]],
    unread: list[object], stack: ExitStack, *, patient: bool = True,
) -> None:
    """Draw the scenes with the interpreter; `known` gets the attempts of the first ones.

    Raises the error that ends them, and `OutOfPatience` unless it is `patient` (or other processes draw them).
    """
    workers = workers_of(request.workers, request.cluster, job.stop - job.start, unread)
    scenes = draw_here(drawing, job, progress.stuck, patient=patient) if workers is None else drawn_by(workers, job, request.workers)
    stack.callback(scenes.close)
    for drawn in printed_first(scenes, progress):
        tally.add(drawn)
        output.write(drawn)
        progress.drawn(drawn.attempts)
        if len(known) <= MOST_PLOTTED:
            known.append((drawn.index, drawn.attempts))


def produce_few(
    drawing: Drawing, job: Job, request: SceneRequest, output: Output, tally: Tally, progress: Progress, known: list[tuple[int, int]],
    unread: list[object], stack: ExitStack, interpreted: str,
) -> str | None:
    """Write the scenes by the interpreter while each needs few attempts and little time, and those that are left by the batch backend, if it can.

    Return why the batch backend drew none of them, or None.
    """
    here = request.workers == 1 and request.cluster is None
    first = job if here else job._replace(max_attempts=min(job.max_attempts, PATIENCE))
    try:
        if here and job.stop - job.start > 2:
            begun = time.process_time()
            one = first._replace(stop=job.start + 1)
            produce_one_by_one(drawing, one, request, output, tally, progress, known, unread, stack, patient=False)
            slow = is_slow(time.process_time() - begun, tally.attempts, job.stop - job.start - 1)
            first = first._replace(start=job.start + 1)
            if slow and drawing.scenario.batch is not None:
                produce_by_batch(first, request, output, tally, progress, known, unread, stack)
                return None
        produce_one_by_one(drawing, first, request, output, tally, progress, known, unread, stack, patient=False)
        return interpreted
    except OutOfPatience:
        pass
    except AttemptsExhausted as error:
        if here or error.attempts < PATIENCE or job.max_attempts == PATIENCE:
            raise
    if drawing.scenario.impossible is not None:
        raise drawing.scenario.impossible
    rest = job._replace(start=job.start + tally.scenes)
    if drawing.scenario.not_lifted is not None:
        produce_one_by_one(drawing, rest, request, output, tally, progress, known, unread, stack)
        return interpreted
    produce_by_batch(rest, request, output, tally, progress, known, unread, stack)
    return None


def rehearse(drawing: Drawing) -> None:
    """Raise the program's error, if it has one, before anything is written; what it printed comes first. Then tell notes and warnings."""
    printed: list[str] = []
    try:
        with running_once(drawing.scenario.fuel):
            drawing.rehearse(printed)
    except ScenicError:
        for text in printed:
            tell(text)
        raise
    tell_notes(drawing.scenario)
    tell_warnings(drawing.scenario)


class Printing(Protocol):
    """A result with the texts that the program printed."""

    @property
    def printed(self) -> tuple[str, ...]:
        """The texts that the program printed."""
        ...


Shown = TypeVar("Shown", bound=Printing)


def printed_first(found: Iterable[Shown | FailedDraw], progress: Progress) -> Iterator[Shown]:
    """Scenes or simulations; what each printed goes to standard error. Raises the error that ends them."""
    for one in found:
        for text in one.printed:
            progress.say(text)
        if isinstance(one, FailedDraw):
            raise one.error
        yield one


def check_paths(source: Source, request: SceneRequest) -> None:
    """Find wrong paths before the work begins. Raises `UsageError`."""
    if request.resume and (request.output is None or request.output == "-"):
        raise UsageError("--resume needs a file to continue: -o PATH")
    if request.resume and request.start:
        raise UsageError("--resume continues with all scenes, so it cannot be combined with --scene")
    for path in (request.output, request.plot, request.report):
        if path is None or path == "-":
            continue
        check_place(path, {"the program itself": source.file})
    if request.output is not None:
        check_ending("-o", request.output, "scenes", (*LINES, *SUFFIXES))
    if request.plot is not None:
        check_ending("--plot", request.plot, "pictures", PICTURES)
    check_file("--report", request.report, "reports", (".json",))


def check_earlier(drawing: Drawing, request: SceneRequest, earlier: Resumed) -> None:
    """Check that the last scene of a resumed file is the one that this program gives. Raises `UsageError`."""
    last = earlier.last
    if last is None:
        return
    again = drawing.again(request.seed, last.index, last.attempts)
    if again is None or again.to_line() != last.line:
        raise UsageError(
            f"{request.output} cannot be resumed: its scene {last.index} is not the one that this program and these options give",
            hint="write to another file, or leave out --resume to overwrite this one",
        )


def plot(drawing: Drawing, request: SceneRequest, known: list[tuple[int, int]]) -> None:
    """Draw the first scenes into one picture, each from the attempt that is known to give it."""
    from ..pictures.scene_figures import save_picture

    assert request.plot is not None
    shown = [drawing.again(request.seed, index, attempts) for index, attempts in known[:MOST_PLOTTED]]
    if len(known) > MOST_PLOTTED:
        tell(f"the picture shows the first {MOST_PLOTTED} scenes")
    try:
        save_picture([scene for scene in shown if scene is not None], request.plot)
    except OSError as error:
        raise UsageError(f"{request.plot} cannot be written: {error.strerror or error}") from None
