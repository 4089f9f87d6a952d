"""The dynamic and compositional listings of the paper, completed for a straight street, run in every simulator."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.simulators.simulating import Simulated

LISTINGS = sorted((Path(__file__).parent.parent.parent / "examples" / "paper" / "dynamic").glob("*.scenic"))
READINGS = {"pulling_ahead": {"interrupt-first-step": "later-steps"}}
STEPS = 90
SIMULATORS = ["kinematic", pytest.param("pymunk", marks=pytest.mark.extra("dynamics"))]


def simulated(name: str, simulator: str, steps: int = STEPS, seed: int = 0) -> Simulated:
    path = next(p for p in LISTINGS if p.stem == name)
    scenario = scenic_ref.load(path, readings=READINGS.get(name, {}))
    return scenario.simulate(simulator, steps, seed, max_attempts=60).simulation


@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("name", [p.stem for p in LISTINGS])
def test_the_listing_runs(name, simulator):
    run = simulated(name, simulator)
    assert len(run.moments) > 10
    assert any(moment.actions for moment in run.moments)


def test_every_listing_is_in_the_manifest():
    text = (LISTINGS[0].parent / "README.md").read_text()
    assert all(f"`{p.name}`" in text for p in LISTINGS)


def speeds(run: Simulated, number: int = 0) -> list[float]:
    return [float(moment.objects[number]["speed"]) for moment in run.moments]  # type: ignore[arg-type]


def test_what_the_paper_says_about_them():
    waits = simulated("wait_until_close", "kinematic")
    assert speeds(waits, 1)[10] == 0 < speeds(waits, 1)[-1]
    brake = simulated("drive_with_sudden_brake", "kinematic", 160)
    stopped = [k for k, v in enumerate(speeds(brake)) if k > 5 and v == 0]
    assert 30 < len(stopped) < 50  # five seconds, less those of braking
    assert speeds(brake)[-1] > 5
    turn = simulated("approach_and_turn_left", "kinematic", 160)
    assert abs(float(turn.moments[-1].objects[0]["heading"])) > 0.3  # type: ignore[arg-type]
    end = simulated("terminate_when", "kinematic", 300)
    assert end.result == "terminated"
    assert len(simulated("parked_cars", "kinematic").moments[-1].objects) == 3
    override = simulated("pulling_ahead", "kinematic")
    assert len(override.moments[-1].objects) == 3
    pedestrian = simulated("avoid_pedestrian", "kinematic", 120)
    brakes = [a.brake for m in pedestrian.moments for a in m.actions.get(0, ()) if type(a).__name__ == "SetBrakeAction" and a.brake]
    assert len(set(brakes)) > 3
    assert all(0.5 <= brake <= 1 for brake in brakes)


def behaviors_in(run: Simulated) -> set[str]:
    """The innermost behaviors that the first object was in, by name."""
    return {text.split(" > ")[-1].split("(")[0] for moment in run.moments for id, text in moment.doing.items() if id == 0}


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_a_car_drives_to_its_lane_and_stays_there(simulator):
    """From the right lane to the left one, and back."""
    for start, lane in ((1.75, -1.75), (-1.75, 1.75)):
        text = f"model street\nego = Car at ({start}, 0), with behavior FollowLaneBehavior(8, {lane})"
        run = scenic_ref.loads(text).simulate(simulator, 150).simulation
        places = [moment.objects[0]["position"].x for moment in run.moments]  # type: ignore[attr-defined]
        assert max(map(abs, places)) < 2
        assert places[-1] == pytest.approx(lane, abs=0.05)
        assert run.moments[-1].objects[0]["position"].y > 60  # type: ignore[attr-defined]


def test_listings_come_to_their_point():
    """What each is about happens: merging and recovering, passing and avoiding, stopping behind."""
    guards = simulated("preconditions_and_invariants", "kinematic", 200)
    assert {"FollowLaneBehavior", "FollowRoad"} <= behaviors_in(guards)
    assert any("GetBackOntoRoad" in text for moment in guards.moments for text in moment.doing.values())
    drive = simulated("drive", "kinematic", 250)
    assert {"FollowLaneBehavior", "StopBehavior"} <= behaviors_in(drive)
    ego, obstacle = (drive.moments[-1].objects[k]["position"] for k in (0, 1))
    assert ego.y > obstacle.y + 20  # type: ignore[attr-defined]
    assert abs(ego.x - 1.75) < 0.2  # type: ignore[attr-defined]
    stops = simulated("follow_avoiding_obstacles", "kinematic", 120)
    assert speeds(stops)[-1] == 0
