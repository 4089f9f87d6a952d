"""Maps of one's own from GeoJSON, WKT and shapefiles, and GeoJSON of whatever has a `__geo_interface__`.

Programs are in metres. What is in degrees is projected by pyproj (extra `geo`) on a plane that touches the earth in the middle of the map.
"""

from __future__ import annotations

import json
import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from io import BytesIO
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry import shape as shape_of
from shapely.geometry.base import BaseGeometry

from ..interpreter.runtime.atomic_files import write_whole
from ..interpreter.runtime.optional_packages import missing_package_error
from ..interpreter.runtime.process_sandbox import limit_time
from ..interpreter.runtime.regular_file import name_and_folder, read_regular_file
from ..semantics.store.errors import ScenicError, UsageError
from ..semantics.store.memory_errors import is_out_of_memory
from .user_maps import Doubt, MapFeature, SiteMap
from .xml_elements import MapError

LARGEST = 64 << 20
"""Bytes that a file may have."""
MOST_POINTS = 2_000_000
LARGEST_EXTENT, LEAST_EXTENT = 100_000.0, 1.0
"""Metres beyond which a map is most likely in other coordinates."""
METRES, DEGREES = "metres", "EPSG:4326"
"""Coordinates that need no projection, and those of GeoJSON if it says nothing else."""
SUFFIXES = (".geojson", ".json", ".wkt", ".shp")
GEOMETRIES = ("Point", "LineString", "LinearRing", "Polygon", "MultiPoint", "MultiLineString", "MultiPolygon", "GeometryCollection")
"""The types of geometries: those of GeoJSON, and one that a shapely geometry may have beside them."""
NAMES = ("name", "Name", "NAME", "id")
"""Properties that may name a feature, the first that there is."""
SRID = re.compile(r"SRID\s*=\s*(\d{1,9})", re.IGNORECASE)
DEEPEST = 32
"""Brackets in each other in a line of WKT, and objects in each other in GeoJSON: libraries read deeper ones by a recursion that has no end."""


def read_site(path: Path, crs: str | None = None) -> SiteMap:
    """The map of a file, in metres. `crs` says what its coordinates are, whatever the file says: "metres", or what pyproj knows.

    Raises `MapError` for what is no map, and `UsageError` for a missing package.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise MapError(f"a map of one's own is a file {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}, not {path.name}")
    try:
        data = read_regular_file(path, LARGEST)
    except FileNotFoundError:
        raise MapError(f"there is no map {name_and_folder(path)}") from None
    except OSError as error:
        raise MapError(f"the map {path} cannot be read: {error.strerror or error}") from None
    try:
        return site_within(data, path, crs)
    except MapError as problem:
        raise MapError(f"{path} is no usable map: {problem.message}") from None


@limit_time("reading a map")
def site_within(data: bytes, path: Path, crs: str | None) -> SiteMap:
    """The map of what is in a file, in the time that a program has for its maps. Raises `MapError`."""
    suffix = path.suffix.lower()
    return usable(in_metres(*of_shapefile(data, path), crs)) if suffix == ".shp" else site_from(data, suffix == ".wkt", crs)


@lru_cache(maxsize=4)
def site_from(data: bytes, is_wkt: bool, crs: str | None) -> SiteMap:
    """The map of what is in a file. Raises `MapError`."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise MapError(f"it is no text in UTF-8 (byte {problem.start})") from None
    return usable(in_metres(*(of_wkt(text) if is_wkt else of_geojson(parse_json(text))), crs))


def usable(site: SiteMap) -> SiteMap:
    """The map, if its shapes are regions. Raises `MapError` if not."""
    _ = site.namespace
    return site


def parse_json(text: str) -> object:
    """Return the value of a JSON text. Raises `MapError`."""
    try:
        return json.loads(text, parse_int=parse_integer)
    except json.JSONDecodeError as problem:
        raise MapError(f"line {problem.lineno}: it is no JSON: {problem.msg}") from None
    except RecursionError:
        raise MapError("it is nested too deeply") from None


MOST_DIGITS = 1000
"""Those of a whole number."""


def parse_integer(digits: str) -> int:
    """A whole number in JSON. Raises `MapError`."""
    if len(digits) > MOST_DIGITS:
        raise MapError(f"a number has more than {MOST_DIGITS} digits")
    return int(digits)


