"""What each dynamic listing is about happens in its program: the interrupt, the violated guard, the rejected run, the choice, the override."""

from __future__ import annotations

import math

import pytest
import shapely
from scenic_ref.data.simulation import Moment, Simulated
from scenic_ref.simulators.actions import SetBrakeAction, SetThrottleAction
from scenic_ref.simulators.worlds.driving import default_network
from shapely.geometry import Point

from .listed import FOLDER, SIMULATORS, apart, avenue, boxes, doing, off_lanes, place, simulated, speed, within

both_simulators = pytest.mark.parametrize("simulator", SIMULATORS)
SEEDS = range(4)


def first(run: Simulated, number: int) -> Moment | None:
    """The first time step in which an object acts."""
    return next((moment for moment in run.moments if moment.actions.get(number)), None)


def steps_of(run: Simulated, event: str) -> list[int]:
    """The time steps in which something happens."""
    return [moment.step for moment in run.moments if any(event in told for told in moment.events)]


def line_of(file: str, text: str) -> int:
    """The number of the first line of a program with a text in it."""
    return next(n for n, line in enumerate((FOLDER / file).read_text("utf-8").splitlines(), 1) if text in line)


def fires(run: Simulated, kind: str, file: str, text: str) -> list[int]:
    """The time steps in which a construct of the program fires: of a kind, in the line with a text."""
    return steps_of(run, f"{kind} (line {line_of(file, text)})")


