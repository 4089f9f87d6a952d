"""Programs with the specifiers of their objects in another order: the order in the source has no meaning (Algorithm 1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import TypeVar

from scenic_ref.conformance.generator.choice_sources import Choices
from scenic_ref.interpreter.language.nesting import children
from scenic_ref.interpreter.language.printer import to_source
from scenic_ref.semantics.syntax import Node, Program
from scenic_ref.semantics.syntax import expressions as e
from scenic_ref.semantics.syntax import python_expressions as p
from scenic_ref.semantics.syntax import specifiers as q
from scenic_ref.semantics.syntax import statements as s

N = TypeVar("N", bound=Node)
HARMLESS = frozenset({"min", "max", "abs", "len", "sum", "CircularRegion", "RectangularRegion", "SectorRegion", "PolygonalRegion", "PolylineRegion"})


def nodes(program: Program) -> Iterator[Node]:
    """All nodes of a program."""
    pending: list[Node] = list(program.statements)
    while pending:
        node = pending.pop()
        yield node
        pending.extend(children(node))


def rewritten(node: N, change: Callable[[Node], Node]) -> N:
    """The tree with `change` applied to every node, the inner ones first."""
    changes = {field.name: _rewritten(getattr(node, field.name), change) for field in fields(node) if field.name != "span"}
    return change(replace(node, **changes))  # type: ignore[return-value, arg-type]


def _rewritten(value: object, change: Callable[[Node], Node]) -> object:
    if isinstance(value, Node):
        return rewritten(value, change)
    return tuple(_rewritten(item, change) for item in value) if isinstance(value, tuple) else value


def permuted(program: Program, choices: Choices, *, drawless: bool = False) -> Program:
    """The program with the specifiers of each object in a random order; if `drawless`, of those only whose specifiers draw nothing."""
    drawing = frozenset(node.name for node in nodes(program) if isinstance(node, s.ClassDefinition)) if drawless else frozenset()

    def shuffled(node: Node) -> Node:
        if not isinstance(node, e.ObjectDefinition) or (drawless and not draws_nothing(node, drawing)):
            return node
        count = len(node.specifiers)
        return replace(node, specifiers=tuple(choices.some(node.specifiers, count, count)))

    statements = tuple(rewritten(statement, shuffled) for statement in program.statements)
    changed = replace(program, statements=statements)
    return replace(changed, text=to_source(changed))


def draws_nothing(definition: e.ObjectDefinition, drawing: frozenset[str]) -> bool:
    """Whether neither the specifiers nor the class (one of `drawing` might) can draw: then every draw keeps its address."""
    if isinstance(definition.class_, p.Name) and definition.class_.name in drawing:
        return False
    pending: list[Node] = list(definition.specifiers)
    while pending:
        node = pending.pop()
        match node:
            case q.InSpecifier() | q.VisibleSpecifier():
                return False
            case p.Call(function=p.Name(name=function)) if function in HARMLESS:
                pending.extend(children(node))
            case p.Call():
                return False
            case _:
                pending.extend(children(node))
    return True


def has_order(program: Program) -> bool:
    """Whether a function of the program counts its calls, so that the order of evaluation shows."""
    return any(isinstance(node, s.Nonlocal) for node in nodes(program))
