"""The variable assignment σ: scopes nested as in Python, the innermost first.

Python's functions close over variables, not values, so that a scope, like a list of the program, is shared and
updated in place, each change noted (`versions`).
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import NamedTuple

from ..syntax import dynamics, python_expressions, statements
from ..syntax.nodes import Node
from .undo_log import MISSING, Content, Entry, Versions

BEGUN = "*begun*"
"""What the variables of a scenario hold once it has begun, besides those of the program."""


class Names(NamedTuple):
    """The names that a function body binds, those it declares global or nonlocal, and whether interrupts stand in it."""

    local: frozenset[str]
    declared_global: frozenset[str]
    declared_nonlocal: frozenset[str]
    has_interrupts: bool = False


NO_NAMES = Names(frozenset(), frozenset(), frozenset())


class Scope:
    """One level of σ; `kind` is "builtins", "module", "function", "class" or "comprehension"; `package` is that of a module.

    `around` is the scope around it, or, of an outermost one, the versions of its run.
    """

    __slots__ = ("bindings", "kind", "names", "package", "parent", "versions")

    def __init__(
        self, kind: str, around: Scope | Versions, names: Names = NO_NAMES, bindings: dict[str, object] | None = None, package: str = "."
    ) -> None:
        self.kind = kind
        self.parent, self.versions = (around, around.versions) if isinstance(around, Scope) else (None, around)
        self.names = names
        self.package = package
        self.bindings: dict[str, object] = {} if bindings is None else bindings

    @classmethod
    def of_call(cls, around: Scope, names: Names, bindings: dict[str, object]) -> Scope:
        """Return the scope of a function that runs: as `Scope("function", around, names, bindings)`."""
        scope = cls.__new__(cls)
        scope.kind, scope.parent, scope.versions, scope.package = "function", around, around.versions, "."
        scope.names, scope.bindings = names, bindings
        return scope

    def lookup(self, name: str) -> object:
        """The value of `name`, or MISSING. A function's own names shadow outer ones even before they are bound."""
        scope: Scope | None = self
        while scope is not None:
            value = scope.bindings.get(name, MISSING)
            if value is not MISSING and (scope.kind != "class" or scope is self):
                return value
            if name in scope.names.local:
                return MISSING
            if name in scope.names.declared_global:
                return scope.module.lookup(name)
            scope = scope.parent
        return MISSING

    @property
    def module(self) -> Scope:
        """The module's scope around this one."""
        scope = self
        while scope.kind != "module" and scope.parent is not None:
            scope = scope.parent
        return scope

    def home(self, name: str) -> Scope:
        """The scope in which an assignment to `name` made here takes effect."""
        scope = self
        while scope.kind == "specifier" and scope.parent is not None:
            scope = scope.parent
        if name in scope.names.declared_global:
            return scope.module
        if name in scope.names.declared_nonlocal:
            outer = scope.parent
            while outer is not None and not (outer.kind == "function" and name in outer.names.local):
                outer = outer.parent
            return outer or scope
        return scope

    def bind(self, name: str, value: object) -> None:
        """Update the scope to σ[name / value]."""
        self.home(name).put(name, value)

    def put(self, name: str, value: object) -> None:
        """Bind a name in this very scope."""
        bindings = self.bindings
        self.versions.current.undo.append(Entry(bindings, name, bindings.get(name, MISSING)))
        bindings[name] = value

    def unbind(self, name: str) -> object:
        """σ without `name`: what its value was, or MISSING."""
        home = self.home(name)
        home.versions.note(Content(home.bindings, dict(home.bindings)))
        return home.bindings.pop(name, MISSING)

    def refill(self, bindings: dict[str, object]) -> None:
        """Begin anew with these variables."""
        self.versions.note(Content(self.bindings, dict(self.bindings)))
        self.bindings.clear()
        self.bindings.update(bindings)

    def snapshot(self, copied: Callable[[object], object]) -> Scope:
        """A copy that later assignments do not reach (reading `requirement-capture`), whose values are `copied`."""
        if self.kind == "builtins":
            return self
        around = self.versions if self.parent is None else self.parent.snapshot(copied)
        return Scope(self.kind, around, self.names, {name: copied(value) for name, value in self.bindings.items()}, self.package)


