"""Points and boxes that lie on the boundary of a closed set, as written: they are in it, in every backend, however they were computed."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pytest
import scenic_ref
from scenic_ref.inference.batch import Batch
from scenic_ref.inference.pruning.algorithms import ROUNDING
from scenic_ref.semantics.space import geometry as g
from scenic_ref.semantics.space.boundaries import METRES, RADIANS
from scenic_ref.semantics.space.fields import PolygonalVectorField
from scenic_ref.semantics.space.regions import (
    BadRegion,
    CircularRegion,
    EmptyRegion,
    PointSetRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    Region,
    SectorRegion,
)
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import AttemptsExhausted

CASES = 200
Case = tuple[Region, Vector, Vector]
"""A region, a point on its boundary, and the direction away from it there."""


def place(chance: random.Random) -> tuple[Vector, float]:
    """A point and a heading, up to some kilometres away."""
    far = 10 ** chance.uniform(-1, 4)
    return Vector(chance.uniform(-far, far), chance.uniform(-far, far)), chance.uniform(-7, 7)


def disc(chance: random.Random) -> Case:
    center, heading = place(chance)
    radius = chance.uniform(0.1, 50)
    return CircularRegion(center, radius), g.offset_local(center, heading, Vector(0.0, radius)), g.direction(heading)


def sector(chance: random.Random) -> Case:
    center, heading = place(chance)
    radius, angle = chance.uniform(0.1, 50), chance.uniform(0.01, 6.2)
    side = chance.choice((1, -1))
    edge = heading + side * angle / 2
    point = g.offset_local(center, edge, Vector(0.0, chance.uniform(0.1, 0.9) * radius))
    return SectorRegion(center, radius, heading, angle), point, g.direction(edge + side * math.pi / 2)


def arc(chance: random.Random) -> Case:
    center, heading = place(chance)
    radius, angle = chance.uniform(0.1, 50), chance.uniform(0.1, 6.2)
    along = heading + chance.uniform(-0.4, 0.4) * angle
    return SectorRegion(center, radius, heading, angle), g.offset_local(center, along, Vector(0.0, radius)), g.direction(along)


def rectangle(chance: random.Random) -> Case:
    center, heading = place(chance)
    width, length = chance.uniform(0.1, 50), chance.uniform(0.1, 50)
    point = g.offset_local(center, heading, Vector(width / 2, chance.uniform(-0.5, 0.5) * length))
    return RectangularRegion(center, heading, width, length), point, g.direction(heading - math.pi / 2)


def polygon(chance: random.Random) -> Case:
    region, point, out = rectangle(chance)
    assert isinstance(region, RectangularRegion)
    return PolygonalRegion(g.corners(region.position, region.heading, region.width, region.length)), point, out


def union(chance: random.Random) -> Case:
    region, point, out = polygon(chance)
    return region.union(CircularRegion(point - 60 * out, 0.1)), point, out


def intersection(chance: random.Random) -> Case:
    region, point, out = sector(chance)
    return region.intersect(CircularRegion(point, 1.0)), point, out


def line(chance: random.Random) -> Case:
    start, heading = place(chance)
    point = g.offset_local(start, heading, Vector(0.0, chance.uniform(1, 9)))
    return PolylineRegion([start, g.offset_local(start, heading, Vector(0.0, 10.0))]), point, g.direction(heading + math.pi / 2)


@pytest.mark.parametrize("kind", [disc, sector, arc, rectangle, polygon, union, intersection, line])
def test_a_point_on_the_boundary_is_in_the_region_and_one_beside_it_is_not(kind: Callable[[random.Random], Case]):
    chance, on, beside = random.Random(kind.__name__), 0, 0
    for _ in range(CASES):
        region, point, out = kind(chance)
        on += region.contains_point(point)
        beside += region.contains_point(point + 3 * METRES * out)
    assert (on, beside) == (CASES, 0)


def test_what_was_taken_away_takes_its_boundary_with_it():
    chance = random.Random(3)
    for _ in range(CASES):
        region, point, out = polygon(chance)
        rest = CircularRegion(point, 1.0).difference(region)
        assert not rest.contains_point(point)
        assert rest.contains_point(point + 3 * METRES * out)


def test_cells_of_fields_are_closed():
    chance = random.Random(4)
    for _ in range(CASES):
        region, point, out = polygon(chance)
        field = PolygonalVectorField("f", [(region, 1.0)])
        assert field.cell_at(point) == 0
        assert field.cell_at(point + 3 * METRES * out) is None


@pytest.mark.parametrize("kind", [rectangle, polygon])
def test_a_box_as_large_as_the_region_is_in_it(kind: Callable[[random.Random], Case]):
    fits, exceeds = random.Random(5), random.Random(5)
    for _ in range(CASES):
        (region, *_), (same, *_) = kind(fits), rectangle(exceeds)
        assert isinstance(same, RectangularRegion)
        box = (same.position, same.heading, same.width, same.length)
        assert region.contains_box(*box)
        assert region.union(CircularRegion(Vector(1e5, 1e5), 1.0)).contains_box(*box)
        assert not region.contains_box(*box[:3], same.length + 6 * METRES)


def test_boxes_side_by_side_touch_and_do_not_overlap():
    chance = random.Random(6)
    for _ in range(CASES):
        position, heading = place(chance)
        widths = chance.uniform(0.1, 9), chance.uniform(0.1, 9)
        for gap, touch, overlap in ((0.0, True, False), (3 * METRES, False, False), (-3 * METRES, True, True)):
            beside = g.offset_local(position, heading, Vector(sum(widths) / 2 + gap, 0.3))
            boxes = (position, heading, widths[0], 2.0, beside, heading + chance.choice((0, math.pi)), widths[1], 3.0)
            assert (g.boxes_intersect(*boxes), g.boxes_intersect(*boxes, closed=False)) == (touch, overlap)


@pytest.mark.parametrize("kind", [sector, arc])
def test_a_box_that_touches_the_visible_region_is_seen(kind: Callable[[random.Random], Case]):
    chance = random.Random(7)
    for _ in range(CASES):
        region, point, out = kind(chance)
        assert isinstance(region, SectorRegion)
        view, box = (region.center, region.radius, region.heading, region.angle), (g.angle_of(out), 0.01, 0.02)
        assert g.sector_meets_box(*view, point + 0.01 * out, *box)
        if region.angle < 3:  # else it is seen on the other side
            assert not g.sector_meets_box(*view, point + (0.01 + 5 * METRES) * out, *box)


def test_a_view_that_lacks_next_to_nothing_of_a_full_turn_is_a_disc():
    behind = Vector(0.0, -5.0)
    assert g.sector_contains(Vector(0.0, 0.0), 9.0, 0.0, g.TAU - RADIANS / 2, behind)
    assert not g.sector_contains(Vector(0.0, 0.0), 9.0, 0.0, g.TAU - 1e-6, behind + Vector(1e-7, 0.0))


BEGINNING = """
c = Uniform(0, 1000) + Range(-5, 5)
h, t, s = Range(0, 360) deg, Range(1, 19), Range(-90, 90)
ego = Object at (c, c), facing h, with viewAngle 90 deg, with viewDistance 20
land = PolygonalRegion([(-70, -100), (70, 100), (-300, 100), (-300, -100)])
shore = OrientedPoint at (0.7 * s, s), facing angle from (-70, -100) to (70, 100)
wind = PolygonalVectorField('wind', [(land, 2)], defaultHeading=0)
"""
ANSWERS = {
    "can see": "param answer = ego can see (ego.position offset along h + 45 deg by (0, t))",
    "disc": "param answer = (ego.position offset along h by (0, t)) in CircularRegion(ego.position, t)",
    "sector": "param answer = (ego.position offset along h + 0.2 by (0, t)) in SectorRegion(ego.position, 20, h, 0.4)",
    "rectangle": "param answer = (ego.position offset along h by (3, t - 10)) in RectangularRegion(ego.position, h, 6, 20)",
    "polygon": "param answer = shore.position in land",
    "field": "param answer = (wind at shore.position) == 2",
    "box in polygon": "house = Object left of shore, with width 2, with requireVisible False\nparam answer = house in land",
    "box in rectangle": "param answer = ego in RectangularRegion(ego.position, h, 1, 1)",
    "view of a box": "edge = OrientedPoint at ego.position offset along h + 45 deg by (0, t), facing h + 45 deg\n"
    "wall = Object left of edge, with width 3, with requireVisible False, with allowCollisions True\nparam answer = ego can see wall",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["interpreter", "columns", pytest.param("compiled", marks=pytest.mark.extra("fast"))])
@pytest.mark.parametrize("name", ANSWERS)
def test_every_backend_decides_a_boundary_alike(name: str, backend: str):
    scenario = scenic_ref.loads(BEGINNING + ANSWERS[name] + "\n")
    if backend == "interpreter":
        scenes = [scenario.sample(9, i) for i in range(50)]
    else:
        scenario.rehearse()
        batch = Batch(scenario.start, fuel=scenario.fuel)
        assert backend == "columns" or batch.compile(), batch.not_compiled
        scenes = list(batch.scenes(300, 9))
    assert [scene.params["answer"] for scene in scenes] == [True] * len(scenes)


def test_what_stands_side_by_side_never_collides_where_touching_is_allowed():
    text = BEGINNING + "Object left of ego, with requireVisible False\n"
    allowed, forbidden = (scenic_ref.loads(text, readings={"touching": reading}) for reading in ("allow", "collide"))
    assert [scene.attempts for scene in allowed.sample_many(300, seed=2)] == [1] * 300
    with pytest.raises(AttemptsExhausted):
        forbidden.sample(2, 0, max_attempts=100)


@pytest.mark.slow
def test_rectangles_side_by_side_are_overlaid_rightly():
    """Their common edge is one line but for rounding, of which an overlay without a grid loses a whole rectangle, in some cases of a thousand."""
    chance = random.Random(8)
    for _ in range(1000):
        position, heading = place(chance)
        left, right, length = (chance.uniform(1, 9) for _ in range(3))
        beside = g.offset_local(position, heading, Vector((left + right) / 2, 0.0))
        one, other = (PolygonalRegion(g.corners(p, heading, w, length)) for p, w in ((position, left), (beside, right)))
        assert one.intersects(other)
        assert PolygonalRegion(polygon=[one, other]).measure() == pytest.approx((left + right) * length, rel=1e-6)  # type: ignore[list-item]
        assert one.union(other).measure() == pytest.approx((left + right) * length, rel=1e-6)
        assert one.intersect(other).measure() == pytest.approx(0.0, abs=1e-5)
        assert one.difference(other).measure() == pytest.approx(left * length, rel=1e-6)
        assert not one.intersects(PolygonalRegion(g.corners(beside + 3 * METRES * g.direction(heading - math.pi / 2), heading, right, length)))


def test_polygons_that_vanish_on_the_grid_are_refused():
    dust = PolygonalRegion([(0, 0), (1e-10, 0), (0, 1e-10)])
    with pytest.raises(BadRegion, match="larger than 1e-09 m"):
        PolygonalRegion(polygon=[dust, dust])  # type: ignore[list-item]


def test_pruning_rounds_by_more_than_the_boundary_is_wide():
    assert ROUNDING > 10 * METRES


def square(west: float, east: float) -> PolygonalRegion:
    return PolygonalRegion([(west, 0), (east, 0), (east, 1), (west, 1)])


def test_regions_that_touch_as_written_meet_however_they_are_written():
    left, right = square(0, 0.3), square(0.1 + 0.2, 1)
    away, beyond = square(-9, -8), square(0.3001, 1)
    for one in (left, left.union(away), away.union(left), left.union(left), left.intersect(square(-1, 0.3))):
        assert one.intersects(right)
        assert right.intersects(one)
        assert not one.intersects(beyond)


def test_what_lies_along_a_boundary_can_be_drawn_from_the_intersection():
    edge = [Vector(0.1 + 0.2, 0.2), Vector(0.1 + 0.2, 0.8)]
    for region in (square(0, 0.3), RectangularRegion(Vector(0.15, 0.5), 0.0, 0.3, 1.0)):
        for thin in (PointSetRegion("spots", edge), PolylineRegion(edge)):
            both = thin.intersect(region)
            assert both.contains_point(both.sample(lambda: 0.5))
        with pytest.raises(EmptyRegion):
            PolylineRegion([Vector(0.301, 0.2), Vector(0.301, 0.8)]).intersect(region).sample(lambda: 0.5)


def test_a_disc_without_itself_is_empty_in_reasonable_time(effort: Callable[[Callable[[], object]], float]):
    """60 times a fixed calculation; with all overlays on a grid it took some 200 times as much."""
    disc = CircularRegion(Vector(0, 0), 5)

    def draw() -> None:
        with pytest.raises(EmptyRegion):
            disc.difference(disc).sample(lambda: 0.5)

    assert effort(draw) < 60
