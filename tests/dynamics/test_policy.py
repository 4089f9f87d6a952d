"""The seven steps of the policy, in their order (paper, Section "Semantics of Scenic", "Dynamic Constructs")."""

from __future__ import annotations

import pytest
from scenic_ref.semantics.dynamics import policy
from scenic_ref.semantics.store import budget
from scenic_ref.semantics.store.errors import RunError, UncaughtException
from scenic_ref.simulators.loop import Failed, Simulated

from .worlds import LIMIT, actions, behavior, simulated

COMPOSE_FIRST = """
behavior Reset():
    while True:
        self.x = 0
        wait
scenario Main():
    setup:
        ego = Object at (0, 0), with x 0, with behavior Reset
        require always ego.x == 0
    compose:
        while True:
            ego.x = 1
            wait
"""
ALWAYS_BEFORE_MONITORS = """
ego = Object at (0, 0), with x 0
require always ego.x == 0
monitor Change:
    ego.x = 1
    terminate
"""
MONITORS_BEFORE_THE_FLAG = """
behavior Fail():
    require False
    wait
ego = Object at (0, 0), with behavior Fail
monitor End:
    terminate
"""
FLAG_BEFORE_BEHAVIORS = """
behavior Fail():
    require False
    wait
ego = Object at (0, 0), with behavior Fail
terminate when True
"""
BEHAVIORS_BEFORE_THE_FLAG = """
behavior End():
    terminate
behavior Go():
    take 1
ego = Object at (0, 0), with behavior Go
other = Object at (5, 0), with behavior End
"""

ORDER = {
    1: (COMPOSE_FIRST, ["rejected"], -1),
    2: (ALWAYS_BEFORE_MONITORS, ["terminated"], 0),
    3: (MONITORS_BEFORE_THE_FLAG, ["terminated"], 0),
    4: (FLAG_BEFORE_BEHAVIORS, ["terminated"], 0),
    5: (BEHAVIORS_BEFORE_THE_FLAG, ["terminated"], 0),
    6: (BEHAVIORS_BEFORE_THE_FLAG, ["terminated"], 0),
}
"""A program for each step, what it does, and in how many time steps that pass: different if the step is exchanged with the next."""


def course(text: str) -> tuple[list[object], int]:
    run = simulated(text, 3)
    return actions(text, 3)[-1:], len(run.moments) - 1 if isinstance(run, Simulated) else -1


@pytest.mark.parametrize("number", ORDER)
def test_each_step_comes_before_the_next(number, monkeypatch):
    text, ends, passed = ORDER[number]
    assert course(text) == (ends, passed)
    exchanged = {**policy.STEPS, number: policy.STEPS[number + 1], number + 1: policy.STEPS[number]}
    monkeypatch.setattr(policy, "STEPS", exchanged)
    assert course(text) != (ends, passed)


def test_step_7_returns_the_actions_of_all_agents():
    text = "behavior Go(n):\n    take n, (n + 1, [n + 2][0])\nego = Object at (0, 0), with behavior Go(1)\nObject at (5, 0), with behavior Go(4)"
    run = simulated(text, 2)
    assert isinstance(run, Simulated)
    assert run.moments[0].actions == {0: (1, 2, 3), 1: (4, 5, 6)}
    assert run.moments[1].actions == {}


def test_requirements_are_checked_before_the_scenario_terminates():
    """The flag: "we need to ensure that all requirements are satisfied before terminating"."""
    head = "ego = Object at (0, 0)\n"
    assert actions(head + "terminate when True\nrequire always False") == ["rejected"]
    assert actions(head + "terminate when True\nmonitor M:\n    require False\n    wait") == ["rejected"]
    assert actions(head + "terminate when True\nrequire eventually False") == ["rejected"]
    assert actions(head + "terminate when True\nrequire eventually True") == ["terminated"]


def test_require_eventually_needs_one_time_step_only():
    text = "ego = Object at (0, 0)\nrequire eventually simulation.currentTime == 2\nterminate when simulation.currentTime == {}"
    assert actions(text.format(1)) == ["rejected"]
    assert actions(text.format(2)) == [None, None, "terminated"]
    assert actions(text.format(4)) == [None] * 4 + ["terminated"]
    assert actions(text.format(99), 1) == ["rejected"]
    assert actions(text.format(99), 2) == [None] * 2 + [LIMIT]