Read = tuple[list[MapFeature], str | None]
"""The features as they stand in the file, and what it says of its coordinates."""


def of_geojson(found: object) -> Read:
    """The features of GeoJSON (RFC 7946), in degrees unless its member `crs`, of the format's first version, says something else."""
    if not isinstance(found, Mapping):
        raise MapError("GeoJSON is an object, with a `type`")
    crs = DEGREES
    if "crs" in found:
        given = found["crs"]
        name = given.get("properties", {}).get("name") if isinstance(given, Mapping) and isinstance(given.get("properties", {}), Mapping) else None
        if given is not None and not isinstance(name, str):
            raise MapError('the member "crs" must be null, for metres, or have properties with a name')
        crs = METRES if given is None else str(name)
    match found.get("type"):
        case "FeatureCollection":
            members = found.get("features")
            if not isinstance(members, list):
                raise MapError("a FeatureCollection has a list of features")
            return [feature_of(member, f"feature {number}") for number, member in enumerate(members)], crs
        case "Feature":
            return [feature_of(found, "the feature")], crs
        case _:
            return [feature_of({"type": "Feature", "geometry": found}, "the map")], crs


def feature_of(member: object, place: str) -> MapFeature:
    """A feature of GeoJSON. Raises `MapError`."""
    if not isinstance(member, Mapping) or member.get("type") != "Feature":
        raise MapError(f"{place} is no object of the type Feature")
    properties = member.get("properties") or {}
    if not isinstance(properties, Mapping):
        raise MapError(f"the properties of {place} are no object")
    given = next((properties[name] for name in NAMES if properties.get(name) is not None), member.get("id"))
    name = None if given is None else str(given)
    where = place if name is None else f"{place} ({name!r:.60})"
    return MapFeature(name, make_geometry(lambda: geometry_of(member["geometry"]), where), dict(properties), where)


def geometry_of(found: object, depth: int = 0) -> BaseGeometry:
    """A geometry of GeoJSON. Raises `ValueError`, and whatever the library raises."""
    if depth > DEEPEST:
        raise ValueError(f"more than {DEEPEST} geometries stand in each other")
    kinds = {kind.lower(): kind for kind in GEOMETRIES}
    if not isinstance(found, Mapping) or str(found.get("type")).lower() not in kinds:
        raise ValueError(f"its type is to be {', '.join(GEOMETRIES[:-1])} or {GEOMETRIES[-1]}")
    kind = kinds[str(found["type"]).lower()]
    parts = found.get(member := "geometries" if kind == "GeometryCollection" else "coordinates")
    if not isinstance(parts, (list, tuple)):
        raise ValueError(f"a {kind} has a list of {member}")
    return shapely.GeometryCollection([geometry_of(part, depth + 1) for part in parts]) if member == "geometries" else shape_of(dict(found))


def make_geometry(make: Callable[[], BaseGeometry], place: str) -> BaseGeometry:
    """The shape that a call makes. Raises `MapError` for whatever the library says that is wrong, and for too many points, or none that is finite."""
    try:
        found = make()
        coordinates = shapely.get_coordinates(found)
    except (shapely.errors.ShapelyError, LookupError, AttributeError, TypeError, ValueError, ArithmeticError, RuntimeError) as problem:
        if is_out_of_memory(problem):
            raise
        detail = f"it has no {problem.args[0]}" if isinstance(problem, KeyError) else str(problem).partition("\n")[0] or type(problem).__name__
        raise MapError(f"{place} has no geometry that can be read: {detail:.200}") from None
    if len(coordinates) > MOST_POINTS:
        raise MapError(f"{place} has {len(coordinates):,} points: at most {MOST_POINTS:,}")
    if not np.isfinite(coordinates).all():
        raise MapError(f"{place} has a coordinate that is not finite")
    return found


