"""Scenes: the result (π, O) of a run, as a record and in the JSON format (DESIGN, section 7)."""

from __future__ import annotations

import json
import math
import pickle
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..interpreter.runtime.process_sandbox import limit_time
from ..pictures.map_layers import site_of
from ..pictures.notebook_views import line_of_object, line_of_scene, page_of_scene, plot_scene
from ..pictures.scene_figures import picture
from ..roads.user_maps import SiteMap
from ..semantics.machine.config import State
from ..semantics.machine.operand_kinds import is_scalar
from ..semantics.machine.value_nesting import check_nesting
from ..semantics.machine.values import Instance, copy_containers, unwrap, value_in_run
from ..semantics.programs import ego_of
from ..semantics.python.string_methods import stable_repr
from ..semantics.scenes.default_requirements import workspace_of
from ..semantics.space.geometry import normalise_heading
from ..semantics.space.regions import CircularRegion, RectangularRegion, Region, SectorRegion, everywhere
from ..semantics.space.regions.region import Everywhere
from ..semantics.space.vectors import Vector
from ..semantics.store.budget import items_of, plain_data
from ..semantics.store.errors import UsageError
from ..semantics.store.scenic_classes import ScenicClass
from .scene_to_scenic import program_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCHEMA = "scenic-ref/scene/1"
LARGEST_NUMBER_BITS = 10_000
OWN_FIELDS = ("position", "heading", "width", "length")


SURROGATE = re.compile("[\ud800-\udfff]")
"""Half of a pair of UTF-16, which is not a character and cannot be written in UTF-8."""


def in_json(value: object, *, allow_nan: bool = False, indent: int | None = None) -> str:
    """The text of a value in JSON, which can always be written in UTF-8. Raises `ValueError` for numbers that JSON does not have, unless allowed."""
    return in_utf8(json.dumps(value, allow_nan=allow_nan, ensure_ascii=False, indent=indent))


def in_utf8(text: str) -> str:
    """A text that can be written in UTF-8: halves of characters are escaped, as JSON does it."""
    return SURROGATE.sub(lambda half: f"\\u{ord(half[0]):04x}", text)


def scene_entry(
    seed: object, index: object, attempts: object, weight: object, params: object, ego: object, objects: list[dict[str, object]], *, pruned: bool
) -> dict[str, object]:
    """The fields of a scene in the scene format, in their order; what stands in them are values in JSON, or whatever is written for many scenes."""
    return {
        "schema": SCHEMA, "seed": seed, "scene": index, "attempts": attempts, "weight": weight, **({"pruned": True} if pruned else {}),
        "params": params, "ego": ego, "objects": objects,
    }  # fmt: skip


def object_entry(
    id: object, name: object, class_name: object, x: object, y: object, heading: object, width: object, length: object, properties: object
) -> dict[str, object]:
    """The fields of an object in the scene format, in their order, as in `scene_entry`."""
    return {
        "id": id, "name": name, "class": class_name, "position": [x, y], "heading": heading, "width": width, "length": length,
        "properties": properties,
    }  # fmt: skip


def problem_of(scene: object) -> str:
    """Return the reason why a value is not a scene of the format, or "". Numbers may be infinite or NaN:
    these are findings.
    """
    if not isinstance(scene, dict):
        return "a scene is an object in braces"
    if scene.get("schema", SCHEMA) != SCHEMA:
        return f"this is {scene['schema']!r}, not a scene"
    objects, params = scene.get("objects"), scene.get("params", {})
    if not isinstance(objects, list) or not isinstance(params, dict):
        return "a scene has a list `objects`" if not isinstance(objects, list) else "`params` maps names to values"
    if "attempts" in scene and not is_count(scene["attempts"]):
        return "`attempts` is not a whole number of at least 1"
    for i, o in enumerate(objects):
        if not isinstance(o, dict) or not isinstance(o.get("properties", {}), dict):
            return f"objects[{i}] is not an object of the format"
        position = o.get("position")
        if not (isinstance(position, list) and len(position) == 2 and is_int_or_float(position[0]) and is_int_or_float(position[1])):
            return f"objects[{i}].position is not a pair of numbers"
        for name in OWN_FIELDS[1:]:
            if name in o and not is_int_or_float(o[name]):
                return f"objects[{i}].{name} is not a number"
    return ""


def is_count(value: object) -> bool:
    """Whether a value is a whole number of at least 1."""
    return type(value) is int and value >= 1