def test_require_always_is_checked_in_every_time_step():
    text = "ego = Object at (0, 0)\nrequire always simulation.currentTime < 3"
    assert actions(text, 2) == [None] * 2 + [LIMIT]
    run = simulated(text, 3)
    assert isinstance(run, Failed)
    assert (run.step, run.requirement.kind, run.requirement.span.line) == (3, "always", 2)


def test_monitors_see_what_happens_and_take_no_actions():
    text = """
behavior Go():
    take 1
    self.x = 1
    take 2
ego = Object at (0, 0), with x 0, with behavior Go
monitor Watch:
    while ego.x == 0:
        take 7
    terminate
"""
    assert actions(text) == [1, 2, "terminated"]


def test_monitors_have_variables_of_their_own_and_parameters():
    text = """
n = 1
monitor Watch(limit=2):
    n = 0
    while n < limit:
        n = n + 1
        wait
    terminate
behavior Go():
    while True:
        take n
ego = Object at (0, 0), with behavior Go
"""
    assert actions(text) == [1, 1, "terminated"]
    with pytest.raises(UncaughtException, match="needs a value for limit"):
        simulated(text.replace("limit=2", "limit"))


def test_in_dialect_scenic_3_monitors_run_where_they_are_required():
    text = """
monitor Watch(limit):
    for i in range(limit):
        wait
    terminate
ego = new Object at (0, 0)
"""
    assert actions(text, 4, dialect="scenic-3") == [None] * 4 + [LIMIT]
    assert actions(text + "require monitor Watch(2)", 4, dialect="scenic-3") == [None, None, "terminated"]
    assert actions(text + "require monitor Watch(3)\nrequire monitor Watch(1)", 4, dialect="scenic-3") == [None, "terminated"]
    with pytest.raises(RunError, match="`require monitor` needs a monitor"):
        simulated(text + "k = 3\nrequire monitor k", dialect="scenic-3")


def test_a_compose_block_may_require_a_monitor_in_dialect_scenic_3():
    text = """
monitor End():
    wait
    terminate
scenario Main():
    setup:
        ego = new Object at (0, 0)
    compose:
        wait
        require monitor End()
        while True:
            wait
"""
    assert actions(text, 5, dialect="scenic-3") == [None, None, "terminated"]


def test_a_behavior_may_depend_on_what_it_draws_and_draws_anew_every_time():
    """Section "Dynamic Scenarios", "Behavior Arguments and Random Parameters"."""
    text = behavior("t = Range(4, 7)\nwhile True:\n    if t < 5:\n        take 0, t\n    else:\n        take Range(0, 1), t")
    seen: set[bool] = set()
    for seed in range(12):
        run = simulated(text, 4, seed=seed)
        assert isinstance(run, Simulated)
        (first, *rest) = [moment.actions[0] for moment in run.moments[:-1]]
        assert all(one[1] == first[1] for one in rest)
        assert (first[0] == 0) == (first[1] < 5)
        assert first[0] == 0 or len({first[0], *(one[0] for one in rest)}) == 4
        seen.add(first[0] == 0)
    assert seen == {True, False}


def test_arguments_and_defaults_of_behaviors_and_independent_copies():
    text = """
behavior Count(step=1):
    n = 0
    while True:
        n += step
        take n
ego = Object at (0, 0), with behavior Count
other = Object at (5, 0), with behavior Count(20)
"""
    run = simulated(text, 2)
    assert isinstance(run, Simulated)
    assert [moment.actions for moment in run.moments[:-1]] == [{0: (1,), 1: (20,)}, {0: (2,), 1: (40,)}]


def test_stateful_behavior_of_the_paper():
    text = behavior(
        "delay = Uniform(2, 2) seconds\nlast_stop = 0\ntry:\n    do Drive()\ninterrupt when simulation.currentTime - last_stop > delay:\n"
        "    do Stop() for 2 seconds\n    delay = Uniform(1, 1) seconds\n    last_stop = simulation.currentTime",
        "behavior Drive():\n    while True:\n        take 'drive'\nbehavior Stop():\n    while True:\n        take 'stop'",
    )
    d, s = "drive", "stop"
    assert actions(text, 10) == [d, d, d, s, s, d, d, s, s, d, LIMIT]


def test_each_time_step_has_a_budget_of_its_own(monkeypatch):
    monkeypatch.setattr(budget, "LARGEST_WORK", 60 * budget.STEP)
    assert actions(behavior("while True:\n    take sorted([3, 1, 2], key=lambda v: -v)[0]"), 20) == [*[3] * 20, LIMIT]
