"""What is wrong in a library module is told where the program called it."""

from __future__ import annotations

import re

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import ProgramError

MODEL = "model scenic.domains.driving.model\n"
CALLS = {
    "a behavior of an object": ("ego = Car with behavior FollowLaneBehavior('fast')\n", 2),
    "a behavior that a behavior invokes": (
        "behavior B():\n    wait\n    do FollowTrajectoryBehavior(5, network.intersections[0])\nego = Car with behavior B\n", 4,
    ),
    "a function": ("ego = Car\nsetTrafficLightStatus(3, 'pink')\n", 3),
    "a function in a function": ("ego = Car\ndef f():\n    setTrafficLightStatus(3, 'pink')\nf()\n", 4),
}


@pytest.mark.parametrize("what", CALLS)
def test_it_is_told_at_the_line_of_the_program(what: str) -> None:
    text, line = CALLS[what]
    with pytest.raises(ProgramError) as found:
        scenic_ref.loads(MODEL + text).simulate("kinematic", steps=3, seed=0)
    assert (found.value.span.file, found.value.span.line) == ("<string>", line)
    assert re.fullmatch(r"found on line \d+ of the library's module scenic\.domains\.driving\.\w+", found.value.hint)


def test_an_exception_of_the_program_itself_has_no_such_hint() -> None:
    with pytest.raises(ProgramError) as found:
        scenic_ref.loads(MODEL + "ego = Car\ndef f():\n    raise ValueError('x')\nf()\n").sample()
    assert found.value.hint == ""
