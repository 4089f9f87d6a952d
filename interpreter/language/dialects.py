"""Dialects: the surface syntaxes that one grammar reads (DESIGN, section 4), and what sets each apart."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...semantics.store.errors import UsageError

MARK = re.compile(r"\ufeff?[ \t]*#[ \t]*dialect[ \t]*:[ \t]*(\S+)")


@dataclass(frozen=True, slots=True)
class Dialect:
    """A surface syntax.

    `explicit_new`: objects are made by `new C ...`, and a class name alone is always the class. `intervals`: a pair in
    parentheses outside vector positions is an `IntervalOrPair`. `monitor_instances`: `require monitor M()`.
    `initial_scenario`: the condition is spelt `initial scenario`. `released`: statements, specifiers and operators that the paper does not have.
    `profile`: the readings under which its programs mean what their authors meant, unless others are asked for.
    """

    name: str
    summary: str
    explicit_new: bool = False
    intervals: bool = False
    monitor_instances: bool = False
    initial_scenario: bool = False
    released: bool = False
    profile: str = "paper"


DIALECTS: dict[str, Dialect] = {
    dialect.name: dialect
    for dialect in (
        Dialect("paper", "the syntax of the paper's Section 4"),
        Dialect("pldi19", "the gallery's: (low, high) is an interval, X @ Y a vector", intervals=True),
        Dialect(
            "scenic-2.1", "the released Scenic 2.1: `initial scenario`", initial_scenario=True, released=True, profile="scenic-2.1",
        ),
        Dialect(
            "scenic-3",
            "the released Scenic 3: `new C`, `require monitor M()`, `initial scenario`",
            explicit_new=True,
            monitor_instances=True,
            initial_scenario=True,
            released=True,
            profile="scenic-3",
        ),
    )
}

DEFAULT = "paper"


def choose(text: str, asked: str | None) -> Dialect:
    """The dialect asked for, else the one the first line names in a comment `# dialect: NAME`, else the paper's.

    Raises UsageError for an unknown dialect.
    """
    mark = MARK.match(text)
    name = asked if asked is not None else mark.group(1) if mark else DEFAULT
    if name not in DIALECTS:
        raise UsageError(f"there is no dialect {name!r}", hint=f"the dialects are {', '.join(DIALECTS)}")
    return DIALECTS[name]


def dialects_with_feature(feature: str) -> str:
    """The names of the dialects with a feature, for messages."""
    return " and ".join(name for name, dialect in DIALECTS.items() if getattr(dialect, feature))
