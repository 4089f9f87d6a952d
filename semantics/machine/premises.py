"""Premises of a rule, reduced one after the other, then its conclusion.

Most rules of the paper have the shape "if E1 → v1, ..., En → vn then E → f(v1, ..., vn)". `premises` reduces the Ei from
left to right and hands their values to the rule. Constants and variables are axioms: they need no step of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ..store.errors import NeedsPosition, RunError
from ..store.scopes import MISSING, Scope
from ..store.suggestions import undefined_name_hint
from ..store.undo_log import changes_its_owner
from ..syntax.dynamics import Do
from ..syntax.expressions import ObjectDefinition
from ..syntax.nodes import NOWHERE, Expression, Node
from ..syntax.python_expressions import Call, Constant, Name
from ..syntax.statements import Assignment, Return
from .config import Config, Stack, State, Value
from .host_calls import HostException, Misapplied
from .implicit_positions import remaining_premises, specified_object, wait
from .operand_kinds import FLAT, SPATIAL
from .outcome import Next, Outcome
from .values import Bound, Instance, Origin, Random, Special, value_in_run

Conclusion = Callable[..., Outcome]
"""Gets the node, the values of its premises, the stack and the state: `conclude(node, values, stack, state)`."""

NOT_AN_AXIOM = object()


class Premises(NamedTuple):
    """The frame of a rule whose premise number `position` is being reduced; `values` are those of the ones before it.

    `begun` is the state before it, if it is an argument of a specifier, which may turn out to need a position (`object_definitions.wait_whole`).
    """

    node: Node
    expressions: Sequence[Node | None]
    position: int
    values: tuple[object, ...]
    conclude: Conclusion
    begun: State | None = None


def premises(
    node: Node, expressions: Sequence[Node | None], conclude: Conclusion, stack: Stack, state: State, values: list[object] | None = None
) -> Outcome:
    """Reduce the premises from number len(values) on, then conclude; a missing (optional) premise has the value None.

    Where something random went in, whether the conclusion raises an exception is random as well.
    """
    values = [] if values is None else values
    read = raw_axiom if not state.may_branch or type(node) in CARRIERS else axiom
    for index in range(len(values), len(expressions)):
        expression = expressions[index]
        result = None if expression is None else read(expression, state)
        if result is NOT_AN_AXIOM:
            begun = state if type(node) is ObjectDefinition else None
            frame = Premises(node, expressions, index, tuple(values), conclude, begun)
            return Next("", Config(expression, (frame, stack), state))  # type: ignore[arg-type]
        values.append(result)
    try:
        return conclude(node, values, stack, state)
    except HostException as problem:
        if problem.origin is None and not isinstance(problem, Misapplied):
            problem.origin = next((v.origin for v in values if type(v) is Random), None)
        raise
    except NeedsPosition:
        return await_position(node, conclude, stack, state, values)


def await_position(node: Node, conclude: Conclusion, stack: Stack, state: State, values: list[object]) -> Outcome:
    """A premise waits for a position, and the rule needs its value: it is reduced where a position is meant, else an expression waits as well."""
    rest = remaining_premises(values)
    if rest is not None and specified_object(state) is not None:
        return premises(node, rest, conclude, stack, state)
    if rest is None or not isinstance(node, Expression) or (isinstance(node, Call) and must_be_made_now(value_in_run(values[0]))):
        raise
    return Next("", Config(Value(wait(node, values, conclude, state)), stack, state), node)


def must_be_made_now(function: object) -> bool:
    """Whether a call does more than to give a value that follows from its arguments."""
    return isinstance(function, (Special, Bound)) or changes_its_owner(function)


def resume_premises(frame: Premises, result: object, stack: Stack, state: State) -> Outcome:
    """The premise that `frame` waits for was reduced to `result`: go on with the next."""
    return premises(frame.node, frame.expressions, frame.conclude, stack, state, [*frame.values, result])


CARRIERS = frozenset({Call, Assignment, Return, Do})
"""Where whatever is drawn may decide the course (`State.may_branch`), rules see plain values; but where a value is only passed on, to a variable or
parameter, it keeps the distribution that it was drawn from, for `resample`.
"""


def axiom(expression: Node, state: State) -> object:
    """The value of a constant or variable, else NOT_AN_AXIOM; a plain one where control flow may depend on it."""
    found = raw_axiom(expression, state)
    return value_in_run(found) if state.may_branch else found


def raw_axiom(expression: Node, state: State) -> object:
    """The value of a constant or variable, else NOT_AN_AXIOM."""
    kind = type(expression)
    if kind is Constant:
        return expression.value  # type: ignore[attr-defined]
    if kind is Name:
        return variable(expression, state)  # type: ignore[arg-type]
    return NOT_AN_AXIOM


def variable(node: Name, state: State) -> object:
    """σ(x); `ego` and `workspace` are shared by all modules."""
    name = node.name
    if name in SHARED:
        own = parameter(name, state.sigma)
        if own is not MISSING:
            return own
    if name == "ego":
        if state.ego is None:
            make = f"create it first: ego = {'new ' * (state.settings.dialect == 'scenic-3')}Object ..."
            if node.span == NOWHERE:  # an operator or specifier that leaves it out
                other = "or say what is meant instead, as in `distance from X to Y`"
                raise RunError("this is seen from ego, which is not assigned yet", rule="E-Variable", hint=f"{make}, {other}")
            line = line_below(node, state)
            below = f"it is assigned below, on line {line}: move that above its first use"
            raise RunError("ego is used before it is assigned", node.span, rule="E-Variable", hint=below if line else make)
        return state.ego
    if name == "workspace" and state.workspace is not None:
        return state.workspace
    result = state.sigma.lookup(name)
    if result is MISSING:
        raise unknown_variable(node, state)
    return result


SHARED = frozenset({"ego", "workspace"})


def parameter(name: str, sigma: Scope) -> object:
    """Return the binding of a parameter or loop variable that is called `ego` or `workspace`, in a function
    or comprehension, or MISSING.
    """
    scope: Scope | None = sigma
    while scope is not None and scope.kind != "module":
        if scope.kind in ("function", "comprehension") and name in scope.bindings:
            return scope.bindings[name]
        scope = scope.parent
    return MISSING


def unknown_variable(node: Name, state: State) -> RunError:
    """The error for a name that σ does not bind, with the nearest one that it does."""
    known: list[str] = []
    scope = state.sigma
    while scope is not None:
        known.extend(scope.bindings)
        if node.name in scope.names.local:
            early = "conditions of interrupts are evaluated before their `try` begins: see `readings interrupt-first-step`"
            hint = early if state.simulation and scope.names.has_interrupts else ""
            return RunError(f"the local variable {node.name} is used before it is assigned", node.span, rule="E-Variable", hint=hint)
        scope = scope.parent
    if node.name == "workspace":
        return RunError("there is no workspace", node.span, rule="E-Variable", hint="set it first: workspace = Workspace(REGION)")
    if node.name in SPATIAL:
        return RunError(f"{node.name} {FLAT}", node.span, rule="E-Variable")
    if line := line_below(node, state):
        hint = f"it is defined below, on line {line}: move that above its first use"
        return RunError(f"{node.name} is not defined", node.span, rule="E-Variable", hint=hint)
    if state.ego is not None:
        known.append("ego")
    if node.name in state.params:
        hint = f"it is a global parameter: write globalParameters.{node.name}"
    elif isinstance(owner := value_in_run(state.sigma.lookup("self")), Instance) and node.name in owner.class_.defaults:
        hint = f"it is a property: write self.{node.name}"
    else:
        hint = undefined_name_hint(node.name, [name for name in known if not name.startswith("__")], state.settings.elsewhere)
    over_time = node.name in ("always", "eventually")
    message = f"`{node.name}` stands only directly behind `require`" if over_time else f"{node.name} is not defined"
    return RunError(message, node.span, rule="E-Variable", hint=hint)


def line_below(node: Name, state: State) -> int:
    """The line, below a name, on which the top level of its program first binds it; 0 if there is none."""
    found = state.settings.defined.get(node.name)
    return found.line if found is not None and found.file == node.span.file and found.line > node.span.line else 0


def describe_origin(origin: Origin) -> str:
    """Describe the origin of a random value in words."""
    place = f" (line {origin.span.line})" if origin.span.line else ""
    return f"{origin.text}{place}"
