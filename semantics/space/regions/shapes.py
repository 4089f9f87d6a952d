"""Discs, sectors and rectangles: regions with a closed form for everything (Disc and Sector of the Figure "Notation").

`resolution` is how many sides the released implementations give a circle that they approximate; these are exact. `name` says nothing either.
"""

from __future__ import annotations

import math
from dataclasses import InitVar, dataclass, field
from functools import lru_cache, reduce

import numpy as np
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from .. import geometry
from ..boundaries import METRES, RADIANS
from ..geometry import TAU
from ..numeric import either, every, larger, negation, smaller, square_root
from ..vectors import Vector
from . import intervals
from .approximation import Approximation, Bounds, box_shape
from .checking import finite, nonnegative, vector
from .errors import EmptyRegion
from .intervals import Intervals
from .region import Region
from .sampling import Numbers

_ROUNDING = 1e-12  # cores are shrunk and covers grown by this share, so that rounding the vertices breaks neither


@dataclass(frozen=True)
class CircularRegion(Region):
    """Disc(center, radius), in metres.

    Example: `ego = Object in CircularRegion((0, 0), 5)`
    """

    is_simple = True

    center: Vector
    radius: float
    resolution: InitVar[int] = 32
    name: str | None = field(default=None, compare=False, repr=False)

    def __post_init__(self, resolution: int) -> None:
        object.__setattr__(self, "center", vector("circle", "center", self.center))
        object.__setattr__(self, "radius", nonnegative("circle", "radius", self.radius))

    def contains_point(self, v: Vector) -> bool:
        x, y = v.x - self.center.x, v.y - self.center.y
        reach = self.radius + METRES
        return x * x + y * y <= reach * reach

    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return every(map(self.contains_point, geometry.corners(position, heading, width, length)))

    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return geometry.distance_to_box(position, heading, width, length, self.center) <= self.radius + METRES

    def distance_to(self, v: Vector) -> float:
        return larger(0.0, geometry.distance(self.center, v) - self.radius)

    def bounds(self) -> Bounds:
        (x, y), r = self.center, self.radius
        return x - r, y - r, x + r, y + r

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        if self.radius == 0:
            center = Point(self.center.x, self.center.y)
            return Approximation(center, center)
        return Approximation(*(_placed(ring, self.center, self.radius, 0.0) for ring in _arc_shapes(TAU, sides)))

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        x, y = start.x - self.center.x, start.y - self.center.y
        return intervals.where_within_disc(x, y, end.x - start.x, end.y - start.y, self.radius)

    def measure(self) -> float:
        return math.pi * self.radius * self.radius

    def sample(self, uniform: Numbers) -> Vector:
        return _point_of_sector(self, self.center, self.radius, 0.0, TAU, uniform)


def past_right_side(a: float, b: float, c: float, d: float) -> float:
    """How far past the right side of a gap an edge gets where it is not right of the left one, 0 if it does not.

    Its ends are a and b past the left side, c and d past the right one; metres.
    """
    first = either(a >= 0, lambda: c, lambda: 0.0)
    return larger(first, either(a * b < 0, lambda: c + (d - c) * a / (a - b), lambda: 0.0))


