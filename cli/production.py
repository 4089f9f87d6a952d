"""What `scenic-ref run` does once its options are understood."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from ..semantics.errors import ScenicError, UsageError
from .drawing import Drawing, Drawn, drawing_of
from .files import check_place
from .options import Source
from .outputs import Earlier, open_output
from .progress import Progress
from .reports import Tally, summary
from .session import Session, tell
from .workers import Failed, Job, draw_here, draw_in_processes

MOST_PLOTTED = 16
FORMATS = ("png", "pdf", "svg")


class Request(NamedTuple):
    """Which scenes to draw, and what to do with them."""

    start: int
    stop: int
    seed: int
    max_attempts: int
    output: str | None
    plot: str | None
    workers: int
    resume: bool


def produce(source: Source, request: Request, session: Session) -> None:
    """Draw the scenes, write them, show how it went. Raises the program's errors, `AttemptsExhausted` and `UsageError`."""
    check_paths(source, request)
    drawing = drawing_of(source)
    rehearse(drawing)
    begun = time.perf_counter()
    tally = Tally()
    with ExitStack() as stack:
        output = open_output(request.output, resume=request.resume)
        stack.push(output)
        earlier = output.earlier(request.seed) if request.resume else ()
        check_earlier(drawing, request, earlier)
        start = max(request.start, len(earlier))
        job = Job(source, request.seed, start, max(start, request.stop), request.max_attempts)
        progress = stack.enter_context(Progress(request.stop - request.start, start - request.start))
        scenes = scenes_of(drawing, job, request.workers, progress)
        stack.callback(scenes.close)
        known = [(e.index, e.attempts) for e in earlier]
        for drawn in accepted(scenes, progress):
            output.write(drawn)
            tally.add(drawn)
            progress.drawn(drawn.attempts)
            if len(known) <= MOST_PLOTTED:
                known.append((drawn.index, drawn.attempts))
        output.finish()
    if earlier:
        tell(f"{len(earlier):,} scenes were there already")
    for line in summary(tally, request.seed, time.perf_counter() - begun, session.texts):
        tell(line)
    if drawing.about_time:
        tell(f"note: conditions over time are not checked, since dynamics do not run yet: {', '.join(drawing.about_time)}")
    if request.plot is not None:
        plot(drawing, request, known[: request.stop])


def rehearse(drawing: Drawing) -> None:
    """Raise the program's error, if it has one, before anything is written; what it printed before comes first."""
    printed: list[str] = []
    try:
        drawing.rehearse(printed)
    except ScenicError:
        for text in printed:
            tell(text)
        raise


def scenes_of(drawing: Drawing, job: Job, workers: int, progress: Progress) -> Generator[Drawn | Failed]:
    """The scenes, from this process or from several."""
    if workers == 1 or job.stop - job.start <= 1:
        return draw_here(drawing, job, progress.stuck)
    return draw_in_processes(job, min(workers, job.stop - job.start))


def accepted(scenes: Iterator[Drawn | Failed], progress: Progress) -> Iterator[Drawn]:
    """The scenes, what each printed being told. Raises the error that ends them."""
    for drawn in scenes:
        for text in drawn.printed:
            progress.say(text)
        if isinstance(drawn, Failed):
            raise drawn.error
        yield drawn


def check_paths(source: Source, request: Request) -> None:
    """Find wrong paths before the work begins. Raises `UsageError`."""
    if request.resume and (request.output is None or request.output == "-"):
        raise UsageError("--resume needs the file to go on with: -o PATH")
    if request.resume and request.start:
        raise UsageError("--resume goes on with all scenes, so it cannot be combined with --scene")
    for path in (request.output, request.plot):
        if path is None or path == "-":
            continue
        check_place(path, {"the program itself": source.file})
    if request.plot is not None and Path(request.plot).suffix[1:].lower() not in FORMATS:
        raise UsageError(f"--plot {request.plot}: pictures are written as .png, .pdf or .svg")


def check_earlier(drawing: Drawing, request: Request, earlier: tuple[Earlier, ...]) -> None:
    """The last scene that is there must be the one that this program gives. Raises `UsageError`."""
    if not earlier:
        return
    last = earlier[-1]
    again = drawing.again(request.seed, last.index, last.attempts)
    if again is None or again.to_line() != last.line:
        raise UsageError(
            f"{request.output} cannot be resumed: its scene {last.index} is not the one that this program and these options give",
            hint="write to another file, or leave out --resume to overwrite this one",
        )


def plot(drawing: Drawing, request: Request, known: list[tuple[int, int]]) -> None:
    """Draw the first scenes into one picture, each from the attempt that is known to give it."""
    from ..interpreter.pictures import save_picture

    assert request.plot is not None
    shown = [drawing.again(request.seed, index, attempts) for index, attempts in known[:MOST_PLOTTED]]
    if len(known) > MOST_PLOTTED:
        tell(f"the picture shows the first {MOST_PLOTTED} scenes")
    try:
        save_picture([scene for scene in shown if scene is not None], request.plot)
    except OSError as error:
        raise UsageError(f"{request.plot} cannot be written: {error.strerror or error}") from None


