"""What a small change of the program would break, and no vector says: hints, limits, edges of shapes. Found by `make mutants`."""

from __future__ import annotations

import copy
import math
import pickle
from itertools import repeat

import pytest
import scenic_ref
from scenic_ref.semantics.machine.sandbox_table import ATTRIBUTES
from scenic_ref.semantics.readings.reading import probe_of
from scenic_ref.semantics.space.distributions import Normal, TruncatedNormal
from scenic_ref.semantics.space.regions import CircularRegion, PolylineRegion, everywhere, parameter_intervals
from scenic_ref.semantics.space.regions.combinations import UnionRegion
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import AttemptsExhausted, ProgramError, RunError
from scenic_ref.semantics.store.generators import EXHAUSTED
from scenic_ref.semantics.store.suggestions import nearest

EGO = "ego = Object at (0, 0)\n"


@pytest.mark.parametrize(
    ("program", "hint"),
    [
        ("class A(object):\n    def total(self): return 1\nx = A().totl", "did you mean total?"),
        ("x = {'lane': 1, 'yard': 2}['Lane']", "did you mean lane?"),
        ("x = {'lane': 1, 'yard': 2}['tree']", "there are lane, yard"),
        ("x = {str(i): i for i in range(20)}['tree']", "there are 0, 1, 2, 3, 4, 5, 6, 7, ..."),
        ("x = 'a'.uper()", "did you mean upper?"),
        ("x = Object at (9, 9), with positionStdDev (1, 1)", "write one number, the standard deviation of each coordinate"),
        ("class Car:\n    width: 2\nx = distance to Car", "that is the class; name an object of it: x = Car ..."),
        ("x = Object at (9, 9), with width (1, 1)", "for a random number write `Range(1, 1)`"),
    ],
)
def test_the_hint_of_an_error_is(program: str, hint: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(EGO + program).sample()
    assert raised.value.hint == hint


@pytest.mark.parametrize(("argument", "got"), [("3", "a scalar"), ("'a'", "a string"), ("Object, Object", "2 arguments"), ("", "0 arguments")])
def test_the_class_of_the_closest_object_is_named_wrongly(argument: str, got: str) -> None:
    program = f"behavior B():\n    take self.distanceToClosest({argument})\n{EGO[:-1]}, with behavior B()\n"
    with pytest.raises(RunError) as raised:
        scenic_ref.loads(program).simulate(steps=1, backend="interpreter")
    assert raised.value.message == f"distanceToClosest expects a class, not {got}"


@pytest.mark.parametrize(
    ("use", "message"),
    [
        ("'{:>1500000}{:>1500000}'.format(1, 2)", "3,000,000 elements or characters are too many for one value: at most 2,000,000"),
        ("('a' * 1000000).replace('a', 'b' * 1000000)", "1,000,000,000,000 elements or characters are too many for one value: at most 2,000,000"),
        ("follow VectorField('f', lambda p: 0, 4, 0.001) from 0 @ 0 for 1e9", "1000000000000 steps along a vector field are too many"),
        ("pow(2, 2 ** 9000, 7)", "a whole number of 144,016 binary digits is too large: at most 100,000"),
        ("sorted([range(20000)] * 1000, key=sum)", "the program goes through more, or makes more, than one run may"),
    ],
)
def test_one_value_is_too_large(use: str, message: str) -> None:
    with pytest.raises(RunError) as raised:
        scenic_ref.loads(f"{EGO}x = {use}\n").sample()
    assert message in raised.value.message


def test_a_normal_distribution_is_finite_where_the_number_is_0() -> None:
    for distribution in (Normal(1.0, 2.0), TruncatedNormal(1.0, 2.0, -math.inf, 5.0)):
        assert math.isfinite(distribution.sample(repeat(0.0).__next__))


def test_a_segment_of_length_0_is_within_a_disc_or_not() -> None:
    assert parameter_intervals.where_within_disc(1.0, 0.0, 0.0, 0.0, 1.0) == parameter_intervals.ALL
    assert parameter_intervals.where_within_disc(1.2, 0.0, 0.0, 0.0, 1.0) == parameter_intervals.NONE


def test_a_step_that_is_given_for_one_way_changes_no_other() -> None:
    program = "F = VectorField('F', lambda p: p.x)\na = F.followFrom((1, 0), 2)\nb = F.followFrom((1, 0), 2, steps=2)\n"
    program += "param r = [F.followFrom((1, 0), 2) == a, a == b]\n"
    assert scenic_ref.loads(EGO + program).sample().params["r"] == [True, False]


def test_a_polyline_that_covers_its_middle_again_is_drawn_from_once() -> None:
    corners = [(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0), (0.0, 0.0), (3.0, 0.0)]
    segments = list(PolylineRegion(corners).segments())
    assert math.isclose(sum(math.dist(start, end) for start, end in segments), 7.0)
    assert max(end.x for _, end in segments) == 3.0


def test_what_a_probe_shows_are_texts() -> None:
    with pytest.raises(ValueError, match="place: shows: '' is not a text"):
        probe_of({"program": "ego = Object", "shows": {"yes": ""}}, {"yes": "it is"}, "place")


def test_of_very_long_names_no_slips_are_looked_for() -> None:
    """Each letter more would cost the square of the letters; a name of a hundred letters is still known."""
    assert nearest("a" * 99 + "x", ["a" * 100]) == "a" * 100
    assert nearest("a" * 299_999 + "x", ["a" * 300_000]) is None


def test_the_end_of_an_iterator_stays_itself_when_it_is_saved() -> None:
    assert copy.deepcopy(EXHAUSTED) is EXHAUSTED
    assert pickle.loads(pickle.dumps(EXHAUSTED)) is EXHAUSTED


def test_the_attributes_that_may_be_asked_for_are_sets_of_words() -> None:
    """A text in the place of a set would allow each of its parts."""
    assert {type(words) for words in ATTRIBUTES.values()} == {frozenset}
    assert all(word.isidentifier() for words in ATTRIBUTES.values() for word in words)


@pytest.mark.slow
def test_keys_that_count_their_hash_themselves_are_a_crowd_of_a_third() -> None:
    """8,000 keys of one hash are too many to be compared with each other; with a hash of their own it may be that few are."""
    key = "class Key(object):\n    def __init__(self, n): self.n = n\n    def __hash__(self): return self.n\n"
    program = f"{EGO}{key}found = frozenset([Key(i) for i in range(8000)])\nparam r = len(found)\n"
    assert scenic_ref.loads(program, fuel=10**8).sample().params["r"] == 8000


@pytest.mark.parametrize(
    "use", ["{a}", "{a: 3}", "{k for k in [a]}", "{k: 2 for k in [a]}", "dict([(a, 3)])", "set([a])", "frozenset([a])", "{**{}, a: 2}", "{1: 2}[a]"]
)  # fmt: skip
def test_what_a_hash_of_the_program_raises_is_the_programs_to_catch(use: str) -> None:
    key = "class Key(object):\n    def __hash__(self): return [][2]\na = Key()\n"
    program = f"{EGO}{key}param r = 0\ntry:\n    x = {use}\nexcept IndexError:\n    param r = 1\n"
    assert scenic_ref.loads(program).sample().params["r"] == 1
    with pytest.raises(RunError, match="IndexError"):
        scenic_ref.loads(f"{EGO}{key}x = {use}\n").sample()


def test_a_circle_of_no_size_is_not_named_for_the_intersection_with_it() -> None:
    program = "ego = Object in CircularRegion(0 @ 0, 0).intersect(RectangularRegion(0 @ 0, 0, 4, 4))\n"
    with pytest.raises(AttemptsExhausted, match="in this IntersectionRegion: it has no area"):
        scenic_ref.loads(program).sample()


def test_fields_of_a_named_tuple_may_be_an_iterator() -> None:
    program = "from collections import namedtuple\nP = namedtuple('P', (n for n in ('a', 'b')))\n"
    found = scenic_ref.loads(f"{program}{EGO}param b = P(1, 2).b, first = P(3, 4)[0], names = P._fields\n").sample().params
    assert (found["b"], found["first"], found["names"]) == (2, 3, ("a", "b"))


def test_beyond_the_end_of_a_line_the_distance_from_it_is_positive() -> None:
    line = PolylineRegion([(0, 0), (1, 0)])
    assert [line.signedDistanceTo(Vector(*p)) for p in ((2, 0), (-1, 0), (0.5, 1), (0.5, -1))] == [1, 1, 1, -1]


def test_a_union_with_what_has_no_bounds_has_none() -> None:
    disc = CircularRegion(Vector(0, 0), 1)
    assert [UnionRegion(*parts).bounds() for parts in ((disc, everywhere), (everywhere, disc))] == [None, None]
    assert UnionRegion(disc, CircularRegion(Vector(4, 0), 1)).bounds() == (-1, -1, 5, 1)


@pytest.mark.parametrize("use", ["starmap(list, [(range(3000000),)])", "takewhile(list, [range(3000000)])", "map(list, [range(3000000)])"])
def test_what_library_code_calls_is_refused_as_a_call_by_the_program_is(use: str) -> None:
    with pytest.raises(RunError, match="a range with so many elements cannot be turned into a collection"):
        scenic_ref.loads(f"from itertools import starmap, takewhile\n{EGO}x = list({use})\n").sample()