@dataclass(frozen=True, slots=True, eq=False)
class ByIdentity:
    """A node as a key of a cache: two keys are equal if they hold the same node, not one that says the same."""

    node: Node

    def __hash__(self) -> int:
        return object.__hash__(self.node)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ByIdentity) and other.node is self.node


def function_names(node: Node) -> Names:
    """Return the names that the body of a function, lambda, behavior, monitor or scenario binds, its
    parameters included.
    """
    return _function_names(ByIdentity(node))


@lru_cache(maxsize=65536)
def _function_names(key: ByIdentity) -> Names:
    node = key.node
    parameters: tuple[python_expressions.Parameter, ...] = getattr(node, "parameters", ())
    bound = {p.name for p in parameters}
    declared_global: set[str] = set()
    declared_nonlocal: set[str] = set()
    has_interrupts = False
    if not isinstance(node, python_expressions.Lambda):
        for inner in _statements(node):
            match inner:
                case statements.Global(names=names):
                    declared_global |= set(names)
                case statements.Nonlocal(names=names):
                    declared_nonlocal |= set(names)
                case _:
                    has_interrupts = has_interrupts or (isinstance(inner, statements.Try) and bool(inner.interrupts))
                    bound |= set(bound_by(inner))
    local = frozenset(bound - declared_global - declared_nonlocal)
    return Names(local, frozenset(declared_global), frozenset(declared_nonlocal), has_interrupts)


_BLOCK_FIELDS = ("body", "then", "otherwise", "final", "setup", "compose")
OPAQUE = (
    statements.FunctionDefinition,
    statements.ClassDefinition,
    dynamics.BehaviorDefinition,
    dynamics.MonitorDefinition,
    dynamics.ScenarioDefinition,
)
"""Definitions with a scope of their own."""


def _statements(node: Node) -> Iterator[Node]:
    """Every statement below `node` that belongs to the same scope."""
    pending: list[Node] = [node]
    while pending:
        current = pending.pop()
        if current is not node:
            yield current
            if isinstance(current, OPAQUE):
                continue
        for name in _BLOCK_FIELDS:
            block = getattr(current, name, None)
            if isinstance(block, tuple):
                pending.extend(block)
        for name in ("handlers", "interrupts"):
            pending.extend(getattr(current, name, ()))


def bound_by(node: Node) -> Iterator[str]:
    """Return the names that one statement binds by itself."""
    match node:
        case statements.Assignment(targets=targets) | statements.Delete(targets=targets):
            for target in targets:
                yield from target_names(target)
        case statements.AugmentedAssignment(target=target) | statements.For(target=target):
            yield from target_names(target)
        case statements.Import(names=names):
            yield from (n.alias or n.name.partition(".")[0] for n in names)
        case statements.ImportFrom(names=names):
            yield from (n.alias or n.name for n in names)
        case statements.Handler(name=str(name)):
            yield name
        case _ if isinstance(node, OPAQUE):
            yield node.name
        case _:
            return


def target_names(target: Node) -> Iterator[str]:
    """The variables that an assignment to `target` binds."""
    match target:
        case python_expressions.Name(name=name):
            yield name
        case python_expressions.Starred(value=value):
            yield from target_names(value)
        case python_expressions.TupleDisplay(items=items) | python_expressions.ListDisplay(items=items):
            for item in items:
                yield from target_names(item)
        case _:
            return


def children(node: Node) -> Iterator[Node]:
    """The nodes directly below `node`, in source order of its fields."""
    for f in fields(node):
        if f.name != "span":
            yield from _nodes_in(getattr(node, f.name))


def _nodes_in(value: object) -> Iterator[Node]:
    if isinstance(value, Node):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _nodes_in(item)


def descendants(node: Node) -> Iterator[Node]:
    """`node` and every node below it, without recursion."""
    pending = [node]
    while pending:
        current = pending.pop()
        yield current
        pending.extend(reversed(list(children(current))))
