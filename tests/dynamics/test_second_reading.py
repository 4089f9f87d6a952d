"""What a reading beside the paper found: each was wrong once."""

from __future__ import annotations

from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import RunError, SimulatorError, UncaughtException, UsageError
from scenic_ref.simulators.kinematic import Kinematic
from scenic_ref.simulators.loop import Failed, Simulated

from .worlds import LIMIT, actions, behavior, simulated

MAIN = "scenario Main():\n    setup:\n        ego = Object at (0, 0), with x 0\n    compose:\n"
SHOWING = "behavior Show():\n    while True:\n        take self.x\n"


def main(compose: str, before: str = "", ego: str = "with x 0") -> str:
    """A program whose scenario Main has this compose block."""
    lines = "".join(f"        {line}\n" for line in compose.strip("\n").split("\n"))
    return f"{before}{MAIN.replace('with x 0', ego)}{lines}"


def acceptance(text: str, steps: int = 2, **options: object) -> Fraction:
    return scenic_ref.loads(text, **options).enumerate_simulations(steps=steps).acceptance  # type: ignore[arg-type]


@pytest.mark.parametrize("profile", ["paper", "prose", "scenic-2.1"])
def test_requirements_are_checked_where_they_stand_while_a_scenario_runs(profile):
    """Whatever reading `require-time` says of scenes."""
    run = simulated(behavior("wait\nrequire False\nwait"), profile=profile)
    assert isinstance(run, Failed)
    assert run.step == 1
    assert simulated(main("require False\nwait"), profile=profile) == Failed(simulated(main("require False\nwait")).requirement, 0)  # type: ignore[union-attr]
    sub = "scenario Sub():\n    setup:\n        require False\n"
    assert isinstance(simulated(main("do Sub()", sub), profile=profile), Failed)


@pytest.mark.parametrize("choice", ["do choose A", "do choose {A: 2}", "do shuffle A"])
def test_preconditions_of_a_choice_are_checked_once(choice):
    """"Checks the preconditions of the given scenarios, then executes one of the enabled scenarios"."""
    assert acceptance(main(f"{choice}\nwait", "scenario A():\n    precondition: Uniform(True, False)\n    compose: wait\n")) == Fraction(1, 2)
    assert acceptance(behavior(choice, "behavior A():\n    precondition: Uniform(True, False)\n    take 1\n")) == Fraction(1, 2)


def test_invariants_of_what_was_chosen_are_checked():
    text = behavior("do choose A, C", "behavior A():\n    invariant: False\n    take 1\nbehavior C():\n    take 2\n")
    assert acceptance(text) == Fraction(1, 2)


def test_a_setup_that_fails_leaves_no_objects_and_the_same_ego():
    failing = "scenario A():\n    setup:\n        ego = Object at (9, 0), with x 5\n        raise ValueError('x')\n"
    text = main("try:\n    do A()\ninterrupt when False:\n    pass\nexcept ValueError:\n    wait\nrequire ego.x == 0\nwait", failing)
    run = simulated(text)
    assert isinstance(run, Simulated)
    assert [len(moment.objects) for moment in run.moments] == [1, 1, 1]
    second = "scenario A():\n    setup:\n        Object at (9, 0)\nscenario C():\n    precondition: False\n"
    text = main("try:\n    do A(), C()\ninterrupt when False:\n    pass\nexcept PreconditionViolation:\n    wait\nwait", second)
    run = simulated(text)
    assert isinstance(run, Simulated)
    assert [len(moment.objects) for moment in run.moments] == [1, 1, 1]


def test_the_last_time_step_of_a_scenario_counts_for_its_monitors_as_for_its_conditions():
    """Reading `eventually-window`; a top-level program is a scenario without a name."""
    head = "scenario S():\n    setup:\n        terminate when simulation.currentTime == 2\n"
    watch = "        monitor M:\n            while True:\n                require simulation.currentTime < {}\n                wait\n"
    always = "        require always simulation.currentTime < {}\n"
    for declared in (watch, always):
        run = simulated(main("do S()\nwait", head + declared.format(2)))
        assert isinstance(run, Failed)
        assert run.step == 2
        assert actions(main("do S()\nwait", head + declared.format(3))) == [None, None, None, "terminated"]


def test_a_scenario_that_never_runs_misses_nothing():
    sub = "scenario S():\n    setup:\n        require eventually False\n"
    assert actions(main("do S() for 0 steps\nwait", sub)) == [None, "terminated"]
    assert actions(main("do S() for 1 steps\nwait", sub)) == ["rejected"]


