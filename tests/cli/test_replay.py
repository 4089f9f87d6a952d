"""`scenic-ref simulate --replay`: recorded actions in a simulator, compared with the recording."""

from __future__ import annotations

import json
import math

import pytest
import scenic_ref
from scenic_ref.data.recording_reader import recording_from
from scenic_ref.data.simulation import to_json
from scenic_ref.semantics.store.errors import SimulatorError, UsageError
from scenic_ref.simulators.still import Still

CARS = """
from scenic.domains.driving.actions import *
class Car:
    width: 2
    length: 4.5
    speed: 0
    viewDistance: 200
behavior Go(throttle):
    while True:
        take SetThrottleAction(throttle), SetSteerAction(Range(-0.2, 0.2))
scenario Another():
    setup:
        Car at (Range(19, 21), 5), with velocity (0, 2), with behavior Go(0.3), with drives True
        terminate when simulation.currentTime >= 2
scenario Main():
    setup:
        ego = Car at (0, 0), with behavior Go(0.5)
        other = Car at (6, Range(10, 20)), with behavior Go(0.2)
    compose:
        wait
        wait
        do Another()
"""


@pytest.fixture
def recorded(ask, tmp_path):
    """Three recorded simulations of cars, one of which a scenario makes in time step 2, as lines of JSON."""
    (tmp_path / "cars.scenic").write_text(CARS)
    assert ask("simulate", "cars.scenic", "--simulator", "kinematic", "-n", 3, "--steps", 15, "-o", "runs.jsonl").code == 0
    return [json.loads(line) for line in (tmp_path / "runs.jsonl").read_text().splitlines()]


def lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def without_events(runs):
    return [{**run, "steps": [{**step, "events": []} for step in run["steps"]]} for run in runs]


def test_a_replay_in_the_same_simulator_gives_the_recorded_states(ask, tmp_path, recorded):
    done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "--simulator", "kinematic", "-o", "again.jsonl")
    assert done.code == 0, done.err
    assert "3 simulations of runs.jsonl replayed in kinematic" in done.err
    assert "all states are equal to the recorded ones" in done.err
    again = lines(tmp_path / "again.jsonl")
    assert [len(step["objects"]) for step in again[0]["steps"][:4]] == [2, 2, 3, 3]
    assert again[0]["created"][0]["properties"]["velocity"] == [0, 2]
    assert without_events(again) == without_events(recorded)


def test_another_simulator_gives_other_states_and_the_report_says_how_far(ask, tmp_path, recorded):
    done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "-o", "again.jsonl")
    assert done.code == 0, done.err
    farthest = (0.0, 0, 0)
    for number, run in enumerate(recorded, 1):
        beginnings = [o["position"] for o in (*run["scene"]["objects"], *run["created"])]
        for step in run["steps"]:
            farthest = max(farthest, *((math.dist(o["position"], beginnings[o["id"]]), o["id"], number) for o in step["objects"]))
    distance, id, number = farthest
    assert f"the largest distance is {distance:.3g} m (object {id} in line {number}, which differs from time step 1 on)" in done.err
    assert "with the recorded states in all time steps: 0 of 3" in done.err


def test_a_changed_state_is_found_from_its_time_step_on(ask, tmp_path, recorded):
    recorded[1]["steps"][7]["objects"][1]["position"][0] += 0.25
    recorded[2]["steps"][7]["objects"][1]["position"][0] += 5e-10
    (tmp_path / "runs.jsonl").write_text("".join(json.dumps(run) + "\n" for run in recorded))
    done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "--simulator", "kinematic", "-o", "again.jsonl")
    assert "with the recorded states in all time steps: 2 of 3" in done.err
    assert "the largest distance is 0.25 m (object 1 in line 2, which differs from time step 7 on)" in done.err


def test_still_replays_any_value(ask, tmp_path):
    text = "behavior B():\n    take 3, (1, 2), 'x', [None, {'a': 1}]\n    take self\nego = Object at (0, 0), with behavior B"
    (tmp_path / "any.scenic").write_text(text)
    assert ask("simulate", "any.scenic", "--steps", 3, "-o", "runs.jsonl").code == 0
    done = ask("simulate", "any.scenic", "--replay", "runs.jsonl", "-o", "again.jsonl")
    assert done.code == 0, done.err
    assert (tmp_path / "again.jsonl").read_text() == (tmp_path / "runs.jsonl").read_text()


