"""What a simulator is told of a scene, and what it says besides: that a run is rejected, or over."""

from __future__ import annotations

import json
import random

import pytest
import scenic_ref
from scenic_ref.data.simulation import Moment, to_line
from scenic_ref.interpreter.runtime.random_streams import simulator_seed
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import AttemptsExhausted, SimulatorError, UsageError
from scenic_ref.simulators import EndRun, RejectRun
from scenic_ref.simulators.loop import ENDED, LIMIT, TERMINATED
from scenic_ref.simulators.still import Still

ONE = "ego = Object at (Range(0, 1), 0)\n"


class Told(Still):
    """Keeps what it is told."""

    def __init__(self):
        super().__init__()
        self.told = []

    def create(self, bodies, scene):
        self.told.append(([body.id for body in bodies], scene))


class Saying(Still):
    """Does what `says` says in a time step, counted from 0, of which `steps` have passed."""

    properties = frozenset({"position"})

    def __init__(self, says):
        super().__init__()
        self.says, self.steps, self.destroyed = says, 0, 0

    def create(self, bodies, scene):
        self.says(self, "create", bodies, scene)

    def step(self, actions):
        self.steps += 1
        self.says(self, "step", self.steps - 1, actions)
        return ()

    def read(self, id):
        self.says(self, "read", self.steps, id)
        return {"position": Vector(float(self.steps), 0.0)}

    def check(self, body, action):
        self.says(self, "check", self.steps, action)

    def destroy(self):
        self.steps = 0
        self.destroyed += 1


def ending(step, reason="that was all", events=()):
    def says(simulator, what, number, _):
        if what == "step" and number == step:
            raise EndRun(reason, events)

    return Saying(says)


# What it is told


def test_a_simulator_is_told_of_parameters_ego_time_step_and_workspace():
    text = "param weather = 'RAIN'\nparam hour = Range(3, 4)\nparam cars = [1, (2, 3)]\nworkspace = Workspace(CircularRegion((0, 0), 50))\n"
    told = Told()
    scenic_ref.loads(text + "Object at (5, 5)\nego = Object at (0, 0)").simulate(told, 2)
    ((ids, scene),) = told.told
    assert ids == [0, 1]
    assert scene.params["weather"] == "RAIN"
    assert 3 <= scene.params["hour"] <= 4
    assert scene.params["cars"] == [1, (2, 3)]
    assert (scene.ego, scene.timestep, scene.network) == (1, 1.0, None)
    assert scene.workspace.contains_point(Vector(3, 4))
    with pytest.raises(TypeError):
        scene.params["weather"] = "SUN"


def test_what_it_does_with_parameters_changes_no_run():
    class Changing(Told):
        def create(self, bodies, scene):
            super().create(bodies, scene)
            scene.params["cars"].append(7)

    told = Changing()
    scenario = scenic_ref.loads("param cars = [1]\n" + ONE + "require always globalParameters.cars == [1]")
    runs = [scenario.simulate(told, 2).simulation for _ in range(2)]
    assert [scene.params["cars"] for _, scene in told.told] == [[1, 7], [1, 7]]
    assert [run.scene.params["cars"] for run in runs] == [[1], [1]]


def test_a_program_on_a_map_has_its_network():
    told = Told()
    scenic_ref.loads("model scenic.domains.driving.model\nego = Car on road").simulate(told, 1)
    network = told.told[0][1].network
    assert len(network.intersections) == 9
    assert told.told[0][1].workspace.network is network


def test_the_seed_is_a_function_of_seed_number_and_attempt():
    told = Told()
    scenario = scenic_ref.loads(ONE + "require always ego.position.x < 0.4")
    runs = [scenario.simulate(told, 1, seed, number) for seed in (0, 1) for number in (0, 1, 2)]
    assert max(run.attempts for run in runs) > 2
    expected = [simulator_seed(seed, number, attempt) for seed in (0, 1) for number in (0, 1, 2) for attempt in range(99)]
    seeds = [scene.seed for _, scene in told.told]
    assert len(set(seeds)) == len(seeds)
    assert [seed for seed in expected if seed in seeds] == seeds
    assert all(0 <= seed < 1 << 31 for seed in seeds)


