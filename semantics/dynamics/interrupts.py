"""`try` with `interrupt when`, and time limits and `until`, which are short for it (Sections "Dynamic Scenarios" and "Statements", "Interrupts").

While a coroutine is in such a statement, its conditions are checked at the start of every time step: those of outer statements first, and
in one statement from the last clause back to the one that is running. The first that is true takes over: what it interrupts, with all
that is inside, is suspended until the handler completes. Then the conditions are checked that were not yet in this time step: the handler's own,
if it has taken time, those of earlier clauses, and those of statements inside; if none is true, what was interrupted goes on (reading
`interrupt-recheck`).
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from ..machine.conditions import condition_truth
from ..machine.config import PASS, Abrupt, Config, Stack, State, Value
from ..machine.outcome import Next, Outcome
from ..machine.simulation_state import Clause, Deadline, Suspended, Who, has_passed, simulation_of
from ..python.control_flow import Finally, Handling, block, try_statement
from ..python.functions import body_as_statement
from ..store.errors import NotBegun
from ..syntax import dynamics as d
from ..syntax import statements as s
from ..syntax.nodes import Expression, Node
from .coroutines import Coroutine, address_of, push_frames, restore_coroutine
from .endings import give_up
from .frames import Abortable, Interruptible, Returning
from .guards import guards_on_resumption, invoked_in, reduce_guards


class Interrupting(NamedTuple):
    """Frame: the condition of clause `clause` of the statement `process.frames[place]` is being reduced."""

    process: Suspended
    place: int
    clause: int


# Statements


def try_rule(node: s.Try, stack: Stack, state: State) -> Outcome:
    """`try`: with `interrupt when`, a rule of its own."""
    return try_interrupt(node, stack, state) if node.interrupts else try_statement(node, stack, state)


def try_interrupt(node: s.Try, stack: Stack, state: State) -> Outcome:
    """`try: ... interrupt when B: ... except E: ...`: the conditions are checked before the body begins (reading `interrupt-first-step`)."""
    outer: Stack = (Abortable(), stack)
    if node.final:
        outer = (Finally(node.final), outer)
    if node.handlers or node.otherwise:
        outer = (Handling(node), outer)
    clauses = tuple(Clause(i.condition, i.body) for i in node.interrupts)
    return interruptible(node, clauses, node.body, outer, state)


def interruptible(node: Node, clauses: tuple[Clause, ...], body: s.Block, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Interrupts": "when a try statement executes, the conditions for each interrupt when block are checked at each time
    step. While none of them are true, the try block executes."
    """
    assert state.simulation is not None
    frame = Interruptible(node, clauses, state.sigma, state.handling, state.depth, state.simulation.step)
    whole = body_as_statement(body)
    if state.reading("interrupt-first-step") == "later-steps":
        return Next("D-Try", Config(whole, (frame, stack), state), node)
    fresh = Suspended(whole, (frame,), state.sigma, state.handling, state.depth, begun=False)
    return Next("D-Try", Config(PASS, (Entering(fresh), stack), state), node)


def resume_abortable(frame: Abortable, result: object, stack: Stack, state: State) -> Outcome:
    """The statement is reduced to `pass`."""
    return Next("", Config(PASS, stack, state))