def of_wkt(text: str) -> Read:
    """A geometry in each line, after its name and a colon if it has one; `#` begins a comment. In metres, unless `SRID=N;` says otherwise."""
    features, codes = [], []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        place = f"line {number}"
        name = code = None
        rest = line
        for _ in range(2):  # in either order
            first, sign, others = rest.partition(";")
            if code is None and sign and (coded := SRID.fullmatch(first.strip())) is not None and others.strip():
                code, rest = coded[1], others
                continue
            first, sign, others = rest.partition(":")
            if name is None and sign and first.strip() and not set(first) & set(";()") and others.strip():
                name, rest = first.strip(), others
        codes.append(code)
        where = place if name is None else f"{place} ({name!r:.60})"
        if depth_of(rest) > DEEPEST:
            raise MapError(f"{where} has more than {DEEPEST} brackets in each other")
        features.append(MapFeature(name, make_geometry(lambda text=rest: shapely.from_wkt(text.strip()), where), {}, where))
    if len(set(codes)) > 1:
        raise MapError("all lines must have the same SRID, or none")
    return features, f"EPSG:{codes[0]}" if codes and codes[0] is not None else METRES


def depth_of(text: str) -> int:
    """How many brackets stand in each other in a text."""
    return max(accumulate({"(": 1, ")": -1}[sign] for sign in text if sign in "()"), default=0)


def of_shapefile(data: bytes, path: Path) -> Read:
    """The features of a shapefile, with the attributes beside it. Raises `MapError`, and `UsageError` for the missing package."""
    try:
        import shapefile
    except ImportError as problem:
        raise missing_package_error("a shapefile", "shapefile", problem, "; or convert the map to GeoJSON") from None
    try:
        projection = open_sidecar(path, ".prj")
        crs = METRES if projection is None else projection.read().decode("utf-8", "replace")
        parts = {"shp": BytesIO(data), "shx": open_sidecar(path, ".shx"), "dbf": open_sidecar(path, ".dbf")}
        with warnings.catch_warnings(action="error"), shapefile.Reader(**parts) as reader:
            features = [feature_of(entry, f"shape {number}") for number, entry in enumerate(entries(reader))]
    except ScenicError:
        raise
    except Exception as problem:  # the library lets many kinds of its own and of Python's out of broken files
        if is_out_of_memory(problem):
            raise
        raise MapError(f"it cannot be read: {str(problem).partition(chr(10))[0]:.200}") from None
    return features, crs


def open_sidecar(path: Path, suffix: str) -> BytesIO | None:
    """Return the file beside a shapefile with that suffix, such as its .prj, as a stream; None if there is none. Raises `OSError`."""
    try:
        return BytesIO(read_regular_file(path.with_suffix(suffix), LARGEST))
    except FileNotFoundError:
        return None


def entries(reader: Any) -> Iterator[Mapping[str, object]]:
    """The shapes of a shapefile as features of GeoJSON, their attributes as JSON has them."""
    for one in reader.iterShapeRecords():
        found = one.__geo_interface__
        yield {**found, "properties": numpy_to_json(found["properties"])}


def in_metres(features: list[MapFeature], told: str | None, crs: str | None) -> SiteMap:
    """The features projected to metres, if they are not. Raises `MapError`."""
    if not features:
        raise MapError("there is nothing on the map")
    if sum(len(shapely.get_coordinates(feature.shape)) for feature in features) > MOST_POINTS:
        raise MapError(f"the map has more than {MOST_POINTS:,} points")
    meant = crs or told or METRES
    flat = [replace(feature, shape=shapely.force_2d(feature.shape)) for feature in features]
    coordinates = shapely.get_coordinates([feature.shape for feature in flat])
    if meant == METRES:
        return SiteMap(tuple(flat), (), doubt_about(coordinates, coordinates, meant, degrees=False))
    projected, note, degrees = projection(meant, coordinates)
    shapes = shapely.transform(np.array([feature.shape for feature in flat], dtype=object), projected)
    if not np.isfinite(shapely.get_coordinates(shapes)).all():
        raise MapError(f"its coordinates lie outside what {meant:.60} can project: say what they are with the parameter map_crs, such as 'metres'")
    doubt = doubt_about(coordinates, shapely.get_coordinates(shapes), meant, degrees=degrees)
    return SiteMap(tuple(replace(feature, shape=shape) for feature, shape in zip(flat, shapes, strict=True)), (note,), doubt)


