"""Traffic lights: their plan has no conflicts, vehicles wait for them, programs may set and freeze them, and nothing of it outlives a run."""

from __future__ import annotations

import math
from itertools import combinations, pairwise

import pytest
import scenic_ref
from scenic_ref.data.simulation import Moment, Simulated
from scenic_ref.errors import UncaughtException
from scenic_ref.roads import Network, made_map
from scenic_ref.roads.network import CLEARING, GREEN, YELLOW, lights_of
from scenic_ref.simulators.worlds.driving import default_network
from shapely.geometry import Point

PERIOD = GREEN + YELLOW + CLEARING
SIMULATORS = ["kinematic", pytest.param("pymunk", marks=[pytest.mark.extra("dynamics"), pytest.mark.slow])]
both_simulators = pytest.mark.parametrize("simulator", SIMULATORS)
MAPS: dict[str, tuple[str, dict[str, bool | float]]] = {
    "grid": ("grid", {"rows": 2, "columns": 2}), "one-way": ("grid", {"rows": 2, "columns": 2, "one_way": True}),
    "crossing": ("crossing", {"lanes": 2}),
    "three": ("crossing", {"legs": 3}), "t": ("t", {}), "left": ("crossing", {"left_hand": True}), "roundabout": ("roundabout", {}),
    "suburb": ("suburb", {"rows": 2, "columns": 2, "seed": 3}),
}  # fmt: skip


def states(network: Network, seconds: float) -> dict[str, str]:
    return {signal.uid: signal.stateAt(seconds) for signal in network.signals}


@pytest.mark.parametrize("name", MAPS)
def test_ways_that_conflict_are_never_green_together(name: str) -> None:
    kind, parameters = MAPS[name]
    network = made_map(kind, signals=True, **parameters)
    assert network.intersections
    for intersection in network.intersections:
        assert lights_of(intersection)
        count = 1 + max(intersection.turns.values())
        with_lights = {lane.group for lane in intersection.incomingLanes if lane._trafficLight is not None}
        assert set(intersection.turns) == with_lights
        assert with_lights == {lane.group for lane in intersection.incomingLanes} or kind == "roundabout"  # whose ring has none
        for tenth in range(int(10 * count * PERIOD)):
            free = {group for group, lights in lights_of(intersection).items() if lights[0].stateAt(tenth / 10) != "red"}
            for one, other in combinations([m for m in intersection.maneuvers if m.startLane.group in free], 2):
                assert one.startLane.group is other.startLane.group or other not in one.conflictingManeuvers


@pytest.mark.parametrize("name", MAPS)
def test_each_light_is_green_once_in_a_cycle_for_its_time(name: str) -> None:
    kind, parameters = MAPS[name]
    for signal in made_map(kind, signals=True, **parameters).signals:
        assert signal.turn is not None
        cycle = signal.turn[1] * PERIOD
        times = [(k + 0.5) / 10 for k in range(round(cycle * 10))]
        told = [signal.stateAt(time) for time in times]
        assert (told.count("green"), told.count("yellow")) == (10 * GREEN, 10 * YELLOW)
        begin = told.index("green")
        assert told[begin:][: round(10 * (GREEN + YELLOW))] == ["green"] * round(10 * GREEN) + ["yellow"] * round(10 * YELLOW)
        assert [signal.stateAt(time + 5 * cycle) for time in times] == told
        changes = [signal.changesUntil(time) for time in times]
        assert all((b - a == 1) if x != y else a == b for (a, b), (x, y) in zip(pairwise(changes), pairwise(told), strict=True))


def test_lanes_know_their_light_and_where_to_wait() -> None:
    network = default_network()
    for intersection in network.intersections:
        for lane in intersection.incomingLanes:
            assert lane.trafficLight in intersection.signals and lane.trafficLight in lane.road.signals
            assert 3 < lane.centerline.polyline.length - lane.trafficLight.stopLine(lane) < 6  # before the crosswalk
    assert all(m.connectingLane is None or m.connectingLane._trafficLight is None for i in network.intersections for m in i.maneuvers)
    assert {signal.stateAt(0.0) for signal in made_map("crossing", signals=True).signals} == {"green", "red"}


HEAD = "model scenic.domains.driving.model\nlane = Uniform(*network.intersections[4].incomingLanes)\n"
WAITS = HEAD + (
    "behavior Wait():\n    do WaitForTrafficLightBehavior()\n    do FollowLaneBehavior()\n"
    "ego = Car at lane.centerline.pointAlongBy(Range(20, 60)), with behavior {}\nparam light = lane.trafficLight\nparam lane = lane\n"
)


def run(text: str, simulator: str, steps: int, seed: int = 0) -> Simulated:
    return scenic_ref.loads(text).simulate(simulator, steps, seed).simulation


