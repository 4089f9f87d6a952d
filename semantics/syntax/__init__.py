"""The abstract syntax: one frozen node per production of the paper's grammar, under the paper's names."""

from __future__ import annotations

from dataclasses import dataclass

from . import dynamics, expressions, nodes, python_expressions, specifiers, statements
from .nodes import Expression, Node, Span, Specifier, Statement
from .statements import Block

__all__ = [
    "Block",
    "Expression",
    "Node",
    "Program",
    "Span",
    "Specifier",
    "Statement",
    "dynamics",
    "expressions",
    "nodes",
    "python_expressions",
    "specifiers",
    "statements",
]


@dataclass(frozen=True, slots=True)
class Program:
    """A parsed and checked program: its statements, the file name, the text and the dialect it was written in."""

    statements: Block
    file: str
    text: str
    dialect: str = "paper"
