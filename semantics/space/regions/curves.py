"""Regions without area: polylines (such as curbs) and finite sets of points."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import shapely
import shapely.ops
from shapely.geometry import LineString, MultiLineString, MultiPoint, Point, Polygon

from ..boundaries import METRES
from ..fields import VectorField
from ..geometry import angle_of
from ..numeric import lifted, pick
from ..vectors import Vector
from . import intervals
from .approximation import NO_BOUNDS, Approximation, Bounds, window_around
from .checking import checked_number_field, vectors
from .errors import BadRegion, EmptyRegion
from .intervals import Intervals
from .plane_shapes import PlaneShape
from .polygons import intervals_within
from .region import Region
from .sampling import Numbers, Segment, SegmentSampler

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

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """The heading of the line at its point nearest to `v`."""
        start, end = self.nearestSegmentTo(v)
        return angle_of(end - start)

    def nearestSegmentTo(self, point: Vector | Sequence[float]) -> Segment:
        """The two ends of the segment that is nearest, the first of several (of the released implementations)."""
        nearest = self.segment_tree.query_nearest(Point(*point), all_matches=True)
        return self._all_segments[int(min(nearest))]

    @lifted(float)
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

    @lifted(bool)
    def contains_point(self, v: Vector) -> bool:
        return bool(shapely.dwithin(self.polyline, Point(v.x, v.y), METRES))

    @lifted(float)
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
            for low, high in intervals.complement(intervals_within(earlier, start, end)):
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

    @lifted(bool)
    def contains_point(self, v: Vector) -> bool:
        return bool(shapely.dwithin(self._shape, Point(v.x, v.y), METRES))

    @lifted(float)
    def distance_to(self, v: Vector) -> float:
        return float(self._shape.distance(Point(v.x, v.y))) if self._points else float("inf")

    def bounds(self) -> Bounds:
        return self._shape.bounds if self._points else NO_BOUNDS

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return Approximation(self._shape, self._shape)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return intervals.NONE

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