def is_int_or_float(value: object) -> bool:
    """Whether a value in JSON is a number."""
    return type(value) is float or type(value) is int


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
    made: int | None = field(default=None, compare=False, repr=False)
    """The number of the instance in its run, by which properties of the scene's objects refer to it; None once the scene was pickled."""

    def __getitem__(self, name: str) -> object:
        """Any property by name; KeyError if the object has none of that name."""
        return getattr(self, name) if name in OWN_FIELDS else self.properties[name]

    def __repr__(self) -> str:
        return line_of_object(self)

    def __reduce__(self) -> tuple[Callable[..., SceneObject], tuple[object, ...]]:
        """For `pickle`: what is no plain data (behaviors, fields, other objects) is the text that stands for it in a file."""
        values = tuple(getattr(self, name) for name in tuple(self.__slots__)[:-2])
        return SceneObject, (*values, portable(dict(self.properties)))

    def to_json(self) -> dict[str, object]:
        """The entry of the scene format."""
        properties = {k: json_value(v) for k, v in self.properties.items()}
        return object_entry(
            self.id, self.name, self.class_name, self.position.x, self.position.y, self.heading, self.width, self.length, properties
        )


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
    site: SiteMap | None = field(default=None, compare=False, repr=False)
    """The map of the model `site_map`, which pictures show."""

    @property
    def ego(self) -> SceneObject:
        """The object from whose point of view the scene is. Raises `UsageError` if there is none (readings `no-ego`, `compose-only`)."""
        if self.ego_id is None:
            raise UsageError("the scene has no ego")
        return self.objects[self.ego_id]

    def __reduce__(self) -> tuple[Callable[..., Scene], tuple[object, ...]]:
        """For `pickle`; see `SceneObject.__reduce__`. A workspace that cannot be pickled is forgotten."""
        values = {name: getattr(self, name) for name in self.__slots__}
        try:
            pickle.dumps(self.workspace)
        except Exception:  # it is oriented by a function of the program, say
            values["workspace"] = everywhere
        return Scene, tuple((values | {"params": portable(dict(self.params))}).values())

    def to_scenic(self, dialect: str = "paper") -> str:
        """A program, in a dialect, that makes just this scene; what cannot be written of it is a comment."""
        return program_of(self, dialect)

    @limit_time("writing a scene")
    def to_json(self) -> dict[str, object]:
        """The scene as a JSON object."""
        params, objects = {k: json_value(v) for k, v in self.params.items()}, [o.to_json() for o in self.objects]
        return scene_entry(self.seed, self.index, self.attempts, self.weight, params, self.ego_id, objects, pruned=self.pruned)

    def to_line(self) -> str:
        """One line of a JSON Lines file."""
        return in_json(self.to_json())

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the scene, seen from above in metres, and return the axes: `ax`, or those of a new figure of `matplotlib.pyplot`.

        Raises `UsageError` for what are no axes, and for coordinates that cannot be drawn.
        """
        return plot_scene(self, ax)

    def __repr__(self) -> str:
        return line_of_scene(self)

    def _repr_html_(self) -> str:
        """The picture and a table of the objects, for notebooks."""
        return page_of_scene(self)

    def _repr_png_(self) -> bytes:
        """A picture, for notebooks. Raises `UsageError` for coordinates that cannot be drawn."""
        return picture([self])


@dataclass(frozen=True, slots=True)
class TextOnly:
    """A value of which only the text is left."""

    text: str

    def __repr__(self) -> str:
        return self.text


PLAIN_SHAPES = (Everywhere, CircularRegion, SectorRegion, RectangularRegion)


def portable(value: object) -> object:
    """A value that is plain data all through, with texts for what is not."""
    match value_in_run(value):
        case None | bool() | int() | float() | str() | bytes() | Vector() | TextOnly() as inner:
            return plain_data(inner)
        case list() as inner:
            return list(map(portable, items_of(inner)))
        case tuple() as inner:
            return tuple(map(portable, items_of(inner)))
        case dict() as inner:
            return {portable(k): portable(v) for k, v in dict.items(inner)}
        case Region() as inner if isinstance(inner, PLAIN_SHAPES):
            return inner
        case ScenicClass(name=name):
            return TextOnly(name)
        case inner:
            return float(inner) if is_scalar(inner) else TextOnly(stable_repr(unwrap(inner)[0]))  # type: ignore[arg-type]


def json_value(value: object) -> object:
    """A property or parameter in JSON; what has no JSON form is written as {"repr": "..."}."""
    inner = plain_data(value_in_run(value))
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
            return [json_value(v) for v in items_of(inner)]
        case dict() if all(isinstance(value_in_run(k), str) for k in items_of(inner)):
            return {plain_data(value_in_run(k)): json_value(v) for k, v in dict.items(inner)}
        case _ if is_scalar(inner):
            return float(inner)  # type: ignore[arg-type]
        case ScenicClass(name=name):
            return {"repr": name}
        case _:
            return {"repr": stable_repr(unwrap(inner)[0])}


@limit_time("writing a scene")
def scene_of(
    state: State, seed: int, index: int, attempts: int, weight: float = 1.0, *, pruned: bool = False, simulated: bool = False
) -> Scene:
    """The scene (π, O) of a finished run; one that is simulated may get its ego later (reading `compose-only`), others may have none (`no-ego`).

    Raises `RunError` for values that cannot be written, since they contain themselves.
    """
    check_written(state)
    numbers = {instance.number: i for i, instance in enumerate(state.scene)}
    seen: dict[int, tuple[object, object]] = {}
    objects = tuple(_scene_object(i, instance, state, seen) for i, instance in enumerate(state.scene))
    params = {name: copy_containers(unwrap(value)[0], seen) for name, value in state.params.items()}
    workspace = workspace_of(state)
    ego = ego_of(state, simulated=simulated)
    return Scene(objects, None if ego is None else numbers[ego.number], params, seed, index, attempts, weight, workspace, pruned, site_of(state))


def check_written(state: State) -> None:
    """Check that what changed after it was given to the scene can still be written."""
    for name, value in state.params.items():
        check_nesting(f"the parameter {name}", value)
    for instance in state.scene:
        for name, value in state.objects[instance.number].items():
            check_nesting(f"the property {name} of {state.names.get(instance.number) or instance.class_.name}", value)


def _scene_object(number: int, instance: Instance, state: State, seen: dict[int, tuple[object, object]]) -> SceneObject:
    properties = {name: copy_containers(unwrap(value)[0], seen) for name, value in state.objects[instance.number].items()}
    position, heading, width, length = (properties.pop(name) for name in OWN_FIELDS)
    assert isinstance(position, Vector)
    return SceneObject(
        number, state.names.get(instance.number), instance.class_.name, position, normalise_heading(heading), float(width), float(length),  # type: ignore[arg-type]
        properties, instance.number,
    )
