"""Corners of rules about which nobody had asked, as small changes of the code showed that no vector noticed."""

from __future__ import annotations

from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.machine.operand_kinds import kind_name
from scenic_ref.semantics.space.boundaries import METRES
from scenic_ref.semantics.space.distributions import Coin, PointIn
from scenic_ref.semantics.space.distributions.distribution import BadParameters
from scenic_ref.semantics.space.regions import CircularRegion, PolylineRegion, UnboundedRegion, everywhere, nowhere
from scenic_ref.semantics.space.regions.approximation import as_cover, box_shape
from scenic_ref.semantics.space.regions.parameter_intervals import complement
from scenic_ref.semantics.space.regions.point_sampling import TriangleSampler
from scenic_ref.semantics.space.regions.polygons import intervals_within
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import FuelExhausted, RunError, ScenicError, SpecifiedTwice, UsageError
from shapely.geometry import GeometryCollection, LineString, MultiLineString, Point, Polygon


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
    assert TriangleSampler(Polygon()).total == 0


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


def params_of(text: str) -> dict[str, object]:
    """The parameters of a scene."""
    return dict(scenic_ref.loads(text).sample().params)


RECORD = """
from collections import namedtuple
from enum import Enum
class Lane(namedtuple('Lane', 'width speed', defaults=[3])):
    def above(self): return super().{0}
class Side(Enum):
    LEFT = 1
    def above(self): return super().{0}
ego = Object
"""


def test_super_gives_the_fields_of_a_named_tuple():
    text = RECORD.format("speed") + "lane = Lane(2)\nparam speed = lane.above(), more = lane._replace(speed=5).above()\n"
    assert params_of(text) == {"speed": 3, "more": 5}


OF_PYTHON = "__repr__ __new__ _field_defaults __dict__ __getnewargs__ _member_map_ _generate_next_value_ __slots__"


@pytest.mark.parametrize("name", OF_PYTHON.split())
@pytest.mark.parametrize("subject", ["Lane(2)", "Side.LEFT"])
def test_super_gives_nothing_of_what_python_has_put_into_a_class(name: str, subject: str):
    with pytest.raises(ScenicError, match="super\\(\\) has no attribute"):
        params_of(RECORD.format(name) + f"x = {subject}.above()\n")


def test_a_named_tuple_is_written_by_repr_alone_which_knows_its_limits():
    text = "from collections import namedtuple\nP = namedtuple('P', 'a b')\nx = 1\nfor i in range(60):\n    x = P(x, x)\nego = Object\ny = {}\n"
    for line in ("x.__repr__()", "repr(x)", "str(x)"):
        with pytest.raises(RunError):
            params_of(text.format(line))


def test_what_waits_many_times_over_is_paid_for_step_by_step():
    text = "f = VectorField('f', lambda p: p.x)\nq = (0.5 relative to f,)\nfor i in range({}):\n    q = (q, q)\nego = Object at (1, 0), with p q\n"
    with pytest.raises(FuelExhausted):
        scenic_ref.loads(text.format(40), fuel=2000).sample()
    assert scenic_ref.loads(text.format(2)).sample().ego["p"] == ((((1.5,), (1.5,)), ((1.5,), (1.5,))))


def test_the_initial_scenario_has_nothing_to_override():
    text = "scenario Main():\n    setup:\n        ego = Object at (0, 0), with p 1\n        override ego with p 2\n"
    with pytest.raises(RunError, match="`override` needs a scenario that runs"):
        scenic_ref.loads(text).sample()


NOT_BEGUN = """
behavior Show():
    while True:
        take self.p
scenario A():
    setup:
        x = 1
scenario B():
    precondition: False
    compose:
        wait
scenario Main():
    setup:
        ego = Object at (0, 0), with p 0, with behavior Show()
    compose:
        s = A()
        try:
            do s, B()
        except PreconditionViolation:
            pass
        try:
            ego.p = s.x
        except AttributeError:
            ego.p = 2
        wait
"""


def test_a_scenario_that_was_set_up_and_did_not_begin_has_no_variables():
    assert scenic_ref.loads(NOT_BEGUN).simulate(steps=3).simulation.moments[0].actions == {0: (2,)}


def test_an_exception_of_a_comparison_has_no_hint_about_keys():
    text = "class S(str):\n    pass\ndef boom(self, o):\n    raise ValueError('boom')\nS.__eq__ = boom\n"
    text += "d = {S('lane'): 1}\nx = d['lane']\nego = Object\n"
    with pytest.raises(ScenicError, match="boom") as caught:
        params_of(text)
    assert not caught.value.hint


def test_what_is_left_of_the_plane_has_no_area_and_nothing_has_no_part_of_a_line():
    disc = CircularRegion(Vector(0.0, 0.0), 1)
    assert everywhere.difference(disc).measure() is None
    assert disc.intersect(CircularRegion(Vector(0.5, 0.0), 1)).measure() == pytest.approx(2.152, abs=1e-3)
    assert nowhere.intervals(Vector(0.0, 0.0), Vector(1.0, 0.0)) == ()


def test_a_polyline_may_be_of_several_lines():
    lines = MultiLineString([[(0, 0), (1, 0)], [(5, 0), (7, 0)]])
    assert PolylineRegion(polyline=lines).measure() == 3


@pytest.mark.parametrize("class_", ["set", "dict"])
@pytest.mark.parametrize("given", ["[(x, 1)]", "zip([x], [1])"])
def test_what_an_initialiser_stores_may_not_stand_at_a_random_place(class_: str, given: str):
    text = f"class Kept({class_}):\n    def __init__(self, x):\n        super().__init__({given})\n"
    text += "kept = Kept({})\nego = Object\nparam n = len(kept)\n"
    assert params_of(text.format("'a'")) == {"n": 1}
    with pytest.raises(RunError, match="would make it random which element stands where"):
        params_of(text.format("Uniform('a', 'b')"))
