"""Scenic classes: what they descend from, and the default value expressions of their properties."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

from ..syntax.nodes import NOWHERE, Node, Span
from ..syntax.python_expressions import TupleDisplay
from .scopes import Scope

Kind = TypeVar("Kind", bound=type)


def name_in_messages(name: str) -> Callable[[Kind], Kind]:
    """Give a class the name that Python's own messages call its values by, as in "'instance' object is not iterable"."""

    def decorate(kind: Kind) -> Kind:
        kind.__name__ = name
        return kind

    return decorate


@name_in_messages("class")
@dataclass(frozen=True, eq=False)
class ScenicClass:
    """A Scenic class: its own defaults as expressions, its methods, and the scope in which both are evaluated."""

    name: str
    superclasses: tuple[ScenicClass, ...]
    own_defaults: Mapping[str, Node]
    scope: Scope
    methods: Mapping[str, object] = field(default_factory=dict[str, object])
    span: Span = NOWHERE
    built_in: bool = False
    own_finals: frozenset[str] = frozenset()
    own_additives: frozenset[str] = frozenset()

    @cached_property
    def finals(self) -> frozenset[str]:
        """The properties that no specifier may specify (the released Scenic 3)."""
        return self.own_finals.union(*(c.own_finals for c in self.lineage))

    @cached_property
    def built_in_name(self) -> str:
        """Which of Point, OrientedPoint and Object this class is or descends from, the nearest one."""
        return next(c.name for c in self.lineage if c.built_in)

    @cached_property
    def lineage(self) -> tuple[ScenicClass, ...]:
        """The class, its superclasses, and so on up to Point: in Python's order of resolution. Raises
        TypeError if there is none.
        """
        return (self, *merge_linearisations([*(list(c.lineage) for c in self.superclasses), list(self.superclasses)]))

    @cached_property
    def defaults(self) -> Mapping[str, tuple[Node, ScenicClass]]:
        """The most-derived default value expression of every property, with the class that it stands in."""
        found = {name: (value, c) for c in reversed(self.lineage) for name, value in c.own_defaults.items()}
        return {name: (self.summed(name) if name in c.own_additives else value, c) for name, (value, c) in found.items()}

    @cached_property
    def defaults_in_releases(self) -> Mapping[str, tuple[Node, ScenicClass]]:
        """The defaults where Point has `visibleDistance` in place of `viewDistance` (reading
        `view-distance`).
        """
        own = {"viewDistance": "visibleDistance"}
        return {own.get(name, name) if c.built_in else name: (v, c) for name, (v, c) in self.defaults.items()}

    def summed(self, name: str) -> Node:
        """The released implementations, `p[additive]: E`: the tuple of E and the defaults of the classes behind it, in their order."""
        own = ((c.own_defaults.get(name), c) for c in self.lineage)
        return TupleDisplay(items=tuple(DefaultIn(expression=found, owner=c) for found, c in own if found is not None))  # type: ignore[arg-type]

    def is_subclass_of(self, other: ScenicClass) -> bool:
        """Whether `other` is this class or one above it."""
        return other in self.lineage

    def method(self, name: str) -> object | None:
        """The most-derived method or class attribute of that name, or None."""
        return next((c.methods[name] for c in self.lineage if name in c.methods), None)

    def __repr__(self) -> str:
        return f"<class {self.name}>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DefaultIn(Node):
    """A default value expression of a class, where one of another class is made of it: it is reduced in the scope of its own class."""

    expression: Node
    owner: ScenicClass


def merge_linearisations(orders: list[list[ScenicClass]]) -> Iterator[ScenicClass]:
    """The classes of these orders in one that agrees with all of them (C3, as in Python). Raises TypeError if there is none."""
    while orders := [order for order in orders if order]:
        first = next((order[0] for order in orders if not any(order[0] in other[1:] for other in orders)), None)
        if first is None:
            raise TypeError("the superclasses can be brought into no order: a class stands before one that is derived from it")
        yield first
        orders = [order[1:] if order[0] is first else order for order in orders]


@dataclass(frozen=True, slots=True)
class Above:
    """The value of `super()` in a method of one of the classes of a value: the value, as its classes above
    that one see it.
    """

    subject: object
    classes: tuple[ScenicClass | type, ...]

    def __repr__(self) -> str:
        return "<super>"
