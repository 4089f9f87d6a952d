"""Whose position is meant, and what waits for one (reading `field-dependency`): the object being specified, or `self` of a behavior."""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Sequence

from ..store.containers import deque
from ..store.errors import NeedsPosition, NotBegun
from ..store.postponed_values import Waiting
from ..store.scopes import MISSING, Scope
from ..syntax.nodes import Expression, Node
from ..syntax.python_expressions import Call, Constant, DictDisplay, Keyword, ListDisplay, TupleDisplay
from .config import State
from .values import Dynamic, Instance, Random, unwrap

SPECIFIED = "<the object being specified>"


def specified_object(state: State) -> Instance | None:
    """The object whose position is meant here: the one that is being specified, once its position is known; in a behavior `self`."""
    found = state.sigma.lookup(SPECIFIED)
    if found is MISSING and state.runs:
        found = state.sigma.lookup("self")
    return found if isinstance(found, Instance) else None


def specifier_scope(instance: Instance, scope: Scope) -> Scope:
    """The scope, with the object whose position is meant in it."""
    return Scope("specifier", scope, bindings={SPECIFIED: instance})


def waits(value: object) -> bool:
    """Whether the value, or one in it, waits for a position."""
    if type(value) is Random:
        return False
    if isinstance(value, Dynamic):
        return value.arguments is not None and waits(list(value.arguments))
    try:
        unwrap(value)
    except NeedsPosition:
        return True
    except NotBegun:
        return False
    return False


def expression_of(value: object, seen: dict[int, Expression] | None = None) -> Expression:
    """An expression with this value, once there is a position. Raises `NeedsPosition` for what is no container, like the view of one.

    What stands in several places is one expression: it takes no longer than there are different parts.
    """
    seen = {} if seen is None else seen
    known = seen.get(id(value))
    if known is None:
        known = seen[id(value)] = expression_for(value, seen)
    return known


def expression_for(value: object, seen: dict[int, Expression]) -> Expression:
    """Return the expression for a value that was not seen before."""
    match value:
        case Waiting():
            return value  # pyright: ignore[reportReturnType]: a node that stands where an expression does
        case _ if not waits(value):
            return Constant(value=value)
        case Dynamic(arguments=(positional, keywords)):
            function = Constant(value=Dynamic(value.definition, value.scope, value.defaults))
            named = tuple(Keyword(name=name, value=expression_of(v, seen)) for name, v in keywords.items())
            return Call(function=function, arguments=tuple(expression_of(v, seen) for v in positional), keywords=named)
        case list() | tuple():
            return (ListDisplay if isinstance(value, list) else TupleDisplay)(items=tuple(expression_of(v, seen) for v in value))
        case deque():
            items = ListDisplay(items=tuple(expression_of(v, seen) for v in value))
            return Call(function=Constant(value=deque), arguments=(items, Constant(value=value.maxlen)), keywords=())
        case dict():
            return DictDisplay(items=tuple((Constant(value=key), expression_of(v, seen)) for key, v in value.items()))
        case _:
            return Constant(value=unwrap(value))


def remaining_premises(values: Sequence[object]) -> list[Expression] | None:
    """Return the expressions that are left to reduce of premises with these values; None if none of them
    waits.
    """
    expressions = [expression_of(v) for v in values]
    return None if all(isinstance(e, Constant) for e in expressions) else expressions


def wait(node: Node, values: Sequence[object], conclude: object, state: State, missing: NotBegun | None = None) -> Waiting:
    """The value of an expression, one of whose premises waits; `missing` is the error of what waits for a scenario to begin."""
    return Waiting(node=node, values=tuple(values), conclude=conclude, scope=state.sigma, missing=missing, span=node.span)  # type: ignore[arg-type]
