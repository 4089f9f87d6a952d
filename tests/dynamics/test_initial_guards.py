"""Guards of scenarios, and what their setup blocks may not do (readings `initial-guards` and `random-branch`)."""

from __future__ import annotations

from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import RandomBranch, RunError

from .worlds import LIMIT, actions

MAIN = "scenario Main():\n{}    setup:\n        ego = Object at (0, 0), with x x\n"


def test_a_random_precondition_of_the_initial_scenario_is_an_observation():
    text = "x = Uniform(1, 2, 3, 4)\n" + MAIN.format("    precondition: x != 2\n    precondition: x < 4\n")
    scenario = scenic_ref.loads(text)
    drawn = [scene.ego["x"] for scene in scenario.sample_many(200)]
    assert drawn == [scenario.sample(index=k).ego["x"] for k in range(200)] and set(drawn) == {1, 3}
    exact = scenario.enumerate()
    assert exact.law(lambda scene: scene.ego["x"]) == {1: Fraction(1, 2), 3: Fraction(1, 2)}
    assert exact.acceptance == Fraction(1, 2)
    assert {requirement.text for requirement in exact.stuck} == {"the precondition of Main on line 3", "the precondition of Main on line 4"}


@pytest.mark.parametrize("precondition", ["3", "'yes'", "x"])
def test_a_precondition_of_the_initial_scenario_is_a_boolean(precondition):
    with pytest.raises(RunError, match="a precondition must be a boolean") as found:
        scenic_ref.loads("x = Uniform(1, 2)\n" + MAIN.format(f"    precondition: {precondition}\n")).sample()
    assert found.value.span.line == 3


def test_invariants_of_the_initial_scenario_are_checked_in_each_time_step():
    now = "simulation.currentTime"
    assert actions("x = 1\n" + MAIN.format(f"    invariant: ego.x == 1 and {now} < 3\n"), 2) == [None, None, LIMIT]
    assert actions("x = 1\n" + MAIN.format(f"    invariant: ego.x == 1 and {now} < 3\n"), 3) == ["rejected"]
    assert actions("x = 1\n" + MAIN.format("    invariant: ego.x == 2\n"), 0) == ["rejected"]
    compose = "    compose:\n        wait\n        wait\n        ego.x = 2\n        wait\n        wait\n"
    assert actions("x = 1\n" + MAIN.format("    invariant: ego.x == 1\n") + compose, 2) == [None, None, LIMIT]
    assert actions("x = 1\n" + MAIN.format("    invariant: ego.x == 1\n") + compose, 3) == ["rejected"]


def test_an_invariant_of_a_sub_scenario_is_first_checked_after_its_setup():
    sub = "scenario Sub():\n    invariant: o.x == {}\n    setup: o = Object at (5, 0), with x 7\n    compose: wait\n"
    compose = "    compose:\n        try:\n            do Sub()\n        except InvariantViolation:\n            terminate\n        wait\n"
    assert actions("x = 1\n" + sub.format(7) + MAIN.format("") + compose) == [None, None, "terminated"]
    assert actions("x = 1\n" + sub.format(8) + MAIN.format("") + compose) == ["terminated"]


BRANCHES = (
    "if x == 1:\n            pass", "while x > 3:\n            pass", "y = 1 if x > 1 else 2", "y = [i for i in range(3) if i < x]",
    "for i in range(x):\n            pass",
)  # fmt: skip


@pytest.mark.parametrize("branch", BRANCHES)
@pytest.mark.parametrize("draw", ["x = Uniform(1, 2)", "o = Object at (5, 5), with x Uniform(1, 2)\n        x = o.x", "x = Uniform(1, 2) + 1"])
def test_no_setup_block_branches_on_a_random_value(branch, draw):
    setup = f"        {draw}\n        {branch}\n"
    texts = [
        f"scenario Main():\n    setup:\n        ego = Object\n{setup}",
        f"scenario Sub():\n    setup:\n{setup}    compose: wait\nscenario Main():\n    setup: ego = Object\n    compose: do Sub()\n",
    ]
    for text in texts:
        with pytest.raises(RandomBranch):
            actions(text, 2)


def test_after_setup_what_was_drawn_is_known():
    sub = "scenario Sub():\n    setup:\n        x = Uniform(1, 2)\n        o = Object at (5 * x, 5), with x x\n        o.x = o.x + 1\n"
    sub += "        xs = [x, x + 1]\n"
    sub += "    compose:\n        if x == 2 and o.x == 3 or x == 1 and o.position.x == 5:\n            wait\n"
    sub += "        for i in range(xs[1]):\n            wait\n        terminate\n"
    text = sub + "scenario Main():\n    setup: ego = Object at (0, 0)\n    compose: do Sub()\n"
    law = scenic_ref.loads(text).enumerate_simulations(steps=9).law(lambda simulation: len(simulation.moments))
    assert law == {4: Fraction(1, 2), 5: Fraction(1, 2)}
