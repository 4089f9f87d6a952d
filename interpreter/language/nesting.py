"""How deep a tree is: the limit that keeps every walk over it, recursive ones too, within the stack."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from functools import cache

from ...semantics.store.errors import ParseError
from ...semantics.syntax import Node
from ...semantics.syntax.expressions import ObjectOrOperator

LIMIT = 400
ROOM = 20 * LIMIT
"""Calls on Python's stack that a recursive walk over a tree of this depth may take."""
READINGS_LIMIT = 12  # A tree with n nested ObjectOrOperator has 2 ** n paths.


@contextmanager
def room() -> Iterator[None]:
    """Python lets a walk over a tree recurse to its depth: printing, comparing, pickling."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, ROOM))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


@cache
def field_names(kind: type[Node]) -> tuple[str, ...]:
    """The fields of a kind of node that make it what it is, which is all but its place in the source."""
    return tuple(field.name for field in fields(kind) if field.name != "span")


def children(node: Node) -> Iterator[Node]:
    """The nodes directly below `node`, in the order of its fields."""
    for name in field_names(type(node)):
        value = getattr(node, name)
        if isinstance(value, Node):
            yield value
        elif isinstance(value, tuple):
            yield from _inside(value)


def _inside(value: tuple[object, ...]) -> Iterator[Node]:
    """The nodes in a tuple, which may hold pairs of nodes (dictionary displays)."""
    for item in value:
        if isinstance(item, Node):
            yield item
        elif isinstance(item, tuple):
            yield from (part for part in item if isinstance(part, Node))


def same(one: object, other: object) -> bool:
    """Whether two trees are equal. It does not recurse: comparing is work of Python's C code, whose stack `room` does not lengthen in 3.12."""
    pending = [(one, other)]
    while pending:
        one, other = pending.pop()
        if isinstance(one, Node) and type(one) is type(other):
            pending.extend((getattr(one, name), getattr(other, name)) for name in field_names(type(one)))
        elif isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
            pending.extend(zip(one, other, strict=True))
        elif type(one) is not type(other) or one != other:
            return False
    return True


def check_nesting(roots: tuple[Node, ...]) -> None:
    """Raises ParseError where a tree is deeper than LIMIT; it does not recurse and visits shared parts once."""
    depths: dict[int, tuple[int, int]] = {}
    pending: list[tuple[Node, tuple[Node, ...] | None]] = [(root, None) for root in reversed(roots)]
    while pending:
        node, below = pending.pop()
        if below is None:
            if id(node) in depths:
                continue
            below = tuple(children(node))
            pending.append((node, below))
            pending.extend((child, None) for child in below)
            continue
        depth = 1 + max((depths[id(child)][0] for child in below), default=0)
        readings = isinstance(node, ObjectOrOperator) + max((depths[id(child)][1] for child in below), default=0)
        depths[id(node)] = depth, readings
        if depth > LIMIT or readings > READINGS_LIMIT:
            raise ParseError("nested too deeply", node.span, hint="name parts of it in separate assignments")