@dataclass(frozen=True)
class SectorRegion(Region):
    """Sector(center, radius, heading, angle): the part of a disc within angle/2 of `heading`; an angle ≥ 2π is the disc.

    Example: `ego = Object in SectorRegion((0, 0), 10, 45 deg, 90 deg)`
    """

    is_simple = True

    center: Vector
    radius: float
    heading: float
    angle: float
    resolution: InitVar[int] = 32
    name: str | None = field(default=None, compare=False, repr=False)

    def __post_init__(self, resolution: int) -> None:
        object.__setattr__(self, "center", vector("sector", "center", self.center))
        object.__setattr__(self, "radius", nonnegative("sector", "radius", self.radius))
        object.__setattr__(self, "heading", finite("sector", "heading", self.heading))
        object.__setattr__(self, "angle", nonnegative("sector", "angle", self.angle))

    def contains_point(self, v: Vector) -> bool:
        return geometry.sector_contains(self.center, self.radius, self.heading, self.angle, v)

    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        corners = geometry.corners(position, heading, width, length)
        inside = every(map(self.contains_point, corners))
        if inside is False or self.angle <= math.pi or self.angle >= TAU - RADIANS:
            return inside
        return inside & negation(self._gap_meets(corners))

    def _gap_meets(self, corners: tuple[Vector, ...]) -> bool:
        """Whether the convex polygon meets the open wedge that the sector leaves out (narrower than π) by more than its boundary.

        It does if some point p is strictly left of the sector's left side, and some point q of those not right of that side is
        strictly right of the right side: points near q on the way to p are then strictly inside the gap.
        """
        left, right = (geometry.direction(self.heading + sign * self.angle / 2) for sign in (1, -1))
        offsets = [corner - self.center for corner in corners]
        past_left = [left.x * v.y - left.y * v.x for v in offsets]
        past_right = [v.x * right.y - v.y * right.x for v in offsets]
        furthest = 0.0
        for i in range(len(offsets)):
            furthest = larger(furthest, past_right_side(past_left[i - 1], past_left[i], past_right[i - 1], past_right[i]))
        return every([reduce(larger, past_left) > METRES, furthest > METRES])

    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return geometry.sector_meets_box(self.center, self.radius, self.heading, self.angle, position, heading, width, length)

    def distance_to(self, v: Vector) -> float:
        offset = v - self.center
        if geometry.wedge_contains(self.heading, self.angle, offset):
            return max(0.0, geometry.length_of(offset) - self.radius)
        half, mid = self.angle / 2, Vector(0.0, self.radius / 2)
        sides = ((geometry.offset_local(self.center, h, mid), h) for h in (self.heading + half, self.heading - half))
        return min(geometry.distance_to_box(middle, h, 0.0, self.radius, v) for middle, h in sides)

    def bounds(self) -> Bounds:
        if self.angle >= TAU:
            return CircularRegion(self.center, self.radius).bounds()
        half, quarter = self.angle / 2, math.pi / 2
        first, last = math.ceil((self.heading - half) / quarter), math.floor((self.heading + half) / quarter)
        headings = [self.heading - half, self.heading + half, *(k * quarter for k in range(first, last + 1))]
        tips = [geometry.offset_local(self.center, h, Vector(0.0, self.radius)) for h in headings]
        xs, ys = [self.center.x, *(tip.x for tip in tips)], [self.center.y, *(tip.y for tip in tips)]
        return min(xs), min(ys), max(xs), max(ys)

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        if self.angle >= TAU or self.radius == 0:
            return CircularRegion(self.center, self.radius).approximate(sides, window)
        if self.angle == 0:
            tip = geometry.offset_local(self.center, self.heading, Vector(0.0, self.radius))
            ray = LineString([tuple(self.center), tuple(tip)])
            return Approximation(ray, ray)
        return Approximation(*(_placed(ring, self.center, self.radius, self.heading) for ring in _arc_shapes(self.angle, sides)))

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        disc = CircularRegion(self.center, self.radius).intervals(start, end)
        if self.angle >= TAU:
            return disc
        a, b, half = start - self.center, end - self.center, self.angle / 2
        left, right, middle = (geometry.direction(h) for h in (self.heading + half, self.heading - half, self.heading))
        past_right = intervals.where_nonnegative(right.x * a.y - right.y * a.x, right.x * b.y - right.y * b.x)
        before_left = intervals.where_nonnegative(a.x * left.y - a.y * left.x, b.x * left.y - b.y * left.x)
        if self.angle > math.pi:
            return intervals.intersection(disc, intervals.union(past_right, before_left))
        ahead = intervals.where_nonnegative(middle.x * a.x + middle.y * a.y, middle.x * b.x + middle.y * b.y)
        return intervals.intersection(disc, intervals.intersection(ahead, intervals.intersection(past_right, before_left)))

    def measure(self) -> float:
        return smaller(self.angle, TAU) * self.radius * self.radius / 2

    def sample(self, uniform: Numbers) -> Vector:
        return _point_of_sector(self, self.center, self.radius, self.heading, smaller(self.angle, TAU), uniform)


