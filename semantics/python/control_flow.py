"""Statements inherited from Python: blocks, `if`, loops, functions, exceptions."""

from __future__ import annotations

from typing import NamedTuple

from ..machine.conditions import random_branch, truth
from ..machine.config import PASS, Abrupt, Config, Stack, State, Value, reduce
from ..machine.host_calls import HostException, host
from ..machine.operand_kinds import kind_name
from ..machine.outcome import Next, Outcome
from ..machine.premises import premises
from ..machine.values import Random, unwrap, value_in_run
from ..syntax import python_expressions as p
from ..syntax import statements as s
from ..syntax.nodes import Node, Span
from .assignment import bind_target, finish_statement
from .functions import make_function
from .generators import EXHAUSTED, Generator, pull, take_element, walk_of_for


class Rest(NamedTuple):
    """Frame: the rest of a block, from `position` on."""

    block: s.Block
    position: int


def block(statements: s.Block, stack: Stack, state: State, rule: str = "", node: Node | None = None) -> Outcome:
    """⟨s1; s2⟩: run the statements one after the other."""
    if not statements:
        return Next(rule, Config(PASS, stack, state), node)
    rest = (Rest(statements, 1), stack) if len(statements) > 1 else stack
    return Next(rule, Config(next(iter(statements)), rest, state), node)


def resume_rest(frame: Rest, result: object, stack: Stack, state: State) -> Outcome:
    """The statement before was reduced to `pass`."""
    following = frame.position + 1
    rest = (Rest(frame.block, following), stack) if following < len(frame.block) else stack
    return Next("", Config(frame.block[frame.position], rest, state))


def pass_statement(node: s.Pass | s.Global | s.Nonlocal, stack: Stack, state: State) -> Outcome:
    """`pass`, and declarations that act when names are resolved."""
    return Next("", Config(PASS, stack, state))


# if, while, for


class Branching(NamedTuple):
    """Frame: the condition of an `if` is being reduced."""

    node: s.If


def if_statement(node: s.If, stack: Stack, state: State) -> Outcome:
    """The condition of `if B: ... else: ...` comes first."""
    if type(node.test) is p.Constant and node.test.value is True:
        return block(node.then, stack, state)
    return reduce(node.test, Branching(node), stack, state)


