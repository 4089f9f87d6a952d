"""Maps of one's own: features with a shape in metres, a name and properties, and the regions and the vector field that programs get of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import shapely
from shapely.geometry import LinearRing, LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry, BaseMultipartGeometry

from ..semantics.space.fields import PolygonalVectorField
from ..semantics.space.regions import BadRegion, PointSetRegion, PolygonalRegion, PolylineRegion, Region
from ..semantics.space.vectors import Vector
from .xml_elements import MapError

KINDS = {Polygon: "areas", LineString: "lines", Point: "points"}
FEATURES, SITE = "site_map.features", "_site"
"""The module that gives what is on a map, and its name for the whole."""
LARGEST_ANGLE = 1e9
"""Degrees of a direction, either way."""
HEADING, BEARING = "heading", "bearing"
"""Properties of an area that give its direction, in degrees from North: to the left, as Scenic counts, or to the right, as a compass does."""


@dataclass(frozen=True)
class MapFeature:
    """Something on a map: its shape in metres, East and North, and what the map says of it; `place` says where, for messages."""

    name: str | None
    shape: BaseGeometry
    properties: Mapping[str, object]
    place: str

    @property
    def parts(self) -> list[BaseGeometry]:
        """The polygons, lines and points that the shape consists of."""
        return simple_parts(self.shape)

    @property
    def polygons(self) -> list[Polygon]:
        """The polygons among them."""
        return [part for part in self.parts if isinstance(part, Polygon)]

    @property
    def kind(self) -> str:
        """The kind of the feature: areas, lines or points. Raises `MapError` if it has several."""
        return kind_of(self.parts, self.place)

    @property
    def heading(self) -> float | None:
        """The direction of traffic, or of whatever the map means, in radians to the left of North. Raises `MapError` for what is none."""
        given = {name: self.properties[name] for name in (HEADING, BEARING) if self.properties.get(name) is not None}
        if not given:
            return None
        if len(given) > 1:
            raise MapError(f"{self.place} has a {HEADING} and a {BEARING}: give one of them")
        [(name, degrees)] = given.items()
        if isinstance(degrees, bool) or not isinstance(degrees, (int, float)) or not abs(degrees) <= LARGEST_ANGLE:
            raise MapError(f"the {name} of {self.place} must be a number of degrees, not {degrees!r:.60}")
        return math.radians(math.remainder(degrees if name == HEADING else -degrees, 360))


class Doubt(NamedTuple):
    """Why a map is most likely not in the coordinates that it is read in, and what to do about it."""

    what: str
    remedy: str


@dataclass(frozen=True)
class SiteMap:
    """A map of one's own: its features, and notes about how they were read."""

    features: tuple[MapFeature, ...]
    notes: tuple[str, ...] = ()
    doubt: Doubt | None = None

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the map without the regions that were made of it."""
        return SiteMap, (self.features, self.notes, self.doubt)

    def names(self) -> dict[str, list[MapFeature]]:
        """The features with each name, in the order of the map."""
        found: dict[str, list[MapFeature]] = {}
        for feature in self.features:
            if feature.name is not None:
                found.setdefault(feature.name, []).append(feature)
        return found

    def areas(self) -> list[MapFeature]:
        """The features that are areas."""
        return [feature for feature in self.features if feature.kind == "areas"]

    @cached_property
    def namespace(self) -> Mapping[str, object]:
        """The names that a program gets: `regions` and `properties` by name, `area`, the union of all areas,
        and `directions`, if an area has one.

        Also the map itself, for pictures.

        Raises `MapError` for shapes that are no regions.
        """
        directed = [(feature, heading) for feature in self.areas() if (heading := feature.heading) is not None]
        cells = [(area, heading) for feature, heading in directed for area in feature.polygons]
        field = PolygonalVectorField("directions", cells) if cells else None
        found: dict[str, object] = {
            SITE: self,
            "regions": {name: region_of(name, features, field) for name, features in self.names().items()},
            "properties": {name: dict(features[0].properties) for name, features in self.names().items()},
        }
        if self.areas():
            found["area"] = region_of("area", self.areas(), field)
        return found if field is None else {**found, "directions": field}

    def summary(self) -> dict[str, object]:
        """Return the contents of the map, as `scenic-ref map --json` prints them: in metres, square metres,
        numbers of points, and degrees to the left of North.
        """
        west, south, east, north = shapely.total_bounds([feature.shape for feature in self.features])
        return {
            "features": [
                {
                    "name": feature.name, "kind": feature.kind, "size": round(feature_size(feature), 3),
                    "heading": None if feature.kind != "areas" or feature.heading is None else round(math.degrees(feature.heading), 9),
                }
                for feature in self.features
            ],
            "area_m2": round(shapely.union_all([feature.shape for feature in self.areas()]).area, 3),
            "bounds": [round(float(x), 3) for x in (west, south, east, north)],
            "notes": [*self.notes, *([] if self.doubt is None else [f"{self.doubt.what}: {self.doubt.remedy}"])],
        }  # fmt: skip


def feature_size(feature: MapFeature) -> float:
    """The area, the length, or the number of points."""
    return {"areas": feature.shape.area, "lines": feature.shape.length, "points": float(len(feature.parts))}[feature.kind]


def simple_parts(shape: BaseGeometry) -> list[BaseGeometry]:
    """The polygons, lines and points that a shape consists of, collections in collections too."""
    if isinstance(shape, BaseMultipartGeometry):
        return [part for inner in shape.geoms for part in simple_parts(inner)]
    return [] if shape.is_empty else [LineString(shape.coords) if isinstance(shape, LinearRing) else shape]


def kind_of(parts: Iterable[BaseGeometry], place: str) -> str:
    """Return the kind of the parts: areas, lines or points. Raises `MapError` if there are several kinds, or
    none.
    """
    kinds = list(dict.fromkeys(KINDS[type(part)] for part in parts))
    if not kinds:
        raise MapError(f"{place} has no shape")
    if len(kinds) > 1:
        raise MapError(f"{place} is made of {' and '.join(kinds)}, and a region is made of one of these: give them different names")
    return kinds[0]


def region_of(name: str, features: list[MapFeature], field: PolygonalVectorField | None) -> Region:
    """The region of the features with a name: the union of areas, along `field` if one of them has a direction, of lines, or of points."""
    place = f"{name!r}" if len(features) > 1 else features[0].place
    parts = [part for feature in features for part in feature.parts]
    kind = kind_of(parts, place)
    try:
        if kind == "areas":
            polygons = [polygon for feature in features for polygon in feature.polygons]
            return PolygonalRegion(polygon=polygons, orientation=field if any(f.heading is not None for f in features) else None, name=name)
        if kind == "lines":
            return PolylineRegion(polyline=[part for part in parts if isinstance(part, LineString)], name=name)
        return PointSetRegion(name, [Vector(*xy) for xy in shapely.get_coordinates(parts)])
    except BadRegion as problem:
        raise MapError(f"{place} has a wrong shape: {problem}") from None
