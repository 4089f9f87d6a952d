"""What each compositional listing is about happens in its program: scenarios in parallel, in sequence and by choice, preconditions, overrides."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.data.simulation import Simulated
from scenic_ref.errors import AttemptsExhausted
from scenic_ref.roads import Network
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.simulators.worlds.driving import default_network

from .listed import FOLDER, SIMULATORS, apart, avenue, boxes, doing, place, simulated, speed, within

pytestmark = pytest.mark.slow
both_simulators = pytest.mark.parametrize("simulator", SIMULATORS)
RUNNER, JAYWALKER, PARKED = "RedLightRunner", "Jaywalker", "ParkedCar"


def created(run: Simulated) -> list[int]:
    """In which time step each object was there first that a scenario made on the way."""
    known = len(run.scene.objects)
    return [next(m.step for m in run.moments if len(m.objects) > known + number) for number in range(len(run.created))]


def gaps(run: Simulated, network: Network) -> list[float]:
    """The distances of parked cars to the curb, in centimetres."""
    curb = network.curbRegion.polyline  # type: ignore[attr-defined]
    return [round(100 * curb.distance(box)) for box in boxes(run, run.moments[-1])[len(run.scene.objects) :]]


def past(run: Simulated, step: int, number: int) -> float:
    """How far ego is past an object, along ego's heading."""
    moment = run.moments[step]
    heading = float(moment.objects[0]["heading"])  # type: ignore[arg-type]
    ahead = place(moment) - place(moment, number)
    return -ahead.x * math.sin(heading) + ahead.y * math.cos(heading)


@both_simulators
def test_two_copies_of_a_scenario_have_their_own_gaps(simulator: str) -> None:
    rejected: Counter[str] = Counter()
    for seed in range(6):
        run, stuck = simulated("parked_cars.scenic", simulator, seed)
        assert created(run) == [0, 0] and gaps(run, default_network()) == [25, 50]
        rejected += stuck
    assert rejected["guard"] > 0  # in an intersection there is no shoulder


def test_without_a_shoulder_the_precondition_rejects_every_run(tmp_path: Path) -> None:
    (tmp_path / "bare.xodr").write_text(generate_map("crossing", shoulders=False))
    program = "param map = localPath('bare.xodr')\n" + (FOLDER / "parked_cars.scenic").read_text("utf-8")
    with pytest.raises(AttemptsExhausted) as told:
        scenic_ref.loads(program, directory=tmp_path).simulate("kinematic", 5, max_attempts=20)
    assert {requirement.kind for requirement, _ in told.value.stuck} <= {"guard", "containment"}  # of ParkedCar, of ego
    assert told.value.stuck[0][0].kind == "guard"


@both_simulators
def test_cars_are_parked_in_turn(simulator: str) -> None:
    for seed in range(2):
        run, _ = simulated("parked_cars_in_turn.scenic", simulator, seed)
        assert created(run) == [0, 300, 600] and gaps(run, avenue()) == [25, 50, 25]


@both_simulators
def test_a_car_is_parked_when_ego_is_past_the_last_one(simulator: str) -> None:
    for seed in range(3):
        run, _ = simulated("parked_cars_one_by_one.scenic", simulator, seed)
        steps = created(run)
        assert steps[0] == 0 and len(steps) > 3 and set(gaps(run, avenue())) == {25}
        for number, step in enumerate(steps[1:], 1):
            assert past(run, step - 1, number) <= 10 < past(run, step, number)


@pytest.mark.slow
@both_simulators
def test_the_override_lasts_as_long_as_the_scenario(simulator: str) -> None:
    for seed in range(2):
        run, _ = simulated("pulling_ahead.scenic", simulator, seed)
        begin, end = created(run)[1], next(m.step for m in run.moments if any("termination condition" in event for event in m.events))
        near = [m.step for m in run.moments[1:] if apart(m, 0, 1) < 10]
        assert near[0] == begin > 0
        lead = {step: names[0] for step, names in doing(run, 1)}
        assert {lead[step] for step in range(begin, end)} == {"FollowLaneAvoidingCollisions"}
        assert {lead[step] for step in [*range(begin), *range(end, len(run.moments) - 1)]} == {"LeadAlong"}
        lane = avenue().laneAt(place(run.moments[begin], 1))
        assert lane is not None
        assert within(run, run.moments[end], lane.polygon, 2) and not within(run, run.moments[end - 1], lane.polygon, 2)  # type: ignore[arg-type]
        assert speed(run.moments[-1], 2) > 7


