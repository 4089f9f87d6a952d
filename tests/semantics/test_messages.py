"""What errors of a run say: which of several messages, where each would be one."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.kernel.errors import ProgramError, SpecifiedTwice

BEHAVIOR = """
behavior Go():
    while True: take 1
behavior B():
{}
ego = Object at (0, 0), with behavior B
"""


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("ego = Object at (0, 0)\np = Point at (5, 5)\nmutate p", "only Objects can be mutated, not an instance of Point"),
        ("ego = Object at (0, 0)\nmutate ego by -1", "`mutate ... by` expects a number that is at least 0, not -1"),
        ("ego = Object at (0, 0)\nraise ValueError('this and no more')", "ValueError: this and no more"),
        ("ego = Object at (0, 0)\nraise ValueError('a' * 1000)", f"ValueError: {'a' * 1000}"),
        ("ego = Object at (0, 0)\nraise ValueError('a' * 1001)", f"ValueError: {'a' * 1000}..."),
        ("ego = Object at (0, 0)\nx = [*Uniform(range(2000001), range(1, 2000002))]", "2000001 elements are too many"),
        ("ego = Object at (0, 0), with width 'wide'", "the property width must be a scalar, not a string (from `with width`)"),
        ("ego = Object at (0, 0), with requireVisible 1", "the property requireVisible must be True or False, not 1 (from `with requireVisible`)"),
        ("ego = Object at (0, 0), with length -2", "the property length must be at least 0, not -2 (from `with length`)"),
    ],
)
def test_an_error_of_a_scene_says(program: str, message: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program).sample()
    assert raised.value.message == message


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("    do Go() until 7", "the condition of `until` must be a boolean, not a scalar"),
        ("    try:\n        do Go()\n    interrupt when 7:\n        take 2", "the condition of an interrupt must be a boolean, not a scalar"),
    ],
)
def test_an_error_of_a_behavior_says(body: str, message: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(BEHAVIOR.format(body)).simulate(steps=2, backend="interpreter")
    assert raised.value.message == message


@pytest.mark.parametrize(
    ("specifiers", "hint"),
    [
        ("with length 2, with height 3", "height is another spelling of length"),
        ("with width 2, with width 3", ""),
        ("at (9, 9), visible", "to require it of the other's position, leave `visible` out and write `require P can see x`"),
    ],
)
def test_the_hint_about_a_property_that_is_specified_twice(specifiers: str, hint: str) -> None:
    with pytest.raises(SpecifiedTwice) as raised:
        scenic_ref.loads(f"ego = Object at (0, 0)\nObject {specifiers}").sample()
    assert raised.value.hint.startswith(hint) and bool(raised.value.hint) == bool(hint)
