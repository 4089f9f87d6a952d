"""Values that contain themselves, or stand in each other too deep for what is done with them: errors, not the end of Python's stack."""

from __future__ import annotations

from .errors import RunError
from .syntax.nodes import NOWHERE, Span
from .values import CONTAINERS, Random

DEEPEST = 100
"""So many lists, tuples, sets and dictionaries may stand in each other in what is written of a scene."""
HINT = "does a list, dictionary or object contain itself, or a great many others in each other?"


def too_deep(span: Span = NOWHERE) -> RunError:
    """The error that Python has no room on its stack for an operation on a value."""
    return RunError("this operation nests too deeply", span, hint=HINT)


def check_nesting(what: str, value: object, span: Span = NOWHERE) -> None:
    """Raise `RunError` at `span` if containers in `value` stand in each other more than `DEEPEST` deep, or for ever."""
    if type(value) is not Random and not isinstance(value, CONTAINERS):
        return
    level: list[object] = [value]
    for _ in range(DEEPEST + 1):
        level = list({id(part): part for outer in level for part in containers_in(outer)}.values())
        if not level:
            return
    raise RunError(f"{what} contains itself, or holds containers more than {DEEPEST} deep", span, hint="the values of a scene are written")


def containers_in(value: object) -> list[object]:
    """The containers and random values that a value holds."""
    inner = value.value if type(value) is Random else value
    if inner is not value and isinstance(inner, CONTAINERS):
        return [inner]
    parts = inner.values() if isinstance(inner, dict) else inner if isinstance(inner, CONTAINERS) else ()
    return [part for part in parts if type(part) is Random or isinstance(part, CONTAINERS)]
