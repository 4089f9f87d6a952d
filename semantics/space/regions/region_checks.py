"""Checks of the numbers that describe a region, common to all kinds of regions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..fields import VectorField
from ..numeric_functions import is_finite_number, to_floats
from ..vectors import Vector
from .errors import BadRegion

FURTHEST = 1e100
"""The largest coordinate and length of a region, in metres: products of three of them are still numbers, as overlays of shapes need."""


def check_finite(kind: str, name: str, value: float) -> float:
    """`value` as a float; `BadRegion` if it is not a finite number."""
    try:
        found = to_floats(value)
    except (TypeError, ValueError):
        raise BadRegion(f"the {name} of a {kind} must be a number, not {value!r}") from None
    if not is_finite_number(found):
        raise BadRegion(f"the {name} of a {kind} must be finite, not {found}")
    if isinstance(found, float) and abs(found) > FURTHEST:
        raise BadRegion(f"the {name} of a {kind} must be at most {FURTHEST:g}, not {found:g}")
    return found


def checked_number_field(kind: str, value: VectorField | None) -> VectorField | None:
    """`value` if it is a vector field or None; otherwise `BadRegion`."""
    if value is not None and not isinstance(value, VectorField):
        raise BadRegion(f"the orientation of a {kind} must be a vector field, not {value!r}")
    return value


def nonnegative(kind: str, name: str, value: float) -> float:
    """`value` as a float; `BadRegion` if it is not a finite number that is at least 0."""
    found = check_finite(kind, name, value)
    if found < 0:
        raise BadRegion(f"the {name} of a {kind} must not be negative, but it is {found}")
    return found


def check_vector(kind: str, name: str, value: Vector | Sequence[float]) -> Vector:
    """`value`, a vector or a pair of numbers, as a vector of finite floats; otherwise `BadRegion`."""
    try:
        x, y, *more = value
    except (TypeError, ValueError):
        raise BadRegion(f"the {name} of a {kind} must be a vector, not {value!r}") from None
    if any(more):
        raise BadRegion(f"the {name} of a {kind} is three-dimensional, {value!r}; this reference is two-dimensional")
    return Vector(check_finite(kind, f"x coordinate of the {name}", x), check_finite(kind, f"y coordinate of the {name}", y))


def vectors(kind: str, values: Iterable[Vector | Sequence[float]]) -> tuple[Vector, ...]:
    """Each of `values` as a vector of finite floats."""
    if not isinstance(values, Iterable):
        raise BadRegion(f"a {kind} is made from a list of points, not from {values!r}")
    return tuple(check_vector(kind, f"point {number}", value) for number, value in enumerate(values))
