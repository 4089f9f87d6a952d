"""Values with symbols inside: the nodes in them, and what they are in one row."""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Callable
from types import BuiltinFunctionType, MethodType
from typing import Any

from ....semantics.kernel.scenic_classes import ScenicClass
from ....semantics.kernel.sets import FrozenSet, Set
from ....semantics.kernel.values import Dynamic, Function, Instance, Method, Module, Pairs, Random, unwrap
from ....semantics.space.symbols import NotLifted
from ....semantics.space.vectors import Vector
from .graph import GraphNode, RowCall, RowDraw
from .symbols import Choice, Traced

Resolve = Callable[[GraphNode], object]


def symbols_in(value: object) -> list[Traced]:
    """The symbols in a value, however deep."""
    found: list[Traced] = []
    _collect(value, found, 0)
    return found


def nodes_in(value: object) -> list[GraphNode]:
    """The nodes of these symbols."""
    return [symbol.node for symbol in symbols_in(value)]


def _collect(value: object, found: list[Traced], depth: int) -> None:
    if depth > 50:
        raise NotLifted("a value is nested too deeply")
    match value:
        case Choice():
            found.append(value)
            for entry in value.values:
                _collect(entry, found, depth + 1)
        case Traced():
            found.append(value)
        case Pairs():
            raise NotLifted("a dictionary with random keys")
        case Random():
            _collect(value.value, found, depth + 1)
        case BaseException() if unwrap(value)[1] is not None:
            raise NotLifted("an exception is made of something random")
        case Vector():
            _collect(value.x, found, depth + 1)
            _collect(value.y, found, depth + 1)
        case dict():
            for pair in value.items():
                _collect(pair, found, depth + 1)
        case list() | tuple() | set() | frozenset() | deque():
            for item in value:
                _collect(item, found, depth + 1)
        case BuiltinFunctionType() | MethodType():
            _collect(value.__self__, found, depth + 1)
        case _ if not isinstance(value, type) and dataclasses.is_dataclass(value) and not isinstance(value, ATOMS):
            for field in dataclasses.fields(value):
                _collect(getattr(value, field.name), found, depth + 1)
        case Dynamic(arguments=arguments) if arguments is not None:
            _collect(arguments, found, depth + 1)


ATOMS = (Instance, ScenicClass, Function, Method, Module, Dynamic)


def in_row(value: object, resolve: Resolve) -> object:
    """The value in a row, of which `resolve` gives the value of a node."""
    if not symbols_in(value):
        return value
    match value:
        case Choice():
            return in_row(value.values[resolve(value.node)], resolve)  # type: ignore[index]
        case Traced():
            return resolve(value.node)
        case Random():
            return in_row(value.value, resolve)
        case Vector():
            return Vector(in_row(value.x, resolve), in_row(value.y, resolve))  # type: ignore[arg-type]
        case dict():
            return _like(value, {in_row(k, resolve): in_row(v, resolve) for k, v in value.items()})
        case tuple() if hasattr(value, "_fields"):
            return type(value)(*[in_row(v, resolve) for v in value])  # pyright: ignore[reportArgumentType]
        case list() | tuple() | set() | frozenset() | deque():
            return _like(value, [in_row(v, resolve) for v in value])
        case BuiltinFunctionType() | MethodType():
            return getattr(in_row(value.__self__, resolve), value.__name__)
        case Dynamic():
            return dataclasses.replace(value, arguments=in_row(value.arguments, resolve))  # type: ignore[arg-type]
        case _:
            return dataclasses.replace(value, **{f.name: in_row(getattr(value, f.name), resolve) for f in dataclasses.fields(value)})  # type: ignore[type-var, arg-type]


def _like(container: object, content: Any) -> object:
    """The content in a container of the same type."""
    if type(container) not in (list, tuple, Set, FrozenSet, dict):
        raise NotLifted(f"a {type(container).__name__} holds random values")
    kind: Any = type(container)
    return kind(content)


def children(node: GraphNode) -> list[GraphNode]:
    """The nodes that a node is computed from."""
    if isinstance(node.function, (RowCall, RowDraw)):
        called = node.function
        return nodes_in((called.structure, called.keywords) if isinstance(called, RowCall) else called.distribution)
    return [a for a in node.arguments if isinstance(a, GraphNode)]