def test_where_a_scene_is_kept_each_of_its_simulations_has_a_seed_of_its_own():
    told = Told()
    text = "behavior B():\n    take Range(0, 1)\n    require Range(0, 1) < 0.2\nego = Object at (0, 0), with behavior B"
    run = scenic_ref.loads(text, readings={"rejected-simulation": "retry"}).simulate(told, 3, 5)
    assert run.attempts > 1
    assert [scene.seed for _, scene in told.told] == [simulator_seed(5, 0, attempt) for attempt in range(run.attempts)]


def test_objects_that_are_made_later_come_with_what_is_so_by_then():
    text = "scenario Late():\n    setup:\n        ego = Object at (9, 9)\nscenario Main():\n    setup:\n        Object at (0, 0)\n"
    told = Told()
    scenic_ref.loads(text + "    compose:\n        wait\n        do Late() for 1 steps").simulate(told, 4)
    assert [(ids, scene.ego) for ids, scene in told.told] == [([0], None), ([1], 1)]
    assert told.told[0][1].seed == told.told[1][1].seed


class Chance(Saying):
    """Random: where objects are, and when it is over, follows from the seed."""

    random = True

    def __init__(self):
        super().__init__(lambda *_: None)
        self.chance = random.Random(0)

    def create(self, bodies, scene):
        self.chance = random.Random(scene.seed)

    def step(self, actions):
        super().step(actions)
        if self.chance.random() < 0.2:
            raise EndRun("chance", ["it happens"])
        return ()

    def read(self, id):
        return {"position": Vector(self.chance.random(), 0.0)}


def test_a_simulation_in_a_random_simulator_is_a_function_of_program_seed_and_number_and_replays():
    scenario = scenic_ref.loads(ONE + "require always ego.position.x < 0.8")
    runs = [scenario.simulate(Chance(), 20, 3, number) for number in range(5)]
    assert {run.simulation.result for run in runs} == {"ended by the simulator"}
    assert max(run.attempts for run in runs) > 1
    one = Chance()
    for number, run in reversed(list(enumerate(runs))):
        assert scenario.simulate(one, 20, 3, number).simulation.moments == run.simulation.moments
        replayed = scenario.replay(json.loads(to_line(run.simulation, run.attempts)), one)
        assert replayed.reason == "chance"
        assert [moment.objects for moment in replayed.moments] == [moment.objects for moment in run.simulation.moments]


def test_a_random_simulator_may_accept_what_it_rejected():
    """Nothing is drawn in this program, but the simulator's seed differs."""
    scenario = scenic_ref.loads("ego = Object at (0.5, 0)\nrequire always ego.position.x < 0.7")
    attempts = [scenario.simulate(Chance(), 3, 0, number).attempts for number in range(12)]
    assert max(attempts) > 1
    with pytest.raises(UsageError, match="not random"):
        scenario.enumerate_simulations(Chance(), 3)


# Rejecting


def rejecting(where, step=0, reason="no place to spawn"):
    def says(simulator, what, number, _):
        if what == where and (what == "create" or number == step):
            raise RejectRun(reason)

    return Saying(says)


@pytest.mark.parametrize(("where", "step", "found"), [("create", 0, 0), ("step", 2, 2), ("read", 2, 1)])
def test_a_rejected_run_is_discarded_with_its_scene_and_counted(where, step, found):
    simulator = rejecting(where, step)
    with pytest.raises(AttemptsExhausted, match=f"in time step {found}: the simulator rejected the run: no place to spawn") as caught:
        scenic_ref.loads(ONE).simulate(simulator, 9, max_attempts=4)
    assert simulator.destroyed == 4
    ((requirement, often),) = caught.value.stuck
    assert (requirement.kind, often) == ("simulator", 4)


def test_another_scene_is_drawn_after_a_rejection():
    def says(simulator, what, bodies, _):
        if what == "create" and bodies[0].properties["position"].x > 0.3:
            raise RejectRun("no place to spawn")

    runs = [scenic_ref.loads(ONE).simulate(Saying(says), 1, 0, number) for number in range(20)]
    assert all(run.simulation.scene.ego.position.x <= 0.3 for run in runs)
    assert all(run.stuck.total() == run.attempts - 1 for run in runs)
    assert 20 < sum(run.attempts for run in runs) < 200


