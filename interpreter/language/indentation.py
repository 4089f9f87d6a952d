"""Layout: the post-lexer that drops line breaks inside brackets, turns indentation into tokens and knows the words of the releases."""

from __future__ import annotations

from collections.abc import Iterator

from lark.lexer import Token

from ...semantics.store.errors import ParseError
from ...semantics.syntax import Span

OPENING = frozenset({"LPAR", "LSQB", "LBRACE"})
CLOSING = frozenset({"RPAR", "RSQB", "RBRACE"})
COMMAS = frozenset({"COMMA", "_SPECIFIER_COMMA"})
ENDING = frozenset({"COMMA", "COLON", "EQUAL", "SEMICOLON"})
SPECIFYING = frozenset({
    "AT", "IN", "OFFSET_BY", "OFFSET_ALONG", "VISIBLE_FROM", "NOT_VISIBLE_FROM", "VISIBLE_LONE", "NOT_VISIBLE_LONE", "_SPECIFIER_COMMA", "_WITH",
    "_LEFT_OF", "_RIGHT_OF", "_AHEAD_OF", "_BEHIND", "_BEYOND", "_ON", "_CONTAINED_IN", "_FOLLOWING", "_FACING", "FACING_TOWARD",
    "FACING_AWAY_FROM", "_APPARENTLY_FACING",
})  # fmt: skip
TAB = 8


class Layout:
    """A token stream with `_INDENT` and `_DEDENT`; it keeps no state between texts.

    Layout tokens stand where the last significant token ended, so that blocks end where their last statement does. In the dialects of the releases
    (`released`) `deg` is an operator like `*`, and elsewhere `always` and `eventually` are names.
    """

    always_accept = ("_NEWLINE", "_WORD_COMMA")

    def __init__(self, released: bool) -> None:
        self.others = {"DEG": "LOOSE_DEG"} if released else {"ALWAYS": "NAME", "EVENTUALLY": "NAME"}

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        """The tokens of `stream`, with layout made explicit. Raises ParseError on inconsistent indentation."""
        depth = 0
        levels = [("", 0)]
        last: Token | None = None
        in_param = False
        line_start = True
        for token in _with_commas(stream):
            if token.type == "_NEWLINE":
                if depth > 0 or (in_param and last is not None and last.type == "COMMA"):
                    continue
                indentation = token.rsplit("\n", 1)[-1].split("#")[0].replace("\f", "")
                yield _after(last, "_NEWLINE", token)
                yield from _change(levels, indentation, last, token)
                line_start, in_param = True, False
                continue
            if last is None and token.column is not None and token.column > 1 and token.line == 1:
                raise ParseError("unexpected indentation", _place(token), hint="begin the first statement in the first column")
            if line_start:
                in_param = token.type == "_PARAM"
            line_start = token.type == "SEMICOLON"
            depth += (token.type in OPENING) - (token.type in CLOSING)
            last = token
            yield Token.new_borrow_pos(self.others[token.type], token, token) if token.type in self.others else token
        while len(levels) > 1:
            levels.pop()
            yield _after(last, "_DEDENT", last)


def _with_commas(stream: Iterator[Token]) -> Iterator[Token]:
    """The tokens of `stream`, with the commas before specifiers that are none made plain ones.

    A comma before `visible` alone, or before `facing(` and the like, is a specifier's where one of the same object stands before it: in
    `(1, visible)` it is a variable, in `(a, facing(b))` a function. The parameters of a lambda and its colon begin no new element. Outside
    of brackets a comma ends its line if the next one is not indented, whatever word that begins with.
    """
    specified = [False]  # of each bracket that is open, whether a specifier stands in its present element
    lambdas = [0]  # and how many lambdas there have not come to their colons
    for token in stream:
        if token.type == "_WORD_COMMA":
            token = Token.new_borrow_pos("_SPECIFIER_COMMA" if specified[-1] else "COMMA", token, token)
        if token.type in OPENING:
            specified.append(False)
            lambdas.append(0)
        elif token.type in CLOSING and len(specified) > 1:
            specified.pop()
            lambdas.pop()
        elif token.type == "_LAMBDA":
            lambdas[-1] += 1
        elif lambdas[-1] and token.type in ENDING:
            lambdas[-1] -= token.type == "COLON"
        elif token.type in ENDING or (token.type == "_NEWLINE" and len(specified) == 1):
            specified[-1], lambdas[-1] = False, 0
        elif token.type in SPECIFYING:
            specified[-1] = True
        plain = token.type == "COMMA" or token.endswith("\n")  # no object goes on behind it
        if len(specified) == 1 and token.type in COMMAS and plain and "\n" in token.replace("\\\n", ""):
            line, column, start = token.line or 1, token.column or 1, token.start_pos or 0
            specified[-1] = False
            yield Token("COMMA", ",", start, line, column, line, column + 1, start + 1)
            yield Token("_NEWLINE", token[1:], start + 1, line, column + 1, token.end_line, token.end_column, token.end_pos)
        else:
            yield token


def _change(levels: list[tuple[str, int]], indentation: str, last: Token | None, token: Token) -> Iterator[Token]:
    """The `_INDENT` or `_DEDENT` tokens that lead from `levels`, which it updates, to a line indented so."""
    width = len(indentation.expandtabs(TAB))
    text, current = levels[-1]
    end_line = (token.end_line or 1, token.end_column or 1)
    place = Span("", end_line[0], 1, end_line[0], max(2, end_line[1]))
    if width == current and indentation != text:
        raise ParseError("tabs and spaces are mixed in the indentation", place, hint="indent with spaces only")
    if width > current:
        if not indentation.startswith(text):
            raise ParseError("tabs and spaces are mixed in the indentation", place, hint="indent with spaces only")
        levels.append((indentation, width))
        yield _after(None, "_INDENT", token)
        return
    while width < levels[-1][1]:
        levels.pop()
        yield _after(last, "_DEDENT", token)
    if levels[-1] != (indentation, width):
        mixed = levels[-1][1] == width or "\t" in indentation + text
        message = "tabs and spaces are mixed in the indentation" if mixed else "this line's indentation matches no enclosing block"
        raise ParseError(message, place, hint="indent with spaces only" if mixed else "align it with the block it belongs to")


def _after(last: Token | None, kind: str, fallback: Token | None) -> Token:
    """A layout token just behind `last`, or else where `fallback` ends."""
    anchor = last if last is not None else fallback
    if anchor is None:
        return Token(kind, "", 0, 1, 1, 1, 1, 0)
    line, column, position = anchor.end_line, anchor.end_column, anchor.end_pos
    return Token(kind, "", position, line, column, line, column, position)


def _place(token: Token) -> Span:
    return Span("", token.line or 1, token.column or 1, token.end_line or 1, token.end_column or 1)
