"""The scenes that samples are compared with: drawn many at a time where that is possible, by one process or by several."""

from __future__ import annotations

import json
import shlex
from collections.abc import Generator, Iterator, Mapping, Sequence
from itertools import islice
from types import TracebackType

from ..inference.batch.jobs.failures import FailedDraw
from ..inference.batch.jobs.worker_pools import processes
from ..inference.comparison.rounding import DEFAULT_TOLERANCE
from ..inference.comparison.scene_columns import FeatureTable, features_table
from ..sampling.batch_sampler import portions
from ..sampling.program_source import DEFAULT_ATTEMPTS, DEFAULT_FUEL, Source
from ..sampling.scene_sampler import Drawing, DrawnScene, Job, draw_here, draw_in_processes, drawing_of
from .progress_bar import Progress

ONE_BY_ONE = 256
"""How many scenes that are drawn one by one become columns together."""


class References:
    """Draws the features of scenes 0 to `total` - 1 of a program, showing how far it is; used in a `with`.

    The processes stay between the blocks that are asked for, one after the other.
    """

    def __init__(self, source: Source, workers: int, total: int) -> None:
        self.source = source
        self.workers = workers
        self.total = total
        self.progress = Progress(total)
        self.tables: Generator[FeatureTable] | None = None
        self.left: list[FeatureTable] = []

    def __enter__(self) -> References:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.tables is not None:
            self.tables.close()
            self.progress.__exit__(kind, error, trace)

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[Mapping[str, object]]:
        """Scenes `start` to `start + n - 1` of `seed`, one by one. Raises the program's errors."""
        drawing = drawing_of(self.source)
        return (json.loads(drawn.line) for drawn in scenes_or_error(draw_here(drawing, Job(self.source, seed, start, start + n, DEFAULT_ATTEMPTS))))

    def feature_tables(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[FeatureTable]:
        """The features of scenes `start` to `start + n - 1` of `seed`, which must be the next ones. Raises the program's errors."""
        if self.tables is None:
            self.progress.__enter__()
            self.tables = self.drawn(Job(self.source, seed, start, self.total, DEFAULT_ATTEMPTS))
        while n > 0 and (table := self.left.pop() if self.left else next(self.tables, None)) is not None:
            if table.n > n:
                self.left = [table.rows(n, table.n)]
                table = table.rows(0, n)
            n -= table.n
            yield table

    def drawn(self, job: Job) -> Generator[FeatureTable]:
        """The features of the scenes of a job, some after the other. Raises the program's errors."""
        drawing = drawing_of(self.source)
        if drawing.scenario.impossible is not None:
            raise drawing.scenario.impossible
        if drawing.scenario.not_lifted is not None:
            yield from self.drawn_one_by_one(drawing, job)
            return
        workers = processes(self.workers) if self.workers > 1 else None
        found = portions(self.source, job, "features", workers, self.workers)
        try:
            for portion in found:
                self.progress.drawn(int(portion.attempts.sum()), len(portion.attempts))
                assert portion.features is not None
                yield portion.features
                if portion.failed is not None:
                    raise portion.failed.error
        finally:
            found.close()

    def drawn_one_by_one(self, drawing: Drawing, job: Job) -> Generator[FeatureTable]:
        """Draw the reference scenes with the interpreter."""
        found = draw_here(drawing, job, self.progress.stuck) if self.workers == 1 else draw_in_processes(job, self.workers)
        try:
            while several := list(islice(scenes_or_error(found, self.progress), ONE_BY_ONE)):
                yield features_table(json.loads(drawn.line) for drawn in several)
        finally:
            found.close()


def scenes_or_error(found: Iterator[DrawnScene | FailedDraw], progress: Progress | None = None) -> Iterator[DrawnScene]:
    """The scenes that are drawn. Raises the error that ends them."""
    for drawn in found:
        if isinstance(drawn, FailedDraw):
            raise drawn.error
        if progress is not None:
            progress.drawn(drawn.attempts)
        yield drawn


def replay_of(
    source: Source, samples: str, reference: str | None, alpha: float, detect_tv: float, seed: int, tolerance: float, ignore: Sequence[str],
    mapped: Mapping[str, str],
) -> str:  # fmt: skip
    """The command that makes the same comparison again."""
    words = ["scenic-ref", "check", source.file, "--samples", samples, "--alpha", f"{alpha:g}", "--detect-tv", f"{detect_tv:g}", "--seed", str(seed)]
    words += ["--tolerance", f"{tolerance:g}"] if tolerance != DEFAULT_TOLERANCE else []
    words += [w for feature in ignore for w in ("--ignore", feature)]
    words += [w for theirs, ours in mapped.items() for w in ("--map", f"{theirs}={ours}")]
    words += ["--reference", reference] if reference is not None else []
    words += ["--profile", source.profile] if source.profile is not None else []
    words += [w for name, value in source.readings for w in ("--reading", f"{name}={value}")]
    words += ["--dialect", source.dialect] if source.dialect is not None else []
    words += ["--model", source.model] if source.model is not None else []
    words += [w for name, value in source.params for w in ("-p", f"{name}={value}")]
    words += ["--fuel", str(source.fuel)] if source.fuel != DEFAULT_FUEL else []
    words += ["--trust"] if source.trust else []
    return shlex.join(words)
