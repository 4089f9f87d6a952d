"""Shapes of the plane as programs of the releases meet them: `polygon` and `lineString` of a region, with plain numbers, pairs and lists inside.

The releases hand out shapely's own geometries, with everything that they can do. Here a program gets the part that says something about the shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import shapely
from shapely.geometry import LineString, MultiLineString, MultiPolygon, Point
from shapely.geometry.base import BaseGeometry

from ..boundaries import METRES
from ..vectors import TakesPoints, Vector

Pair = tuple[float, float]


class PlaneShape(TakesPoints):
    """A point, line, ring or polygon, or several of them; lengths in metres, areas in square metres.

    Its attributes are those of shapely's geometries of the same name, as far as the table of allowed attributes lists them.
    """

    scenic_made = True
    scenic_names = frozenset(
        {"centroid", "exterior", "interiors", "boundary", "coords", "xy", "x", "y", "bounds", "area", "length", "geoms", "envelope", "convex_hull"}
        | {"is_empty", "geom_type", "contains", "covers", "within", "intersects", "distance", "interpolate", "project", "representative_point"}
        | {"containsPoint", "distanceTo"}
    )

    def __init__(self, geometry: BaseGeometry) -> None:
        self.geometry = geometry

    def __repr__(self) -> str:
        return f"<{self.geom_type} of {shapely.get_num_coordinates(self.geometry):,} points>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PlaneShape) and bool(self.geometry == other.geometry)

    def __hash__(self) -> int:
        return hash(self.geometry)

    def part(self, name: str) -> BaseGeometry:
        """Return a part of the geometry. Raises AttributeError where a geometry of its type has none."""
        found = getattr(self.geometry, name, None)
        if found is None:
            raise AttributeError(f"a {self.geom_type} has no {name}")
        return found

    @cached_property
    def centroid(self) -> PlaneShape:
        """The centre of gravity, a point."""
        return PlaneShape(self.geometry.centroid)

    @cached_property
    def exterior(self) -> PlaneShape:
        """The outer ring of a polygon."""
        return PlaneShape(self.part("exterior"))

    @cached_property
    def interiors(self) -> tuple[PlaneShape, ...]:
        """The rings of a polygon's holes."""
        return tuple(map(PlaneShape, self.part("interiors")))  # type: ignore[arg-type]

    @cached_property
    def boundary(self) -> PlaneShape:
        """The boundary of the shape."""
        return PlaneShape(self.geometry.boundary)

    @cached_property
    def envelope(self) -> PlaneShape:
        """The smallest rectangle along the axes that holds it."""
        return PlaneShape(self.geometry.envelope)

    @cached_property
    def convex_hull(self) -> PlaneShape:
        """The convex hull of the shape."""
        return PlaneShape(self.geometry.convex_hull)

    @cached_property
    def coords(self) -> tuple[Pair, ...]:
        """The points of a point, line or ring, as pairs of coordinates. Raises AttributeError for a polygon, whose `exterior` has them."""
        if self.geometry.geom_type not in ("Point", "LineString", "LinearRing"):
            raise AttributeError(f"a {self.geom_type} has no coords; ask for those of its exterior, or of its parts, geoms")
        return tuple((float(x), float(y)) for x, y in shapely.get_coordinates(self.geometry))

    @property
    def xy(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The coordinates of the points of a point, line or ring: all x, all y."""
        xs, ys = zip(*self.coords, strict=True)
        return xs, ys

    @property
    def x(self) -> float:
        """The first coordinate of a point."""
        return float(self.part("x"))  # type: ignore[arg-type]

    @property
    def y(self) -> float:
        """The second coordinate of a point."""
        return float(self.part("y"))  # type: ignore[arg-type]

    @property
    def line(self) -> LineString | MultiLineString:
        """The geometry of a line. Raises AttributeError for anything else."""
        if not isinstance(self.geometry, (LineString, MultiLineString)):
            raise AttributeError(f"a {self.geom_type} is no line")
        return self.geometry

    @property
    def bounds(self) -> tuple[float, ...]:
        """The least x and y, and the greatest."""
        return tuple(map(float, self.geometry.bounds))

    @property
    def area(self) -> float:
        """The area of the shape."""
        return float(self.geometry.area)

    @property
    def length(self) -> float:
        """The length of a line, or of a polygon's boundary."""
        return float(self.geometry.length)

    @cached_property
    def geoms(self) -> tuple[PlaneShape, ...]:
        """The parts of a shape of several."""
        return tuple(map(PlaneShape, self.part("geoms")))  # type: ignore[arg-type]

    @cached_property
    def together(self) -> PlaneShape:
        """A polygon or several as one MultiPolygon, the releases' `polygons` of a region."""
        return PlaneShape(MultiPolygon(list(shapely.get_parts(self.geometry))))

    @property
    def is_empty(self) -> bool:
        """Whether it has no point."""
        return bool(self.geometry.is_empty)

    @property
    def geom_type(self) -> str:
        """Shapely's name of its type, such as Polygon."""
        return str(self.geometry.geom_type)

    def contains(self, other: object) -> bool:
        """Return whether the other shape or point lies within it, and not only on its boundary."""
        return bool(self.geometry.contains(geometry_of(other)))

    def covers(self, other: object) -> bool:
        """Return whether every point of the other shape is one of it."""
        return bool(self.geometry.covers(geometry_of(other)))

    def within(self, other: object) -> bool:
        """Return whether the other shape contains it."""
        return bool(self.geometry.within(geometry_of(other)))

    def intersects(self, other: object) -> bool:
        """Return whether the two have a point in common."""
        return bool(self.geometry.intersects(geometry_of(other)))

    def distance(self, other: object) -> float:
        """Return the distance to the other shape or point, in metres."""
        return float(self.geometry.distance(geometry_of(other)))

    def containsPoint(self, point: object) -> bool:
        """Return whether a point is one of it, its boundary included, as of the region (reading `boundaries`)."""
        return self.distance(point) <= METRES

    def distanceTo(self, point: object) -> float:
        """Return the distance to a point, in metres; of the releases' regions."""
        return self.distance(point)

    def interpolate(self, distance: float, normalized: bool = False) -> PlaneShape:
        """Return the point of a line that many metres from its beginning, or that part of its length."""
        return PlaneShape(self.line.interpolate(float(distance), normalized=bool(normalized)))

    def project(self, other: object, normalized: bool = False) -> float:
        """Return how far along a line its point nearest to the other point is."""
        point = geometry_of(other)
        if not isinstance(point, Point):
            raise TypeError(f"project() takes a point, not a {point.geom_type}")
        return float(self.line.project(point, normalized=bool(normalized)))

    def representative_point(self) -> PlaneShape:
        """Return a point that lies within it."""
        return PlaneShape(self.geometry.representative_point())


def geometry_of(value: object) -> BaseGeometry:
    """Return the geometry of a shape, a region with straight edges, a vector or a pair. Raises TypeError for anything else."""
    if isinstance(value, PlaneShape):
        return value.geometry
    inside = getattr(value, "polygon", None) or getattr(value, "polyline", None)
    if isinstance(inside, BaseGeometry):
        return inside
    if isinstance(value, Vector) or (isinstance(value, Sequence) and len(value) == 2 and all(isinstance(c, (int, float)) for c in value)):
        return Point(*value)
    raise TypeError(f"a shape of the plane is compared with another one, a region or a point, not with {value!r:.40}")


PlaneShape.__name__ = "shape"  # as Python's own messages call its values, as in "'shape' object is not iterable"
