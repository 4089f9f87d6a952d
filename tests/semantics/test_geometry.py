"""The equations of the Figure "Notation used to define the semantics", and the predicates on boxes and sectors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scenic_ref.semantics.space import geometry as g
from scenic_ref.semantics.space.boundaries import METRES
from scenic_ref.semantics.space.vectors import Vector
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

NEAR = 1e-6  # metres: closer than this to touching, an approximation by polygons decides nothing
coordinates = st.floats(-20, 20).map(lambda x: round(x, 6))  # sums of two of them lose nothing that matters
vectors = st.builds(Vector, coordinates, coordinates)
headings = st.floats(-7, 7)
extents = st.just(0.0) | st.floats(0.001, 10)
boxes = st.tuples(vectors, headings, extents, extents)
sectors = st.tuples(vectors, st.floats(0.01, 15), headings, st.floats(0.01, 2 * math.pi))
Box = tuple[Vector, float, float, float]
Sector = tuple[Vector, float, float, float]


def shape_of_box(box: Box) -> BaseGeometry:
    return Polygon([tuple(corner) for corner in g.corners(*box)]).buffer(0) if min(box[2:]) > 0 else thin(box)


def thin(box: Box) -> BaseGeometry:
    a, _, c, _ = g.corners(*box)
    return LineString([tuple(a), tuple(c)])


def shape_of_sector(sector: Sector, scale: float = 1.0) -> Polygon:
    center, radius, heading, angle = sector
    arc = np.linspace(heading - angle / 2, heading + angle / 2, 3001)
    rim = np.stack([center.x - scale * radius * np.sin(arc), center.y + scale * radius * np.cos(arc)], axis=1)
    return Polygon(rim) if angle >= 2 * math.pi else Polygon(np.concatenate([[tuple(center)], rim]))


def moved(v: Vector, turn: float, shift: Vector) -> Vector:
    return g.rotate(v, turn) + shift


def test_rotation_is_anticlockwise() -> None:
    quarter = g.rotate(Vector(0.0, 1.0), math.pi / 2)
    assert (quarter.x, quarter.y) == pytest.approx((-1, 0), abs=1e-15)


@given(vectors, headings)
def test_rotation_is_the_papers_equation(v: Vector, angle: float) -> None:
    expected = (v.x * math.cos(angle) - v.y * math.sin(angle), v.x * math.sin(angle) + v.y * math.cos(angle))
    assert tuple(g.rotate(v, angle)) == pytest.approx(expected, abs=1e-13)


@given(vectors, headings, vectors)
def test_local_coordinates_invert_local_offsets(position: Vector, heading: float, v: Vector) -> None:
    back = g.to_local(position, heading, g.offset_local(position, heading, v))
    assert tuple(back) == pytest.approx(tuple(v), abs=1e-12)


@given(vectors)
def test_a_vector_points_along_its_angle(v: Vector) -> None:
    again = g.rotate(Vector(0.0, g.vector_norm(v)), g.angle_of(v))
    assert tuple(again) == pytest.approx(tuple(v), abs=1e-12)
    assert -math.pi <= g.angle_of(v) <= math.pi


@pytest.mark.parametrize(
    ("v", "heading"), [((0, 1), 0), ((-1, 0), math.pi / 2), ((0, -1), math.pi), ((-0.0, -1), math.pi), ((1, 0), -math.pi / 2), ((0, 0), 0)]
)
def test_angles_count_anticlockwise_from_north(v: tuple[float, float], heading: float) -> None:
    assert g.angle_of(Vector(*v)) == heading


@given(st.floats(-1e6, 1e6))
def test_normalised_headings_are_equivalent_and_above_minus_pi_up_to_pi(heading: float) -> None:
    normal = g.normalise_heading(heading)
    assert -math.pi < normal <= math.pi
    assert math.remainder(normal - heading, 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert g.normalise_heading(normal) == normal


@pytest.mark.parametrize(("heading", "normal"), [(math.pi, math.pi), (-math.pi, math.pi), (3 * math.pi, math.pi), (0.3, 0.3)])
def test_half_turns_normalise_to_plus_pi(heading: float, normal: float) -> None:
    assert g.normalise_heading(heading) == pytest.approx(normal, abs=1e-15)


def test_forward_euler_takes_n_steps_each_along_the_field_at_its_start() -> None:
    visited: list[Vector] = []

    def field(v: Vector) -> float:
        visited.append(v)
        return math.pi / 2 * (len(visited) - 1)

    end = g.forward_euler(field, Vector(1.0, 2.0), 8.0, 4)
    assert len(visited) == 4
    assert tuple(visited[1]) == pytest.approx((1, 4))
    assert tuple(end) == pytest.approx((1, 2), abs=1e-12)  # a square


def test_a_box_lies_lengthwise_along_its_heading() -> None:
    front_right, front_left, back_left, back_right = g.corners(Vector(0.0, 0.0), math.pi / 2, 2.0, 4.0)
    for corner, expected in ((front_right, (-2, 1)), (front_left, (-2, -1)), (back_left, (2, -1)), (back_right, (2, 1))):
        assert tuple(corner) == pytest.approx(expected)


@given(boxes, boxes)
@settings(deadline=None, max_examples=300)
def test_boxes_intersect_as_polygons_do(first: Box, second: Box) -> None:
    a, b = shape_of_box(first), shape_of_box(second)
    found = g.boxes_intersect(*first, *second)
    assert found is g.boxes_intersect(*second, *first)
    if a.distance(b) > NEAR:
        assert not found
    elif a.buffer(-NEAR).intersects(b.buffer(-NEAR)):
        assert found


@pytest.mark.parametrize(("x", "touch"), [(2.0, True), (math.nextafter(2.0, 3.0), True), (2.0 + 2 * METRES, False), (0.0, True)])
def test_touching_boxes_intersect(x: float, touch: bool) -> None:
    assert g.boxes_intersect(Vector(0.0, 0.0), 0.0, 2.0, 4.0, Vector(x, 4.0), 0.0, 2.0, 4.0) is touch


def test_boxes_without_area_intersect_where_their_segments_cross() -> None:
    upright = (Vector(0.0, 0.0), 0.0, 0.0, 2.0)
    assert g.boxes_intersect(*upright, Vector(1.0, 1.0), 0.0, 2.0, 0.0)
    assert not g.boxes_intersect(*upright, Vector(1.0, 1.1), 0.0, 2.0, 0.0)
    assert not g.boxes_intersect(*upright, Vector(0.0, 2.5), 0.0, 0.0, 2.0)
    assert g.boxes_intersect(*upright, Vector(0.0, 1.0), 0.5, 0.0, 0.0)


@given(boxes, vectors)
@settings(deadline=None)
def test_distance_to_a_box_is_that_to_its_polygon(box: Box, v: Vector) -> None:
    assert g.distance_to_box(*box, v) == pytest.approx(shape_of_box(box).distance(Point(*v)), abs=1e-9)
    away = g.distance_to_box(*box, v)
    assert g.box_contains(*box, v) or away > METRES
    assert away <= 1.42 * METRES or not g.box_contains(*box, v)


@given(sectors, vectors)
@settings(deadline=None, max_examples=300)
def test_sector_contains_the_points_of_its_polygon(sector: Sector, v: Vector) -> None:
    found = g.sector_contains(*sector, v)
    outer = shape_of_sector(sector, 1 + 1e-6)
    gap = outer.exterior.distance(Point(*v))
    assume(gap > 1e-5 * max(sector[1], 1))
    assert found is outer.contains(Point(*v))


@pytest.mark.slow
@given(sectors, boxes)
@settings(deadline=None, max_examples=500)
def test_sector_meets_a_box_exactly_if_its_polygon_does(sector: Sector, box: Box) -> None:
    found = g.sector_meets_box(*sector, *box)
    inner, shape = shape_of_sector(sector), shape_of_box(box)
    if inner.distance(shape) > 1e-5 * max(sector[1], 1):
        assert not found
    elif inner.buffer(-1e-5).intersects(shape):
        assert found


@given(sectors, boxes, headings, vectors)
@settings(deadline=None)
def test_sector_meets_box_is_invariant_under_rigid_motions(sector: Sector, box: Box, turn: float, shift: Vector) -> None:
    (center, radius, heading, angle), (position, box_heading, width, length) = sector, box
    before = [g.sector_meets_box(center, radius * k, heading, angle, *box) for k in (1 - 1e-9, 1 + 1e-9)]
    assume(before[0] == before[1])
    wider = g.sector_meets_box(center, radius, heading, angle + 1e-9, *box)
    narrower = g.sector_meets_box(center, radius, heading, angle - 1e-9, *box)
    assume(wider == narrower)
    other = (moved(position, turn, shift), box_heading + turn, width, length)
    assert g.sector_meets_box(moved(center, turn, shift), radius, heading + turn, angle, *other) is before[0]


@pytest.mark.slow
@given(vectors, st.floats(0, 15), headings, st.floats(2 * math.pi, 20), boxes)
@settings(deadline=None)
def test_a_sector_of_a_full_turn_or_more_is_a_disc(center: Vector, radius: float, heading: float, angle: float, box: Box) -> None:
    within = g.distance_to_box(*box, center)
    assume(abs(within - radius) > 1e-9)
    assert g.sector_meets_box(center, radius, heading, angle, *box) is (within <= radius)


def test_the_arc_is_a_true_arc() -> None:
    """A box beyond the chord of a coarse polygon but within the circle is met, one just beyond the circle is not."""
    radius, tip = 30.0, 0.5
    for gap, expected in ((-1e-12, True), (1e-12, True), (2 * METRES, False)):
        box = (Vector(0.0, radius + gap + tip), 0.0, 1e-9, 2 * tip)
        assert g.sector_meets_box(Vector(0.0, 0.0), radius, 0.0, 1.0, *box) is expected


@pytest.mark.parametrize(
    ("radius", "angle", "seen"),
    [(5.0, 0.0, True), (5.0, -0.1, False), (-1.0, 1.0, False), (2.0, 0.0, False), (3.0, 0.0, True), (math.inf, 0.5, True)],
)
def test_degenerate_sectors(radius: float, angle: float, seen: bool) -> None:
    """An angle of 0 is a segment (here from (0, 0) towards North), a negative angle or radius nothing; a box touches at y = 3."""
    assert g.sector_meets_box(Vector(0.0, 0.0), radius, 0.0, angle, Vector(0.0, 4.0), 0.0, 2.0, 2.0) is seen


def test_the_apex_belongs_to_the_sector() -> None:
    here = Vector(1.0, 2.0)
    assert g.sector_contains(here, 0.0, 0.3, 0.0, here)
    assert g.sector_meets_box(here, 0.0, 0.3, 0.0, here, 0.0, 0.0, 0.0)


@given(st.lists(st.tuples(sectors, boxes), min_size=1, max_size=20))
@settings(deadline=None)
def test_arrays_and_scalars_agree_bit_for_bit(pairs: list[tuple[Sector, Box]]) -> None:
    def column(values: list[float]) -> float:
        return np.array(values)  # pyright: ignore[reportReturnType]

    def columns(rows: list[Box] | list[Sector]) -> tuple[Vector, float, float, float]:
        points = Vector(column([row[0].x for row in rows]), column([row[0].y for row in rows]))
        return points, column([row[1] for row in rows]), column([row[2] for row in rows]), column([row[3] for row in rows])

    sector, box = columns([s for s, _ in pairs]), columns([b for _, b in pairs])
    assert list(np.asarray(g.sector_meets_box(*sector, *box))) == [g.sector_meets_box(*s, *b) for s, b in pairs]
    assert list(np.asarray(g.boxes_intersect(*sector, *box))) == [g.boxes_intersect(*s, *b) for s, b in pairs]
    turned = g.rotate(box[0], box[1])
    assert list(zip(np.asarray(turned.x), np.asarray(turned.y), strict=True)) == [tuple(g.rotate(b[0], b[1])) for _, b in pairs]
    assert list(np.asarray(g.angle_of(box[0]))) == [g.angle_of(b[0]) for _, b in pairs]
    assert list(np.asarray(g.normalise_heading(box[1]))) == [g.normalise_heading(b[1]) for _, b in pairs]
    assert list(np.asarray(g.distance_to_box(*box, sector[0]))) == [g.distance_to_box(*b, s[0]) for s, b in pairs]


def test_scalars_give_python_numbers() -> None:
    assert type(g.rotate(Vector(1.0, 2.0), 0.3).x) is float
    assert type(g.distance(Vector(1.0, 2.0), Vector(3.0, 4.0))) is float
    assert type(g.normalise_heading(5.0)) is float
