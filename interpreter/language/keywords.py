"""The words of the language, read from the terminals of `grammar.lark`, so that whatever colours programs agrees with the parser."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from typing import NamedTuple

HEADING = re.compile(r"^// (?:-{4} Terminals: (?P<part>\w+) -+|(?P<title>Infix and trailing words|Specifiers|Prefix operators|Statements)\b.*)$")
TERMINAL = re.compile(r"^(?P<name>_?[A-Z][A-Z_]*)(?:\.(?P<priority>\d))?: (?P<body>.+)$")
PIECE = re.compile(r"/(?P<pattern>(?:[^/\\]|\\.)+)/|\"(?P<text>[^\"]+)\"|(?P<name>_?[A-Z][A-Z_]*)|(?P<bar>\|)")
WORD = re.compile(r"\(\?:[a-z]|[a-z]")
NOT_AFTER, NOT_BEFORE = r"(?<![.\w])", r"(?![ \t]*=(?!=))"
"""A word of the language is none behind a dot, or where something is assigned to it."""
KINDS = {
    "Python": "keyword", "Infix and trailing words": "operator", "Prefix operators": "operator", "Specifiers": "specifier", "Statements": "statement",
}
"""What the words under each heading of the grammar are."""
CONSTANTS = ("TRUE", "FALSE", "NONE")


class LanguageWord(NamedTuple):
    """A terminal that is a word or a phrase: its kind, and the pattern by which it is known, which may look at what follows."""

    name: str
    kind: str
    pattern: str
    priority: int


@cache
def terminals() -> dict[str, tuple[str, str, int]]:
    """Every terminal of the grammar: the heading under which it stands, its pattern, its priority."""
    found: dict[str, tuple[str, str, int]] = {}
    heading, lines = "", files(__spec__.parent if __spec__ else "scenic_ref.interpreter.language").joinpath("grammar.lark").read_text("utf-8")
    for line in re.sub(r"\n +\|", " |", lines).splitlines():
        if title := HEADING.match(line):
            heading = title["title"] or title["part"]
        elif terminal := TERMINAL.match(line):
            found[terminal["name"]] = (heading, pattern_of(terminal["body"], found), int(terminal["priority"] or 0))
    return found


def pattern_of(body: str, known: dict[str, tuple[str, str, int]]) -> str:
    """The pattern of a terminal's right-hand side; it names earlier terminals only, or later ones that look at what follows."""
    parts: list[str] = []
    for piece in PIECE.finditer(body):
        if piece["bar"]:
            parts.append("|")
        elif piece["name"]:
            parts.append(known[piece["name"]][1] if piece["name"] in known else "")
        else:
            parts.append(piece["pattern"].replace(r"\/", "/") if piece["pattern"] else re.escape(piece["text"]))
    return f"(?:{''.join(parts)})" if "|" in parts else "".join(parts)


def pattern(name: str) -> str:
    """The pattern of one terminal."""
    return terminals()[name][1]


@cache
def keywords() -> tuple[LanguageWord, ...]:
    """The words and phrases of the language, those that the parser prefers, and longer ones, first."""
    found = [
        LanguageWord(name, "constant" if name in CONSTANTS else KINDS[heading], f"{NOT_AFTER}{pattern}{NOT_BEFORE}", priority)
        for name, (heading, pattern, priority) in terminals().items()
        if heading in KINDS and (WORD.match(pattern) or name in CONSTANTS)
    ]
    return tuple(sorted(found, key=lambda one: (-one.priority, -len(one.pattern))))
