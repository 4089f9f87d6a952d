"""Scenes as a tidy table, one row per object: the columns, and the files of them (Parquet, npz). The only file that imports pyarrow.

A table is written in groups of rows whose ends depend on the scenes only, not on the pieces in which they arrive. So one file
results whoever draws the scenes: the interpreter one by one, or columns of many, from one process or from several.
"""

from __future__ import annotations

import os
import shutil
import zipfile
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from ..interpreter.extras import needed
from ..semantics.kernel.errors import UsageError
from .scenes import in_json

ROWS_AT_ONCE = 1 << 16
"""Rows at which a group ends, with the first scene that reaches them."""
SCENES_AT_ONCE = 1000
"""How many single scenes are kept before they become columns."""
COLUMNS = {
    "seed": "string", "scene": "int64", "attempts": "int64", "weight": "float64", "object": "int64", "ego": "bool", "name": "string",
    "class": "string", "x": "float64", "y": "float64", "heading": "float64", "width": "float64", "length": "float64",
    "properties": "string", "params": "string",
}
"""The columns: metres and radians; `properties` and `params` are JSON; `seed` is text, since seeds have no bounds."""
JSON_ALREADY = ("properties", "params")
SUFFIXES = (".parquet", ".npz")
"""Which files are tables."""


class Texts(NamedTuple):
    """A column of texts: that of row k is `values[codes[k]]`."""

    values: Sequence[str | None]
    codes: np.ndarray


Columns = dict[str, "np.ndarray | Texts"]
"""The columns of some rows, by the names in `COLUMNS`, all of one length; the rows of a scene are together, scenes in order."""


# Columns


def columns_of(scenes: Iterable[Mapping[str, Any]]) -> Columns:
    """The columns of scenes in the scene format."""
    rows = [row for scene in scenes for row in rows_of(scene)]
    return {
        name: texts_of([row[name] for row in rows]) if kind == "string" else np.array([row[name] for row in rows], dtype=kind)  # type: ignore[arg-type]
        for name, kind in COLUMNS.items()
    }


def texts_of(values: Iterable[str | None]) -> Texts:
    """A column of texts, equal ones once, in the order in which they come first."""
    places: dict[str | None, int] = {}
    codes = np.array([places.setdefault(v, len(places)) for v in values], dtype=np.int64)
    return Texts(list(places), codes)


def rows_of(scene: Mapping[str, Any]) -> list[dict[str, object]]:
    """One row per object of a scene in the scene format."""
    shared = {
        "seed": str(scene["seed"]), "scene": scene["scene"], "attempts": scene["attempts"], "weight": scene["weight"],
        "params": in_json(scene["params"], allow_nan=True),
    }
    return [
        {
            **shared, "object": o["id"], "ego": o["id"] == scene["ego"], "name": o["name"], "class": o["class"],
            "x": float(o["position"][0]), "y": float(o["position"][1]), "heading": float(o["heading"]), "width": float(o["width"]),
            "length": float(o["length"]), "properties": in_json(o["properties"], allow_nan=True),
        }
        for o in scene["objects"]
    ]


def joined(pieces: Sequence[Columns]) -> Columns:
    """The rows of some columns after those of others."""
    if len(pieces) == 1:
        return pieces[0]
    return {name: _joined([piece[name] for piece in pieces]) for name in COLUMNS}


def _joined(columns: Sequence[np.ndarray | Texts]) -> np.ndarray | Texts:
    if not isinstance(columns[0], Texts):
        return np.concatenate(columns)  # type: ignore[arg-type]
    values: list[str | None] = []
    codes: list[np.ndarray] = []
    for column in columns:
        assert isinstance(column, Texts)
        codes.append(column.codes + len(values))
        values += column.values
    return Texts(values, np.concatenate(codes))


def chosen(columns: Columns, rows: slice | np.ndarray) -> Columns:
    """Some of the rows."""
    return {name: _chosen(column, rows) for name, column in columns.items()}


