"""Uniform points of intersections of regions that differ from run to run, such as `visible road`: by clipping curves, and by proposals."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import shapely

from ....semantics.space.distributions import PointIn
from ....semantics.space.geometry import TAU, direction
from ....semantics.space.regions import (
    CircularRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    Region,
    SectorRegion,
)
from ....semantics.space.regions.combinations import PROPOSALS, IntersectionRegion
from ....semantics.space.vectors import Vector
from ..graph import RowDraw, Site
from ..symbolic import Choice, Opaque, Traced, in_row, symbols_in
from .point_in_polygon import TIE, Grid, tests_of
from .random_numbers import Numbers


class Clipped(NamedTuple):
    """A curve, and the numbers of a sector (heading and angle are 0 and 2π for a disc), which may be symbols."""

    curve: PolylineRegion
    x: Any
    y: Any
    radius: Any
    heading: Any
    angle: float


def clipped_curve(distribution: object) -> Clipped | None:
    """The curve and the sector, if the distribution is that of a point in their intersection and the sector is not wider than a half-plane."""
    if not (isinstance(distribution, PointIn) and isinstance(distribution.region, IntersectionRegion)):
        return None
    first, second = distribution.region.first, distribution.region.second
    curve, other = (first, second) if isinstance(first, PolylineRegion) else (second, first)
    if not isinstance(curve, PolylineRegion):
        return None
    match other:
        case CircularRegion(center=center, radius=radius):
            return Clipped(curve, center.x, center.y, radius, 0.0, TAU)
        case SectorRegion(center=center, radius=radius, heading=heading, angle=angle) if not symbols_in(angle):
            return Clipped(curve, center.x, center.y, radius, heading, angle) if angle <= math.pi or angle >= TAU else None
        case _:
            return None


def largest_radius(radius: object) -> float:
    """A bound of the radius, in metres; infinite if there is none."""
    if isinstance(radius, Traced):
        return radius.node.bounds[1] if radius.node.bounds is not None else math.inf
    return float(radius)  # type: ignore[arg-type]


class CurveTests:
    """The segments of a curve, and which are within `reach` metres of where."""

    def __init__(self, curve: PolylineRegion, reach: float) -> None:
        segments = tuple(curve.segments())
        self.start = np.array([(a.x, a.y) for a, _ in segments])
        self.end = np.array([(b.x, b.y) for _, b in segments])
        lines = shapely.linestrings(np.stack([self.start, self.end], axis=1))
        self.grid = Grid(np.asarray(lines), max(reach / 2, 1.0), reach + 100 * TIE * (1 + float(np.abs(self.start).max())))

    def sample(self, x: np.ndarray, y: np.ndarray, radius: np.ndarray, heading: np.ndarray, angle: float, uniform: np.ndarray) -> np.ndarray:
        """Points, (rows, 2); NaN where no part of the curve is in the sector."""
        square = self.grid.square_of(x, y)
        rows, most = len(x), self.grid.most
        low, high, ends = np.zeros((most, rows)), np.zeros((most, rows)), np.zeros((most, rows))
        length = np.zeros((most, rows))
        total = np.zeros(rows)
        for k in range(most):
            near = np.flatnonzero(self.grid.counts[square] > k)
            segment = self.grid.lists[square[near], k]
            low[k, near], high[k, near] = self.inside(segment, x[near], y[near], radius[near], heading[near], angle)
            sx, sy, ex, ey = self.piece(segment, low[k, near], high[k, near])
            length[k, near] = np.where(low[k, near] < high[k, near], np.hypot(ex - sx, ey - sy), 0.0)
            total += length[k]
            ends[k] = total
        target = uniform * total
        beyond = (target < ends) & (length > 0)
        last = most - 1 - np.argmax(length[::-1] > 0, axis=0) if most else np.zeros(rows, dtype=np.int64)
        chosen = np.where(beyond.any(axis=0), beyond.argmax(axis=0), last) if most else last
        every = np.arange(rows)
        if not most:
            return np.full((rows, 2), np.nan)
        sx, sy, ex, ey = self.piece(self.grid.lists[square, chosen], low[chosen, every], high[chosen, every])
        before = np.where(chosen > 0, ends[chosen - 1, every], 0.0)
        with np.errstate(all="ignore"):
            share = np.minimum((target - before) / (ends[chosen, every] - before), 1.0)
        points = np.stack([sx + (ex - sx) * share, sy + (ey - sy) * share], axis=1)
        points[total == 0] = np.nan
        return points

    def piece(self, segment: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Both ends of the parts of segments with these parameters."""
        (x, y), (dx, dy) = self.start[segment].T, (self.end[segment] - self.start[segment]).T
        return x + dx * low, y + dy * low, x + dx * high, y + dy * high

    def inside(
        self, segment: np.ndarray, x: np.ndarray, y: np.ndarray, radius: np.ndarray, heading: np.ndarray, angle: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """The parameters of the part in the sector; the first is the larger one where there is none."""
        (px, py), (qx, qy) = self.start[segment].T, self.end[segment].T
        dx, dy = qx - px, qy - py
        ax, ay = px - x, py - y
        a, b, c = dx * dx + dy * dy, ax * dx + ay * dy, ax * ax + ay * ay - radius * radius
        discriminant = b * b - a * c
        with np.errstate(invalid="ignore"):
            root = np.sqrt(discriminant)
        low = np.where(discriminant >= 0, np.maximum(0.0, (-b - root) / a), 2.0)
        high = np.where(discriminant >= 0, np.minimum(1.0, (-b + root) / a), -1.0)
        if angle < TAU:
            bx, by = qx - x, qy - y
            left, right, middle = (direction(h) for h in (heading + angle / 2, heading - angle / 2, heading))  # pyright: ignore[reportArgumentType]
            for start, end in (
                (right.x * ay - right.y * ax, right.x * by - right.y * bx),
                (ax * left.y - ay * left.x, bx * left.y - by * left.x),
                (middle.x * ax + middle.y * ay, middle.x * bx + middle.y * by),
            ):
                with np.errstate(all="ignore"):
                    crossing = start / (start - end)
                low = np.maximum(low, np.where(start < 0, np.where(end < 0, 2.0, crossing), 0.0))
                high = np.minimum(high, np.where(start < 0, np.where(end < 0, -1.0, 1.0), np.where(end < 0, crossing, 1.0)))
        return low, high


@lru_cache(maxsize=64)
def curve_tests(curve: PolylineRegion, reach: float) -> CurveTests:
    """The tests of a curve, made once."""
    return CurveTests(curve, reach)


SHAPES = (CircularRegion, SectorRegion, RectangularRegion, PolygonalRegion)
SIZES = ("radius", "angle", "width", "length")


class Proposed(NamedTuple):
    """The region in which points are drawn, and the one in which they must lie."""

    smaller: Region
    other: Region


def proposed_in(distribution: object) -> Proposed | None:
    """Both regions, if the distribution is that of a point in an intersection of two such; their sizes must be the same in all runs."""
    region = distribution.region if isinstance(distribution, PointIn) else None
    if not isinstance(region, IntersectionRegion):
        return None
    for part in (region.first, region.second):
        if not isinstance(part, SHAPES) or symbols_in([getattr(part, size) for size in SIZES if hasattr(part, size)]):
            return None
        if any(isinstance(symbol, (Choice, Opaque)) for symbol in symbols_in(part)):
            return None
    return None if region.proposed is None else Proposed(*region.proposed)


def proposed_points(found: Proposed, columns: Mapping[int, np.ndarray], numbers: Numbers, draw: RowDraw) -> np.ndarray:
    """Points, (rows, 2); NaN where none of `PROPOSALS` candidates lies in both regions."""
    points, rows = np.full((len(numbers), 2), np.nan), np.arange(len(numbers))
    numbers = numbers.copy()
    used = 0

    def uniform() -> Any:
        nonlocal used
        used += 1
        return numbers.column(Site(draw.address, used - 1, draw.per_scene))

    for _ in range(PROPOSALS):
        smaller, other = (with_columns(region, columns, rows) for region in found)
        point = point_of(smaller, uniform)
        kept = contains(other, point)
        points[rows[kept]] = np.stack([point.x, point.y], axis=1)[kept]
        rows = rows[~kept]
        if not len(rows):
            break
        numbers.keep(~kept)
    return points


def with_columns(region: Region, columns: Mapping[int, np.ndarray], rows: np.ndarray) -> Region:
    """The region in some rows: its position and heading are columns, which its constructor would refuse."""
    if not symbols_in(region):
        return region
    made = copy.copy(region)
    for field in fields(region):  # type: ignore[arg-type]
        value = in_row(getattr(region, field.name), lambda node: columns[node.number][rows].astype(float))
        object.__setattr__(made, field.name, value)
    return made


def point_of(region: Region, uniform: Callable[[], Any]) -> Vector:
    """`region.sample`, for as many rows as there are numbers."""
    if not isinstance(region, PolygonalRegion):
        return region.sample(uniform)
    sampler = region.sampler
    along = uniform() * sampler.total
    chosen = np.searchsorted(sampler.cumulative[:-1], along, side="right")
    return sampler.point(sampler.triangles[chosen].reshape(-1, 6).T, along, uniform)


def contains(region: Region, point: Vector) -> np.ndarray:
    """`region.contains_point`, for a column of points."""
    if isinstance(region, PolygonalRegion):
        return tests_of(region).contains_point(point.x, point.y)  # type: ignore[arg-type]
    return np.asarray(region.contains_point(point))