def doubt_about(given: np.ndarray, metres: np.ndarray, crs: str, *, degrees: bool) -> Doubt | None:
    """Return a doubt about implausible coordinates of a map, as they were `given` and in `metres`; None if
    there is none.
    """
    across = float(np.ptp(metres, axis=0).max()) if len(metres) else 0.0
    if degrees and across > LARGEST_EXTENT:
        what = f"the map is {across / 1000:,.0f} km across, since its coordinates are read as degrees"
        return Doubt(what, "if they are metres, set the parameter map_crs to 'metres', or write \"crs\": null into the GeoJSON")
    if degrees and (np.abs(given[:, 0]) > 180).any():
        return Doubt("the map has longitudes beyond 180 degrees", "if its coordinates are no degrees, set the parameter map_crs, such as to 'metres'")
    if across > LARGEST_EXTENT:
        return Doubt(f"the map is {across / 1000:,.0f} km across", f"if its coordinates are not those of {crs:.60}, set the parameter map_crs")
    if not degrees and 0 < across < LEAST_EXTENT and (np.abs(given) <= (180.0, 90.0)).all():
        what = f"the map is {across:.3g} m across, since its coordinates are read as {crs:.60}"
        return Doubt(what, f"if they are longitude and latitude, set the parameter map_crs to {DEGREES!r}")
    return None


AUTHORITY = re.compile(r"[A-Za-z]\w*:\w+(?:\+\d+)?|urn:ogc:def:crs(?:[:,][\w.+-]*)+|https?://www\.opengis\.net/def/crs/[\w/.]+")
NAMED = re.compile(r"\w[\w ().,'+-]*(?: / [\w ().,'+-]+)*")
SETTING = re.compile(r"\+?(?P<name>\w+)(?:=(?P<value>[\w.,+-]*|@null))?")
SETTINGS = frozenset({
    "M", "R", "R_A", "W", "a", "alpha", "axis", "azi", "b", "datum", "ellps", "es", "f", "gamma", "h", "k",
    "k_0", "lat_0", "lat_1", "lat_2", "lat_b", "lat_ts", "lon_0", "lon_1", "lon_2", "lon_wrap", "lonc",
    "m", "n", "no_defs", "no_off", "no_rot", "no_uoff", "ns", "over", "pm", "proj", "q", "r_lat_a", "rf",
    "south", "sweep", "tilt", "to_meter", "towgs84", "type", "units", "vto_meter", "vunits", "wktext",
    "x_0", "y_0", "z_0", "zone",
})  # fmt: skip
"""The settings of PROJ's own strings that name no file."""
EXTENSION = re.compile(r'\bEXTENSION\b(?:\s*[\[(]\s*"(?P<name>[^"]*)"\s*,\s*"(?P<value>[^"]*)"\s*[\])])?', re.IGNORECASE)


def without_files(crs: str) -> bool:
    """Whether what says a reference system names no file, since PROJ opens whatever it is told to: an authority's code, a name, settings of PROJ
    from a list, or WKT without files.
    """
    text = crs.strip()
    if AUTHORITY.fullmatch(text) or NAMED.fullmatch(text):
        return True
    if re.match(r"[A-Za-z]\w*\s*[\[(]", text):
        extensions = all(found["name"] == "PROJ4" and of_settings(found["value"]) for found in EXTENSION.finditer(text))
        return extensions and not re.search(r"\bPARAMETERFILE\b", text, re.IGNORECASE)
    return of_settings(text)


def of_settings(text: str) -> bool:
    """Whether a string of PROJ has none but the `SETTINGS`, and grids only where it says that there are none."""
    found = [SETTING.fullmatch(word) for word in text.split()]
    return all(one and (one["name"] in SETTINGS or (one["name"] == "nadgrids" and one["value"] == "@null")) for one in found)


