"""An exact and deterministic simulator without forces between objects: vehicles as in the released implementation's Newtonian simulator.

Per time step of dt seconds, with v the speed along the heading, h the heading and L the length of the vehicle:

    brake > 0:     v moves towards 0 by 6.8 m/s2 * brake * dt, and not past it
    otherwise:     v += 5.6 m/s2 * throttle * dt   (subtracted in reverse gear)
    velocity       = v * (-sin h, cos h)
    angularSpeed   = -v * sin(steer * pi/2) / L    (0 if the steering is straight)
    position      += velocity * dt
    heading       += angularSpeed * dt

Pedestrians move with their speed along the direction in which they walk; everything else keeps its velocity. Nothing collides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..interpreter.simulating import Body, Pose
from ..semantics.vectors import Vector
from . import actions as a

BRAKING, ACCELERATION = 6.8, 5.6
"""Metres per second squared, at full brake and full throttle."""


@dataclass
class Moving:
    """An object: metres, radians, seconds."""

    x: float
    y: float
    heading: float
    length: float
    vehicle: bool
    pedestrian: bool
    vx: float = 0.0
    vy: float = 0.0
    turning: float = 0.0
    throttle: float = 0.0
    brake: float = 0.0
    steer: float = 0.0
    handbrake: bool = False
    reverse: bool = False
    walking: float | None = None

    @property
    def speed(self) -> float:
        """The length of the velocity; negative for a vehicle that moves backwards."""
        backwards = self.vehicle and self.vy * math.cos(self.heading) < self.vx * math.sin(self.heading)
        return -math.hypot(self.vx, self.vy) if backwards else math.hypot(self.vx, self.vy)

    def run(self, speed: float, heading: float) -> None:
        """Let the velocity be this speed along a heading."""
        self.vx, self.vy = -speed * math.sin(heading), speed * math.cos(heading)


class Kinematic:
    """The simulator; `timestep` is in seconds."""

    properties = frozenset({"position", "heading", "speed", "velocity", "angularSpeed"})

    def __init__(self, timestep: float = 0.1) -> None:
        if not (timestep > 0 and math.isfinite(timestep)):
            raise ValueError(f"the time step is a positive number of seconds, not {timestep}")
        self.timestep = timestep
        self.bodies: list[Moving] = []

    def create(self, bodies: Sequence[Body]) -> None:
        """Objects begin with their property `velocity`, else `speed` along their heading, else at rest."""
        for body in bodies:
            position, heading = body.properties["position"], float(body.properties["heading"])  # type: ignore[arg-type]
            assert isinstance(position, Vector)
            moving = Moving(position.x, position.y, heading, float(body.properties["length"]), a.drives(body), a.walks(body))  # type: ignore[arg-type]
            velocity, speed = body.properties.get("velocity"), body.properties.get("speed")
            if isinstance(velocity, Vector) and (velocity.x or velocity.y):
                moving.vx, moving.vy = velocity.x, velocity.y
            elif a.is_number(speed):
                moving.run(float(speed), heading)  # type: ignore[arg-type]
            self.bodies.append(moving)

    def check(self, body: Body, action: object) -> str | None:
        """Whether it is one of our actions, and this object can take it."""
        if not isinstance(action, a.Action):
            return f"it is none of {', '.join(a.ACTIONS)}"
        return action.reason_against(body)

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """The actions, then the equations above."""
        for id, taken in actions.items():
            for action in taken:
                take(self.bodies[id], action)
        for body in self.bodies:
            move(body, self.timestep)
        return ()

    def read(self, id: int) -> Pose:
        """Where the object is, and how it moves."""
        body = self.bodies[id]
        return {
            "position": Vector(body.x, body.y), "heading": body.heading, "speed": body.speed, "velocity": Vector(body.vx, body.vy),
            "angularSpeed": body.turning,
        }

    def destroy(self) -> None:
        """Forget the objects."""
        self.bodies = []


def take(body: Moving, action: object) -> None:
    """The effect of an action on the controls of an object."""
    match action:
        case a.SetThrottleAction(throttle=throttle):
            body.throttle = float(throttle)
        case a.SetBrakeAction(brake=brake):
            body.brake = float(brake)
        case a.SetSteerAction(steer=steer):
            body.steer = float(steer)
        case a.SetHandBrakeAction(handbrake=handbrake):
            body.handbrake = bool(handbrake)
        case a.SetReverseAction(reverse=reverse):
            body.reverse = bool(reverse)
        case a.SetPositionAction(position=position):
            body.x, body.y = position.x, position.y
        case a.SetVelocityAction(velocity=velocity):
            body.vx, body.vy = velocity.x, velocity.y
        case a.SetSpeedAction(speed=speed):
            body.run(float(speed), body.heading)
        case a.SetWalkingDirectionAction(heading=heading):
            body.walking = float(heading)
            body.run(body.speed, body.walking)
        case a.SetWalkingSpeedAction(speed=speed):
            body.run(float(speed), body.heading if body.walking is None else body.walking)
        case _:
            raise AssertionError(action)


def move(body: Moving, dt: float) -> None:
    """One time step of `dt` seconds."""
    if body.vehicle:
        speed = body.speed
        brake = max(float(body.handbrake), body.brake)
        if brake > 0:
            slower = BRAKING * brake * dt
            speed = max(0.0, speed - slower) if speed > 0 else min(0.0, speed + slower)
        else:
            speed += (-body.throttle if body.reverse else body.throttle) * ACCELERATION * dt
        body.run(speed, body.heading)
        body.turning = -speed * math.sin(body.steer * math.pi / 2) / body.length if body.steer else 0.0
    body.x += body.vx * dt
    body.y += body.vy * dt
    body.heading += body.turning * dt
