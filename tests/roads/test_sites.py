"""Maps of one's own: GeoJSON, WKT, shapefiles and whatever has a `__geo_interface__` become regions in metres, broken ones a message."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path
from types import SimpleNamespace

import pytest
import scenic_ref
import shapely
from scenic_ref.api.diagnostics import warnings_about
from scenic_ref.errors import AttemptsExhausted, ProgramError, UsageError
from scenic_ref.pictures.map_figures import site_picture
from scenic_ref.roads.geodata import in_metres, of_geojson, read_site, without_files
from scenic_ref.roads.user_maps import SiteMap
from scenic_ref.roads.xml_elements import MapError

ROOT = Path(__file__).parents[2]
YARD = ROOT / "examples" / "maps" / "yard.geojson"
SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]
GEO = pytest.mark.extra("geo")


def collection(*features: dict, **more: object) -> dict:
    """GeoJSON in metres."""
    return {"type": "FeatureCollection", "crs": None, "features": list(features), **more}


def feature(kind: str, coordinates: object, **properties: object) -> dict:
    """A feature of GeoJSON."""
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}


@pytest.fixture
def site(tmp_path: Path):
    """Writes a map, and says what `read_site` finds."""

    def read(content: object, name: str = "site.geojson", crs: str | None = None) -> SiteMap:
        path = tmp_path / name
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return read_site(path, crs)

    return read


def sampled(program: str, folder: Path, **more: object) -> scenic_ref.Scene:
    """A scene of a program on the map `site.geojson`."""
    return scenic_ref.loads(f"param map = localPath('site.geojson')\nmodel site_map\n{program}\n", directory=folder, **more).sample()


def test_each_shape_is_its_region(site, tmp_path: Path) -> None:
    site(
        collection(
            feature("Polygon", [SQUARE, [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]], name="ring"),
            feature("LineString", [[20, 0], [20, 5]], name="wall"), feature("MultiPoint", [[30, 1], [31, 2]], name="poles"),
            feature("MultiPolygon", [[SQUARE]], name="ring"), feature("Point", [40, 1, 7], id=3),
        )
    )
    scene = sampled(
        "ego = Object at 3@3, with a (1@1) in regions['ring'], with b regions['ring'].measure(), with c (5@5) in regions['ring'], "
        "with d regions['wall'].measure(), with e regions['poles'].measure(), with f (20@2) in regions['wall'], with g (40@1) in regions['3'], "
        "with h (20@2) in area, with i sorted(regions)\n",
        tmp_path,
    )
    found = [scene.ego.properties[name] for name in "abcdefghi"]
    assert found == [True, 100.0, True, 5.0, 2.0, True, True, False, ["3", "poles", "ring", "wall"]]


def test_the_workspace_is_the_union_of_areas_or_the_one_that_is_named_so(site, tmp_path: Path) -> None:
    areas = [feature("Polygon", [SQUARE], name="yard"), feature("Polygon", [[[20, 0], [30, 0], [30, 10], [20, 0]]], name="shed")]
    site(collection(*areas))
    assert sampled("ego = Object at 28@3", tmp_path).ego.position == (28, 3)
    with pytest.raises(AttemptsExhausted, match="contained in the workspace"):
        sampled("ego = Object at 15@3", tmp_path)
    site(collection(*areas, feature("Polygon", [SQUARE], name="workspace")))
    with pytest.raises(AttemptsExhausted, match="contained in the workspace"):
        sampled("ego = Object at 28@3", tmp_path)
    site(collection(feature("Point", [0, 0], name="here")))
    assert sampled("ego = Object at 500@3", tmp_path).ego.position == (500, 3)


@pytest.mark.parametrize(("given", "heading"), [({"heading": 90}, math.pi / 2), ({"bearing": 90}, -math.pi / 2), ({"bearing": 0}, 0.0), ({}, 0.0)])
def test_directions_are_degrees_to_the_left_or_to_the_right_of_north(site, tmp_path: Path, given: dict, heading: float) -> None:
    site(collection(feature("Polygon", [SQUARE], name="lane", **given)))
    assert sampled("ego = Object in regions['lane'], with requireVisible False", tmp_path).ego.heading == pytest.approx(heading)
    if given:
        assert sampled("ego = Object at 5@5, facing directions", tmp_path).ego.heading == pytest.approx(heading)
    else:
        with pytest.raises(ProgramError, match="directions"):
            sampled("ego = Object at 5@5, facing directions", tmp_path)


def test_wkt_has_a_shape_in_each_line(site) -> None:
    found = site("# the yard\nyard: POLYGON ((0 0, 10 0, 10 10, 0 0))\n\nPOINT (1 2)\nLINESTRING Z (0 0 5, 1 1 5)\n", "site.wkt")
    assert [(one.name, one.kind) for one in found.features] == [("yard", "areas"), (None, "points"), (None, "lines")]
    assert not found.features[2].shape.has_z


@GEO
def test_a_name_and_a_reference_system_stand_before_a_shape_in_either_order(site) -> None:
    shape = "POLYGON ((0 0, 0 0.001, 0.001 0.001, 0 0))"
    one, other = site(f"SRID=4326;lane: {shape}\nlane: SRID=4326;{shape}", "site.wkt").features
    assert (one.name, one.shape) == (other.name, other.shape) == ("lane", one.shape)
    assert one.shape.area > 1000


@GEO
def test_degrees_are_projected_to_metres_about_the_middle(site) -> None:
    """Areas and lengths against those on the ellipsoid: in 1 km, to a millionth."""
    from pyproj import Geod

    ring = [[8.5, 47.3], [8.513, 47.3], [8.513, 47.309], [8.5, 47.309], [8.5, 47.3]]
    [square] = site(feature("Polygon", [ring], name="square")).features
    area, length = Geod(ellps="WGS84").geometry_area_perimeter(shapely.Polygon(ring))
    assert square.shape.area == pytest.approx(abs(area), rel=1e-6)
    assert square.shape.length == pytest.approx(length, rel=1e-6)
    west, south, east, north = square.shape.bounds
    assert abs(west + east) < 0.2 and abs(south + north) < 0.2, "the middle of the map is the origin"
    assert square.shape.exterior.coords[1][0] > 400 and abs(square.shape.exterior.coords[1][1] + 500) < 2, "East is to the right, North is up"
    assert site("SRID=4326;POINT (8.5 47.3)", "site.wkt").notes == ("metres East and North of longitude 8.5, latitude 47.3",)


@GEO
def test_projected_coordinates_stay_as_they_are_and_feet_become_metres(site) -> None:
    here = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    found = site(collection(feature("Point", [500_000, 5_200_000]), crs=here))
    assert list(found.features[0].shape.coords) == [(500_000, 5_200_000)] and "ETRS89" in found.notes[0]
    feet = site(collection(feature("Point", [1000, 2000])), crs="EPSG:2263").features[0].shape
    assert (feet.x, feet.y) == pytest.approx((304.8006, 609.6012), rel=1e-6)


@GEO
def test_a_shapefile_is_read_with_its_attributes_and_its_reference_system(tmp_path: Path) -> None:
    import shapefile
    from pyproj import CRS

    with shapefile.Writer(str(tmp_path / "site.shp")) as writer:
        writer.field("NAME", "C")
        writer.field("bearing", "N", decimal=1)
        writer.poly([[[8.5, 47.3], [8.5, 47.31], [8.51, 47.31], [8.51, 47.3], [8.5, 47.3]]])
        writer.record("yard", 90)
    (tmp_path / "site.prj").write_text(CRS.from_epsg(4326).to_wkt("WKT1_ESRI"))
    [yard] = read_site(tmp_path / "site.shp").features
    assert yard.name == "yard" and yard.heading == pytest.approx(-math.pi / 2) and yard.shape.area == pytest.approx(840_742, rel=1e-3)
    (tmp_path / "site.prj").unlink()
    assert read_site(tmp_path / "site.shp").features[0].shape.area == pytest.approx(1e-4)
    data = (tmp_path / "site.shp").read_bytes()
    for length in (0, 50, 120, len(data) - 9):
        (tmp_path / "site.shp").write_bytes(data[:length])
        with pytest.raises(UsageError, match="no usable map"):
            read_site(tmp_path / "site.shp")


def test_anything_with_a_geo_interface_is_saved_as_a_map(tmp_path: Path) -> None:
    path = tmp_path / "site.geojson"
    frame = SimpleNamespace(__geo_interface__=collection(feature("Polygon", [SQUARE], name="yard", size=math.nan)))
    scenic_ref.save_map([shapely.box(20, 0, 30, 5), frame, "wall: LINESTRING (0 0, 0 9)"], path)
    found = read_site(path)
    assert [(one.name, one.kind) for one in found.features] == [(None, "areas"), ("yard", "areas"), ("wall", "lines")]
    assert found.features[1].properties == {"name": "yard", "size": None} and not found.notes
    for wrong in (3, [object()], {"type": "Nothing"}):
        with pytest.raises(UsageError):
            scenic_ref.save_map(wrong, path)
    with pytest.raises(UsageError, match=r"\.geojson"):
        scenic_ref.save_map(shapely.box(0, 0, 1, 1), tmp_path / "site.shp")
    assert len(read_site(path).features) == 3, "what was written stays"


WRONG = {
    "no JSON": ("{", "line 1: it is no JSON"),
    "deep": ("[" * 200_000, "nested too deeply"),
    "a list": ("[]", "GeoJSON is an object"),
    "no features": (collection(), "nothing on the map"),
    "features that are none": (collection(features=3), "a FeatureCollection has a list of features"),
    "no geometry": (collection({"type": "Feature", "properties": {}, "geometry": None}), "feature 0 has no geometry that can be read"),
    "no numbers": (collection(feature("Point", ["a", "b"])), "feature 0 has no geometry that can be read"),
    "no type": ({}, "the map has no geometry that can be read: its type is to be Point, "),
    "no coordinates": ({"type": "Point"}, "the map has no geometry that can be read: a Point has a list of coordinates"),
    "coordinates in a text": ({"type": "Point", "coordinates": "ab"}, "a Point has a list of coordinates"),
    "a huge number": ({"type": "Point", "crs": None, "coordinates": [10**400, 1]}, "the map has no geometry that can be read"),
    "a part that is none": ({"type": "GeometryCollection", "geometries": [None]}, "the map has no geometry that can be read: its type is to be"),
    "a part without coordinates": (
        {"type": "GeometryCollection", "geometries": [{"type": "Point"}]}, "the map has no geometry that can be read: a Point has a list of"
    ),
    "not finite": (collection(feature("Point", [math.inf, 0])), "not finite"),
    "crossing": (collection(feature("Polygon", [[[0, 0], [9, 9], [9, 0], [0, 9], [0, 0]]], name="b")), r"feature 0 \('b'\) has a wrong shape.*Self"),
    "mixed": (collection(feature("Point", [0, 0], name="a"), feature("LineString", [[0, 0], [1, 1]], name="a")), "'a' is made of points and lines"),
    "two directions": (collection(feature("Polygon", [SQUARE], heading=1, bearing=2)), "has a heading and a bearing"),
    "no direction": (collection(feature("Polygon", [SQUARE], heading="North")), "must be a number of degrees, not 'North'"),
    "crs of no name": (collection(feature("Point", [0, 0]), crs=3), '"crs" must be null'),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_broken_map_is_an_error_that_says_what_is_wrong(name: str, site, tmp_path: Path) -> None:
    content, message = WRONG[name]
    with pytest.raises(UsageError, match=message):
        site(content)
    with pytest.raises(ProgramError, match=message) as told:
        sampled("ego = Object", tmp_path)
    assert told.value.span.line == 1, "where the map is named"


@GEO
@pytest.mark.parametrize(
    ("content", "crs", "message"),
    [
        (feature("Point", [5000, 5000]), None, "its coordinates are no degrees: .* map_crs"),
        (feature("Point", [5, 5]), "EPSG:99999999", "there is no reference system"),
        (feature("Point", [5, 5]), "EPSG:4978", "no plane of metres"),
    ],
)
def test_a_wrong_reference_system_is_told(site, content: dict, crs: str | None, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        site(content, crs=crs)


def test_a_model_without_a_map_and_a_parameter_that_is_no_text_are_errors(site, tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match="needs a map") as told:
        scenic_ref.loads("model site_map\nego = Object").sample()
    assert "localPath('site.geojson')" in told.value.hint and "-p map=" in told.value.hint
    site(collection(feature("Point", [0, 0])))
    with pytest.raises(ProgramError, match="map_crs must be a text"):
        sampled("ego = Object", tmp_path, params={"map_crs": 3})
    with pytest.raises(ProgramError, match="map_crs must be a text"):
        sampled("param map_crs = Uniform('a', 'b')\nego = Object", tmp_path)


def test_what_a_run_changes_no_other_sees(site, tmp_path: Path) -> None:
    site(collection(feature("Point", [0, 0], name="a", tags=[1])))
    scenario = scenic_ref.loads(
        "param map = localPath('site.geojson')\nmodel site_map\nproperties['a']['tags'].append(2)\n"
        "ego = Object with n len(properties['a']['tags'])\n",
        directory=tmp_path,
    )
    assert [scenario.sample(index=k).ego.properties["n"] for k in range(3)] == [2, 2, 2]


def test_the_example_draws_trucks_along_their_lanes() -> None:
    scenario = scenic_ref.load(ROOT / "examples" / "maps" / "trucks.scenic")
    scenes = list(scenario.sample_many(50, seed=3, backend="batch"))
    for scene in scenes:
        for truck in scene.objects[:2]:
            assert truck.heading == pytest.approx(-math.pi / 2 if truck.position.y < 20 else math.pi / 2)
    assert [scene.to_json() for scene in scenes] == [scene.to_json() for scene in scenario.sample_many(50, seed=3, backend="interpreter")]


@pytest.mark.parametrize("seed", range(40))
def test_mutated_files_are_a_map_or_a_message(seed: int, tmp_path: Path) -> None:
    numbers, data = random.Random(seed), bytearray(YARD.read_bytes())
    for _ in range(numbers.randint(1, 6)):
        place = numbers.randrange(len(data))
        match numbers.randrange(3):
            case 0:
                data[place] = numbers.randrange(256)
            case 1:
                del data[place : place + numbers.randint(1, 40)]
            case _:
                data[place:place] = numbers.choice([b"null", b"[", b"1e999", b"-", b'"', b"{}", b",", b"NaN"])
    path = tmp_path / "site.geojson"
    path.write_bytes(data)
    try:
        found = read_site(path, "metres")
    except UsageError as problem:
        assert str(path) in problem.message
    else:
        assert found.features and site_picture(found)


@pytest.mark.parametrize(
    "shape", ["CIRCULARSTRING (0 0, 1 1, 2 0)", "CURVEPOLYGON (CIRCULARSTRING (0 0, 4 0, 4 4, 0 4, 0 0))", "TIN EMPTY", "POINT EMPTY"]
)
def test_shapes_that_no_region_has_are_told(shape: str, site) -> None:
    with pytest.raises(UsageError, match=r"no usable map: line 1 \('a'\) has no (geometry that can be read|shape)"):
        site(f"a: {shape}", "site.wkt")


def test_huge_files_are_refused_before_they_are_read(tmp_path: Path) -> None:
    with (tmp_path / "site.geojson").open("wb") as file:
        file.truncate(65 << 20)
    with pytest.raises(UsageError, match="too large"):
        read_site(tmp_path / "site.geojson")


def test_a_closed_line_of_shapely_is_saved_and_read(tmp_path: Path) -> None:
    scenic_ref.save_map(shapely.LinearRing([(0, 0), (9, 0), (9, 9)]), tmp_path / "site.geojson")
    assert read_site(tmp_path / "site.geojson").features[0].shape.length == pytest.approx(18 + math.hypot(9, 9))


def test_reading_knows_whatever_geojson_may_be() -> None:
    shape = {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [1, 2]}, {"type": "Point", "coordinates": [3, 4]}]}
    found = in_metres(*of_geojson(shape), "metres")
    assert found.features[0].kind == "points" and found.summary()["bounds"] == [1.0, 2.0, 3.0, 4.0]


def moved(scale: float, east: float = 0.0, north: float = 0.0) -> list[list[list[float]]]:
    """A square of ten times the scale."""
    return [[[x * scale + east, y * scale + north] for x, y in SQUARE]]


@GEO
@pytest.mark.parametrize(
    ("coordinates", "crs", "what", "remedy"),
    [
        (moved(1), "EPSG:4326", "the map is 1,115 km across, since its coordinates are read as degrees", "if they are metres, set"),
        (moved(0.0001, 200, 50), "EPSG:4326", "the map has longitudes beyond 180 degrees", "if its coordinates are no degrees"),
        (moved(20_000), "metres", "the map is 200 km across", "if its coordinates are not those of metres, set the parameter map_crs"),
        (moved(0.001, 13, 52), "metres", "the map is 0.01 m across, since its coordinates are read as metres", "map_crs to 'EPSG:4326'"),
        (moved(0.0001, 13, 52), "EPSG:4326", None, None),
        (moved(2), "metres", None, None),
        (moved(0.01, 4_000), "metres", None, None),
        (moved(2, 600_000, 5_800_000), "EPSG:25832", None, None),
    ],
)  # fmt: skip
def test_a_map_that_is_most_likely_in_other_coordinates_is_doubted(site, tmp_path: Path, coordinates, crs, what, remedy) -> None:
    found = site(collection(feature("Polygon", coordinates, name="yard")), crs=crs)
    scenario = scenic_ref.loads(
        f"param map_crs = '{crs}'\nparam map = localPath('site.geojson')\nmodel site_map\nego = Object on area\n", directory=tmp_path
    )
    warned = [(w.kind, w.message, w.span.line) for w in warnings_about(scenario)]
    if what is None:
        assert found.doubt is None and warned == []
    else:
        assert found.doubt is not None and found.doubt.what == what and remedy in found.doubt.remedy
        assert warned == [("implausible map", what, 2)]
        assert f"{what}: {found.doubt.remedy}" in found.summary()["notes"]


def test_python_warns_of_a_map_in_degrees_that_is_saved_as_metres(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="if they are longitude and latitude, set crs to 'EPSG:4326'"):
        scenic_ref.save_map(shapely.box(13.4, 52.5, 13.401, 52.501), tmp_path / "site.geojson")


@pytest.mark.parametrize(
    "crs",
    [
        "EPSG:4326", "OGC:CRS84", "EPSG:4326+5773", "urn:ogc:def:crs:OGC:1.3:CRS84", "http://www.opengis.net/def/crs/EPSG/0/4326",
        "WGS 84 / UTM zone 32N", "+proj=utm +zone=32 +ellps=GRS80 +units=m +no_defs", "proj=longlat datum=WGS84",
        "+proj=merc +a=6378137 +b=6378137 +nadgrids=@null +wktext +no_defs",
        'PROJCS["Web",GEOGCS["WGS 84"],EXTENSION["PROJ4","+proj=merc +a=6378137 +nadgrids=@null"]]',
    ],
)  # fmt: skip
def test_a_reference_system_is_said_by_a_code_a_name_or_settings(crs: str) -> None:
    assert without_files(crs)


@GEO
@pytest.mark.parametrize(
    "crs",
    [
        "+init=/etc/passwd:root +type=crs", "init=/etc/passwd:root", "+proj=longlat +nadgrids=/etc/passwd", "+nadgrids=@null,/etc/passwd",
        "+proj=pipeline +step +proj=hgridshift +grids=/etc/passwd +type=crs", "+proj=utm +geoidgrids=/etc/passwd", "/etc/passwd",
        'GEOGCS["x",EXTENSION["PROJ4","+proj=longlat +nadgrids=/etc/passwd"]]', 'GEOGCS["x",EXTENSION ["PROJ4_GRIDS","/etc/passwd"]]',
        'BOUNDCRS[ABRIDGEDTRANSFORMATION["a",PARAMETERFILE["b","/etc/passwd"]]]', "EPSG:4326\n+init=/etc/passwd:x", '{"type": "GeographicCRS"}',
        'GEOGCS["x",EXTENSION["PROJ4","a""b"]]',
    ],
)  # fmt: skip
def test_a_reference_system_that_names_a_file_is_refused(crs: str, tmp_path: Path) -> None:
    (tmp_path / "p.geojson").write_text(json.dumps(
        {"type": "Point", "coordinates": [8.0, 49.0], "crs": {"type": "name", "properties": {"name": crs}}}
    ))  # fmt: skip
    with pytest.raises(MapError, match="may name files: say it as an authority does"):
        read_site(tmp_path / "p.geojson")
    with pytest.raises(MapError, match="may name files: say it as an authority does"):
        read_site(tmp_path / "p.geojson", crs)
