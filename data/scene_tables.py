"""Scenes as a tidy table, one row per object: the columns of scenes, put together from pieces and cut into groups.

The end of a group depends on the scenes only, not on the pieces in which they arrive. So one file results whoever draws the scenes: the interpreter
one by one, or columns of many, from one process or from several.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from .scene import in_utf8
from .typed_columns import BOOL, FLOAT, INT64, TEXT, TypedColumn, column_of, concatenate_columns, empty_column, select_rows

ROWS_AT_ONCE = 1 << 16
"""Rows at which a group ends, with the first scene that reaches them."""
SCENES_AT_ONCE = 1000
"""How many single scenes become columns together."""
SCHEMA = "scenic-ref/table/2"
OWN = {
    "seed": TEXT, "scene": INT64, "attempts": INT64, "weight": FLOAT, "object": INT64, "ego": BOOL, "name": TEXT, "class": TEXT,
    "x": FLOAT, "y": FLOAT, "heading": FLOAT, "width": FLOAT, "length": FLOAT,
}
"""The columns that every table has: metres and radians; `seed` is text, since seeds have no bounds; an object may have no `name`."""
PARTS = ("properties", "params")
"""Beside them a table has a column for each property of an object and for each global parameter: `properties.NAME`, `params.NAME`."""
Columns = dict[str, TypedColumn]
"""The columns of some rows, all of one length; the rows of a scene are together, scenes in order."""


def part_of(name: str) -> tuple[str, str] | None:
    """Return the part to which a column belongs, and its name there; None for a column of its own."""
    part, _, inner = name.partition(".")
    return (part, inner) if part in PARTS else None


def column_name(part: str, name: str) -> str:
    """The column of a property or parameter."""
    return f"{part}.{in_utf8(name)}"


def columns_of(scenes: Iterable[Mapping[str, Any]]) -> Columns:
    """The columns of scenes in the scene format."""
    rows = [row for scene in scenes for row in rows_of(scene)]
    return {name: column_of([row.get(name) for row in rows]) for name in order_columns({name for row in rows for name in row})}


def order_columns(names: Iterable[str]) -> list[str]:
    """The names of the columns in the order of tables: those of their own, properties, parameters."""
    return [*OWN, *sorted({*names} - OWN.keys(), key=lambda name: (PARTS.index(name.partition(".")[0]), name))]


def rows_of(scene: Mapping[str, Any]) -> list[dict[str, object]]:
    """One row per object of a scene in the scene format."""
    shared = {"seed": str(scene["seed"]), "scene": scene["scene"], "attempts": scene["attempts"], "weight": float(scene["weight"])}
    params = {column_name("params", name): value for name, value in scene["params"].items()}
    return [
        {
            **shared, "object": o["id"], "ego": o["id"] == scene["ego"], "name": o["name"], "class": o["class"],
            "x": float(o["position"][0]), "y": float(o["position"][1]), "heading": float(o["heading"]), "width": float(o["width"]),
            "length": float(o["length"]), **{column_name("properties", name): value for name, value in o["properties"].items()}, **params,
        }
        for o in scene["objects"]
    ]


def rows_in(columns: Columns) -> int:
    """The number of rows."""
    return columns["scene"].rows


def together(pieces: Sequence[Columns]) -> Columns:
    """The rows of some columns after those of others; a column that one of them lacks has no values there."""
    if len(pieces) == 1:
        return pieces[0]
    names = order_columns({name for piece in pieces for name in piece})
    return {name: concatenate_columns([piece[name] if name in piece else empty_column(rows_in(piece)) for piece in pieces]) for name in names}


def some(columns: Columns, rows: slice | np.ndarray) -> Columns:
    """Some of the rows."""
    return {name: select_rows(column, rows) for name, column in columns.items()}


def pieces_of(scenes: Iterable[Mapping[str, Any]]) -> Iterator[Columns]:
    """The columns of scenes in the scene format, of some at a time."""
    waiting = iter(scenes)
    while several := list(islice(waiting, SCENES_AT_ONCE)):
        yield columns_of(several)


class Groups:
    """Rows put together from single scenes and from pieces of whole ones, and cut into groups."""

    def __init__(self) -> None:
        self.scenes: list[Mapping[str, Any]] = []
        self.pieces: list[Columns] = []
        self.rows = 0

    def add_scene(self, scene: Mapping[str, Any]) -> Iterator[Columns]:
        """The groups that the objects of one more scene, given in the scene format, complete."""
        self.scenes.append(scene)
        if len(self.scenes) >= SCENES_AT_ONCE:
            yield from self.settled()

    def settled(self) -> Iterator[Columns]:
        """The groups that the single scenes complete."""
        if self.scenes:
            columns, self.scenes = columns_of(self.scenes), []
            yield from self.add(columns)

    def add(self, columns: Columns) -> Iterator[Columns]:
        """The groups that these further rows complete."""
        yield from self.settled()
        self.pieces.append(columns)
        self.rows += rows_in(columns)
        while self.rows >= ROWS_AT_ONCE:
            whole = together(self.pieces)
            end = end_of_scene(whole["scene"].values, ROWS_AT_ONCE)
            self.pieces, self.rows = ([some(whole, slice(end, None))] if end < self.rows else []), self.rows - end
            yield some(whole, slice(0, end))

    def rest(self) -> Iterator[Columns]:
        """The last groups, if there are rows left."""
        yield from self.settled()
        if self.rows:
            yield together(self.pieces)


def end_of_scene(scenes: np.ndarray, row: int) -> int:
    """The first row, from `row` on, at which another scene begins."""
    return int(np.searchsorted(scenes, scenes[row - 1], side="right"))