@both_simulators
def test_the_initial_scenario_makes_its_ego_and_others_use_the_one_that_is_there(simulator: str) -> None:
    alone = scenic_ref.load(FOLDER / "two_lane_pedestrian.scenic", scenario="TwoLanePedestrianScenario")
    walked = []
    for seed in range(4):
        run = alone.simulate(simulator, 10, seed).simulation
        assert [o.class_name for o in run.scene.objects] == ["Car", "Pedestrian"] and not run.created
        assert speed(run.moments[-1]) == 0
        both, _ = simulated("two_lane_pedestrian.scenic", simulator, seed)
        assert [o.class_name for o in both.scene.objects] == ["Car"] and [body.class_name for body in both.created] == ["Pedestrian"]
        for one in (run, both):
            road = default_network().roadAt(place(one.moments[0]))
            assert road is not None and len(road.lanes) == 2
            assert any(walk.contains_point(place(one.moments[0], 1)) for walk in road.sidewalks)
        walked.append(place(both.moments[0], 1) != place(both.moments[60], 1))
    assert any(walked)


def kinds(run: Simulated) -> list[str]:
    """Of which scenarios the created objects are, in order."""
    found = {"Pedestrian": JAYWALKER, "Car": PARKED}
    return [RUNNER if body.properties.get("speed") else found[body.class_name] for body in run.created]


def near_lights(where: Vector) -> bool:
    """Whether an intersection with traffic lights is less than 30 m away."""
    return any(i.distance_to(where) < 30 for i in default_network().intersections)


@pytest.mark.slow
@both_simulators
def test_the_next_scenario_is_picked_by_the_place(simulator: str) -> None:
    found = set()
    for seed in range(8):
        run, _ = simulated("next_scenario.scenic", simulator, seed)
        [kind] = kinds(run)
        assert (kind == RUNNER) == near_lights(place(run.moments[0]))
        found.add(kind)
    assert RUNNER in found and len(found) > 1


@both_simulators
def test_the_runner_enters_while_its_light_is_red(simulator: str) -> None:
    runs = [run for run in (simulated("next_scenario.scenic", simulator, seed)[0] for seed in range(8)) if kinds(run) == [RUNNER]]
    assert runs
    for run in runs:
        lane = default_network().laneAt(place(run.moments[0], 1))
        assert lane is not None
        enters = next(m.step for m in run.moments if default_network().intersectionAt(place(m, 1)) is not None)
        assert lane.trafficLight.stateAt(enters * 0.1) == "red"


def only(statement: str) -> str:
    """The program with one of its three choices alone."""
    lines = (FOLDER / "random_selection.scenic").read_text("utf-8").splitlines()
    others = [line for line in lines if line.strip().startswith(("do choose", "do shuffle")) and not line.strip().startswith(f"do {statement}")]
    return "\n".join(line for line in lines if line not in others) + "\n"


@both_simulators
@pytest.mark.parametrize("statement", ["choose RedLightRunner", "choose {RedLightRunner: 2"])
def test_each_scenario_is_chosen_in_some_run(statement: str, simulator: str) -> None:
    scenario = scenic_ref.loads(only(statement))
    found = [kinds(scenario.simulate(simulator, 1, seed, max_attempts=50).simulation) for seed in range(16)]
    assert all(len(chosen) == 1 for chosen in found)
    assert {chosen for [chosen] in found} == {RUNNER, JAYWALKER, PARKED}


@pytest.mark.slow
@both_simulators
def test_the_shuffle_runs_all_in_some_order(simulator: str) -> None:
    scenario = scenic_ref.loads(only("shuffle"))
    orders = set()
    for seed in range(4):
        run = scenario.simulate(simulator, 600, seed, max_attempts=100).simulation
        assert run.result == "terminated" and sorted(kinds(run)) == [JAYWALKER, PARKED, RUNNER]
        orders.add(tuple(kinds(run)))
    assert len(orders) > 1


@pytest.mark.slow
@both_simulators
def test_the_choices_come_one_after_the_other(simulator: str) -> None:
    for seed in range(2):
        run, _ = simulated("random_selection.scenic", simulator, seed)
        assert run.result == "terminated" and sorted(kinds(run)[2:]) == [JAYWALKER, PARKED, RUNNER]
        ends = [m.step for m in run.moments for event in m.events if "termination condition" in event]
        assert created(run)[0] == 0 and created(run)[1:] == ends[:4]


def test_a_disabled_scenario_is_never_chosen(tmp_path: Path) -> None:
    (tmp_path / "bare.xodr").write_text(generate_map("grid", rows=1, columns=2, shoulders=False, signals=True, crosswalks=True))
    scenario = scenic_ref.loads("param map = localPath('bare.xodr')\n" + only("choose RedLightRunner"), directory=tmp_path)
    found = {kinds(scenario.simulate("kinematic", 1, seed, max_attempts=50).simulation)[0] for seed in range(12)}
    assert found == {RUNNER, JAYWALKER}