def _chosen(column: np.ndarray | Texts, rows: slice | np.ndarray) -> np.ndarray | Texts:
    if not isinstance(column, Texts):
        return column[rows]
    codes = column.codes[rows]
    if len(codes) >= len(column.values):
        return Texts(column.values, codes)
    used, codes = np.unique(codes, return_inverse=True)
    return Texts([column.values[k] for k in used.tolist()], codes)


class Groups:
    """Rows put together from pieces of whole scenes, and cut into groups."""

    def __init__(self) -> None:
        self.pieces: list[Columns] = []
        self.rows = 0

    def add(self, columns: Columns) -> Iterator[Columns]:
        """The groups that these further rows complete."""
        self.pieces.append(columns)
        self.rows += len(columns["scene"])  # type: ignore[arg-type]
        while self.rows >= ROWS_AT_ONCE:
            whole = joined(self.pieces)
            end = end_of_scene(whole["scene"], ROWS_AT_ONCE)  # type: ignore[arg-type]
            self.pieces, self.rows = ([chosen(whole, slice(end, None))] if end < self.rows else []), self.rows - end
            yield chosen(whole, slice(0, end))

    def rest(self) -> Iterator[Columns]:
        """The last group, if there are rows left."""
        if self.rows:
            yield joined(self.pieces)


def end_of_scene(scenes: np.ndarray, row: int) -> int:
    """The first row, from `row` on, at which another scene begins."""
    return int(np.searchsorted(scenes, scenes[row - 1], side="right"))


# Files


