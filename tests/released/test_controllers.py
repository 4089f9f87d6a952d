"""Controllers of the driving library: on sequences of errors they answer what those of the releases do (`record_controllers.py` wrote that down)."""

from __future__ import annotations

import json
from typing import Any

import pytest
import scenic_ref
from scenic_ref.errors import RunError
from scenic_ref.simulators import by_name

from .record_controllers import ERRORS, OWN, RECORD

TOLD: list[Any] = json.loads(RECORD.read_text(encoding="utf-8"))
"""The same of both releases; 2.1.0 has time steps of 0.1 s only."""
VEHICLES = (("Car", 0.1), ("Car", 0.25), ("Van", 0.1), ("Van", 0.25))
MODEL = "model scenic.domains.driving.model\n"
ASK = f"""{MODEL}class Van(Vehicle):
    pass
behavior Ask():
    pairs = [simulation().getLaneFollowingControllers(self), simulation().getTurningControllers(self), simulation().getLaneChangingControllers(self)]
    for error in globalParameters.errors:
        take [c.run_step(error) for pair in pairs for c in pair]
"""


def actions(text: str, timestep: float, errors: tuple[float, ...]) -> list[tuple[float, ...]]:
    """What an agent takes in each time step, of a simulator for which any number is an action."""
    scenario = scenic_ref.loads(text, dialect="scenic-2.1", params={"errors": errors})
    run = scenario.simulate(by_name("still", timestep), len(errors)).simulation
    return [moment.actions[0] for moment in run.moments[: len(errors)]]  # type: ignore[misc]


@pytest.mark.parametrize("number", range(len(VEHICLES)))
def test_the_controllers_of_a_simulation_answer_as_those_of_the_releases(number: int) -> None:
    kind, timestep = VEHICLES[number]
    taken = actions(f"{ASK}ego = {kind} on road, with behavior Ask, with regionContainedIn None\n", timestep, ERRORS)
    assert list(zip(*taken, strict=True)) == [pytest.approx(answers, abs=1e-9) for answers in TOLD[len(OWN) + number]]


@pytest.mark.parametrize("number", range(len(OWN)))
def test_controllers_with_gains_of_their_own_answer_as_those_of_the_releases(number: int) -> None:
    name, options = OWN[number]
    text = (
        "from scenic.domains.driving.controllers import *\n"
        f"behavior Ask():\n    one = {name}(**{options!r})\n    for error in globalParameters.errors:\n        take one.run_step(error)\n"
        "ego = Object with behavior Ask\n"
    )
    assert [a for (a,) in actions(text, 1.0, ERRORS)] == pytest.approx(TOLD[number], abs=1e-9)


def test_each_use_of_a_simulation_makes_new_controllers() -> None:
    text = f"{MODEL}behavior Ask():\n    for k in range(3):\n        take simulation().getLaneFollowingControllers(self)[1].run_step(0.3)\n"
    assert actions(f"{text}ego = Car on road, with behavior Ask\n", 0.1, (0.0,) * 3) == [(pytest.approx(0.3306),)] * 3


def test_controllers_keep_a_car_in_its_lane() -> None:
    """As the releases' own behaviors do: the car is steered back to the middle of its lane, and reaches the speed."""
    text = f"""{MODEL}behavior Drive():
    throttle, steering = simulation().getLaneFollowingControllers(self)
    past = 0
    while True:
        steer = steering.run_step(lane.centerline.signedDistanceTo(self.position))
        take RegulatedControlAction(throttle.run_step(8 - self.speed), steer, past)
        past = steer
lane = filter(lambda l: l.centerline.length > 55, network.lanes)[0]
start = OrientedPoint at lane.centerline.pointAlongBy(4), facing roadDirection
ego = Car at start offset by 0.8 @ 0, with behavior Drive, with regionContainedIn None
require always abs(lane.centerline.signedDistanceTo(ego.position)) < 0.9
record final abs(lane.centerline.signedDistanceTo(ego.position)) as aside
record final ego.speed as speed
"""
    run = scenic_ref.loads(text, dialect="scenic-2.1").simulate("kinematic", 60).simulation
    recorded = {name: values[-1][1] for name, values in run.records.items()}
    print(recorded)
    assert recorded["aside"] < 0.3 and recorded["speed"] == pytest.approx(8, abs=1)  # type: ignore[operator]


def test_a_simulation_has_no_controllers_away_from_roads() -> None:
    text = "behavior B():\n    simulation().getTurningControllers(self)\n    wait\nego = Object with behavior B\n"
    with pytest.raises(RunError, match="`simulation` has no getTurningControllers") as told:
        scenic_ref.loads(text).simulate("still", 1)
    assert told.value.hint == "it has currentTime, currentRealTime, timestep, objects; those of roads come with `model scenic.domains.driving.model`"
