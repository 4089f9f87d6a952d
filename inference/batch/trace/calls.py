"""What is known of calls that are made row by row: their names, what they suppose, the bounds of what they give."""

from __future__ import annotations

from ....semantics.kernel.values import Bound, Native
from ....semantics.space.fields import OutsideField, PolygonalVectorField, VectorField
from ....semantics.space.vectors import Vector
from .symbols import Traced


def name_of(function: object) -> str:
    """A function as reports call it."""
    if isinstance(function, Traced):
        return name_of(function.example)
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
