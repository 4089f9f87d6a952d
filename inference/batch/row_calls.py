"""Nodes that stand for calls of Python, row by row, and those on regions and fields that are made for a column of rows at a time."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from ...semantics.machine.outcome import Requirement
from ...semantics.space.boundaries import METRES
from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.regions import AlongCurve, PolygonalRegion, PolylineRegion
from ...semantics.space.vectors import Vector
from .graph import GraphEvent, HasValue, RowCall, RowDraw
from .primitives.drawn_points import Clipped, clipped_curve, largest_radius, proposed_in
from .primitives.point_in_polygon import constant_cells, field_of, tests_of
from .symbolic import METHODS, Choice, Opaque, Traced, symbols_in

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
        """Return the failures of these rows placed among `count` rows, of whose others none failed."""
        reasons = None if self.reasons is None else np.full(count, None)
        found = FailedRows(np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), reasons)
        found.rejected[rows], found.left[rows] = self.rejected, self.left
        if reasons is not None:
            reasons[rows] = self.reasons
        return found

    def reasons_of(self, rows: np.ndarray, event: GraphEvent) -> dict[int, Requirement]:
        """Return the requirements that rejected rows failed, by position, if that is known row by row."""
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


def always_gives_a_value(function: object) -> bool:
    """Whether a node that decides runs has columns: then each row has a value, or is rejected since there is none."""
    if isinstance(function, HasValue):
        return not function.left.any()
    if isinstance(function, RowDraw):
        return is_clipped(function) is not None or proposed_in(function.distribution) is not None
    return isinstance(function, RowCall) and column_methods(function) is not None


def is_clipped(draw: RowDraw) -> Clipped | None:
    """The curve and the sector, if the draw is that of a point of a curve in a sector of bounded radius."""
    found = clipped_curve(draw.distribution)
    return found if found is not None and math.isfinite(largest_radius(found.radius)) else None


def values_of(structure: Sequence[object], columns: Columns, count: int) -> list[np.ndarray]:
    """Numbers and vectors as columns of numbers."""
    found: list[np.ndarray] = []
    for value in structure:
        for part in (value.x, value.y) if isinstance(value, Vector) else (value,):
            symbol = part.number() if isinstance(part, Traced) and part.node.kind == "int" else part
            found.append(columns[symbol.node.number].astype(float) if isinstance(symbol, Traced) else np.full(count, float(symbol)))  # type: ignore[arg-type]
    return found


ColumnCall = Callable[..., np.ndarray]
"""A method for many rows: from its owner and columns of numbers to a column of results, NaN where a row has none."""
Owned = tuple[object, ColumnCall]
"""A method for many rows, with the region or field that owns it."""


def heading_along(curve: PolylineRegion, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the headings of a curve at its points nearest to (x, y): those of the first of the nearest segments."""
    row, segment = curve.segment_tree.query_nearest(shapely.points(x, y), all_matches=True)
    first = np.full(len(x), len(curve.headings), dtype=np.int64)
    np.minimum.at(first, row, segment)
    return np.append(curve.headings, np.nan)[first]


def distance_from_polygon(region: PolygonalRegion, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the distances of (x, y) from a polygon, 0 within it."""
    return np.asarray(shapely.distance(region.polygon, shapely.points(x, y)))


def heading_in_field(field: PolygonalVectorField, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the headings of a field with constant cells at (x, y); NaN outside of its cells."""
    tests, headings = field_of(field)
    return headings[tests.first(x, y)]


POLYGON_TESTS: dict[Callable[..., object], ColumnCall] = {
    PolygonalRegion.contains_point: lambda region, x, y: tests_of(region).contains_point(x, y),
    PolygonalRegion.contains_box: lambda region, *box: tests_of(region).contains_box(*box),
    PolygonalVectorField._value_at: heading_in_field,  # pyright: ignore[reportPrivateUsage]
}
"""The calls that compiled code and tensors have forms for as well."""
COLUMN_CALLS: dict[Callable[..., object], ColumnCall] = {
    **POLYGON_TESTS,
    PolygonalRegion.distance_to: distance_from_polygon,
    PolylineRegion.contains_point: lambda region, x, y: shapely.dwithin(region.polyline, shapely.points(x, y), METRES),
    PolylineRegion.distance_to: lambda region, x, y: shapely.distance(region.polyline, shapely.points(x, y)),
    PolylineRegion.heading_at: heading_along,
}
NAMES = {function: name for name, (function, _) in METHODS.items()}
"""The names of the methods that the rules of the language ask of a region or field that differs from row to row."""


def is_polygon_test(call: RowCall) -> bool:
    """Return whether a call is a test on one polygon, or asks one field with constant cells."""
    if call.function not in POLYGON_TESTS or symbols_in(call.structure[0]):
        return False
    return not isinstance(call.structure[0], PolygonalVectorField) or constant_cells(call.structure[0])


def column_methods(call: RowCall) -> list[Owned] | None:
    """Return the method of the owner that all rows share, or those of the values of a choice; None if one has no such form."""
    if not call.structure or not all(map(has_number_columns, call.structure[1:])):
        return None
    owner = call.structure[0]
    if isinstance(owner, Choice):
        name = NAMES.get(call.function)
        methods = [] if name is None else [method_named(name, value) for value in owner.values]
        found = [method for method in methods if method is not None]
        return found if found and len(found) == len(methods) else None
    if call.function in POLYGON_TESTS and not is_polygon_test(call):
        return None
    method = COLUMN_CALLS.get(call.function)
    return None if method is None else [(owner, method)]


def has_number_columns(argument: object) -> bool:
    """Return whether an argument is a number or a vector, so that it has columns of numbers."""
    parts = (argument.x, argument.y) if isinstance(argument, Vector) else (argument,)
    return all(not isinstance(part, (Choice, Opaque)) and isinstance(part, (Traced, int, float)) for part in parts)


def method_named(name: str, owner: object) -> Owned | None:
    """Return the method of that name of a region or field, if it has a form for many rows."""
    if name == "at":
        if isinstance(owner, AlongCurve):
            return owner.curve, heading_along
        return (owner, heading_in_field) if isinstance(owner, PolygonalVectorField) and constant_cells(owner) else None
    method = COLUMN_CALLS.get(getattr(type(owner), name, None))  # type: ignore[arg-type]
    return None if method is None else (owner, method)


def call_by_owner(methods: Sequence[Owned], chosen: np.ndarray, values: Sequence[np.ndarray], kind: str) -> np.ndarray:
    """Call each method once, for the rows in which it is the `chosen` one, and return the column of all results."""
    result = np.empty(len(chosen), dtype=bool if kind == "bool" else float)
    order = np.argsort(chosen, kind="stable")
    borders = np.flatnonzero(np.diff(chosen[order])) + 1
    for rows in np.split(order, borders) if len(order) else ():
        owner, method = methods[int(chosen[rows[0]])]
        result[rows] = method(owner, *(column[rows] for column in values))
    return result

