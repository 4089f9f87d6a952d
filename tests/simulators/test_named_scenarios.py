"""Scenarios that the paper names, near the ends of lanes, and behaviors through intersections."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.data.simulation import Moment, Simulated
from scenic_ref.errors import AttemptsExhausted
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.vehicle_paths import Trajectory
from scenic_ref.simulators.worlds.driving import default_network

MODEL = "model scenic.domains.driving.model\nfrom scenic.domains.driving.scenarios import *\n"
IN = "network.intersections[0].incomingLanes[0]"


def composed(setup: str, compose: str, steps: int, prelude: str = "", seed: int = 0, **more: object) -> Simulated:
    blocks = ("\n".join(f"        {line}" for line in part.splitlines()) for part in (setup, compose))
    text = "{}{}scenario Main():\n    setup:\n{}\n    compose:\n{}\n".format(prelude, MODEL, *blocks)
    return scenic_ref.loads(text, **more).simulate("kinematic", steps=steps, seed=seed).simulation  # type: ignore[arg-type]


def distance(moment: Moment) -> float:
    """Metres between the first two objects."""
    between = moment.objects[1]["position"] - moment.objects[0]["position"]  # type: ignore[operator]
    return math.hypot(between.x, between.y)


def following(left: float, gap: float, lane: str = IN, steps: int = 120, **more: object) -> Simulated:
    """Ego so many metres before the end of a lane, and the car that it follows so many metres ahead."""
    setup = f"lane = {lane}\nego = Car at lane.centerline.pointAlongBy(lane.centerline.length - {left})"
    return composed(setup, f"do FollowingScenario({gap})", steps, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(("left", "gap"), [(40, 20), (25, 20), (19, 20), (10, 20), (2, 20), (5, 35), (3, 60)])
def test_the_car_that_is_followed_stands_at_its_gap_also_behind_the_end_of_the_lane(left, gap):
    start = following(left, gap, steps=1).moments[0].objects
    lane = default_network().intersections[0].incomingLanes[0]
    way = next(m for m in lane.maneuvers if m.type.name == "STRAIGHT")
    path = Trajectory([lane, way.connectingLane, way.endLane])
    places = [path.along(o["position"]) for o in start]
    assert places[1] - places[0] == pytest.approx(gap, abs=0.01)
    assert all(abs(o["heading"] - start[0]["heading"]) < 0.01 for o in start)


@pytest.mark.parametrize("left", [30, 8])
def test_ego_closes_up_and_falls_back_also_over_an_intersection(left):
    moments = following(left, 20).moments
    gaps = [distance(moment) for moment in moments]
    assert min(gaps) < 10
    assert gaps[-1] > 18


def test_where_ways_only_turn_ego_follows_round_the_bend(tmp_path: Path):
    (tmp_path / "t.xodr").write_text(generate_map("t"))
    stem = "[l for l in network.intersections[0].incomingLanes if all([m.type is not ManeuverType.STRAIGHT for m in l.maneuvers])][0]"
    moments = following(10, 40, stem, 90, prelude="param map = localPath('t.xodr')\n", directory=tmp_path).moments
    first, last = (moment.objects for moment in (moments[0], moments[-1]))
    assert abs(first[1]["heading"] - first[0]["heading"]) == pytest.approx(1.57, abs=0.1)
    assert last[0]["heading"] == pytest.approx(last[1]["heading"], abs=0.1)
    assert 10 < distance(moments[-1]) < 40


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_ego_goes_the_ways_that_the_car_ahead_chooses(tmp_path: Path, seed: int):
    (tmp_path / "round.xodr").write_text(generate_map("roundabout"))
    text = f"param map = localPath('round.xodr')\n{MODEL}scenario Main():\n    setup:\n"
    text += "        ways = filter(lambda l: len(l.maneuvers) > 1, network.lanes)\n"
    text += "        ego = Car on Uniform(*ways).centerline\n    compose:\n        do FollowingScenario()\n"
    run = scenic_ref.loads(text, directory=tmp_path).simulate("kinematic", steps=400, seed=seed).simulation
    gaps = [distance(moment) for moment in run.moments]
    assert max(gaps) < 25  # 108 at the end, where they part
    assert math.dist(run.moments[0].objects[1]["position"], run.moments[-1].objects[1]["position"]) > 20  # type: ignore[arg-type]


OVERRIDDEN = """scenario Other(target):
    setup:
        override target with behavior FollowLaneAvoidingCollisions
        terminate when False
