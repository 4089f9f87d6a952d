"""Comprehensions, as in Python: the first iterable is reduced in the scope around, the rest in a scope of its own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from .assignment import bind_target
from .conditions import truth
from .config import Config, Stack, State, reduce, value
from .expressions import elements, host_container
from .functions import InScope
from .outcome import Next, Outcome
from .scopes import Scope, function_names, target_names
from .syntax import python_expressions as p


class Comprehending(NamedTuple):
    """Frame of a comprehension: `iterators` of the open clauses, the elements found so far, what is being reduced."""

    node: p.Comprehension
    iterators: tuple[Iterator[object], ...]
    found: list[object]
    phase: tuple[str, int, int]
    key: object = None


def comprehension(node: p.Comprehension, stack: Stack, state: State) -> Outcome:
    """`[E for x in I if B]`: the first iterable in the scope around it, the rest in a scope of its own."""
    outer = InScope(state.sigma)
    names = frozenset(n for clause in node.clauses for n in target_names(clause.target))
    inner = Scope("comprehension", state.sigma, function_names(node)._replace(local=names))
    frame = Comprehending(node, (), [], ("iterable", 0, 0))
    return Next("", Config(node.clauses[0].iterable, (frame, (outer, stack)), state._replace(sigma=inner)))


def resume_comprehension(frame: Comprehending, result: object, stack: Stack, state: State) -> Outcome:
    """Go on where the frame's phase says."""
    phase, clause, condition = frame.phase
    node = frame.node
    if phase == "iterable":
        source = elements(result, node.clauses[clause].iterable, state)
        return advance(frame._replace(iterators=(*frame.iterators, iter(source))), stack, state)
    if phase == "condition":
        test = node.clauses[clause].conditions[condition]
        if not truth(result, test, state, "the condition of this comprehension"):
            return advance(frame, stack, state)
        return check_conditions(frame, clause, condition + 1, stack, state)
    if phase == "key":
        return reduce(node.element, frame._replace(phase=("element", 0, 0), key=result), stack, state)
    frame.found.append((frame.key, result) if node.kind == "dict" else result)
    return advance(frame, stack, state)


def advance(frame: Comprehending, stack: Stack, state: State) -> Outcome:
    """Take the next element of the innermost iterator; an exhausted one gives way to the one around it."""
    iterators = frame.iterators
    while iterators:
        index = len(iterators) - 1
        try:
            item = next(iterators[-1])
        except StopIteration:
            iterators = iterators[:-1]
            continue
        bind_target(frame.node.clauses[index].target, item, state)
        return check_conditions(frame._replace(iterators=iterators), index, 0, stack, state)
    kinds = {"list": list, "generator": list, "set": set, "dict": dict}
    return value("E-Comprehension", host_container(kinds[frame.node.kind], frame.found), stack, state, frame.node)


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
