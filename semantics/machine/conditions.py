"""Boolean operators, conditional expressions, and reading `random-branch`: what decides control flow may not be random."""

from __future__ import annotations

import operator as python
from collections import deque
from collections.abc import Callable, Collection, Sequence
from functools import reduce as fold_left
from types import BuiltinFunctionType, MethodType
from typing import Any, NamedTuple, TypeGuard

from ..space.numeric_functions import is_needed, is_truth
from ..store.errors import RandomBranch, RunError
from ..store.scenic_classes import ScenicClass
from ..syntax import python_expressions as p
from ..syntax.nodes import Node, Span
from .config import Config, Stack, State, reduce, value
from .draws import numbered_apart
from .host_calls import host
from .operand_kinds import kind_name
from .outcome import Next, Outcome
from .premises import describe_origin
from .sandbox_table import is_user_made
from .values import (
    Applicable,
    Bound,
    Constructor,
    Dynamic,
    Function,
    Method,
    Module,
    Native,
    Random,
    Special,
    value_in_run,
)

INSTEAD_OF_BRANCHES = "use `require` to condition on it, or Uniform/Discrete to choose among values"


class Boolean(NamedTuple):
    """Frame of `and`/`or`: operand `position` is being reduced; `held` are those before it once one was random."""

    node: p.BooleanOperation
    position: int
    held: tuple[object, ...]


def boolean(node: p.BooleanOperation, stack: Stack, state: State) -> Outcome:
    """The first operand of `E1 and E2`, `E1 or E2` comes first."""
    return reduce(node.operands[0], Boolean(node, 0, ()), stack, state)


def resume_boolean(frame: Boolean, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨E1⟩ → v, and v leaves the answer open, then ⟨E1 and E2⟩ → ⟨E2⟩, else v; `or` likewise (reading `boolean-random`: where v is random)."""
    node, following = frame.node, frame.position + 1
    last, going_on = following == len(node.operands), node.operator == "and"
    if not frame.held and type(result) is not Random:
        if last or bool_of(result, node, state) is not going_on:
            return value("E-Boolean", result, stack, state, node)
        return reduce(node.operands[following], Boolean(node, following, ()), stack, state)
    held = (*frame.held, result)
    if not last and not frame.held:
        stack, state = before_operands(node.operands[following:], stack, state)
    if last:
        return value("E-Boolean", combine(node.operator, held, state), stack, state, node)
    operand = reduce(node.operands[following], Boolean(node, following, held), stack, state)
    if state.reading("boolean-random") == "operator":
        return operand
    return where_open(truth_of(result, state), going_on, operand, lambda: value("E-Boolean", combine(node.operator, held, state), stack, state, node))


def before_operands(operands: Sequence[p.Expression], stack: Stack, state: State) -> tuple[Stack, State]:
    """Number draws within the operands apart from those after them if something random decides whether the
    operands are reduced.
    """
    if state.reading("boolean-random") == "operator" or all(isinstance(operand, (p.Name, p.Constant)) for operand in operands):
        return stack, state
    return numbered_apart(stack, state)


def where_open(truth: object, going_on: bool, operand: Next, decided: Callable[[], Next]) -> Next:
    """Short-circuit on something random: the next operand is reduced where the truth so far leaves the answer open; else the answer is known."""
    return operand if is_needed(truth, going_on, operand.config.stack) else decided()._replace(beyond=operand.config)


def truth_of(result: object, state: State) -> object:
    """The truth of a value, random or not, in this run."""
    return value_in_run(host(state.settings.door, state, bool, result))


def combine(operator: str, operands: tuple[object, ...], state: State) -> object:
    """Python's `and` or `or` over values, some of which are random."""

    def fold(*values: object) -> object:
        for v in values[:-1]:
            if bool(v) is (operator == "or"):
                return v
        return values[-1]

    connective: Callable[[Any, Any], object] = {"and": python.and_, "or": python.or_}[operator]  # pyright: ignore[reportUnknownVariableType, reportUnknownMemberType]
    if all(is_truth(value_in_run(v)) for v in operands):
        return fold_left(lambda left, right: host(state.settings.door, state, connective, left, right), operands)
    return host(state.settings.door, state, fold, *operands)


def bool_of(result: object, node: Node, state: State) -> bool:
    """The truth of a value that is not random."""
    if result is True or result is False:
        return result
    if is_counted(result):
        return len(result) > 0
    answer = host(state.settings.door, state, bool, result)
    if type(answer) is Random:  # a class of the program whose truth depends on something random
        raise random_branch(answer, node, "the truth of this value")
    return bool(answer)


def is_counted(value: object) -> TypeGuard[Collection[object]]:
    """Whether the truth of a value is whether it has elements, whatever they are: of Python's own containers."""
    return not is_user_made(value) and isinstance(value, (list, tuple, dict, set, frozenset, deque))


def truth(result: object, node: Node, state: State, what: str, hint: str = INSTEAD_OF_BRANCHES) -> bool:
    """The truth of a condition that decides control flow: it may not be random outside behaviors, monitors and compose blocks."""
    if type(result) is Random:
        raise random_branch(result, node, what, hint)
    return bool_of(result, node, state)


def random_branch(result: Random, node: Node, what: str, hint: str = INSTEAD_OF_BRANCHES) -> RandomBranch:
    """Section "Syntax of Scenic": "conditional branching may not depend on random variables (except in behaviors)." It is an error, whatever was
    drawn (reading `random-branch`).
    """
    return RandomBranch(
        f"{what} is random: it depends on {describe_origin(result.origin)}, and control flow outside behaviors and compose blocks may not",
        node.span, rule="E-Branch", hint=hint,
    )


def condition_truth(result: object, span: Span, state: State, what: str, rule: str) -> object:
    """Whether the condition of a requirement, guard, interrupt or end holds, perhaps as a symbol: a boolean, in this run where it is random.

    An instance of a Python class of the program is as true as it says. Raises `RunError` for anything else (reading `condition-truth`), and under
    each reading for a definition, which would always hold.
    """
    inner = value_in_run(result)
    any_truth = state.reading("condition-truth") == "any" and not isinstance(inner, DEFINITIONS)
    holds = truth_of(result, state) if any_truth or (is_user_made(inner) and not isinstance(inner, type)) else inner
    if not is_truth(holds):
        hint = "write the condition without quotation marks" if isinstance(inner, str) else "compare it with something"
        raise RunError(f"{what} must be a boolean, not {kind_name(result)}", span, rule=rule, hint=hint)
    return holds


DEFINITIONS = (
    Dynamic, ScenicClass, type, Function, Method, Native, Bound, Special, Applicable, Constructor, Module, BuiltinFunctionType, MethodType,
)  # fmt: skip
"""Behaviors, scenarios, classes, functions, distributions and modules, which have no truth value of their own."""


class Test(NamedTuple):
    """Frame of `E1 if B else E2` while B is being reduced."""

    node: p.Conditional


def conditional(node: p.Conditional, stack: Stack, state: State) -> Outcome:
    """The condition of `E1 if B else E2` comes first."""
    return reduce(node.test, Test(node), stack, state)


def resume_test(frame: Test, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨B⟩ → True then ⟨E1 if B else E2⟩ → ⟨E1⟩; if ⟨B⟩ → False then ⟨E2⟩."""
    chosen = frame.node.then if truth(result, frame.node.test, state, "the condition of this `if`") else frame.node.otherwise
    return Next("E-Conditional", Config(chosen, stack, state), frame.node)
