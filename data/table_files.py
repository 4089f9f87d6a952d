"""Files of tables: Parquet, Arrow, npz and CSV; columns as those of Arrow, whole or as a stream."""

from __future__ import annotations

import csv
import io
import json
import os
import zipfile
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from io import TextIOWrapper
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np

from ..interpreter.runtime.atomic_files import remove_unfinished, whole_file
from ..interpreter.runtime.optional_packages import missing_package_error
from ..interpreter.runtime.process_sandbox import WALL
from ..semantics.store.errors import UsageError
from .scene import in_json
from .scene_tables import OWN, PARTS, SCHEMA, Columns, Groups, order_columns, part_of, rows_in
from .typed_columns import (
    BOOL,
    FLOAT,
    INT53,
    INT64,
    JSON,
    NOTHING,
    TEXT,
    TypedColumn,
    all_alike,
    as_kind,
    broadcast_first_row,
    dtype_of,
    empty_column,
    in_first_order,
    is_alike,
    joint,
    shown_kind,
    valid_in,
    vector_length,
)

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
        count = vector_length(kind)
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
        if vector_length(column.kind) is None:
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
        raise missing_package_error(what, "pyarrow", problem, ", or write .npz") from None


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
        return {name: as_kind(group.get(name, empty_column(rows)), kind) for name, kind in self.made.kinds.items()}

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


SOME = 1024
"""So many rows of the first group say how a column of numbers is written: ..."""
FEW = 256
"""... where they have so few values, as a place among them."""


class StoredArray(NamedTuple):
    """An array in the file: its place, its type and its shape; if all rows are alike, only the first is
    stored.
    """

    place: int
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    alike: bool


class Stored(NamedTuple):
    """A column of a group in the file: its type, its arrays, which rows have values if some have none, and where its texts stand."""

    kind: str
    values: StoredArray
    valid: StoredArray | None
    texts: int


class Spool:
    """Groups of rows in a file without a name, and the types that all of them have together."""

    def __init__(self, folder: Path) -> None:
        self.file: IO[bytes] = TemporaryFile(dir=folder)  # noqa: SIM115
        self.groups: list[tuple[int, dict[str, Stored]]] = []
        self.types: Kinds = dict(OWN)

    def write(self, group: Columns) -> None:
        """Add a group. Raises `OSError`."""
        pieces = {}
        for name, column in group.items():
            if name not in OWN:
                self.types[name] = joint(self.types.get(name, NOTHING), column.kind)
            valid = None if column.valid is None else self.store(column.valid)
            pieces[name] = Stored(column.kind, self.store(column.values), valid, self.file.tell())
            if column.kind in (TEXT, JSON):
                self.file.write(f"{json.dumps(list(column.texts))}\n".encode())
        self.groups.append((rows_in(group), pieces))

    def store(self, array: np.ndarray) -> StoredArray:
        alike = len(array) > 1 and all_alike(array)
        stored = StoredArray(self.file.tell(), array.dtype, array.shape, alike)
        self.file.write(np.ascontiguousarray(array[:1] if alike else array).data)
        return stored

    def array(self, stored: StoredArray) -> np.ndarray:
        self.file.seek(stored.place)
        found = np.empty((1, *stored.shape[1:]) if stored.alike else stored.shape, stored.dtype)
        self.file.readinto(found.data)  # type: ignore[attr-defined]
        return broadcast_first_row(found, stored.shape[0]) if stored.alike else found

    @property
    def kinds(self) -> Kinds:
        """The type of each column."""
        return {name: self.types[name] for name in order_columns(self.types)}

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return sum(rows for rows, _ in self.groups)

    def read(self) -> Iterator[Columns]:
        """The groups, in order, in the types of all."""
        for rows, pieces in self.groups:
            yield {name: as_kind(self.piece(rows, pieces.get(name)), kind) for name, kind in self.kinds.items()}

    def column(self, name: str) -> Iterator[TypedColumn]:
        """The groups of one column."""
        for rows, pieces in self.groups:
            yield as_kind(self.piece(rows, pieces.get(name)), self.types[name])

    def has_missing(self, name: str) -> bool:
        """Whether a column lacks values."""
        return any(name not in pieces or pieces[name].valid is not None for _, pieces in self.groups)

    def piece(self, rows: int, piece: Stored | None) -> TypedColumn:
        """Read a column that was stored; None reads as an empty column of `rows` rows."""
        if piece is None:
            return empty_column(rows)
        values, valid, texts = self.array(piece.values), None if piece.valid is None else self.array(piece.valid), ()
        if piece.kind in (TEXT, JSON):
            self.file.seek(piece.texts)
            texts = json.loads(self.file.readline())
        return TypedColumn(piece.kind, values, texts, valid)

    def close(self) -> None:
        """Let the file go."""
        self.file.close()


