"""Regions between two polygons: a core inside and a cover outside, as close as one asks for.

Predicates without a closed form are decided by them: what holds of the core holds of the region, what fails for the cover
fails for it, and in between one looks closer. At the finest level the cover decides; an arc is then known to within 1.2e-9 of
its radius (6e-8 m for 50 m). Regions with straight edges are their own core and cover, so for them the first level is exact.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import shapely
from shapely.geometry import GeometryCollection, LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from ..boundaries import METRES, common, unite_shapes, widen_shape
from ..vectors import Vector

Bounds = tuple[float, float, float, float]  # west, south, east, north

NO_BOUNDS: Bounds = (float("inf"), float("inf"), float("-inf"), float("-inf"))  # of the empty set
LEVELS = (32, 256, 4096, 65536)  # sides of the polygons that stand for a circle
_SLIVER = METRES / 10  # metres by which lines and points left over by clipping are widened when they belong to a cover


@dataclass(frozen=True)
class Approximation:
    """Geometries with core ⊆ region ⊆ cover, inside the window they were asked for. One object twice if exact."""

    core: BaseGeometry
    cover: BaseGeometry

    @property
    def exact(self) -> bool:
        """Whether core and cover are the region itself."""
        return self.core is self.cover


class Approximable(Protocol):
    """A set that can be approximated, as `Region.approximate` says."""

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        """Shapes inside and around the set."""
        ...


def levels(region: Approximable, window: Polygon) -> Iterator[Approximation]:
    """Ever closer approximations of `region` inside `window`; only one if it is exact."""
    for sides in LEVELS:
        approximation = region.approximate(sides, window)
        yield approximation
        if approximation.exact:
            return


def contains(region: Approximable, shape: BaseGeometry) -> bool:
    """Whether `shape` ⊆ `region`, a closed set."""
    for approximation in levels(region, window_around(shape.bounds)):
        if widen_shape(approximation.core).covers(shape):
            return True
        if not widen_shape(approximation.cover).covers(shape):
            return False
    return True


def meets(region: Approximable, shape: BaseGeometry) -> bool:
    """Whether `shape` ∩ `region` ≠ ∅, a closed set."""
    for approximation in levels(region, window_around(shape.bounds)):
        if shapely.dwithin(approximation.core, shape, METRES):
            return True
        if not shapely.dwithin(approximation.cover, shape, METRES):
            return False
    return True


def region_distance(region: Approximable, v: Vector, window: Polygon) -> float:
    """The distance in metres from `v` to `region`, within 1e-6 where arcs are involved; infinite for an empty region."""
    point, nearest = Point(v.x, v.y), float("inf")
    for approximation in levels(region, window):
        if approximation.cover.is_empty:
            return float("inf")
        nearest = approximation.cover.distance(point)
        if not approximation.core.is_empty and approximation.core.distance(point) - nearest < 1e-6:
            break
    return nearest


def box_shape(position: Vector, heading: float, width: float, length: float) -> BaseGeometry:
    """The box as a shape; a segment or a point if it is that thin."""
    c, s = math.cos(heading), math.sin(heading)
    across_x, across_y, along_x, along_y = width / 2 * c, width / 2 * s, -(length / 2 * s), length / 2 * c
    front_x, front_y, back_x, back_y = position.x + along_x, position.y + along_y, position.x - along_x, position.y - along_y
    points = [
        (front_x + across_x, front_y + across_y), (front_x - across_x, front_y - across_y),
        (back_x - across_x, back_y - across_y), (back_x + across_x, back_y + across_y),
    ]  # fmt: skip
    if points[0] not in (points[1], points[3]):
        return shapely.polygons(shapely.linearrings(points))  # type: ignore[return-value]
    return LineString((points[0], points[2])) if points[0] != points[2] else Point(points[0])


def window_around(bounds: Bounds, margin: float = 1.0) -> Polygon:
    """The rectangle with these bounds, widened by `margin` metres; empty for the bounds of the empty set."""
    west, south, east, north = bounds
    if not west <= east:
        return Polygon()
    return shapely.box(west - margin, south - margin, east + margin, north + margin)


def hull(first: Bounds, second: Bounds) -> Bounds:
    """The bounds of the union."""
    return min(first[0], second[0]), min(first[1], second[1]), max(first[2], second[2]), max(first[3], second[3])


def overlap(first: Bounds, second: Bounds) -> Bounds:
    """Bounds of the intersection, of which each point is within `METRES` of both."""
    west, south, east, north = max(first[0], second[0]), max(first[1], second[1]), min(first[2], second[2]), min(first[3], second[3])
    if west > east + 2 * METRES or south > north + 2 * METRES:
        return NO_BOUNDS
    return min(west, east), min(south, north), max(west, east), max(south, north)


def polygonal(shape: BaseGeometry) -> BaseGeometry:
    """The part of `shape` that has area."""
    if shape.geom_type in ("Polygon", "MultiPolygon"):
        return shape
    polygons = [part for part in shapely.get_parts(shape) if part.geom_type in ("Polygon", "MultiPolygon")]
    return unite_shapes(polygons) if polygons else Polygon()


def as_core(shape: BaseGeometry) -> BaseGeometry:
    """A subset of `shape` that later set operations accept: of a mixed collection, the polygons."""
    return polygonal(shape) if isinstance(shape, GeometryCollection) else shape


def as_cover(shape: BaseGeometry) -> BaseGeometry:
    """A superset of `shape` that later set operations accept: of a mixed collection, the parts slightly widened."""
    return shape.buffer(_SLIVER, quad_segs=1, join_style="mitre") if isinstance(shape, GeometryCollection) else shape


def union_inside(window: Polygon, first: BaseGeometry, second: BaseGeometry) -> BaseGeometry:
    """first ∪ second inside `window` (clipped first, for speed)."""
    return unite_shapes([common(first, window), common(second, window)])