def test_the_time_step_is_the_recorded_one_unless_another_is_given(ask, tmp_path, recorded):
    for more, timestep in (((), 0.1), (("--dt", "0.5"), 0.5)):
        done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "--simulator", "kinematic", *more)
        assert [json.loads(line)["timestep"] for line in done.out.splitlines()] == [timestep] * 3


def test_a_recording_of_something_else_is_refused_with_its_line(ask, tmp_path, recorded):
    recorded[1]["scene"]["objects"][1]["position"][1] += 1e-6
    (tmp_path / "runs.jsonl").write_text("".join(json.dumps(run) + "\n" for run in recorded))
    done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "--simulator", "kinematic", "-o", "again.jsonl")
    assert done.code == 2
    assert "runs.jsonl, line 2: its scene is not scene 1 of seed 0 of this program" in done.err
    assert "another program, other options" in done.err
    assert len(lines(tmp_path / "again.jsonl")) == 1


def drop(name):
    return lambda run: run.pop(name)


def put(*path_and_value):
    *path, last, value = path_and_value

    def change(run):
        for key in path:
            run = run[key]
        run[last] = value

    return change


def nested(run):
    run["steps"][0]["actions"]["0"] = json.loads("[" * 300 + "]" * 300)


@pytest.mark.sampled(8)
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("schema", "scenic-ref/scene/1"), "it is not a simulation of the format scenic-ref/simulation/1"),
        (drop("scene"), "the simulation has no field scene that is an object"),
        (drop("steps"), "the simulation has no field steps that is a list"),
        (put("steps", []), "it has no time steps"),
        (put("timestep", 0), "a positive number of seconds"),
        (put("timestep", 10**400), "no field timestep that is a number"),
        (put("seed", 1), "its scene is not that of seed 1, number 1"),
        (put("scene", "attempts", 0), "the scene has no field attempts that is a whole number of at least 1"),
        (put("steps", 3, "step", 10**30), "time step 3 is missing, or not in its place"),
        (put("steps", 3, 5), "time step 3 is missing, or not in its place"),
        (put("steps", 1, "actions", "7", []), "time step 1 refers to object 7, but there are 2 objects in it"),
        (put("steps", 1, "actions", "9" * 5000, []), "time step 1 refers to object 999"),
        (put("steps", 1, "objects", 0, "id", 4), "object 0 of time step 1 is missing, or not in its place"),
        (put("steps", 1, "objects", 0, "position", [1, None]), "no field position that is a list of two numbers"),
        (put("steps", -1, "objects", []), "has 0 objects, where there are 3"),
        (put("created", []), "time step 2 has 3 objects, where there are 2"),
        (lambda run: run["created"][0].pop("properties"), "an earlier version recorded it"),
        (put("steps", -1, "actions", "0", [1]), "which is the last"),
        (nested, "nested too deeply"),
        (put("steps", 4, "actions", "0", [{"action": "Fly", "args": []}]), "time step 4: there is no action Fly"),
        (put("steps", 4, "actions", "0", [{"action": "SetThrottleAction", "args": [3]}]), "throttle must be a number from 0 to 1, not 3"),
        (put("steps", 4, "actions", "0", [{"action": "SetThrottleAction", "args": [1, 2, 3]}]), "SetThrottleAction: "),
        (put("steps", 4, "actions", "0", [{"action": "SetSpeedAction", "args": [10**400]}]), "SetSpeedAction: "),
        (put("steps", 4, "actions", "0", [{"action": "SetWalkingSpeedAction", "args": [1]}]), "only pedestrians can"),
        (put("steps", 4, "actions", "0", ["go"]), "it is none of SetThrottleAction"),
    ],
)
def test_hostile_recordings_are_usage_errors_with_their_line(ask, tmp_path, recorded, change, message):
    change(recorded[1])
    (tmp_path / "runs.jsonl").write_text("".join(json.dumps(run) + "\n" for run in recorded))
    done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "--simulator", "kinematic", "-o", "again.jsonl")
    assert done.code == 2, done.err
    assert "runs.jsonl, line 2: " in done.err
    assert message in done.err
    if (tmp_path / "again.jsonl").exists():
        assert without_events(lines(tmp_path / "again.jsonl")) == without_events(recorded[:1])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text[:-40], "line 3: it is not JSON"),
        (lambda text: text + "\n", "line 4: it is not JSON"),
        (lambda text: text.replace('"timestep": 0.1', '"timestep": NaN'), "line 1: it is not JSON: NaN is not a number"),
        (lambda text: text.replace('"timestep": 0.1', '"timestep": 1e999'), "line 1: it is not JSON: 1e999 is not a number"),
        (lambda text: "[" * 200_000, "line 1: "),
        (lambda text: "[1, 2]\n", "line 1: it is not a simulation"),
        (lambda text: "\udcff\n", "line 1: it is not JSON"),
        (lambda text: "", "holds no simulations"),
    ],
)
def test_what_is_no_file_of_simulations_is_refused_before_anything_is_written(ask, tmp_path, recorded, change, message):
    (tmp_path / "runs.jsonl").write_text(change((tmp_path / "runs.jsonl").read_text()), errors="surrogateescape")
    done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "-o", "again.jsonl", "--html", "again.html", "--gif", "again.gif")
    assert (done.code, done.out) == (2, "")
    assert message in done.err
    assert not list(tmp_path.glob("again*"))


