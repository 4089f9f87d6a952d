"""Comprehensions, as in Python: the first iterable is reduced in the scope around, the rest in a scope of its own."""

from __future__ import annotations

from typing import NamedTuple

from ..kernel.conditions import truth
from ..kernel.config import Config, Stack, State, reduce, value
from ..kernel.outcome import Next, Outcome
from ..kernel.scopes import Scope, function_names, target_names
from ..kernel.sets import Set
from ..syntax import python_expressions as p
from .assignment import bind_target
from .expressions import host_container
from .functions import InScope
from .iteration import elements


class Comprehending(NamedTuple):
    """Frame of a comprehension: the elements and position of each open clause, what was found (a chain, last
    first), what is being reduced.
    """

    node: p.Comprehension
    iterators: tuple[tuple[tuple[object, ...], int], ...]
    found: tuple
    phase: tuple[str, int, int]
    key: object = None


def comprehension(node: p.Comprehension, stack: Stack, state: State) -> Outcome:
    """`[E for x in I if B]`: the first iterable in the scope around it, the rest in a scope of its own."""
    outer = InScope(state.sigma)
    frame = Comprehending(node, (), (), ("iterable", 0, 0))
    return Next("", Config(node.clauses[0].iterable, (frame, (outer, stack)), state))


def inner_scope(node: p.Comprehension, outer: Scope) -> Scope:
    """The comprehension's own scope."""
    names = frozenset(n for clause in node.clauses for n in target_names(clause.target))
    return Scope("comprehension", outer, function_names(node)._replace(local=names))


def resume_comprehension(frame: Comprehending, result: object, stack: Stack, state: State) -> Outcome:
    """Go on where the frame's phase says."""
    phase, clause, condition = frame.phase
    node = frame.node
    if phase == "iterable":
        source = tuple(elements(result, node.clauses[clause].iterable, state))
        inner = state if clause else state._replace(sigma=inner_scope(node, state.sigma))
        return advance(frame._replace(iterators=(*frame.iterators, (source, 0))), stack, inner)
    if phase == "condition":
        test = node.clauses[clause].conditions[condition]
        if not truth(result, test, state, "the condition of this comprehension"):
            return advance(frame, stack, state)
        return check_conditions(frame, clause, condition + 1, stack, state)
    if phase == "key":
        return reduce(node.element, frame._replace(phase=("element", 0, 0), key=result), stack, state)
    found = (frame.key, result) if node.kind == "dict" else result
    return advance(frame._replace(found=(found, frame.found)), stack, state)


def advance(frame: Comprehending, stack: Stack, state: State) -> Outcome:
    """⟨[E for x in I if B]⟩ → the values of E, for those elements x of I for which B holds, in order.

    Take the next element of the innermost iterator; an exhausted one gives way to the one around it.
    """
    iterators = frame.iterators
    while iterators:
        *outer, (source, position) = iterators
        if position == len(source):
            iterators = tuple(outer)
            continue
        index = len(outer)
        bind_target(frame.node.clauses[index].target, source[position], state)
        return check_conditions(frame._replace(iterators=(*outer, (source, position + 1))), index, 0, stack, state)
    kinds = {"list": list, "generator": list, "set": Set, "dict": dict}
    return value("E-Comprehension", host_container(kinds[frame.node.kind], in_order(frame.found), state), stack, state, frame.node)


def in_order(found: tuple) -> list[object]:
    """The elements of a chain (last, (..., (first, ()))), first to last."""
    items: list[object] = []
    while found:
        item, found = found
        items.append(item)
    return items[::-1]


def check_conditions(frame: Comprehending, clause: int, condition: int, stack: Stack, state: State) -> Outcome:
    """Reduce the next condition, or open the next clause, or reduce the element."""
    node = frame.node
    if condition < len(node.clauses[clause].conditions):
        return reduce(node.clauses[clause].conditions[condition], frame._replace(phase=("condition", clause, condition)), stack, state)
    if clause + 1 < len(node.clauses):
        return reduce(node.clauses[clause + 1].iterable, frame._replace(phase=("iterable", clause + 1, 0)), stack, state)
    if node.key is not None:
        return reduce(node.key, frame._replace(phase=("key", 0, 0)), stack, state)
    return reduce(node.element, frame._replace(phase=("element", 0, 0)), stack, state)
