"""An expression as a statement, for its effect: an object definition, a call."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import NamedTuple

from ..machine.config import PASS, Config, Stack, State, reduce
from ..machine.operand_kinds import kind_name
from ..machine.outcome import Next, Outcome
from ..machine.values import Dynamic, Module, value_in_run
from ..space.fields import VectorField
from ..space.regions import Region
from ..store.errors import RunError
from ..store.scopes import MISSING
from ..syntax import dynamics as d
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax import statements as s
from ..syntax.nodes import Node


class Discard(NamedTuple):
    """Frame: the value of an expression statement is not used."""

    node: s.ExpressionStatement


def expression_statement(node: s.ExpressionStatement, stack: Stack, state: State) -> Outcome:
    """⟨E⟩ for its effect."""
    return reduce(node.value, Discard(node), stack, state)


def resume_discard(frame: Discard, result: object, stack: Stack, state: State) -> Outcome:
    """The statement is reduced to `pass`. Raises `RunError` where it only makes a behavior, monitor, scenario or action, which does nothing."""
    made, node = value_in_run(result), frame.node
    if isinstance(made, Dynamic) and isinstance(value_in_run(lookup_named_value(node.value, state)), Dynamic):
        raise RunError(f"{kind_name(made)} alone does nothing", node.span, rule="D-Do", hint=RUN_BY[type(made.definition)])
    if is_dataclass(made) and not isinstance(made, (Region, VectorField)) and lookup_named_value(node.value, state) is type(made):
        raise RunError(f"the action {made!r} alone does nothing", node.span, rule="D-Take", hint="write `take` before it")
    return Next("", Config(PASS, stack, state))


RUN_BY: Mapping[type, str] = {
    d.BehaviorDefinition: "write `do` before it in a behavior, or `with behavior` at an object",
    d.ScenarioDefinition: "write `do` before it in a compose block",
    d.MonitorDefinition: "a monitor runs from its definition on, or, in dialect scenic-3, by `require monitor`",
}


def lookup_named_value(expression: Node, state: State) -> object:
    """Return the value that the expression names, or that it calls by name; MISSING if it is something else,
    or not bound.
    """
    match expression:
        case e.ObjectOrValue(value=inner) | p.Call(function=inner):
            return lookup_named_value(inner, state)
        case p.Name(name=name):
            return state.sigma.lookup(name)
        case p.Attribute(value=inner, name=name):
            owner = value_in_run(lookup_named_value(inner, state))
            return owner.scope.bindings.get(name, MISSING) if isinstance(owner, Module) else MISSING
        case _:
            return MISSING
