"""A scene as a program that makes just this scene."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count
from typing import TYPE_CHECKING, NamedTuple

from ..interpreter.language.dialects import DEFAULT, choose
from ..interpreter.language.printer import parameter_name
from ..semantics.machine.sandbox_table import is_user_made
from ..semantics.machine.values import Instance, unwrap
from ..semantics.python.builtins import BUILTINS
from ..semantics.python.string_methods import stable_repr
from ..semantics.space.regions import (
    CircularRegion,
    RectangularRegion,
    SectorRegion,
    Workspace,
    everywhere,
    nowhere,
)
from ..semantics.space.vectors import Vector
from ..semantics.store.built_in_classes import OBJECT_CLASS, built_in_defaults
from ..semantics.store.sets import Set

if TYPE_CHECKING:
    from .scene import Scene, SceneObject

class Unwritten(Exception):
    """A value that no expression gives."""


class Writing(NamedTuple):
    """How values are written: a tuple of two, the objects made so far, by their numbers in the run, and second names of built-ins."""

    pair: str
    names: dict[int, str]
    shadowed: Mapping[str, str]

    def call(self, name: str, arguments: str) -> str:
        """Return the call of a built-in, under its second name where a class of the program has its own."""
        return f"{self.built_in(name)}({arguments})"

    def built_in(self, name: str) -> str:
        """Return the name under which a built-in can be had."""
        return self.shadowed.get(name, name)


def program_of(scene: Scene, dialect: str = DEFAULT) -> str:
    """The text of a program whose one scene has the objects, properties and parameters of `scene`. Raises `UsageError` for an unknown dialect.

    A property that holds an object made later is assigned when all are made.
    """
    syntax = choose("", dialect)
    new = "new " if syntax.explicit_new else ""
    lines = [] if dialect == DEFAULT else [f"# dialect: {dialect}"]
    classes = dict.fromkeys(o.class_name for o in scene.objects if o.class_name != OBJECT_CLASS.name)
    shadowed = second_names(scene, classes)
    known = Writing(f"{shadowed.get('tuple', 'tuple')}([{{}}])" if syntax.intervals else "({})", {}, shadowed)
    lines += [f"{other} = {name}" for name, other in shadowed.items()]
    for name in classes:
        lines += [f"class {name}:", "    pass"]
    lines += optional("workspace = ", scene.workspace, known) if scene.workspace.bounds() is not None else []
    taken = {*classes, *shadowed.values(), *BUILTINS, "ego", "workspace"}
    own_names = [o.name if o.name and o.name not in taken else "ego" if o.id == scene.ego_id else "" for o in scene.objects]
    called = references(scene, own_names, taken)
    later: list[tuple[str, object]] = []
    for o, own_name in zip(scene.objects, own_names, strict=True):
        reference = called.get(o.made)
        name = own_name or reference or ""
        own, comments, awaiting = object_specifiers(o, known, called, released=syntax.released)
        if o.name and o.name != name:
            comments.append(f"# {o.class_name}: its name was {o.name}")
        lines += [*comments, f"{name} = {new}{o.class_name} {', '.join(own)}" if name else f"{new}{o.class_name} {', '.join(own)}"]
        lines += [f"ego = {name}"] if name != "ego" and o.id == scene.ego_id else []
        if reference is not None and o.made is not None:
            lines += [f"{reference} = {name}"] if reference != name else []
            known.names[o.made] = reference
        later += [(f"{reference}.{property} = ", o.properties[property]) for property in awaiting]
    for begin, value in (*later, *((f"param {parameter_name(name)} = ", value) for name, value in scene.params.items())):
        lines += optional(begin, value, known)
    return "\n".join(lines) + "\n"


WRITTEN = (
    "float", "bytes", "set", "frozenset", "range", "tuple", "Vector", "Workspace", "CircularRegion", "SectorRegion", "RectangularRegion",
    "everywhere", "nowhere",
)  # fmt: skip
"""Built-ins that `expression` writes."""


DECIMAL_BITS = 10_000
"""Of longer whole numbers Python writes and reads the hexadecimal digits alone."""


def second_names(scene: Scene, classes: Iterable[str]) -> dict[str, str]:
    """Return second names for the built-ins of `WRITTEN` whose names the classes of the program have."""
    used = {*classes, *BUILTINS, *(o.name for o in scene.objects)}
    return {name: next(n for n in (f"built_in{'_' * i}{name}" for i in count(1)) if n not in used) for name in classes if name in WRITTEN}


def references(scene: Scene, names: Sequence[str], taken: set[str]) -> dict[int | None, str]:
    """Under which name to refer to an object, by its number in the run, for those that others hold, or that hold one made later (or themselves).

    That is its own name where it has one to itself.
    """
    wanted = set(numbers_in(list(scene.params.values())))
    before: set[int | None] = set()
    made = {o.made for o in scene.objects if o.made is not None}
    for o in scene.objects:
        held = made.intersection(numbers_in(list(o.properties.values())))
        wanted |= held
        if not held <= before and o.made is not None:
            wanted.add(o.made)
        before.add(o.made)
    found: dict[int | None, str] = {}
    used = {*taken, *names}
    for o, name in zip(scene.objects, names, strict=True):
        if o.made is None or o.made not in wanted:
            continue
        if not name or names.count(name) > 1:
            name = next(n for n in (f"{base}{o.id}" for base in ("object_", "object__", "object___")) if n not in used)
        found[o.made] = name
    return found


def numbers_in(value: object) -> Iterator[int]:
    """The numbers of the instances that a value holds, however deep."""
    match value:
        case Instance(number=number):
            yield number
        case dict():
            for key, item in value.items():
                yield from (*numbers_in(key), *numbers_in(item))
        case list() | tuple() | Set():
            for item in value:
                yield from numbers_in(item)
        case _:
            pass


def optional(begin: str, value: object, known: Writing) -> list[str]:
    """The line of a statement about a value, or a comment that says what is missing."""
    try:
        return [f"{begin}{expression(value, known)}"]
    except Unwritten:
        return [f"# {begin}{comment_text(value)}"]


def object_specifiers(o: SceneObject, known: Writing, called: Mapping[int | None, str], *, released: bool) -> tuple[list[str], list[str], list[str]]:
    """The specifiers of an object, for what is not the built-in default, comments for properties that no expression gives, and the names of those
    that hold objects made later, which are None at first.
    """
    x, y = (expression(v, known) for v in o.position)
    specifiers = [f"at ({x}, {y})", f"facing {expression(o.heading, known)}"]
    comments: list[str] = []
    awaiting: list[str] = []
    values = {"width": o.width, "length": o.length, **o.properties}
    for name, value in values.items():
        default = DEFAULTS.get(name, Unwritten)
        if type(value) is type(default) and value == default:
            continue
        spelled = "visibleDistance" if released and name == "viewDistance" and "visibleDistance" not in values else name
        numbers = set(numbers_in(value))
        if numbers and numbers <= called.keys() and not numbers <= known.names.keys():
            awaiting.append(name)
            specifiers.append(f"with {spelled} None")
            continue
        try:
            text = expression(value, known)
        except Unwritten:
            text = ""
        if text and name != "mutationScale":  # which would add noise again
            specifiers.append(f"with {spelled} {text}")
        else:
            comments.append(f"# {o.name or o.class_name}: {name} was {comment_text(value)}")
    return specifiers, comments, awaiting


DEFAULTS = {**built_in_defaults(OBJECT_CLASS), "visibleDistance": 50, "width": 1.0, "length": 1.0}


def comment_text(value: object) -> str:
    """Return the text of a value for a comment of one line."""
    return " ".join(stable_repr(unwrap(value)[0]).split())


def expression(value: object, known: Writing) -> str:
    """An expression of the language with this value. Raises `Unwritten`."""

    def inside(values: Iterable[object]) -> str:
        return ", ".join(expression(v, known) for v in values)

    match value:
        case Instance(number=number) if number in known.names:
            return known.names[number]
        case tuple() if type(value) is tuple or hasattr(value, "_fields"):
            return known.pair.format(inside(value)) if len(value) == 2 else f"({inside(value)}{',' if len(value) == 1 else ''})"
        case _ if is_user_made(value):
            raise Unwritten
        case None | bool() | str() | bytes():
            return repr(value)
        case int():
            return repr(value) if value.bit_length() <= DECIMAL_BITS else hex(value)
        case float():
            return repr(value) if math.isfinite(value) else known.call("float", f"'{value!r}'")
        case list():
            return f"[{inside(value)}]"
        case dict():
            return f"{{{', '.join(f'{expression(k, known)}: {expression(v, known)}' for k, v in value.items())}}}"
        case Set():
            return f"{{{inside(value)}}}" if value else known.call("set", "")
        case frozenset():
            return known.call("frozenset", f"[{inside(value)}]" if value else "")
        case range(start=start, stop=stop, step=step):
            return known.call("range", inside((start, stop) if step == 1 else (start, stop, step)))
        case _:
            return plane_value(value, known)


def plane_value(value: object, known: Writing) -> str:
    """An expression for a vector, a region or a workspace. Raises `Unwritten` for anything else."""

    def made(name: str, *parts: object) -> str:
        return known.call(name, ", ".join(expression(part, known) for part in parts))

    match value:
        case Vector(x=x, y=y):
            return made("Vector", x, y)
        case Workspace(region=inner):
            return made("Workspace", inner)
        case CircularRegion(center=center, radius=radius):
            return made("CircularRegion", center, radius)
        case SectorRegion(center=center, radius=radius, heading=heading, angle=angle):
            return made("SectorRegion", center, radius, heading, angle)
        case RectangularRegion(position=position, heading=heading, width=width, length=length):
            return made("RectangularRegion", position, heading, width, length)
        case _ if value is everywhere or value is nowhere:
            return known.built_in(repr(value))
        case _:
            raise Unwritten
