"""Smaller programs with the same property: statements, specifiers and operands are left out and numbers made simple, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from itertools import chain

from ...interpreter.language.parser import parse
from ...interpreter.language.printer import to_source
from ...semantics.store.errors import ProgramError
from ...semantics.store.scopes import children
from ...semantics.syntax import Expression, Program, Statement
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax.nodes import Node

SIMPLE = (0, 1, 2, True)
"""What expressions are tried to be replaced by."""


def shrunk(text: str, holds: Callable[[str], bool], out_of_time: Callable[[], bool]) -> str:
    """A text from which nothing can be left out so that it still holds, or as far as one came in time."""
    current, seen = text, {text}
    while True:
        found = next((smaller for smaller in fresh(current, seen) if out_of_time() or holds(smaller)), None)
        if found is None or out_of_time():
            return current
        current = found


def fresh(text: str, seen: set[str]) -> Iterator[str]:
    """The texts with one thing less that were not tried yet, the largest things first: whole statements, at any depth, before their parts."""
    try:
        program = parse(text, "<shrinking>", None)
    except ProgramError:
        yield from fresh_lines(text, seen)
        return
    size = shrink_order(text)
    for variant in chain(thinner(program.statements), variants(program.statements)):
        try:
            smaller = to_source(replace_statements(program, variant))
        except Exception:  # a tree that no program has, such as one with an empty block, may be printed in any way, or not at all
            continue
        if smaller not in seen and shrink_order(smaller) < size:
            seen.add(smaller)
            yield smaller


def fresh_lines(text: str, seen: set[str]) -> Iterator[str]:
    """The texts without some of their lines, for what is not a program."""
    lines = text.splitlines(keepends=True)
    for part in parts(len(lines)):
        smaller = "".join(line for number, line in enumerate(lines) if number not in part)
        if smaller not in seen:
            seen.add(smaller)
            yield smaller


def replace_statements(program: Program, statements: object) -> Program:
    """The program with other statements."""
    assert isinstance(statements, tuple)
    return replace(program, statements=statements)


def shrink_order(text: str) -> tuple[int, int, str]:
    """Return the measure to shrink: words and signs, then characters; of two that are alike, the first in the
    order of the alphabet.
    """
    return len(text.split()), len(text), text


def parts(count: int) -> Iterator[range]:
    """Stretches of a sequence, long ones first."""
    length = count
    while length:
        yield from (range(start, min(start + length, count)) for start in range(0, count, length))
        length //= 2


def thinner(value: object) -> Iterator[object]:
    """A node or a tuple of such with less statements or clauses, or with a block in the place of the statement that holds it."""
    if isinstance(value, tuple) and value and all(isinstance(item, Node) and not isinstance(item, Expression) for item in value):
        yield from shorter(value)
        for place, item in enumerate(value):
            yield from ((*value[:place], other, *value[place + 1 :]) for other in thinner(item))
    elif isinstance(value, Node) and not isinstance(value, Expression):
        for field in fields(value):
            yield from (replace(value, **{field.name: other}) for other in thinner(getattr(value, field.name)))


def variants(value: object) -> Iterator[object]:
    """A node or a tuple of such with one change in it: what stands higher is changed first."""
    if isinstance(value, tuple):
        yield from shorter(value)
        for place, item in enumerate(value):
            for other in (*instead(item), *variants(item)):
                yield (*value[:place], other, *value[place + 1 :])
    elif isinstance(value, e.ObjectOrOperator):
        yield from variants(value.as_object)
        yield from variants(value.as_operator)
    elif isinstance(value, e.ObjectOrValue):
        yield from variants(value.value)
    elif isinstance(value, Node):
        for field in fields(value):
            held = getattr(value, field.name)
            if field.name == "span" or not isinstance(held, (Node, tuple)):
                continue
            for other in (*instead(held), *variants(held)):
                yield replace(value, **{field.name: other})
            if isinstance(held, Node):
                yield replace(value, **{field.name: None})


def shorter(items: tuple[object, ...]) -> Iterator[object]:
    """A tuple with some items less, or with a block in the place of the statement that holds it."""
    for part in parts(len(items)):
        yield (*items[: part.start], *items[part.stop :])
    for place, item in enumerate(items):
        if isinstance(item, Statement):
            for field in fields(item):
                block = getattr(item, field.name)
                if isinstance(block, tuple) and block and all(isinstance(inner, Statement) for inner in block):
                    yield (*items[:place], *block, *items[place + 1 :])


def instead(value: object) -> Iterator[object]:
    """Simpler values: an operand instead of an operation, a simple constant, a number with fewer digits."""
    if isinstance(value, p.Constant) and isinstance(value.value, (int, float)) and not isinstance(value.value, bool):
        yield from (p.Constant(value=simple) for simple in (*SIMPLE[:3], int(value.value), round(value.value, 1)) if simple != value.value)
    elif isinstance(value, Expression) and not isinstance(value, (p.Constant, p.Name)):
        yield from (inner for inner in children(value) if isinstance(inner, Expression))
        yield from (p.Constant(value=simple) for simple in SIMPLE)
        if not isinstance(value, p.TupleDisplay):
            yield p.TupleDisplay(items=(p.Constant(value=1), p.Constant(value=2)))
