"""Scenes: the result (π, O) of a run, as a record and in the JSON format (DESIGN, section 7)."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from ..semantics.kernel.config import State
from ..semantics.kernel.errors import UsageError
from ..semantics.kernel.kinds import is_scalar
from ..semantics.kernel.nesting import check_nesting
from ..semantics.kernel.values import Instance, ScenicClass, plain, unwrap
from ..semantics.programs import ego_of
from ..semantics.python.texts import stable_repr
from ..semantics.scenes.default_requirements import workspace_of
from ..semantics.space.geometry import normalise_heading
from ..semantics.space.regions import Region, everywhere
from ..semantics.space.vectors import Vector

SCHEMA = "scenic-ref/scene/1"
LARGEST_NUMBER_BITS = 10_000
OWN_FIELDS = ("position", "heading", "width", "length")


SURROGATE = re.compile("[\ud800-\udfff]")
"""Half of a pair of UTF-16, which is not a character and cannot be written in UTF-8."""


def in_json(value: object, *, allow_nan: bool = False, indent: int | None = None) -> str:
    """The text of a value in JSON, which can always be written in UTF-8. Raises `ValueError` for numbers that JSON does not have, unless allowed."""
    text = json.dumps(value, allow_nan=allow_nan, ensure_ascii=False, indent=indent)
    return SURROGATE.sub(lambda half: f"\\u{ord(half[0]):04x}", text)


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An Object of a scene: metres, radians anticlockwise from North in (-π, π]; `properties` are all the others."""

    id: int
    name: str | None
    class_name: str
    position: Vector
    heading: float
    width: float
    length: float
    properties: Mapping[str, object]

    def __getitem__(self, name: str) -> object:
        """Any property by name; KeyError if the object has none of that name."""
        return getattr(self, name) if name in OWN_FIELDS else self.properties[name]

    def to_json(self) -> dict[str, object]:
        """The entry of the scene format."""
        return {
            "id": self.id, "name": self.name, "class": self.class_name, "position": [self.position.x, self.position.y], "heading": self.heading,
            "width": self.width, "length": self.length, "properties": {k: json_value(v) for k, v in self.properties.items()},
        }


@dataclass(frozen=True, slots=True)
class Scene:
    """One scene, the one with number `index` for `seed`; `attempts` runs were needed, `weight` is 1 for rejection.

    `pruned`: points were drawn from smaller regions, so that a seed gives other scenes than without, from the same distribution.
    """

    objects: tuple[SceneObject, ...]
    ego_id: int | None
    params: Mapping[str, object]
    seed: int
    index: int
    attempts: int
    weight: float = 1.0
    workspace: Region = everywhere
    pruned: bool = False

    @property
    def ego(self) -> SceneObject:
        """The object from whose point of view the scene is."""
        if self.ego_id is None:
            raise UsageError("the scene has no ego: a scenario that the compose block runs makes it")
        return self.objects[self.ego_id]

    def to_json(self) -> dict[str, object]:
        """The scene as a JSON object."""
        return {
            "schema": SCHEMA, "seed": self.seed, "scene": self.index, "attempts": self.attempts, "weight": self.weight,
            **({"pruned": True} if self.pruned else {}),
            "params": {k: json_value(v) for k, v in self.params.items()}, "ego": self.ego_id, "objects": [o.to_json() for o in self.objects],
        }

    def to_line(self) -> str:
        """One line of a JSON Lines file."""
        return in_json(self.to_json())

    def _repr_png_(self) -> bytes:
        """A picture, for notebooks."""
        from .pictures import picture

        return picture([self])


def json_value(value: object) -> object:
    """A property or parameter in JSON; what has no JSON form is written as {"repr": "..."}."""
    inner = plain(value)
    match inner:
        case int() if inner.bit_length() > LARGEST_NUMBER_BITS:
            return {"repr": hex(inner)}
        case None | bool() | str() | int():
            return inner
        case float():
            return inner if math.isfinite(inner) else {"repr": repr(inner)}
        case Vector(x=x, y=y):
            return [json_value(x), json_value(y)]
        case list() | tuple():
            return [json_value(v) for v in inner]
        case dict() if all(isinstance(plain(k), str) for k in inner):
            return {str(plain(k)): json_value(v) for k, v in inner.items()}
        case _ if is_scalar(inner):
            return float(inner)  # type: ignore[arg-type]
        case ScenicClass(name=name):
            return {"repr": name}
        case _:
            return {"repr": stable_repr(unwrap(inner)[0])}


def scene_of(
    state: State, seed: int, index: int, attempts: int, weight: float = 1.0, *, pruned: bool = False, simulated: bool = False
) -> Scene:
    """The scene (π, O) of a finished run; one that is simulated may get its ego later (reading `compose-only`).

    Raises `RunError` for values that cannot be written, since they contain themselves.
    """
    check_written(state)
    numbers = {instance.number: i for i, instance in enumerate(state.scene)}
    objects = tuple(_scene_object(i, instance, state) for i, instance in enumerate(state.scene))
    params = {name: unwrap(value)[0] for name, value in state.params.items()}
    workspace = workspace_of(state)
    ego = None if simulated and state.ego is None else numbers[ego_of(state).number]
    return Scene(objects, ego, params, seed, index, attempts, weight, workspace, pruned)


def check_written(state: State) -> None:
    """Check that what changed after it was given to the scene can still be written."""
    for name, value in state.params.items():
        check_nesting(f"the parameter {name}", value)
    for instance in state.scene:
        for name, value in state.objects[instance.number].items():
            check_nesting(f"the property {name} of {state.names.get(instance.number) or instance.class_.name}", value)


def _scene_object(number: int, instance: Instance, state: State) -> SceneObject:
    properties = {name: unwrap(value)[0] for name, value in state.objects[instance.number].items()}
    position, heading, width, length = (properties.pop(name) for name in OWN_FIELDS)
    assert isinstance(position, Vector)
    return SceneObject(
        number, state.names.get(instance.number), instance.class_.name, position, normalise_heading(heading), float(width), float(length), properties  # type: ignore[arg-type]
    )
