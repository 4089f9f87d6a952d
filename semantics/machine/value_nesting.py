"""Values that contain themselves, or stand in each other too deep for what is done with them: errors, not the end of Python's stack."""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ..store.budget import LARGEST_SEQUENCE, container_length, items_of, values_of
from ..store.errors import RunError
from ..syntax.nodes import NOWHERE, Span
from .values import CONTAINERS, Random, arguments_of, is_flat

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
    if isinstance(value, CONTAINERS) and is_flat(contained_values(value)):
        return
    level: list[object] = [value]
    for _ in range(DEEPEST + 1):
        level = list({id(part): part for outer in level for part in containers_in(outer)}.values())
        if not level:
            break
    else:
        raise RunError(f"{what} contains itself, or holds containers more than {DEEPEST} deep", span, hint="the values of a scene are written")
    if expanded_size(value) > LARGEST_SEQUENCE:
        raise RunError(f"{what} has more than {LARGEST_SEQUENCE:,} parts where it is written out", span, hint="the values of a scene are written")


def check_written(*values: object) -> None:
    """Refuse values that are compared, or become texts, part by part, where that would take too long (or never end). Raises `RunError`."""
    for value in values:
        value = arguments_of(value) if isinstance(value, BaseException) else value
        if isinstance(value, CONTAINERS) and expanded_size(value) > LARGEST_SEQUENCE:
            raise RunError(f"this value has more than {LARGEST_SEQUENCE:,} parts, where what stands in several places counts in each", hint=HINT)


def expanded_size(value: object, seen: dict[int, int] | None = None) -> int:
    """How many parts a value has where it is written out, what stands in several places counted in each; what is no container is one part.

    It takes no longer than there are different containers in it. Raises `RecursionError` for one that contains itself.
    """
    inner = value.value if type(value) is Random else value
    if not isinstance(inner, CONTAINERS):
        return 1
    seen = {} if seen is None else seen
    known = seen.get(id(inner))
    if known is None:
        flat = is_flat(contained_values(inner))
        known = seen[id(inner)] = 1 + (container_length(inner) if flat else sum(expanded_size(part, seen) for part in contained_values(inner)))
    return known


def contained_values(container: Any) -> Iterable[Any]:
    """Return the values in a container: of a dictionary its values, not its keys."""
    return values_of(container) if isinstance(container, dict) else items_of(container)


def containers_in(value: object) -> list[object]:
    """The containers and random values that a value holds."""
    inner = value.value if type(value) is Random else value
    if inner is not value and isinstance(inner, CONTAINERS):
        return [inner]
    parts = contained_values(inner) if isinstance(inner, CONTAINERS) else ()
    return [part for part in parts if type(part) is Random or isinstance(part, CONTAINERS)]
