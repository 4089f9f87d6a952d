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
from dataclasses import dataclass, field
from typing import TypeVar

from ..data.simulation import Body, Pose
from ..semantics.space.geometry import rotate
from ..semantics.space.vectors import Vector
from . import actions as a
from .controls import ACCELERATION, BRAKING, PROPERTIES, Controls, along, checked_timestep, reason_against, velocity_at_first
from .protocol import Surroundings


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
    walking: float | None = None
    controls: Controls = field(default_factory=Controls)

    @property
    def speed(self) -> float:
        """The length of the velocity; negative for a vehicle that moves backwards."""
        backwards = self.vehicle and self.vy * math.cos(self.heading) < self.vx * math.sin(self.heading)
        return -math.hypot(self.vx, self.vy) if backwards else math.hypot(self.vx, self.vy)

    def run(self, speed: float, heading: float) -> None:
        """Let the velocity be this speed along a heading."""
        self.vx, self.vy = along(speed, heading)


class Kinematic:
    """The simulator; `timestep` is in seconds."""

    properties = PROPERTIES
    random = False

    def __init__(self, timestep: float = 0.1) -> None:
        self.timestep = checked_timestep(timestep)
        self.bodies: list[Moving] = []

    def create(self, bodies: Sequence[Body], scene: Surroundings) -> None:
        """Objects begin with their property `velocity`, else `speed` along their heading, else at rest."""
        self.bodies += [moving_of(body, Moving) for body in bodies]

    def check(self, body: Body, action: object) -> str | None:
        """Whether it is one of our actions, and this object can take it."""
        return reason_against(body, action)

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """The actions, then the equations above."""
        for id, taken in actions.items():
            for action in taken:
                take(self.bodies[id], action)
        for body in self.bodies:
            move(body, self.timestep)
        return ()

    def read(self, id: int) -> Pose:
        """Return the position and motion of the object."""
        return pose_of(self.bodies[id])

    def controls(self, id: int) -> Pose:
        """How the controls of the object are set."""
        return self.bodies[id].controls.shown

    def destroy(self) -> None:
        """Forget the objects of this simulation."""
        self.bodies = []


Kind = TypeVar("Kind", bound=Moving)


def moving_of(body: Body, kind: type[Kind]) -> Kind:
    """An object as it begins."""
    position, heading = body.properties["position"], float(body.properties["heading"])  # type: ignore[arg-type]
    assert isinstance(position, Vector)
    drives = a.drives(body)
    moving = kind(position.x, position.y, heading, float(body.properties["length"]), drives, a.walks(body) and not drives)  # type: ignore[arg-type]
    moving.vx, moving.vy = velocity_at_first(body)
    return moving


def pose_of(body: Moving) -> Pose:
    """Return the position and motion of a body."""
    return {
        "position": Vector(body.x, body.y), "heading": body.heading, "speed": body.speed, "velocity": Vector(body.vx, body.vy),
        "angularSpeed": body.turning,
    }  # fmt: skip


def take(body: Moving, action: object) -> None:
    """The effect of an action on the controls of an object."""
    if body.controls.set(action):
        return
    match action:
        case a.SetPositionAction(pos=position):
            body.x, body.y = position.x, position.y
        case a.OffsetAction(offset=offset):
            moved = rotate(offset, body.heading)
            body.x, body.y = body.x + moved.x, body.y + moved.y
        case a.SetVelocityAction(velocity=velocity):
            body.vx, body.vy = velocity.x, velocity.y
        case a.SetSpeedAction(speed=speed):
            body.run(float(speed), body.heading)
        case a.SetWalkingDirectionAction(heading=heading) if body.vehicle:  # a bicycle turns round
            speed, body.heading = body.speed, float(heading)
            body.run(speed, body.heading)
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
        sine, cosine = math.sin(body.heading), math.cos(body.heading)
        speed = math.hypot(body.vx, body.vy)
        if body.vy * cosine < body.vx * sine:
            speed = -speed
        controls = body.controls
        if controls.braking > 0:
            slower = BRAKING * controls.braking * dt
            speed = max(0.0, speed - slower) if speed > 0 else min(0.0, speed + slower)
        else:
            speed += controls.driving * ACCELERATION * dt
        body.vx, body.vy = -speed * sine, speed * cosine
        body.turning = -speed * math.sin(controls.steer * math.pi / 2) / body.length if controls.steer else 0.0
    body.x += body.vx * dt
    body.y += body.vy * dt
    body.heading += body.turning * dt
