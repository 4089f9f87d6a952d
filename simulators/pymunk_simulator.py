"""A simulator with collisions, seen from above, by pymunk (extra `dynamics`). The only file that imports pymunk.

Objects are boxes. Vehicles have throttle, brake and drag along their heading, tyres that hold them sideways up to a limit, and turn as a
bicycle does; pedestrians walk; what has neither engine nor legs, nor a velocity to begin with, stands still for good. A run has a space of its
own, bodies in the order of the scene, fixed time steps and no randomness, so that equal actions give equal trajectories, bit for bit, on one
machine. After each internal step of pymunk, what engines, brakes, tyres and legs do to all velocities is done at once.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..data.simulation import Body, Pose
from ..interpreter.runtime.optional_packages import missing_package_error
from ..semantics.space.geometry import rotate
from ..semantics.space.vectors import Vector
from . import actions as a
from .controls import (
    ACCELERATION,
    BRAKING,
    PROPERTIES,
    Controls,
    along,
    checked_timestep,
    reason_against,
    velocity_at_first,
)
from .protocol import Surroundings

DRAG = ACCELERATION / 50.0**2
"""Per metre: at full throttle a vehicle reaches 50 m/s."""
ROLLING = 0.1
"""Metres per second squared by which a vehicle that is left alone slows down."""
GRIP = 0.9 * 9.81
"""Metres per second squared that tyres can turn or hold."""
STEERING, WHEELBASE, YAWING = math.radians(35), 0.6, 8.0
"""The largest angle of the front wheels; the wheelbase as a share of the length; radians per second squared by which the yaw rate can change."""
WALKING = 3.0
"""Metres per second squared by which a pedestrian changes its velocity."""
MASS = 160.0
"""Kilograms per square metre, about that of a car."""
SLOP = 0.01
"""Metres by which objects that touch may overlap."""
SUBSTEP, FASTEST = 1 / 60, 40.0
"""The longest internal step in seconds, and the speed up to which nothing passes through anything."""


LONGEST = 60.0
"""The longest time step in seconds: it has thousands of internal steps."""


class Motion(NamedTuple):
    """The motion of a body: its position, angle, velocity and yaw rate, in metres, radians and seconds."""

    x: float
    y: float
    angle: float
    velocity_x: float
    velocity_y: float
    turning: float


class Controlled:
    """An object: its body, what kind it is, and how its controls are set."""

    def __init__(self, id: int, body: Any, length: float, vehicle: bool, pedestrian: bool) -> None:
        self.id, self.body, self.length, self.vehicle, self.pedestrian = id, body, length, vehicle, pedestrian
        self.controls = Controls()
        self.walking: tuple[float, float] | None = None

    def speed(self, now: Motion) -> float:
        """The speed along the heading, in metres per second; of the velocity for what is not a vehicle."""
        if not self.vehicle:
            return math.hypot(now.velocity_x, now.velocity_y)
        return now.velocity_y * math.cos(now.angle) - now.velocity_x * math.sin(now.angle)

    def after(self, angle: float, x: float, y: float, turning: float, dt: float) -> tuple[float, float, float]:
        """The velocity (x, y) and the yaw rate after `dt` seconds of what the object does; they stay those of what does nothing."""
        return self.driven(angle, x, y, turning, dt) if self.vehicle else self.walked(x, y, dt) if self.pedestrian else (x, y, turning)

    def driven(self, angle: float, x: float, y: float, turning: float, dt: float) -> tuple[float, float, float]:
        """Engine, brake and drag along a vehicle, tyres across it, the yaw rate of a bicycle."""
        controls = self.controls
        sine, cosine = math.sin(angle), math.cos(angle)
        ahead, across = y * cosine - x * sine, x * cosine + y * sine
        ahead += controls.driving * ACCELERATION * dt if controls.braking == 0 else 0.0
        slower = (BRAKING * controls.braking + (ROLLING if controls.throttle == 0 else 0.0) + DRAG * ahead * ahead) * dt
        ahead = math.copysign(max(0.0, abs(ahead) - slower), ahead)
        across = math.copysign(max(0.0, abs(across) - GRIP * dt), across)
        wanted = -ahead * math.tan(controls.steer * STEERING) / (WHEELBASE * self.length)
        limit = GRIP / max(abs(ahead), 1e-6)
        change = min(max(wanted, -limit), limit) - turning
        return across * cosine - ahead * sine, ahead * cosine + across * sine, turning + min(max(change, -YAWING * dt), YAWING * dt)

    def walked(self, x: float, y: float, dt: float) -> tuple[float, float, float]:
        """A pedestrian's velocity approaches that with which it wants to walk."""
        to_x, to_y = self.walking or (0.0, 0.0)
        far = math.hypot(to_x - x, to_y - y)
        share = min(1.0, WALKING * dt / far) if far else 0.0
        return x + (to_x - x) * share, y + (to_y - y) * share, 0.0


