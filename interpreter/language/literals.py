"""The values of literals: numbers, strings, and the pieces of f-strings."""

from __future__ import annotations

import ast
import re
import unicodedata
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

PREFIX = re.compile(r"[A-Za-z]*")
ESCAPE_OR_QUOTE = re.compile(r'\\[\s\S]|"')


class LiteralFault(ValueError):
    """A literal that has no value; `offset` says where in its text the trouble is."""

    def __init__(self, message: str, offset: int = 0) -> None:
        super().__init__(message)
        self.message = message
        self.offset = offset


def parse_number_literal(text: str) -> int | float:
    """The value of a number literal. Raises LiteralFault for imaginary and malformed ones."""
    if text[-1] in "jJ" and not text.lower().startswith("0x"):
        raise LiteralFault("complex numbers are not part of the language")
    digits = text.replace("_", "")
    if digits[:2].lower() in ("0x", "0o", "0b"):
        return int(digits, 0)
    if any(mark in digits for mark in ".eE"):
        return float(digits)
    if len(digits) > 1 and digits[0] == "0" and digits.strip("0"):
        raise LiteralFault("a decimal integer cannot begin with 0; write 0o17 for an octal number")
    if len(digits) > 4000:
        raise LiteralFault("this integer has too many digits")
    return int(digits)


def name(text: str) -> str:
    """The normal form of an identifier. Raises LiteralFault if it is not one."""
    normal = text if text.isascii() else unicodedata.normalize("NFKC", text)
    if not normal.isidentifier():
        raise LiteralFault(f"{text!r} is not a name")
    return normal


def string(text: str) -> str | bytes:
    """The value of a string or bytes literal with its prefix and quotes."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = ast.literal_eval(text)
    except (SyntaxError, ValueError) as error:
        raise LiteralFault(f"bad string literal: {_reason(error)}") from None
    assert isinstance(value, str | bytes)
    return value


@dataclass(frozen=True, slots=True)
class Replacement:
    """`{expression!conversion:format}` in an f-string; offsets count from the start of the literal's text."""

    expression: str
    offset: int
    conversion: str
    format: tuple[Piece, ...] | None


Piece = str | Replacement


def f_string(text: str) -> tuple[Piece, ...]:
    """The pieces of an f-string literal with its prefix and quotes, in order."""
    found = PREFIX.match(text)
    prefix = found.group() if found else ""
    width = 3 if text[len(prefix) : len(prefix) + 3] in ('"""', "'''") else 1
    start, stop = len(prefix) + width, len(text) - width
    scanner = _Scanner(text, start, stop, raw="r" in prefix.lower())
    return tuple(_merge(scanner.pieces(nested=0)))


class _Scanner:
    """A reader of an f-string's inside, from `position` to `stop`."""

    def __init__(self, text: str, position: int, stop: int, *, raw: bool) -> None:
        self.text = text
        self.position = position
        self.stop = stop
        self.raw = raw

    def peek(self, ahead: int = 0) -> str:
        place = self.position + ahead
        return self.text[place] if place < self.stop else ""

    def pieces(self, nested: int) -> Iterator[Piece]:
        """Literal and replacement pieces up to the end, or up to the `}` that closes a format specification."""
        literal_start = self.position
        while self.position < self.stop:
            char = self.peek()
            if char == "\\" and not self.raw:
                named = self.text.startswith("\\N{", self.position)
                self.position = self.text.find("}", self.position) + 1 if named else self.position + 2
                if self.position == 0:
                    raise LiteralFault("malformed \\N{...} escape", literal_start)
            elif nested == 0 and char in "{}" and self.peek(1) == char:
                yield self.literal(literal_start, self.position + 1)
                self.position += 2
                literal_start = self.position
            elif char == "{":
                yield self.literal(literal_start, self.position)
                if nested > 1:
                    raise LiteralFault("f-string: replacements are nested too deeply", self.position)
                yield from self.replacement(nested)
                literal_start = self.position
            elif char == "}":
                if nested:
                    break
                raise LiteralFault("f-string: single '}' is not allowed", self.position)
            else:
                self.position += 1
        yield self.literal(literal_start, self.position)

    def literal(self, start: int, stop: int) -> str:
        """The value of the literal characters from `start` to `stop`."""
        piece = self.text[start:stop]
        if self.raw or "\\" not in piece:
            return piece
        value = string('"""' + ESCAPE_OR_QUOTE.sub(lambda m: '\\"' if m.group() == '"' else m.group(), piece) + '"""')
        assert isinstance(value, str)
        return value

    def replacement(self, nested: int) -> Iterator[Piece]:
        """The replacement that begins at `{`; `{x=}` gives its own text first."""
        opening = self.position
        self.position += 1
        start = self.position
        self.skip_expression(opening)
        expression, debug = self.text[start : self.position], False
        if self.peek() == "=":
            self.position += 1
            while self.peek().isspace():
                self.position += 1
            debug = True
            yield self.text[start : self.position]
        if not expression.strip():
            raise LiteralFault("f-string: empty expression", opening)
        if "\\" in expression:
            raise LiteralFault("f-string: an expression cannot contain a backslash", opening)
        conversion = ""
        if self.peek() == "!":
            conversion = self.peek(1)
            if conversion not in ("r", "s", "a"):
                raise LiteralFault("f-string: the conversion must be 'r', 's' or 'a'", self.position)
            self.position += 2
        layout: tuple[Piece, ...] | None = None
        if self.peek() == ":":
            self.position += 1
            layout = tuple(_merge(self.pieces(nested + 1)))
        if self.peek() != "}":
            raise LiteralFault("f-string: expected '}'", opening)
        self.position += 1
        if debug and not conversion and layout is None:
            conversion = "r"
        yield Replacement(expression, start, conversion, layout)

    def skip_expression(self, opening: int) -> None:
        """Move to the `}`, `!`, `:` or `=` that ends the expression begun at `opening`."""
        depth = 0
        while self.position < self.stop:
            char, pair = self.peek(), self.peek() + self.peek(1)
            if char in "'\"":
                quote = char * 3 if self.text.startswith(char * 3, self.position) else char
                end = self.text.find(quote, self.position + len(quote), self.stop)
                if end < 0:
                    raise LiteralFault("f-string: unterminated string", self.position)
                self.position = end + len(quote)
                continue
            if char == "#":
                raise LiteralFault("f-string: an expression cannot contain '#'", self.position)
            if depth == 0:
                if pair in ("!=", "==", "<=", ">="):
                    self.position += 2
                    continue
                if char in "}!:=":
                    return
            depth += (char in "([{") - (char in ")]}")
            self.position += 1
        raise LiteralFault("f-string: expected '}'", opening)


def _merge(pieces: Iterator[Piece]) -> Iterator[Piece]:
    """The pieces with neighbouring literal ones joined and empty ones left out."""
    text = ""
    for piece in pieces:
        if isinstance(piece, str):
            text += piece
            continue
        if text:
            yield text
        text = ""
        yield piece
    if text:
        yield text


def _reason(error: Exception) -> str:
    return str(error.args[0]) if error.args else "malformed"
