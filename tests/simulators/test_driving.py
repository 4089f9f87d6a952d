"""The driving library: programs on maps, by every backend and in both simulators; what its behaviors do."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.data.simulation import Simulated
from scenic_ref.errors import AttemptsExhausted, ProgramError, UncaughtException
from scenic_ref.roads import Network, made_map, read_map
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.vehicle_paths import Trajectory
from scenic_ref.semantics.space.absence import Absent
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.simulators import by_name
from scenic_ref.simulators.worlds.driving import default_network

MODEL = "model scenic.domains.driving.model\n"
STEPS = 150
DOCS = Path(__file__).parents[2] / "docs" / "roads.md"

PROGRAMS = {
    "two cars": "ego = Car on road\nother = Car ahead of ego by Range(5, 10)\n",
    "a maneuver and what conflicts with it": (
        "inter = Uniform(*filter(lambda i: i.is4Way, network.intersections))\n"
        "lane = Uniform(*inter.incomingLanes)\n"
        "turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, lane.maneuvers))\n"
        "other = Uniform(*turn.conflictingManeuvers)\n"
        "ego = Car on lane.centerline\nCar on other.startLane.centerline\nparam kind = other.type.name\n"
    ),
    "sections of lanes": (
        "s = Uniform(*network.laneSections)\nrequire s._laneToLeft is not None\nrequire s.laneToLeft.isForward != s.isForward\n"
        "ego = Car on s\nparam free = s._fasterLane is None, number = s.openDriveID\n"
    ),
    "curbs and sidewalks": (
        "r = Uniform(*filter(lambda r: len(r.lanes) == 2, network.roads))\nego = Car on r\n"
        "spot = OrientedPoint on visible ego.laneGroup.curb\nparked = Car left of spot by 0.25\nPedestrian on visible r.sidewalkRegion\n"
        "require ego.road is r\nrequire (distance from ego to intersection) < 60\n"
    ),
}


def scenario(text: str, **more: object) -> scenic_ref.Scenario:
    return scenic_ref.loads(MODEL + text, **more)  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("name", PROGRAMS)
def test_scenes_are_the_same_by_the_interpreter_and_by_the_batch_backend(name: str) -> None:
    program = scenario(PROGRAMS[name])
    one_by_one, many = (list(program.sample_many(8, 1, backend=backend)) for backend in ("interpreter", "batch"))
    assert [s.to_json() for s in one_by_one] == [s.to_json() for s in many]
    network = default_network()
    for scene in many:
        for o in scene.objects:
            region = network.roadOrShoulder if o.class_name == "Car" else network.walkableRegion
            assert region.contains_box(o.position, o.heading, o.width, o.length)


def test_the_program_of_the_documentation_runs(tmp_path: Path) -> None:
    [text] = re.findall(r"```\n(param map.*?)```", DOCS.read_text(), re.DOTALL)
    (tmp_path / "town.xodr").write_text(generate_map("crossing", signals=True))
    program = scenic_ref.loads(text, directory=tmp_path)
    assert program.sample().params["map"].endswith("town.xodr")  # type: ignore[union-attr]
    assert isinstance(simulated(program), Simulated)


def simulated(program: scenic_ref.Scenario, simulator: str = "kinematic", steps: int = STEPS, seed: int = 0) -> Simulated:
    return program.simulate(by_name(simulator, 0.1), steps, seed).simulation


def track(simulation: Simulated, number: int = 0) -> list[tuple[Vector, float]]:
    """Where an object is, and how fast, at each time step."""
    poses = [moment.objects[number] for moment in simulation.moments]
    return [(pose["position"], pose["speed"]) for pose in poses]  # type: ignore[misc]


def off_lanes(network: Network, places: list[Vector]) -> float:
    """The largest distance to the nearest centerline of a lane."""
    return max(min(lane.centerline.distance_to(place) for lane in network.lanes) for place in places)


@pytest.mark.slow
@pytest.mark.parametrize("simulator", ["kinematic", pytest.param("pymunk", marks=pytest.mark.extra("dynamics"))])
@pytest.mark.parametrize("seed", range(3))
def test_lanes_are_followed_at_a_sensible_speed(simulator: str, seed: int) -> None:
    program = scenario("lane = Uniform(*network.lanes)\nego = Car on lane.centerline, with behavior FollowLaneBehavior(8)\n")
    found = track(simulated(program, simulator, 250, seed))
    assert off_lanes(default_network(), [place for place, _ in found]) < 0.8
    assert 7 < max(speed for _, speed in found) < 9
    assert sum(abs(complex(*(after - before))) for (before, _), (after, _) in pairwise(found)) > 40


TURNS = {"LEFT_TURN": "left", "RIGHT_TURN": "right", "STRAIGHT": "straight on"}


@pytest.mark.slow
@pytest.mark.parametrize("kind", TURNS)
def test_a_trajectory_through_an_intersection_is_followed_to_its_end(kind: str) -> None:
    text = (
        f"turn = Uniform(*filter(lambda m: m.type is ManeuverType.{kind}, network.intersections[4].maneuvers))\n"
        "start = turn.startLane.centerline[-1]\n"
        "ego = Car following roadDirection from start for -15,\n"
        "      with behavior FollowTrajectoryBehavior(8, [turn.startLane, turn.connectingLane, turn.endLane])\n"
        "param there = turn.endLane.uid\n"
    )
    run = scenario(text).simulate(by_name("kinematic", 0.1), STEPS, 3).simulation
    network = default_network()
    end = network.elements[run.scene.params["there"]]  # type: ignore[index]
    places = [place for place, _ in track(run)]
    assert off_lanes(network, places) < 0.8
    assert any(end.contains_point(place) for place in places)
    slowest = min(speed for place, speed in track(run) if network.intersectionAt(place) is not None)
    assert slowest > 6 if kind == "STRAIGHT" else slowest < 6.5  # bends are taken slowly


LANES = "grid", {"lanes": 2, "block": 250.0, "rows": 1, "columns": 2}


def on_two_lanes(text: str, tmp_path: Path) -> scenic_ref.Scenario:
    (tmp_path / "lanes.xodr").write_text(generate_map(LANES[0], **LANES[1]))  # type: ignore[arg-type]
    return scenic_ref.loads("param map = localPath('lanes.xodr')\n" + MODEL + text, directory=tmp_path)


SECTION = "lane = filter(lambda s: s._fasterLane is not None and s.centerline.length > 150, network.laneSections)[0]\n"


def test_lanes_are_changed(tmp_path: Path) -> None:
    text = (
        f"{SECTION}behavior Change():\n    do LaneChangeBehavior(lane.fasterLane)\n    do FollowLaneBehavior()\n"
        "ego = Car at lane.centerline.pointAlongBy(20), with speed 10, with behavior Change\nparam lane = lane.uid\n"
    )
    program = on_two_lanes(text, tmp_path)
    run = simulated(program, steps=60)
    network = read_map(tmp_path / "lanes.xodr")
    before = network.elements[run.scene.params["lane"]]
    last, _ = track(run)[-1]
    assert before.fasterLane.contains_point(last) and before.fasterLane.centerline.distance_to(last) < 0.6


def test_what_stands_in_the_way_is_passed(tmp_path: Path) -> None:
    text = (
        f"{SECTION}"
        "behavior Drive():\n"
        "    passed = False\n"
        "    try:\n        do FollowLaneBehavior(8)\n"
        "    interrupt when self.distanceToNextObstacle() < 20 and not passed:\n"
        "        do PassingBehavior()\n        passed = True\n"
        "ego = Car at lane.centerline.pointAlongBy(20), with speed 8, with behavior Drive\n"
        "slow = Car at lane.centerline.pointAlongBy(60)\n"
        "require always not ego.intersects(slow)\n"
        "require eventually (distance from ego to lane.centerline.pointAlongBy(100)) < 2\n"
    )
    assert simulated(on_two_lanes(text, tmp_path), steps=120).result == "time limit"


def test_drivers_brake_before_what_is_ahead() -> None:
    text = (
        "lane = filter(lambda l: l.centerline.length > 55, network.lanes)[0]\n"
        "ego = Car at lane.centerline.pointAlongBy(8), with behavior DriveAvoidingCollisions(10, 12)\n"
        "Car at lane.centerline.pointAlongBy(45)\n"
        "require always (distance from ego to lane.centerline.pointAlongBy(45)) > 4.6\n"
    )
    found = track(simulated(scenario(text)))
    assert max(speed for _, speed in found) > 6 and abs(found[-1][1]) < 0.5


def test_elements_that_are_not_there_reject_the_run() -> None:
    with pytest.raises(AttemptsExhausted) as told:
        scenario("ego = Car on road, with regionContainedIn None\nparam c = ego.laneGroup.bikeLane.uid\n").sample(max_attempts=20)
    assert "has no bike lane" in str(told.value.stuck)
    assert scenario("ego = Car on road\nparam c = ego.laneGroup._bikeLane is None\n").sample().params["c"] is True


WRONG_MAPS = {
    "no OpenDRIVE file": ("param map = localPath('map.net')\n", r"the map of a program is an OpenDRIVE file \(\.xodr\), not map\.net"),
    "not there": ("param map = localPath('none.xodr')\n", r"there is no map .*none\.xodr"),
    "broken": ("param map = localPath('broken.xodr')\n", "broken.xodr is no usable OpenDRIVE map: line 1: it is no XML"),
    "random": ("param map = Uniform('a.xodr', 'b.xodr')\n", r"the parameter map must be a text, or localPath\(a text\)"),
}


@pytest.mark.parametrize("name", WRONG_MAPS)
def test_a_wrong_map_is_an_error_where_it_is_named(name: str, tmp_path: Path) -> None:
    (tmp_path / "broken.xodr").write_text("<")
    text, message = WRONG_MAPS[name]
    with pytest.raises(ProgramError, match=message) as told:
        scenic_ref.loads(f"{text}{MODEL}ego = Car\n", directory=tmp_path).sample()
    assert (told.value.span.line, told.value.span.column) == (1, len("param map = ") + 1)


def test_mixins_make_objects_take_the_actions_of_vehicles_or_pedestrians() -> None:
    tug = "class Tug(DrivingObject{}):\n    width: 2\nego = Tug on road, with regionContainedIn None, with behavior Push\n"
    push = "behavior Push():\n    take SetThrottleAction(1)\n    take SetWalkingSpeedAction(1)\n"
    with pytest.raises(ProgramError, match="SetThrottleAction"):
        scenario(push + tug.format("")).simulate("kinematic", 2)
    with pytest.raises(ProgramError, match="SetWalkingSpeedAction"):
        scenario(push + tug.format(", Steers")).simulate("kinematic", 2)
    assert scenario(push + tug.format(", Steers, Walks")).simulate("kinematic", 2).simulation.moments[-1].step == 2
    found = scenario("ego = Car on road\nparam a = isinstance(ego, Steers), b = isinstance(ego, Walks), c = network.show()\n").sample().params
    assert (found["a"], found["b"], found["c"]) == (True, False, None)


ACTIONS = {
    "SetVelocityAction(3, 4).velocity": (3, 4), "SetVelocityAction((3, 4)).velocity": (3, 4),
    "SetVelocityAction(xVel=3, yVel=4, zVel=9).velocity": (3, 4), "SetReverseAction(True).reverse": True,
    "SetVelocityAction(3)": "xVel must be a vector, or yVel be given as well, not 3", "SetVelocityAction(3, 'a')": "yVel must be a number, not 'a'",
    "SetReverseAction('no')": "SetReverseAction: reverse must be True or False, not 'no'",
    "SetHandBrakeAction(3)": "SetHandBrakeAction: handBrake must be True or False, not 3",
}  # fmt: skip
"""Actions, and what they are or why they are refused."""


@pytest.mark.parametrize("action", ACTIONS)
def test_actions_take_what_the_library_says(action: str) -> None:
    found, program = ACTIONS[action], scenario(f"ego = Car on road\nparam x = {action}\n")
    if isinstance(found, str):
        with pytest.raises((ProgramError, UncaughtException), match=found):
            program.sample()
    else:
        assert program.sample().params["x"] == found


def test_what_is_beside_a_road_without_lanes_belongs_to_none() -> None:
    network = made_map("grid", one_way=True, sidewalks=True)
    loose = [walk for walk in network.sidewalks if walk._road is None]
    assert loose and any(walk._road is not None for walk in network.sidewalks)
    with pytest.raises(Absent, match="belongs to no road with lanes"):
        _ = loose[0].road


FORBIDDEN = {
    "network.lanes[0].road = None": "road|immutable", "x = Lane(uid='a')": "a Lane is made by reading a map", "x = network.by_uid": "by_uid",
    "x = network.lanes[0].polygon.wkt": "a shape has no attribute wkt",
}  # fmt: skip


@pytest.mark.parametrize("attack", FORBIDDEN)
def test_programs_cannot_change_or_forge_the_network(attack: str) -> None:
    with pytest.raises((ProgramError, UncaughtException), match=FORBIDDEN[attack]):
        scenario(f"ego = Car on road\n{attack}\n").sample()


def test_a_trajectory() -> None:
    path = Trajectory([(0, 0), (0, 10), [(10, 10)]])
    assert path.length == 20 and path.along((3, 4)) == 4 and path.along((9, 12), 14.0) == 19
    assert tuple(path.point(15)) == (5, 10) and tuple(path.point(25)) == (15, 10)
    assert path.steering((0, 0), 0.0, 1.0, 4.5, 0.0) == 0
    assert path.steering((1, 0), 0.0, 1.0, 4.5, 0.0) < 0 < path.steering((-1, 0), 0.0, 1.0, 4.5, 0.0)  # back onto the path
    assert path.speed_limit(0) < path.speed_limit(15)
    assert tuple(Trajectory([(0, 0), (0, 10)], reverse=True).point(0)) == (0, 10)
    with pytest.raises(ValueError, match="at least two different points"):
        Trajectory([(1, 1), (1, 1)])


def test_what_is_near() -> None:
    """A car ahead in the same lane, one behind, which is not seen, and a pedestrian: by the names of the released library."""
    text = (
        "behavior Look():\n"
        "    take (SetThrottleAction(1 if withinDistanceToAnyCars(self, 9) else 0), SetBrakeAction(1 if withinDistanceToAnyObjs(self, 9) else 0),\n"
        "          SetSteerAction(1 if withinDistanceToObjsInLane(self, 13) else 0), SetReverseAction(withinDistanceToAnyPedestrians(self, 12)))\n"
        "lane = filter(lambda l: l.centerline.length > 55, network.lanes)[0]\n"
        "ego = Car at lane.centerline.pointAlongBy(20), with behavior Look\n"
        "Car at lane.centerline.pointAlongBy({ahead})\nCar at lane.centerline.pointAlongBy(12)\n"
        "Pedestrian at lane.centerline.pointAlongBy({walker}), with regionContainedIn None\n"
    )
    for ahead, walker, told in ((32, 40, (1, 0, 1, False)), (28, 33, (1, 1, 1, True)), (34, 8, (1, 0, 0, False))):
        run = simulated(scenario(text.format(ahead=ahead, walker=walker)), steps=1)
        taken = run.moments[0].actions[0]
        assert tuple(next(iter(vars_of(action))) for action in taken) == told


def vars_of(action: object) -> list[object]:
    return [getattr(action, name) for name in ("throttle", "brake", "steer", "reverse") if hasattr(action, name)]


@pytest.mark.slow
def test_objects_are_points_to_the_network_and_subclasses_drive() -> None:
    """An object is interpreted as a vector where one is expected (the paper, Section "Data Types")."""
    text = (
        "class Scooter(Car):\n    width: 0.8\n    length: 1.8\nclass Child(Pedestrian):\n    width: 0.4\n"
        "lane = Uniform(*network.lanes)\nego = Scooter on lane.centerline, with behavior FollowLaneBehavior(5)\n"
        "Child on sidewalk, with behavior WalkForwardBehavior\n"
        "param a = network.laneAt(ego) is ego.lane, b = lane.sectionAt(ego) is not None, c = network.nominalDirectionsAt(ego)[0]\n"
    )
    program = scenario(text)
    one_by_one, many = (list(program.sample_many(12, 1, backend=backend)) for backend in ("interpreter", "batch"))
    assert [s.to_json() for s in one_by_one] == [s.to_json() for s in many]
    assert all(scene.params["a"] and scene.params["b"] for scene in many)
    run = simulated(program, steps=40)
    assert track(run)[-1][1] > 4 and abs(track(run, 1)[-1][1] - 0.5) < 1e-6


SIMULATORS = ["kinematic", pytest.param("pymunk", marks=pytest.mark.extra("dynamics"))]
LIBRARY = """model scenic.domains.driving.model
behavior Controlled():
    take RegulatedControlAction({throttle}, {steer}, 0)
    while True:
        wait
