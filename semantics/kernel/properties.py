"""Values of the built-in properties: positions are vectors, sizes are finite and not negative."""

from __future__ import annotations

from ..space.numeric import is_truth
from ..space.vectors import Vector
from ..syntax.nodes import Span
from .classes import BOOLEAN_PROPERTIES, NON_NEGATIVE_PROPERTIES, SCALAR_PROPERTIES, VECTOR_PROPERTIES
from .config import State
from .errors import RunError
from .kinds import Reader, has_kind, is_finite, kind_name, repair
from .nesting import check_nesting
from .values import Instance, Random, unwrap


def checked_property(name: str, assigned: object, place: Span, source: str, state: State) -> object:
    """`assigned` as a value of the property: interpreted as its kind, or an error at `place` that names the specifier `source`."""
    if name == "viewDistance" and state.reading("view-distance") == "own":
        name = "a name like any other"
    if type(assigned) is int and assigned >= 0 and name in SCALAR_PROPERTIES:
        return assigned
    if name in VECTOR_PROPERTIES:
        kind, expected = "vector", "a vector"
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
    result = reader.read(inner, kind)
    if not is_finite(result):
        raise _bad(name, "finite", result, place, source)
    if name in NON_NEGATIVE_PROPERTIES and result < 0:  # type: ignore[operator]
        raise _bad(name, "at least 0", result, place, source)
    if type(assigned) is Random and not isinstance(inner, Instance):
        return Random(result, assigned.origin)
    return reader.wrap(result)


def _bad(name: str, expected: str, found: object, place: Span, source: str) -> RunError:
    is_number = isinstance(found, (int, float, Vector)) and not isinstance(found, bool)
    shown = str(found) if is_number else kind_name(found)
    if name == "positionStdDev" and isinstance(found, (tuple, list)):
        hint = "write one number, the standard deviation of each coordinate"
    else:
        hint = repair(found, {"heading" if name == "heading" else expected.removeprefix("a ")})
    return RunError(f"the property {name} must be {expected}, not {shown} (from `{source}`)", place, rule="E-ObjectDefinition", hint=hint)
