"""Conditions over time that are written another way: formulas that look like calls (`require (always (B))`), times where a condition is meant, parts
of definitions elsewhere.
"""

from __future__ import annotations

import re
from typing import Literal

from ...semantics.store.errors import ParseError
from ...semantics.syntax import Expression
from ...semantics.syntax.expressions import Seconds
from ...semantics.syntax.python_expressions import BinaryOperation, BooleanOperation, Call, Conditional, Name, UnaryOperation
from .dialects import Dialect
from .printer import to_source
from .tree_builder import condition

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
        raise ParseError(time_condition_message(word, time), node.span, hint=hint)
    return node


def time_condition_message(word: str, time: str) -> str:
    """Return the message about a time behind a word that takes a condition."""
    return f"`{word}` takes a condition, and `{time}` is a time"


def instead(word: str, time: str, amount: str, *, released: bool) -> str:
    """Return the repair: in a dialect of the releases the clock counts steps, in others seconds."""
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


NO_OTHERS = "over time there are `require always B` and `require eventually B` for a condition B, and no other formulas"
WHOLE = "write a monitor for the whole condition"
DUAL = {"always": "eventually", "eventually": "always"}
TEMPORAL = re.compile(r"\b(?:always|eventually|next|until)\b")


def misplaced_operator_message(word: str, before: str, after: str) -> tuple[str, str]:
    """The message and hint about an operator over time, or `implies`, in a condition: behind `require` stands the text `before`, then the word."""
    outer = re.sub(r"^[\s(]*(?:always|eventually)\b", "", before)
    match word:
        case "until":
            return f"{NO_OTHERS} (`until`)", "for `B until C` write a monitor that requires B in each time step before C holds"
        case "next":
            return f"{NO_OTHERS} (`next`)", "for `next B` write a monitor that waits for one time step and then requires B"
        case "implies" if TEMPORAL.search(outer + after):
            return f"{NO_OTHERS} (`implies` around them)", WHOLE
        case "implies":
            return "`implies` is not part of the language", "write `not B or C` for `B implies C`"
        case _:
            return inside_condition(word, joined_by(before, after))


def joined_by(before: str, after: str) -> str:
    """The one word that makes a larger condition of an operator over time between these texts: "and" or "not"; "" where it is another."""
    start = before.rstrip(" \t(")
    joining = set(re.findall(r"\b(?:and|or|not|implies|until|if|else)\b", f"{before} {after}"))
    if start.count("(") != start.count(")") or len(joining) != 1:
        return ""
    alone = "not" in joining and not start.replace("not", "", 1).strip(" (")
    return "and" if "and" in joining else "not" if alone else ""


def inside_condition(word: str, joined: str) -> tuple[str, str]:
    """The message and hint about `always` or `eventually` in a condition that is larger by the word `joined`, "" for any other reason."""
    hints = {"and": f"write two statements, one of them `require {word} B`", "not": f"for `not {word} B` write `require {DUAL[word]} not (B)`"}
    return f"`{word}` stands directly behind `require`, not within a larger condition", hints.get(joined, WHOLE)


def with_probability(word: str) -> tuple[str, str]:
    """The message and hint about an operator over time behind a probability."""
    return f"`{word}` stands directly behind `require`: a requirement over time has no probability", "leave out the brackets and the probability"


def over_time(node: Expression, dialect: Dialect) -> tuple[Literal["", "always", "eventually"], Expression]:
    """The operator that the whole condition of a requirement is an application of, and its operand; "" and the condition if it is none.

    Raises `ParseError` for one that stands deeper.
    """
    word = operator_of(node, dialect)
    if word not in ("always", "eventually"):
        refuse_formulas(node, dialect)
        return "", node
    assert isinstance(node, Call)
    refuse_formulas(node.arguments[0], dialect, "")
    return word, condition(node.arguments[0])


def operator_of(node: Expression, dialect: Dialect) -> str:
    """The operator over time that a call spells: none in the paper's dialects, and `next` is one in `scenic-3` alone."""
    words = ("always", "eventually", "next")[: 2 + dialect.explicit_new] if dialect.released else ()
    if isinstance(node, Call) and isinstance(node.function, Name) and node.function.name in words and len(node.arguments) == 1 and not node.keywords:
        return node.function.name
    return ""


def refuse_formulas(node: Expression, dialect: Dialect, joined: str = "whole") -> None:
    """Raises `ParseError` at an operator over time among the parts of a condition that are truth values.

    `joined` is the one word that the condition is joined by so far, "whole" for the whole condition of `require`, "" for what stands deeper.
    """
    pending = [(node, joined)]
    while pending:
        part, joined = pending.pop()
        if word := operator_of(part, dialect):
            message, hint = misplaced_operator_message("next", "", "") if word == "next" else inside_condition(word, joined)
            raise ParseError(message, part.span, hint=hint)
        match part:
            case BooleanOperation(operator=operator, operands=operands):
                pending.extend((operand, operator if joined in ("whole", operator) else "") for operand in operands)
            case UnaryOperation(operator="not", operand=operand):
                pending.append((operand, "not" if joined == "whole" else ""))
            case Conditional(then=then, test=test, otherwise=otherwise):
                pending.extend((inner, "") for inner in (then, test, otherwise))
            case _:
                pass

