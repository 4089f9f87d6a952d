"""Columns as those of Arrow, whole or as a stream."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, BinaryIO

from ..interpreter.extras import needed
from ..interpreter.walls import WALL
from ..semantics.kernel.errors import UsageError
from .columns import BOOL, FLOAT, INT53, INT64, JSON, NOTHING, TEXT, TypedColumn, as_kind, is_alike, joint, length_of, nothing, shown_kind
from .tables import OWN, PARTS, SCHEMA, Columns, Groups, part_of, rows_in

if TYPE_CHECKING:
    import pyarrow

Kinds = dict[str, str]
"""The type of each column, by name, in the order of tables."""


class Arrow:
    """Columns as those of Arrow: properties and parameters as structs with a typed field for each."""

    def __init__(self, kinds: Kinds) -> None:
        import pyarrow

        self.arrow = pyarrow
        self.kinds = kinds
        fields = [self.field(name, name) for name in OWN]
        for part in PARTS:
            inside = [self.field(name, place[1]) for name in kinds if (place := part_of(name)) is not None and place[0] == part]
            if inside:
                fields.append(pyarrow.field(part, pyarrow.struct(inside), nullable=False))
        self.schema = pyarrow.schema(fields, metadata={"schema": SCHEMA})
        self.last: dict[str, tuple[object, Any]] = {}

    def field(self, name: str, shown: str) -> Any:
        """The field of a column; one of JSON texts says so."""
        kind = self.kinds[name]
        return self.arrow.field(shown, self.type_of(kind), metadata={"format": "json"} if kind == JSON else None)

    def type_of(self, kind: str) -> Any:
        """The type of Arrow."""
        count = length_of(kind)
        if count is not None:
            return self.arrow.list_(self.arrow.float64(), count)
        plain = {BOOL: self.arrow.bool_(), INT53: self.arrow.int64(), INT64: self.arrow.int64(), FLOAT: self.arrow.float64()}
        return plain.get(kind, self.arrow.string())

    def array(self, name: str, column: TypedColumn) -> Any:
        """The array of a column; where all rows are alike, and those of the last group were the same, that of the last group."""
        if not (is_alike(column.values) and (column.valid is None or is_alike(column.valid))):
            return self.new_array(column)
        text = column.texts[int(column.values[0])] if column.kind in (TEXT, JSON) else None
        value = column.values[:1].tobytes() if text is None else text
        what = (column.rows, value, column.valid is None or bool(column.valid[0]))
        last, array = self.last.get(name, (None, None))
        if last != what:
            array = self.new_array(column)
            self.last[name] = what, array
        return array

    def new_array(self, column: TypedColumn) -> Any:
        """The array of a column."""
        arrow, kind = self.arrow, self.type_of(column.kind)
        mask = None if column.valid is None else ~column.valid
        if column.kind in (TEXT, JSON):
            return arrow.array(list(column.texts), type=kind).take(arrow.array(column.values, mask=mask))
        if column.kind == NOTHING:
            return arrow.nulls(column.rows, kind)
        if length_of(column.kind) is None:
            return arrow.array(column.values, type=kind, mask=mask)
        inner = arrow.array(column.values.ravel())
        return arrow.FixedSizeListArray.from_arrays(inner, type=kind, mask=None if mask is None else arrow.array(mask))

    def batch(self, group: Columns) -> Any:
        """A group of rows."""
        arrays = []
        for field in self.schema:
            if field.name in OWN:
                arrays.append(self.array(field.name, group[field.name]))
            else:
                names = [f"{field.name}.{child.name}" for child in field.type]
                inside = [self.array(name, group[name]) for name in names]
                arrays.append(self.arrow.StructArray.from_arrays(inside, fields=list(field.type)))
        return self.arrow.RecordBatch.from_arrays(arrays, schema=self.schema)


def arrow_for(what: str) -> None:
    """Check that pyarrow is there. Raises `UsageError`."""
    try:
        import pyarrow  # noqa: F401
    except ImportError as problem:
        raise needed(what, "pyarrow", problem, ", or write .npz") from None


def prepare_arrow() -> None:
    """Load pyarrow, if it is installed, for a process whose memory will be limited, and write a little with it.

    It reserves a gigabyte of address space and starts threads, and may end the process where it gets neither. Hence it is loaded before there is a
    limit, gets its memory from the system piece by piece, and has one thread of each kind.
    """
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return  # `arrow_for` tells it, where what is asked for can be had at all
    pyarrow.set_cpu_count(1)
    pyarrow.set_io_thread_count(1)
    batch = pyarrow.record_batch({"texts": pyarrow.array(["a"]).take(pyarrow.array([0])), "numbers": pyarrow.array([1.0])})
    with io.BytesIO() as nowhere, pyarrow.ipc.new_file(nowhere, batch.schema) as stream:
        stream.write_batch(batch)
    with io.BytesIO() as nowhere, parquet.ParquetWriter(nowhere, batch.schema, compression="zstd") as table:
        table.write_batch(batch)


ROOM = 512 << 20
"""Bytes beyond the limit of memory that pyarrow may have: it tells of a lack of many bytes, and ends the process for want of a few."""


def room_to_write() -> AbstractContextManager[None]:
    """Allow pyarrow more memory than the program had; the error where it needs more still is the program's."""
    return WALL.room(ROOM)


