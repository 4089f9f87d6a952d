"""Recorded simulations that are read again: one line of the simulation format, checked before anything is done with it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import NamedTuple, NoReturn, TypeVar

from ..semantics.space.vectors import Vector
from ..semantics.store.errors import UsageError
from .scene import OWN_FIELDS
from .simulation import SCHEMA, Body

Kind = TypeVar("Kind")
DEEPEST = 100
"""How deep lists and mappings can be nested in an action or a property."""


class RecordedAction(NamedTuple):
    """An action by the name of its class, with its arguments."""

    name: str
    arguments: tuple[object, ...]


class RecordedStep(NamedTuple):
    """A time step: the objects as JSON, the actions by object, and which behavior each agent was in."""

    objects: tuple[Mapping[str, object], ...]
    actions: Mapping[int, tuple[object, ...]]
    doing: Mapping[int, str]


class Recording(NamedTuple):
    """A recorded simulation. `scene` is JSON; `created` are the objects that scenarios made on the way."""

    seed: int
    run: int
    attempts: int
    timestep: float
    scene: Mapping[str, object]
    scene_attempts: int
    created: tuple[Body, ...]
    steps: tuple[RecordedStep, ...]
    result: str
    reason: str


def recording_from(line: bytes) -> Recording:
    """The simulation of one line of a file. Raises `UsageError`."""
    try:
        value = json.loads(line.decode("utf-8"), parse_constant=refuse_number, parse_float=parse_finite)
    except RecursionError:
        raise UsageError("it is nested too deeply") from None
    except ValueError as problem:
        hint = "" if line.endswith(b"\n") else "the file seems to be cut off: delete its last line"
        raise UsageError(f"it is not JSON: {problem}", hint=hint) from None
    return recording_of(value)


def refuse_number(text: str) -> NoReturn:
    """Refuse NaN and Infinity, which Python's JSON reads."""
    raise ValueError(f"{text} is not a number")


def parse_finite(text: str) -> float:
    """A number with a fraction or an exponent. Raises `ValueError` if it is too large."""
    number = float(text)
    return number if math.isfinite(number) else refuse_number(text)


def recording_of(value: object) -> Recording:
    """The simulation of a JSON value. Raises `UsageError`."""
    if not isinstance(value, Mapping) or value.get("schema") != SCHEMA:
        raise UsageError(f"it is not a simulation of the format {SCHEMA}", hint="`scenic-ref simulate -o PATH` writes them")
    scene = has(value, "scene", Mapping, "the simulation")
    seed, run = integer_field(value, "seed", "the simulation"), integer_field(value, "run", "the simulation", 0)
    attempts, scene_attempts = (integer_field(one, "attempts", what, 1) for one, what in ((value, "the simulation"), (scene, "the scene")))
    if (scene.get("seed"), scene.get("scene")) != (seed, run):
        raise UsageError(f"its scene is not that of seed {seed}, number {run}")
    timestep = real(value, "timestep", "the simulation")
    if timestep <= 0:
        raise UsageError(f"the time step must be a positive number of seconds, not {timestep}")
    known = len(has(scene, "objects", list, "the scene"))
    created = tuple(body_of(one, known + k) for k, one in enumerate(has(value, "created", list, "the simulation")))
    steps = steps_of(has(value, "steps", list, "the simulation"), known, known + len(created))
    result, reason = (has(value, name, str, "the simulation") for name in ("result", "reason"))
    return Recording(seed, run, attempts, timestep, scene, scene_attempts, created, steps, result, reason)


def steps_of(values: list[object], first: int, last: int) -> tuple[RecordedStep, ...]:
    """The time steps; the number of objects grows from `first` to `last`."""
    if not values:
        raise UsageError("it has no time steps")
    steps: list[RecordedStep] = []
    count = first
    for number, value in enumerate(values):
        step = step_of(value, number)
        if not count <= len(step.objects) <= last:
            known = f"{count}" if count == last else f"{count} to {last}"
            raise UsageError(f"time step {number} has {len(step.objects)} objects, where there are {known}")
        count = len(step.objects)
        steps.append(step)
    if steps[-1].actions:
        raise UsageError(f"there are actions in time step {len(steps) - 1}, which is the last")
    if count < last:
        raise UsageError(f"object {count} was created, but is in no time step")
    return tuple(steps)


