"""A scene as a program that makes just this scene."""

from __future__ import annotations

import keyword
import math
from typing import TYPE_CHECKING

from ..interpreter.dialects import DEFAULT, choose
from ..semantics.kernel.classes import BUILT_IN_CLASSES, OBJECT_CLASS, built_in_defaults
from ..semantics.kernel.values import unwrap
from ..semantics.python.builtins import BUILTINS
from ..semantics.python.texts import stable_repr
from ..semantics.space.regions import CircularRegion, RectangularRegion, SectorRegion, Workspace
from ..semantics.space.vectors import Vector

if TYPE_CHECKING:
    from .scenes import Scene, SceneObject

REFUSED = frozenset({"mutationScale"})
"""Properties that would change the scene: it is mutated already."""


class Unwritten(Exception):
    """A value that no expression gives."""


def program_of(scene: Scene, dialect: str = DEFAULT) -> str:
    """The text of a program whose one scene has the objects, properties and parameters of `scene`. Raises `UsageError` for an unknown dialect."""
    new = "new " if choose("", dialect).explicit_new else ""
    lines = [] if dialect == DEFAULT else [f"# dialect: {dialect}"]
    classes = dict.fromkeys(o.class_name for o in scene.objects if o.class_name not in BUILT_IN_CLASSES)
    for name in classes:
        lines += [f"class {name}:", "    pass"]
    lines += optional("workspace = ", scene.workspace) if scene.workspace.bounds() is not None else []
    taken = {*classes, *BUILTINS, "ego", "workspace"}
    for o in scene.objects:
        own, comments = written(o)
        name = o.name if o.name and o.name.isidentifier() and not keyword.iskeyword(o.name) and o.name not in taken else ""
        taken.add(name)
        left = f"{name} = " if name else "ego = " if o.id == scene.ego_id else ""
        lines += [*comments, f"{left}{new}{o.class_name} {', '.join(own)}"]
        if name and o.id == scene.ego_id:
            lines.append(f"ego = {name}")
    for name, value in scene.params.items():
        lines += optional(f"param {name if name.isidentifier() else repr(name)} = ", value)
    return "\n".join(lines) + "\n"


def optional(begin: str, value: object) -> list[str]:
    """The line of a statement about a value, or a comment that says what is missing."""
    try:
        return [f"{begin}{expression(value)}"]
    except Unwritten:
        return [f"# {begin}{text_of(value)}"]


def written(o: SceneObject) -> tuple[list[str], list[str]]:
    """The specifiers of an object, for what is not the built-in default, and comments for properties that no expression gives."""
    x, y = map(expression, o.position)
    specifiers = [f"at ({x}, {y})", f"facing {expression(o.heading)}"]
    comments: list[str] = []
    values = {"width": o.width, "length": o.length, **o.properties}
    for name, value in values.items():
        default = DEFAULTS.get(name, Unwritten)
        if name in REFUSED or (type(value) is type(default) and value == default):
            continue
        try:
            specifiers.append(f"with {name} {expression(value)}")
        except Unwritten:
            comments.append(f"# {o.name or o.class_name}: {name} was {text_of(value)}")
    return specifiers, comments


DEFAULTS = {**built_in_defaults(OBJECT_CLASS), "width": 1.0, "length": 1.0}


def text_of(value: object) -> str:
    """What a value is, for a comment of one line."""
    return " ".join(stable_repr(unwrap(value)[0]).split())


def expression(value: object) -> str:
    """An expression of the language with this value. Raises `Unwritten`."""
    match value:
        case None | bool() | int() | str():
            return repr(value)
        case float():
            return repr(value) if math.isfinite(value) else f"float('{value!r}')"
        case Vector(x=x, y=y):
            return f"Vector({expression(x)}, {expression(y)})"
        case list():
            return f"[{', '.join(map(expression, value))}]"
        case tuple() if type(value) is tuple:
            return f"({', '.join(map(expression, value))}{',' if len(value) == 1 else ''})"
        case dict():
            return f"{{{', '.join(f'{expression(k)}: {expression(v)}' for k, v in value.items())}}}"
        case Workspace(region=region):
            return f"Workspace({expression(region)})"
        case CircularRegion(center=center, radius=radius):
            return f"CircularRegion({expression(center)}, {expression(radius)})"
        case SectorRegion(center=center, radius=radius, heading=heading, angle=angle):
            return f"SectorRegion({', '.join(map(expression, (center, radius, heading, angle)))})"
        case RectangularRegion(position=position, heading=heading, width=width, length=length):
            return f"RectangularRegion({', '.join(map(expression, (position, heading, width, length)))})"
        case _:
            raise Unwritten

