"""Generators, as in Python: the body runs to its next element when one is asked for; what is iterated over gives its elements one by one."""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..machine.conditions import random_branch
from ..machine.config import Abrupt, Config, Stack, State, Value
from ..machine.host_calls import HostException, raw
from ..machine.operand_kinds import is_scalar
from ..machine.outcome import Next, Outcome
from ..machine.values import Function, Random
from ..store.budget import LARGEST_SEQUENCE, Metered
from ..store.errors import NeedsElements, RunError
from ..store.generators import EXHAUSTED, Generator
from ..store.scopes import Scope
from ..syntax.nodes import Node
from ..syntax.python_expressions import Name
from .functions import InScope
from .iteration import elements

# What elements are taken from


class Walk(NamedTuple):
    """A place in a sequence, which may grow; `whole` is what the elements are of, where it may not change its size."""

    items: Sequence[object]
    position: int = 0
    whole: Sequence[object] | None = None


def walk(iterable: object, node: Node, state: State) -> object:
    """Return the source of the elements of something iterated over, one when it is asked for: a `Walk`, or an
    iterator of the program.
    """
    if type(iterable) in (list, tuple, range):
        return Walk(iterable)  # type: ignore[arg-type]
    if type(iterable) in (Generator, Metered):
        return iterable
    if isinstance(getattr(type(iterable), "__iter__", None), Function):
        found = raw(state.settings.door, state, iter, iterable)  # type: ignore[call-overload]
        if type(found) is Random:
            raise random_branch(found, node, "what its iterator gives")
        return found
    return Walk(elements(iterable, node, state), 0, iterable if hasattr(iterable, "keys") else None)  # type: ignore[arg-type]


def walk_of_for(iterable: object, node: Node, state: State) -> object:
    """`walk` for a `for` of a statement or comprehension. Raises TypeError for a number, with what to write for one that counts."""
    if is_scalar(iterable):
        error = TypeError("`for` goes through a list or a range, not a number")
        if isinstance(iterable, int) and 0 <= iterable <= LARGEST_SEQUENCE:
            error.add_note(f"write range({node.name if isinstance(node, Name) else iterable})")
        raise HostException(error, span=node.span)
    return walk(iterable, node, state)


def take_element(source: object, state: State) -> tuple[object, object]:
    """The next element of a source that is no generator, EXHAUSTED behind the last one; and the source after it."""
    if type(source) is Walk:
        items, position, container = source
        if container is not None and len(container) != len(items):
            raise HostException(RuntimeError("dictionary changed size during iteration"))
        return (items[position], source._replace(position=position + 1)) if position < len(items) else (EXHAUSTED, source)
    try:
        return raw(state.settings.door, state, next, source), source  # type: ignore[arg-type]
    except HostException as problem:
        if isinstance(problem.exception, StopIteration):
            return EXHAUSTED, source
        raise


# Generators


def begin_generator(frame: NamedTuple, scope: Scope, state: State) -> Generator:
    """A generator whose body begins in the frame and the scope."""
    return Generator(frame, scope, state.settings.door.budget, state.settings.door.calls)


GO_ON = object()
"""What the body of a generator gets where it goes on."""


class Giving(NamedTuple):
    """Frame below the body of a generator: what it gives goes to whoever asked."""

    generator: Generator


def pull(generator: Generator, stack: Stack, state: State) -> Next:
    """⟨next(g), σ⟩ → v: the body of g runs, in the σ where it was left, to its next element; EXHAUSTED after the last one."""
    if generator.running:
        raise HostException(ValueError("generator already executing"))
    if generator.place < len(generator.ahead):
        return Next("", Config(Value(next(generator)), stack, state))
    if generator.suspended is None:
        return Next("", Config(Value(EXHAUSTED), stack, state))
    frame, scope = generator.suspended
    generator.change(running=True)
    return Next("", Config(Value(GO_ON), (frame, (Giving(generator), (InScope(state.sigma), stack))), state._replace(sigma=scope)))


def give(frame: NamedTuple | None, result: object, stack: Stack, state: State) -> Outcome:
    """An element of the generator whose frame is on top of the stack: it goes on in `frame` when the next one is asked for; None at its end."""
    giving, below = stack
    giving.generator.change(suspended=None if frame is None else (frame, state.sigma), running=False)
    return Next("", Config(Value(result), below, state))


def unwind_giving(frame: Giving, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """A generator that raises an exception has ended; StopIteration becomes RuntimeError."""
    frame.generator.change(suspended=None, running=False)
    if abrupt.kind == "raise" and isinstance(abrupt.value, StopIteration):
        abrupt = abrupt._replace(value=RuntimeError("generator raised StopIteration"))
    return Next("", Config(abrupt, stack, state))


class Expanding(NamedTuple):
    """Frame: the elements of a generator are computed ahead (a chain, last first), for the step of `control`, which library code is part of."""

    generator: Generator
    control: object
    found: tuple = ()
    many: int = 0


def expand(needed: NeedsElements, config: Config) -> Next:
    """The elements of the generator first, then the step again that needs them."""
    generator: Generator = needed.generator  # type: ignore[assignment]
    return pull(generator, (Expanding(generator, config.control), config.stack), config.state)


def resume_expanding(frame: Expanding, result: object, stack: Stack, state: State) -> Outcome:
    """One more element; after the last one, the step again."""
    if result is not EXHAUSTED:
        if frame.many == LARGEST_SEQUENCE:
            raise RunError(f"a generator has more than {LARGEST_SEQUENCE:,} elements", rule="E-Next")
        return pull(frame.generator, (frame._replace(found=(result, frame.found), many=frame.many + 1), stack), state)
    frame.generator.change(ahead=unlink_elements(frame.found), place=0)
    return Next("", Config(frame.control, stack, state))  # type: ignore[arg-type]


def unlink_elements(found: tuple) -> list[object]:
    """The elements of a chain (last, (..., (first, ()))), first to last."""
    items: list[object] = []
    while found:
        item, found = found
        items.append(item)
    return items[::-1]
