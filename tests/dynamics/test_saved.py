"""A run can be saved between any two time steps, and goes on from there in the same way, as often as one likes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.conformance.generator.dynamic_programs import STEPS, dynamic_programs
from scenic_ref.data.checkpoint import resume, save
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import drive
from scenic_ref.semantics.dynamics.policy import after_one_step, begin, policy
from scenic_ref.semantics.machine.config import State
from scenic_ref.semantics.machine.outcome import Act, Done, Finish, Stuck
from scenic_ref.semantics.store.errors import UsageError

LISTINGS = sorted((Path(__file__).parent.parent.parent / "examples" / "paper" / "dynamic").glob("*.scenic"))
FORKING = """
behavior B():
    n, seen = 0, []
    while True:
        n = n + 1
        seen.append(Uniform(*range(1000)))
        take n, len(seen), seen[-1], seen[0]
ego = Object at (0, 0), with behavior B
"""


def course(scenario: Scenario, seed: int, steps: int, between: Callable[[State], State]) -> list[object]:
    """The actions of each time step, and how the run ends; `between` gets the state before each step. Nothing moves."""
    choose = from_stream(seed, 0, 0)
    generated, _ = drive(scenario.start(), choose)
    if not isinstance(generated, Done):
        return ["no scene"]
    state, found = begin(generated.state, 1.0), []
    for _ in range(steps):
        outcome, _ = drive(policy(between(state)), choose)
        match outcome:
            case Stuck(requirement=requirement):
                return [*found, requirement]
            case Finish(reason=reason):
                return [*found, reason]
            case _:
                assert isinstance(outcome, Act)
                found.append(repr(outcome.actions))
                state = after_one_step(outcome.state)
    return found


def saved(state: State) -> State:
    """The state, saved and resumed."""
    return resume(save(state))


def unchanged(state: State) -> State:
    """The state itself."""
    return state


@pytest.mark.slow
def test_random_programs_go_on_from_a_saved_state():
    courses = 0
    for text in dynamic_programs(60, seed=7):
        scenario = scenic_ref.loads(text)
        expected = course(scenario, 3, STEPS, unchanged)
        assert course(scenario, 3, STEPS, saved) == expected, text
        courses += len(expected) > 1
    assert courses > 20


@pytest.mark.sampled(8)
@pytest.mark.parametrize("path", LISTINGS, ids=lambda path: path.stem)
def test_listings_go_on_from_a_saved_state(path):
    scenario = scenic_ref.load(path, readings={"interrupt-first-step": "later-steps"})
    courses = ((seed, course(scenario, seed, 12, unchanged)) for seed in range(50))
    seed, expected = next((seed, steps) for seed, steps in courses if len(steps) > 1)
    assert course(scenario, seed, 12, saved) == expected


def test_courses_from_one_saved_state_do_not_meet():
    """Each begins where the first one did, whatever others have done since to variables and lists."""
    scenario = scenic_ref.loads(FORKING)
    generated, _ = drive(scenario.start(), from_stream(0, 0, 0))
    assert isinstance(generated, Done)
    first, _ = drive(policy(begin(generated.state, 1.0)), from_stream(0, 0, 0))
    assert isinstance(first, Act)
    middle = save(after_one_step(first.state))
    seen = []
    for seed in (1, 2, 1):
        outcome, _ = drive(policy(resume(middle)), from_stream(seed, 0, 0))
        assert isinstance(outcome, Act)
        seen.append(outcome.actions[0])
    assert seen[0] == seen[2] != seen[1]
    assert [one[:2] for one in seen] == [(2, 2)] * 3
    assert seen[0][3] == seen[1][3] == first.actions[0][3]


def test_classes_of_the_program_are_saved_with_what_their_instances_remember():
    """A controller, whose class knows itself and has a property, goes on with the errors that it was told before; and so it does again."""
    text = """from scenic.domains.driving.controllers import *
class Twice(PIDLongitudinalController):
    def run_step(self, error):
        return [super(Twice, self).run_step(error), isinstance(self, Twice), self.told]
    @property
    def told(self):
        return len(self.errors)
one = Twice(0.02, 0.01, 0.05, 0.5)
behavior Ask():
    for error in (1.0, 2.0, 0.5):
        take one.run_step(error)
ego = Object with behavior Ask
"""
    scenario = scenic_ref.loads(text)
    whole = [moment.actions.get(0) for moment in scenario.simulate("still", 3).simulation.moments]
    generated, _ = drive(scenario.start(), from_stream(0, 0, 0))
    assert isinstance(generated, Done)
    first, _ = drive(policy(begin(generated.state, 1.0)), from_stream(0, 0, 0))
    assert isinstance(first, Act)
    middle = save(after_one_step(first.state))
    for _again in range(2):
        outcome, _ = drive(policy(resume(middle)), from_stream(0, 0, 0))
        assert isinstance(outcome, Act)
        assert outcome.actions[0] == whole[1]
    assert whole[1][1:] == (True, 2)  # type: ignore[index]


def test_what_cannot_be_saved_is_told():
    scenario = scenic_ref.loads("import threading\nego = Object at (0, 0), with lock threading.Lock()", trust=True)
    generated, _ = drive(scenario.start(), from_stream(0, 0, 0))
    assert isinstance(generated, Done)
    with pytest.raises(UsageError, match="cannot be saved"):
        save(begin(generated.state, 1.0))
