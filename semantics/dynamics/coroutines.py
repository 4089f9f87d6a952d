"""Coroutines: behaviors, monitors and compose blocks run until they take an action or wait, and go on where they were one time step later.

A suspended coroutine is a value: what is left to do, the context around it, and its own part of the state. It is resumed by putting its frames
back onto the stack. Before that the interrupts of the `try` statements around it are checked, from the outermost one inwards, and then
the invariants of the behavior or scenario that it is in (Section "Statements", "Actions" and "Interrupts").
"""

from __future__ import annotations

from typing import NamedTuple

from ..machine.config import Abrupt, Config, Stack, State, Value
from ..machine.outcome import Next, Outcome
from ..machine.simulation_state import Suspended, Who
from ..store.scopes import Scope
from ..syntax.nodes import NOWHERE, Node

DYNAMIC = -1
"""The first number of the addresses of draws that are made while a scenario runs; those of the scene begin with a number that is at least 0."""


KINDS = ("behavior", "monitor", "compose", "condition")


class Yielded(NamedTuple):
    """The result of a coroutine's time step: it took these actions, and `rest` is what will go on."""

    actions: tuple[object, ...]
    rest: Suspended


class Ended(NamedTuple):
    """A coroutine has come to its end; `terminates`: by the statement `terminate`."""

    terminates: bool = False


class Coroutine(NamedTuple):
    """Frame at the bottom of a coroutine that runs: whose it is, and the state of those who run it."""

    who: Who
    sigma: Scope
    handling: tuple[BaseException, ...]
    depth: int
    prefix: tuple[int, ...]
    draws: int


def address_of(who: Who, state: State) -> tuple[int, ...]:
    """Return the address from which the draws of a coroutine are numbered in this time step."""
    assert state.simulation is not None
    return (DYNAMIC, state.simulation.step, KINDS.index(who.kind), who.number, who.part)


def push_frames(frames: tuple[object, ...], stack: Stack) -> Stack:
    """The stack with frames on it, the first one innermost."""
    for frame in reversed(frames):
        stack = (frame, stack)
    return stack


def restore_coroutine(process: Suspended, state: State) -> State:
    """The state with the coroutine's own part."""
    return state._replace(sigma=process.sigma, handling=process.handling, depth=process.depth)


def suspend(actions: tuple[object, ...], control: Node | Value, stack: Stack, state: State, rule: str, node: Node | None = None) -> Outcome:
    """Take the frames of the running coroutine off the stack; `control` is what it will go on with."""
    frames: list[object] = []
    while not isinstance(stack[0], Coroutine):
        frame, stack = stack
        frames.append(frame)
    rest = Suspended(control, tuple(frames), state.sigma, state.handling, state.depth, span=NOWHERE if node is None else node.span)
    return Next(rule, Config(Value(Yielded(actions, rest)), stack, state), node)


def resume_coroutine(frame: Coroutine, result: object, stack: Stack, state: State) -> Outcome:
    """The coroutine yielded, or its block is reduced to `pass`."""
    done = result if isinstance(result, Yielded) else Ended()
    return Next("", Config(Value(done), stack, back(frame, state)))


def back(frame: Coroutine, state: State) -> State:
    """The state of those who run the coroutine."""
    return state._replace(sigma=frame.sigma, handling=frame.handling, depth=frame.depth, prefix=frame.prefix, draws=frame.draws)


def unwind_coroutine(frame: Coroutine, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """`return` ends it, `terminate` as well; an exception goes on to those who run it."""
    if abrupt.kind == "raise":
        return Next("", Config(abrupt, stack, back(frame, state)))
    return Next("", Config(Value(Ended(abrupt.kind == "terminate")), stack, back(frame, state)))
