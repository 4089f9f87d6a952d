"""Values with symbols inside: the nodes in them, and what they are in one row."""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Callable
from types import BuiltinFunctionType, MethodType
from typing import Any

from ....semantics.kernel.budget import PLAIN
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
    if type(value) in PLAIN or (type(value) is Vector and type(value.x) is float and type(value.y) is float):
        return
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


def in_row(value: object, resolve: Resolve) -> Any:
    """The value in a row, of which `resolve` gives the value of a node."""
    return row_maker(value)(resolve)


def row_maker(value: object) -> Callable[[Resolve], Any]:
    """What gives the value in each row: where its symbols stand is found once."""
    if not symbols_in(value):
        return lambda resolve: value
    match value:
        case Choice(node=node):
            among = [row_maker(v) for v in value.values]
            return lambda resolve: among[resolve(node)](resolve)  # type: ignore[index]
        case Traced(node=node):
            return lambda resolve: resolve(node)
        case Random():
            return row_maker(value.value)
        case Vector():
            x, y = row_maker(value.x), row_maker(value.y)
            return lambda resolve: Vector(x(resolve), y(resolve))
        case dict():
            pairs = [(row_maker(k), row_maker(v)) for k, v in value.items()]
            return _like(value, lambda resolve: {k(resolve): v(resolve) for k, v in pairs})
        case tuple() if hasattr(value, "_fields"):
            parts = [row_maker(v) for v in value]
            return lambda resolve: type(value)(*[v(resolve) for v in parts])  # pyright: ignore[reportArgumentType]
        case list() | tuple() | set() | frozenset() | deque():
            items = [row_maker(v) for v in value]
            return _like(value, lambda resolve: [v(resolve) for v in items])
        case BuiltinFunctionType() | MethodType():
            subject = row_maker(value.__self__)
            return lambda resolve: getattr(subject(resolve), value.__name__)
        case Dynamic():
            arguments = row_maker(value.arguments)
            return lambda resolve: dataclasses.replace(value, arguments=arguments(resolve))
        case _:
            fields = {f.name: row_maker(getattr(value, f.name)) for f in dataclasses.fields(value)}  # type: ignore[arg-type]
            return lambda resolve: dataclasses.replace(value, **{name: made(resolve) for name, made in fields.items()})  # type: ignore[type-var]


def _like(container: object, content: Callable[[Resolve], Any]) -> Callable[[Resolve], Any]:
    """The content in a container of the same type."""
    if type(container) not in (list, tuple, Set, FrozenSet, dict):
        raise NotLifted(f"a {type(container).__name__} holds random values")
    kind: Any = type(container)
    return lambda resolve: kind(content(resolve))



def children(node: GraphNode) -> list[GraphNode]:
    """The nodes that a node is computed from."""
    if isinstance(node.function, (RowCall, RowDraw)):
        called = node.function
        return nodes_in((called.structure, called.keywords) if isinstance(called, RowCall) else called.distribution)
    return [a for a in node.arguments if isinstance(a, GraphNode)]
