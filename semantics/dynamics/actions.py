"""`take`, `wait` and `terminate` (Section "Statements", "Actions" and "Termination Conditions")."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import is_dataclass

from ..machine.config import Abrupt, Config, Stack, State, Value
from ..machine.outcome import Next, Outcome
from ..machine.premises import premises
from ..machine.simulation_state import Clause, flag_end
from ..machine.values import Dynamic, unwrap
from ..python.expression_statements import RUN_BY
from ..store.errors import RunError
from ..syntax import dynamics as d
from ..syntax.nodes import Expression, Node
from ..syntax.python_expressions import Constant
from ..syntax.statements import While
from .coroutines import suspend
from .frames import Abortable
from .interrupts import interruptible
from .invocations import runner
from .scenarios import deadline_of


def take(node: d.Take, stack: Stack, state: State) -> Outcome:
    """The actions of `take` come first."""
    return premises(node, node.actions, conclude_take, stack, state)


def conclude_take(node: d.Take, values: list[object], stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Actions": "select one or more actions for the agent to take in the current time step"; then "the behavior is suspended
    until one time step has elapsed".

    Actions in lists and tuples are taken one by one; a monitor's are ignored (reading `take-in-monitor`).
    """
    taken = actions_of(node, values) if runner(stack).kind == "behavior" else ()
    return suspend(taken, Value(None), stack, state, "D-Take", node)


def actions_of(node: d.Take, values: Sequence[object]) -> tuple[object, ...]:
    """The actions among the values of `take`, also in lists and tuples. Raises `RunError` for what is none."""
    actions: list[object] = []
    for expression, value in zip(node.actions, (unwrap(v)[0] for v in values), strict=True):
        inside: Sequence[object] = value if isinstance(value, (list, tuple)) else [value]
        for one in inside:
            refuse_other(one, expression)
        actions.extend(inside)
    return tuple(actions)


def refuse_other(value: object, expression: Expression) -> None:
    """Raises `RunError` for a behavior, scenario or monitor, and for a class of actions."""
    if isinstance(value, Dynamic):
        called = f"{value!r}" if value.arguments is not None else f"{value!r}()"
        what = type(value.definition).__name__.removesuffix("Definition").lower()
        hint = to_run(type(value.definition), called)
        raise RunError(f"{value!r} is a {what}, not an action", expression.span, rule="D-Take", hint=hint)
    if isinstance(value, type) and is_dataclass(value):
        text = f"{value.__name__} is a class of actions, not an action"
        raise RunError(text, expression.span, rule="D-Take", hint=f"write `{value.__name__}(...)`")


def to_run(kind: type[Node], called: str) -> str:
    """How a behavior, scenario or monitor is run, by the kind of its definition."""
    if kind is d.BehaviorDefinition:
        return f"write `do {called}`"
    return f"write `do {called}` in a compose block" if kind is d.ScenarioDefinition else RUN_BY[kind]


def wait(node: d.Wait, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Actions": "The wait statement means no actions are taken in this time step (which makes sense inside monitors and
    compose blocks)."
    """
    return suspend((), Value(None), stack, state, "D-Wait", node)


def wait_for(node: d.WaitFor, stack: Stack, state: State) -> Outcome:
    """`wait for S seconds`, `wait until B`: the amount comes first."""
    return premises(node, [node.limit.amount] if isinstance(node.limit, d.TimeLimit) else [], conclude_wait_for, stack, state)


def conclude_wait_for(node: d.WaitFor, values: list[object], stack: Stack, state: State) -> Outcome:
    """⟦wait until B⟧ = ⟦try: while True: wait; interrupt when B: abort⟧, and likewise ⟦wait for T⟧, where B is that T has passed."""
    limit = node.limit
    condition = limit.condition if isinstance(limit, d.Until) else deadline_of(limit, values[0], node, "D-WaitFor", state)
    forever = While(test=Constant(value=True, span=node.span), body=(d.Wait(span=node.span),), span=node.span)
    begun = interruptible(node, (Clause(condition, (d.Abort(span=node.span),)),), (forever,), (Abortable(), stack), state)
    return begun._replace(rule="D-WaitFor")  # type: ignore[union-attr]


def terminate(node: d.Terminate, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Termination Conditions": "The terminate statement can be called inside a behavior, monitor, or compose block to end the
    scenario immediately."

    Which scenario that is depends on where the statement stands (reading `terminate-who`).
    """
    if node.simulation:
        state = flag_end("`terminate simulation` was executed", state)
    return Next("D-Terminate", Config(Abrupt("terminate", None, node.span), stack, state), node)
