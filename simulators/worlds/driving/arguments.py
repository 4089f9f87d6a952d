"""Checks of the arguments of behaviors, scenarios, controllers and functions in the driving library."""

from __future__ import annotations

from collections.abc import Mapping

from ....roads.network import Intersection, Lane, LaneSection, LinearElement, Signal
from ....semantics.machine.operand_kinds import is_object
from ....semantics.machine.values import Dynamic, Instance
from ....semantics.space.regions import PolylineRegion, Region
from ....semantics.space.vectors import Vector
from ...actions import DISTANCE, NUMBER, SHARE, SPEED, TRUTH, Wanted, check_action_arguments, is_finite_scalar, is_vector


def is_way(value: object) -> bool:
    """Whether a value is a lane, a line, or a list of these and of points."""
    if isinstance(value, (list, tuple)):
        return len(value) > 0 and all(isinstance(part, (Vector, Instance)) or is_vector(part) or is_way(part) for part in value)
    return isinstance(value, (LinearElement, PolylineRegion))


def is_driven(value: object) -> bool:
    """Whether a value is an object that can be asked for its lane."""
    return OBJECT.admits(value) and any("_lane" in one.methods for one in value.class_.lineage)  # type: ignore[attr-defined]


def is_scenarios(value: object) -> bool:
    """Whether a value is a list of scenarios from which one can be picked by the place."""
    return isinstance(value, (list, tuple)) and len(value) > 1 and all(isinstance(part, Dynamic) for part in value)


OBJECT = Wanted("an object", lambda value: isinstance(value, Instance) and is_object(value))
PLACE = Wanted("an object, a point or a region", lambda value: isinstance(value, (Instance, Vector, Region)) or is_vector(value))
LANE = Wanted("a lane", lambda value: isinstance(value, Lane))
SECTION = Wanted("a section of a lane, such as lane.sections[0]", lambda value: isinstance(value, LaneSection))
WAY = Wanted("a lane, a line, or a list of lanes, lines and points", is_way)
TRAIL = Wanted("a Trail", lambda value: type(value).__name__ == "Trail")
LIGHT = Wanted("a traffic light, such as lane.trafficLight", lambda value: isinstance(value, Signal) and value.isTrafficLight)
SIGNAL = Wanted("a signal of the map, such as lane.trafficLight", lambda value: isinstance(value, Signal))
COLOR = Wanted("'green', 'yellow' or 'red'", lambda value: value in ("green", "yellow", "red"))
INTERSECTION = Wanted("an intersection", lambda value: isinstance(value, Intersection))
SCENARIOS = Wanted("a list of two scenarios or more", is_scenarios)
DRIVEN = Wanted("a vehicle, a pedestrian or another object of the driving library", is_driven)
STEP = Wanted("a number of seconds, more than 0", lambda value: is_finite_scalar(value) and value > 0)  # type: ignore[operator]
GAINS = {"K_P": NUMBER, "K_D": NUMBER, "K_I": NUMBER, "dt": STEP}

WANTED: Mapping[str, Mapping[str, Wanted]] = {
    "ConstantThrottleBehavior": {"x": SHARE},
    "FollowTrajectoryBehavior": {"target_speed": SPEED, "trajectory": WAY, "turn_speed": SPEED.or_none()},
    "TurnBehavior": {"trajectory": WAY, "target_speed": SPEED},
    "FollowLaneBehavior": {"target_speed": SPEED, "laneToFollow": LANE.or_none(), "is_oppositeTraffic": TRUTH},
    "LaneChangeBehavior": {"laneSectionToSwitch": SECTION, "is_oppositeTraffic": TRUTH, "target_speed": SPEED},
    "DriveAvoidingCollisions": {"target_speed": SPEED, "avoidance_threshold": DISTANCE},
    "WalkForwardBehavior": {"speed": SPEED},
    "WalkAlongSidewalkBehavior": {"speed": SPEED},
    "CrossingBehavior": {"reference_actor": PLACE, "min_speed": SPEED, "threshold": DISTANCE, "final_speed": SPEED.or_none()},
    "PassingBehavior": {"target_speed": SPEED},
    "WaitForTrafficLightBehavior": {"target_speed": SPEED},
    "FollowLaneObeyingTrafficLights": {"target_speed": SPEED},
    "LeadAlong": {"trail": TRAIL, "speed": SPEED},
    "FollowTrail": {"trail": TRAIL, "speed": SPEED},
    "KeepAway": {"trail": TRAIL, "speed": SPEED},
    "CloseUpAndFallBack": {"leader": OBJECT, "trail": TRAIL, "speed": SPEED},
    "PullOutBehavior": {"lane": LANE, "target_speed": SPEED},
    "CrossInFrontOf": {"vehicle": PLACE, "other": PLACE, "speed": SPEED, "threshold": DISTANCE},
    "FollowingScenario": {"gap": DISTANCE, "speed": SPEED},
    "ParkedCarPullingAheadOf": {"target": OBJECT, "metres": DISTANCE, "gap": NUMBER},
    "RedLightRunner": {"speed": SPEED},
    "Jaywalker": {"gap": DISTANCE, "speed": SPEED},
    "ParkedCar": {"gap": NUMBER},
    "PIDLongitudinalController": GAINS,
    "PIDLateralController": GAINS,
    "PIDLongitudinalController.run_step": {"speed_error": NUMBER},
    "PIDLateralController.run_step": {"cte": NUMBER},
    "getLaneFollowingControllers": {"agent": OBJECT},
    "getTurningControllers": {"agent": OBJECT},
    "getLaneChangingControllers": {"agent": OBJECT},
    "withinDistanceToAnyCars": {"car": PLACE, "thresholdDistance": DISTANCE},
    "withinDistanceToAnyObjs": {"vehicle": OBJECT, "thresholdDistance": DISTANCE},
    "withinDistanceToAnyPedestrians": {"vehicle": OBJECT, "thresholdDistance": DISTANCE},
    "withinDistanceToObjsInLane": {"vehicle": OBJECT, "thresholdDistance": DISTANCE},
    "getTrafficLightStatus": {"signal": SIGNAL},
    "setTrafficLightStatus": {"signal": LIGHT, "color": COLOR},
    "setAllIntersectionTrafficLightsStatus": {"intersection": INTERSECTION, "color": COLOR},
    "getClosestTrafficLightStatus": {"vehicle": DRIVEN, "distance": DISTANCE},
    "setClosestTrafficLightStatus": {"vehicle": DRIVEN, "color": COLOR, "distance": DISTANCE},
    "withinDistanceToTrafficLight": {"vehicle": DRIVEN, "thresholdDistance": DISTANCE},
    "withinDistanceToRedYellowTrafficLight": {"vehicle": DRIVEN, "thresholdDistance": DISTANCE},
    "curbAhead": {"vehicle": DRIVEN, "metres": NUMBER},
    "pickNextScenario": {"position": PLACE, "scenarios": SCENARIOS},
}
"""The arguments of each, in the order of its parameters."""


def check_arguments(of: str, *values: object) -> None:
    """Raise `ValueError` for the first argument that is not what is wanted."""
    check_action_arguments(of, WANTED[of], dict(zip(WANTED[of], values, strict=True)))
