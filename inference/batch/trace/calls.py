"""What is known of calls that are made row by row: their names, what they suppose, the bounds of what they give."""

from __future__ import annotations

from collections.abc import Mapping

from ....semantics.kernel.values import Bound, Native
from ....semantics.python.elementwise import select
from ....semantics.space.fields import OutsideField, PolygonalVectorField, VectorField
from ....semantics.space.symbols import Listed
from ....semantics.space.vectors import Vector
from .symbols import Choice, Traced

PLAIN = (bool, int, float, str, type(None))


def siblings_of(value: object) -> tuple[object, ...]:
    """Return all values of the same kind, such as all lanes of a network; none where they cannot be listed."""
    return value.siblings if isinstance(value, Listed) else ()


def name_of(function: object) -> str:
    """A function as reports call it."""
    if isinstance(function, Traced):
        return name_of(function.example)
    if function is select:
        return "filter"
    owner = getattr(function, "__self__", function)
    return owner.name if isinstance(owner, (Native, Bound)) else getattr(function, "__qualname__", repr(function))


def premise_of(arguments: tuple[object, ...], text: str) -> str:
    """What a call supposes, in words: that a field has a value, or a region a point."""
    fields = [a for a in arguments if isinstance(a, VectorField)]
    return OutsideField(fields[0], Vector(0.0, 0.0)).premise if fields else text


def bounds_of_field(subject: object = None, *rest: object) -> tuple[float, float] | None:
    """The least and greatest heading of a field with constant cells."""
    if not (isinstance(subject, PolygonalVectorField) and subject.cells and all(isinstance(h, (int, float)) for _, h in subject.cells)):
        return None
    headings = [float(h) for _, h in subject.cells] + ([] if subject.defaultHeading is None else [subject.defaultHeading])  # type: ignore[arg-type]
    return min(headings), max(headings)


def key_of(function: object, arguments: tuple[object, ...], keywords: Mapping[str, object]) -> object:
    """What two calls share if they are one: the function and arguments that are nodes, numbers or the same object."""

    def part(value: object) -> object:
        if isinstance(value, Traced):
            return value.node if not isinstance(value, Choice) else (value.node, id(value.values))
        if isinstance(value, Vector):
            return part(value.x), part(value.y)
        return (type(value), value) if isinstance(value, PLAIN) else id(value)

    return ("call", function if not keywords else object(), *map(part, arguments))