def resume_branching(frame: Branching, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨B⟩ → True then ⟨if B: s1 else: s2⟩ → ⟨s1⟩; if ⟨B⟩ → False then ⟨s2⟩."""
    node = frame.node
    chosen = truth(result, node.test, state, "the condition of this `if`")
    return block(node.then if chosen else node.otherwise, stack, state, "S-If", node)


class Looping(NamedTuple):
    """Frame of a loop's body: afterwards the loop goes on, a `for` with the next element of its `source`; `break` and `continue` stop here."""

    node: s.While | s.For
    source: object = None


class Testing(NamedTuple):
    """Frame: the condition of a `while` is being reduced."""

    node: s.While


class Iterating(NamedTuple):
    """Frame: the iterable of a `for` is being reduced."""

    node: s.For


def while_statement(node: s.While, stack: Stack, state: State) -> Outcome:
    """The condition of `while B: ...` comes first."""
    return reduce(node.test, Testing(node), stack, state)


def resume_testing(frame: Testing, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨B⟩ → True then ⟨while B: s⟩ → ⟨s; while B: s⟩; if ⟨B⟩ → False then its `else` block."""
    node = frame.node
    if truth(result, node.test, state, "the condition of this `while`", "let it turn a number of times that is fixed, as in `for i in range(3):`"):
        return block(node.body, (Looping(node), stack), state, "S-While", node)
    return block(node.otherwise, stack, state, "S-While", node)


def for_statement(node: s.For, stack: Stack, state: State) -> Outcome:
    """The iterable of `for x in I: ...` comes first."""
    return reduce(node.iterable, Iterating(node), stack, state)


def resume_iterating(frame: Iterating, result: object, stack: Stack, state: State) -> Outcome:
    """Begin the first turn, now that the source of the elements is known."""
    return next_turn(frame.node, walk_of_for(result, frame.node.iterable, state), stack, state)


def next_turn(node: s.For, source: object, stack: Stack, state: State) -> Outcome:
    """The next element, where it takes no more than to look for it."""
    if type(source) is Generator:
        return pull(source, (Turning(node, source), stack), state)
    element, source = take_element(source, state)
    return turn(node, element, source, stack, state)


class Turning(NamedTuple):
    """Frame: the next element of a `for` over a generator is being computed."""

    node: s.For
    source: Generator


def resume_turning(frame: Turning, result: object, stack: Stack, state: State) -> Outcome:
    """The generator gave an element, or ended."""
    return turn(frame.node, result, frame.source, stack, state)


def turn(node: s.For, element: object, source: object, stack: Stack, state: State) -> Outcome:
    """⟨for x in (v, ...): s⟩ → ⟨s; for x in (...): s, σ[x/v]⟩; after the last element, its `else` block."""
    if element is EXHAUSTED:
        return block(node.otherwise, stack, state, "S-For", node)
    bind_target(node.target, element, state)
    return block(node.body, (Looping(node, source), stack), state, "S-For", node)


def resume_looping(frame: Looping, result: object, stack: Stack, state: State) -> Outcome:
    """The body ended: go on."""
    if frame.source is None:
        return Next("", Config(frame.node, stack, state))
    return next_turn(frame.node, frame.source, stack, state)  # type: ignore[arg-type]


def unwind_looping(frame: Looping, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """If ⟨s⟩ → ⟨break⟩ then ⟨while B: s⟩ → ⟨pass⟩; if ⟨s⟩ → ⟨continue⟩ then ⟨while B: s⟩ → ⟨while B: s⟩; likewise for `for`."""
    if abrupt.kind == "break":
        return Next("S-Break", Config(PASS, stack, state))
    if abrupt.kind == "continue":
        return resume_looping(frame, None, stack, state)
    return Next("", Config(abrupt, stack, state))


def leave_block(node: s.Break | s.Continue, stack: Stack, state: State) -> Outcome:
    """`break` and `continue`."""
    return Next("", Config(Abrupt("break" if isinstance(node, s.Break) else "continue", None, node.span), stack, state))


# Functions


def return_statement(node: s.Return, stack: Stack, state: State) -> Outcome:
    """The value of `return E` comes first."""
    return premises(node, [node.value], conclude_return, stack, state)


def conclude_return(node: s.Return, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E⟩ → v then ⟨return E; s⟩ → ⟨return v⟩, which leaves the function."""
    return Next("S-Return", Config(Abrupt("return", values[0], node.span), stack, state), node)


def function_definition(node: s.FunctionDefinition, stack: Stack, state: State) -> Outcome:
    """Default values of `def f(x=E): ...` are evaluated now, once (reading `default-arguments`)."""
    defaults = [q.default for q in node.parameters]
    return premises(node, [*defaults, *node.decorators], conclude_function, stack, state)


def conclude_function(node: s.FunctionDefinition, values: list[object], stack: Stack, state: State) -> Outcome:
    """⟨def f(x=E): s, σ⟩ → ⟨pass, σ[f / the function]⟩, decorated from the innermost decorator outwards."""
    function = make_function(node, values[: len(node.parameters)], state)
    decorators = values[len(node.parameters) :]
    if not decorators:
        state.sigma.bind(node.name, function)
        return finish_statement("S-Def", node, stack, state)
    call: Node = p.Constant(value=function)
    for decorator in reversed(decorators):
        call = p.Call(function=p.Constant(value=decorator), arguments=(call,), span=node.span)  # type: ignore[arg-type]
    return Next("S-Def", Config(s.Assignment(targets=(p.Name(name=node.name),), value=call, span=node.span), stack, state), node)  # type: ignore[arg-type]


# Exceptions


class Handling(NamedTuple):
    """Frame of a `try` body: exceptions stop here."""

    node: s.Try


class Choosing(NamedTuple):
    """Frame: the type of handler `position` is being reduced to see whether it catches `abrupt`."""

    node: s.Try
    position: int
    abrupt: Abrupt


class Handled(NamedTuple):
    """Frame of a handler's body: afterwards the exception is forgotten."""

    name: str | None


class Finally(NamedTuple):
    """Frame of everything before `finally`: whatever happens, the block runs."""

    body: s.Block


class Afterwards(NamedTuple):
    """Frame of a `finally` block: afterwards go on with what led into it."""

    control: Value | Abrupt


def try_statement(node: s.Try, stack: Stack, state: State) -> Outcome:
    """`try` with `except`, `else`, `finally`; one with `interrupt when` is a rule of its own (`interrupts.try_interrupt`)."""
    outer = (Finally(node.final), stack) if node.final else stack
    return block(node.body, (Handling(node), outer), state)


def resume_handling(frame: Handling, result: object, stack: Stack, state: State) -> Outcome:
    """No exception: the `else` block."""
    return block(frame.node.otherwise, stack, state)


def unwind_handling(frame: Handling, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception: ask the handlers from the first on; anything else passes through."""
    if abrupt.kind != "raise":
        return Next("", Config(abrupt, stack, state))
    return choose_handler(frame.node, 0, abrupt, stack, state)


def choose_handler(node: s.Try, index: int, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Reduce the next handler's type, or give up."""
    if index == len(node.handlers):
        return Next("", Config(abrupt, stack, state))
    handler = node.handlers[index]
    if handler.type is None:
        return handle(handler, abrupt, stack, state)
    return reduce(handler.type, Choosing(node, index, abrupt), stack, state)


def resume_choosing(frame: Choosing, result: object, stack: Stack, state: State) -> Outcome:
    """Does the handler catch the exception?"""
    classes, origin = unwrap(result)
    if origin is not None and not state.may_branch:
        raise random_branch(Random(classes, origin), frame.node.handlers[frame.position], "which exceptions this `except` catches")
    candidates = classes if isinstance(classes, tuple) else (classes,)
    if not all(isinstance(c, type) and issubclass(c, BaseException) for c in candidates):
        raise HostException(TypeError("except needs exception classes"))
    if isinstance(frame.abrupt.value, candidates):  # type: ignore[arg-type]
        return handle(frame.node.handlers[frame.position], frame.abrupt, stack, state)
    return choose_handler(frame.node, frame.position + 1, frame.abrupt, stack, state)


def handle(handler: s.Handler, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """If ⟨s1⟩ → ⟨raise v⟩ and v is an instance of C then ⟨try: s1 except C as x: s2, σ⟩ → ⟨s2, σ[x / v]⟩."""
    exception = abrupt.value
    assert isinstance(exception, BaseException)
    if abrupt.origin is not None and not state.may_branch:
        raise random_branch(Random(exception, abrupt.origin), handler, f"the {type(exception).__name__} that this catches, or whether it is raised,")
    if handler.name is not None:
        state.sigma.bind(handler.name, exception)
    inner = state._replace(handling=(*state.handling, exception))
    return block(handler.body, (Handled(handler.name), stack), inner, "S-Except")


def forget(frame: Handled, state: State) -> State:
    """Unbind the handler's name, as Python does."""
    if frame.name is not None:
        state.sigma.unbind(frame.name)
    return state._replace(handling=state.handling[:-1])


def resume_handled(frame: Handled, result: object, stack: Stack, state: State) -> Outcome:
    """Forget the exception after its handler has ended."""
    return Next("", Config(PASS, stack, forget(frame, state)))


def unwind_handled(frame: Handled, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The handler was left otherwise."""
    return Next("", Config(abrupt, stack, forget(frame, state)))


def final_block(body: s.Block, control: Value | Abrupt, stack: Stack, state: State) -> Outcome:
    """⟨try: s1 finally: s2⟩ → ⟨s2⟩ when s1 is reduced or left, in whatever way; then on with that."""
    return block(body, (Afterwards(control), stack), state, "S-Finally")


def resume_finally(frame: Finally, result: object, stack: Stack, state: State) -> Outcome:
    """Run the block, then go on."""
    return final_block(frame.body, PASS, stack, state)


def unwind_finally(frame: Finally, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Run the block, then go on unwinding."""
    return final_block(frame.body, abrupt, stack, state)


def resume_afterwards(frame: Afterwards, result: object, stack: Stack, state: State) -> Outcome:
    """The `finally` block ended by itself."""
    return Next("", Config(frame.control, stack, state))


def raise_host_exception(problem: HostException, place: Span, stack: Stack, state: State) -> Outcome:
    """If an operation of Python raises the exception v then ⟨E⟩ → ⟨raise v⟩: blocks are left with v, and the program may catch it."""
    return Next("E-Raise", Config(Abrupt("raise", problem.exception, place, problem.origin), stack, state))


def raise_statement(node: s.Raise, stack: Stack, state: State) -> Outcome:
    """The exception of `raise E from F`, and its cause, come first."""
    return premises(node, [node.exception, node.cause], conclude_raise, stack, state)


def conclude_raise(node: s.Raise, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E⟩ → v then ⟨raise E; s⟩ → ⟨raise v⟩, which leaves blocks; a class is instantiated, a bare `raise` repeats the one being handled."""
    exception, cause = (value_in_run(v) for v in values)
    if node.exception is None:
        if not state.handling:
            raise HostException(RuntimeError("no exception is being handled"))
        exception = state.handling[-1]
    if isinstance(exception, type) and issubclass(exception, BaseException):
        exception = host(state.settings.door, state, exception)
    if not isinstance(exception, BaseException):
        raise HostException(TypeError(f"only exceptions can be raised, not {kind_name(exception)}"))
    if isinstance(cause, BaseException):
        exception.__cause__ = cause
    return Next("S-Raise", Config(Abrupt("raise", exception, node.span, unwrap(values)[1]), stack, state), node)


def assert_statement(node: s.Assert, stack: Stack, state: State) -> Outcome:
    """The condition of `assert B, M` comes first."""
    return premises(node, [node.test, node.message], conclude_assert, stack, state)


def conclude_assert(node: s.Assert, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨B⟩ → True then ⟨assert B, M⟩ → ⟨pass⟩, else AssertionError; this is no requirement, and B may not be random."""
    if truth(values[0], node.test, state, "the condition of this `assert`"):
        return finish_statement("S-Assert", node, stack, state)
    exception = AssertionError(*([] if node.message is None else [value_in_run(values[1])]))
    return Next("S-Assert", Config(Abrupt("raise", exception, node.span, unwrap(values)[1]), stack, state), node)
