"""Iteration: the number of elements may not be random, but for functions that nothing branches in (reading
`random-length`).
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

import operator as python
from collections.abc import Mapping
from typing import Any

from ..machine.conditions import random_branch
from ..machine.config import State
from ..machine.host_calls import HostException, host, raw
from ..machine.operand_kinds import is_vector, symbolic_items
from ..machine.values import Origin, Random, value_in_run, wrap
from ..space.vectors import Vector
from ..store.budget import LARGEST_SEQUENCE
from ..store.errors import RunError
from ..store.postponed_values import Waiting, needs_position
from ..store.sets import FrozenSet, Set
from ..syntax.nodes import Node


def elements(iterable: object, node: Node, state: State) -> list[object]:
    """The items of something iterated over; how many there are may not be random."""
    if type(iterable) is Random:
        known = known_elements(iterable, state)
        if known is None:
            raise random_branch(iterable, node, "how many elements this has", "give it a number of elements that is fixed, as in `range(3)`")
        return known
    if isinstance(iterable, range) and len(iterable) > LARGEST_SEQUENCE:
        raise RunError(f"{len(iterable)} elements are too many", node.span)
    if type(iterable) is Waiting:
        raise needs_position(iterable)
    try:
        result = raw(state.settings.door, state, list, iterable)
    except HostException as problem:
        problem.span = problem.span or node.span
        if type(iterable) is int and 0 <= iterable <= LARGEST_SEQUENCE:
            problem.exception.add_note(f"write range({iterable})")
        raise
    state.settings.door.budget.made(value_in_run(result))
    if type(result) is Random:  # an iterator of the program gave something random
        raise random_branch(result, node, "what its iterator gives")
    return result  # type: ignore[return-value]


def known_elements(iterable: Random, state: State) -> list[object] | None:
    """The items of a random vector, or of a draw among containers that all have the same number of them, each random; None for anything else."""
    length = known_length(iterable)
    if is_vector(iterable.value) and (length is not None or iterable.origin.distribution is None):
        return [host(state.settings.door, state, python.attrgetter(axis), iterable) for axis in ("x", "y")]
    if length is not None and length > LARGEST_SEQUENCE:
        raise RunError(f"{length} elements are too many")
    return None if length is None else [host(state.settings.door, state, element_at, iterable, place) for place in range(length)]


def known_length(value: object) -> int | None:
    """How many items a value has in every run; None if it may be something else than a container or a vector, or if their number differs."""
    if type(value) is not Random:
        return len(value) if isinstance(value, (*INDEXED, Mapping, Set, FrozenSet)) else None
    if value.origin.distribution is None:
        return None
    lengths = {known_length(v) for v, _ in value.origin.distribution.support() or ((None, 1),)}
    return lengths.pop() if len(lengths) == 1 else None


INDEXED = (list, tuple, str, range, Vector)


def element_at(container: Any, place: int) -> object:
    """The item that is the next one after so many, when the container is iterated over."""
    return container[place] if isinstance(container, INDEXED) else list(container)[place]


def elements_in_this_run(iterable: object, node: Node, state: State, chosen: bool = False) -> tuple[list[object], Origin | None]:
    """The items of something iterated over where their number may be random, and the draw that it depends on, if it is.

    `chosen`: a distribution chooses among them, so that something that stands for them all is enough.
    """
    if type(iterable) is not Random or known_elements(iterable, state):
        return elements(iterable, node, state), None
    found = (symbolic_items(iterable.value) if chosen else None) or elements(iterable.value, node, state)
    return [wrap(v, iterable.origin) for v in found], iterable.origin
