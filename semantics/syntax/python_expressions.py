"""Expressions inherited from Python (the paper, Section "Syntax of Scenic": "standard imperative constructs")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .nodes import Expression, Node


@dataclass(frozen=True, slots=True, kw_only=True)
class Constant(Expression):
    """A literal: int, float, complex-free number, str, bytes, True, False, None or `...`."""

    value: object


@dataclass(frozen=True, slots=True, kw_only=True)
class Name(Expression):
    """A variable, given by its name."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FormattedValue(Node):
    """`{value!conversion:format}` inside an f-string; `format` is itself an f-string or None."""

    value: Expression
    conversion: Literal["", "r", "s", "a"] = ""
    format: FString | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FString(Expression):
    """An f-string: literal pieces and formatted values in order."""

    parts: tuple[str | FormattedValue, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Starred(Expression):
    """`*value` in a display, a call or an assignment target."""

    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class TupleDisplay(Expression):
    """`(a, b)`; a pair of scalars is also how the paper writes a vector."""

    items: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ListDisplay(Expression):
    """`[a, b]`."""

    items: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetDisplay(Expression):
    """`{a, b}`."""

    items: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DictDisplay(Expression):
    """`{k: v, **rest}`; a None key stands for `**`."""

    items: tuple[tuple[Expression | None, Expression], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Attribute(Expression):
    """`value.name`."""

    value: Expression
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Slice(Expression):
    """`lower:upper:step` inside a subscript."""

    lower: Expression | None = None
    upper: Expression | None = None
    step: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Subscript(Expression):
    """`value[index]`."""

    value: Expression
    index: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Keyword(Node):
    """`name=value` in a call; a None name stands for `**value`."""

    name: str | None
    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Call(Expression):
    """`function(arguments, keywords)`; distributions (`Range(0, 1)`) and `resample(D)` are calls too."""

    function: Expression
    arguments: tuple[Expression, ...] = ()
    keywords: tuple[Keyword, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class UnaryOperation(Expression):
    """`-x`, `+x`, `~x` or `not x`."""

    operator: Literal["-", "+", "~", "not"]
    operand: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class BinaryOperation(Expression):
    """`left operator right` for Python's arithmetic and bitwise operators (`@` is `VectorOf`)."""

    operator: Literal["+", "-", "*", "/", "//", "%", "**", "<<", ">>", "&", "|", "^"]
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class BooleanOperation(Expression):
    """`a and b and c` or `a or b or c`."""

    operator: Literal["and", "or"]
    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison(Expression):
    """`left op right op ...`; `in` covers the paper's `X in region` (reading `is-in`: `is in` is the same)."""

    left: Expression
    operators: tuple[Literal["==", "!=", "<", ">", "<=", ">=", "in", "not in", "is", "is not"], ...]
    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditional(Expression):
    """`then if test else otherwise`."""

    test: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter(Node):
    """A parameter of a function, lambda, behavior, monitor or scenario."""

    name: str
    default: Expression | None = None
    kind: Literal["positional", "positional only", "*args", "keyword only", "**kwargs"] = "positional"


@dataclass(frozen=True, slots=True, kw_only=True)
class Lambda(Expression):
    """`lambda parameters: body`."""

    parameters: tuple[Parameter, ...]
    body: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class ComprehensionClause(Node):
    """`for target in iterable if condition ...`."""

    target: Expression
    iterable: Expression
    conditions: tuple[Expression, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Comprehension(Expression):
    """`[element for ...]` and its set, dict (`key: element`) and generator forms."""

    kind: Literal["list", "set", "dict", "generator"]
    element: Expression
    clauses: tuple[ComprehensionClause, ...]
    key: Expression | None = None
