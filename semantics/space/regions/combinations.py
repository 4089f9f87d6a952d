"""Intersections, unions and differences of regions: exact predicates where the parts have them, sampling by rejection.

A difference holds the points of the first region that are not in the second, hence not on the second's edge; but what touches that edge alone
meets it, as `intersects` and collisions with boxes see its closure.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import shapely
from shapely.geometry import Point, Polygon

from ..boundaries import METRES, common, without
from ..fields import OutsideField, VectorField
from ..numeric_functions import every, lift_method
from ..vectors import Vector
from . import parameter_intervals
from .approximation import (
    LEVELS,
    NO_BOUNDS,
    Approximation,
    Bounds,
    as_core,
    as_cover,
    box_shape,
    contains,
    hull,
    levels,
    overlap,
    polygonal,
    union_inside,
    window_around,
)
from .errors import EmptyRegion, UnboundedRegion
from .parameter_intervals import Intervals
from .point_sampling import Numbers, Segment, SegmentSampler, TriangleSampler
from .region import Everywhere, Nowhere, Region, everywhere, nowhere

_GOOD_COVER = 0.5  # a cover is close enough for sampling if at least this share of it is core
_POOREST_COVER = 1e-3  # a region is too thin to be told from the empty set if the finest cover has less core than this
PROPOSALS = 128
"""So many points are drawn in the smaller part of an intersection before its shape is worked out, which takes as long as thousands."""
_CERTAINTY = 200.0  # sampling gives up after so many tries that it would fail by chance with probability exp(-200)

def intersection(first: Region, second: Region) -> Region:
    """first ∩ second, the simpler region where one is everywhere or nowhere."""
    if isinstance(first, Nowhere) or isinstance(second, Nowhere):
        return nowhere
    if isinstance(first, Everywhere) or isinstance(second, Everywhere):
        return second if isinstance(first, Everywhere) else first
    return IntersectionRegion(first, second)


def union(first: Region, second: Region) -> Region:
    """first ∪ second, the simpler region where one is everywhere or nowhere."""
    if isinstance(first, Everywhere) or isinstance(second, Everywhere):
        return everywhere
    if isinstance(first, Nowhere) or isinstance(second, Nowhere):
        return second if isinstance(first, Nowhere) else first
    return UnionRegion(first, second)


def difference(first: Region, second: Region) -> Region:
    """first minus second, simplified likewise."""
    if isinstance(first, Nowhere) or isinstance(second, Everywhere):
        return nowhere
    return first if isinstance(second, Nowhere) else DifferenceRegion(first, second)


def share_a_point(first: Region, second: Region) -> bool:
    """Whether first ∩ second ≠ ∅; see `Region.intersects`."""
    both = IntersectionRegion(first, second)
    window = window_around(both.bounds() or hull(both.extent(), (0.0, 0.0, 0.0, 0.0)))
    for sides in LEVELS:
        one, other = first.approximate(sides, window), second.approximate(sides, window)
        if shapely.dwithin(one.core, other.core, METRES):
            return True
        if not shapely.dwithin(one.cover, other.cover, METRES):
            return False
    return True


@dataclass(frozen=True, eq=False)
class _Combination(Region):
    """A region made of two others. Points are sampled from a close cover, and those outside the region drawn again."""

    scenic_made = True
    first: Region
    second: Region

    def extent(self) -> Bounds:
        return hull(self.first.extent(), self.second.extent())

    def measure(self) -> float | None:
        if self.dimension < 2:
            return self._segment_sampler.total if self.dimension == 1 else float(len(self._points))
        return None if self.bounds() is None else self._area

    @cached_property
    def _limits(self) -> Bounds | None:
        return self.bounds()

    def sample(self, uniform: Numbers) -> Vector:
        if self._limits is None:
            raise UnboundedRegion(self)
        if self._limits == NO_BOUNDS:
            raise EmptyRegion(self, "its parts are apart")
        return (self._sample_point, self._sample_curve, self._sample_area)[self.dimension](uniform)

    def _sample_area(self, uniform: Numbers) -> Vector:
        sampler, tries = self._triangle_sampler
        for _ in range(tries):
            point = sampler.sample(uniform)
            if self.contains_point(point):
                return point
        raise EmptyRegion(self, "it is too small for its coordinates")

    def _sample_curve(self, uniform: Numbers) -> Vector:
        if self._segment_sampler.total == 0:
            raise EmptyRegion(self, "it has no length")
        return self._segment_sampler.sample(uniform)

    def _sample_point(self, uniform: Numbers) -> Vector:
        if not self._points:
            raise EmptyRegion(self, "it has no points")
        return self._points[int(uniform() * len(self._points))]

    @cached_property
    def _area(self) -> float:
        """The area; where arcs are involved, by extrapolation: with n sides for a circle the error is some c / n² + O(1 / n³)."""
        window = window_around(self.bounds() or NO_BOUNDS)
        coarse, fine = (self.approximate(sides, window) for sides in (2048, 4096))
        area = polygonal(fine.core).area
        return area if fine.exact else area + (area - polygonal(coarse.core).area) / 3

    @cached_property
    def _triangle_sampler(self) -> tuple[TriangleSampler, int]:
        """A sampler of a cover, and after how many tries at most one of its points is in the region."""
        core, cover = 0.0, Polygon()
        for approximation in levels(self, window_around(self.bounds() or NO_BOUNDS)):
            core, cover = polygonal(approximation.core).area, polygonal(approximation.cover)
            if core >= _GOOD_COVER * cover.area:
                break
        if core == 0 or core < _POOREST_COVER * cover.area:
            raise EmptyRegion(self, "it has no area")
        return TriangleSampler(cover), math.ceil(_CERTAINTY * cover.area / core)

    @cached_property
    def _segment_sampler(self) -> SegmentSampler:
        return SegmentSampler(tuple(self.segments()))

    @cached_property
    def _points(self) -> tuple[Vector, ...]:
        return tuple(self.points())


def _kept_segments(curve: Region, keep: Callable[[Vector, Vector], Intervals], within: Bounds | None) -> Iterable[Segment]:
    """The parts of the curve's segments whose parameters `keep` gives."""
    for start, end in curve.segments(within):
        for low, high in keep(start, end):
            if low < high:
                yield start + (end - start) * low, start + (end - start) * high