"""


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [8, 1000])
def test_ego_follows_also_a_car_that_another_scenario_overrides(tmp_path: Path, seconds: int):
    (tmp_path / "round.xodr").write_text(generate_map("roundabout"))
    setup = (
        "lane = Uniform(*filter(lambda l: len(l.maneuvers) > 1, network.lanes))\n"
        "ego = Car at lane.centerline.pointAlongBy(max(5, lane.centerline.length - 30))"
    )
    compose = (
        f"following = FollowingScenario(20)\ntry:\n    do following\n"
        f"interrupt when simulation().currentTime == 5:\n    do Other(following.leadCar) for {seconds} seconds"
    )
    prelude = f"param map = localPath('round.xodr')\n{MODEL}{OVERRIDDEN}"
    run = composed(setup, compose, 300, prelude, seed=1, directory=tmp_path)
    assert max(map(distance, run.moments)) < 25  # 91 if ego went the way that was foreseen


def test_what_is_done_is_told_the_same_in_every_process():
    doing = following(30, 20, steps=1).moments[0].doing
    assert doing[0].startswith("CloseUpAndFallBack(<Car 1>, <scenic.Trail object>)")


PULLED = "ego = Car at {}.centerline.pointAlongBy({}), with behavior FollowLaneBehavior(6)"


def test_a_parked_car_pulls_out_ahead_and_the_scenario_ends_when_it_is_in_the_lane():
    run = composed(PULLED.format(IN, 5), "do ParkedCarPullingAheadOf(ego)\nterminate", 400)
    assert (run.result, run.reason) == ("terminated", "`terminate` was executed")
    lane = default_network().intersections[0].incomingLanes[0]
    parked = [m.objects[1]["position"] for m in run.moments]
    assert not lane.contains_point(parked[0])
    assert lane.contains_point(parked[-1])
    ego, other = (m for m in run.moments[-1].objects[:2])
    path = Trajectory([lane])
    assert path.along(other["position"]) > path.along(ego["position"]) + 4


def test_meanwhile_its_target_keeps_away_and_then_goes_on_as_before():
    run = composed(PULLED.format(IN, 5), "do ParkedCarPullingAheadOf(ego, 30)\ndo ParkedCar() for 2 seconds", 400)
    doing = [m.doing[0].partition(" >")[0] for m in run.moments if 0 in m.doing]
    assert doing[0].startswith("FollowLaneAvoidingCollisions")
    assert doing[-1].startswith("FollowLaneBehavior(6")


NO_ROOM = "lane.centerline.pointAlongBy(lane.centerline.length - 30)"
NO_SHOULDER = "network.intersections[0].maneuvers[0].connectingLane.centerline.pointAlongBy(3)"


@pytest.mark.parametrize("place", [NO_ROOM, NO_SHOULDER])
def test_without_room_or_shoulder_the_scenario_is_disabled(place):
    setup = f"lane = {IN}\nego = Car at {place}"
    other = "scenario Nothing():\n    setup:\n        terminate when True\n"
    run = composed(setup, "do choose ParkedCarPullingAheadOf(ego), Nothing()\nterminate", 20, other)
    assert [len(moment.objects) for moment in run.moments] == [1] * len(run.moments)
    with pytest.raises(AttemptsExhausted):
        composed(setup, "do choose ParkedCarPullingAheadOf(ego)", 5)


def turning(start: str, trajectory: str, steps: int = 200) -> Simulated:
    text = f"""model scenic.domains.driving.model
behavior B(m):
    do TurnBehavior({trajectory}, 6)
    take SetPositionAction((500, 500))
    terminate
m = [m for m in network.intersections[0].maneuvers if m.type is ManeuverType.LEFT_TURN][0]
ego = Car at {start}, with behavior B(m), facing m.connectingLane.centerline.heading_at({start})
"""
    return scenic_ref.loads(text).simulate("kinematic", steps=steps, seed=0).simulation


@pytest.mark.parametrize("start", ["m.connectingLane.centerline.pointAlongBy(3)", "m.startLane.centerline.pointAlongBy(-10)"])
def test_turning_ends_where_the_vehicle_leaves_the_intersection(start):
    network = default_network()
    intersection = network.intersections[0]
    positions = [m.objects[0]["position"] for m in turning(start, "[m.startLane, m.connectingLane, m.endLane]").moments]
    within = [network.intersectionAt(p) is intersection for p in positions]
    left = len(within) - 1 - within[::-1].index(True)  # the last moment in it
    assert positions[left + 2].x == pytest.approx(500, abs=1)
