"""Drawing scenes many at a time: what the batch backend gives for a job, as lines or as columns of a table."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Generator, Iterable, Iterator
from contextlib import AbstractContextManager
from typing import Literal, NamedTuple

import numpy as np

from ..data.scene_tables import Columns
from ..inference.batch import Block
from ..inference.batch.features import features_in
from ..inference.batch.jobs.failures import FailedDraw, record_failed_draw
from ..inference.batch.jobs.memory_files import Shelf, lay
from ..inference.batch.jobs.worker_pools import FIRST, Pace, Workers, block_of
from ..inference.comparison.scene_columns import FeatureTable
from ..semantics.machine.outcome import Requirement
from .program_source import Source
from .scene_sampler import Drawing, Job, Softness, drawing_of

Form = Literal["lines", "table", "features"]
MOST_LOOKED_AT = 500
"""For how many scenes the interpreter counts how often each soft requirement held."""
SMALL_PARTS = 4
"""The first jobs of each process, if there are few scenes."""


class Portion(NamedTuple):
    """Scenes `start` to `start + len(attempts) - 1`, as lines (some at a time, good until the next are asked for), as columns or as features, how
    often which requirement failed, and how long that took (seconds of a processor, so that other work of the machine does not count).

    `left` runs were left to the interpreter, and `doubtful` ones by torch to NumPy. `failed` is the error that ended the job early, at
    the scene behind the last.
    """

    start: int
    attempts: np.ndarray
    lines: Iterable[bytes | memoryview]
    columns: Columns | None
    stuck: Counter[Requirement]
    soft: tuple[Softness, ...]
    left: int
    seconds: float
    failed: FailedDraw | None
    features: FeatureTable | None = None
    doubtful: int = 0
    laid: int = 0
    """How many bytes of lines lie in the file that was lent for them."""


class PortionJob(NamedTuple):
    """A job and the form of its result; scenes before number `looked` are examined for soft requirements.

    About `ahead` more scenes will be asked for of each process. Lines are laid into the file `place`, if
    there is one.
    """

    job: Job
    form: Form
    looked: int
    ahead: int
    place: str | None = None


def draw_portion(drawing: Drawing, asked: PortionJob) -> Portion:
    """The scenes of a job, in this process."""
    begun = time.thread_time()
    job, batch = asked.job, drawing.batch
    block = block_of(batch, job.seed, job.start, job.stop, job.max_attempts, asked.ahead)
    lines = drawing.lines.of(block, job.seed, asked.ahead) if asked.form == "lines" else ()
    columns = drawing.tables.of(block, job.seed) if asked.form == "table" and len(block.attempts) else None
    features = features_in(batch.template, block) if asked.form == "features" else None
    soft = softness_of(drawing, block, job.seed, asked.looked) if asked.form != "features" and drawing.has_soft_requirements else ()
    ended = record_failed_draw(block.error, []) if block.error is not None else None
    seconds = time.thread_time() - begun
    return Portion(job.start, block.attempts + 1, lines, columns, block.stuck, soft, block.left, seconds, ended, features, block.doubtful)


def softness_of(drawing: Drawing, block: Block, seed: int, stop: int) -> tuple[Softness, ...]:
    """How often soft requirements held in the scenes of a block before scene `stop`."""
    looked = block.attempts[: max(0, stop - block.start)].tolist()
    return tuple(soft for place, attempt in enumerate(looked) for soft in drawing.softness(seed, block.start + place, attempt + 1, block))


def work_on_portion(asked: PortionJob) -> Portion:
    """The scenes of a job, in a process that is given nothing else."""
    portion = draw_portion(drawing_of(asked.job.source), asked)
    begun = time.thread_time()
    size = lay(asked.place, portion.lines) if asked.place is not None else None
    lines = () if size is not None else tuple(map(bytes, portion.lines))
    return portion._replace(lines=lines, laid=size or 0, seconds=portion.seconds + time.thread_time() - begun)


def portions(
    source: Source, job: Job, form: Form, workers: AbstractContextManager[Workers] | None, count: int = 1
) -> Generator[Portion]:
    """The scenes of a job, in order, from this process (`workers` None) or others, about `count` of them."""
    drawing = drawing_of(source)
    total = job.stop - job.start
    size = FIRST if workers is None else max(1, min(FIRST, total // (SMALL_PARTS * count)))
    pace = Pace(size, len(drawing.batch.template.objects))
    looked = job.start + MOST_LOOKED_AT
    parts = pace.parts(job.start, job.stop)
    asked = (PortionJob(job._replace(start=first, stop=stop), form, looked, (job.stop - stop) // count) for first, stop in parts)
    if workers is None:
        yield from pace_portions((draw_portion(drawing, part) for part in asked), pace)
        return
    with workers as several, Shelf() as shelf:
        if several.here and form == "lines":
            asked = (part._replace(place=shelf.lend()) for part in asked)
        for portion in pace_portions(several.draw(work_on_portion, asked), pace):
            yield portion._replace(lines=shelf.read(portion.laid)) if portion.laid else portion
            shelf.put_back()


def pace_portions(found: Iterator[Portion], pace: Pace) -> Iterator[Portion]:
    """The portions, those still to come being as large as these were quick."""
    for portion in found:
        pace.took(len(portion.attempts), portion.seconds)
        yield portion