ego = Car at (0, 0), facing {heading} deg, with speed 10, with behavior Controlled, with regionContainedIn everywhere
"""


@pytest.mark.slow
@pytest.mark.parametrize("simulator", SIMULATORS)
def test_regulated_controls_brake_and_do_not_jump(simulator):
    """A negative throttle is a brake of at most 0.5 (the release has 0 there); steering changes by at most 0.1 at a time."""

    def speed(throttle: float) -> float:
        text = LIBRARY.format(throttle=throttle, steer=0, heading=0)
        return scenic_ref.loads(text).simulate(simulator, 10).simulation.moments[-1].objects[0]["speed"]  # type: ignore[return-value]

    assert speed(-5) == pytest.approx(speed(-0.5))
    assert speed(-0.5) < speed(-0.2) < 9.5
    assert speed(5) == pytest.approx(speed(0.5))
    assert speed(0.5) > 10.5
    texts = {steer: LIBRARY.format(throttle=0.1, steer=steer, heading=0) for steer in (1, 0.1, 0.05)}
    ends = {steer: scenic_ref.loads(text).simulate(simulator, 5).simulation.moments[-1] for steer, text in texts.items()}
    steered = {steer: end.objects[0]["heading"] for steer, end in ends.items()}
    assert steered[1] == steered[0.1] < steered[0.05] < 0


def test_what_controls_ask_for_is_checked():
    from scenic_ref.simulators.actions import RegulatedControlAction

    assert RegulatedControlAction(-0.3, -1, -0.75, max_steer=0.8).regulated == (0.0, 0.3, -0.8)
    assert RegulatedControlAction(0.9, 0.5, 0.2).regulated == pytest.approx((0.5, 0.0, 0.3))
    with pytest.raises(ValueError, match="past_steer must be a number"):
        RegulatedControlAction(0, 0, None)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="max_brake must be a number from 0 to 1, not 2"):
        RegulatedControlAction(0, 0, 0, max_brake=2)


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_an_offset_is_along_the_object(simulator):
    text = """from scenic.domains.driving.actions import *
