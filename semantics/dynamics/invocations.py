"""`do`: behaviors invoke behaviors, and compose blocks scenarios, one or several at a time (Section "Statements", "Invoking Other Behaviors and
Scenarios").
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from ..machine.config import Abrupt, Config, Stack, State, Value
from ..machine.operand_kinds import SCALAR, has_kind, kind_name
from ..machine.outcome import Next, Outcome
from ..machine.premises import premises
from ..machine.simulation_state import Agent, Clause, Deadline, Suspended, Who, agent_of, flag_end, span_line_text
from ..machine.values import Dynamic, value_in_run
from ..python.calls import invocation
from ..python.functions import LARGEST_DEPTH, body_as_statement
from ..python.string_methods import stable_repr
from ..store.errors import RunError
from ..store.scopes import MISSING, Scope
from ..syntax import dynamics as d
from ..syntax import statements as s
from ..syntax.nodes import Expression, Node
from ..syntax.python_expressions import Name
from .coroutines import Coroutine, Ended, Yielded, suspend
from .frames import Invoked, Picking, Together
from .guards import guards_of, reduce_guards, return_from_do, scope_of
from .interrupts import run_for_one_step, run_until_limit
from .scenarios import begin_scenarios, deadline_of

# Values


def with_arguments(value: object, node: Node, state: State) -> Dynamic:
    """A behavior or scenario that can run: one without parentheses has the default arguments (reading `bare-behavior`)."""
    found = value_in_run(value)
    if not isinstance(found, Dynamic):
        hint = ""
        if has_kind(found, SCALAR):
            name = "B" if state.sigma.lookup("FollowLaneBehavior") is MISSING else "FollowLaneBehavior"
            hint = f"write a call, such as `do {name}({node.name if isinstance(node, Name) else '...'})`"
        elif isinstance(found, (list, tuple)):
            hint = "list them without brackets, as in `do A, B` or `do choose A, B`"
        raise RunError(f"`do` invokes behaviors and scenarios, not {kind_name(found)}", node.span, rule="D-Do", hint=hint)
    return found if found.arguments is not None else invocation(found, (), {})


# do


def do(node: d.Do, stack: Stack, state: State) -> Outcome:
    """Reduce the invocations of `do B1, ..., Bn [for T | until C]`, and the limit, first."""
    amount = node.limit.amount if isinstance(node.limit, d.TimeLimit) else None
    return premises(node, [*node.invocations, amount], conclude_do, stack, state)


def conclude_do(node: d.Do, values: list[object], stack: Stack, state: State) -> Outcome:
    """Begin the invocations, inside a statement with an interrupt if there is a limit (Section "Dynamic Scenarios": they are short for one)."""
    *invocations, amount = values
    behaviors = tuple(with_arguments(v, one, state) for v, one in zip(invocations, node.invocations, strict=True))
    return limit_task(node, Begin(node, behaviors), Beginning(begin_all), amount, stack, state)


def limit_task(
    node: d.Do | d.DoChoose | d.DoShuffle, task: Begin | Picking, begin: Beginning, amount: object, stack: Stack, state: State
) -> Outcome:
    """A task within the limit of its statement. Scenarios are set up first, so that the limit may be about them, as in the paper's listing."""
    limit = node.limit
    if limit is None:
        return begin.begin(task, stack, state)
    condition: Expression | Deadline
    if isinstance(limit, d.Until):
        condition = limit.condition
    else:
        condition = deadline_of(limit, amount, node, "D-Do", state)
    until = Clause(condition, (d.Abort(span=node.span),))
    if isinstance(task, Begin) and runner(stack).kind == "compose":
        check_kinds(task, "compose")
        return begin_scenarios(node, task.invocations, stack, state, until)
    return run_until_limit(node, until, Value(task), begin, stack, state)


class Begin(NamedTuple):
    """The value that lets the frame `Beginning` begin these invocations."""

    node: Node
    invocations: tuple[Dynamic, ...]


class Beginning(NamedTuple):
    """Frame that begins what its statement asks for, once the limit is known not to have passed: invocations, or a choice among some."""

    begin: Callable[[Any, Stack, State], Outcome]


def resume_beginning(frame: Beginning, result: object, stack: Stack, state: State) -> Outcome:
    """The limit has not passed: begin."""
    return frame.begin(result, stack, state)


def begin_all(task: Begin, stack: Stack, state: State) -> Outcome:
    """Begin the invocations of the task."""
    return invoke(task.node, task.invocations, stack, state)


def runner(stack: Stack) -> Who:
    """Whose coroutine it is that runs."""
    while not isinstance(stack[0], Coroutine):
        stack = stack[1]
    return stack[0].who


def invoke(node: Node, invocations: tuple[Dynamic, ...], stack: Stack, state: State, *, enabled: bool = False) -> Outcome:
    """Begin behaviors (in a behavior) or scenarios (in a compose block); the preconditions of one that is `enabled` are known to hold."""
    who = runner(stack)
    check_kinds(Begin(node, invocations), who.kind)
    if who.kind == "compose":
        return begin_scenarios(node, invocations, stack, state, enabled=enabled)
    if who.kind != "behavior":
        raise RunError(f"a {who.kind} has no agent that could run {invocations[0]!r}", node.span, rule="D-Do")
    if len(invocations) == 1:
        return run_behavior(node, invocations[0], who, stack, state, enabled=enabled)
    children = tuple((k, behavior_coroutine(b, node, state)) for k, b in enumerate(invocations))
    return run_together(Together(children, who, 0, (), ()), stack, state)


