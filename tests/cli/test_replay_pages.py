"""What lies below the objects of a replay page: the map of the program, or its workspace, in the colours of pictures."""

from __future__ import annotations

import json

import pytest
import shapely
from scenic_ref.pictures import map_layers
from scenic_ref.pictures.map_layers import DIM, FAINT
from scenic_ref.pictures.scene_figures import CLASSES, EGO, LAND

ROAD = "model scenic.domains.driving.model\nego = Car on road\nTruck on road\nCar on road\n"


def data_of(ask, tmp_path, text, *more):
    (tmp_path / "p.scenic").write_text(text)
    done = ask("simulate", "p.scenic", "--steps", 1, "-o", "runs.jsonl", "--html", "page.html", *more)
    assert done.code == 0, done.err
    page = (tmp_path / "page.html").read_text()
    return json.loads(page.split("const data = ", 1)[1].split(";\nconst at", 1)[0])


def cover(areas, colour):
    shapes = [shapely.Polygon(area["rings"][0], area["rings"][1:]) for area in areas if area["colour"] == colour]
    return shapely.union_all(shapes)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_a_program_on_roads_has_its_map(ask, tmp_path, workers):
    data = data_of(ask, tmp_path, ROAD, "-n", 2, "--workers", workers)
    ground = data["map"]
    assert [run["land"] for run in data["runs"]] == [None, None]
    road = cover(ground["areas"], map_layers.ROAD).union(cover(ground["areas"], map_layers.JUNCTION))
    for run in data["runs"]:
        for thing in run["objects"]:
            assert road.buffer(0.2).covers(shapely.Point(thing["position"]))
    assert {map_layers.WALK, map_layers.SHOULDER} <= {area["colour"] for area in ground["areas"]}
    assert ground["ways"]
    for x, y, heading in ground["arrows"]:
        assert road.buffer(0.2).covers(shapely.Point(x, y))
        assert abs(heading) < 4


def test_ego_is_red_and_the_others_have_the_colours_of_their_classes(ask, tmp_path):
    (run,) = data_of(ask, tmp_path, ROAD)["runs"]
    assert [thing["colour"] for thing in run["objects"]] == [EGO, CLASSES[0], CLASSES[1]]


def test_each_simulation_has_its_own_workspace(ask, tmp_path):
    text = "r = Range(5, 50)\nworkspace = Workspace(RectangularRegion((0, 0), 0, r, 10))\nego = Object at (0, 0)\nparam r = r\n"
    data = data_of(ask, tmp_path, text, "-n", 3)
    widths = [json.loads(line)["scene"]["params"]["r"] for line in (tmp_path / "runs.jsonl").read_text().splitlines()]
    assert data["map"] is None
    for run, width in zip(data["runs"], widths, strict=True):
        (area,) = run["land"]["areas"]
        assert area["colour"] == LAND
        assert cover(run["land"]["areas"], LAND).bounds == pytest.approx((-width / 2, -5, width / 2, 5), abs=0.01)


def test_a_workspace_with_a_hole_keeps_it(ask, tmp_path):
    text = "workspace = Workspace(CircularRegion((0, 0), 20).difference(CircularRegion((10, 0), 3)))\nego = Object at (0, 0)\n"
    (run,) = data_of(ask, tmp_path, text)["runs"]
    ground = cover(run["land"]["areas"], LAND)
    assert not ground.covers(shapely.Point(10, 0))
    assert ground.covers(shapely.Point(0, 15))


def test_the_whole_plane_and_objects_beyond_all_bounds_have_no_land(ask, tmp_path):
    assert data_of(ask, tmp_path, "ego = Object at (0, 0)\n")["runs"][0]["land"] == {"areas": []}
    far = "workspace = Workspace(CircularRegion((0, 0), 1e12))\nego = Object at (1e10, 0)\n"
    assert data_of(ask, tmp_path, far)["runs"][0]["land"] == {"areas": []}


SITE = """{"type": "FeatureCollection", "crs": null, "features": [
{"type": "Feature", "properties": {"name": "yard"}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]]]}},
{"type": "Feature", "properties": {"name": "wall"}, "geometry": {"type": "LineString", "coordinates": [[1, 1], [9, 1]]}},
{"type": "Feature", "properties": {"name": "posts"}, "geometry": {"type": "MultiPoint", "coordinates": [[3, 3], [5, 3], [900, 900]]}}]}"""


def test_a_map_of_ones_own_is_below_with_its_areas_lines_and_points(ask, tmp_path):
    (tmp_path / "s.geojson").write_text(SITE)
    text = f"param map = {str(tmp_path / 's.geojson')!r}\nmodel site_map\nego = Object at 10 @ 10\n"
    land = data_of(ask, tmp_path, text)["runs"][0]["land"]
    assert cover(land["areas"], FAINT[0]).bounds == (0, 0, 20, 20)
    assert land["lines"] == [{"colour": DIM[1], "points": [[1, 1], [9, 1]]}]
    assert land["points"] == [{"colour": DIM[2], "points": [[3, 3], [5, 3]]}]
