"""An exception in a library module says where the program called it."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.kernel.errors import ProgramError

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
def test_the_hint_names_the_line_of_the_program(what: str) -> None:
    text, line = CALLS[what]
    with pytest.raises(ProgramError) as found:
        scenic_ref.loads(MODEL + text).simulate("kinematic", steps=3, seed=0)
    assert found.value.span.file.startswith("<scenic.domains.driving.")
    assert found.value.hint == f"the program called this on line {line} of <string>"


def test_an_exception_of_the_program_itself_has_no_such_hint() -> None:
    with pytest.raises(ProgramError) as found:
        scenic_ref.loads(MODEL + "ego = Car\ndef f():\n    raise ValueError('x')\nf()\n").sample()
    assert found.value.hint == ""