behavior Jump():
    take OffsetAction(1 @ 5)
ego = Object at (2, 3), facing 90 deg, with behavior Jump
"""
    place = scenic_ref.loads(text).simulate(simulator, 1).simulation.moments[-1].objects[0]["position"]
    assert (place.x, place.y) == pytest.approx((-3, 4))  # type: ignore[attr-defined]


def test_lines_are_put_together():
    text = """model scenic.domains.driving.model
maneuver = network.intersections[0].maneuvers[0]
ways = [maneuver.startLane, maneuver.connectingLane, maneuver.endLane]
line = concatenateCenterlines([way.centerline for way in ways])
ego = Car on line, with length line.length, with all sum([way.centerline.length for way in ways]), with regionContainedIn everywhere
require ego.position in line
"""
    ego = scenic_ref.loads(text).sample().ego
    assert ego.length == pytest.approx(ego["all"])


def test_a_program_without_a_map_is_told_that_it_is_on_the_default_one(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    from scenic_ref.api.program_loader import load
    from scenic_ref.simulators.worlds.driving import ON_DEFAULT_MAP, notes

    del capsys
    program = tmp_path / "p.scenic"
    program.write_text("model scenic.domains.driving.model\nego = Car\n")
    scenario = load(program)
    assert notes(scenario.settings.library, scenario.program, {}) == [f"note: {ON_DEFAULT_MAP}"]
    assert notes(scenario.settings.library, scenario.program, {"map": "town.xodr"}) == []
