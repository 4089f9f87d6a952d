"""How far inside a region many points are, in metres: the distance to the boundary, negative outside.

At the corners of a sector or a combination, outside, it is a lower bound of the distance; its sign is exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ....semantics.space.geometry import TAU
from ....semantics.space.regions import (
    CircularRegion,
    DifferenceRegion,
    IntersectionRegion,
    PolygonalRegion,
    RectangularRegion,
    Region,
    SectorRegion,
    UnionRegion,
    Workspace,
)
from ..trace.graph import GraphNode
from ..trace.symbols import Choice, Opaque, Traced
from .polygons import tests_of

ColumnOf = Callable[[GraphNode], np.ndarray]
Array = np.ndarray
COMBINED = (IntersectionRegion, UnionRegion, DifferenceRegion)


def is_known(region: Region) -> bool:
    """Whether `inside_by` can tell of such a region."""
    match region:
        case Workspace():
            return is_known(region.region)
        case IntersectionRegion() | UnionRegion() | DifferenceRegion():
            return is_known(region.first) and is_known(region.second)
        case CircularRegion() | SectorRegion() | RectangularRegion():
            return all(isinstance(v, (int, float)) or (isinstance(v, Traced) and not isinstance(v, (Choice, Opaque))) for v in numbers_in(region))
        case _:
            return isinstance(region, PolygonalRegion)


def numbers_in(region: Region) -> list[object]:
    """The symbols among the numbers that make up a region."""
    match region:
        case Workspace():
            return numbers_in(region.region)
        case IntersectionRegion() | UnionRegion() | DifferenceRegion():
            return [*numbers_in(region.first), *numbers_in(region.second)]
        case CircularRegion(center=c, radius=r):
            found = [c.x, c.y, r]
        case SectorRegion(center=c, radius=r, heading=h, angle=a):
            found = [c.x, c.y, r, h, a]
        case RectangularRegion(position=c, heading=h, width=w, length=l):
            found = [c.x, c.y, h, w, l]
        case _:
            found = []
    return [v for v in found if isinstance(v, Traced)]


def sectors_in(region: Region) -> list[SectorRegion]:
    """The sectors that a region is made of, but for discs: near the arc of one its sides hide what is near the arc alone."""
    match region:
        case Workspace():
            return sectors_in(region.region)
        case IntersectionRegion() | UnionRegion() | DifferenceRegion():
            return [*sectors_in(region.first), *sectors_in(region.second)]
        case SectorRegion(angle=angle) if not isinstance(angle, (int, float)) or angle < TAU:
            return [region]
        case _:
            return []


def within_arc(region: SectorRegion, x: Array, y: Array, column_of: ColumnOf) -> Array:
    """How far within the circle of a sector's arc the points are."""
    x0, y0, radius = (column_of(v.node) if isinstance(v, Traced) else v for v in (region.center.x, region.center.y, region.radius))
    return radius - np.hypot(x - x0, y - y0)


def reach_of(region: Region) -> float | None:
    """The largest coordinate of a region, in metres."""
    bounds = region.bounds()
    return None if bounds is None else max(1.0, *map(abs, bounds))


def inside_by(region: Region, x: Array, y: Array, column_of: ColumnOf) -> Array:
    """How far inside the points are, where the numbers of the region may be symbols with columns."""

    def number(value: object) -> object:
        return column_of(value.node) if isinstance(value, Traced) else value

    match region:
        case Workspace():
            return inside_by(region.region, x, y, column_of)
        case IntersectionRegion():
            return np.minimum(inside_by(region.first, x, y, column_of), inside_by(region.second, x, y, column_of))
        case UnionRegion():
            return np.maximum(inside_by(region.first, x, y, column_of), inside_by(region.second, x, y, column_of))
        case DifferenceRegion():
            return np.minimum(inside_by(region.first, x, y, column_of), -inside_by(region.second, x, y, column_of))
        case CircularRegion(center=c, radius=r):
            return number(r) - np.hypot(x - number(c.x), y - number(c.y))  # type: ignore[operator]
        case SectorRegion(center=c, radius=r, heading=h, angle=a):
            return inside_sector(x - number(c.x), y - number(c.y), number(r), number(h), number(a))  # type: ignore[operator, arg-type]
        case RectangularRegion(position=c, heading=h, width=w, length=l):
            dx, dy, turn = x - number(c.x), y - number(c.y), number(h)  # type: ignore[operator]
            u, v = dx * np.cos(turn) + dy * np.sin(turn), dy * np.cos(turn) - dx * np.sin(turn)  # type: ignore[call-overload]
            return np.minimum(number(w) / 2 - np.abs(u), number(l) / 2 - np.abs(v))  # type: ignore[operator]
        case PolygonalRegion():
            return inside_polygon(region, x, y)
        case _:
            raise AssertionError(region)


def inside_sector(x: Array, y: Array, radius: Array | float, heading: Array | float, angle: Array | float) -> Array:
    """How far inside a sector with its apex at the origin the points are."""
    far = np.hypot(x, y)
    off = np.abs((np.arctan2(-x, y) - heading + math.pi) % TAU - math.pi)
    past = np.asarray(angle) / 2 - off
    side = np.where(np.abs(past) <= math.pi / 2, far * np.sin(past), np.sign(past) * far)
    return np.where(np.asarray(angle) >= TAU, radius - far, np.minimum(radius - far, side))


def inside_polygon(region: PolygonalRegion, x: Array, y: Array) -> Array:
    """How far inside a polygon the points are, up to `reach_within` of it: further inside and outside all are at that distance."""
    tests, reach = tests_of(region), reach_within(region)
    grid, _ = tests.grid_for(reach)
    known = np.isfinite(x) & np.isfinite(y)
    px, py = np.where(known, x, 0.0), np.where(known, y, 0.0)
    square, rows = grid.square_of(px, py), np.arange(len(px))
    nearest = np.full(len(px), reach * reach)
    for k in range(grid.most):
        rows = rows[grid.counts[square[rows]] > k]
        if not len(rows):
            break
        ax, ay, bx, by = tests.edges[grid.lists[square[rows], k]].T
        dx, dy, ux, uy = bx - ax, by - ay, px[rows] - ax, py[rows] - ay
        along = np.clip((ux * dx + uy * dy) / np.maximum(dx * dx + dy * dy, 1e-300), 0.0, 1.0)
        off = (ux - along * dx) ** 2 + (uy - along * dy) ** 2
        nearest[rows] = np.minimum(nearest[rows], off)
    distance = np.sqrt(nearest)
    return np.where(known, np.where(tests.contains_point(px, py), distance, -distance), np.nan)


@lru_cache(maxsize=64)
def reach_within(region: PolygonalRegion) -> float:
    """How far from the boundary of a polygon points are told apart, in metres: half the width of a road, for a net of them."""
    return float(region.polygon.area / region.polygon.length)
