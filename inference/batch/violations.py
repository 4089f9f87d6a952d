"""How far a run is from meeting a requirement: its violation, which is 0 exactly where it is met.

Comparisons are as far off as their sides differ, `and` as its worst part, `or` as its best; boxes that must not meet, as deep as they overlap on
the axis that separates them best; a box or a point that must lie in a polygon, as far as it sticks out. What has no such measure is violated
by 1. A requirement that counts only where a coin shows heads is as far off as the coin is from tails, if that is nearer. So the states whose
violation is at most a level are nested, and those of level 0 are the accepted runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...semantics.space.regions import PolygonalRegion
from .graph import GraphEvent, GraphNode, Macro, RowCall
from .primitives.point_in_polygon import tests_of
from .row_calls import values_of

UNKNOWN = 1.0
"""What a truth value is worth whose distance from changing is not known."""
LEAST = 1e-12
"""A requirement that is not met is violated by more than nothing."""
DIFFERENCES = {np.less: 1, np.less_equal: 1, np.greater: -1, np.greater_equal: -1}


class Margin:
    """By how much conditions hold (not, where it is negative), as a column."""

    def __init__(self, values: np.ndarray) -> None:
        self.values = values

    def __and__(self, other: object) -> Margin:
        return Margin(np.minimum(self.values, margin_of(other)))

    def __or__(self, other: object) -> Margin:
        return Margin(np.maximum(self.values, margin_of(other)))

    def __invert__(self) -> Margin:
        return Margin(-self.values)

    __rand__, __ror__ = __and__, __or__


def margin_of(value: object) -> Any:
    """A margin's numbers; a truth value is as far from changing as can be."""
    return value.values if isinstance(value, Margin) else np.where(np.asarray(value), np.inf, -np.inf)


class Slack(np.ndarray):
    """A column whose comparisons tell by how much they hold."""

    def __le__(self, other: object) -> Any:
        return Margin(np.asarray(other) - np.asarray(self))

    def __ge__(self, other: object) -> Any:
        return Margin(np.asarray(self) - np.asarray(other))

    def __lt__(self, other: object) -> Any:
        return self <= other

    def __gt__(self, other: object) -> Any:
        return self >= other


def violation(node: GraphNode, columns: Mapping[int, np.ndarray], wrong: np.ndarray) -> np.ndarray:
    """By how much a condition is violated in the rows `wrong`, where it is not met (or is, and must not be)."""
    found = np.abs(margin(node, Rows(columns, np.flatnonzero(wrong))))
    return np.where(np.isfinite(found), np.maximum(found, LEAST), UNKNOWN)


def decisive(event: GraphEvent) -> list[GraphNode]:
    """The conditions one of which must change for the requirement of an event to be met: its own, and that under which it counts."""
    return [event.node] if event.condition is None else [event.node, event.condition]


class Rows(Mapping[int, np.ndarray]):
    """The columns of an evaluation in some of its rows."""

    def __init__(self, columns: Mapping[int, np.ndarray], rows: np.ndarray) -> None:
        self.columns, self.rows = columns, rows

    def __getitem__(self, number: int) -> np.ndarray:
        return self.columns[number][self.rows]

    def __iter__(self) -> Any:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)


def margin(node: object, columns: Rows) -> np.ndarray:
    """By how much a condition holds in each row: not where it is negative."""
    count = len(columns.rows)
    if not isinstance(node, GraphNode):
        return np.broadcast_to(margin_of(node), count)
    function, arguments = node.function, node.arguments
    if function in DIFFERENCES:
        left, right = (columns[a.number].astype(float) if isinstance(a, GraphNode) else a for a in arguments)
        with np.errstate(invalid="ignore"):
            return DIFFERENCES[function] * (right - left)  # type: ignore[index, operator]
    if function is np.logical_not:
        return -margin(arguments[0], columns)
    if function in (np.logical_and, np.logical_or):
        best = np.minimum if function is np.logical_and else np.maximum
        return best(*(margin(a, columns) for a in arguments))
    if function is np.where:
        condition, *sides = arguments
        chosen: Any = columns[condition.number] if isinstance(condition, GraphNode) else condition
        return np.where(np.asarray(chosen, dtype=bool), *(margin(a, columns) for a in sides))
    truth = columns[node.number].astype(bool)
    if isinstance(function, Macro):
        known = of_macro(function, [columns[a.number] if isinstance(a, GraphNode) else a for a in arguments], count)
    elif isinstance(function, RowCall) and function.function in IN_POLYGON and isinstance(function.structure[0], PolygonalRegion):
        region, *structure = function.structure
        known = polygon_margin(region, truth, values_of(structure, columns, count))  # type: ignore[arg-type]
    else:
        known = None
    return np.where(truth, UNKNOWN, -UNKNOWN) if known is None else known


def of_macro(function: Macro, operands: list[Any], count: int) -> np.ndarray | None:
    """The margin of a geometric test made of comparisons, if it says one."""
    try:
        with np.errstate(all="ignore"):
            found = function.call([np.broadcast_to(np.asarray(v, dtype=float), count).view(Slack) for v in operands])
    except (TypeError, ValueError):
        return None
    return found.values if isinstance(found, Margin) else None


IN_POLYGON = (PolygonalRegion.contains_point, PolygonalRegion.contains_box)


def polygon_margin(region: PolygonalRegion, inside: np.ndarray, values: list[np.ndarray]) -> np.ndarray:
    """Of a point or a box in a polygon: how far it is from the boundary, or the farthest corner from the polygon."""
    x, y = values[:2]
    if len(values) == 2:
        away = points_away(tests_of(region).edges, x, y)
    else:
        heading, width, length = values[2:]
        c, s = np.cos(heading), np.sin(heading)
        corners = [(a * width / 2, b * length / 2) for a in (-1, 1) for b in (-1, 1)]
        away = np.max([points_away(tests_of(region).edges, x + a * c - b * s, y + a * s + b * c) for a, b in corners], axis=0)
    return np.where(inside, UNKNOWN, -away)


PAIRS = 1 << 16
"""So many pairs of a point and an edge are looked at at a time."""


def points_away(edges: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """How far points are outside of the polygon with these edges; 0 inside."""
    step = max(1, PAIRS // len(edges))
    parts = [few_away(edges, x[first : first + step, None], y[first : first + step, None]) for first in range(0, len(x), step)]
    return np.concatenate(parts) if parts else np.zeros(0)


def few_away(edges: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return how far a few points, which stand below each other, are outside of the polygon with these edges;
    0 inside.
    """
    ax, ay, bx, by = edges.T
    dx, dy = bx - ax, by - ay
    squared = dx * dx + dy * dy
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(squared == 0, 0.0, np.clip(((x - ax) * dx + (y - ay) * dy) / squared, 0.0, 1.0))
        crossed = ((ay > y) != (by > y)) & (x < ax + (y - ay) / dy * dx)  # by a ray to the East
    least = ((ax + share * dx - x) ** 2 + (ay + share * dy - y) ** 2).min(axis=1)
    return np.where(np.logical_xor.reduce(crossed, axis=1), 0.0, np.sqrt(least))
