"""A scene as a program that makes just this scene."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..interpreter.dialects import DEFAULT, choose
from ..interpreter.printer import parameter_name
from ..semantics.kernel.classes import BUILT_IN_CLASSES, OBJECT_CLASS, built_in_defaults
from ..semantics.kernel.sets import Set
from ..semantics.kernel.values import unwrap
from ..semantics.python.builtins import BUILTINS
from ..semantics.python.texts import stable_repr
from ..semantics.space.regions import CircularRegion, RectangularRegion, SectorRegion, Workspace
from ..semantics.space.vectors import Vector

if TYPE_CHECKING:
    from .scenes import Scene, SceneObject

class Unwritten(Exception):
    """A value that no expression gives."""


def program_of(scene: Scene, dialect: str = DEFAULT) -> str:
    """The text of a program whose one scene has the objects, properties and parameters of `scene`. Raises `UsageError` for an unknown dialect."""
    syntax = choose("", dialect)
    new, pair = "new " if syntax.explicit_new else "", "tuple([{}])" if syntax.intervals else "({})"
    lines = [] if dialect == DEFAULT else [f"# dialect: {dialect}"]
    classes = dict.fromkeys(o.class_name for o in scene.objects if o.class_name not in BUILT_IN_CLASSES)
    for name in classes:
        lines += [f"class {name}:", "    pass"]
    lines += optional("workspace = ", scene.workspace, pair) if scene.workspace.bounds() is not None else []
    taken = {*classes, *BUILTINS, "ego", "workspace"}
    for o in scene.objects:
        own, comments = written(o, pair)
        name = o.name if o.name and o.name not in taken else "ego" if o.id == scene.ego_id else ""
        if o.name and o.name != name:
            comments.append(f"# {o.class_name}: its name was {o.name}")
        lines += [*comments, f"{name} = {new}{o.class_name} {', '.join(own)}" if name else f"{new}{o.class_name} {', '.join(own)}"]
        if name != "ego" and o.id == scene.ego_id:
            lines.append(f"ego = {name}")
    for name, value in scene.params.items():
        lines += optional(f"param {parameter_name(name)} = ", value, pair)
    return "\n".join(lines) + "\n"


def optional(begin: str, value: object, pair: str) -> list[str]:
    """The line of a statement about a value, or a comment that says what is missing."""
    try:
        return [f"{begin}{expression(value, pair)}"]
    except Unwritten:
        return [f"# {begin}{text_of(value)}"]


def written(o: SceneObject, pair: str) -> tuple[list[str], list[str]]:
    """The specifiers of an object, for what is not the built-in default, and comments for properties that no expression gives."""
    x, y = (expression(v, pair) for v in o.position)
    specifiers = [f"at ({x}, {y})", f"facing {expression(o.heading, pair)}"]
    comments: list[str] = []
    values = {"width": o.width, "length": o.length, **o.properties}
    for name, value in values.items():
        default = DEFAULTS.get(name, Unwritten)
        if type(value) is type(default) and value == default:
            continue
        try:
            text = expression(value, pair)
        except Unwritten:
            text = ""
        if text and name != "mutationScale":  # which would add noise again
            specifiers.append(f"with {name} {text}")
        else:
            comments.append(f"# {o.name or o.class_name}: {name} was {text_of(value)}")
    return specifiers, comments


DEFAULTS = {**built_in_defaults(OBJECT_CLASS), "visibleDistance": 50, "width": 1.0, "length": 1.0}


def text_of(value: object) -> str:
    """What a value is, for a comment of one line."""
    return " ".join(stable_repr(unwrap(value)[0]).split())


def expression(value: object, pair: str) -> str:
    """An expression of the language with this value; `pair` is how a tuple of two is written. Raises `Unwritten`."""

    def inside(values: Iterable[object]) -> str:
        return ", ".join(expression(v, pair) for v in values)

    match value:
        case None | bool() | int() | str():
            return repr(value)
        case float():
            return repr(value) if math.isfinite(value) else f"float('{value!r}')"
        case Vector(x=x, y=y):
            return f"Vector({inside((x, y))})"
        case list():
            return f"[{inside(value)}]"
        case tuple() if type(value) is tuple:
            return pair.format(inside(value)) if len(value) == 2 else f"({inside(value)}{',' if len(value) == 1 else ''})"
        case dict():
            return f"{{{', '.join(f'{expression(k, pair)}: {expression(v, pair)}' for k, v in value.items())}}}"
        case Set():
            return f"{{{inside(value)}}}" if value else "set()"
        case Workspace(region=region):
            return f"Workspace({expression(region, pair)})"
        case CircularRegion(center=center, radius=radius):
            return f"CircularRegion({inside((center, radius))})"
        case SectorRegion(center=center, radius=radius, heading=heading, angle=angle):
            return f"SectorRegion({inside((center, radius, heading, angle))})"
        case RectangularRegion(position=position, heading=heading, width=width, length=length):
            return f"RectangularRegion({inside((position, heading, width, length))})"
        case _:
            raise Unwritten