def test_objects_that_are_made_later_can_be_rejected_as_well():
    def says(simulator, what, bodies, _):
        if what == "create" and bodies[0].id == 1:
            raise RejectRun("no place to spawn")

    text = "scenario Late():\n    setup:\n        Object at (9, 9)\nscenario Main():\n    setup:\n        ego = Object at (Range(0, 1), 0)\n"
    with pytest.raises(AttemptsExhausted, match="in time step 1: the simulator rejected"):
        scenic_ref.loads(text + "    compose:\n        wait\n        do Late()").simulate(Saying(says), 4, max_attempts=2)


def test_where_nothing_is_drawn_a_rejection_is_for_good():
    with pytest.raises(AttemptsExhausted, match="this fails in time step 0 whatever is drawn: the simulator rejected the run"):
        scenic_ref.loads("ego = Object at (0, 0)").simulate(rejecting("create"), 3)


def test_an_enumeration_counts_rejections_by_their_probability():
    def says(simulator, what, bodies, _):
        if what == "create" and bodies[0].properties["position"].x == 3:
            raise RejectRun("no place to spawn")

    found = scenic_ref.loads("ego = Object at (Uniform(1, 2, 3), 0)").enumerate_simulations(Saying(says), 1)
    assert float(found.acceptance) == pytest.approx(2 / 3)
    assert [(failed.requirement.text, failed.step) for failed in found.stuck] == [("the simulator rejected the run: no place to spawn", 0)]


# Ending


def test_a_simulation_that_the_simulator_ends_says_so():
    run = scenic_ref.loads(ONE).simulate(ending(2, events=["crash"]), 9).simulation
    assert (run.result, run.reason) == ("ended by the simulator", "that was all")
    assert [moment.step for moment in run.moments] == [0, 1, 2, 3]
    assert run.moments[2].events == ("crash",)
    assert run.moments[3].objects[0]["position"] == Vector(3.0, 0.0)


def test_the_policy_looks_at_the_last_state():
    """Steps 1 to 4 of the paper's policy are made once more, as at the time limit: what must hold always must hold then."""
    text = "ego = Object at (0, 0)\nrequire {}"
    accepted = scenic_ref.loads(text.format("eventually ego.position.x == 3")).simulate(ending(2), 9).simulation
    assert accepted.result == "ended by the simulator"
    assert "`require eventually` on line 2 is satisfied" in accepted.moments[3].events
    for condition in ("always ego.position.x < 3", "eventually ego.position.x == 4"):
        with pytest.raises(AttemptsExhausted, match="in time step 3"):
            scenic_ref.loads(text.format(condition)).simulate(ending(2), 9)


def test_the_programs_own_end_counts_first_and_the_time_limit_last():
    text = "ego = Object at (0, 0)\nterminate when ego.position.x == 3"
    cases = ((2, 9, TERMINATED), (3, 9, TERMINATED), (1, 9, ENDED), (2, 2, LIMIT), (1, 2, ENDED))
    for step, limit, result in cases:
        assert scenic_ref.loads(text).simulate(ending(step), limit).simulation.result == result


def test_monitors_and_compose_blocks_run_once_more():
    text = "monitor M:\n    while True:\n        if ego.position.x == 2:\n            terminate\n        wait\nego = Object at (0, 0)\n"
    assert scenic_ref.loads(text).simulate(ending(1), 9).simulation.result == "terminated"


# Errors


@pytest.mark.parametrize("where", ["create", "read", "check"])
def test_only_a_time_step_can_end_a_simulation(where):
    def says(simulator, what, number, _):
        if what == where:
            raise EndRun("over")

    text = "behavior B():\n    take 1\nego = Object at (0, 0), with behavior B"
    with pytest.raises(SimulatorError, match=rf"ended the run in {where}\(\), which only step\(\) can: over"):
        scenic_ref.loads(text).simulate(Saying(says), 3)


def test_a_check_cannot_reject_a_run():
    text = "behavior B():\n    take 1\nego = Object at (0, 0), with behavior B"
    with pytest.raises(SimulatorError, match=r"rejected the run in check\(\), which only create\(\), step\(\) and read\(\) can"):
        scenic_ref.loads(text).simulate(rejecting("check"), 3)


