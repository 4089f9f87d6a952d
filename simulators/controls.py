"""The parts that simulators with vehicles and pedestrians share: setting controls, initial velocities,
reasons to refuse.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..data.simulation import Body
from ..semantics.space.vectors import Vector
from . import actions as a
from .actions import is_finite_scalar

CONTROLS = ("throttle", "brake", "steer", "hand_brake", "reverse")
"""The properties in which objects of the Newtonian model have their controls, by the released names; `SHOWN` says which objects do."""
SHOWN = "controls_shown"
PROPERTIES = frozenset({"position", "heading", "speed", "velocity", "angularSpeed"})
"""What they update."""
BRAKING, ACCELERATION = 6.8, 5.6
"""Metres per second squared, at full brake and full throttle, as in the released implementation's Newtonian simulator."""


@dataclass
class Controls:
    """How a vehicle's controls are set; they stay so."""

    throttle: float = 0.0
    brake: float = 0.0
    steer: float = 0.0
    handbrake: bool = False
    reverse: bool = False

    def set(self, action: object) -> bool:
        """Whether the action is one of a vehicle's controls, which is then set."""
        match action:
            case a.SetThrottleAction(throttle=throttle):
                self.throttle = float(throttle)
            case a.SetBrakeAction(brake=brake):
                self.brake = float(brake)
            case a.SetSteerAction(steer=steer):
                self.steer = float(steer)
            case a.RegulatedControlAction():
                self.throttle, self.brake, self.steer = action.regulated
            case a.SetHandBrakeAction(handbrake=handbrake):
                self.handbrake = bool(handbrake)
            case a.SetReverseAction(reverse=reverse):
                self.reverse = bool(reverse)
            case _:
                return False
        return True

    @property
    def shown(self) -> dict[str, float | bool]:
        """The controls under the names of `CONTROLS`."""
        return dict(zip(CONTROLS, (self.throttle, self.brake, self.steer, self.handbrake, self.reverse), strict=True))

    @property
    def braking(self) -> float:
        """The brake that counts, from 0 to 1."""
        return max(float(self.handbrake), self.brake)

    @property
    def driving(self) -> float:
        """The throttle, negative in reverse gear."""
        return -self.throttle if self.reverse else self.throttle


def along(speed: float, heading: float) -> tuple[float, float]:
    """The velocity of this speed along a heading."""
    return -speed * math.sin(heading), speed * math.cos(heading)


def velocity_at_first(body: Body) -> tuple[float, float]:
    """The property `velocity`, else `speed` along the heading, else rest."""
    velocity, speed = body.properties.get("velocity"), body.properties.get("speed")
    if isinstance(velocity, Vector) and (velocity.x or velocity.y):
        return velocity.x, velocity.y
    return along(float(speed), float(body.properties["heading"])) if is_finite_scalar(speed) else (0.0, 0.0)  # type: ignore[arg-type]


def reason_against(body: Body, action: object) -> str | None:
    """Whether it is one of our actions, and this object can take it in a simulator without drivers of its own."""
    if isinstance(action, a.SetAutopilotAction):
        return "this simulator has no drivers: --simulator sumo has"
    return action.reason_against(body) if isinstance(action, a.Action) else f"it is none of {', '.join(a.ACTIONS)}"


def checked_timestep(timestep: float) -> float:
    """A time step in seconds. Raises `ValueError`."""
    if not (timestep > 0 and math.isfinite(timestep)):
        raise ValueError(f"the time step must be a positive number of seconds, not {timestep}")
    return timestep
