"""The dynamic and compositional listings of the paper, completed for a straight street, run in every simulator."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.interpreter.simulating import Simulated

LISTINGS = sorted((Path(__file__).parent.parent.parent / "examples" / "paper" / "dynamic").glob("*.scenic"))
READINGS = {"pulling_ahead": {"interrupt-first-step": "later-steps"}}
STEPS = 90


def simulated(name: str, simulator: str, steps: int = STEPS, seed: int = 0) -> Simulated:
    if simulator == "pymunk":
        pytest.importorskip("pymunk")
    path = next(p for p in LISTINGS if p.stem == name)
    scenario = scenic_ref.load(path, readings=READINGS.get(name, {}))
    return scenario.simulate(simulator, steps, seed, max_attempts=60).simulation


@pytest.mark.parametrize("simulator", ["kinematic", "pymunk"])
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
