"""The phrases of the language as completion offers them, by where they can stand."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from ..interpreter.keywords import LanguageWord, keywords

SPECIFIERS = (
    "at", "in", "on", "offset by", "offset along", "left of", "right of", "ahead of", "behind", "beyond", "visible", "visible from", "following",
    "facing", "facing toward", "facing away from", "apparently facing", "with",
)  # fmt: skip
RELEASED_SPECIFIERS = ("contained in", "not visible", "not visible from")
PREFIXES = (
    "relative heading of", "apparent heading of", "distance to", "distance from", "angle to", "angle from", "follow", "visible", "front of",
    "back of", "left of", "right of", "front left of", "front right of", "back left of", "back right of", "distance past", "not",
    "lambda", "True", "False", "None",
)  # fmt: skip
RELEASED_PREFIXES = ("new", "relative position of", "not visible", "initial scenario")
INFIXES = (
    "at", "offset by", "offset along", "relative to", "can see", "visible from", "deg", "seconds", "by", "from", "to", "for", "in", "not in", "is",
    "is not", "and", "or", "if", "else", "as", "until", "steps", "past", "of", "in initial scenario",
)  # fmt: skip
RELEASED_INFIXES = ("intersects", "not visible from", "every", "after")
PYTHON = ("if", "for", "while", "try", "def", "assert", "raise", "del", "pass")
CLAUSES = ("elif", "else", "except", "finally", "break", "continue")
DECLARATIONS = (
    "class", "import", "from", "model", "param", "require", "require always", "require eventually", "terminate when", "mutate", "behavior", "monitor",
    "scenario",
)  # fmt: skip
RELEASED_DECLARATIONS = (
    "require monitor", "terminate simulation when", "terminate after", "record", "record initial", "record final", "simulator", "mutate by",
)  # fmt: skip
DYNAMIC = ("take", "wait", "terminate", "do", "do choose", "do shuffle", "interrupt when", "abort", "return")
RELEASED_DYNAMIC = ("wait for", "wait until", "terminate simulation")
STATEMENTS: Mapping[str, tuple[str, ...]] = {
    "module": (*DECLARATIONS, *PYTHON, *CLAUSES),
    "class": ("def", "pass"),
    "function": ("return", "global", "nonlocal", *PYTHON, *CLAUSES),
    "behavior": ("precondition", "invariant", *DYNAMIC, *PYTHON, *CLAUSES),
    "monitor": (*DYNAMIC, *PYTHON, *CLAUSES, "require"),
    "scenario": ("precondition", "invariant", "setup", "compose", "override", *DECLARATIONS, *DYNAMIC, *PYTHON, *CLAUSES),
}
"""The first words of statements, by the kind of definition that they stand in."""
RELEASED_STATEMENTS: Mapping[str, tuple[str, ...]] = {
    "module": RELEASED_DECLARATIONS, "behavior": RELEASED_DYNAMIC, "monitor": RELEASED_DYNAMIC,
    "scenario": (*RELEASED_DECLARATIONS, *RELEASED_DYNAMIC),
}  # fmt: skip
POSTFIXES = frozenset({"DEG", "SECONDS", "STEPS", "VISIBLE_LONE", "NOT_VISIBLE_LONE", "TRUE", "FALSE", "NONE", "INITIAL_SCENARIO", "PASS"})
"""Words behind which an expression is complete."""
BEHIND = (" x", " x:", ":", "", " x = 1", " from x")
"""What may follow, since the patterns of some words look at it."""


@cache
def word_of(phrase: str, kinds: tuple[str, ...] = ("specifier", "operator", "statement", "keyword", "constant")) -> LanguageWord | None:
    """The terminal of the grammar that a phrase is, of one of these kinds rather than of others."""
    found = [
        word for behind in BEHIND for word in keywords()
        if (match := re.compile(word.pattern).match(phrase + behind)) is not None and match.end() == len(phrase)
    ]  # fmt: skip
    if not found and " " in phrase:
        return word_of(phrase.rpartition(" ")[0], kinds)  # `distance to`: the terminal is the first word
    return next((word for word in found if word.kind in kinds), found[0] if found else None)