def test_a_monitor_that_ends_its_scenario_does_not_save_it_from_its_requirements():
    sub = "scenario S():\n    setup:\n        require eventually simulation.currentTime == {}\n"
    sub += "        monitor M:\n            wait\n            terminate\n"
    assert actions(main("do S()\nwait", sub.format(9))) == ["rejected"]
    assert actions(main("do S()\nwait", sub.format(1))) == [None, None, None, "terminated"]


def test_a_scenario_that_runs_mutates_only_what_it_makes():
    for listed in ("mutate ego", "Object at (9, 0)\n        mutate ego"):
        with pytest.raises(RunError, match="mutates the objects that it makes"):
            simulated(main("do S()", f"scenario S():\n    setup:\n        {listed}\n"))
    run = simulated(main("do S() for 1 steps", "scenario S():\n    setup:\n        Object at (90, 0), with requireVisible False\n        mutate\n"))
    assert isinstance(run, Simulated)
    assert run.created[0].properties["position"] != Vector(90.0, 0.0)
    assert run.scene.ego.position == Vector(0.0, 0.0)


LOGGED = "seen = []\ndef logged():\n    seen.append(simulation.currentTime)\n    return True\nbehavior Say(word):\n    take word\n"


@pytest.mark.parametrize(("statement", "times"), [
    ("do Say('a')", (0.0, 1.0)), ("do Say('a') for 5 steps", (0.0, 1.0)), ("do Say('a') for 1 steps", (0.0, 1.0)),
    ("do Say('a') until False", (0.0, 1.0)), ("do shuffle Say('a'), Say('a')", (0.0, 2.0)), ("do Say('a'), Say('a')", (0.0, 1.0)),
])  # fmt: skip
def test_the_invariants_of_the_caller_are_checked_once_when_do_returns(statement, times):
    run = actions(behavior(f"invariant: logged()\n{statement}\ntake tuple(seen)", LOGGED), 4)
    assert times in run


def test_each_run_of_a_scenario_has_variables_of_its_own():
    sub = "scenario S(p):\n    setup:\n        p = p + 1\n        override ego with x p\n"
    text = main("s = S(1)\ndo s for 1 steps\ndo s for 1 steps\nrequire s.p == 2", SHOWING + sub, "with x 0, with behavior Show")
    assert actions(text) == [2, 2, "terminated"]
    with pytest.raises(RunError, match="is running already"):
        simulated(main("s = S(1)\ndo s, s", sub))


def test_scenarios_that_invoke_themselves_without_end_are_told():
    with pytest.raises(RunError, match="invokes itself too deeply"):
        simulated(main("do R()", "scenario R():\n    compose:\n        do R()\n"))


def test_the_state_at_the_time_limit_is_looked_at():
    assert actions("ego = Object at (0, 0)\nterminate when simulation.currentTime == 2", 2) == [None, None, "terminated"]
    assert actions("ego = Object at (0, 0)\nmonitor M:\n    wait\n    require False\n    wait", 1) == ["rejected"]
    assert actions(behavior("take 1\nrequire False\nwait"), 1) == [1, LIMIT]


# What a simulator does that it should not


class Odd(Kinematic):
    """Gives what it is told to."""

    said: object = None

    def read(self, id):
        return self.said if not isinstance(self.said, dict) else {**super().read(id), **self.said}


@pytest.mark.parametrize(("said", "message"), [
    (None, "gives None for"), ({"position": "here"}, "gives 'here' as the position of"), ({"speed": "fast"}, "gives 'fast' as the speed of"),
    ({"colour": 3}, "gives angularSpeed, colour, .* but declares angularSpeed, heading"),
])  # fmt: skip
def test_what_a_simulator_says_is_looked_at(said, message):
    simulator = Odd()
    simulator.said = said
    with pytest.raises(SimulatorError, match=message):
        scenic_ref.loads("ego = Object at (0, 0)").simulate(simulator, 2)


class Endless(Kinematic):
    """Cannot be ended once it has been made."""

    made = False

    def destroy(self):
        if self.made:
            raise RuntimeError("cannot stop")
        super().destroy()


class Five(Kinematic):
    def step(self, actions):
        return 5


def test_a_simulator_that_cannot_end_and_one_that_says_nonsense():
    scenario, simulator = scenic_ref.loads("ego = Object at (0, 0)"), Endless()
    simulator.made = True
    with pytest.raises(SimulatorError, match="RuntimeError: cannot stop"):
        scenario.simulate(simulator, 1)
    with pytest.raises(SimulatorError, match="a sequence of texts, not 5"):
        scenario.simulate(Five(), 1)


