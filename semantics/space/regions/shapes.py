"""Regions with a closed form: discs, sectors and rectangles (Disc and Sector of the paper), and those without area: polylines (such as curbs) and
finite sets of points.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import InitVar, dataclass, field
from functools import cached_property, lru_cache, reduce

import numpy as np
import shapely
import shapely.ops
from shapely.geometry import LineString, MultiLineString, MultiPoint, Point, Polygon
from shapely.geometry.base import BaseGeometry

from .. import geometry
from ..boundaries import METRES, RADIANS
from ..fields import VectorField
from ..geometry import TAU, angle_of
from ..numeric_functions import either, every, larger, lift_method, negation, pick, smaller, square_root
from ..vectors import Vector
from . import parameter_intervals
from .approximation import NO_BOUNDS, Approximation, Bounds, box_shape, window_around
from .errors import BadRegion, EmptyRegion
from .parameter_intervals import Intervals
from .plane_shapes import PlaneShape
from .point_sampling import Numbers, Segment, SegmentSampler
from .polygons import intervals_within
from .region import Region
from .region_checks import check_finite, check_vector, checked_number_field, nonnegative, vectors

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
        object.__setattr__(self, "center", check_vector("circle", "center", self.center))
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
        return Approximation(*(_place_ring(ring, self.center, self.radius, 0.0) for ring in _arc_shapes(TAU, sides)))

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        x, y = start.x - self.center.x, start.y - self.center.y
        return parameter_intervals.where_within_disc(x, y, end.x - start.x, end.y - start.y, self.radius)

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
        object.__setattr__(self, "center", check_vector("sector", "center", self.center))
        object.__setattr__(self, "radius", nonnegative("sector", "radius", self.radius))
        object.__setattr__(self, "heading", check_finite("sector", "heading", self.heading))
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
            return max(0.0, geometry.vector_norm(offset) - self.radius)
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
        return Approximation(*(_place_ring(ring, self.center, self.radius, self.heading) for ring in _arc_shapes(self.angle, sides)))

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        disc = CircularRegion(self.center, self.radius).intervals(start, end)
        if self.angle >= TAU:
            return disc
        a, b, half = start - self.center, end - self.center, self.angle / 2
        left, right, middle = (geometry.direction(h) for h in (self.heading + half, self.heading - half, self.heading))
        past_right = parameter_intervals.where_nonnegative(right.x * a.y - right.y * a.x, right.x * b.y - right.y * b.x)
        before_left = parameter_intervals.where_nonnegative(a.x * left.y - a.y * left.x, b.x * left.y - b.y * left.x)
        if self.angle > math.pi:
            return parameter_intervals.intersection(disc, parameter_intervals.union(past_right, before_left))
        ahead = parameter_intervals.where_nonnegative(middle.x * a.x + middle.y * a.y, middle.x * b.x + middle.y * b.y)
        return parameter_intervals.intersection(
            disc, parameter_intervals.intersection(ahead, parameter_intervals.intersection(past_right, before_left))
        )

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
        object.__setattr__(self, "position", check_vector("rectangle", "position", self.position))
        object.__setattr__(self, "heading", check_finite("rectangle", "heading", self.heading))
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
        inside = parameter_intervals.ALL
        for half, p, q in ((self.width / 2 + METRES, a.x, b.x), (self.length / 2 + METRES, a.y, b.y)):
            inside = parameter_intervals.intersection(inside, parameter_intervals.where_nonnegative(half - p, half - q))
            inside = parameter_intervals.intersection(inside, parameter_intervals.where_nonnegative(half + p, half + q))
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


def _place_ring(ring: np.ndarray, center: Vector, radius: float, heading: float) -> BaseGeometry:
    """The ring scaled by `radius`, turned by `heading` and moved to `center`, as a polygon."""
    c, s = math.cos(heading), math.sin(heading)
    return Polygon((ring * radius) @ np.array([[c, s], [-s, c]]) + (center.x, center.y))


MOST_POINTS = 100_000


class PolylineRegion(Region):
    """The curve through `points`, or a given shapely LineString, MultiLineString or sequence of LineStrings.

    `orientation` True orients each point along the line, in the direction of its points (the nearest segment's, the first of
    several); a vector field orients it so; False or None not at all. Raises `BadRegion` for what is not a curve.

    Example: `ego = Object on PolylineRegion([(0, 0), (0, 10), (5, 20)])`
    """

    dimension = 1

    def __init__(
        self,
        points: Sequence[Vector | Sequence[float]] | None = None,
        polyline: LineString | MultiLineString | Iterable[LineString] | None = None,
        orientation: VectorField | bool | None = True,
        name: str | None = None,
    ) -> None:
        if (points is None) == (polyline is None):
            raise BadRegion("a polyline region is given either by its points or by a polyline")
        paths = [vectors("polyline", points)] if points is not None else _paths(polyline)
        self.name = name
        self.lines: tuple[tuple[Vector, ...], ...] = tuple(paths)
        self._all_segments: tuple[Segment, ...] = tuple((a, b) for path in paths for a, b in itertools.pairwise(path) if a != b)
        if not self._all_segments:
            raise BadRegion("a polyline needs at least 2 different points")
        self.polyline = MultiLineString([[(v.x, v.y) for v in path] for path in paths])
        shapely.prepare(self.polyline)
        along = AlongCurve(f"along {name or 'polyline'}", self)
        self.orientation = along if orientation is True else checked_number_field("PolylineRegion", orientation or None)

    def __repr__(self) -> str:
        return f"PolylineRegion({self.name or self.polyline!r})"

    @lift_method(float)
    def heading_at(self, v: Vector) -> float:
        """The heading of the line at its point nearest to `v`."""
        start, end = self.nearestSegmentTo(v)
        return angle_of(end - start)

    def nearestSegmentTo(self, point: Vector | Sequence[float]) -> Segment:
        """The two ends of the segment that is nearest, the first of several (of the released implementations)."""
        nearest = self.segment_tree.query_nearest(Point(*point), all_matches=True)
        return self._all_segments[int(min(nearest))]

    @lift_method(float)
    def signedDistanceTo(self, point: Vector | Sequence[float]) -> float:
        """The distance from the line to the point in metres, negative to the right of the nearest segment (of the released implementations)."""
        v = Vector(*point)
        start, end = self.nearestSegmentTo(v)
        along, off = end - start, v - start
        return self.distance_to(v) if along.x * off.y - along.y * off.x >= 0 else -self.distance_to(v)

    def project(self, point: Vector | Sequence[float]) -> Vector:
        """The point of the line that is nearest (of the released implementations)."""
        nearest, _ = shapely.ops.nearest_points(self.polyline, Point(*point))
        return Vector(nearest.x, nearest.y)

    def pointAlongBy(self, distance: float, normalized: bool = False) -> Vector:
        """The point that many metres along the line, or that part of its length (of the released implementations)."""
        part = shapely.line_interpolate_point(shapely.line_merge(self.polyline), distance, normalized=normalized)
        return Vector(part.x, part.y)

    def equallySpacedPoints(self, num: int) -> list[Vector]:
        """So many points, at equal distances along the line, its ends among them; one is its beginning (of the released implementations)."""
        if not isinstance(num, int) or not 1 <= num <= MOST_POINTS:
            raise ValueError(f"there can be 1 to {MOST_POINTS} points, not {num!r}")
        return [self.pointAlongBy(i / max(num - 1, 1), normalized=True) for i in range(num)]

    def pointsSeparatedBy(self, distance: float) -> list[Vector]:
        """The points of the line at that distance along it from each other, from its beginning on (of the released implementations)."""
        if not distance > 0 or self.polyline.length / distance > MOST_POINTS:
            raise ValueError(f"the points of a line of {self.polyline.length} m cannot be {distance!r} m apart")
        return [self.pointAlongBy(i * distance) for i in range(math.ceil(self.polyline.length / distance))]

    def __iter__(self) -> Iterator[Vector]:
        return (point for line in self.lines for point in line)

    @cached_property
    def headings(self) -> list[float]:
        """The headings of the segments, in order."""
        return [angle_of(end - start) for start, end in self._all_segments]

    @cached_property
    def plane_shape(self) -> PlaneShape:
        """The line as programs meet it: one LineString where it is in one piece."""
        parts = shapely.get_parts(self.polyline)
        return PlaneShape(parts[0] if len(parts) == 1 else self.polyline)

    @cached_property
    def segment_tree(self) -> shapely.STRtree:
        """The segments, in order."""
        return shapely.STRtree([LineString([(a.x, a.y), (b.x, b.y)]) for a, b in self._all_segments])

    @lift_method(bool)
    def contains_point(self, v: Vector) -> bool:
        return bool(shapely.dwithin(self.polyline, Point(v.x, v.y), METRES))

    @lift_method(float)
    def distance_to(self, v: Vector) -> float:
        return float(self.polyline.distance(Point(v.x, v.y)))

    def bounds(self) -> Bounds:
        return self.polyline.bounds

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return Approximation(self.polyline, self.polyline)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return intervals_within(self.polyline, start, end)

    @cached_property
    def _disjoint_segments(self) -> tuple[Segment, ...]:
        """The segments, without the parts that earlier ones cover already."""
        if shapely.union_all(self.polyline).length >= self.polyline.length * (1 - 1e-12):
            return self._all_segments
        kept: list[Segment] = []
        for start, end in self._all_segments:
            earlier = shapely.union_all([LineString([tuple(a), tuple(b)]) for a, b in kept]) if kept else LineString()
            for low, high in parameter_intervals.complement(intervals_within(earlier, start, end)):
                kept.append((start + (end - start) * low, start + (end - start) * high))
        return tuple(kept)

    @cached_property
    def _disjoint_tree(self) -> shapely.STRtree:
        return shapely.STRtree([LineString([tuple(a), tuple(b)]) for a, b in self._disjoint_segments])

    def segments(self, within: Bounds | None = None) -> Iterable[Segment]:
        if within is None:
            return self._disjoint_segments
        window = window_around(within, METRES)
        near = sorted(self._disjoint_tree.query(window)) if not window.is_empty else ()
        return tuple(self._disjoint_segments[int(i)] for i in near)

    @cached_property
    def sampler(self) -> SegmentSampler:
        """The line cut into segments that overlap nowhere."""
        return SegmentSampler(self._disjoint_segments)

    def measure(self) -> float:
        return self.sampler.total

    def sample(self, uniform: Numbers) -> Vector:
        return self.sampler.sample(uniform)


class AlongCurve(VectorField):
    """The field that has the heading of a curve at its nearest point."""

    scenic_made = True

    def __init__(self, name: str, curve: PolylineRegion) -> None:
        super().__init__(name, curve.heading_at)
        self.curve = curve


class PointSetRegion(Region):
    """A finite set of points, each as likely as any other; a point that is listed twice counts once.

    `kdTree` is accepted as by the released library, and not needed.

    Example: `ego = Object in PointSetRegion('stops', [(0, 0), (0, 10)])`
    """

    dimension = 0

    def __init__(
        self,
        name: str,
        points: Iterable[Vector | Sequence[float]],
        kdTree: object = None,
        orientation: VectorField | None = None,
    ) -> None:
        self.name = name
        self.orientation = checked_number_field("PointSetRegion", orientation)
        self._points = tuple(dict.fromkeys(vectors("set of points", points)))
        self._shape = MultiPoint([(v.x, v.y) for v in self._points])
        shapely.prepare(self._shape)

    def __repr__(self) -> str:
        return f"PointSetRegion({self.name!r}, {len(self._points)} points)"

    @lift_method(bool)
    def contains_point(self, v: Vector) -> bool:
        return bool(shapely.dwithin(self._shape, Point(v.x, v.y), METRES))

    @lift_method(float)
    def distance_to(self, v: Vector) -> float:
        return float(self._shape.distance(Point(v.x, v.y))) if self._points else float("inf")

    def bounds(self) -> Bounds:
        return self._shape.bounds if self._points else NO_BOUNDS

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return Approximation(self._shape, self._shape)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return parameter_intervals.NONE

    def points(self) -> Iterable[Vector]:
        return self._points

    def measure(self) -> float:
        return float(len(self._points))

    def sample(self, uniform: Numbers) -> Vector:
        if not self._points:
            raise EmptyRegion(self, "it has no points")
        return pick(self._points, uniform() * len(self._points))


def _paths(polyline: object) -> list[tuple[Vector, ...]]:
    """The corner points of the lines that `polyline` is or holds."""
    polyline = polyline.geometry if isinstance(polyline, PlaneShape) else polyline
    if isinstance(polyline, LineString):
        return [vectors("polyline", polyline.coords)] if not polyline.is_empty else []
    members = polyline.geoms if isinstance(polyline, MultiLineString) else polyline
    if not isinstance(members, Iterable):
        raise BadRegion(f"a polyline region is made of shapely linestrings, not of {polyline!r}")
    return [path for member in members for path in _paths(member)]

