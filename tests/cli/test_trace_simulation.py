"""`scenic-ref trace --steps N`: the rules of the policy, time step by time step."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

PROGRAM = """
behavior Inner():
    take Uniform(1, 2)
behavior B():
    try:
        while True:
            do Inner()
            self.x = self.x + 1
    interrupt when simulation.currentTime == 1:
        take "brake"
monitor Watch:
    while True:
        require ego.x < 4
        wait
ego = Object at (0, 0), with x 0, with behavior B
require always ego.x < 5
terminate when ego.x == 2
"""
CHANCE = "behavior B():\n    require Range(0, 1) < 0.2\n    take 1\nego = Object at (0, 0), with behavior B\n"
MOVING = "ego = Object at (0, 0), with speed 2\n"


@pytest.fixture
def program():
    Path("d.scenic").write_text(PROGRAM)
    return "d.scenic"


def test_each_time_step_shows_the_rules_of_the_policy_in_their_order(ask, program):
    out = ask("trace", program, "--steps", 9).out
    steps = re.split(r"-------- time step \d+, \d+ s\n", out)
    assert len(steps) == 6
    for text in steps[1:-1]:
        places = [text.index(f"D-Policy-{k} ") for k in range(1, 8)]
        assert places == sorted(places)
    assert "D-Interrupt" in steps[2]
    assert "ego takes 'brake'" in steps[2]
    assert "ego > B() > Inner()" in steps[1]
    assert "a monitor of the top-level scenario" in steps[1]
    assert "O[ego.x / 1]" in steps[3]
    assert "D-Policy-5" not in steps[-1]
    assert "the scenario ends: the termination condition on line 17 is true" in steps[-1]
    assert "accepted: terminated: the termination condition on line 17 is true" in out


def test_the_actions_and_the_density_are_those_of_the_simulation(ask, program):
    run = json.loads(ask("simulate", program, "--steps", 9, "--run", 3, "--seed", 5).out)
    out = ask("trace", program, "--steps", 9, "--scene", 3, "--seed", 5).out
    taken = [step["actions"]["0"][0] for step in run["steps"][:-1]]
    assert re.findall(r"ego takes (\S+)", out) == [repr(one) for one in taken]
    found = re.search(r"log density (\S+)", out)
    assert found is not None
    assert float(found.group(1)) == pytest.approx(sum(math.log(1 / 2) for one in taken if one != "brake"), rel=1e-5)


def test_the_accepted_attempt_is_traced_unless_another_is_asked_for(ask):
    Path("c.scenic").write_text(CHANCE)
    run = next(r for r in (json.loads(ask("simulate", "c.scenic", "--steps", 1, "--run", k).out) for k in range(9)) if r["attempts"] > 1)
    found = ask("trace", "c.scenic", "--steps", 1, "--scene", run["run"]).out
    assert f"attempt {run['attempts']}\n" in found
    assert "accepted: time limit" in found
    other = ask("trace", "c.scenic", "--steps", 1, "--scene", run["run"], "--attempt", run["attempts"] - 1)
    assert other.code == 0
    assert "discarded, with its scene: this fails in time step 0: the requirement on line 2" in other.out


def test_what_the_simulator_changed_is_shown_where_the_step_begins(ask):
    Path("m.scenic").write_text(MOVING)
    out = ask("trace", "m.scenic", "--steps", 2, "--simulator", "kinematic", "--dt", 0.5).out
    assert "time step 0, 0 s\n" in out
    assert re.search(r"-------- time step 1, 0.5 s: the simulator: O\[ego.position / \(", out)
    assert out.count("the simulator: ") == 2
    assert "accepted: time limit: 2 time steps have passed" in out


def test_an_error_while_the_scenario_runs_follows_the_rules_before_it(ask):
    Path("e.scenic").write_text("behavior B():\n    take 1\n    take nosuch\nego = Object at (0, 0), with behavior B\n")
    found = ask("trace", "e.scenic", "--steps", 5)
    assert found.code == 1
    assert "time step 1" in found.out
    assert "the program is wrong, and the run ends here" in found.out
    assert found.err.count("nosuch is not defined") == 1
    assert "e.scenic:3" in found.err


def test_the_page_holds_the_time_steps(ask, program):
    ask("trace", program, "--steps", 3, "--html", "t.html")
    text = Path("t.html").read_text()
    events = json.loads(re.search(r"const trace = (.*);\n", text).group(1))["events"]
    assert [e["change"] for e in events if e["kind"] == "time"] == [f"time step {k}, {k} s" for k in range(4)]
    assert {e["step"] for e in events} == {None, 0, 1, 2, 3}


def test_a_simulator_without_steps_is_wrong_usage(ask, program):
    found = ask("trace", program, "--simulator", "kinematic")
    assert found.code == 2
    assert "--steps N" in found.err
