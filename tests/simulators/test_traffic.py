"""The simulator `sumo`: what behaviors move moves as in `kinematic`, and SUMO drives the rest on the map of the program."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.semantics.store.errors import AttemptsExhausted, RunError, UsageError
from scenic_ref.simulators import by_name
from scenic_ref.simulators.actions import SetAutopilotAction, SetThrottleAction
from scenic_ref.testing import check_simulator

MODEL = "model scenic.domains.driving.model\n"
ONE_LANE = MODEL + "lane = network.laneAt((-60, -1.8))\n"
DRIVER = ONE_LANE + "ego = Car at (-60, -1.75), facing -90 deg, with behavior AutopilotBehavior()\n"
"""A car in the middle of a lane towards the East, 46 m before the lights of a crossing, on the map that programs have by default."""
needs_sumo = pytest.mark.extra("sumo")


def moments(text, steps=100, simulator="sumo", **options):
    return scenic_ref.loads(MODEL + text if "model" not in text else text).simulate(simulator, steps, **options).simulation.moments


@needs_sumo
def test_it_keeps_the_contract_of_simulators():
    text = MODEL + "ego = Car at (-60, -1.75), facing -90 deg\nCar at (-30, -1.75), facing -90 deg\nCar at (-60, 1.75), facing 90 deg\n"
    against = text.replace("facing -90 deg\nCar", "facing 90 deg\nCar", 1)
    check_simulator(lambda: by_name("sumo"), SetThrottleAction(1), program=text)
    check_simulator(lambda: by_name("sumo"), SetAutopilotAction(True), program=text, tolerance=1e-6, rejected=against)


@needs_sumo
def test_what_behaviors_move_moves_as_in_kinematic():
    text = """
behavior B():
    while True:
        take SetThrottleAction(Range(0, 1)), SetSteerAction(Range(-0.3, 0.3))
ego = Car on road, with behavior B()
Pedestrian on sidewalk, with behavior WalkForwardBehavior(1)
"""
    for sumo, kinematic in zip(moments(text), moments(text, simulator="kinematic"), strict=True):
        assert sumo.objects == kinematic.objects


@needs_sumo
def test_a_driver_keeps_its_lane_accelerates_and_stops_at_a_red_light():
    course = [moment.objects[0] for moment in moments(DRIVER, 200)]
    assert max(abs(pose["position"].y + 1.75) for pose in course) < 0.05
    assert max(abs(pose["heading"] + math.pi / 2) for pose in course) < 0.01
    speeds = [pose["speed"] for pose in course]
    assert max(speeds) > 7
    assert speeds[-1] < 0.01
    assert -30 < course[-1]["position"].x < -8
    for one, other in pairwise(course[3:]):
        assert other["position"].x - one["position"].x == pytest.approx(other["speed"] * 0.1, abs=0.02)


@needs_sumo
def test_a_driver_brakes_for_what_another_behavior_moves():
    ahead = DRIVER + "Car at (-45, -1.75), facing -90 deg\n"
    course = [moment.objects[0]["position"].x for moment in moments(ahead, 150)]
    assert -55 < course[-1] < -45 - 4.5
    assert course[-1] - course[-20] < 0.01


@needs_sumo
def test_a_behavior_gets_its_car_back():
    text = MODEL + """
behavior B():
    take SetAutopilotAction(True)
    for i in range(20):
        wait
    take SetAutopilotAction(False), SetBrakeAction(0.5)
ego = Car at (-60, -1.75), facing -90 deg, with behavior B()
"""
    speeds = [moment.objects[0]["speed"] for moment in moments(text, 40)]
    driven = speeds[21]
    assert driven > 3
    for number, speed in enumerate(speeds[21:], 21):
        assert speed == pytest.approx(max(0.0, driven - 0.34 * (number - 21)), abs=1e-6)


@needs_sumo
def test_a_collision_is_told_once():
    text = MODEL + """
behavior B():
    take SetSpeedAction(10)
ego = Car at (-60, -1.75), facing -90 deg, with behavior B()
Car at (-45, -1.75), facing -90 deg
"""
    told = [(moment.step, event) for moment in moments(text, 20) for event in moment.events]
    assert [event for _, event in told] == ["collision of objects 0 and 1"]
    assert told[0][0] == pytest.approx((15 - 4.5) / 1.0, abs=1.01)


@needs_sumo
def test_objects_that_scenarios_make_later_join_the_traffic():
    text = MODEL + """
