"""Points of regions are uniform: counts in cells of known probability, against a rival that each test must reject.

The seeds are fixed; with a fresh one each test raises a false alarm with probability at most `DEFAULT_ALPHA`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping
from typing import TypeVar

import pytest
from scenic_ref.inference.comparison import Categorical, contradicts
from scenic_ref.interpreter.runtime.random_streams import Stream
from scenic_ref.semantics.space import geometry as g
from scenic_ref.semantics.space.regions import (
    CircularRegion,
    PointSetRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    Region,
    SectorRegion,
)
from scenic_ref.semantics.space.regions.combinations import PROPOSALS
from scenic_ref.semantics.space.vectors import Vector
from shapely.geometry import MultiPolygon, Point, Polygon, box

COUNT = 20_000
ORIGIN = Vector(0.0, 0.0)
Cell = TypeVar("Cell", bound=Hashable)
Draw = Callable[[Callable[[], float]], Vector]


def alarms(draw: Draw, classify: Callable[[Vector], Cell], probabilities: Mapping[Cell, float]) -> bool:
    """Whether the cells of the draws contradict their probabilities."""
    numbers = Stream(7, 0, 0).at((0,))
    assert sum(probabilities.values()) == pytest.approx(1, abs=1e-12)
    return contradicts([classify(draw(numbers)) for _ in range(COUNT)], Categorical(probabilities))


def ring_and_side(v: Vector) -> tuple[bool, bool]:
    return math.hypot(v.x, v.y) < 1, g.angle_of(v) < 0


def linear_radius(numbers: Callable[[], float]) -> Vector:
    """The rival: the distance from the centre is uniform (no square root)."""
    return g.rotate(Vector(0.0, 2 * numbers()), (numbers() - 0.5) * 2 * math.pi)


def test_discs_are_uniform_by_area() -> None:
    cells = {(True, True): 1 / 8, (True, False): 1 / 8, (False, True): 3 / 8, (False, False): 3 / 8}
    assert not alarms(CircularRegion(ORIGIN, 2.0).sample, ring_and_side, cells)
    assert alarms(linear_radius, ring_and_side, cells)


def test_sectors_are_uniform_by_area_and_angle() -> None:
    sector = SectorRegion(Vector(3.0, 4.0), 2.0, 1.0, 5.0)

    def cell(v: Vector) -> tuple[bool, int]:
        local = g.to_local(sector.center, sector.heading, v)
        return g.vector_norm(local) < 1, math.floor((g.angle_of(local) + 2.5) / 1.25)

    cells = {(near, part): (0.25 if near else 0.75) / 4 for near in (True, False) for part in range(4)}
    assert not alarms(sector.sample, cell, cells)
    narrower = SectorRegion(sector.center, 2.0, 1.1, 4.8)
    assert alarms(narrower.sample, cell, cells)


def test_rectangles_are_uniform() -> None:
    rectangle = RectangularRegion(Vector(1.0, 2.0), 0.7, 4.0, 2.0)

    def cell(v: Vector) -> tuple[bool, bool]:
        local = g.to_local(rectangle.position, rectangle.heading, v)
        return local.x < 1, local.y < 0.5

    cells = {(True, True): 9 / 16, (True, False): 3 / 16, (False, True): 3 / 16, (False, False): 1 / 16}
    assert not alarms(rectangle.sample, cell, cells)
    assert alarms(RectangularRegion(Vector(1.0, 2.0), 0.7, 5.0, 2.0).sample, cell, cells)


@pytest.mark.slow
def test_overlapping_polygons_are_one_area() -> None:
    """The rival chooses one of the two polygons first, and so favours their overlap."""
    parts = [PolygonalRegion(polygon=box(0, 0, 2, 2)), PolygonalRegion(polygon=box(1, 0, 3, 2))]
    both = PolygonalRegion(polygon=[part.polygon for part in parts])
    cells = {0: 1 / 3, 1: 1 / 3, 2: 1 / 3}
    for region in (both, parts[0].union(parts[1])):
        assert not alarms(region.sample, lambda v: math.floor(v.x), cells)
    assert alarms(lambda numbers: parts[numbers() < 0.5].sample(numbers), lambda v: math.floor(v.x), cells)


def test_polygons_with_holes_and_bays_are_uniform_within_and_between_triangles() -> None:
    """The rival forgets the square root: points crowd at one corner of each triangle."""
    outline = [(0, 0), (6, 0), (6, 4), (4, 4), (4, 5), (6, 5), (6, 6), (0, 6)]
    shape = Polygon(outline, [box(1, 1, 3, 3).exterior])
    region = PolygonalRegion(polygon=shape)
    squares = {(i, j): (shape & box(i, j, i + 1, j + 1)).area / shape.area for i in range(6) for j in range(6)}
    cells = {square: share for square, share in squares.items() if share > 0}
    assert not alarms(region.sample, lambda v: (math.floor(v.x), math.floor(v.y)), cells)

    def crowded(numbers: Callable[[], float]) -> Vector:
        chosen, first, second = numbers(), numbers(), numbers()
        values = iter((chosen, first * first, second))
        return region.sample(lambda: next(values))

    assert alarms(crowded, lambda v: (math.floor(v.x), math.floor(v.y)), cells)


def lens_cells() -> tuple[Region, Callable[[Vector], bool], dict[bool, float]]:
    lens = CircularRegion(ORIGIN, 2.0).intersect(CircularRegion(Vector(1.0, 0.0), 2.0))
    area = 8 * math.acos(1 / 4) - math.sqrt(15) / 2
    return lens, lambda v: math.hypot(v.x - 0.5, v.y) < 1.5, {True: 2.25 * math.pi / area, False: 1 - 2.25 * math.pi / area}


def test_intersections_of_discs_are_uniform() -> None:
    lens, inside, cells = lens_cells()
    assert not alarms(lens.sample, inside, cells)
    assert alarms(CircularRegion(Vector(0.5, 0.0), 1.7).sample, inside, cells)


@pytest.mark.slow
def test_the_remains_of_what_is_proposed_are_uniform_too() -> None:
    """Two rectangles with 1/200 of each in common: half of the points are found by proposing, half in the shape of the remains."""
    corner = RectangularRegion(ORIGIN, 0.0, 20.0, 10.0).intersect(RectangularRegion(Vector(18.0, 9.5), 0.0, 20.0, 10.0))
    assert corner.measure() == pytest.approx(1.0)
    numbers, tries = Stream(7, 0, 0).at((0,)), [0] * 400

    def counted(which: int) -> float:
        tries[which] += 1
        return numbers()

    for k in range(len(tries)):
        corner.sample(lambda k=k: counted(k))
    assert 0.3 < sum(used > 2 * PROPOSALS for used in tries) / len(tries) < 0.7
    cells = {(i, j): 1 / 8 for i in range(4) for j in range(2)}
    assert not alarms(corner.sample, lambda v: (math.floor(2 * v.x - 16), math.floor(4 * v.y - 18)), cells)
    larger = RectangularRegion(ORIGIN, 0.0, 20.0, 10.2).intersect(RectangularRegion(Vector(18.0, 9.5), 0.0, 20.0, 10.0))
    assert alarms(larger.sample, lambda v: (math.floor(2 * v.x - 16), min(math.floor(4 * v.y - 18), 1)), cells)


def test_differences_are_uniform() -> None:
    ring = CircularRegion(ORIGIN, 2.0).difference(CircularRegion(ORIGIN, 1.0))
    cells = {True: (1.5**2 - 1) / 3, False: (4 - 1.5**2) / 3}
    assert not alarms(ring.sample, lambda v: math.hypot(v.x, v.y) < 1.5, cells)
    assert alarms(CircularRegion(ORIGIN, 2.0).sample, lambda v: math.hypot(v.x, v.y) < 1.5, cells)


def test_unions_of_discs_are_uniform() -> None:
    union = CircularRegion(ORIGIN, 2.0).union(CircularRegion(Vector(1.0, 0.0), 2.0))
    area = 8 * math.pi - (8 * math.acos(1 / 4) - math.sqrt(15) / 2)
    cells = {True: 4 * math.pi / area, False: 1 - 4 * math.pi / area}
    assert not alarms(union.sample, lambda v: math.hypot(v.x, v.y) <= 2, cells)
    lens, _, _ = lens_cells()
    assert alarms(lens.sample, lambda v: math.hypot(v.x, v.y) <= 2, cells)


@pytest.mark.slow
def test_the_visible_part_of_a_road_is_uniform() -> None:
    """A sector of a quarter turn on a cross of two roads, with the shares of its cells by close polygons."""
    road = PolygonalRegion(polygon=[box(-1, -9, 1, 9), box(-9, 3, 9, 5)])
    seen = road.intersect(SectorRegion(ORIGIN, 6.0, 0.0, math.pi / 2))
    close = road.polygon & (Point(0, 0).buffer(6, quad_segs=20_000) & box(-9, 0, 9, 9)) & _quarter()
    cells = {k: (close & box(-9, k, 9, k + 1)).area / close.area for k in range(6)}
    assert seen.measure() == pytest.approx(close.area, rel=1e-7)
    assert not alarms(seen.sample, lambda v: math.floor(v.y), cells)
    wider = road.intersect(SectorRegion(ORIGIN, 6.0, 0.0, 1.75))
    assert alarms(wider.sample, lambda v: math.floor(v.y), cells)


def _quarter() -> Polygon | MultiPolygon:
    return PolygonalRegion([(0, 0), (20, 20), (-20, 20)]).polygon


def test_polylines_are_uniform_by_length() -> None:
    """The rival chooses among the segments first."""
    line = PolylineRegion([(0, 0), (1, 0), (1, 3)])

    def cell(v: Vector) -> int:
        return 0 if v.y == 0 else 1 + math.floor(v.y)

    cells = {0: 1 / 4, 1: 1 / 4, 2: 1 / 4, 3: 1 / 4}
    assert not alarms(line.sample, cell, cells)
    short, tall = PolylineRegion([(0, 0), (1, 0)]), PolylineRegion([(1, 0), (1, 3)])
    assert alarms(lambda numbers: (short if numbers() < 0.5 else tall).sample(numbers), cell, cells)


def test_polylines_in_sectors_are_uniform_by_length_with_true_arcs() -> None:
    line = PolylineRegion(polyline=[PolylineRegion([(-5, y), (5, y)]).polyline.geoms[0] for y in (1, 2)])
    seen = line.intersect(CircularRegion(ORIGIN, 2.5))
    lengths = {1: 2 * math.sqrt(6.25 - 1), 2: 2 * math.sqrt(6.25 - 4)}
    assert seen.measure() == pytest.approx(sum(lengths.values()), rel=1e-14)
    cells = {y: length / sum(lengths.values()) for y, length in lengths.items()}
    assert not alarms(seen.sample, lambda v: round(v.y), cells)
    assert alarms(line.sample, lambda v: round(v.y), cells)
    wedge = line.intersect(SectorRegion(ORIGIN, 100.0, 0.0, math.pi / 2))
    assert wedge.measure() == pytest.approx(6, rel=1e-14)
    rest = line.difference(SectorRegion(ORIGIN, 100.0, 0.0, math.pi / 2))
    assert rest.measure() == pytest.approx(14, rel=1e-14)
    assert line.union(PolylineRegion([(4, 1), (6, 1)])).measure() == pytest.approx(21)


def test_points_are_equally_likely() -> None:
    points = PointSetRegion("p", [(0, 0), (1, 0), (2, 0), (2, 0)])
    cells = {0: 1 / 3, 1: 1 / 3, 2: 1 / 3}
    assert not alarms(points.sample, lambda v: round(v.x), cells)
    assert alarms(lambda numbers: Vector(float(min(2, int(numbers() * 4))), 0.0), lambda v: round(v.x), cells)
    assert not alarms(points.intersect(CircularRegion(ORIGIN, 1.5)).sample, lambda v: round(v.x), {0: 1 / 2, 1: 1 / 2})


@pytest.mark.parametrize(
    "region", [CircularRegion(ORIGIN, 1.0), SectorRegion(ORIGIN, 1.0, 0.0, 1.0), RectangularRegion(ORIGIN, 0.0, 1.0, 1.0)]
)
def test_shapes_use_two_numbers_and_polygons_three(region: Region) -> None:
    for shape, expected in ((region, 2), (PolygonalRegion(polygon=box(0, 0, 1, 1)), 3), (PolylineRegion([(0, 0), (1, 1)]), 1)):
        used: list[float] = []
        numbers = Stream(0, 0, 0).at(())
        shape.sample(lambda: used.append(numbers()) or used[-1])  # noqa: B023
        assert len(used) == expected


def test_thin_remains_of_two_discs_are_sampled_without_endless_rejection() -> None:
    sliver = CircularRegion(ORIGIN, 30.0).intersect(CircularRegion(Vector(59.9999, 0.0), 30.0))
    numbers = Stream(0, 0, 0).at(())
    for _ in range(50):
        assert sliver.contains_point(sliver.sample(numbers))
