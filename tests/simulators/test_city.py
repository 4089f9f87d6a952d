"""The made-up city: roads, curbs and traffic directions are what programs about cars rely on."""

from __future__ import annotations

import math

import pytest
import scenic_ref
from scenic_ref.interpreter.runtime.random_streams import Stream
from scenic_ref.semantics.space import geometry as g
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.simulators.worlds.city import LANE, SHOULDER, City, city
from shapely.geometry import LineString

POSES = ((-628.7878, -540.6067, -359.1691), (-625.4444, -530.7654, 8.2872))  # of the gallery's cars: x, y, degrees


@pytest.fixture(scope="module")
def world() -> City:
    return city()


def some_points(world: City, what: str, count: int) -> list[Vector]:
    numbers = Stream(5, 0, 0).at((0,))
    region = world.road_region() if what == "road" else world.curb_region()
    return [region.sample(numbers) for _ in range(count)]


def test_the_city_is_made_once_and_always_the_same(world: City) -> None:
    assert city() is world
    again = city.__wrapped__()
    assert [(p.wkb, h) for p, h in again.cells] == [(p.wkb, h) for p, h in world.cells]
    assert [c.wkb for c in again.curbs] == [c.wkb for c in world.curbs]


def test_the_city_is_large_and_its_cells_are_polygons(world: City) -> None:
    assert len(world.cells) >= 400
    assert all(cell.is_valid and cell.area > 1 for cell, _ in world.cells)
    west, south, east, north = world.road.bounds
    assert 250 < east - west < 2000
    assert 250 < north - south < 2000


def test_every_point_of_the_road_has_a_traffic_direction(world: City) -> None:
    direction = world.road_direction()
    for point in some_points(world, "road", 5000):
        direction.at(point)  # raises OutsideField if there is none
    assert world.road_region().orientation is direction


def test_the_road_is_to_the_left_of_its_curbs(world: City) -> None:
    direction, road = world.road_direction(), world.road_region()
    for point in some_points(world, "curb", 3000):
        heading = direction.at(point)
        assert road.contains_point(g.offset_local(point, heading, Vector(-2.0, 0.0)))
    assert world.curb_region().orientation is direction


def test_beside_a_curb_there_is_no_road_but_near_junctions(world: City) -> None:
    direction, road = world.road_direction(), world.road_region()
    points = some_points(world, "curb", 3000)
    beyond = sum(road.contains_point(g.offset_local(p, direction.at(p), Vector(1.0, 0.0))) for p in points)
    assert beyond / len(points) < 0.02


def test_curbs_run_along_traffic_and_stop_at_junctions(world: City) -> None:
    direction = world.road_direction()
    for curb in world.curbs:
        middle = curb.interpolate(0.5, normalized=True)
        ahead = curb.interpolate(curb.length / 2 + 0.5)
        along = g.angle_of(Vector(ahead.x - middle.x, ahead.y - middle.y))
        assert abs(g.normalise_heading(along - direction.at(Vector(middle.x, middle.y)))) < math.radians(15)
    inside = world.road.buffer(-1.0)
    assert sum(curb.intersection(inside).length for curb in world.curbs) < 0.01 * sum(curb.length for curb in world.curbs)


def test_traffic_keeps_to_the_right(world: City) -> None:
    """On the avenue of the gallery's cars, northbound traffic is East of southbound traffic."""
    direction = world.road_direction()
    assert abs(direction.at(Vector(-625.0, -540.0))) < math.radians(5)
    assert abs(direction.at(Vector(-636.0, -540.0))) > math.radians(175)


@pytest.mark.parametrize(("x", "y", "degrees"), POSES)
def test_the_gallerys_cars_are_on_the_road_even_with_noise(world: City, x: float, y: float, degrees: float) -> None:
    road, heading = world.road_region(), math.radians(degrees)
    for dx, dy, turn in ((0, 0, 0), (2, 1, 5), (-2, -1, -5), (3, 0, 0), (-3, 0, 10)):
        assert road.contains_box(Vector(x + dx, y + dy), heading + math.radians(turn), 2.5, 5.5)


def test_the_gallerys_ego_drives_along_traffic(world: City) -> None:
    x, y, degrees = POSES[0]
    assert abs(g.normalise_heading(math.radians(degrees) - world.road_direction().at(Vector(x, y)))) < math.radians(1)


def test_three_lanes_of_cars_fit_on_most_of_the_road(world: City) -> None:
    """Three cars side by side, 3.5 m apart, are all on the road at a good share of its points."""
    direction, road = world.road_direction(), world.road_region()
    points = some_points(world, "road", 1500)
    abreast = [[g.offset_local(p, direction.at(p), Vector(x, 0.0)) for x in (-3.5, 0.0, 3.5)] for p in points]
    fits = sum(all(road.contains_box(c, direction.at(p), 2.0, 4.5) for c in cars) for p, cars in zip(points, abreast, strict=True))
    assert fits / len(points) > 0.5


def test_avenues_are_three_lanes_a_side(world: City) -> None:
    """21 m and the strips at the edges; measured across the avenue of the gallery's cars."""
    across = world.road.intersection(LineString([(-660.0, -540.0), (-600.0, -540.0)]))
    assert across.length == pytest.approx(6 * LANE + 2 * SHOULDER, abs=0.1)


@pytest.mark.parametrize(("dialect", "profile", "new"), [("paper", "paper", ""), ("scenic-2.1", "scenic-2.1", ""), ("scenic-3", "scenic-3", "new ")])
def test_cars_are_as_long_as_their_models(dialect: str, profile: str, new: str) -> None:
    program = f"model scenic.simulators.gta.model\nego = {new}Car\nparam wanted = [ego.model.width, ego.model.length]\n"
    scene = scenic_ref.loads(program, dialect=dialect, profile=profile).sample(seed=1)
    assert [scene.ego.width, scene.ego.length] == scene.params["wanted"] and scene.ego.length > 3