@dataclass(frozen=True, eq=False)
class IntersectionRegion(_Combination):
    """The points in both regions (⟦R⟧ ∩ visibleRegion(P) in the paper), oriented as the first, else as the second."""

    @property
    def dimension(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        least = min(self.first.dimension, self.second.dimension)
        return 0 if least == 1 and self._crossings and self._segment_sampler.total == 0 else least

    @cached_property
    def _crossings(self) -> tuple[Vector, ...]:
        """The points in which two curves meet."""
        bounds = self.bounds()
        if self.first.dimension != 1 or self.second.dimension != 1 or bounds is None or bounds == NO_BOUNDS:
            return ()
        window = window_around(bounds, METRES)
        both = common(self.first.approximate(1, window).cover, self.second.approximate(1, window).cover)
        return tuple(Vector(float(part.x), float(part.y)) for part in shapely.get_parts(both) if isinstance(part, Point))

    @property
    def orientation(self) -> VectorField | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.first.orientation if self.first.orientation is not None else self.second.orientation

    def contains_point(self, v: Vector) -> bool:
        return every(part.contains_point(v) for part in (self.first, self.second))

    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        box = (position, heading, width, length)
        return every(part.contains_box(*box) for part in (self.first, self.second))

    def _sample_area(self, uniform: Numbers) -> Vector:
        if self.proposed is not None:
            smaller, other = self.proposed
            for _ in range(PROPOSALS):
                point = smaller.sample(uniform)
                if other.contains_point(point):
                    return point
        return super()._sample_area(uniform)

    @cached_property
    def proposed(self) -> tuple[Region, Region] | None:
        """The part in which points are drawn that may lie in the other, and the other: the smaller one of those that are easily drawn from."""
        areas = [(part.measure() or 0.0, part, other) for part, other in ((self.first, self.second), (self.second, self.first)) if part.is_simple]
        positive = [entry for entry in areas if 0.0 < entry[0] < math.inf]
        return min(positive, key=lambda entry: entry[0])[1:] if positive else None

    def bounds(self) -> Bounds | None:
        first, second = self.first.bounds(), self.second.bounds()
        return second if first is None else first if second is None else overlap(first, second)

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        first, second = self.first.approximate(sides, window), self.second.approximate(sides, window)
        both = common(first.cover, second.cover)
        if first.exact and second.exact:
            cover = as_cover(both)
            return Approximation(cover, cover)
        return Approximation(as_core(common(first.core, second.core)), as_cover(both))

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return parameter_intervals.intersection(self.first.intervals(start, end), self.second.intervals(start, end))

    def segments(self, within: Bounds | None = None) -> Iterable[Segment]:
        curve, other = (self.first, self.second) if self.first.dimension == 1 else (self.second, self.first)
        bounds = self._limits
        near = bounds if within is None or bounds is None else overlap(bounds, within)
        return _kept_segments(curve, other.intervals, near)

    def points(self) -> Iterable[Vector]:
        if self._crossings:
            return self._crossings
        few, other = (self.first, self.second) if self.first.dimension == 0 else (self.second, self.first)
        return (point for point in few.points() if other.contains_point(point))


@dataclass(frozen=True, eq=False)
class UnionRegion(_Combination):
    """The points in either region. Parts of lower dimension have no measure: sampling ignores them."""

    @property
    def dimension(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        return max(self.first.dimension, self.second.dimension)

    @cached_property
    def orientation(self) -> VectorField | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        if self.first.orientation is None or self.second.orientation is None:
            return None
        return VectorField(f"{self.first.orientation.name} or {self.second.orientation.name}", self._orientation_at)

    @lift_method(float)
    def _orientation_at(self, v: Vector) -> float:
        """The orientation of the first part that contains `v`."""
        for part in (self.first, self.second):
            if part.orientation is not None and part.contains_point(v):
                return part.orientation.at(v)
        assert self.orientation is not None
        raise OutsideField(self.orientation, v)

    @lift_method(bool)
    def contains_point(self, v: Vector) -> bool:
        return self.first.contains_point(v) or self.second.contains_point(v)

    @lift_method(bool)
    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        box = (position, heading, width, length)
        if self.first.contains_box(*box) or self.second.contains_box(*box):
            return True
        return contains(self, box_shape(*box))

    @lift_method(bool)
    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        box = (position, heading, width, length)
        return self.first.meets_box(*box) or self.second.meets_box(*box)

    @lift_method(float)
    def distance_to(self, v: Vector) -> float:
        return min(self.first.distance_to(v), self.second.distance_to(v))

    def bounds(self) -> Bounds | None:
        first, second = self.first.bounds(), self.second.bounds()
        return None if first is None or second is None else hull(first, second)

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        first, second = self.first.approximate(sides, window), self.second.approximate(sides, window)
        cover = as_cover(union_inside(window, first.cover, second.cover))
        if first.exact and second.exact:
            return Approximation(cover, cover)
        return Approximation(as_core(union_inside(window, first.core, second.core)), cover)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return parameter_intervals.union(self.first.intervals(start, end), self.second.intervals(start, end))

    def segments(self, within: Bounds | None = None) -> Iterable[Segment]:
        yield from self.first.segments(within)
        yield from _kept_segments(self.second, lambda a, b: parameter_intervals.complement(self.first.intervals(a, b)), within)

    def points(self) -> Iterable[Vector]:
        yield from self.first.points()
        yield from (point for point in self.second.points() if not self.first.contains_point(point))


@dataclass(frozen=True, eq=False)
class DifferenceRegion(_Combination):
    """The points of the first region that are not in the second, oriented as the first."""

    @property
    def dimension(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.first.dimension

    @property
    def orientation(self) -> VectorField | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.first.orientation

    @lift_method(bool)
    def contains_point(self, v: Vector) -> bool:
        return self.first.contains_point(v) and not self.second.contains_point(v)

    @lift_method(bool)
    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        box = (position, heading, width, length)
        return self.first.contains_box(*box) and not self.second.meets_box(*box)

    def bounds(self) -> Bounds | None:
        return self.first.bounds()

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        first, second = self.first.approximate(sides, window), self.second.approximate(sides, window)
        cover = as_cover(without(first.cover, second.core))
        if first.exact and second.exact:
            return Approximation(cover, cover)
        return Approximation(as_core(without(first.core, second.cover)), cover)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return parameter_intervals.intersection(self.first.intervals(start, end), parameter_intervals.complement(self.second.intervals(start, end)))

    def segments(self, within: Bounds | None = None) -> Iterable[Segment]:
        return _kept_segments(self.first, lambda a, b: parameter_intervals.complement(self.second.intervals(a, b)), within)

    def points(self) -> Iterable[Vector]:
        return (point for point in self.first.points() if not self.second.contains_point(point))
