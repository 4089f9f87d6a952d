"""Actions and behaviors take the arguments of the released ones by their names (`inspect.signature` of Scenic 3.1.1), and are asked alike."""

from __future__ import annotations

import inspect

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import ProgramError
from scenic_ref.simulators.actions import ACTIONS

MODEL = "model scenic.domains.driving.model\n"
RELEASED_ACTIONS = {
    "SetPositionAction": "pos", "OffsetAction": "offset", "SetVelocityAction": "xVel, yVel, zVel=0", "SetSpeedAction": "speed",
    "SetThrottleAction": "throttle", "SetSteerAction": "steer", "SetBrakeAction": "brake", "SetHandBrakeAction": "handBrake",
    "SetReverseAction": "reverse", "SetWalkingDirectionAction": "heading", "SetWalkingSpeedAction": "speed",
    "RegulatedControlAction": "throttle, steer, past_steer, max_throttle=0.5, max_brake=0.5, max_steer=0.8",
}  # fmt: skip
RELEASED_BEHAVIORS = {
    "ConstantThrottleBehavior": "x=0.1", "DriveAvoidingCollisions": "target_speed=25, avoidance_threshold=10", "AccelerateForwardBehavior": "",
    "WalkForwardBehavior": "", "FollowLaneBehavior": "target_speed=10, laneToFollow=None, is_oppositeTraffic=False",
    "FollowTrajectoryBehavior": "target_speed=10, trajectory=network.lanes[:1], turn_speed=None",
    "TurnBehavior": "trajectory=network.lanes[:1], target_speed=6",
    "LaneChangeBehavior": "laneSectionToSwitch=network.lanes[0].sections[0], is_oppositeTraffic=False, target_speed=10",
}  # fmt: skip


@pytest.mark.parametrize("name", RELEASED_ACTIONS)
def test_arguments_of_actions_have_the_released_names(name):
    ours = inspect.signature(ACTIONS[name]).parameters.values()
    expected = [part.partition("=") for part in RELEASED_ACTIONS[name].split(", ")]
    assert [p.name for p in ours] == [known for known, _, _ in expected]
    assert all(str(p.default) == default for p, (_, _, default) in zip(ours, expected, strict=True) if default)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", RELEASED_BEHAVIORS)
def test_arguments_of_behaviors_have_the_released_names(name):
    agent = "Pedestrian on network.sidewalks[0]" if name == "WalkForwardBehavior" else "Car at network.lanes[0].centerline.pointAlongBy(5)"
    text = f"{MODEL}ego = {agent}, with behavior {name}({RELEASED_BEHAVIORS[name]})\n"
    run = scenic_ref.loads(text).simulate("kinematic", steps=2, seed=0)
    assert any(moment.actions[i] for moment in run.simulation.moments[:2] for i in moment.actions)


def simulated(body: str, steps: int = 2):
    text = f"{MODEL}behavior B():\n    {body}\nego = Car on road, with behavior B\nwalker = Pedestrian\n"
    return scenic_ref.loads(text).simulate("kinematic", steps=steps, seed=0).simulation


@pytest.mark.parametrize("where", ["pos=(1, 2)", "[1, 2]", "Point at (1, 2)", "OrientedPoint at (1, 2)", "1 @ 2"])
def test_an_action_takes_whatever_has_a_position(where):
    moved = simulated(f"take SetPositionAction({where})").moments[1].objects[0]
    assert (moved["position"].x, moved["position"].y) == (1.0, 2.0)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("action", "agent", "can"),
    [
        ("SetThrottleAction(1)", "ego", True), ("SetThrottleAction(1)", "walker", False), ("SetWalkingSpeedAction(1)", "walker", True),
        ("SetWalkingSpeedAction(1)", "ego", False), ("SetSpeedAction(1)", "walker", True), ("SetBrakeAction(1)", "Object at (99, 99)", False),
        ("SetBrakeAction(1)", "Pedestrian with drives True", True),
    ],
)  # fmt: skip
def test_an_action_can_be_asked_who_takes_it(action, agent, can):
    text = f"{MODEL}ego = Car\nwalker = Pedestrian\nother = {agent}\nparam can = {action}.canBeTakenBy(other)\n"
    assert scenic_ref.loads(text).sample(seed=0).params["can"] is can


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("take SetWalkingSpeedAction(-1)", r"0 or more \(SetWalkingDirectionAction turns a pedestrian round\), not -1"),
        ("take SetHandBrakeAction(handbrake=True)", "has no parameter handbrake"),
        ("take SetPositionAction((1, 2, 3))", r"pos must be a vector, not \(1, 2, 3\)"),
        ("take SetBrakeAction(1) if SetBrakeAction(1).canBeTakenBy(3) else 1", r"canBeTakenBy\(agent\) takes an object, not a scalar"),
        ("do FollowTrajectoryBehavior(trajectory=[self, self])", "a trajectory needs at least two different points"),
    ],
)
def test_what_is_wrong_with_an_argument_is_said(body, said):
    with pytest.raises(ProgramError, match=said):
        simulated(body)


@pytest.mark.parametrize("path", ["self.lane", "self.lane.centerline", "[self.lane]", "[self, self.lane.centerline[-1]]"])
def test_a_trajectory_may_be_a_lane_or_a_line_itself(path):
    run = simulated(f"do FollowTrajectoryBehavior(5, {path})", steps=20)
    assert run.moments[-1].objects[0]["speed"] > 2
