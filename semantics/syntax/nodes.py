"""The base of all nodes of the syntax tree: frozen records with a place in the source."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple


class Span(NamedTuple):
    """A stretch of source text: file name, then 1-based line and column of its first and one past its last character."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


NOWHERE = Span("<built-in>", 0, 0, 0, 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Node:
    """A node; two nodes are equal when they say the same thing, wherever they stand."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


class Expression(Node):
    """A production of `value` in the paper's grammar (Figure "Simplified Scenic grammar"), or of Python's `expr`."""

    __slots__ = ()


class Specifier(Node):
    """A production of `specifier` (Tables "Specifiers for position" and "Specifiers for heading")."""

    __slots__ = ()


class Statement(Node):
    """A production of `statement` (Table "Statements"), or of Python's `stmt`."""

    __slots__ = ()