class TableFile(ABC):
    """A file of a table being written: under another name until `finish`, so that `path` is only ever a complete table.

    Raises `UsageError` if it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
        self.scenes: list[Mapping[str, Any]] = []
        self.groups = Groups()
        if path.exists() and not os.access(path, os.W_OK):
            raise UsageError(f"{path} cannot be written: permission denied")

    def add(self, scene: Mapping[str, Any]) -> None:
        """The objects of a scene, given in the scene format."""
        self.scenes.append(scene)
        if len(self.scenes) >= SCENES_AT_ONCE:
            self._flush()

    def add_columns(self, columns: Columns) -> None:
        """The objects of further scenes."""
        self._flush()
        self._write(self.groups.add(columns))

    def finish(self) -> None:
        """Write what is left and give the file its name."""
        self._flush()
        self._write(self.groups.rest())
        try:
            self.complete().replace(self.path)
        except OSError as error:
            raise self.unwritable(error) from None

    def _flush(self) -> None:
        if self.scenes:
            columns, self.scenes = columns_of(self.scenes), []
            self._write(self.groups.add(columns))

    def _write(self, groups: Iterator[Columns]) -> None:
        for group in groups:
            try:
                self.write_group(group)
            except OSError as error:
                raise self.unwritable(error) from None

    def unwritable(self, error: OSError) -> UsageError:
        """The error that says why the file cannot be written."""
        return UsageError(f"{self.path} cannot be written: {error.strerror or error}")

    @abstractmethod
    def write_group(self, group: Columns) -> None:
        """Write some rows. Raises `OSError`."""

    @abstractmethod
    def complete(self) -> Path:
        """The file with all rows, under its other name. Raises `OSError`."""

    @abstractmethod
    def close(self) -> None:
        """Remove what was written, unless it was finished."""


class ParquetTable(TableFile):
    """A Parquet file; a group of rows is a row group. Raises `UsageError` if pyarrow is not installed."""

    def __init__(self, path: Path) -> None:
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError as problem:
            raise needed("a Parquet table", "pyarrow", problem, ", or write .npz") from None
        super().__init__(path)
        self.arrow = pyarrow
        self.schema = pyarrow.schema([(name, getattr(pyarrow, "bool_" if kind == "bool" else kind)()) for name, kind in COLUMNS.items()])
        try:
            texts = [name for name, kind in COLUMNS.items() if kind == "string"]
            self.writer = parquet.ParquetWriter(self.unfinished, self.schema, use_dictionary=texts, compression="zstd", compression_level=1)  # type: ignore[arg-type]
        except OSError as error:
            raise self.unwritable(error) from None

    def write_group(self, group: Columns) -> None:
        """One row group."""
        arrays = [self._array(group[field.name], field.type) for field in self.schema]
        self.writer.write_table(self.arrow.Table.from_arrays(arrays, schema=self.schema), row_group_size=len(arrays[0]))

    def _array(self, column: np.ndarray | Texts, kind: object) -> Any:
        if isinstance(column, Texts):
            return self.arrow.array(column.values, type=kind).take(self.arrow.array(column.codes))
        return self.arrow.array(column, type=kind)

    def complete(self) -> Path:
        """The file, closed."""
        self.writer.close()
        return self.unfinished

    def close(self) -> None:
        """Remove the file unless it was finished."""
        if self.unfinished.exists():
            with suppress(OSError):  # it is removed anyway
                self.writer.close()
            self.unfinished.unlink()


class NpzTable(TableFile):
    """An npz file: NAME.npy for each column, and NAME.jsonl for one of texts, whose numbers in NAME.npy are those of lines in NAME.jsonl.

    Each column is a file of its own until all rows are there; then they are copied into one, so that memory stays bounded.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.rows = 0
        self.texts = {name: 0 for name, kind in COLUMNS.items() if kind == "string"}
        self.files: dict[str, IO[bytes]] = {}
        try:
            self.unfinished.mkdir()
            for name in (*COLUMNS, *(f"{name}.jsonl" for name in self.texts)):
                self.files[name] = (self.unfinished / name).open("w+b")
        except OSError as error:
            self.close()
            raise self.unwritable(error) from None

    def write_group(self, group: Columns) -> None:
        """Add to the files of the columns."""
        self.rows += len(group["scene"])  # type: ignore[arg-type]
        for name, column in group.items():
            if isinstance(column, Texts):
                values, codes = in_first_order(column)
                encoded = values if name in JSON_ALREADY else [in_json(v, allow_nan=True) for v in values]
                self.files[f"{name}.jsonl"].write("".join(f"{text}\n" for text in encoded).encode())
                column = codes + self.texts[name]
                self.texts[name] += len(values)
            self.files[name].write(np.ascontiguousarray(column, dtype=numpy_kind(name)).tobytes())

    def complete(self) -> Path:
        """The columns in one file, not compressed; equal rows give equal bytes."""
        whole = self.unfinished / "whole"
        with zipfile.ZipFile(whole, "w", zipfile.ZIP_STORED) as archive:
            for name, file in self.files.items():
                member = zipfile.ZipInfo(name if name.endswith(".jsonl") else f"{name}.npy")  # its date is always 1980
                with archive.open(member, "w", force_zip64=True) as target:
                    if not name.endswith(".jsonl"):
                        header = {"descr": numpy_kind(name).str, "fortran_order": False, "shape": (self.rows,)}
                        np.lib.format.write_array_header_1_0(target, header)
                    file.seek(0)
                    shutil.copyfileobj(file, target, 1 << 20)
        return whole

    def close(self) -> None:
        """Remove all but the finished file."""
        for file in self.files.values():
            with suppress(OSError):  # it is removed anyway
                file.close()
        shutil.rmtree(self.unfinished, ignore_errors=True)


def in_first_order(column: Texts) -> Texts:
    """The same texts, equal ones once, in the order in which they come first, without those that no row has."""
    places: dict[str | None, int] = {}
    number_of = np.array([places.setdefault(v, len(places)) for v in column.values], dtype=np.int64)
    codes = number_of[column.codes]
    used, first, inverse = np.unique(codes, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    values = list(places)
    return Texts([values[k] for k in used[order].tolist()], rank[inverse])


def numpy_kind(name: str) -> np.dtype[Any]:
    """The type of a column in an npz file: that of its values; texts are numbered."""
    kind = COLUMNS[name]
    return np.dtype("int64" if kind == "string" else kind)


def open_table(path: Path) -> TableFile:
    """The table that the suffix asks for. Raises `UsageError`."""
    return ParquetTable(path) if path.suffix.lower() == ".parquet" else NpzTable(path)
