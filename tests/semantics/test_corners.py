"""Corners of rules about which nobody had asked, as small changes of the code showed that no vector noticed."""

from __future__ import annotations

from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.kernel.errors import RunError, ScenicError
from scenic_ref.semantics.kernel.kinds import kind_name
from scenic_ref.semantics.space.regions.intervals import complement


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