@both_simulators
def test_a_car_with_the_behavior_follows_its_lane(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("follow_lane.scenic", simulator, seed)
        assert {speed(moment, 1) for moment in run.moments} == {0}
        assert max(speed(moment) for moment in run.moments) > 6
        assert all(off_lanes(default_network(), place(moment)) < 0.9 for moment in run.moments[60:])


@both_simulators
def test_the_simplified_behavior_finds_its_lane(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("simplified_lane_following.scenic", simulator, seed)
        assert off_lanes(avenue(), place(run.moments[-1])) < 0.1
        assert 7 < speed(run.moments[-1]) < 9
        assert type(run.moments[5].actions[0][0]) is SetThrottleAction


@both_simulators
def test_a_car_waits_until_ego_is_close(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("wait_until_close.scenic", simulator, seed)
        begin = first(run, 1)
        assert begin is not None and begin.step > 10
        assert all((apart(moment, 0, 1) > 15) == (moment.step < begin.step) for moment in run.moments[: begin.step + 1])
        assert speed(run.moments[-1], 1) > 6


@both_simulators
def test_each_copy_of_a_behavior_has_its_own_threshold(simulator: str) -> None:
    drives: dict[int, set[bool]] = {1: set(), 2: set()}
    for seed in range(14):
        run, _ = simulated("two_thresholds.scenic", simulator, seed)
        for number, threshold in ((1, 15), (2, 20)):
            begin = first(run, number)
            near = next((moment.step for moment in run.moments[:-1] if apart(moment, 0, number) <= threshold), None)
            assert (None if begin is None else begin.step) == near
            drives[number].add(near is not None)
    assert drives == {1: {True, False}, 2: {True, False}}


@both_simulators
def test_braking_for_a_pedestrian_is_random_each_time(simulator: str) -> None:
    nearest, farthest = [], []
    for seed in range(6):
        run, _ = simulated("avoid_pedestrian.scenic", simulator, seed)
        taken = [(apart(moment, 0, 1), moment.actions[0][0]) for moment in run.moments[:-1]]
        brakes = [(far, action.brake) for far, action in taken if isinstance(action, SetBrakeAction)]
        free = [far for far, action in taken if isinstance(action, SetThrottleAction)]
        assert len({brake for _, brake in brakes}) == len(brakes) > 3
        assert all(0.5 <= brake <= 1 for _, brake in brakes)
        assert min(free) >= 4 and max(far for far, _ in brakes) < min(7.0, min(free))
        assert speed(run.moments[-1]) > 2
        nearest.append(min(free))
        farthest.append(max(far for far, _ in brakes))
    assert max(farthest) > min(nearest) + 1  # the threshold is drawn once for each run


@both_simulators
def test_the_interrupt_fires_while_something_is_near(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("follow_avoiding_obstacles.scenic", simulator, seed)
        near = [moment.step for moment in run.moments[:-1] if apart(moment, 0, 1) < 5]
        assert 2 < len(near) < 40
        assert fires(run, "interrupt", "follow_avoiding_obstacles.scenic", "interrupt when") == near
        for moment in run.moments[:-1]:
            assert (moment.actions[0] == (SetBrakeAction(1),)) == (moment.step in near)
        assert speed(run.moments[-1]) > 8


@pytest.mark.slow
@both_simulators
def test_an_interrupt_of_higher_priority_interrupts_a_handler(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("drive.scenic", simulator, seed)
        stages = [names[1] for _, names in doing(run) if len(names) > 1]
        order = [stage for before, stage in zip(["", *stages], stages, strict=False) if stage != before]
        passing = [k for k, stage in enumerate(order) if stage == "PassingBehavior"]
        assert len(passing) > 1  # it goes on where it was
        assert set(order[passing[0] : passing[-1] + 1]) == {"PassingBehavior", "CollisionAvoidance"}
        assert order[: 2] == ["FollowLaneBehavior", "CollisionAvoidance"] and order[-1] == "FollowLaneBehavior"
        begin = next(step for step, names in doing(run) if "PassingBehavior" in names)
        assert apart(run.moments[begin], 0, 1) - 4.5 < 20.1
        last = run.moments[-1]
        assert apart(last, 0, 1) > 20 and off_lanes(avenue(), place(last)) < 0.5
        lanes = [avenue().laneAt(place(moment)) for moment in run.moments]
        assert lanes[0] is lanes[-1] and len(set(lanes)) == 2


@both_simulators
def test_the_car_waits_at_the_light_and_turns_left(simulator: str) -> None:
    network, waited = default_network(), 0
    for seed in SEEDS:
        run, _ = simulated("approach_and_turn_left.scenic", simulator, seed)
        lane = network.laneAt(place(run.moments[0]))
        assert lane is not None
        inter = lane.maneuvers[0].intersection
        assert inter is not None
        [abort] = fires(run, "abort", "approach_and_turn_left.scenic", "abort    #")
        assert inter.polygon.distance(Point(*place(run.moments[abort]))) < 10 <= inter.polygon.distance(Point(*place(run.moments[abort - 1])))
        enters = next(moment.step for moment in run.moments if inter.contains_point(place(moment)))
        leaves = next(step for step, names in doing(run) if "TurnLeftBehavior" in names)
        assert lane.trafficLight.stateAt(leaves * 0.1) == "green"
        for moment in run.moments[abort:leaves]:
            assert lane.trafficLight.stateAt(moment.step * 0.1) != "green"
        waited += min(speed(moment) for moment in run.moments[abort:enters]) < 0.05
        ends = {m.endLane for m in lane.maneuvers if m.type.name == "LEFT_TURN"}
        assert any(network.laneAt(place(moment)) in ends for moment in run.moments)
    assert waited >= 2


@both_simulators
def test_the_short_form_does_the_same(simulator: str) -> None:
    for seed in SEEDS:
        one, other = (simulated(f"{name}.scenic", simulator, seed)[0] for name in ("approach_and_turn_left", "approach_and_turn_left_for_short"))
        assert [moment.objects for moment in one.moments] == [moment.objects for moment in other.moments]


@both_simulators
def test_a_behavior_is_over_after_its_time(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("drive_for_a_while.scenic", simulator, seed)
        assert [bool(moment.actions) for moment in run.moments] == [True] * 300 + [False] * 11
        assert fires(run, "abort", "drive_for_a_while.scenic", "30 seconds") == [300]


@both_simulators
def test_the_sudden_brake_is_once_and_five_seconds_long(simulator: str) -> None:
    for seed in SEEDS:
        run, _ = simulated("drive_with_sudden_brake.scenic", simulator, seed)
        stops = [step for step, names in doing(run) if "StopBehavior" in names]
        assert stops == list(range(stops[0], stops[0] + 50))
        assert fires(run, "interrupt", "drive_with_sudden_brake.scenic", "targetRegion and") == [stops[0]]
        assert min(speed(moment) for moment in run.moments[stops[0] : stops[-1]]) < 0.05
        assert speed(run.moments[-1]) > 8


@pytest.mark.slow
@both_simulators
def test_stops_come_at_times_that_are_drawn_anew(simulator: str) -> None:
    delays = []
    for seed in range(2):
        run, _ = simulated("drive_with_random_stops.scenic", simulator, seed)
        begins = fires(run, "interrupt", "drive_with_random_stops.scenic", "last_stop > delay")
        stops = [step for step, names in doing(run) if "StopBehavior" in names]
        assert stops == [step for begin in begins for step in range(begin, begin + 50)] and len(begins) >= 2
        delays += [begins[0], begins[1] - begins[0] - 50]
    assert all(150 < delay <= 301 for delay in delays) and len(set(delays)) == len(delays)


def sees(run: Simulated, moment: Moment, number: int) -> bool:
    """Whether ego's view, a sector of 90 degrees and 50 m, meets the box of another object."""
    x, y = place(moment)
    turns = [float(moment.objects[0]["heading"]) + math.radians(k - 45) for k in range(91)]  # type: ignore[arg-type]
    view = shapely.Polygon([(x, y), *((x - 50 * math.sin(turn), y + 50 * math.cos(turn)) for turn in turns)])
    return view.intersects(boxes(run, moment)[number])


@both_simulators
def test_never_are_both_cars_visible(simulator: str) -> None:
    rejected, one = 0, 0
    for seed in range(8):
        run, stuck = simulated("never_both_visible.scenic", simulator, seed)
        seen = [(sees(run, moment, 1), sees(run, moment, 2)) for moment in run.moments]
        assert (True, True) not in seen
        one += (True, False) in seen or (False, True) in seen
        rejected += stuck["always"]
        assert set(stuck) <= {"always"}
    assert rejected > 2 and one > 2


@both_simulators
def test_ego_enters_an_intersection_at_some_time(simulator: str) -> None:
    rejected = 0
    for seed in SEEDS:
        run, stuck = simulated("enters_an_intersection.scenic", simulator, seed)
        area = default_network().intersectionRegion.closed  # type: ignore[attr-defined]
        assert any(within(run, moment, area) for moment in run.moments)
        rejected += stuck["eventually"]
    assert rejected > 2


@both_simulators
def test_no_pedestrian_is_close_until_ego_is(simulator: str) -> None:
    rejected, later = 0, 0
    for seed in range(8):
        run, stuck = simulated("no_pedestrian_until_close.scenic", simulator, seed)
        begin = first(run, 1)
        assert begin is not None and all(apart(moment, 1, 2) > 15 for moment in run.moments[: begin.step])
        later += any(apart(moment, 1, 2) <= 15 for moment in run.moments[begin.step :])
        rejected += stuck["require"]
    assert rejected > 2 and later > 0


@pytest.mark.slow
@both_simulators
def test_the_monitor_rejects_other_orders(simulator: str) -> None:
    area = default_network().intersectionRegion.closed  # type: ignore[attr-defined]
    rejected = 0
    for seed in range(3):
        run, stuck = simulated("car_c_enters_last.scenic", simulator, seed)
        a, b, c = (next((m.step for m in run.moments if within(run, m, area, number)), None) for number in range(3))
        assert a is not None and b is not None and c is not None and max(a, b) < c
        rejected += stuck["require"]
    assert rejected > 0


@both_simulators
def test_the_precondition_chooses_the_lane(simulator: str) -> None:
    attempts = 0
    for seed in range(6):
        run, stuck = simulated("merge_into.scenic", simulator, seed)
        assert set(stuck) <= {"guard"}
        attempts += 1 + stuck["guard"]
        before, after = (avenue().laneAt(place(moment)) for moment in (run.moments[0], run.moments[-1]))
        assert before is not None and after is not None
        assert before is before.group.lanes[0] and after is before.group.lanes[1]
        assert off_lanes(avenue(), place(run.moments[-1])) < 0.6
    assert attempts > 10  # two of three lanes violate it


@both_simulators
def test_the_violated_invariant_is_caught(simulator: str) -> None:
    for seed in SEEDS:
        run, stuck = simulated("drive_with_recovery.scenic", simulator, seed)
        assert not stuck
        stages = [names[1] for _, names in doing(run) if len(names) > 1]
        order = [stage for before, stage in zip(["", *stages], stages, strict=False) if stage != before]
        assert order == ["FollowLaneBehavior", "CollisionAvoidance", "GetBackOntoRoad", "FollowLaneBehavior"]
        road = default_network().drivableRegion.closed  # type: ignore[attr-defined]
        begin = next(step for step, names in doing(run) if "GetBackOntoRoad" in names)
        assert not within(run, run.moments[begin], road) and within(run, run.moments[-1], road)


@both_simulators
def test_the_simulation_ends_after_fifty_metres(simulator: str) -> None:
    results = set()
    for seed in range(5):
        run, _ = simulated("terminate_when.scenic", simulator, seed)
        far = [abs(complex(*(place(moment) - place(run.moments[0])))) >= 50 for moment in run.moments]
        assert far == [False] * (len(far) - 1) + [run.result == "terminated"]
        results.add(run.result)
    assert "terminated" in results


@pytest.mark.slow
@both_simulators
def test_the_monitor_ends_the_simulation(simulator: str) -> None:
    area = default_network().intersectionRegion.closed  # type: ignore[attr-defined]
    for seed in range(3):
        run, _ = simulated("stop_after_time_in_intersection.scenic", simulator, seed)
        assert run.result == "terminated" and "monitor" in run.reason
        assert sum(within(run, moment, area) for moment in run.moments[:-1]) == 30