@pytest.mark.slow
@both_simulators
@pytest.mark.parametrize("behavior", ["Wait", "FollowLaneObeyingTrafficLights"])
def test_a_car_waits_at_the_line_and_goes_at_green(behavior: str, simulator: str) -> None:
    waited = 0
    for seed in range(2):
        found = run(WAITS.format(behavior), simulator, 520, seed)
        light, lane = found.scene.params["light"], found.scene.params["lane"]
        line = light.stopLine(lane)
        fronts = [lane.centerline.polyline.project(point(m)) + 2.25 for m in found.moments]
        over = next(k for k, front in enumerate(fronts) if front > line)
        assert light.stateAt(over * 0.1) in ("green", "yellow")
        stands = [m.step for m in found.moments[30:over] if abs(m.objects[0]["speed"]) < 0.05]  # type: ignore[arg-type]
        if stands:
            waited += 1
            assert light.stateAt(stands[0] * 0.1) != "green" and line - 2 < fronts[stands[0]] <= line
            begin = next(k for k in range(stands[0], len(found.moments)) if light.stateAt(k * 0.1) == "green")
            assert begin - 1 <= stands[-1] <= begin + 3
    assert waited >= 1


def point(moment: Moment) -> Point:
    """Where ego is."""
    return Point(*moment.objects[0]["position"])  # type: ignore[misc]


SETS = HEAD + """
STATES = ('green', 'yellow', 'red')
behavior Look():
    for i in range(200):
        {}
        take SetThrottleAction(STATES.index(getTrafficLightStatus(lane.trafficLight)) / 2), SetBrakeAction(1)
ego = Car at lane.centerline.pointAlongBy(60), with behavior Look
require lane.trafficLight.stateAt(0) == 'red' and lane.trafficLight.stateAt(16) == 'green'
"""


def seen(statements: str, seed: int = 0) -> list[str]:
    """The state of the light in each time step."""
    found = run(SETS.format("\n        ".join(statements.split("; "))), "kinematic", 200, seed)
    return [("green", "yellow", "red")[int(2 * moment.actions[0][0].throttle)] for moment in found.moments[:-1]]  # type: ignore[attr-defined]


@pytest.mark.slow
def test_a_light_that_is_set_stays_so_until_the_plan_changes_it() -> None:
    planned = seen("pass")
    assert planned == ["red"] * 150 + ["green"] * 50
    set_once = seen("if i == 20: setClosestTrafficLightStatus(self, 'green')")
    assert set_once == ["red"] * 20 + ["green"] * 180
    assert seen("if i == 20: setClosestTrafficLightStatus(self, 'yellow')") == ["red"] * 20 + ["yellow"] * 130 + ["green"] * 50
    assert seen("if i == 20: setAllIntersectionTrafficLightsStatus(network.intersections[4], 'yellow')")[20:150] == ["yellow"] * 130
    assert seen("pass") == planned  # nothing is left of it in the next run


def test_frozen_lights_change_only_when_they_are_set() -> None:
    assert seen("if i == 10: freezeTrafficLights()") == ["red"] * 200
    late = seen("if i == 10: freezeTrafficLights(); if i == 30: unfreezeTrafficLights()")
    assert late == ["red"] * 170 + ["green"] * 30
    assert seen("if i == 10: freezeTrafficLights(); if i == 60: setClosestTrafficLightStatus(self, 'green')") == ["red"] * 60 + ["green"] * 140


NEAR = HEAD + """
behavior Look():
    near, notGreen = withinDistanceToTrafficLight(self, {}), withinDistanceToRedYellowTrafficLight(self, {})
    take SetThrottleAction(1 if near else 0), SetBrakeAction(1 if notGreen else 0)
ego = Car at lane.centerline.pointAlongBy({}), with behavior Look
require lane.trafficLight.stateAt(0) == '{}'
"""


@pytest.mark.parametrize(("near", "place", "state", "told"), [(20, 80, "red", (1, 1)), (20, 80, "green", (1, 0)), (10, 60, "red", (0, 0))])
def test_whether_a_light_is_near(near: float, place: float, state: str, told: tuple[int, int]) -> None:
    first = run(NEAR.format(near, near, place, state), "kinematic", 1).moments[0]
    assert (first.actions[0][0].throttle, first.actions[0][1].brake) == told  # type: ignore[attr-defined]


def test_only_lights_have_the_three_states() -> None:
    for wrong, message in (("'blue'", "must be 'green', 'yellow' or 'red', not 'blue'"), ("7", "not 7")):
        with pytest.raises(UncaughtException, match=message):
            run(SETS.format(f"setClosestTrafficLightStatus(self, {wrong})"), "kinematic", 2)


def test_a_colour_that_is_none_is_refused_where_no_light_is_near() -> None:
    far = "behavior Set():\n    setClosestTrafficLightStatus(self, 'pink', distance=0)\n    wait\nego = Car on road, with behavior Set\n"
    with pytest.raises(UncaughtException, match="must be 'green', 'yellow' or 'red', not 'pink'"):
        scenic_ref.loads(f"model scenic.domains.driving.model\n{far}").simulate("kinematic", 2)



def test_a_map_without_lights_has_none() -> None:
    network = made_map("crossing")
    assert not network.signals and all(lane._trafficLight is None for lane in network.lanes)
    assert not network.intersections[0].turns and math.isclose(PERIOD, 15)
