"""The result of `sample_many`: scenes one after the other, or all of them as columns."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ..data.scene import Scene
from ..data.scene_tables import OWN, Columns, columns_of, pieces_of, together
from ..data.table_files import arrow_for, arrow_table
from ..data.typed_columns import JSON, NOTHING, TEXT, TypedColumn, as_kind, is_alike, vector_length
from ..inference.batch import Batch, Block
from ..inference.batch.jobs.block_tables import Tables
from ..inference.batch.jobs.worker_pools import jobs
from ..inference.rejection import OutOfPatience, patiently
from ..interpreter.runtime.optional_packages import missing_package_error
from ..pictures.notebook_views import count_phrase
from ..semantics.store.errors import UsageError
from .engine_choice import Backend, choose_engine, is_slow

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

    from .scenario import Scenario

ToldScenes = Callable[[int], object]
"""Is told how many scenes there are so far."""


class Drawn(Iterator[Scene]):
    """The scenes of a seed, drawn as they are asked for: by iterating, or all that are left as columns, which is much quicker.

    Each scene is given once: columns of scenes that are all taken raise `UsageError`. Raises, where they are drawn, the program's errors and
    `AttemptsExhausted`.
    """

    def __init__(self, count: int, scenes: Iterator[Scene], blocks: tuple[Batch, int, Iterator[Block]] | None, tell: ToldScenes | Bar) -> None:
        self._count = count
        self._scenes = scenes if blocks is None else _scenes_in(*blocks)
        self._blocks = blocks
        self._tell = tell
        self._done = 0

    def __repr__(self) -> str:
        return f"<{count_phrase(self._count, 'scene')}, {self._done:,} of them drawn>"

    def __next__(self) -> Scene:
        try:
            scene = next(self._scenes)
        except BaseException:
            self.close()
            raise
        self._done += 1
        self._tell(self._done)
        return scene

    def close(self) -> None:
        """Stop the drawing of further scenes."""
        self._scenes = iter(())
        self._blocks = None
        if isinstance(self._tell, Bar):
            self._tell.stop()

    def __del__(self) -> None:
        self.close()

    def columns(self) -> dict[str, np.ndarray]:
        """The objects of the scenes that are left, one in each row, as NumPy arrays (rows,): the columns of the table format by name.

        Numbers, truth values and texts have their type; lists of k numbers are (rows, k); what has no type is its JSON text. What is missing is
        NaN among floats, None among texts, and masked (`numpy.ma`) otherwise. Metres and radians.
        """
        return {name: array_of(column) for name, column in self._all().items()}

    def to_arrow(self) -> pyarrow.Table:
        """Return the scenes as an Arrow table, in which `properties` and `params` are structs. Raises
        `UsageError` without pyarrow.
        """
        arrow_for("`to_arrow`")
        return arrow_table(self._all())

    def to_polars(self) -> polars.DataFrame:
        """Return the scenes as a Polars frame. Raises `UsageError` without polars or pyarrow."""
        try:
            import polars
        except ImportError as problem:
            raise missing_package_error("`to_polars`", "polars", problem) from None
        arrow_for("`to_polars`")
        return polars.DataFrame(polars.from_arrow(self.to_arrow()))

    def to_pandas(self) -> pandas.DataFrame:
        """Return the scenes as a pandas frame, with a column for each of `columns`. Raises `UsageError`
        without pandas.
        """
        try:
            import pandas
        except ImportError as problem:
            raise missing_package_error("`to_pandas`", "pandas", problem) from None
        return pandas.DataFrame({name: series_of(column) for name, column in self._all().items()})

    def _all(self) -> Columns:
        """The columns of the scenes that are left. Raises `UsageError` if there were some and all are taken."""
        if self._done and self._done >= self._count:
            raise UsageError("all of these scenes are taken: each is given once", hint="call sample_many again, or keep what it gave")
        try:
            pieces = list(pieces_of(s.to_json() for s in self) if self._done or self._blocks is None else self._by_block(*self._blocks))
        finally:
            self.close()
        return together(pieces) if pieces else {name: as_kind(column, OWN[name]) for name, column in columns_of([]).items()}

    def _by_block(self, batch: Batch, seed: int, blocks: Iterator[Block]) -> Iterator[Columns]:
        tables = Tables(batch.template)
        for block in blocks:
            self._done += len(block.attempts)
            self._tell(self._done)
            if len(block.attempts):
                yield tables.of(block, seed)


def sample_scenes(scenario: Scenario, n: int, seed: int, start: int, max_attempts: int, backend: Backend, tell: ToldScenes | Bar) -> Drawn:
    """Return the result of `Scenario.sample_many`. Raises as that method does."""
    engine = choose_engine(scenario, n, backend)
    batch = scenario.batch if engine.why_interpreted is None else None
    blocks = None if batch is None else (batch, seed, jobs(batch, n, seed, start, max_attempts))
    few = few_scenes if engine.hands_over else one_by_one
    return Drawn(n, few(scenario, seed, start, start + n, max_attempts), blocks, tell)


def one_by_one(scenario: Scenario, seed: int, start: int, stop: int, max_attempts: int) -> Iterator[Scene]:
    """Scenes `start` to `stop - 1` by the interpreter."""
    return (scenario.sample(seed, index, max_attempts=max_attempts) for index in range(start, stop))


def few_scenes(scenario: Scenario, seed: int, start: int, stop: int, max_attempts: int) -> Iterator[Scene]:
    """Scenes `start` to `stop - 1` by the interpreter while each takes little time; the others by the batch backend, if it can."""
    for index in range(start, stop):
        begun = time.process_time()
        try:
            found = scenario.sampled(seed, index, max_attempts=max_attempts, on_attempt=patiently(max_attempts))
        except OutOfPatience:
            first = index
        else:
            took = time.process_time() - begun
            yield found.scene
            if index > start or not is_slow(took, found.scene.attempts, stop - index - 1):
                continue
            first = index + 1
        if scenario.impossible is not None:
            raise scenario.impossible
        if scenario.batch is None:
            yield from one_by_one(scenario, seed, first, stop, max_attempts)
        else:
            yield from _scenes_in(scenario.batch, seed, jobs(scenario.batch, stop - first, seed, first, max_attempts))
        return


def _scenes_in(batch: Batch, seed: int, blocks: Iterator[Block]) -> Iterator[Scene]:
    for block in blocks:
        yield from batch.scenes_of(block, seed)


def array_of(column: TypedColumn) -> np.ndarray:
    """A column as an array, as `Drawn.columns` says."""
    if column.kind == NOTHING:
        return np.full(column.rows, None)
    if column.kind in (TEXT, JSON):
        found = np.array(column.texts, dtype=object)[column.values]
        if column.valid is not None:
            found[~column.valid] = None
        return found
    values = np.array(column.values) if is_alike(column.values) else column.values  # a user may want to write into it
    if column.valid is None:
        return values
    if values.dtype == float:
        return np.where(column.valid if values.ndim == 1 else column.valid[:, None], values, np.nan)
    return np.ma.masked_array(values, ~column.valid)


def series_of(column: TypedColumn) -> Any:
    """A column as pandas takes it: texts by categories, whole numbers and truth values that may be missing, lists as objects."""
    import pandas

    found = array_of(column)
    if vector_length(column.kind) is not None:
        rows = found.tolist()
        return rows if column.valid is None else [row if there else None for row, there in zip(rows, column.valid.tolist(), strict=True)]
    if column.kind == TEXT:
        return pandas.Categorical(found)
    if isinstance(found, np.ma.MaskedArray):
        kind = pandas.arrays.BooleanArray if found.dtype == bool else pandas.arrays.IntegerArray
        return kind(np.asarray(found.data), np.ma.getmaskarray(found))
    return found


class Bar:
    """A bar on standard error, from the first scene on until it is stopped."""

    def __init__(self, count: int) -> None:
        from rich.console import Console
        from rich.progress import Progress

        self.shown = Progress(console=Console(stderr=True))
        self.task = self.shown.add_task("scenes", total=count)

    def __call__(self, done: int) -> None:
        self.shown.start()
        self.shown.update(self.task, completed=done)

    def stop(self) -> None:
        """Let the terminal be as it was."""
        self.shown.stop()


def progress_of(progress: bool | ToldScenes, count: int) -> ToldScenes | Bar:
    """Return the observer of progress: a bar for True, none for False, or the given function. Raises
    `UsageError` for anything else.
    """
    if callable(progress):
        return progress
    if not isinstance(progress, bool):
        raise UsageError(f"progress is True, False or a function of the number of scenes, not {progress!r}")
    return Bar(count) if progress else lambda done: None
