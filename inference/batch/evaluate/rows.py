"""Nodes that stand for calls of Python, row by row, and that have columns all the same: tests on polygons, fields, clipped curves."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ....semantics.kernel.outcome import Requirement
from ....semantics.space.fields import PolygonalVectorField
from ....semantics.space.regions.polygons import PolygonalRegion
from ....semantics.space.vectors import Vector
from ..trace.graph import GraphEvent, GraphNode, RowCall, RowDraw
from ..trace.structures import symbols_in
from ..trace.symbols import Traced
from .clipped import Clipped, clipped_curve, largest_radius
from .polygons import FieldTests, tests_of
from .proposed import proposed_in

Columns = Mapping[int, np.ndarray]


class FailedRows(NamedTuple):
    """Rows of a node that is computed row by row: where a requirement failed, and where the interpreter must see what happens.

    `reasons` holds what rows failed, if that is known row by row: requirements, whose place is that of the node's event.
    """

    rejected: np.ndarray
    left: np.ndarray
    reasons: np.ndarray | None = None

    def at(self, kept: np.ndarray) -> FailedRows:
        """Only the rows where `kept` is True."""
        return FailedRows(self.rejected[kept], self.left[kept], None if self.reasons is None else self.reasons[kept])

    def among(self, rows: np.ndarray, count: int) -> FailedRows:
        """The same where these are some of so many rows, of whose others none failed."""
        reasons = None if self.reasons is None else np.full(count, None)
        found = FailedRows(np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), reasons)
        found.rejected[rows], found.left[rows] = self.rejected, self.left
        if reasons is not None:
            reasons[rows] = self.reasons
        return found

    def reasons_of(self, rows: np.ndarray, event: GraphEvent) -> dict[int, Requirement]:
        """What those of these rows failed that are rejected, by their position, where it is known row by row."""
        if self.reasons is None or event.requirement is None:
            return {}
        rejected = np.flatnonzero(rows & self.rejected & ~self.left).tolist()
        return {row: self.reasons[row]._replace(span=event.requirement.span) for row in rejected}


def note(stuck: Counter[Requirement], event: GraphEvent, lost: np.ndarray, failed: Mapping[int, FailedRows]) -> None:
    """Count what rows failed that an event ends."""
    if event.requirement is None:
        return
    own = failed[event.node.number].reasons_of(lost, event) if event.node.number in failed else {}
    stuck.update(own.values())
    if rest := int(np.count_nonzero(lost)) - len(own):
        stuck[event.requirement] += rest


Fast = Callable[[GraphNode, RowCall, Columns, dict[int, FailedRows], int], np.ndarray]


def has_columns(call: RowCall) -> Fast | None:
    """How a call is computed for many rows at a time, if there is a way."""
    rule = FAST.get(call.function)
    if rule is None:
        return None
    if symbols_in(call.structure[0]) or (rule is _heading and not constant_cells(call.structure[0])):
        return None
    return rule


def always_gives_a_value(function: object) -> bool:
    """Whether a row-by-row node has columns: then each row has a value, or is rejected since there is none."""
    if isinstance(function, RowDraw):
        return is_clipped(function) is not None or proposed_in(function.distribution) is not None
    return isinstance(function, RowCall) and has_columns(function) is not None


def is_clipped(draw: RowDraw) -> Clipped | None:
    """The curve and the sector, if the draw is that of a point of a curve in a sector of bounded radius."""
    found = clipped_curve(draw.distribution)
    return found if found is not None and math.isfinite(largest_radius(found.radius)) else None


@lru_cache(maxsize=64)
def constant_cells(field: object) -> bool:
    """Whether a polygonal field has a constant heading in each cell and none outside."""
    return isinstance(field, PolygonalVectorField) and bool(field.cells) and all(isinstance(h, (int, float)) for _, h in field.cells)


@lru_cache(maxsize=64)
def field_of(field: PolygonalVectorField) -> tuple[FieldTests, np.ndarray]:
    """The cells of a field and their headings."""
    headings = [float(h) for _, h in field.cells]  # type: ignore[arg-type]
    outside = np.nan if field.defaultHeading is None else field.defaultHeading
    return FieldTests(tuple(field.closed)), np.array([*headings, outside])


def values_of(structure: Sequence[object], columns: Columns, count: int) -> list[np.ndarray]:
    """Numbers and vectors as columns of numbers."""
    found: list[np.ndarray] = []
    for value in structure:
        for part in (value.x, value.y) if isinstance(value, Vector) else (value,):
            symbol = part.number() if isinstance(part, Traced) and part.node.kind == "int" else part
            found.append(columns[symbol.node.number].astype(float) if isinstance(symbol, Traced) else np.full(count, float(symbol)))  # type: ignore[arg-type]
    return found


def _heading(node: GraphNode, call: RowCall, columns: Columns, failed: dict[int, FailedRows], count: int) -> np.ndarray:
    field, v = call.structure
    tests, headings = field_of(field)  # type: ignore[arg-type]
    result = headings[tests.first(*values_of((v,), columns, count))]
    outside = np.isnan(result)
    if outside.any():
        failed[node.number] = FailedRows(outside, np.zeros(count, dtype=bool))
    return result


def _point_in(node: GraphNode, call: RowCall, columns: Columns, failed: dict[int, FailedRows], count: int) -> np.ndarray:
    region, v = call.structure
    return tests_of(region).contains_point(*values_of((v,), columns, count))  # type: ignore[arg-type]


def _box_in(node: GraphNode, call: RowCall, columns: Columns, failed: dict[int, FailedRows], count: int) -> np.ndarray:
    region, *box = call.structure
    return tests_of(region).contains_box(*values_of(box, columns, count))  # type: ignore[arg-type]


FAST: dict[Callable[..., object], Fast] = {
    PolygonalVectorField._value_at: _heading,  # pyright: ignore[reportPrivateUsage]
    PolygonalRegion.contains_point: _point_in,
    PolygonalRegion.contains_box: _box_in,
}