def step_of(value: object, number: int) -> RecordedStep:
    """A time step. Raises `UsageError`."""
    what = f"time step {number}"
    if not isinstance(value, Mapping) or integer_field(value, "step", what) != number:
        raise UsageError(f"{what} is missing, or not in its place")
    objects = has(value, "objects", list, what)
    for id, one in enumerate(objects):
        if not isinstance(one, Mapping) or one.get("id") != id:
            raise UsageError(f"object {id} of {what} is missing, or not in its place")
        if "position" in one:
            vector_field(one, "position", f"object {id} of {what}")
    taken: dict[int, tuple[object, ...]] = {}
    for key, actions in has(value, "actions", Mapping, what).items():
        id = number_of(key, len(objects), what)
        if not isinstance(actions, list):
            raise UsageError(f"the actions of object {id} in {what} are not a list")
        taken[id] = tuple(action_of(action, f"an action of object {id} in {what}") for action in actions)
    doing = value.get("doing", {})
    if not isinstance(doing, Mapping) or not all(isinstance(text, str) for text in doing.values()):
        raise UsageError(f"what the agents do in {what} is not text")
    return RecordedStep(tuple(objects), taken, {number_of(key, len(objects), what): text for key, text in doing.items()})


def number_of(key: str, count: int, what: str) -> int:
    """The object that a key names. Raises `UsageError`."""
    if not (len(key) <= 9 and key.isascii() and key.isdigit() and str(int(key)) == key and int(key) < count):
        raise UsageError(f"{what} refers to object {key[:40]}, but there are {count} objects in it")
    return int(key)


def action_of(value: object, what: str) -> object:
    """An action with its arguments, or a plain value."""
    if isinstance(value, Mapping) and set(value) == {"action", "args"} and isinstance(value["action"], str) and isinstance(value["args"], list):
        return RecordedAction(value["action"], tuple(value_of(one, what) for one in value["args"]))
    return value_of(value, what)


def body_of(value: object, id: int) -> Body:
    """An object that was created on the way. Raises `UsageError`."""
    what = f"the created object {id}"
    if not isinstance(value, Mapping) or value.get("id") != id:
        raise UsageError(f"{what} is missing, or not in its place")
    if "properties" not in value:
        raise UsageError(f"{what} has no properties: an earlier version recorded it", hint="record the simulation again")
    others = {name: value_of(one, what) for name, one in has(value, "properties", Mapping, what).items() if name not in OWN_FIELDS}
    own = {"position": vector_field(value, "position", what), **{name: real(value, name, what) for name in ("heading", "width", "length")}}
    return Body(id, has(value, "class", str, what), own | others)


def value_of(value: object, what: str, depth: int = 0) -> object:
    """A JSON value as the program had it: two numbers are a vector, other lists tuples. Raises `UsageError`."""
    if depth > DEEPEST:
        raise UsageError(f"{what} is nested too deeply")
    match value:
        case [x, y] if fits_float(x) and fits_float(y):
            return Vector(x, y)
        case list():
            return tuple(value_of(one, what, depth + 1) for one in value)
        case Mapping():
            return {name: value_of(one, what, depth + 1) for name, one in value.items()}
        case _:
            return value


# Fields


def has(value: Mapping[str, object], name: str, kind: type[Kind], what: str) -> Kind:
    """A field of this kind. Raises `UsageError`."""
    found = value.get(name)
    if not isinstance(found, kind):
        raise UsageError(f"{what} has no field {name} that is {KINDS[kind]}")
    return found


KINDS: Mapping[type, str] = {str: "a text", list: "a list", Mapping: "an object"}
"""In the words of JSON."""


def integer_field(value: Mapping[str, object], name: str, what: str, least: int | None = None) -> int:
    """A whole number. Raises `UsageError`."""
    found = value.get(name)
    if type(found) is not int or (least is not None and found < least):
        raise UsageError(f"{what} has no field {name} that is a whole number" + ("" if least is None else f" of at least {least}"))
    return found


def real(value: Mapping[str, object], name: str, what: str) -> float:
    """A number. Raises `UsageError`."""
    found = value.get(name)
    if not fits_float(found):
        raise UsageError(f"{what} has no field {name} that is a number")
    return found  # type: ignore[return-value]


def vector_field(value: Mapping[str, object], name: str, what: str) -> Vector:
    """A position. Raises `UsageError`."""
    found = value.get(name)
    if not (isinstance(found, list) and len(found) == 2 and all(map(fits_float, found))):
        raise UsageError(f"{what} has no field {name} that is a list of two numbers")
    return Vector(*found)


def fits_float(value: object) -> bool:
    """Whether it is a number that is not too large for a float."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
