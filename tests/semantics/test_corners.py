"""Corners of rules about which nobody had asked, as small changes of the code showed that no vector noticed."""

from __future__ import annotations

from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.kernel.errors import RunError, ScenicError, SpecifiedTwice, UsageError
from scenic_ref.semantics.kernel.kinds import kind_name
from scenic_ref.semantics.space.boundaries import METRES
from scenic_ref.semantics.space.distributions import Coin, PointIn
from scenic_ref.semantics.space.distributions.distribution import BadParameters
from scenic_ref.semantics.space.regions import UnboundedRegion, everywhere
from scenic_ref.semantics.space.regions.approximation import as_cover, box_shape
from scenic_ref.semantics.space.regions.intervals import complement
from scenic_ref.semantics.space.regions.polygons import intervals_within
from scenic_ref.semantics.space.regions.sampling import TriangleSampler
from scenic_ref.semantics.space.vectors import Vector
from shapely.geometry import GeometryCollection, LineString, Point, Polygon


def test_comprehensions_have_any_number_of_clauses():
    text = "xs = [(a, b, c) for a in [1, 2] for b in [a, 3] if a < b for c in [a + b] if c < 5]\nego = Object\nparam xs = str(xs)\n"
    assert scenic_ref.loads(text).sample().params["xs"] == str([(a, b, c) for a in [1, 2] for b in [a, 3] if a < b for c in [a + b] if c < 5])


def test_a_normal_without_deviation_is_one_value():
    law = scenic_ref.loads("x = Normal(2, 0)\nego = Object\nparam x = x\n").enumerate()
    assert law.law(lambda scene: scene.params["x"]) == {2: Fraction(1)}


def test_weights_are_a_list():
    with pytest.raises(RunError, match="weights"):
        scenic_ref.loads("x = DiscreteRange(1, 2, 5)\nego = Object\nparam x = x\n").sample()


def test_the_rest_of_an_interval_from_its_beginning_has_no_empty_part():
    assert complement(((0.0, 0.5),)) == ((0.5, 1.0),)
    assert complement(((0.25, 1.0),)) == ((0.0, 0.25),)
    assert complement(()) == ((0.0, 1.0),)


@pytest.mark.parametrize(("value", "name"), [(True, "True"), (None, "None")])
def test_truth_values_and_none_are_called_by_their_names(value: object, name: str):
    assert kind_name(value) == name


def test_a_position_that_is_given_beside_visible_is_told_how_to_require_it():
    with pytest.raises(ScenicError) as caught:
        scenic_ref.loads("ego = Object\nObject visible, at 3 @ 3\n").sample()
    assert "`require P can see x`" in (caught.value.hint or "")


BOX = Polygon([(0, 0), (4, 0), (4, 4), (0, 4)])


def test_a_segment_of_no_length_has_no_part_in_an_area():
    assert intervals_within(BOX, Vector(1.0, 1.0), Vector(1.0, 1.0)) == ()
    assert intervals_within(BOX, Vector(1.0, 1.0), Vector(2.0, 1.0)) == ((0.0, 1.0),)


@pytest.mark.parametrize(
    ("width", "length", "kind"), [(0.0, 2.0, "LineString"), (2.0, 0.0, "LineString"), (0.0, 0.0, "Point"), (2.0, 1.0, "Polygon")]
)
def test_a_thin_box_is_a_segment_or_a_point(width: float, length: float, kind: str):
    shape = box_shape(Vector(1.0, 1.0), 0.5, width, length)
    assert (shape.geom_type, shape.is_valid) == (kind, True)


def test_lines_left_over_by_clipping_are_widened_by_less_than_a_boundary_is_wide():
    both = as_cover(GeometryCollection([BOX, LineString([(4, 4), (9, 9)])]))
    assert both.covers(Point(7, 7)) and both.distance(Point(7, 7 + 2 * METRES)) > METRES / 2


def test_nothing_has_no_area():
    assert TriangleSampler(Polygon()).area == 0


def test_a_coin_has_a_probability():
    with pytest.raises(BadParameters, match="probability must be a number, not 'half'"):
        Coin("half")  # type: ignore[arg-type]


def test_points_of_the_whole_plane_have_no_density():
    with pytest.raises(UnboundedRegion):
        PointIn(everywhere).log_density(Vector(0.0, 0.0))


def test_a_scenario_that_is_not_there_is_named_beside_those_that_are():
    for text, known in [
        ("ego = Object\n", "none"),
        ("scenario A():\n    setup:\n        ego = Object\nscenario B():\n    compose:\n        wait\n", "A, B"),
    ]:
        with pytest.raises(UsageError) as caught:
            scenic_ref.loads(text, scenario="C").sample()
        assert caught.value.hint == f"the scenarios of the program: {known}"


@pytest.mark.parametrize("keyword", ["in", "on"])
def test_specifiers_of_regions_are_called_by_the_word_that_was_written(keyword: str):
    with pytest.raises(SpecifiedTwice, match=f"by `{keyword}` and by `at`"):
        scenic_ref.loads(f"ego = Object {keyword} CircularRegion((0, 0), 1), at (0, 0)\n").sample()
