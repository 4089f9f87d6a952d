"""What an expression says of scenes: it changes nothing about them, and draws nothing."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.api.scene_expressions import NAME, expression_of, law_of, value_in_final_state
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import Accepted, generate_scene
from scenic_ref.semantics.machine.values import unwrap
from scenic_ref.semantics.store.errors import FuelExhausted, ParseError, RunError, UsageError

PROGRAM = "def twice(x):\n    return 2 * x\nego = Object at (0, 0)\nother = Object at (Range(3, 5), 5)\nmutate\n"


def value(expression: str, program: str = PROGRAM) -> object:
    """The value of an expression in the first scene."""
    scenario = scenic_ref.loads(program)
    ended = generate_scene(scenario.start(), from_stream(0, 0, 0), fuel=scenario.fuel)
    assert isinstance(ended, Accepted)
    return unwrap(value_in_final_state(expression_of(expression), ended.state))[0]


def test_an_expression_sees_the_scene_as_it_is_after_mutation():
    scene = scenic_ref.loads(PROGRAM).sample()
    assert value("other.position.x") == scene.objects[1].position.x
    assert value("distance from ego to other") == pytest.approx(math.dist(scene.objects[1].position, scene.ego.position))
    assert value("twice(other.width)") == 2
    assert value("'near' if (distance to other) < 100 else 'far'") == "near"
    assert value("ego can see other") is True


@pytest.mark.parametrize(
    ("expression", "error", "said"),
    [
        ("Range(0, 1)", RunError, "cannot draw"), ("[Uniform(1, 2) for i in range(2)]", RunError, "cannot draw"), ("nosuch", RunError, "not defined"),
        ("x = 1", UsageError, "no expression"), ("1\n2", UsageError, "no expression"), ("import os", UsageError, "no expression"),
        ("(", ParseError, "never closed|unexpected|expected"), ("[i for i in range(10**6)]", FuelExhausted, "100,000 steps"),
    ],
)  # fmt: skip
def test_what_is_no_expression_or_draws_is_refused(expression, error, said):
    with pytest.raises(error, match=said):
        value(expression)


def test_the_law_of_an_expression_is_exact_under_both_readings_of_the_coin():
    program = "x = Uniform(1, 2, 3)\nego = Object at (0, 0)\nother = Object at (5 * x, 5)\nrequire[0.5] x == 1\n"
    for reading, expected in (("run", Fraction(1, 2)), ("scene", Fraction(2, 3))):
        law = law_of(scenic_ref.loads(program, readings={"soft": reading}), expression_of("other.position.x < 6"))
        assert law.law(lambda scene: unwrap(scene.params[NAME])[0])[True] == expected


def test_the_law_is_that_of_the_same_parameter():
    program = "x = Uniform(1, 2, 3)\nego = Object at (0, 0)\nother = Object at (5 * x, 5)\nrequire x < 3\n"
    with_param = scenic_ref.loads(program + "param d = distance to other\n").enumerate().law(lambda scene: unwrap(scene.params["d"])[0])
    assert law_of(scenic_ref.loads(program), expression_of("distance to other")).law(lambda scene: unwrap(scene.params[NAME])[0]) == with_param
