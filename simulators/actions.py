"""The actions of the paper's examples: what an agent can do in a time step, whatever simulator executes it.

Throttle, brake and steering stay as they are set until they are set again. Which agents can take which is said by `Action.reason_against`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ..data.simulation import Body
from ..semantics.machine.operand_kinds import kind_name
from ..semantics.machine.values import Described
from ..semantics.space.vectors import TakesObjects, TakesPoints, Vector

LONGEST = 40
"""So many characters of a value are told."""


class Wanted(NamedTuple):
    """The requirement on an argument: the words that follow "must be", and a test of values."""

    words: str
    admits: Callable[[object], bool]

    def or_none(self) -> Wanted:
        """Return the requirement that admits None as well."""
        return Wanted(f"{self.words}, or None", lambda value: value is None or self.admits(value))


def is_finite_scalar(value: object) -> bool:
    """Whether a value is a finite number."""
    return math.isfinite(value) if type(value) is float else isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def wanted_range(low: float, high: float, words: str) -> Wanted:
    """A number of a range."""
    return Wanted(words, lambda value: is_finite_scalar(value) and low <= value <= high)  # type: ignore[operator]


def is_distance(value: object) -> bool:
    """Whether a value is a number that is not negative; infinity is one, for what is however far away."""
    return (is_finite_scalar(value) or value == math.inf) and value >= 0  # type: ignore[operator]


def is_vector(value: object) -> bool:
    """Whether a value is a vector, or two numbers in a list or tuple."""
    parts = (value.x, value.y) if isinstance(value, Vector) else value
    return isinstance(parts, (tuple, list)) and len(parts) == 2 and all(map(is_finite_scalar, parts))


NUMBER = Wanted("a number", is_finite_scalar)
HEADING = NUMBER._replace(words="an angle in radians")
SHARE = wanted_range(0, 1, "a number from 0 to 1")
STEERING = wanted_range(-1, 1, "a number from -1 (left) to 1 (right)")
SPEED = wanted_range(0, math.inf, "a speed in m/s, 0 or more")
DISTANCE = Wanted("a number of metres, 0 or more", is_distance)
TRUTH = Wanted("True or False", lambda value: isinstance(value, bool))
VECTOR = Wanted("a vector", is_vector)


def short_value_text(value: object) -> str:
    """A value in a message: short ones as they are written, others by their kind."""
    flat = value if isinstance(value, (list, tuple)) and len(value) < LONGEST else [value]
    if not all(v is None or isinstance(v, (bool, int, float, str)) for v in flat):
        return kind_name(value)
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def check_action_arguments(of: str, wanted: Mapping[str, Wanted], values: Mapping[str, object]) -> None:
    """Raise `ValueError` for the first argument that is not what is wanted."""
    for name, kind in wanted.items():
        if not kind.admits(values[name]):
            raise unwanted_argument_error(of, name, kind, values[name])


def unwanted_argument_error(of: str, name: str, kind: Wanted, value: object) -> ValueError:
    """The error for an argument that is not what is wanted."""
    return ValueError(f"{of}: {name} must be {kind.words}, not {short_value_text(value)}")


WALKING = SPEED._replace(words=f"{SPEED.words} (SetWalkingDirectionAction turns a pedestrian round)")
VEHICLES = "drives"
PEDESTRIANS = "walks"


def drives(body: Body | Described) -> bool:
    """Whether an object is a vehicle: its property `drives` says so, or its class is a car's."""
    return bool(body.properties.get(VEHICLES, body.class_name in CARS))


def walks(body: Body | Described) -> bool:
    """Whether an object is a pedestrian: its property `walks` says so, or its class is a pedestrian's."""
    return bool(body.properties.get(PEDESTRIANS, body.class_name == "Pedestrian"))


CARS = ("Car", "EgoCar", "NPCCar", "Vehicle", "Truck", "Rover")


@dataclass(frozen=True, slots=True)
class Action(TakesPoints, TakesObjects):
    """An action; `reason_against` says why a body cannot take it."""

    scenic_names: ClassVar[frozenset[str]] = frozenset(
        {"throttle", "brake", "steer", "handbrake", "reverse", "pos", "offset", "velocity", "heading", "speed", "enabled", "canBeTakenBy"}
    )
    """What a program may ask of actions."""
    wanted: ClassVar[Mapping[str, Wanted]] = {}
    """What the arguments must be."""

    def __post_init__(self) -> None:
        """Check the arguments. Raises `ValueError`."""
        for name, kind in self.wanted.items():
            if not kind.admits(getattr(self, name)):
                raise unwanted_argument_error(type(self).__name__, name, kind, getattr(self, name))

    def reason_against(self, body: Body | Described) -> str | None:
        """Why this object cannot take the action, None if it can."""
        return None

    def canBeTakenBy(self, agent: object) -> bool:
        """Whether an object can take the action; under this name in programs."""
        if not isinstance(agent, Described):
            raise TypeError(f"canBeTakenBy(agent) takes an object, not {kind_name(agent)}")
        return self.reason_against(agent) is None


def only(who: str, property: str, body: Body | Described) -> str:
    """Why an object that is none of `who` cannot take an action of theirs."""
    return f"only {who} can ({property} would have to be True, as in `{body.class_name} with {property} True`)"


@dataclass(frozen=True, slots=True)
class DrivingAction(Action):
    """An action of a vehicle."""

    def reason_against(self, body: Body | Described) -> str | None:
        """Return a reason unless the agent is a vehicle: only vehicles drive."""
        return None if drives(body) else only("vehicles", VEHICLES, body)