@pytest.mark.parametrize(("arguments", "message"), [
    ({"simulator": object()}, "has no method create"), ({"simulator": Kinematic}, "the class Kinematic"), ({"steps": -1}, "at least 0"),
    ({"steps": 2.5}, "whole number"), ({"seed": "a"}, "whole number"), ({"index": -1}, "at least 0"),
    pytest.param({"simulator": "pymunk", "timestep": 1e9}, "at most 60 seconds", marks=pytest.mark.extra("dynamics")),
])  # fmt: skip
def test_wrong_arguments_are_told(arguments, message):
    with pytest.raises(UsageError, match=message):
        scenic_ref.loads("ego = Object at (0, 0)").simulate(**arguments)


def test_errors_have_their_place():
    text = "behavior B(x):\n    take x\nego = Object at (0, 0), with behavior B\n"
    with pytest.raises(RunError, match="B\\(\\) needs a value for x") as found:
        simulated(text)
    assert found.value.span.line == 3
    text = "from scenic.domains.driving.actions import *\nbehavior B():\n    wait\n    take SetWalkingSpeedAction(1)\nclass Car:\n    width: 2\n"
    with pytest.raises(RunError, match="cannot take the action") as found:
        scenic_ref.loads(text + "ego = Car at (0, 0), with behavior B").simulate("kinematic", 5)
    assert found.value.span.line == 4
    with pytest.raises(RunError) as found:
        simulated("scenario S():\n    setup:\n        ego = Object at (0, 0)\n")
    assert found.value.hint == "begin with a scenario: --scenario S, or call it Main"


@pytest.mark.parametrize("change", [
    "x.k = 4", "l[0] = x\n    l[0].k = 4", "l[Uniform(0, 0)] = x\n    l[0].k = 4", "i = Uniform(0, 0)\n    l[i] = x\n    l[i].k = 4",
])  # fmt: skip
def test_what_was_drawn_may_be_changed_while_a_scenario_runs(change):
    text = f"behavior B():\n    x = Uniform(ego, o)\n    l = Uniform([1], [2])\n    {change}\n    take ego.k, o.k\n"
    text += "ego = Object at (0, 0), with k 0, with behavior B\no = Object at (5, 5), with k 0\n"
    law = scenic_ref.loads(text).enumerate_simulations(steps=1).law(lambda run: run.moments[0].actions[0])
    assert law == {(4, 0): Fraction(1, 2), (0, 4): Fraction(1, 2)}


def test_variables_of_a_setup_that_failed_are_gone():
    bad = "scenario Bad():\n    setup:\n        o = Object at (5, 5), with k 3\n        seen.append(o)\n        raise ValueError('x')\n"
    caught = "b = Bad()\ntry:\n    do b\nexcept ValueError:\n    pass\n"
    assert actions(main(f"{caught}require seen[0].k == 3\nwait", f"seen = []\n{bad}")) == [None, "terminated"]
    with pytest.raises(UncaughtException, match="o"):
        simulated(main(f"{caught}x = b.o.k\nwait", f"seen = []\n{bad}"))


def test_variables_of_a_scenario_that_did_not_come_to_begin_are_kept():
    """The third of a `do` had run before; the second cannot begin."""
    scenarios = "scenario Good():\n    setup:\n        k = 3\nscenario Bad():\n    precondition: False\n"
    compose = "g = Good()\ndo g for 1 steps\ntry:\n    do Good(), Bad(), g\nexcept PreconditionViolation:\n    pass\nrequire g.k == 3\nwait"
    assert actions(main(compose, scenarios)) == [None, None, "terminated"]


def test_abort_in_finally_ends_that_statement_only():
    body = "try:\n    take 0\ninterrupt when False:\n    pass\nfinally:\n    abort\ntake 3"
    assert actions(behavior(body), 2) == [0, 3, LIMIT]
    nested = "try:\n" + "".join(f"    {line}\n" for line in body.splitlines()) + "interrupt when False:\n    pass\ntake 4"
    assert actions(behavior(nested), 3) == [0, 3, 4, LIMIT]


class Clearing(Kinematic):
    def check(self, body, action):
        return None

    def step(self, actions):
        actions.clear()
        return []


class Numbering(Kinematic):
    def check(self, body, action):
        return 5


def test_a_simulator_cannot_change_what_is_recorded():
    scenario = scenic_ref.loads(behavior("take 1"))
    assert scenario.simulate(Clearing(), 1).simulation.moments[0].actions == {0: (1,)}
    with pytest.raises(SimulatorError, match="None or a reason, not 5"):
        scenario.simulate(Numbering(), 1)


def test_wrong_arguments_of_enumeration_are_told():
    scenario = scenic_ref.loads("ego = Object at (0, 0)")
    for arguments in ({"steps": -1}, {"steps": "a"}, {"max_runs": 0}):
        with pytest.raises(UsageError, match="whole number"):
            scenario.enumerate_simulations(**arguments)
    with pytest.raises(UsageError, match="max_attempts is a whole number of at least 1"):
        scenario.simulate(max_attempts=0)
