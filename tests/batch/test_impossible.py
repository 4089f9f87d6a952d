"""A requirement that fails whatever is drawn is found out before the first attempt, where bounds of the values show it."""

from __future__ import annotations

import re

import pytest
import scenic_ref
from scenic_ref.conformance.generator import random_programs
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import Rejected, generate_scene
from scenic_ref.semantics.store.errors import AttemptsExhausted, ScenicError

EGO = "ego = Object at (0, 0)\n"


@pytest.mark.parametrize("text", ["require x > 2", "y = x * x + 1\nrequire y < 0.5", "require False"])
def test_what_can_never_hold_is_an_error_at_once(text):
    text = f"x = Range(0, 1)\n{text}"
    scenario = scenic_ref.loads(EGO + text)
    line = text.count("\n") + 2
    with pytest.raises(AttemptsExhausted, match=f"no scene is possible: the requirement on line {line} fails, whatever is drawn") as found:
        scenario.sample_many(20)
    assert found.value.attempts == 1
    assert found.value.span.line == line
    with pytest.raises(AttemptsExhausted, match="no scene in 50 attempts"):
        scenario.sample(max_attempts=50)


@pytest.mark.parametrize(("text", "hint"), [
    ("x = Range(0, 1)\nrequire x > 5", "its left side is never more than 1, and its right side is 5"),
    ("x = Range(0, 1)\nrequire 5 < abs(x)", "its left side is 5, and its right side is never more than 1"),
    (
        "other = Object at (3, Range(4, 5))\nrequire (distance to other) < 4",
        "its left side is never less than 5, and its right side is 4",
    ),
    ("x = Uniform(1, 2, 3)\nrequire x == 5", ""), ("x = Uniform(1, 2, 3)\nrequire x in [4, 5]", ""),
    ("x = Range(0, 1)\nrequire x @ 0 in CircularRegion((50, 50), 3)", ""), ("x = Range(0, 1)\nrequire x > 5 or x < -1", ""),
    ("x = Range(0, 1)\nrequire max(x, 9 if 1 > 2 else 0) > 3", ""),
])  # fmt: skip
def test_the_sides_of_a_comparison_are_told_where_they_are_those_that_the_program_wrote(text: str, hint: str) -> None:
    impossible = scenic_ref.loads(f"{EGO}{text}").impossible
    assert impossible is not None and impossible.hint == hint


@pytest.mark.parametrize("text", [
    "x = Range(0, 1)\nrequire[0.5] x > 2", "x = Range(0, 1)\nrequire x > 0.99999", "x = Uniform(0, 1)\nrequire x > 0.5\nrequire x == 1",
])  # fmt: skip
def test_what_may_hold_is_not(text):
    assert scenic_ref.loads(EGO + text).impossible is None


@pytest.mark.parametrize("share", [0.25, 1])
def test_a_soft_requirement_that_never_holds_is_met_by_the_coin(share):
    """The runs whose coin shows tails are accepted, by columns as by the interpreter."""
    scenario = scenic_ref.loads(f"{EGO}x = Range(0, 1)\nrequire[{share}] x > 2\nparam x = x")
    if share == 1:
        assert scenario.impossible is not None
        return
    assert scenario.batch is not None
    expected = [scene.to_line() for scene in scenario.sample_many(40, backend="interpreter")]
    assert [scene.to_line() for scene in scenario.sample_many(40, backend="batch")] == expected
    assert any(scene.attempts > 1 for scene in scenario.sample_many(40))


@pytest.mark.slow
def test_random_programs_that_are_said_to_have_no_scene_have_none():
    """A requirement on a parameter is added to 60 programs; of those that are said to have no scene, 40 runs are made each."""
    said = possible = 0
    for program in random_programs(60, 5):
        name = re.search(r"^param (\w+) = \1", program.text, re.MULTILINE)
        scenario = scenic_ref.loads(f"{program.text}require {name[1]} > 4\n" if name else program.text)
        try:
            impossible = scenario.impossible
        except ScenicError:
            continue
        possible += scenario.batch is not None
        if impossible is None:
            continue
        said += 1
        for attempt in range(40):
            try:
                found = generate_scene(scenario.start(), from_stream(1, 0, attempt))
            except ScenicError:
                continue
            assert isinstance(found, Rejected), program.text
    assert said > 2
    assert possible > 20


def test_a_place_outside_a_field_is_said_to_have_no_value() -> None:
    with pytest.raises(AttemptsExhausted, match="the vector field roadDirection has no value there, whatever is drawn") as found:
        scenic_ref.loads("model scenic.simulators.gta.model\nego = Car\nCar at (5, 10)\n").sample_many(20)
    assert "a heading of its own (`facing ...`)" in found.value.hint
