"""What is inherited from Python parses, and with Python's precedence."""

from __future__ import annotations

import pytest
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.syntax import Expression
from scenic_ref.semantics.syntax import python_expressions as p

PYTHON = [
    "x = y = a, *b",
    "(a, [b, *c]), d.e, f[0] = g",
    "x **= 2; y //= 3; z <<= 1",
    "if a: pass\nelif b: pass\nelse: pass",
    "for a, b in c:\n    continue\nelse:\n    pass",
    "while a:\n    break\nelse: pass",
    "def f(a, b=1, /, c=2, *d, e, f=3, **g): return a, b",
    "def f(*, a): pass",
    "@a.b\n@c(1)\ndef f(): pass",
    "f = lambda a, *b, c=1, **d: lambda: 0",
    "x = [a for a, b in c if d if e for f in g]",
    "x = {a: b for a in c}, {a for a in b}, (a for a in b), f(a for a in b)",
    "x = {**a, 'b': 1}, {1, 2,}, {}, [], (), (1,)",
    "x = a[1], a[1:2], a[:, ::2, ...], a[b,]",
    "x = f(*a, b, c=1, **d)",
    "assert a, b\ndel a, b.c, d[0]\nraise a from b",
    "global a, b\nfrom . import a\nfrom ..b.c import (d as e, f,)\nimport a.b as c, d\nfrom x import *",
    "x = a if b else c if d else e",
    "x = a < b <= c != d is not e not in f is g",
    "x = not a and b or c",
    "x = 0xFF + 0b1 + 0o7 + 1_0.5e-3 + .5 + 5. + 1E5",
    "x = 'a' \"b\" '''c\nd''' r'\\e'",
    "x = b'a' rb'\\b'",
    'x = f"{a!r:>{w}} {b=} {{}} {c:{d}.{e}}" f"""{g["h"]}"""',
    "x = a + \\\n    b",
    "x = (a +\n\n  # comment\nb)",
    "# only a comment",
    "",
    "\n\n   \nx = 1\n\n",
    "if a:\n\tx = 1\n\tif b:\n\t\ty = 2\n",
    "x = -a ** -b % ~c",
    "x = a | b ^ c & d << e",
    "x = ...\r\ny = 1\r\n",
]


@pytest.mark.parametrize("text", PYTHON)
def test_python_construct_parses(text: str) -> None:
    parse(text)


@pytest.mark.parametrize(
    "text", ["1 + 2 * 3 - 4", "2 ** 3 ** 2", "-2 ** 2", "7 // 2 % 3", "1 << 2 + 1", "5 & 3 | 8 ^ 1", "not 0 == 1", "(1 if 0 else 2) + 3"]
)
def test_python_precedence_is_pythons(text: str) -> None:
    (statement,) = parse(f"x = ({text})").statements
    assert evaluate(statement.value) == eval(text)  # type: ignore[attr-defined]


def evaluate(node: Expression) -> object:
    """The value of a small arithmetic tree, by Python itself on its fully parenthesised text."""
    match node:
        case p.Constant():
            return node.value
        case p.UnaryOperation():
            return eval(f"{node.operator} ({evaluate(node.operand)})")
        case p.BinaryOperation():
            return eval(f"({evaluate(node.left)}) {node.operator} ({evaluate(node.right)})")
        case p.Comparison():
            return eval(f"({evaluate(node.left)}) {node.operators[0]} ({evaluate(node.operands[0])})")
        case p.Conditional():
            return evaluate(node.then) if evaluate(node.test) else evaluate(node.otherwise)
        case _:
            raise AssertionError(node)
