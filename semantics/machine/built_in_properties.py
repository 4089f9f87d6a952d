"""Values of the built-in properties: positions are vectors, sizes are finite and not negative."""

from __future__ import annotations

from ..space.numeric_functions import is_truth
from ..space.vectors import Vector
from ..store.built_in_classes import (
    BOOLEAN_PROPERTIES,
    NON_NEGATIVE_PROPERTIES,
    SCALAR_PROPERTIES,
    VECTOR_PROPERTIES,
)
from ..store.errors import RunError
from ..syntax.nodes import Span
from .config import State
from .operand_kinds import Reader, has_kind, in_the_plane, is_finite, kind_name, repair
from .value_nesting import check_nesting
from .values import Instance, Random, unwrap

EXACT = 2**53
"""Whole numbers up to this one are floats without rounding."""


def checked_property(name: str, assigned: object, place: Span, source: str, state: State) -> object:
    """`assigned` as a value of the property: interpreted as its kind, or an error at `place` that names the specifier `source`."""
    if name == "viewDistance" and state.reading("view-distance") == "own":
        name = "a name like any other"
    if type(assigned) is int and 0 <= assigned <= EXACT and name in SCALAR_PROPERTIES:
        return assigned
    if name in VECTOR_PROPERTIES:
        kind, expected, assigned = "vector", "a vector", in_the_plane(assigned, state)
    elif name in SCALAR_PROPERTIES:
        kind, expected = "heading" if name == "heading" else "scalar", "a scalar"
    elif name in BOOLEAN_PROPERTIES:
        if not is_truth(unwrap(assigned)[0]):
            raise _bad(name, "True or False", unwrap(assigned)[0], place, source)
        return assigned
    else:
        check_nesting(f"{source}: the property {name}", assigned, place)
        return assigned
    reader = Reader(state)
    inner = reader.plain(assigned)
    if not has_kind(inner, kind):
        raise _bad(name, expected, inner, place, source)
    try:
        result = exact(reader.read(inner, kind))
    except OverflowError:
        raise RunError(f"the property {name} is too large for a number (from `{source}`)", place, rule="E-ObjectDefinition") from None
    if not is_finite(result):
        raise _bad(name, "finite", result, place, source)
    if name in NON_NEGATIVE_PROPERTIES and result < 0:  # type: ignore[operator]
        raise _bad(name, "at least 0", result, place, source)
    if type(assigned) is Random and not isinstance(inner, Instance):
        return Random(result, assigned.origin)
    return reader.wrap(result)


def exact(result: object) -> object:
    """Return a whole number that is too large to be exact as a float as that float; anything else as it is. Raises OverflowError."""
    return float(result) if type(result) is int and abs(result) > EXACT else result


def _bad(name: str, expected: str, found: object, place: Span, source: str) -> RunError:
    is_number = isinstance(found, (int, float, Vector)) and not isinstance(found, bool)
    shown = str(found) if is_number else kind_name(found)
    if name == "positionStdDev" and isinstance(found, (tuple, list)):
        hint = "write one number, the standard deviation of each coordinate"
    else:
        hint = repair(found, {"heading" if name == "heading" else expected.removeprefix("a ")})
    return RunError(f"the property {name} must be {expected}, not {shown} (from `{source}`)", place, rule="E-ObjectDefinition", hint=hint)
