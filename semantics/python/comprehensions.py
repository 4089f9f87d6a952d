"""Comprehensions, as in Python: the first iterable is reduced in the scope around, the rest in a scope of its own; a generator waits to be asked."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from ..machine.conditions import truth
from ..machine.config import Config, Stack, State, reduce, value
from ..machine.outcome import Next, Outcome
from ..store.scopes import ByIdentity, Names, Scope, function_names, target_names
from ..store.sets import Set
from ..syntax import python_expressions as p
from .assignment import bind_target
from .expressions import container
from .functions import InScope
from .generators import EXHAUSTED, GO_ON, Generator, begin_generator, give, pull, take_element, unlink_elements, walk_of_for


class Comprehending(NamedTuple):
    """Frame of a comprehension: what gives the elements of each open clause, what was found (a chain, last first), what is being reduced."""

    node: p.Comprehension
    sources: tuple[object, ...]
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
    return Scope("comprehension", outer, inner_names(ByIdentity(node)))


@lru_cache(maxsize=65536)
def inner_names(key: ByIdentity) -> Names:
    """The names of a comprehension's own scope: the variables of its clauses."""
    node: p.Comprehension = key.node  # type: ignore[assignment]
    names = frozenset(n for clause in node.clauses for n in target_names(clause.target))
    return function_names(node)._replace(local=names)


def resume_comprehension(frame: Comprehending, result: object, stack: Stack, state: State) -> Outcome:
    """Go on where the frame's phase says."""
    phase, clause, condition = frame.phase
    node = frame.node
    match phase:
        case _ if result is GO_ON:
            return advance(frame, stack, state)
        case "iterable":
            opened = frame._replace(sources=(*frame.sources, walk_of_for(result, node.clauses[clause].iterable, state)))
            if clause:
                return advance(opened, stack, state)
            inner = inner_scope(node, state.sigma)
            return generator(opened, inner, stack, state) if node.kind == "generator" else advance(opened, stack, state._replace(sigma=inner))
        case "next":
            return advance(frame._replace(sources=frame.sources[:-1]), stack, state) if result is EXHAUSTED else turn(frame, result, stack, state)
        case "condition":
            test = node.clauses[clause].conditions[condition]
            if not truth(result, test, state, "the condition of this comprehension"):
                return advance(frame, stack, state)
            return check_conditions(frame, clause, condition + 1, stack, state)
        case "key":
            return reduce(node.element, frame._replace(phase=("element", 0, 0), key=result), stack, state)
        case _ if node.kind == "generator":
            return give(frame, result, stack, state)
        case _:
            found = (frame.key, result) if node.kind == "dict" else result
            return advance(frame._replace(found=(found, frame.found)), stack, state)


def generator(frame: Comprehending, scope: Scope, stack: Stack, state: State) -> Outcome:
    """If ⟨I⟩ → v then ⟨(E for x in I if B), σ⟩ → a generator g; asked for the next one, g gives the value of E for the next x of v for which B."""
    return value("E-Generator", begin_generator(frame, scope, state), stack, state, frame.node)


def advance(frame: Comprehending, stack: Stack, state: State) -> Outcome:
    """⟨[E for x in I if B]⟩ → the values of E, for those elements x of I for which B holds, in order.

    Take the next element of the innermost source; an exhausted one gives way to the one around it.
    """
    while frame.sources:
        *outer, source = frame.sources
        if type(source) is Generator:
            return pull(source, (frame._replace(phase=("next", 0, 0)), stack), state)
        element, source = take_element(source, state)
        if element is not EXHAUSTED:
            return turn(frame._replace(sources=(*outer, source)), element, stack, state)
        frame = frame._replace(sources=tuple(outer))
    if frame.node.kind == "generator":
        return give(None, EXHAUSTED, stack, state)
    kinds = {"list": list, "set": Set, "dict": dict}
    return value("E-Comprehension", container(kinds[frame.node.kind], unlink_elements(frame.found), state), stack, state, frame.node)


def turn(frame: Comprehending, element: object, stack: Stack, state: State) -> Outcome:
    """The innermost clause has its next element."""
    clause = len(frame.sources) - 1
    bind_target(frame.node.clauses[clause].target, element, state)
    return check_conditions(frame, clause, 0, stack, state)


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
