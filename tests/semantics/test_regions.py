"""Regions as sets: points, boxes, distances, combinations, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scenic_ref.interpreter.runtime.random_streams import Stream
from scenic_ref.semantics.space import geometry as g
from scenic_ref.semantics.space.boundaries import METRES
from scenic_ref.semantics.space.fields import VectorField
from scenic_ref.semantics.space.regions import (
    BadRegion,
    CircularRegion,
    EmptyRegion,
    IntersectionRegion,
    PointSetRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    Region,
    SectorRegion,
    UnboundedRegion,
    Workspace,
    everywhere,
    nowhere,
)
from scenic_ref.semantics.space.vectors import Vector
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

ORIGIN = Vector(0.0, 0.0)
coordinates = st.floats(-6, 6).map(lambda x: x if abs(x) > 1e-12 else 0.0)  # nearer to an edge than rounding, either answer is right
vectors = st.builds(Vector, coordinates, coordinates)
headings = st.floats(-4, 4)
extents = st.floats(0.01, 5)
circles = st.builds(CircularRegion, vectors, extents)
sectors = st.builds(SectorRegion, vectors, extents, headings, st.floats(0.01, 7))
rectangles = st.builds(RectangularRegion, vectors, headings, extents, extents)
polygons = st.sampled_from(
    [Polygon([(0, 0), (4, 0), (4, 4), (3, 1)]), Polygon(box(-3, -3, 1, 1).exterior, [box(-2, -2, 0, 0).exterior])]
).map(lambda p: PolygonalRegion(polygon=p))
simple = circles | sectors | rectangles | polygons
combined = st.builds(lambda how, a, b: getattr(a, how)(b), st.sampled_from(["intersect", "union", "difference"]), simple, simple)
regions = simple | combined
boxes = st.tuples(vectors, headings, extents, extents)
Box = tuple[Vector, float, float, float]


def random_points(region: Region, count: int, seed: int = 1) -> list[Vector]:
    numbers = Stream(seed, 0, 0).at((0,))
    return [region.sample(numbers) for _ in range(count)]


def points_of_box(region_box: Box) -> list[Vector]:
    """A grid of points of the box, with its corners and edges."""
    position, heading, width, length = region_box
    shares = [k / 6 - 0.5 for k in range(7)]
    return [g.offset_local(position, heading, Vector(s * width, t * length)) for s in shares for t in shares]


@pytest.mark.slow
@given(regions, boxes)
@settings(deadline=None, max_examples=300)
def test_a_contained_box_has_its_points_inside_and_an_unmet_one_outside(region: Region, region_box: Box) -> None:
    position, heading, width, length = region_box
    points = points_of_box((position, heading, width * (1 - 1e-6), length * (1 - 1e-6)))
    if region.contains_box(*region_box):
        assert all(map(region.contains_point, points))
        assert region.meets_box(*region_box)
    if not region.meets_box(*region_box):
        assert not any(map(region.contains_point, points))


@pytest.mark.slow
@given(regions, boxes)
@settings(deadline=None, max_examples=300)
def test_a_box_that_is_not_contained_has_a_point_outside(region: Region, region_box: Box) -> None:
    """Judged by close polygons: what is missing has an area, or the box is nearly contained."""
    assume(not region.contains_box(*region_box))
    window = box(-30, -30, 30, 30)
    shape = Polygon([tuple(corner) for corner in g.corners(*region_box)])
    core = region.approximate(4096, window).core
    assert not core.buffer(-1e-4).covers(shape)


@given(regions, vectors)
@settings(deadline=None, max_examples=300)
def test_points_between_core_and_cover(region: Region, v: Vector) -> None:
    for sides in (32, 256):
        approximation = region.approximate(sides, box(-30, -30, 30, 30))
        point = Point(*v)
        assume(approximation.core.boundary.distance(point) > 1e-6)
        assume(approximation.cover.boundary.distance(point) > 1e-6)
        if approximation.core.covers(point):
            assert region.contains_point(v)
        if region.contains_point(v):
            assert approximation.cover.covers(point)


@example(PolygonalRegion(polygon=Polygon([(0, 0), (4, 0), (4, 4), (3, 1)])), Vector(0.0, 3.5e-11))
@given(regions, vectors)
@settings(deadline=None, max_examples=200)
def test_distance_is_that_to_close_polygons_and_zero_inside(region: Region, v: Vector) -> None:
    approximation = region.approximate(4096, box(-30, -30, 30, 30))
    shape = approximation.cover
    assume(shape.is_empty or approximation.core.area > 1e-6)  # thinner remains than this cannot be told from nothing
    distance = region.distance_to(v)
    if shape.is_empty:
        assert distance == math.inf
    else:
        assert distance == pytest.approx(shape.distance(Point(*v)), abs=1e-4)
    by_boundary_alone = 5 * METRES  # as `distance_to` says; 5 is how far the corner of a widened polygon may be mitred
    assert distance == 0 or not region.contains_point(v) or distance <= by_boundary_alone


@pytest.mark.slow
@given(regions, vectors, vectors)
@settings(deadline=None, max_examples=300)
def test_intervals_are_the_part_of_a_segment_inside(region: Region, start: Vector, end: Vector) -> None:
    assume(g.distance(start, end) > 0.1)
    inside = region.intervals(start, end)
    assert list(inside) == sorted(inside)
    for k in range(1, 60):
        t = k / 60
        if any(abs(t - bound) < 1e-6 for interval in inside for bound in interval):
            continue
        around = {region.contains_point(start + (end - start) * (t + shift)) for shift in (-1e-7, 0.0, 1e-7)}
        assert len(around) == 2 or around == {any(a < t < b for a, b in inside)}  # single points, where it touches, are left out


@pytest.mark.slow
@given(regions)
@settings(deadline=None, max_examples=150)
def test_samples_are_in_the_region_and_its_bounds(region: Region) -> None:
    try:
        points = random_points(region, 20)
    except EmptyRegion:
        assert region.measure() == pytest.approx(0, abs=1e-6)
        return
    bounds = region.bounds()
    assert bounds is not None
    assert region.measure() is not None
    for point in points:
        assert region.distance_to(point) < 1e-9
        assert bounds[0] - 1e-9 <= point.x <= bounds[2] + 1e-9
        assert bounds[1] - 1e-9 <= point.y <= bounds[3] + 1e-9


@given(simple)
@settings(deadline=None)
def test_sampling_is_a_function_of_the_numbers(region: Region) -> None:
    assert random_points(region, 5) == random_points(region, 5)


def test_measures_of_combinations_with_arcs() -> None:
    lens = CircularRegion(ORIGIN, 2.0).intersect(CircularRegion(Vector(1.0, 0.0), 2.0))
    area = 8 * math.acos(1 / 4) - math.sqrt(15) / 2
    assert lens.measure() == pytest.approx(area, rel=1e-8)
    moon = CircularRegion(ORIGIN, 2.0).difference(CircularRegion(Vector(1.0, 0.0), 2.0))
    assert moon.measure() == pytest.approx(4 * math.pi - area, rel=1e-8)


def test_a_sector_wider_than_a_half_turn_contains_boxes_beside_its_gap_only() -> None:
    sector = SectorRegion(ORIGIN, 10.0, 0.0, math.radians(300))
    assert sector.contains_box(Vector(0.0, 2.0), 0.3, 2.0, 2.0)
    assert not sector.contains_box(ORIGIN, 0.0, 2.0, 2.0)  # the gap's apex is inside
    assert not sector.contains_box(Vector(0.0, -3.0), 0.0, 12.0, 0.5)  # corners inside, the gap between them
    assert sector.contains_box(Vector(4.0, -3.0), 0.0, 1.0, 1.0)
    assert sector.contains_box(Vector(0.0, 1.0), 0.0, 2.0, 2.0)  # touches the apex


def test_a_box_may_lie_across_the_parts_of_a_union() -> None:
    both = PolygonalRegion(polygon=box(0, 0, 2, 2)).union(PolygonalRegion(polygon=box(2, 0, 4, 2)))
    assert both.contains_box(Vector(2.0, 1.0), 0.4, 1.0, 1.0)
    assert not both.contains_box(Vector(2.0, 1.0), 0.4, 1.0, 3.0)
    discs = CircularRegion(ORIGIN, 2.0).union(CircularRegion(Vector(2.0, 0.0), 2.0))
    assert discs.contains_box(Vector(1.0, 0.0), 0.0, 4.0, 2.0)
    assert not discs.contains_box(Vector(1.0, 0.0), 0.0, 4.0, 3.5)


def test_regions_are_closed_but_a_difference_lacks_the_edge_of_what_is_taken_away() -> None:
    square, disc = RectangularRegion(ORIGIN, 0.0, 2.0, 2.0), CircularRegion(Vector(1.0, 0.0), 1.0)
    assert square.contains_point(Vector(1.0, 1.0))
    assert disc.contains_point(ORIGIN)
    assert not square.difference(disc).contains_point(ORIGIN)
    assert PolygonalRegion([(0, 0), (2, 0), (0, 2)]).contains_point(Vector(1.0, 1.0))
    assert square.contains_box(ORIGIN, 0.0, 2.0, 2.0)


def test_everywhere_and_nowhere_are_neutral() -> None:
    disc = CircularRegion(ORIGIN, 1.0)
    assert disc.intersect(everywhere) is disc
    assert everywhere.intersect(disc) is disc
    assert disc.intersect(nowhere) is nowhere
    assert disc.union(nowhere) is disc
    assert disc.union(everywhere) is everywhere
    assert disc.difference(nowhere) is disc
    assert disc.difference(everywhere) is nowhere
    assert everywhere.contains_box(ORIGIN, 0.0, 1.0, 1.0)
    assert not nowhere.contains_point(ORIGIN)
    assert nowhere.distance_to(ORIGIN) == math.inf


def test_the_complement_of_a_disc_is_a_region() -> None:
    outside = everywhere.difference(CircularRegion(ORIGIN, 2.0))
    assert outside.bounds() is None
    assert outside.distance_to(Vector(0.5, 0.0)) == pytest.approx(1.5, abs=1e-6)
    assert outside.contains_box(Vector(5.0, 0.0), 0.0, 2.0, 2.0)
    assert not outside.contains_box(Vector(2.5, 0.0), 0.0, 2.0, 2.0)
    with pytest.raises(UnboundedRegion):
        random_points(outside, 1)
    assert all(map(outside.contains_point, random_points(outside.intersect(CircularRegion(ORIGIN, 3.0)), 20)))


@pytest.mark.parametrize(
    "region",
    [
        nowhere,
        CircularRegion(ORIGIN, 0.0),
        SectorRegion(ORIGIN, 1.0, 0.0, 0.0),
        RectangularRegion(ORIGIN, 0.0, 1.0, 0.0),
        PointSetRegion("none", []),
        CircularRegion(ORIGIN, 1.0).intersect(CircularRegion(Vector(3.0, 0.0), 1.0)),
        CircularRegion(ORIGIN, 1.0).intersect(CircularRegion(Vector(2.0, 0.0), 1.0)),
        CircularRegion(ORIGIN, 1.0).difference(CircularRegion(ORIGIN, 1.0)),
        PolygonalRegion(polygon=box(0, 0, 1, 1)).intersect(PolygonalRegion(polygon=box(1, 0, 2, 1))),
        PolylineRegion([(0, 5), (1, 5)]).intersect(CircularRegion(ORIGIN, 1.0)),
        PolylineRegion([(-1, 1), (1, 1)]).intersect(CircularRegion(ORIGIN, 1.0)),
        PolylineRegion([(0, 0), (1, 1)]).intersect(PolylineRegion([(0, 1), (1, 2)])),
        PointSetRegion("one", [(5, 5)]).intersect(CircularRegion(ORIGIN, 1.0)),
    ],
    ids=str,
)
def test_empty_and_measureless_regions_have_no_random_point(region: Region) -> None:
    with pytest.raises(EmptyRegion) as empty:
        random_points(region, 1)
    assert empty.value.region is region
    assert empty.value.reason


def test_unbounded_regions_have_no_random_point() -> None:
    for region in (everywhere, Workspace(), everywhere.difference(CircularRegion(ORIGIN, 1.0)), IntersectionRegion(everywhere, everywhere)):
        with pytest.raises(UnboundedRegion):
            random_points(region, 1)


PLATE = RectangularRegion(ORIGIN, 0.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PolygonalRegion([(0, 0), (1, 1)]), "at least 3 different points"),
        (lambda: PolygonalRegion([(0, 0), (1, 1), (0, 0)]), "at least 3 different points"),
        (lambda: PolygonalRegion([(0, 0), (1, 1), (1, 0), (0, 1)]), "Self-intersection"),
        (lambda: PolygonalRegion([(0, 0), (1, 1), (2, 2)]), "not a polygon"),
        (lambda: PolygonalRegion([(0, 0), (1, math.nan), (2, 2)]), "must be finite"),
        (lambda: PolygonalRegion(polygon=Polygon()), "finite coordinates"),
        (lambda: PolygonalRegion(), "either by its points or by a polygon"),
        (lambda: PolygonalRegion(polygon=3), "made of polygons"),  # pyright: ignore[reportArgumentType]
        (lambda: PolygonalRegion(PolylineRegion([(0, 0), (1, 1)])), r"made of polygons, not of PolylineRegion.*; use that region as it is"),  # pyright: ignore[reportArgumentType]
        (lambda: PolylineRegion(PLATE), "made from a list of points, not from RectangularRegion"),  # pyright: ignore[reportArgumentType]
        (lambda: PointSetRegion("p", PLATE), "made from a list of points, not from RectangularRegion"),  # pyright: ignore[reportArgumentType]
        (lambda: PolylineRegion([(0, 0)]), "at least 2 different points"),
        (lambda: PolylineRegion([(0, 0), (math.inf, 0)]), "must be finite"),
        (lambda: CircularRegion(ORIGIN, -1.0), "the radius of a circle must not be negative"),
        (lambda: CircularRegion(ORIGIN, math.inf), "the radius of a circle must be finite"),
        (lambda: SectorRegion(ORIGIN, 1.0, math.nan, 1.0), "the heading of a sector must be finite"),
        (lambda: SectorRegion(ORIGIN, 1.0, 0.0, -1.0), "the angle of a sector must not be negative"),
        (lambda: RectangularRegion(3, 0.0, 1.0, 1.0), "must be a vector"),  # pyright: ignore[reportArgumentType]
    ],
)
def test_what_is_no_region_is_refused_with_a_reason(make: Callable[[], Region], message: str) -> None:
    with pytest.raises(BadRegion, match=message):
        make()


def test_overlapping_parts_count_once() -> None:
    assert PolygonalRegion(polygon=[box(0, 0, 2, 2), box(1, 0, 3, 2)]).measure() == 6
    assert PolygonalRegion(polygon=MultiPolygon([box(0, 0, 2, 2), box(1, 0, 3, 2)])).measure() == 6
    assert PolylineRegion(polyline=[LineString([(0, 0), (2, 0)]), LineString([(1, 0), (3, 0)])]).measure() == pytest.approx(3)
    assert PointSetRegion("p", [(0, 0), (0, 0), (1, 1)]).measure() == 2


def test_simple_regions_are_equal_if_their_numbers_are() -> None:
    assert CircularRegion((0, 0), 1) == CircularRegion(ORIGIN, 1.0)  # pyright: ignore[reportArgumentType]
    assert hash(RectangularRegion(ORIGIN, 0, 1, 2)) == hash(RectangularRegion(ORIGIN, 0.0, 1.0, 2.0))
    assert SectorRegion(ORIGIN, 1, 0, 1) != SectorRegion(ORIGIN, 1, 0, 2)


def test_orientation_of_combinations() -> None:
    north, west = VectorField("north", lambda v: 0.0), VectorField("west", lambda v: 1.5)
    first, second = PolygonalRegion(polygon=box(0, 0, 2, 2), orientation=north), PolygonalRegion(polygon=box(1, 0, 3, 2), orientation=west)
    plain = CircularRegion(ORIGIN, 3.0)
    assert first.intersect(second).orientation is north
    assert plain.intersect(second).orientation is west
    assert first.difference(second).orientation is north
    assert plain.difference(second).orientation is None
    assert plain.union(first).orientation is None
    either = first.union(second).orientation
    assert either is not None
    assert (either.at(Vector(1.5, 1.0)), either.at(Vector(2.5, 1.0))) == (0, 1.5)


def test_a_polyline_is_oriented_along_its_points() -> None:
    line = PolylineRegion([(0, 0), (0, 2), (-2, 2)])
    assert line.orientation is not None
    assert line.orientation.at(Vector(0.3, 1.0)) == 0
    assert line.orientation.at(Vector(-1.0, 2.0)) == pytest.approx(math.pi / 2)
    assert line.orientation.at(Vector(0.0, 2.0)) == 0  # the first of two nearest segments
    assert PolylineRegion([(0, 0), (0, 2)], orientation=None).orientation is None
    field = VectorField("f", lambda v: 0.25)
    assert PolylineRegion([(0, 0), (0, 2)], orientation=field).orientation is field


@pytest.mark.parametrize(
    ("first", "second", "share"),
    [
        (CircularRegion(ORIGIN, 1.0), CircularRegion(Vector(2.0, 0.0), 1.0), True),
        (CircularRegion(ORIGIN, 1.0), CircularRegion(Vector(2.000001, 0.0), 1.0), False),
        (RectangularRegion(ORIGIN, 0.0, 2.0, 2.0), RectangularRegion(Vector(2.0, 2.0), 0.0, 2.0, 2.0), True),
        (PolygonalRegion(polygon=box(0, 0, 1, 1)), CircularRegion(Vector(3.0, 0.5), 1.0), False),
        (PolylineRegion([(0, 0), (1, 1)]), PolylineRegion([(0, 1), (1, 0)]), True),
        (everywhere, CircularRegion(ORIGIN, 0.0), True),
        (everywhere, everywhere, True),
        (nowhere, everywhere, False),
    ],
)
def test_intersects_says_whether_regions_share_a_point(first: Region, second: Region, share: bool) -> None:
    assert first.intersects(second) is share
    assert second.intersects(first) is share


def test_a_workspace_is_its_region() -> None:
    disc = CircularRegion(ORIGIN, 2.0)
    workspace = Workspace(disc)
    assert workspace.contains_box(ORIGIN, 0.0, 1.0, 1.0)
    assert workspace.measure() == disc.measure()
    assert random_points(workspace, 3) == random_points(disc, 3)
    assert workspace.containsPoint((0.0, 2.0))


def test_thin_boxes_are_segments_and_points() -> None:
    square = PolygonalRegion(polygon=box(0, 0, 2, 2))
    assert square.contains_box(Vector(1.0, 1.0), 0.0, 0.0, 2.0)
    assert not square.contains_box(Vector(1.0, 1.0), 0.0, 0.0, 2.1)
    assert square.contains_box(Vector(2.0, 2.0), 0.5, 0.0, 0.0)
    assert square.contains_box(Vector(1.0, 1.0), 0.5, 1e-30, 1.0)


def test_boxes_are_tested_by_the_union_not_by_the_parts() -> None:
    road = PolygonalRegion(polygon=[box(k, 0, k + 1, 3) for k in range(6)])
    assert road.contains_box(Vector(3.0, 1.5), 0.2, 2.0, 2.0)
    assert shapely.is_valid(road.polygon)


@pytest.mark.parametrize("distance", [0, -1, math.nan, 1e-9])
def test_points_of_a_line_are_apart(distance: float) -> None:
    with pytest.raises(ValueError, match="cannot be"):
        PolylineRegion([(0, 0), (3, 0)]).pointsSeparatedBy(distance)


def test_the_nearest_segment_of_a_line_is_the_first_of_several():
    line = PolylineRegion([(0, 0), (10, 0), (10, 10)])
    first, second = (Vector(0, 0), Vector(10, 0)), (Vector(10, 0), Vector(10, 10))
    near = {(3, 1): first, (10, 0): first, (11, 5): second, (5, 5): first, (12, 12): second, (-1, -1): first}  # as in both releases
    assert {point: line.nearestSegmentTo(point) for point in near} == near
