"""Scenes as a tidy Parquet table: one row per object. The only file that imports pyarrow."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..semantics.errors import UsageError

ROWS_AT_ONCE = 10_000
COLUMNS = {
    "seed": "string", "scene": "int64", "attempts": "int64", "weight": "float64", "object": "int64", "ego": "bool", "name": "string",
    "class": "string", "x": "float64", "y": "float64", "heading": "float64", "width": "float64", "length": "float64",
    "properties": "string", "params": "string",
}
"""The columns: metres and radians; `properties` and `params` are JSON; `seed` is text, since seeds have no bounds."""


class TableFile:
    """A Parquet file being written: under another name until `finish`, so that PATH is only ever a complete table.

    Raises `UsageError` if pyarrow is not installed or the file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise UsageError("Parquet tables need the package pyarrow", hint="pip install 'scenic-ref[parquet]', or write JSON Lines") from None
        self.path = path
        self.unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
        self.arrow = pyarrow
        self.schema = pyarrow.schema([(name, getattr(pyarrow, "bool_" if kind == "bool" else kind)()) for name, kind in COLUMNS.items()])
        self.rows: list[dict[str, object]] = []
        if path.exists() and not os.access(path, os.W_OK):
            raise UsageError(f"{path} cannot be written: permission denied")
        try:
            self.writer = parquet.ParquetWriter(self.unfinished, self.schema)
        except OSError as error:
            raise self._unwritable(error) from None

    def add(self, scene: Mapping[str, Any]) -> None:
        """The objects of a scene, given in the scene format."""
        self.rows += rows_of(scene)
        if len(self.rows) >= ROWS_AT_ONCE:
            self._flush()

    def finish(self) -> None:
        """Write what is left and give the file its name."""
        self._flush()
        try:
            self.writer.close()
            self.unfinished.replace(self.path)
        except OSError as error:
            raise self._unwritable(error) from None

    def close(self) -> None:
        """Remove the file unless it was finished."""
        if self.unfinished.exists():
            with suppress(OSError):  # it is removed anyway
                self.writer.close()
            self.unfinished.unlink()

    def _flush(self) -> None:
        table = self.arrow.Table.from_pylist(self.rows, schema=self.schema)
        try:
            self.writer.write_table(table)
        except OSError as error:
            raise self._unwritable(error) from None
        self.rows = []

    def _unwritable(self, error: OSError) -> UsageError:
        return UsageError(f"{self.path} cannot be written: {error.strerror or error}")


def rows_of(scene: Mapping[str, Any]) -> list[dict[str, object]]:
    """One row per object of a scene in the scene format."""
    shared = {
        "seed": str(scene["seed"]), "scene": scene["scene"], "attempts": scene["attempts"], "weight": scene["weight"],
        "params": json.dumps(scene["params"], ensure_ascii=False),
    }
    return [
        {
            **shared, "object": o["id"], "ego": o["id"] == scene["ego"], "name": o["name"], "class": o["class"],
            "x": float(o["position"][0]), "y": float(o["position"][1]), "heading": float(o["heading"]), "width": float(o["width"]),
            "length": float(o["length"]), "properties": json.dumps(o["properties"], ensure_ascii=False),
        }
        for o in scene["objects"]
    ]
