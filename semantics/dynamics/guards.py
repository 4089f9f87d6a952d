"""Preconditions and invariants (Section "Dynamic Scenarios"): a violated one is an exception, and rejects the simulation if nothing catches it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..conditions import holding
from ..config import Abrupt, Config, Stack, State
from ..outcome import Next, Outcome
from ..scopes import Scope
from ..syntax.nodes import Expression, Span


class GuardViolation(Exception):
    """A precondition or invariant does not hold."""


class PreconditionViolation(GuardViolation):
    """A precondition does not hold where a behavior or scenario begins."""


class InvariantViolation(GuardViolation):
    """An invariant does not hold where a behavior or scenario begins or goes on."""


EXCEPTIONS = {c.__name__: c for c in (GuardViolation, PreconditionViolation, InvariantViolation)}
Then = Callable[[Stack, State], Outcome]


class Guards(NamedTuple):
    """Conditions of one kind, of a behavior or scenario of this name, to be reduced in its scope; what is raised if one is not True."""

    name: str
    word: str
    conditions: tuple[Expression, ...]
    scope: Scope
    exception: type[GuardViolation]


class Guarding(NamedTuple):
    """Frame: guard number `index` is being reduced; σ is `outer` afterwards, and then comes `then`."""

    guards: tuple[Guards, ...]
    index: int
    outer: Scope
    then: Then


def guarded(guards: tuple[Guards, ...], then: Then, stack: Stack, state: State, index: int = 0) -> Outcome:
    """Reduce the guards from number `index` on, one after the other, then go on."""
    while guards and index == len(guards[0].conditions):
        guards, index = guards[1:], 0
    if not guards:
        return then(stack, state)
    frame = Guarding(guards, index, state.sigma, then)
    return Next("", Config(guards[0].conditions[index], (frame, stack), state._replace(sigma=guards[0].scope)))


def resume_guarding(frame: Guarding, result: object, stack: Stack, state: State) -> Outcome:
    """One guard was reduced."""
    first, *_ = frame.guards
    condition = first.conditions[frame.index]
    after = state._replace(sigma=frame.outer)
    article = "an" if first.word == "invariant" else "a"
    if holding(result, condition.span, state, f"{article} {first.word}", f"D-{first.word.capitalize()}"):
        return guarded(frame.guards, frame.then, stack, after, frame.index + 1)
    return Next(f"D-{first.word.capitalize()}", Config(Abrupt("raise", violation(first, condition.span), condition.span), stack, after), condition)


def unwind_guarding(frame: Guarding, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The guard raised an exception."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def violation(guards: Guards, span: Span) -> GuardViolation:
    """The exception of a guard that does not hold."""
    return guards.exception(f"the {guards.word} of {guards.name} on line {span.line}")