def projection(crs: str, coordinates: np.ndarray) -> tuple[Callable[[np.ndarray], np.ndarray], str, bool]:
    """Return the conversion from coordinates of a reference system into metres, a note that describes it, and
    whether the coordinates are degrees.

    Raises `MapError`, and `UsageError` where the package is missing.
    """
    try:
        from pyproj import CRS, Transformer
        from pyproj.exceptions import ProjError
    except ImportError as problem:
        raise missing_package_error("a map in degrees", "pyproj", problem, ", or set the parameter map_crs to 'metres' if it is in metres") from None
    try:
        if not without_files(crs):
            raise MapError(f"the reference system {crs!r:.60} may name files: say it as an authority does, such as 'EPSG:25832'")
        system = CRS.from_user_input(crs)
    except ProjError as problem:
        raise MapError(f"there is no reference system {crs!r:.60}: {str(problem).partition(chr(10))[0]:.120}") from None
    if not system.is_geographic:
        factors = {axis.unit_conversion_factor for axis in system.axis_info[:2]}
        if not system.is_projected or len(factors) != 1:
            raise MapError(f"{system.name} is no plane of metres, nor in degrees")
        [factor] = factors
        note = f"coordinates are those of {system.name}" + ("" if factor == 1 else f", in metres ({factor:g} each)")
        return (lambda points: points * factor), note, False
    if (np.abs(coordinates) > (360.0, 90.0)).any():
        raise MapError("its coordinates are no degrees: say what they are with the parameter map_crs, such as 'metres' or 'EPSG:25832'")
    west, south = coordinates.min(axis=0)
    east, north = coordinates.max(axis=0)
    longitude, latitude = round(float(west + east) / 2, 6), round(float(south + north) / 2, 6)
    plane = CRS.from_dict({"proj": "tmerc", "lat_0": latitude, "lon_0": longitude, "k": 1, "ellps": "WGS84", "units": "m"})
    transformer = Transformer.from_crs(system, plane, always_xy=True)
    note = f"metres East and North of longitude {longitude:g}, latitude {latitude:g}"
    return (lambda points: np.column_stack(transformer.transform(points[:, 0], points[:, 1]))), note, True


def save_map(source: object, path: str | Path, *, crs: str | None = None) -> None:
    """Write a map of one's own as GeoJSON in metres, for `param map`.

    `source` is anything with a `__geo_interface__` (a shapely geometry, a GeoDataFrame), GeoJSON as a mapping, WKT, or a list of these.
    `crs` says what its coordinates are: "metres" (the default), or what pyproj knows. Raises `UsageError`, `OSError`.
    """
    site = in_metres([replace(one, place=f"feature {k}") for k, one in enumerate(features_in(source))], crs or METRES, None)
    usable(site)
    if site.doubt is not None:
        warnings.warn(f"{site.doubt.what}: {site.doubt.remedy.replace('the parameter map_crs', 'crs')}", stacklevel=2)
    members = []
    for one in site.features:
        named = {} if one.name is None else {"name": one.name}
        members.append({"type": "Feature", "geometry": shapely.geometry.mapping(one.shape), "properties": {**one.properties, **named}})
    try:
        text = json.dumps({"type": "FeatureCollection", "crs": None, "features": members}, ensure_ascii=False, allow_nan=False, default=str)
    except (ValueError, TypeError, RecursionError) as problem:
        raise UsageError(f"the properties of the map cannot be written as JSON: {problem}") from None
    if Path(path).suffix.lower() not in SUFFIXES[:2]:
        raise UsageError(f"a map is written as {SUFFIXES[0]} or {SUFFIXES[1]}, not {Path(path).name}")
    write_whole(Path(path), f"{text}\n".encode())


def features_in(source: object) -> list[MapFeature]:
    """The features of what `save_map` takes. Raises `MapError`, `UsageError`."""
    if isinstance(source, str):
        return of_wkt(source)[0]
    if isinstance(source, (list, tuple)):
        return [feature for one in source for feature in features_in(one)]
    found = source if isinstance(source, Mapping) else getattr(source, "__geo_interface__", None)
    if found is None:
        raise UsageError(f"a map has a __geo_interface__, or is GeoJSON, WKT, or a list of these, not {source!r:.60}")
    return of_geojson(numpy_to_json(found))[0]


def numpy_to_json(value: object) -> object:
    """A value as JSON has it: what NumPy and others have for numbers as Python's own; missing numbers as None."""
    if isinstance(value, Mapping):
        return {str(key): numpy_to_json(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [numpy_to_json(inner) for inner in value]
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:
        return numpy_to_json(value.item())  # type: ignore[attr-defined]
    if isinstance(value, float) and math.isnan(value):
        return None
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)
