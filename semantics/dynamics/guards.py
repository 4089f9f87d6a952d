"""Preconditions and invariants (Section "Dynamic Scenarios"): a violated one is an exception, and rejects the simulation if nothing catches it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from ..machine.conditions import condition_truth
from ..machine.config import PASS, Abrupt, Config, Stack, State
from ..machine.draws import Apart
from ..machine.outcome import Next, Outcome, Requirement, Stuck
from ..machine.simulation_state import TOP, Who, simulation_of
from ..machine.values import Dynamic
from ..python.expressions import resolve_waiting
from ..python.functions import bind
from ..store.errors import InvariantViolation, PreconditionViolation
from ..store.scopes import Scope, function_names
from ..syntax import dynamics as d
from ..syntax import statements as s
from ..syntax.nodes import Expression
from .coroutines import Coroutine, address_of
from .frames import Interruptible, Invoked, Returning, Scenarios, Shuffling, Together

Then = Callable[[Stack, State], Outcome]


PRECONDITIONS, INVARIANTS = 1, 2
"""The parts of a scenario (`Who.part`) whose draws are those of guards that no compose block checks."""


class Guards(NamedTuple):
    """Conditions of one kind, of a behavior or scenario of this name, to be reduced in its scope; the rule for one that does not hold."""

    name: str
    word: str
    conditions: tuple[Expression, ...]
    scope: Scope
    violated: Callable[[str, Expression, Stack, State], Outcome]


class Guarding(NamedTuple):
    """Frame: guard number `i` is being reduced; σ is `outer` afterwards, and then comes `then`."""

    guards: tuple[Guards, ...]
    i: int
    outer: Scope
    then: Then


def reduce_guards(guards: tuple[Guards, ...], then: Then, stack: Stack, state: State, index: int = 0) -> Outcome:
    """Reduce the guards from number `i` on, one after the other, then go on."""
    while guards and index == len(guards[0].conditions):
        guards, index = guards[1:], 0
    if not guards:
        return then(stack, state)
    frame = Guarding(guards, index, state.sigma, then)
    return Next("", Config(guards[0].conditions[index], (frame, stack), state._replace(sigma=guards[0].scope)))


def guarded_apart(who: Who, guards: tuple[Guards, ...], then: Then, stack: Stack, state: State) -> Outcome:
    """Reduce the guards of a scenario outside of its compose block, then go on; their draws are those of `who` in this time step."""
    if not any(one.conditions for one in guards):
        return then(stack, state)
    inner = state._replace(prefix=address_of(who, state), draws=0)
    return reduce_guards(guards, partial(after_apart, then), (Apart(state.prefix, state.draws), stack), inner)


def after_apart(then: Then, stack: Stack, state: State) -> Outcome:
    """The guards hold: go on as before."""
    frame, below = stack
    return then(below, state._replace(prefix=frame.prefix, draws=frame.draws))


def resume_guarding(frame: Guarding, result: object, stack: Stack, state: State) -> Outcome:
    """One guard was reduced."""
    first, *_ = frame.guards
    condition = first.conditions[frame.i]
    after = state._replace(sigma=frame.outer)
    article = "an" if first.word == "invariant" else "a"
    if condition_truth(result, condition.span, state, f"{article} {first.word}", f"D-{first.word.capitalize()}"):
        return reduce_guards(frame.guards, frame.then, stack, after, frame.i + 1)
    return first.violated(f"the {first.word} of {first.name} on line {condition.span.line}", condition, stack, after)


def precondition_violated(text: str, condition: Expression, stack: Stack, state: State) -> Outcome:
    """Section "Dynamic Scenarios", "Preconditions and Invariants": "Scenic signals guard violations by raising a GuardViolation exception which
    can be caught like any other exception". Here it is a PreconditionViolation, where a behavior or scenario begins.
    """
    return Next("D-Precondition", Config(Abrupt("raise", PreconditionViolation(text), condition.span), stack, state), condition)


def invariant_violated(text: str, condition: Expression, stack: Stack, state: State) -> Outcome:
    """Section "Dynamic Scenarios", "Preconditions and Invariants": "invariants which are checked at every time step during the execution of a
    behavior, not just when it begins running." A violated one raises an InvariantViolation.
    """
    return Next("D-Invariant", Config(Abrupt("raise", InvariantViolation(text), condition.span), stack, state), condition)


def at_top_level(abrupt: Abrupt) -> Stuck:
    """Section "Dynamic Scenarios", "Preconditions and Invariants": "the simulation is only rejected if the exception propagates out to the top
    level", that is out of all agents, monitors and scenarios of a time step, or out of the program before there is any.
    """
    return Stuck("D-Guard", Requirement("guard", abrupt.span, str(abrupt.value)))


def unwind_guarding(frame: Guarding, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The guard raised an exception."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def scope_of(dynamic: Dynamic, state: State, **more: object) -> Scope:
    """A new scope with the arguments as variables, and `more`; what waited for a scenario that has begun since waits no longer."""
    definition = dynamic.definition
    assert dynamic.arguments is not None
    positional = tuple(resolve_waiting(value, state) for value in dynamic.arguments[0])
    keywords = {name: resolve_waiting(value, state) for name, value in dynamic.arguments[1].items()}
    bound = bind(definition.name, definition.parameters, dynamic.defaults, positional, keywords)  # type: ignore[attr-defined]
    return Scope("function", dynamic.scope, function_names(definition), {**bound, **more})


def guards_of(dynamic: Dynamic, scope: Scope) -> tuple[Guards, Guards]:
    """The preconditions and the invariants."""
    definition = dynamic.definition
    assert isinstance(definition, (d.BehaviorDefinition, d.ScenarioDefinition))
    return (
        Guards(definition.name, "precondition", definition.preconditions, scope, precondition_violated),
        Guards(definition.name, "invariant", definition.invariants, scope, invariant_violated),
    )


def guards_on_resumption(stack: Stack, state: State) -> tuple[Guards, ...]:
    """The invariants that are checked when the coroutine on the stack goes on: those of the innermost behavior or scenario.

    Under the reading `invariant-of-caller=every-step`, those of all callers as well, from the outermost one on.
    """
    found: list[Guards] = []
    while stack:
        frame, stack = stack
        if isinstance(frame, (Together, Scenarios)) and state.reading("invariant-of-caller") == "on-return" and not found:
            return ()  # the caller waits for what it invoked
        if isinstance(frame, Invoked):
            found.append(guards_of(frame.behavior, frame.scope)[1])
        elif isinstance(frame, Coroutine):
            if frame.who.kind == "compose":
                found.append(compose_guards(frame.who.number, state))
            break
    return tuple(reversed(found)) if state.reading("invariant-of-caller") == "every-step" else tuple(found[:1])


def invoked_in(frames: tuple[object, ...]) -> bool:
    """Whether these frames run something that the coroutine has invoked."""
    return any(isinstance(frame, (Invoked, Together, Scenarios)) for frame in frames)


def return_from_do(stack: Stack, state: State) -> Outcome:
    """A `do` statement returns; not yet where it has a limit, to which `Returning` belongs, or others to shuffle."""
    inside = isinstance(stack[0], Shuffling) or (isinstance(stack[0], Interruptible) and not isinstance(stack[0].node, s.Try))
    guards = () if inside else guards_on_resumption(stack, state)[-1:]
    return reduce_guards(guards, do_returns, stack, state)


def resume_returning(frame: Returning, result: object, stack: Stack, state: State) -> Outcome:
    """The invariants of the caller are checked."""
    return return_from_do(stack, state)


def do_returns(stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Invoking Other Behaviors and Scenarios": "When the do statement returns, the invariants of the calling
    behavior/scenario are checked as above." They have been: ⟨do B⟩ → ⟨pass⟩.
    """
    return Next("D-Do-Return", Config(PASS, stack, state))


def opening_guards(state: State) -> tuple[Guards, ...]:
    """The preconditions of the initial scenario in the first time step, under the reading `initial-guards=first-step`."""
    simulation = simulation_of(state)
    top = simulation.scenarios[TOP]
    if simulation.step > 0 or top.dynamic is None or state.reading("initial-guards") == "around-setup":
        return ()
    return guards_of(top.dynamic, top.scope)[:1]


def compose_guards(number: int, state: State) -> Guards:
    """The invariants of a scenario."""
    running = simulation_of(state).scenarios[number]
    if running.dynamic is None:
        return Guards("", "invariant", (), running.scope, invariant_violated)
    return guards_of(running.dynamic, running.scope)[1]
