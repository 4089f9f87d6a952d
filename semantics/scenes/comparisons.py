"""Comparisons, and chains of them: standard, as in Python; `in` with a region is an operator of the paper."""

from __future__ import annotations

import operator as python
from collections.abc import Callable, Mapping
from typing import Any

from ..machine.conditions import before_operands, bool_of, combine, truth_of, where_open
from ..machine.config import Stack, State, Value, reduce, value
from ..machine.host_calls import HostException, host
from ..machine.operand_kinds import has_kind, is_a, is_scalar, kind_name, may_be_none
from ..machine.outcome import Next, Outcome
from ..machine.premises import Premises, premises
from ..machine.sandbox_table import is_user_made
from ..machine.value_nesting import check_written
from ..machine.values import Random, unwrap, value_in_run
from ..machine.world_queries import Parameters
from ..python.call_costs import check_key
from ..space.regions import Region
from ..store.containers import copy_inner_lists, deque
from ..syntax import python_expressions as p
from .operator_application import membership


def contains(container: Any, item: object) -> bool:
    """`item in container`. Raises TypeError for a number, which a distribution gives as well."""
    if is_scalar(container) and not is_user_made(container):
        error = TypeError("`in` needs a container or a region behind it, and this is one number")
        error.add_note("compare it, as in `3 <= x <= 5`; a distribution such as Range(3, 5) stands for the one number that it draws")
        raise error
    if isinstance(container, (dict, set, frozenset)):
        check_key(item)
    return item in container


COMPARE: Mapping[str, Callable[..., object]] = {
    "==": python.eq, "!=": python.ne, "<": python.lt, ">": python.gt, "<=": python.le, ">=": python.ge,
    "is": python.is_, "is not": python.is_not,
    "in": lambda left, right: contains(right, left), "not in": lambda left, right: not contains(right, left),
}


def comparison(node: p.Comparison, stack: Stack, state: State) -> Outcome:
    """`E1 < E2 <= E3`: the first two operands come first."""
    return premises(node, [None, node.left, node.operands[0]], conclude_comparison, stack, state, [()])


def conclude_comparison(node: p.Comparison, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E1⟩ → v1 and ⟨E2⟩ → v2 then ⟨E1 < E2⟩ → v1 < v2; of E1 < E2 <= E3, from left to right until a link does not hold.

    `values` are the links before this one and its operands. `in` with a region is an operator of the paper.
    """
    held: tuple[object, ...] = values[0]  # type: ignore[assignment]
    left, right = values[1:]
    name = node.operators[len(held)]
    if node.operators == ("in",) and lies_in_region(left, right):
        return membership(node, left, right, stack, state)
    before, held = any(type(v) is Random for v in held), (*held, link(node, name, left, right, state))
    last = len(held) == len(node.operators)
    if not before and type(held[-1]) is not Random:
        if last or not bool_of(held[-1], node, state):
            return value("E-Compare", held[-1], stack, state, node)
        return premises(node, [None, None, node.operands[len(held)]], conclude_comparison, stack, state, [held, right])
    if not last and not before:
        stack, state = before_operands(node.operands[len(held) :], stack, state)
    if last:
        return value("E-Compare", combine("and", held, state), stack, state, node)
    frame = Premises(node, [None, None, node.operands[len(held)]], 2, (held, right), conclude_comparison)
    operand = reduce(node.operands[len(held)], frame, stack, state)
    if state.reading("boolean-random") == "operator":
        return operand
    return where_open(truth_of(held[-1], state), True, operand, lambda: value("E-Compare", combine("and", held, state), stack, state, node))


def lies_in_region(left: object, right: object) -> bool:
    """Whether `left in right` is the operator of the paper."""
    if not is_a(value_in_run(right), Region):
        return False
    if not has_kind(unwrap(left)[0], "vector"):
        raise HostException(TypeError(f"{kind_name(left)} cannot lie in a region"))
    return True


def link(node: p.Comparison, name: str, left: object, right: object, state: State) -> object:
    """`left name right`, for one link of a comparison."""
    if type(left) is float and type(right) is float and name in ORDER:
        return COMPARE[name](left, right)
    if type(left) in (int, bool) and type(right) is range and name in ("in", "not in"):
        return COMPARE[name](left, right)  # without going through the numbers
    if name in ("in", "not in") and lies_in_region(left, right):
        outcome = membership(node, left, right, (), state)
        assert isinstance(outcome, Next) and isinstance(outcome.config.control, Value)
        result = outcome.config.control.value
        return result if name == "in" else host(state.settings.door, state, python.not_, result)
    if name in ("is", "is not"):
        if right is None and never_none(left):
            return name == "is not"
        if type(left) is not Random and type(right) is not Random:
            return COMPARE[name](left, right)
    if type(right) is Parameters and name in ("in", "not in"):
        right = dict(state.params)
    state.settings.door.budget.compared(value_in_run(left), value_in_run(right))
    check_written(value_in_run(left), value_in_run(right))
    if name in ("in", "not in") and unwrap(left)[1] is None:
        if isinstance(right, dict) and not is_user_made(right):
            right = right.keys()  # its values do not matter
        elif certain_member(left, right):
            return name == "in"
    if name in ORDER:
        left, right = (Random(copy_inner_lists(v.value), v.origin) if type(v) is Random else copy_inner_lists(v) for v in (left, right))
    return host(state.settings.door, state, COMPARE[name], left, right)


SIMPLE = (bool, int, float, str, type(None))


def certain_member(item: object, container: object) -> bool:
    """Whether a number or text is one of the elements that are not random: then it does not depend on a draw that it is there.

    An element before it whose class may say itself what it equals is asked first, as in Python.
    """
    if type(item) not in SIMPLE or type(container) not in (list, tuple, deque, type({}.values())):
        return False
    for element in container:  # type: ignore[attr-defined]
        if type(value_in_run(element)) not in SIMPLE:
            return False
        if type(element) is not Random and (element is item or element == item):
            return True
    return False


ORDER = frozenset({"<", ">", "<=", ">="})


def never_none(subject: object) -> bool:
    """Whether `subject` is a draw that cannot give None, so that `is None` does not depend on what is drawn (reading `is-none`)."""
    if type(subject) is not Random or subject.origin.distribution is None:
        return False
    support = subject.origin.distribution.support()
    return support is None or not any(may_be_none(value_in_run(v)) for v, _ in support)