def unwind_abortable(frame: Abortable, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """`abort` has ended the statement; all else passes through."""
    return Next("", Config(PASS if abrupt.kind == "abort" else abrupt, stack, state))


class Entering(NamedTuple):
    """Frame: a statement with interrupts begins, and its conditions are checked for the first time."""

    process: Suspended


def resume_entering(frame: Entering, result: object, stack: Stack, state: State) -> Outcome:
    """Check the conditions of the interrupts."""
    return check_interrupts(frame.process, stack, state)


def abort(node: d.Abort, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Interrupts": "any block may execute the abort statement to immediately terminate the entire try statement."
    """
    return Next("D-Abort", Config(Abrupt("abort", None, node.span), stack, state), node)


# The start of a time step


def check_interrupts(process: Suspended, stack: Stack, state: State, place: int | None = None, clause: int | None = None) -> Outcome:
    """Look at the conditions of the statements that a coroutine is in, outermost first; let it go on if none is true.

    `place` and `clause` say where to go on looking.
    """
    place = len(process.frames) - 1 if place is None else place
    while place >= 0:
        frame = process.frames[place]
        if isinstance(frame, Interruptible):
            clause = len(frame.clauses) - 1 if clause is None else clause
            while clause > frame.current:
                condition = frame.clauses[clause].condition
                if not isinstance(condition, Deadline):
                    asked = (Interrupting(process, place, clause), push_frames(process.frames[place + 1 :], stack))
                    return Next("", Config(condition, asked, state._replace(sigma=frame.sigma, handling=frame.handling, depth=frame.depth)))
                if has_passed(condition, frame.first_step, simulation_of(state)):
                    return interrupt(process, place, clause, stack, state)
                clause -= 1
        place, clause = place - 1, None
    return go_on(process, stack, state)


def resume_interrupting(frame: Interrupting, result: object, stack: Stack, state: State) -> Outcome:
    """A condition was reduced: interrupt, or look at the next."""
    statement = frame.process.frames[frame.place]
    assert isinstance(statement, Interruptible)
    for _ in frame.process.frames[frame.place + 1 :]:
        stack = stack[1]
    condition = statement.clauses[frame.clause].condition
    assert isinstance(condition, Expression)
    what = "the condition of an interrupt" if isinstance(statement.node, s.Try) else "the condition of `until`"
    if condition_truth(result, condition.span, state, what, "D-Interrupt"):
        return interrupt(frame.process, frame.place, frame.clause, stack, state)
    return check_interrupts(frame.process, stack, state, frame.place, frame.clause - 1)


def unwind_interrupting(frame: Interrupting, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """A condition raised an exception, which leaves its statement: what that was running is given up.

    One about a scenario that has not begun is not true yet (reading `names-not-begun`).
    """
    if isinstance(abrupt.value, NotBegun):
        return resume_interrupting(frame, False, stack, state)
    inside = frame.process._replace(frames=frame.process.frames[: frame.place + 1])
    return give_up((inside,), Config(abrupt, stack, state))


def interrupt(process: Suspended, place: int, clause: int, stack: Stack, state: State) -> Outcome:
    """Suspend what the statement is running, and begin a handler.

    Where it was the behavior's own `take` that waited, and nothing that it invoked, the behavior goes on: its invariants are checked.
    """
    frame = process.frames[place]
    assert isinstance(frame, Interruptible)
    interrupted = process._replace(frames=process.frames[:place])
    now = simulation_of(state).step
    handling = frame._replace(current=clause, since=now, waiting=(*frame.waiting, (frame.current, frame.since, interrupted)))
    own = state._replace(sigma=frame.sigma, handling=frame.handling, depth=frame.depth)
    condition = frame.clauses[clause].condition
    node = frame.node if isinstance(condition, Deadline) else condition
    whole = (handling, push_frames(process.frames[place + 1 :], stack))
    goes_on = process.begun and (not invoked_in(interrupted.frames) or state.reading("invariant-of-caller") == "every-step")
    guards = guards_on_resumption(whole, state) if goes_on else ()
    return reduce_guards(guards, partial(begin_handler, frame.clauses[clause].block, node), whole, own)


def begin_handler(handler: s.Block, node: Node, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Interrupts": "When an interrupt condition becomes true, the body of the corresponding block is executed (with lower
    blocks preempting those above), suspending any behaviors/scenarios that were executing in the try block until the interrupt handler completes".
    """
    return block(handler, stack, state, "D-Interrupt", node)


def resume_interruptible(frame: Interruptible, result: object, stack: Stack, state: State) -> Outcome:
    """The body is done, and so is the statement; or a handler is, and what it interrupted goes on, unless it is interrupted again.

    The handler's own condition was looked at in this time step if the handler began in it, those after it anyway.
    """
    if not frame.waiting:
        return Next("", Config(PASS, stack, state))
    clause, since, interrupted = frame.waiting[-1]
    rest = frame._replace(current=clause, since=since, waiting=frame.waiting[:-1])
    whole = interrupted._replace(frames=(*interrupted.frames, rest))
    next_clause = frame.current if frame.since < simulation_of(state).step else frame.current - 1
    return check_interrupts(whole, stack, state, len(interrupted.frames), next_clause)


def unwind_interruptible(frame: Interruptible, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The statement is left: what was interrupted is given up, and scenarios in it end."""
    return give_up(tuple(process for _, _, process in frame.waiting), Config(abrupt, stack, state))


def go_on(process: Suspended, stack: Stack, state: State) -> Outcome:
    """Check the invariants of the behavior or scenario that the coroutine is in, then go on where it was."""
    whole = push_frames(process.frames, stack)
    guards = guards_on_resumption(whole, state) if process.begun else ()
    return reduce_guards(guards, partial(continue_coroutine, process.control), whole, restore_coroutine(process, state))


def continue_coroutine(control: Node | Value | Abrupt, stack: Stack, state: State) -> Outcome:
    """The coroutine goes on."""
    return Next("", Config(control, stack, state))


def run_for_one_step(process: Suspended, who: Who, stack: Stack, state: State, prefix: tuple[int, ...] | None = None) -> Outcome:
    """Let a coroutine go on until it yields or ends; the frame below gets a `Yielded` or an `Ended`. Its draws are numbered below `prefix`."""
    frame = Coroutine(who, state.sigma, state.handling, state.depth, state.prefix, state.draws)
    inner = state._replace(prefix=address_of(who, state) if prefix is None else prefix, draws=0)
    return check_interrupts(process, (frame, stack), inner)


def run_until_limit(node: Node, until: Clause, control: Value, task: object, stack: Stack, state: State) -> Outcome:
    """Go on with the frame `task` unless the limit is reached, now or later."""
    assert state.simulation is not None
    frame = Interruptible(node, (until,), state.sigma, state.handling, state.depth, state.simulation.step)
    fresh = Suspended(control, (task, frame), state.sigma, state.handling, state.depth, begun=False)
    return check_interrupts(fresh, (Abortable(), (Returning(), stack)), state)
