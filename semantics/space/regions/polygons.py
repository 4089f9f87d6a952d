"""Polygonal regions: areas with straight edges, such as the roads of a map."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry

from ..boundaries import GRID, unite_shapes, widen_shape
from ..fields import VectorField
from ..numeric_functions import lift_method
from ..vectors import Vector
from . import parameter_intervals
from .approximation import Approximation, Bounds, box_shape
from .errors import BadRegion
from .parameter_intervals import Intervals
from .plane_shapes import PlaneShape
from .point_sampling import Numbers, TriangleSampler
from .region import Region
from .region_checks import checked_number_field, vectors


class PolygonalRegion(Region):
    """The polygon with the corners `points`, or a given shapely polygon, multipolygon, region with straight edges, or sequence of these.

    Parts may overlap: the region is their union. `orientation` is a vector field or None. `polygon` is the union as one
    shapely geometry, to which `closed` adds the boundary; sampling uses exactly three numbers. Raises `BadRegion` for what is not a polygon.

    Example: `ego = Object in PolygonalRegion([(0, 0), (10, 0), (0, 10)])`
    """

    is_simple = True

    def __init__(
        self,
        points: Sequence[Vector | Sequence[float]] | None = None,
        polygon: Polygon | MultiPolygon | Iterable[Polygon | MultiPolygon] | None = None,
        orientation: VectorField | None = None,
        name: str | None = None,
    ) -> None:
        if (points is None) == (polygon is None):
            raise BadRegion("a polygonal region is given either by its points or by a polygon")
        if isinstance(points, Region):
            points, polygon = None, points  # type: ignore[assignment]
        parts = [_from_points(points)] if points is not None else _polygons_of(polygon)
        self.name = name
        self.orientation = checked_number_field("PolygonalRegion", orientation)
        self.polygon: Polygon | MultiPolygon = _unite_polygons([_check_polygon(part) for part in parts])

    def __repr__(self) -> str:
        return f"PolygonalRegion({self.name or self.polygon!r})"

    @lift_method(bool)
    def contains_point(self, v: Vector) -> bool:
        return bool(shapely.intersects_xy(self.closed, v.x, v.y))

    @lift_method(bool)
    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return bool(self.closed.covers(box_shape(position, heading, width, length)))

    @lift_method(bool)
    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return bool(self.closed.intersects(box_shape(position, heading, width, length)))

    @lift_method(float)
    def distance_to(self, v: Vector) -> float:
        return float(self.polygon.distance(Point(v.x, v.y)))

    def bounds(self) -> Bounds:
        return self.polygon.bounds

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return Approximation(self.polygon, self.polygon)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return intervals_within(self.closed, start, end)

    def measure(self) -> float:
        return float(self.polygon.area)

    def sample(self, uniform: Numbers) -> Vector:
        return self.sampler.sample(uniform)

    @cached_property
    def plane_shape(self) -> PlaneShape:
        """The polygon as programs meet it."""
        return PlaneShape(self.polygon)

    @cached_property
    def closed(self) -> BaseGeometry:
        """The union with its boundary, as wide as `boundaries` says."""
        shape = widen_shape(self.polygon)
        shapely.prepare(shape)
        return shape

    @cached_property
    def sampler(self) -> TriangleSampler:
        """The union cut into disjoint triangles, with their areas."""
        return TriangleSampler(self.polygon)


def intervals_within(shape: BaseGeometry, start: Vector, end: Vector) -> Intervals:
    """The parameters t for which start + t (end - start) lies in `shape`; single points are left out."""
    dx, dy = end.x - start.x, end.y - start.y
    square = dx * dx + dy * dy
    if square == 0:
        return parameter_intervals.NONE
    segment = LineString([(start.x, start.y), (end.x, end.y)])
    if shape.covers(segment):
        return parameter_intervals.ALL
    common = shapely.intersection(shape, segment) if shape.intersects(segment) else LineString()
    found: list[tuple[float, float]] = []
    for part in shapely.get_parts(common):
        if part.geom_type == "LineString" and not part.is_empty:
            along = ((shapely.get_coordinates(part) - (start.x, start.y)) @ np.array([dx, dy])) / square
            found.append((float(np.clip(along.min(), 0, 1)), float(np.clip(along.max(), 0, 1))))
    return tuple(sorted(found))


def _from_points(points: Sequence[Vector | Sequence[float]]) -> Polygon:
    corners = vectors("polygon", points)
    if len(set(corners)) < 3:
        raise BadRegion(f"a polygon needs at least 3 different points, not {len(set(corners))}")
    return Polygon([(corner.x, corner.y) for corner in corners])


def _polygons_of(polygon: object) -> list[Polygon]:
    """The polygons that `polygon` is or holds; a region with straight edges stands for its own."""
    inside = getattr(polygon, "polygon", None) if isinstance(polygon, Region) else polygon.geometry if isinstance(polygon, PlaneShape) else polygon
    if isinstance(inside, Polygon):
        return [inside]
    members = inside.geoms if isinstance(inside, MultiPolygon) else inside
    if not isinstance(members, Iterable):
        instead = "; use that region as it is, or give its corners" if isinstance(polygon, Region) else ""
        raise BadRegion(f"a polygonal region is made of polygons, not of {polygon!r}{instead}")
    return [part for member in members for part in _polygons_of(member)]


def _check_polygon(polygon: Polygon) -> Polygon:
    if polygon.is_empty or not np.isfinite(shapely.get_coordinates(polygon)).all():
        raise BadRegion(f"a polygon must have points with finite coordinates: {polygon!r}")
    if not polygon.is_valid:
        raise BadRegion(f"not a polygon: {shapely.is_valid_reason(polygon)}")
    return polygon if not polygon.has_z else shapely.force_2d(polygon)


def _unite_polygons(parts: list[Polygon]) -> Polygon | MultiPolygon:
    if not parts:
        raise BadRegion("a polygonal region needs at least one polygon")
    union = parts[0] if len(parts) == 1 else unite_shapes(parts)
    if union.is_empty:
        raise BadRegion(f"polygons that are put together must be larger than {GRID:g} m")
    assert isinstance(union, (Polygon, MultiPolygon))
    return union