def test_options_that_the_recording_decides_cannot_be_given(ask, recorded):
    for option in ("-n", "--seed", "--run", "--steps"):
        done = ask("simulate", "cars.scenic", "--replay", "runs.jsonl", option, 1)
        assert done.code == 2
        assert f"{option} cannot be given with --replay" in done.err
    assert "nowhere.jsonl cannot be read: No such file" in ask("simulate", "cars.scenic", "--replay", "nowhere.jsonl").err
    assert "is the recording" in ask("simulate", "cars.scenic", "--replay", "runs.jsonl", "-o", "runs.jsonl").err


def test_in_python_a_record_is_replayed_by_the_scenario(recorded):
    scenario = scenic_ref.loads(CARS)
    run = scenario.simulate("kinematic", 15, 0, 1)
    record = json.loads(json.dumps(to_json(run.simulation, run.attempts)))
    assert scenario.replay(record, "kinematic").moments[-1].objects == run.simulation.moments[-1].objects
    with pytest.raises(UsageError, match="its scene is not scene 1 of seed 0 of this program"):
        scenic_ref.loads(CARS.replace("Range(10, 20)", "Range(10, 21)")).replay(recording_from(json.dumps(record).encode()))


class Failing(Still):
    """Raises in the third time step."""

    steps = 0
    destroyed = 0

    def step(self, actions):
        self.steps += 1
        if self.steps == 3:
            raise ZeroDivisionError("oh")
        return ()

    def destroy(self):
        self.destroyed += 1


def test_a_simulator_that_fails_in_a_replay_is_told_and_destroyed(recorded):
    simulator = Failing()
    with pytest.raises(SimulatorError, match="the simulator failed: ZeroDivisionError: oh"):
        scenic_ref.loads(CARS).replay(recorded[0], simulator)
    assert (simulator.steps, simulator.destroyed) == (3, 1)
    failing = Failing()
    with pytest.raises(SimulatorError, match="oh"):
        scenic_ref.loads("ego = Object at (0, 0)").simulate(failing, 5)
    assert (failing.steps, failing.destroyed) == (3, 1)


MODULE = "from dataclasses import dataclass\n@dataclass(frozen=True)\nclass Jump:\n    height: float\n"


def test_actions_of_a_trusted_module_are_made_again(ask, tmp_path):
    (tmp_path / "jumping.py").write_text(MODULE)
    (tmp_path / "jump.scenic").write_text("from jumping import Jump\nbehavior B():\n    take Jump(2.5)\nego = Object at (0, 0), with behavior B")
    scenario = scenic_ref.load(tmp_path / "jump.scenic", trust=True)
    run = scenario.simulate("still", 2)
    again = scenario.replay(to_json(run.simulation, 1))
    assert again.moments[0].actions == run.simulation.moments[0].actions
    assert type(again.moments[0].actions[0][0]).__name__ == "Jump"