@pytest.mark.parametrize("reason", ["", " ", None, 3])
def test_a_reason_is_a_text(reason):
    for kind in (RejectRun, EndRun):
        with pytest.raises(SimulatorError, match="TypeError: the reason must be a text"):
            scenic_ref.loads(ONE).simulate(Saying(lambda *_, kind=kind: (_ for _ in ()).throw(kind(reason))), 3)


def test_events_of_an_end_are_texts():
    with pytest.raises(SimulatorError, match="what happened as a sequence of texts, not 'crash'"):
        scenic_ref.loads(ONE).simulate(ending(0, events="crash"), 3)


def test_a_simulator_says_whether_it_is_random():
    simulator = Still()
    simulator.random = "no"
    with pytest.raises(UsageError, match="random of a simulator must be True or False"):
        scenic_ref.loads(ONE).simulate(simulator)


# Replays


def test_a_replay_may_be_rejected():
    scenario = scenic_ref.loads(ONE)
    run = scenario.simulate(Saying(lambda *_: None), 4)
    record = json.loads(to_line(run.simulation, run.attempts))
    for where, step in (("create", 0), ("step", 2)):
        with pytest.raises(AttemptsExhausted, match=f"the replay fails in time step {step}: the simulator rejected the run: no place to spawn"):
            scenario.replay(record, rejecting(where, step))


def test_a_replay_may_end_before_the_recording():
    scenario = scenic_ref.loads(ONE)
    run = scenario.simulate(Saying(lambda *_: None), 4)
    record = json.loads(to_line(run.simulation, run.attempts))
    replayed = scenario.replay(record, ending(1, events=["crash"]))
    assert (replayed.result, replayed.reason, len(replayed.moments)) == ("ended by the simulator", "that was all", 3)
    assert replayed.moments[1].events == ("crash",)
    assert scenario.replay(record, ending(9)).result == "time limit"


@pytest.mark.parametrize("backend", ["compiled", "interpreter"])
def test_a_simulation_ends_where_its_outcome_is_settled(backend: str) -> None:
    scenario = scenic_ref.loads(
        "behavior B:\n    for i in range(20):\n        take Uniform(1, 2, 3)\nego = Object with behavior B\nrecord simulation.currentTime as t\n",
        dialect="scenic-2.1",
    )
    seen: list[int] = []

    def settled(moment: Moment) -> str:
        seen.append(moment.step)
        return "a three was taken" if moment.actions[0] == (3,) else ""

    run = scenario.simulate(steps=15, seed=4, settled=settled, backend=backend).simulation  # type: ignore[arg-type]
    whole = scenario.simulate(steps=15, seed=4, backend=backend).simulation  # type: ignore[arg-type]
    first = next(moment.step for moment in whole.moments if moment.actions[0] == (3,))
    assert (run.result, run.reason, len(run.moments)) == ("settled", "a three was taken", first + 2)
    assert run.moments[: first + 1] == whole.moments[: first + 1]
    assert seen == list(range(first + 1))
    assert to_line(scenario.simulate(steps=15, seed=4, settled=lambda moment: "").simulation, 1) == to_line(whole, 1)


def test_what_the_program_ends_is_not_settled() -> None:
    scenario = scenic_ref.loads("behavior B:\n    take 1\n    take 2\n    terminate\nego = Object with behavior B\n")
    run = scenario.simulate(steps=9, settled=lambda moment: "over" if moment.step == 2 else "").simulation
    assert run.result == "terminated"
    failing = scenic_ref.loads("ego = Object\nrequire eventually simulation.currentTime > 5\n")
    with pytest.raises(AttemptsExhausted):
        failing.simulate(steps=9, settled=lambda moment: "over", max_attempts=1)


@pytest.mark.parametrize("answer", [True, 3, b"over"])
def test_settled_gives_a_text_or_none(answer: object) -> None:
    scenario = scenic_ref.loads("ego = Object\n")
    with pytest.raises(UsageError, match="settled gives a text, the reason, or None, not"):
        scenario.simulate(steps=3, settled=lambda moment: answer)  # type: ignore[arg-type, return-value]
    assert scenario.simulate(steps=3, settled=lambda moment: None).simulation.result == "time limit"
