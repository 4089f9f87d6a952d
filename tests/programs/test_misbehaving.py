"""Each mistake in a behavior, monitor, block, guard or condition is an error in its place, wherever it stands."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.inference.simulation_rejection import sample_simulation
from scenic_ref.semantics.store.errors import RunError
from scenic_ref.simulators.kinematic import Kinematic
from scenic_ref.simulators.still import Still

from .dynamic_mistakes import Misbehaving, misbehaving


@pytest.mark.parametrize("wrong", list(misbehaving()), ids=lambda wrong: wrong.mistake)
def test_each_mistake_gives_an_error_in_its_place(wrong: Misbehaving):
    scenario = scenic_ref.loads(wrong.text)
    assert sample_simulation(scenario.start, Still(), 0, 0, 0).simulation.result == "time limit"
    with pytest.raises(RunError) as found:
        sample_simulation(scenario.start, Still(), 2, 0, 0)
    assert wrong.wrong in wrong.text.split("\n")[found.value.span.line - 1]
    assert found.value.rule and found.value.hint


ACTIONS = "from scenic.domains.driving.actions import *\nbehavior B():\n    {}\nclass Car:\n    pass\nego = Car with behavior B\n"


def simulated(body: str):
    """One step of a car with this behavior."""
    return sample_simulation(scenic_ref.loads(ACTIONS.format(body)).start, Kinematic(), 1, 0, 0).simulation


def test_an_action_alone_is_an_error():
    with pytest.raises(RunError, match=r"SetThrottleAction.* alone does nothing") as found:
        simulated("SetThrottleAction(1)")
    assert found.value.hint == "write `take` before it"
    assert simulated("take SetThrottleAction(1)").moments[0].actions


def test_what_is_made_elsewhere_may_be_dropped():
    """A call for its effect may give a behavior: only naming or making one is a mistake."""
    text = "behavior B():\n    wait\nwaiting = [B(), B()]\nwaiting.pop()\ndef make():\n    return B()\nmake()\nego = Object\nparam n = len(waiting)\n"
    assert scenic_ref.loads(text).sample().params == {"n": 1}