class ArrowStream:
    """A stream of Arrow record batches, with the types of the first group of rows.

    Raises `UsageError` if pyarrow is not installed, or if a later value has another type.
    """

    def __init__(self, target: BinaryIO) -> None:
        arrow_for("an Arrow stream")
        self.target = target
        self.groups = Groups()
        self.made: Arrow | None = None
        self.writer: Any = None

    def add(self, scene: Mapping[str, Any]) -> None:
        """The objects of a scene, given in the scene format."""
        for group in self.groups.add_scene(scene):
            self.write(group)

    def add_columns(self, columns: Columns) -> None:
        """The objects of further scenes."""
        for group in self.groups.add(columns):
            self.write(group)

    def write(self, group: Columns | None) -> None:
        """A group of rows; None for a stream without any."""
        with room_to_write():
            self._write(group)

    def _write(self, group: Columns | None) -> None:
        import pyarrow

        if self.made is None:
            kinds = dict(OWN) if group is None else OWN | {name: column.kind for name, column in group.items() if name not in OWN}
            self.made = Arrow(kinds)
            self.writer = pyarrow.ipc.new_stream(self.target, self.made.schema)
        if group is not None:
            self.check(group)
            self.writer.write_batch(self.made.batch(self.like_before(group)))

    def check(self, group: Columns) -> None:
        """Check that a group has the types of the stream. Raises `UsageError`."""
        assert self.made is not None
        for name, column in group.items():
            if name not in OWN and (name not in self.made.kinds or joint(self.made.kinds[name], column.kind) != self.made.kinds[name]):
                known = self.made.kinds.get(name, "missing")
                place = f"{name} is {shown_kind(column.kind)} in scene {group['scene'].values[0]} or later, and {shown_kind(known)} before"
                raise UsageError(f"{place}; the types of a stream are those of its beginning", hint="write a file: -o PATH.arrow")

    def like_before(self, group: Columns) -> Columns:
        """The columns of a group in the types of the stream."""
        assert self.made is not None
        rows = rows_in(group)
        return {name: as_kind(group.get(name, nothing(rows)), kind) for name, kind in self.made.kinds.items()}

    def finish(self) -> None:
        """Write what is left, and the end."""
        for group in self.groups.rest():
            self.write(group)
        if self.made is None:
            self.write(None)
        with room_to_write():
            self.writer.close()


def arrow_table(columns: Columns) -> pyarrow.Table:
    """The rows as a table of Arrow. Raises `UsageError` if pyarrow is not installed."""
    arrow_for("a table of Arrow")
    made = Arrow({name: OWN.get(name, column.kind) for name, column in columns.items()})
    return made.arrow.Table.from_batches([made.batch(columns)])
