"""Formulas over time that look like calls: `require (always (B))` in the dialects of the releases."""

from __future__ import annotations

from typing import Literal

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Expression
from ..semantics.syntax.python_expressions import BooleanOperation, Call, Conditional, Name, UnaryOperation
from .dialects import Dialect
from .tree_builder import condition

MESSAGE = "over time there are `require always B` and `require eventually B` for a condition B, and no other formulas (`next`, `until`, `implies`)"
HINT = "write `not B or C` for `B implies C`, and a monitor for what else is required"


def over_time(node: Expression, dialect: Dialect) -> tuple[Literal["", "always", "eventually"], Expression]:
    """The operator that the whole condition of a requirement is an application of, and its operand; "" and the condition if it is none.

    Raises `ParseError` for one that stands deeper.
    """
    word = operator_of(node, dialect)
    if word not in ("always", "eventually"):
        refuse_formulas(node, dialect)
        return "", node
    assert isinstance(node, Call)
    refuse_formulas(node.arguments[0], dialect)
    return word, condition(node.arguments[0])


def operator_of(node: Expression, dialect: Dialect) -> str:
    """The operator over time that a call spells: none in the paper's dialects, and `next` is one in `scenic-3` alone."""
    words = ("always", "eventually", "next")[: 2 + dialect.explicit_new] if dialect.released else ()
    if isinstance(node, Call) and isinstance(node.function, Name) and node.function.name in words and len(node.arguments) == 1 and not node.keywords:
        return node.function.name
    return ""


def refuse_formulas(node: Expression, dialect: Dialect) -> None:
    """Raises `ParseError` at an operator over time among the parts of a condition that are truth values."""
    pending = [node]
    while pending:
        part = pending.pop()
        if operator_of(part, dialect):
            raise ParseError(MESSAGE, part.span, hint=HINT)
        match part:
            case BooleanOperation(operands=operands):
                pending.extend(operands)
            case UnaryOperation(operator="not", operand=operand):
                pending.append(operand)
            case Conditional(then=then, test=test, otherwise=otherwise):
                pending.extend((then, test, otherwise))
            case _:
                pass
