"""The names for which programs choose a world model: what to suggest where a program without it uses one of them."""

from __future__ import annotations

from collections.abc import Mapping

NAMES_OF_MODELS: Mapping[str, str] = {
    "gtaLib": "Car EgoCar Bus Compact CarModel CarColor road curb roadDirection createPlatoonAt carAheadOfCar",
    "mars": "Goal Rover Rock BigRock Pipe",
    "scenic.domains.driving.model": (
        "Car NPCCar Vehicle Pedestrian Bicycle Truck network road curb sidewalk shoulder roadOrShoulder intersection roadDirection "
        "FollowLaneBehavior FollowTrajectoryBehavior LaneChangeBehavior TurnBehavior DriveAvoidingCollisions ConstantThrottleBehavior "
        "WalkForwardBehavior CrossingBehavior AutopilotBehavior StopBehavior SetThrottleAction SetBrakeAction SetSteerAction SetSpeedAction "
        "withinDistanceToAnyCars withinDistanceToAnyObjs"
    ),
}
"""The models of which programs are written here, with their names."""


def models_by_name() -> Mapping[str, tuple[str, ...]]:
    """The models that have a name, by the name."""
    found: dict[str, tuple[str, ...]] = {}
    for model, names in NAMES_OF_MODELS.items():
        for name in names.split():
            found[name] = (*found.get(name, ()), model)
    return found


MODELS_BY_NAME = models_by_name()