@dataclass(frozen=True, slots=True)
class SetThrottleAction(DrivingAction):
    """The throttle, from 0 to 1."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"throttle": SHARE}
    throttle: float


@dataclass(frozen=True, slots=True)
class SetBrakeAction(DrivingAction):
    """The brake, from 0 to 1."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"brake": SHARE}
    brake: float


@dataclass(frozen=True, slots=True)
class SetSteerAction(DrivingAction):
    """The steering, from -1 (left) to 1 (right)."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"steer": STEERING}
    steer: float


@dataclass(frozen=True, slots=True, init=False)
class SetHandBrakeAction(DrivingAction):
    """The hand brake, on or off; its argument has another name than what the action has, as in the released library."""

    handbrake: bool

    def __init__(self, handBrake: bool) -> None:
        check_action_arguments("SetHandBrakeAction", {"handBrake": TRUTH}, {"handBrake": handBrake})
        object.__setattr__(self, "handbrake", handBrake)


@dataclass(frozen=True, slots=True)
class SetReverseAction(DrivingAction):
    """The reverse gear, in or not."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"reverse": TRUTH}
    reverse: bool


STEERED = 0.1
"""How much a regulated steering may change in a time step."""


@dataclass(frozen=True, slots=True)
class RegulatedControlAction(DrivingAction):
    """An action of controllers, within limits: throttle, or brake if `throttle` is negative, and steering
    that does not jump from `past_steer`.
    """

    wanted: ClassVar[Mapping[str, Wanted]] = {
        **dict.fromkeys(("throttle", "steer", "past_steer"), NUMBER), **dict.fromkeys(("max_throttle", "max_brake", "max_steer"), SHARE)
    }  # fmt: skip
    throttle: float
    steer: float
    past_steer: float
    max_throttle: float = 0.5
    max_brake: float = 0.5
    max_steer: float = 0.8

    @property
    def regulated(self) -> tuple[float, float, float]:
        """Throttle, brake and steering, as the released library means them (where the brake is 0 by mistake)."""
        steer = min(max(self.steer, self.past_steer - STEERED), self.past_steer + STEERED)
        steer = min(max(steer, -self.max_steer), self.max_steer)
        if self.throttle > 0:
            return min(self.throttle, self.max_throttle), 0.0, steer
        return 0.0, min(-self.throttle, self.max_brake), steer


@dataclass(frozen=True, slots=True)
class SetAutopilotAction(DrivingAction):
    """Whether a driver of the simulator's drives the vehicle; only `sumo` has drivers."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"enabled": TRUTH}
    enabled: bool


@dataclass(frozen=True, slots=True)
class SetPositionAction(Action):
    """The object is at this position at once (metres)."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"pos": VECTOR}
    pos: Vector

    def __post_init__(self) -> None:
        """A pair is a vector."""
        Action.__post_init__(self)
        object.__setattr__(self, "pos", pair_to_vector(self.pos))


@dataclass(frozen=True, slots=True)
class OffsetAction(Action):
    """The object is at once as far from where it is: metres to its right and ahead of it."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"offset": VECTOR}
    offset: Vector

    def __post_init__(self) -> None:
        """A pair is a vector."""
        Action.__post_init__(self)
        object.__setattr__(self, "offset", pair_to_vector(self.offset))


@dataclass(frozen=True, slots=True, init=False)
class SetVelocityAction(Action):
    """The object moves with this velocity (metres per second, East and North) until it gets another.

    It is given as one vector, or as two numbers with the names of the released library, whose third, the height, says nothing in the plane.
    """

    velocity: Vector

    def __init__(self, xVel: object, yVel: object = None, zVel: object = 0) -> None:
        one = {"xVel": VECTOR._replace(words="a vector, or yVel be given as well")}
        two = {"xVel": NUMBER, "yVel": NUMBER, "zVel": NUMBER}
        check_action_arguments("SetVelocityAction", one if yVel is None else two, {"xVel": xVel, "yVel": yVel, "zVel": zVel})
        object.__setattr__(self, "velocity", pair_to_vector(xVel if yVel is None else (xVel, yVel)))


@dataclass(frozen=True, slots=True)
class SetSpeedAction(Action):
    """The object moves with this speed (metres per second) along its heading until it gets another."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"speed": NUMBER}
    speed: float


@dataclass(frozen=True, slots=True)
class WalkingAction(Action):
    """An action of a pedestrian."""

    def reason_against(self, body: Body | Described) -> str | None:
        """Return a reason unless the agent is a pedestrian: only pedestrians walk."""
        return None if walks(body) else only("pedestrians", PEDESTRIANS, body)


@dataclass(frozen=True, slots=True)
class SetWalkingDirectionAction(WalkingAction):
    """The direction in which a pedestrian walks, as a heading (radians, anticlockwise from North)."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"heading": HEADING}
    heading: float


@dataclass(frozen=True, slots=True)
class SetWalkingSpeedAction(WalkingAction):
    """How fast a pedestrian walks (metres per second)."""

    wanted: ClassVar[Mapping[str, Wanted]] = {"speed": WALKING}
    speed: float


def pair_to_vector(value: object) -> Vector:
    """A vector, of what `is_vector`."""
    x, y = (value.x, value.y) if isinstance(value, Vector) else value  # type: ignore[misc]
    return Vector(float(x), float(y))  # type: ignore[arg-type]


ACTIONS = {
    a.__name__: a
    for a in (
        SetThrottleAction, SetBrakeAction, SetSteerAction, SetHandBrakeAction, SetReverseAction, RegulatedControlAction,
        SetPositionAction, OffsetAction, SetVelocityAction, SetSpeedAction, SetWalkingDirectionAction, SetWalkingSpeedAction, SetAutopilotAction,
    )
}
"""The actions by name."""

