"""Uniform points of the intersection of two regions, at least one of which differs from run to run, such as `visible road`: for many runs at a time.

As in `semantics.space.regions.combined`, points are drawn in the smaller region until one is in the other.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np

from ....semantics.space.distributions import PointIn
from ....semantics.space.regions import CircularRegion, PolygonalRegion, RectangularRegion, Region, SectorRegion
from ....semantics.space.regions.combined import PROPOSALS, IntersectionRegion
from ....semantics.space.vectors import Vector
from ..trace.graph import RowDraw, Site
from ..trace.structures import in_row, symbols_in
from ..trace.symbols import Choice, Opaque
from .numbers import Numbers
from .polygons import tests_of

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