@dataclass(frozen=True)
class RectangularRegion(Region):
    """The rectangle with its centre at `position`, `width` metres across `heading` and `length` metres along it.

    Example: `ego = Object in RectangularRegion((0, 0), 30 deg, 4, 8)`
    """

    is_simple = True

    position: Vector
    heading: float
    width: float
    length: float
    name: str | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", vector("rectangle", "position", self.position))
        object.__setattr__(self, "heading", finite("rectangle", "heading", self.heading))
        object.__setattr__(self, "width", nonnegative("rectangle", "width", self.width))
        object.__setattr__(self, "length", nonnegative("rectangle", "length", self.length))

    def contains_point(self, v: Vector) -> bool:
        return geometry.box_contains(self.position, self.heading, self.width, self.length, v)

    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return every(map(self.contains_point, geometry.corners(position, heading, width, length)))

    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return geometry.boxes_intersect(
            self.position, self.heading, self.width, self.length, position, heading, width, length
        )  # fmt: skip

    def distance_to(self, v: Vector) -> float:
        return geometry.distance_to_box(self.position, self.heading, self.width, self.length, v)

    def bounds(self) -> Bounds:
        corners = geometry.corners(self.position, self.heading, self.width, self.length)
        xs, ys = [corner.x for corner in corners], [corner.y for corner in corners]
        return min(xs), min(ys), max(xs), max(ys)

    @property
    def polygon(self) -> BaseGeometry:
        """The rectangle as a polygon; a line or a point if it has no width or length."""
        return box_shape(self.position, self.heading, self.width, self.length)

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return Approximation(self.polygon, self.polygon)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        a, b = (geometry.to_local(self.position, self.heading, v) for v in (start, end))
        inside = intervals.ALL
        for half, p, q in ((self.width / 2 + METRES, a.x, b.x), (self.length / 2 + METRES, a.y, b.y)):
            inside = intervals.intersection(inside, intervals.where_nonnegative(half - p, half - q))
            inside = intervals.intersection(inside, intervals.where_nonnegative(half + p, half + q))
        return inside

    def measure(self) -> float:
        return self.width * self.length

    def sample(self, uniform: Numbers) -> Vector:
        if self.measure() == 0:
            raise EmptyRegion(self, "it has no area")
        x, y = (uniform() - 0.5) * self.width, (uniform() - 0.5) * self.length
        return geometry.offset_local(self.position, self.heading, Vector(x, y))


def _point_of_sector(region: Region, center: Vector, radius: float, heading: float, angle: float, uniform: Numbers) -> Vector:
    """A uniform point of the sector from two numbers: the distance r√u has density proportional to itself."""
    if radius * radius * angle == 0:
        raise EmptyRegion(region, "it has no area")
    away, turn = radius * square_root(uniform()), (uniform() - 0.5) * angle
    return geometry.offset_local(center, heading + turn, Vector(0.0, away))


@lru_cache(maxsize=64)
def _arc_shapes(angle: float, sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Inscribed and circumscribed rings, (n, 2), of the sector of radius 1 about the origin along North."""
    pieces = max(1, math.ceil(sides * angle / TAU), math.ceil(4 * angle / math.pi))
    step = angle / pieces
    ends = np.linspace(-angle / 2, angle / 2, pieces + 1)
    tangents = (ends[:-1] + ends[1:]) / 2
    inner = _on_circle(ends, 1 - _ROUNDING)
    outer = _on_circle(tangents, (1 + _ROUNDING) / math.cos(step / 2))
    if angle >= TAU:
        return inner[:-1], outer
    rim = _on_circle(ends[[0, -1]], 1 + _ROUNDING)
    apex = np.zeros((1, 2))
    return np.concatenate([apex, inner]), np.concatenate([apex, rim[:1], outer, rim[1:]])


def _on_circle(headings: np.ndarray, radius: float) -> np.ndarray:
    return radius * np.stack([-np.sin(headings), np.cos(headings)], axis=1)


def _placed(ring: np.ndarray, center: Vector, radius: float, heading: float) -> BaseGeometry:
    """The ring scaled by `radius`, turned by `heading` and moved to `center`, as a polygon."""
    c, s = math.cos(heading), math.sin(heading)
    return Polygon((ring * radius) @ np.array([[c, s], [-s, c]]) + (center.x, center.y))
