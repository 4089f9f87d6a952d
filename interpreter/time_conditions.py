"""A time with its unit where a condition is meant: `do B() until 5 seconds`, `terminate when 3 steps`."""

from __future__ import annotations

import re

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Expression
from ..semantics.syntax.expressions import Seconds
from ..semantics.syntax.python_expressions import BinaryOperation, UnaryOperation
from .dialects import Dialect
from .printer import to_source

WORDS = (
    "until", "wait until", "terminate when", "terminate simulation when", "interrupt when", "require", "require always",
    "require eventually", "precondition", "invariant",
)  # fmt: skip
"""What has a condition behind it that decides when something happens."""
SPELT = "|".join(word.replace(" ", r"\s+") for word in sorted(WORDS, key=len, reverse=True))
STEPS = re.compile(rf"\b(?P<word>{SPELT})\s*:?\s*(?P<time>(?P<amount>[\w.]+)\s+steps)\b")
"""A number of time steps behind one of the words."""


def is_time(node: Expression) -> bool:
    """Whether an expression is a number of seconds by the way it is written."""
    match node:
        case Seconds():
            return True
        case BinaryOperation(left=left, operator="+" | "-" | "*", right=right):
            return is_time(left) or is_time(right)
        case UnaryOperation(operator="+" | "-", operand=operand):
            return is_time(operand)
        case _:
            return False


def refuse_time(word: str, node: Expression, dialect: Dialect) -> Expression:
    """The condition behind `word`. Raises `ParseError` for a time."""
    if is_time(node):
        time = to_source(node, dialect.name)
        amount = to_source(node.value, dialect.name) if isinstance(node, Seconds) else "..."
        hint = instead(word, time, amount, released=dialect.released)
        raise ParseError(message(word, time), node.span, hint=hint)
    return node


def message(word: str, time: str) -> str:
    """What is wrong with a time behind a word that takes a condition."""
    return f"`{word}` takes a condition, and `{time}` is a time"


def instead(word: str, time: str, amount: str, *, released: bool) -> str:
    """What to write for it: in a dialect of the releases the clock counts steps, in others seconds."""
    in_steps = time.endswith("steps")
    if released:
        clock = "simulation().currentTime" + ("" if in_steps else " * simulation().timestep")
    else:
        clock = "simulation.currentTime" + (" / simulation.timestep" if in_steps else "")
    match word.split():
        case ["until"]:
            return f"write `for {time}`"
        case ["wait", "until"]:
            return f"write `wait for {time}`"
        case ["terminate", "when"] if released:
            return f"write `terminate after {time}`"
        case ["require", *_]:
            end = f"terminate after {time}" if released else f"terminate when {clock} >= {amount}"
            return f"write what must hold; a simulation is ended by `{end}`"
        case ["precondition" | "invariant"]:
            return f"write what must hold, such as `{word}: {clock} >= {amount}`"
        case _:
            return f"write `{word} {clock} >= {amount}`"