class TableFile(ABC):
    """A file of a table being written, which gets its name when it is complete.

    Raises `UsageError` if it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.groups = Groups()
        if path.exists() and not os.access(path, os.W_OK):
            raise UsageError(f"{path} cannot be written: permission denied")
        try:
            remove_unfinished(path)
            self.spool = Spool(path.parent)
        except OSError as error:
            raise self.unwritable(error) from None

    def add(self, scene: Mapping[str, Any]) -> None:
        """The objects of a scene, given in the scene format."""
        self._write(self.groups.add_scene(scene))

    def add_columns(self, columns: Columns) -> None:
        """The objects of further scenes."""
        self._write(self.groups.add(columns))

    def finish(self) -> None:
        """Write the file and give it its name."""
        self._write(self.groups.rest())
        try:
            with whole_file(self.path) as file:
                self.complete(self.spool, file)
        except OSError as error:
            raise self.unwritable(error) from None

    def _write(self, groups: Iterator[Columns]) -> None:
        for group in groups:
            try:
                self.spool.write(group)
            except OSError as error:
                raise self.unwritable(error) from None

    def unwritable(self, error: OSError) -> UsageError:
        """The error that says why the file cannot be written."""
        return UsageError(f"{self.path} cannot be written: {error.strerror or error}")

    def close(self) -> None:
        """Let go of the rows that were added."""
        self.spool.close()

    @abstractmethod
    def complete(self, spool: Spool, target: IO[bytes]) -> None:
        """Write all groups to the file. Raises `OSError`."""


# Arrow and Parquet


class ParquetTable(TableFile):
    """A Parquet file; a group of rows is a row group. Raises `UsageError` if pyarrow is not installed."""

    def __init__(self, path: Path) -> None:
        arrow_for("a Parquet table")
        super().__init__(path)

    def complete(self, spool: Spool, target: IO[bytes]) -> None:
        """Write the row groups."""
        from pyarrow import parquet

        made, first = Arrow(spool.kinds), next(spool.read(), {})
        with room_to_write(), parquet.ParquetWriter(target, made.schema, **parquet_encoding(first)) as writer:
            for group in spool.read():
                writer.write_batch(made.batch(group), row_group_size=rows_in(group))


def parquet_encoding(first: Columns) -> dict[str, Any]:
    """How the columns of a Parquet file are encoded, by the first group.

    Few values are written as places among them, the numbers of scenes as differences. Columns of reals that are nearly all distinct are not
    compressed: that would take longer than to write them, and save a twentieth.
    """
    texts = [name for name, column in first.items() if column.kind in (TEXT, JSON)]
    distinct = {name: distinct_in(c.values) for name, c in first.items() if name not in texts and c.values.ndim == 1}
    few = [name for name, count in distinct.items() if count <= FEW and name != "scene"]
    many = {name for name, count in distinct.items() if count > 0.95 * SOME and first[name].kind == FLOAT}
    compressed = [name if vector_length(column.kind) is None else f"{name}.list.element" for name, column in first.items() if name not in many]
    return {
        "use_dictionary": texts + few, "column_encoding": {"scene": "DELTA_BINARY_PACKED"}, "write_statistics": ["scene"],
        "compression": dict.fromkeys(compressed, "zstd"), "compression_level": dict.fromkeys(compressed, 1),
    }


def distinct_in(values: np.ndarray) -> int:
    """How many values there are in the first rows."""
    return len(np.unique(values[:SOME]))


class ArrowTable(TableFile):
    """An Arrow IPC file ("Feather 2"). Raises `UsageError` if pyarrow is not installed."""

    def __init__(self, path: Path) -> None:
        arrow_for("an Arrow table")
        super().__init__(path)

    def complete(self, spool: Spool, target: IO[bytes]) -> None:
        """Write the record batches."""
        import pyarrow

        made = Arrow(spool.kinds)
        with room_to_write(), pyarrow.ipc.new_file(target, made.schema) as writer:
            for group in spool.read():
                writer.write_batch(made.batch(group))


# Without pyarrow


class NpzTable(TableFile):
    """An npz file: NAME.npy for each column, NAME.jsonl with the texts whose numbers are in NAME.npy, NAME.valid.npy where values are missing."""

    def complete(self, spool: Spool, target: IO[bytes]) -> None:
        """The columns one after the other, not compressed; equal rows give equal bytes."""
        with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
            described = {"schema": SCHEMA, "columns": {name: shown_kind(kind) for name, kind in spool.kinds.items()}}
            archive.writestr(zipfile.ZipInfo("schema.json"), in_json(described))  # the date of a member is always 1980
            for name, kind in spool.kinds.items():
                count = vector_length(kind)
                texts = write_member(archive, name, dtype_of(kind), (spool.rows,) if count is None else (spool.rows, count), spool.column(name))
                if kind in (TEXT, JSON):
                    archive.writestr(zipfile.ZipInfo(f"{name}.jsonl"), "".join(f"{text if kind == JSON else in_json(text)}\n" for text in texts))
                if spool.has_missing(name):
                    valid = (TypedColumn(BOOL, valid_in(column)) for column in spool.column(name))
                    write_member(archive, f"{name}.valid", np.dtype(bool), (spool.rows,), valid)


def write_member(archive: zipfile.ZipFile, name: str, dtype: np.dtype[Any], shape: tuple[int, ...], column: Iterator[TypedColumn]) -> list[str]:
    """The member NAME.npy; the texts whose numbers it has, equal ones of a group once, -1 standing for none."""
    texts: list[str] = []
    with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as target:
        np.lib.format.write_array_header_1_0(target, {"descr": dtype.str, "fortran_order": False, "shape": shape})  # type: ignore[arg-type]
        for piece in column:
            if piece.kind in (TEXT, JSON):
                piece = in_first_order(piece)
                piece = piece._replace(values=np.where(piece.values < 0, -1, piece.values + len(texts)))
                texts += piece.texts
            target.write(np.ascontiguousarray(piece.values, dtype=dtype).tobytes())
    return texts


class CsvTable(TableFile):
    """A CSV file: a line with the names, then one for each row; what is missing is empty, lists are JSON."""

    def complete(self, spool: Spool, target: IO[bytes]) -> None:
        """Write all rows as lines of CSV."""
        text = TextIOWrapper(target, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(spool.kinds)
        for group in spool.read():
            writer.writerows(zip(*(cells(column) for column in group.values()), strict=True))
        text.detach()  # which writes the rest, and leaves the file open


def cells(column: TypedColumn) -> list[str]:
    """The cells of a column."""
    shown: list[str]
    if column.kind in (TEXT, JSON):
        shown = [str(column.texts[k]) for k in column.values.tolist()]
    elif column.kind == BOOL:
        shown = ["true" if v else "false" for v in column.values.tolist()]
    elif vector_length(column.kind) is not None:
        shown = [json.dumps(row) for row in column.values.tolist()]
    else:
        shown = list(map(repr, column.values.tolist()))
    return shown if column.valid is None else [cell if there else "" for cell, there in zip(shown, column.valid.tolist(), strict=True)]


KINDS_OF_FILE: dict[str, type[TableFile]] = {".parquet": ParquetTable, ".arrow": ArrowTable, ".npz": NpzTable, ".csv": CsvTable}
SUFFIXES = tuple(KINDS_OF_FILE)
"""Which files are tables."""


def open_table(path: Path) -> TableFile:
    """The table that the suffix asks for. Raises `UsageError`."""
    return KINDS_OF_FILE[path.suffix.lower()](path)