scenario Late():
    setup:
        Car at (-30, -1.75), facing -90 deg
scenario Main():
    setup:
        ego = Car at (-60, -1.75), facing -90 deg, with behavior AutopilotBehavior()
    compose:
        for i in range(5):
            wait
        do Late()
"""
    found = moments(text, 120)
    assert [len(moment.objects) for moment in found][4:7] == [1, 2, 2]
    assert found[-1].objects[1]["position"].x == -30
    assert found[-1].objects[0]["position"].x < -30 - 4.5
    assert found[-1].objects[0]["speed"] < 0.1


@needs_sumo
@pytest.mark.parametrize(
    ("place", "why"),
    [
        ("(0, 0)", "is in an intersection, where SUMO's drivers cannot begin"),
        ("(-60, 20)", "m from the nearest lane of SUMO: there is no place for a driver to begin"),
        ("(-60, 1.75)", "faces against the traffic of its lane"),
    ],
)
def test_where_no_driver_can_begin_the_run_is_rejected(place, why):
    text = MODEL + f"ego = Car at {place}, facing -90 deg, with regionContainedIn everywhere, with behavior AutopilotBehavior()\n"
    with pytest.raises(AttemptsExhausted, match="the simulator rejected the run: object 0") as caught:
        scenic_ref.loads(text).simulate("sumo", 3, max_attempts=2)
    assert why in caught.value.message
    assert caught.value.attempts == 2


@pytest.mark.slow
@needs_sumo
def test_simulations_follow_from_program_seed_and_number_and_replay():
    text = MODEL + "ego = Car on road, with behavior AutopilotBehavior()\nCar on road, with behavior AutopilotBehavior()\n"
    scenario = scenic_ref.loads(text)
    first = scenario.simulate("sumo", 60, 3, 1)
    assert scenario.simulate("sumo", 60, 3, 1).simulation.moments == first.simulation.moments
    record = json.loads(scenic_ref.data.simulation.to_line(first.simulation, first.attempts))
    again = scenario.replay(record, "sumo")
    assert [moment.objects for moment in again.moments] == [moment.objects for moment in first.simulation.moments]


@pytest.mark.slow
@needs_sumo
def test_drivers_are_the_seeds():
    turns = {moments(DRIVER, 700, seed=seed)[-1].objects[0]["position"] for seed in range(3)}
    assert len(turns) > 1


@needs_sumo
def test_an_ego_that_leaves_the_roads_ends_the_simulation(tmp_path):
    (tmp_path / "m.xodr").write_text(generate_map("highway", leg=60.0))
    text = f"param map = {str(tmp_path / 'm.xodr')!r}\n" + MODEL + """
ego = Car on Uniform(*network.roads[0].lanes).centerline, with behavior AutopilotBehavior()
require eventually ego.speed > 3
"""
    simulation = scenic_ref.loads(text).simulate("sumo", 2000).simulation
    assert simulation.result == "ended by the simulator"
    assert simulation.reason == "object 0, which is ego, has reached the end of the roads"
    assert simulation.moments[-2].events[-1] == "object 0 has reached the end of the roads"


@needs_sumo
def test_a_program_without_a_map_and_a_broken_time_step_are_refused():
    with pytest.raises(UsageError, match="needs a map"):
        scenic_ref.loads("ego = Object at (0, 0)").simulate("sumo")
    with pytest.raises(UsageError, match="a whole number of milliseconds"):
        by_name("sumo", 0.00015)


@pytest.mark.slow
@needs_sumo
def test_its_processes_end_with_it():
    simulator = by_name("sumo")
    scenic_ref.loads(DRIVER).simulate(simulator, 3)
    assert simulator.process is None
    code = "import scenic_ref, os, signal; from scenic_ref.simulators import by_name; s = by_name('sumo'); d = s.destroy\n"
    code += f"s.destroy = lambda: (print(s.process.pid, flush=True), d())\nscenic_ref.loads({DRIVER!r}).simulate(s, 2)"
    pid = int(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
    assert not Path(f"/proc/{pid}").exists()


def test_others_than_sumo_have_no_drivers():
    with pytest.raises(RunError, match="this simulator has no drivers"):
        moments(DRIVER, 2, "kinematic")
