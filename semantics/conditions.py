"""Boolean operators, conditional expressions, and reading `random-branch`: what decides control flow may not be random."""

from __future__ import annotations

import operator as python
from functools import reduce as fold_left
from typing import NamedTuple

from .config import Config, Stack, State, reduce, value
from .errors import RandomBranch
from .host import host
from .outcome import Next, Outcome
from .premises import describe_origin
from .symbols import is_truth
from .syntax import python_expressions as p
from .syntax.nodes import Node
from .values import Random, plain


class Boolean(NamedTuple):
    """Frame of `and`/`or`: operand `index` is being reduced; `held` are those before it once one was random."""

    node: p.BooleanOperation
    index: int
    held: tuple[object, ...]


def boolean(node: p.BooleanOperation, stack: Stack, state: State) -> Outcome:
    """`E1 and E2`, `E1 or E2`: as in Python, except that after a random operand all the others are reduced as well."""
    return reduce(node.operands[0], Boolean(node, 0, ()), stack, state)


def resume_boolean(frame: Boolean, result: object, stack: Stack, state: State) -> Outcome:
    """An operand was reduced."""
    node, last = frame.node, frame.index == len(frame.node.operands) - 1
    held = (*frame.held, result)
    if not any(type(v) is Random for v in held):
        decided = bool_of(result, node, state) is (node.operator == "or")
        if decided or last:
            return value("E-Boolean", result, stack, state, node)
        held = ()
    elif last:
        return value("E-Boolean", combine(node.operator, held, state), stack, state, node)
    return reduce(node.operands[frame.index + 1], Boolean(node, frame.index + 1, held), stack, state)


def combine(operator: str, operands: tuple[object, ...], state: State) -> object:
    """Python's `and` or `or` over values, some of which are random."""

    def fold(*values: object) -> object:
        for v in values[:-1]:
            if bool(v) is (operator == "or"):
                return v
        return values[-1]

    connective = {"and": python.and_, "or": python.or_}[operator]
    if all(is_truth(plain(v)) for v in operands):
        return fold_left(lambda left, right: host(state.settings.door, state, connective, left, right), operands)
    return host(state.settings.door, state, fold, *operands)


def bool_of(result: object, node: Node, state: State) -> bool:
    """The truth of a value that is not random."""
    if result is True or result is False:
        return result
    answer = host(state.settings.door, state, bool, result)
    if type(answer) is Random:  # a class of the program whose truth depends on something random
        raise random_branch(answer, node, "the truth of this value")
    return bool(answer)


def truth(result: object, node: Node, state: State, what: str) -> bool:
    """The truth of a condition that decides control flow: it may not be random outside behaviors."""
    if type(result) is Random:
        raise random_branch(result, node, what)
    return bool_of(result, node, state)


def random_branch(result: Random, node: Node, what: str) -> RandomBranch:
    """The error of reading `random-branch`."""
    return RandomBranch(
        f"{what} is random: it depends on {describe_origin(result.origin)}, and control flow outside behaviors may not",
        node.span, rule="E-Branch", hint="use `require` to condition on it, or Uniform/Discrete to choose among values",
    )


class Test(NamedTuple):
    """Frame of `E1 if B else E2` while B is being reduced."""

    node: p.Conditional


def conditional(node: p.Conditional, stack: Stack, state: State) -> Outcome:
    """`E1 if B else E2`."""
    return reduce(node.test, Test(node), stack, state)


def resume_test(frame: Test, result: object, stack: Stack, state: State) -> Outcome:
    """Go on with the branch that the condition chose."""
    chosen = frame.node.then if truth(result, frame.node.test, state, "the condition of this `if`") else frame.node.otherwise
    return Next("E-Conditional", Config(chosen, stack, state), frame.node)