def check_kinds(task: Begin, runs: str) -> None:
    """Compose blocks invoke scenarios, all else behaviors."""
    wanted, word = (d.ScenarioDefinition, "scenario") if runs == "compose" else (d.BehaviorDefinition, "behavior")
    for one in task.invocations:
        if not isinstance(one.definition, wanted):
            hint = f"give it to an object: `with behavior {one!r}`" if isinstance(one.definition, d.BehaviorDefinition) else ""
            raise RunError(f"{one!r} is not a {word}: here `do` invokes {word}s", task.node.span, rule="D-Do", hint=hint)


def run_behavior(node: Node, behavior: Dynamic, who: Who, stack: Stack, state: State, *, enabled: bool = False) -> Outcome:
    """Check the preconditions and invariants of a behavior, then run its body."""
    if state.depth >= LARGEST_DEPTH:
        raise RunError(f"{behavior!r} invokes itself too deeply ({LARGEST_DEPTH} invocations are open)", node.span, rule="D-Do")
    scope = scope_of(behavior, state, self=agent_of(who, state))
    return reduce_guards(guards_of(behavior, scope)[enabled:], partial(enter_behavior, node, behavior, scope), stack, state)


def enter_behavior(node: Node, behavior: Dynamic, scope: Scope, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Invoking Other Behaviors and Scenarios": "invokes one or more behaviors (if in a behavior) or scenarios (if in a
    compose block). It does not return until the sub-behavior/sub-scenario terminates". Here the guards of a behavior hold, and it runs as part of
    the one that invokes it.
    """
    body: s.Block = behavior.definition.body  # type: ignore[attr-defined]
    frame = Invoked(behavior, scope, state.sigma, node)
    return Next("D-Do", Config(body_as_statement(body), (frame, stack), state._replace(sigma=scope, depth=state.depth + 1)), node)


def resume_invoked(frame: Invoked, result: object, stack: Stack, state: State) -> Outcome:
    """The behavior ended: "When the do statement returns, the invariants of the calling behavior/scenario are checked"."""
    return return_from_do(stack, leave_invocation(frame, state))


def leave_invocation(frame: Invoked, state: State) -> State:
    """Back in the scope of the caller."""
    return state._replace(sigma=frame.caller, depth=state.depth - 1)


def unwind_invoked(frame: Invoked, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """`return` ends the behavior; all else goes on."""
    if abrupt.kind == "return":
        return resume_invoked(frame, None, stack, state)
    return Next("", Config(abrupt, stack, leave_invocation(frame, state)))


# Several behaviors at a time


def behavior_coroutine(behavior: Dynamic, node: Node, state: State) -> Suspended:
    """A coroutine that will run a behavior."""
    return Suspended(Value(Begin(node, (behavior,))), (Beginning(begin_all),), state.sigma, (), state.depth, begun=False)


def run_together(frame: Together, stack: Stack, state: State) -> Outcome:
    """Run the next of the behaviors for one time step; when all have, their actions together are those of this step."""
    if frame.base is None:
        frame, state = frame._replace(base=state.address), state._replace(draws=state.draws + 1)
    if frame.i < len(frame.children):
        place, process = frame.children[frame.i]
        return run_for_one_step(process, frame.who, (frame, stack), state, (*frame.base, place))  # type: ignore[misc]
    if frame.terminates:
        return Next("", Config(Abrupt("terminate"), stack, state))
    if not frame.left:
        return return_from_do(stack, state)
    return suspend(frame.actions, Value(None), (Together(frame.left, frame.who, 0, (), ()), stack), state, "")


def resume_together(frame: Together, result: object, stack: Stack, state: State) -> Outcome:
    """A behavior has run for one time step (or, the value being None, a new step begins)."""
    place = frame.children[frame.i][0] if frame.i < len(frame.children) else 0
    match result:
        case Yielded(actions=actions, rest=rest):
            frame = frame._replace(i=frame.i + 1, actions=(*frame.actions, *actions), left=(*frame.left, (place, rest)))
        case Ended(terminates=terminates):
            frame = frame._replace(i=frame.i + 1, terminates=frame.terminates or terminates)
        case _:
            pass
    return run_together(frame, stack, state)


def unwind_together(frame: Together, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """One of the behaviors raised an exception, which goes on, and may be caught. Where another has executed `terminate` in this time step, the flag
    of the policy is set all the same: "setting the terminate flag as in (3)", that is "if the terminate statement is executed".
    """
    if frame.terminates:
        state = flag_end(f"the behavior of {agent_of(frame.who, state)!r} executed `terminate`", state)
    return Next("", Config(abrupt, stack, state))


def describe_behaviors(agent: Agent) -> str:
    """Which behaviors an agent is in, the outermost first, and on which line the innermost waits."""
    if agent.ended or agent.process is None:
        return "its behavior has ended" if agent.ended else ""
    names = [stable_repr(frame.behavior) for frame in reversed(agent.process.frames) if isinstance(frame, Invoked)]
    return ", ".join([" > ".join(names), *([place] if (place := span_line_text(agent.process.span, agent.instance.span.file)) else [])])
