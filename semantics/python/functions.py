"""Functions and lambdas, as in Python: closed over their scope, default values evaluated once; arguments keep their randomness."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..machine.config import Abrupt, Config, Stack, State, Value, value
from ..machine.host_calls import Misapplied
from ..machine.implicit_positions import SPECIFIED, specified_object
from ..machine.outcome import Next, Outcome
from ..machine.premises import premises
from ..machine.values import Function
from ..store.errors import RunError
from ..store.scopes import Scope, function_names
from ..store.suggestions import meant_parameter
from ..syntax import python_expressions as p
from ..syntax import statements as s
from ..syntax.nodes import NOWHERE, Node

LARGEST_DEPTH = 3_000
"""So many calls may be open: the machine needs none of Python's stack for them."""


class Called(NamedTuple):
    """Frame of a call: what comes below it runs in the callee's scope; `caller` is restored when it ends."""

    caller: Scope
    node: Node
    constructed: object = None


class InScope(NamedTuple):
    """Frame that restores σ to `outer` when what stands above it ends."""

    outer: Scope


def lambda_rule(node: p.Lambda, stack: Stack, state: State) -> Outcome:
    """If ⟨E⟩ → v then ⟨lambda x=E: E', σ⟩ → the function (x=v) ↦ E' that closes over σ: E is evaluated now, once (reading `default-arguments`)."""
    return premises(node, [q.default for q in node.parameters], conclude_lambda, stack, state)


def conclude_lambda(node: p.Lambda, values: list[object], stack: Stack, state: State) -> Outcome:
    """The function as a value."""
    function = make_function(node, values, state)
    return value("E-Lambda", function, stack, state, node)


def make_function(node: p.Lambda | s.FunctionDefinition, values: list[object], state: State) -> Function:
    """A function closed over the current σ."""
    defaults = {q.name: v for q, v in zip(node.parameters, values, strict=False) if q.default is not None}
    name = node.name if isinstance(node, s.FunctionDefinition) else "<lambda>"
    return Function(name, node.parameters, node.body, state.sigma, defaults, function_names(node), state.settings.door, node.span)


def bind(
    name: str, parameters: tuple[p.Parameter, ...], defaults: Mapping[str, object], arguments: tuple[object, ...], keywords: Mapping[str, object]
) -> dict[str, object]:
    """The variables of a call; TypeError (the program's) when the arguments do not fit the parameters."""
    bound: dict[str, object] = {}
    rest = dict(keywords)
    positional = [q for q in parameters if q.kind in ("positional", "positional only")]
    star = next((q for q in parameters if q.kind == "*args"), None)
    if len(arguments) > len(positional) and star is None:
        text = f"{name}() takes {len(positional)} positional arguments but {len(arguments)} were given"
        raise misapplied_error(text, parameters, len(positional))
    for parameter, argument in zip(positional, arguments, strict=False):
        bound[parameter.name] = argument
        if parameter.kind == "positional" and parameter.name in rest:
            raise misapplied_error(f"{name}() got two values for {parameter.name}", parameters, parameter.name)
    if star is not None and star.name:
        bound[star.name] = tuple(arguments[len(positional) :])
    for parameter in parameters:
        if parameter.kind in ("*args", "**kwargs") or parameter.name in bound:
            continue
        if parameter.kind != "positional only" and parameter.name in rest:
            bound[parameter.name] = rest.pop(parameter.name)
        elif parameter.name in defaults:
            bound[parameter.name] = defaults[parameter.name]
        else:
            raise misapplied_error(f"{name}() needs a value for {parameter.name}", parameters)
    extra = next((q for q in parameters if q.kind == "**kwargs"), None)
    if extra is not None:
        bound[extra.name] = rest
    elif rest:
        given = next(iter(rest))
        raise misapplied_error(f"{name}() has no parameter {given}", parameters, given)
    return bound


def misapplied_error(
    text: str, parameters: tuple[p.Parameter, ...], argument: str | int | None = None
) -> Misapplied:
    """The TypeError of a call whose arguments do not fit, with a note that tells the parameters."""
    error = TypeError(text)
    names = [q.name for q in parameters if q.kind not in ("*args", "**kwargs") and q.name != "self"]
    if names or len(parameters) == 0:
        by_name = isinstance(argument, str) and argument not in names
        error.add_note(meant_parameter(str(argument) if by_name else "", names))
    return Misapplied(error, argument)


def enter(
    function: Function, arguments: tuple[object, ...], keywords: Mapping[str, object], state: State, stack: Stack = (), node: Node | None = None
) -> Config:
    """The configuration that runs a function's body; it ends in the frame `Called`."""
    if state.depth >= LARGEST_DEPTH:
        text = f"{function.name} is called too deeply ({LARGEST_DEPTH} calls are open)"
        hint = f"{function.name} is defined on line {function.span.line}: does it call itself without end?"
        raise RunError(text, function.span if node is None else node.span, rule="E-Call", hint=hint)
    bindings = bind(function.name, function.parameters, function.defaults, arguments, keywords)
    instance = specified_object(state)
    if instance is not None:
        bindings[SPECIFIED] = instance
    scope = Scope("function", function.scope, function.names, bindings)
    frame = Called(state.sigma, node if node is not None else p.Constant(value=None, span=function.span))
    inner = state._replace(sigma=scope, depth=state.depth + 1)
    control = body_as_statement(function.body) if isinstance(function.body, tuple) else function.body
    return Config(control, (frame, stack), inner)


def body_as_statement(body: s.Block) -> Node:
    """A function's body as one statement."""
    return s.If(test=p.Constant(value=True), then=body, span=body[0].span if body else NOWHERE)


def resume_called(frame: Called, result: object, stack: Stack, state: State) -> Outcome:
    """If the body s of f is reduced to v then ⟨f(v_1, ..., v_n), σ⟩ → v, in the σ of the call: a lambda's value, or None where a function ends
    without `return`.
    """
    outcome = frame.constructed if frame.constructed is not None else result
    return value("E-Return", outcome, stack, leave(frame, state), frame.node)


def leave(frame: Called, state: State) -> State:
    """Back in the caller's scope."""
    return state._replace(sigma=frame.caller, depth=state.depth - 1)


def unwind_called(frame: Called, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """`return v` ends the call with v; an exception goes on to the caller."""
    if abrupt.kind == "return":
        return resume_called(frame, abrupt.value, stack, state)
    return Next("", Config(abrupt, stack, leave(frame, state)))


def resume_in_scope(frame: InScope, result: object, stack: Stack, state: State) -> Outcome:
    """Restore σ and hand the value on."""
    return value("", result, stack, state._replace(sigma=frame.outer))


def unwind_in_scope(frame: InScope, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Restore σ and go on unwinding."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def return_host_result(node: Node, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨E_i⟩ → v_i then ⟨f(E_1, ..., E_n)⟩ → f(v_1, ..., v_n) for a function f of the library, random if a v_i is.

    ⟨map(f, I)⟩ → ⟨(f(x) for x in I)⟩ and ⟨filter(f, I)⟩ → the list of those x of I for which ⟨f(x)⟩ → True.
    """
    return Next("E-Call-Host", Config(result if isinstance(result, p.Comprehension) else Value(result), stack, state), node)
