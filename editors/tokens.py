"""The words of a text that need not be a program: pieces, phrases of the language, and statements, without the parser.

All of it takes time in proportion to the text, whatever is in it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from ..interpreter.language.keywords import LanguageWord, keywords, pattern

UNCLOSED = r"[a-zA-Z]{0,2}(?:\"\"\"[\s\S]*|'''[\s\S]*|\"[^\r\n]*|'[^\r\n]*)"
PIECES = re.compile(
    rf"(?P<comment>{pattern('COMMENT')})|(?P<string>{pattern('FSTRING')}|{pattern('STRING')}|{UNCLOSED})|(?P<name>[^\W\d]\w*)"
    rf"|(?P<number>{pattern('NUMBER')})|(?P<end>\r\n|\r|\n)|(?P<space>[ \t\f\ufeff]+|\\(?:\r\n|\r|\n))|(?P<mark>->|[=!<>]=|\*\*|//|[\s\S])"
)
OPENING, CLOSING = "([{", ")]}"
HEADS = frozenset({
    "class", "constructor", "def", "behavior", "monitor", "scenario", "if", "elif", "else", "for", "while", "try", "except", "finally", "interrupt",
    "precondition", "invariant", "setup", "compose",
})  # fmt: skip
"""The first words of lines that a block follows, or an expression behind a colon."""
BEGINNINGS = HEADS | {"import", "from", "model", "param", "require", "ego", "return", "take", "do", "terminate", "mutate", "workspace"}
"""First words of lines that are no more part of brackets which somebody has not closed yet."""
MOST_WORDS = 4
"""So many words a phrase of the language has."""


class TextPiece(NamedTuple):
    """A word, a number, a text, a comment or a mark, and where it stands."""

    kind: str
    text: str
    start: int
    end: int


class Line(NamedTuple):
    """A statement, without comments: its pieces, and how far it is indented."""

    pieces: tuple[TextPiece, ...]
    indent: int

    @property
    def words(self) -> tuple[str, ...]:
        """The texts of the pieces."""
        return tuple(piece.text for piece in self.pieces)


class Phrase(NamedTuple):
    """A word or phrase of the language at a place of the text."""

    word: LanguageWord
    start: int
    end: int


@lru_cache(maxsize=16)
def pieces(text: str) -> tuple[TextPiece, ...]:
    """The pieces of a text, its ends of lines among them, but no space."""
    found = (TextPiece(match.lastgroup or "", match[0], match.start(), match.end()) for match in PIECES.finditer(text))
    return tuple(piece for piece in found if piece.kind != "space")


def piece_at(text: str, offset: int) -> TextPiece | None:
    """The piece that an index is in, or right behind; a word if there is one."""
    near = [piece for piece in pieces(text)[first_ending(text, offset) :][:2] if piece.start <= offset]
    return next((piece for piece in near if piece.kind == "name"), near[0] if near else None)


def first_ending(text: str, offset: int) -> int:
    """The number of the first piece that ends at this index or behind it."""
    found = pieces(text)
    low, high = 0, len(found)
    while low < high:
        middle = (low + high) // 2
        low, high = (middle + 1, high) if found[middle].end < offset else (low, middle)
    return low


def phrase_at(text: str, piece: TextPiece) -> Phrase | None:
    """The phrase of the language that a word is part of."""
    number = first_ending(text, piece.end)
    before = pieces(text)[max(0, number - MOST_WORDS + 1) : number + 1]
    for first in before:
        for word in keywords() if first.kind == "name" else ():
            match = re.compile(word.pattern).match(text, first.start)
            if match is not None and match.end() >= piece.end:
                return Phrase(word, match.start(), match.end())
    return None


@lru_cache(maxsize=16)
def lines(text: str) -> tuple[Line, ...]:
    """The statements of a text, the heads of blocks apart from what stands behind their colons."""
    return tuple(line for whole in whole_lines(text) for line in split_statements(whole))


def whole_lines(text: str) -> Iterator[Line]:
    """The lines of a text, joined where brackets are open and behind a comma that ends one."""
    current: list[TextPiece] = []
    indent, depth = 0, 0
    for row in rows(text):
        deeper = indentation(text, row) > indent
        begins = row[0].text in BEGINNINGS or [piece.text for piece in row[1:2]] == ["="]
        ended = bool(current) and current[-1].text == ":" and current[0].text in HEADS
        if current and not ended and (deeper or not begins if depth else deeper and current[-1].text == ","):
            current += row
        else:
            yield from [Line(tuple(current), indent)] if current else []
            current, indent, depth = row, indentation(text, row), 0
        for piece in row:
            depth = max(0, depth + (piece.text in OPENING) - (piece.text in CLOSING))
    yield from [Line(tuple(current), indent)] if current else []


def rows(text: str) -> Iterator[list[TextPiece]]:
    """The pieces of each line of the text that has any, without comments."""
    row: list[TextPiece] = []
    for piece in pieces(text):
        if piece.kind == "end":
            yield from [row] if row else []
            row = []
        elif piece.kind != "comment":
            row.append(piece)
    yield from [row] if row else []


def indentation(text: str, row: list[TextPiece]) -> int:
    """How far a line is indented, by the space before its first piece."""
    stop = start = row[0].start
    while start and text[start - 1] in " \t\f":
        start -= 1
    return len(text[start:stop].expandtabs(8))


def split_statements(whole: Line) -> Iterator[Line]:
    """The statements of a line: those between semicolons, and what stands behind the colon of the head of a block."""
    current: list[TextPiece] = []
    depth, indent = 0, whole.indent
    for piece in whole.pieces:
        depth += (piece.text in OPENING) - (piece.text in CLOSING)
        if piece.text == ";" and depth <= 0:
            yield from [Line(tuple(current), indent)] if current else []
            current = []
            continue
        current.append(piece)
        if piece.text == ":" and depth <= 0 and current[0].text in HEADS:
            yield Line(tuple(current), indent)
            current, indent = [], indent + 1
    yield from [Line(tuple(current), indent)] if current else []