class Physics:
    """The simulator; `timestep` is in seconds. Raises `UsageError` if pymunk is not installed."""

    properties = PROPERTIES
    random = False

    def __init__(self, timestep: float = 0.1) -> None:
        self.timestep = checked_timestep(timestep)
        if timestep > LONGEST:
            raise ValueError(f"a time step of pymunk must be at most {LONGEST:g} seconds, not {timestep:g}")
        try:
            import pymunk
            from pymunk import batch
        except ImportError as problem:
            raise missing_package_error("the simulator pymunk", "pymunk", problem) from None
        self.pymunk, self.batch, self.fields = pymunk, batch, batch.BodyFields
        self.velocities = self.fields.VELOCITY | self.fields.ANGULAR_VELOCITY
        self.gotten, self.given = batch.Buffer(), batch.Buffer()
        self.destroy()

    def create(self, bodies: Sequence[Body], scene: Surroundings) -> None:
        """Objects begin with their property `velocity`, else `speed` along their heading, else at rest; others pass through `allowCollisions`."""
        for body in bodies:
            position, heading = body.properties["position"], float(body.properties["heading"])  # type: ignore[arg-type]
            width, length = float(body.properties["width"]), float(body.properties["length"])  # type: ignore[arg-type]
            velocity = velocity_at_first(body)
            moves = velocity != (0.0, 0.0)
            vehicle = a.drives(body)
            pedestrian = a.walks(body) and not vehicle
            made = self.body_of(width, length, still=not (vehicle or pedestrian or moves), turns=not pedestrian)
            made.position, made.angle = (position.x, position.y), heading  # type: ignore[union-attr]
            moving = Controlled(body.id, made, length, vehicle, pedestrian)
            if moves:
                made.velocity = velocity
            shape = self.pymunk.Poly.create_box(made, (width, length))
            shape.friction, shape.elasticity = 0.6, 0.1
            shape.sensor = bool(body.properties.get("allowCollisions", False))
            self.space.add(made, shape)
            self.ids[shape] = body.id
            self.moving[body.id] = moving
            self.smallest = min(self.smallest, max(min(width, length), 1e-3))
        self.gotten.clear()
        self.batch.get_space_bodies(self.space, self.fields.BODY_ID, self.gotten)
        by_number = {moving.body.id: moving for moving in self.moving.values()}
        self.ordered = [by_number[number] for number in np.frombuffer(self.gotten.int_buf(), np.uintp).tolist()]
        self.look()

    def body_of(self, width: float, length: float, *, still: bool, turns: bool) -> Any:
        """A body without its place."""
        if still:
            return self.pymunk.Body(body_type=self.pymunk.Body.STATIC)
        mass = max(MASS * width * length, 1e-3)
        return self.pymunk.Body(mass, self.pymunk.moment_for_box(mass, (width, length)) if turns else math.inf)

    def check(self, body: Body, action: object) -> str | None:
        """Whether it is one of our actions, and this object can take it."""
        return reason_against(body, action)

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """The actions, then as many internal steps as are needed that nothing passes through anything; collisions that begin are reported."""
        for id, taken in actions.items():
            for action in taken:
                self.take(self.moving[id], action)
        count = math.ceil(self.timestep / min(SUBSTEP, self.smallest / FASTEST) - 1e-9)
        self.met = []
        dt = self.timestep / count
        for _ in range(count):
            self.space.step(dt)
            self.control(dt)
        self.look()
        return [f"collision of objects {one} and {other}" for one, other in dict.fromkeys(self.met)]

    def numbers(self, fields: Any) -> array[float]:
        """Return the numbers in these fields of all bodies, one body after the other."""
        self.gotten.clear()
        self.batch.get_space_bodies(self.space, fields, self.gotten)
        return array("d", bytes(self.gotten.float_buf()))

    def look(self) -> None:
        """Note where all objects are, and how they move."""
        numbers = self.numbers(self.fields.POSITION | self.fields.ANGLE | self.velocities)
        self.motions = {moving.id: Motion(*numbers[6 * place : 6 * place + 6]) for place, moving in enumerate(self.ordered)}

    def control(self, dt: float) -> None:
        """Change the velocities of vehicles and pedestrians by what they do in `dt` seconds."""
        numbers = self.numbers(self.fields.ANGLE | self.velocities)
        given = array("d")
        for moving, angle, x, y, turning in zip(self.ordered, *(numbers[field::4] for field in range(4)), strict=True):
            given.extend(moving.after(angle, x, y, turning, dt))
        self.given.set_float_buf(given)
        self.batch.set_space_bodies(self.space, self.velocities, self.given)

    def take(self, moving: Controlled, action: object) -> None:
        """The effect of an action on the controls of an object."""
        body = moving.body
        if moving.controls.set(action):
            return
        match action:
            case a.SetPositionAction(pos=position):
                body.position = (position.x, position.y)
                self.space.reindex_shapes_for_body(body)
            case a.OffsetAction(offset=offset):
                moved = rotate(offset, body.angle)
                body.position += (moved.x, moved.y)
                self.space.reindex_shapes_for_body(body)
            case a.SetVelocityAction(velocity=velocity):
                self.push(moving, (velocity.x, velocity.y))
            case a.SetSpeedAction(speed=speed):
                self.push(moving, along(speed, body.angle))
            case a.SetWalkingDirectionAction(heading=heading) if moving.vehicle:  # a bicycle turns round
                speed, body.angle = math.hypot(*body.velocity), float(heading)
                self.push(moving, along(speed, heading))
            case a.SetWalkingSpeedAction(speed=speed) if moving.vehicle:
                self.push(moving, along(speed, body.angle))
            case a.SetWalkingDirectionAction(heading=heading):
                speed = math.hypot(*(moving.walking or body.velocity))
                moving.walking = along(speed, heading)
                body.angle = float(heading)
            case a.SetWalkingSpeedAction(speed=speed):
                moving.walking = along(speed, body.angle)
            case _:
                raise AssertionError(action)

    def push(self, moving: Controlled, velocity: tuple[float, float]) -> None:
        """Give an object a velocity; what stood still for good cannot have one."""
        if moving.body.body_type == self.pymunk.Body.STATIC:
            raise ValueError("an object that stands still cannot be given a velocity: let it begin with one")
        moving.body.velocity = velocity
        moving.walking = velocity if moving.pedestrian else None

    def read(self, id: int) -> Pose:
        """Return the position and motion of the object."""
        now = self.motions[id]
        return {
            "position": Vector(now.x, now.y), "heading": now.angle, "speed": self.moving[id].speed(now),
            "velocity": Vector(now.velocity_x, now.velocity_y), "angularSpeed": now.turning,
        }  # fmt: skip

    def controls(self, id: int) -> Pose:
        """How the controls of the object are set."""
        return self.moving[id].controls.shown

    def destroy(self) -> None:
        """Begin with an empty space."""
        self.space: Any = self.pymunk.Space()
        self.space.collision_slop = SLOP
        self.space.on_collision(begin=self.meet)
        self.ids: dict[Any, int] = {}
        self.moving: dict[int, Controlled] = {}
        self.ordered: list[Controlled] = []
        self.motions: dict[int, Motion] = {}
        self.met: list[tuple[int, int]] = []
        self.smallest = math.inf

    def meet(self, arbiter: Any, space: Any, data: Any) -> None:
        """Note that two objects touch."""
        one, other = (self.ids[shape] for shape in arbiter.shapes)
        self.met.append((min(one, other), max(one, other)))
