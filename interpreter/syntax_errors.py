"""What a user reads when the text is not a program: the place, what was expected, and one repair."""

from __future__ import annotations

import re

from lark import Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken
from lark.parsers.lalr_parser_state import ParserState

from ..semantics.kernel.errors import ParseError
from . import repairs
from .tree_builder import TextOrigin

EXPECTED_LIMIT = 8
WORD = re.compile(r"[^\W\d]\w*|\d[\w.]*|\S")
BRACKET_OR_TEXT = re.compile(
    r"#[^\n]*|\"\"\"(?:[^\\]|\\[\s\S])*?\"\"\"|'''(?:[^\\]|\\[\s\S])*?'''|\"(?:[^\"\\\n]|\\[\s\S])*\"|'(?:[^'\\\n]|\\[\s\S])*'|[()\[\]{}]"
)
PAIRS = {")": "(", "]": "[", "}": "{"}

# The names that a user knows terminals by, the most telling first.
HUMAN: dict[str, tuple[str, ...]] = {
    "an indented block": ("_INDENT",),
    "`:`": ("COLON",),
    "`)`": ("RPAR",),
    "`]`": ("RSQB",),
    "`}`": ("RBRACE",),
    "`=`": ("EQUAL",),
    "an expression": ("NUMBER",),
    "a name": ("NAME",),
    "`,`": ("COMMA",),
    "`by`": ("_BY",),
    "`from`": ("_FROM",),
    "`to`": ("_TO",),
    "`for`": ("_FOR",),
    "`import`": ("_IMPORT",),
    "`else`": ("_ELSE",),
    "a specifier": ("_FACING", "_WITH"),
    "an operator": ("DEG",),
    "a string": ("STRING",),
    "the end of the line": ("_NEWLINE",),
}


def explain(fault: UnexpectedInput, source: str, origin: TextOrigin, *, released: bool = False) -> ParseError:
    """The error for Lark's `fault` in `source`, which stands at `origin`; `released`: in a dialect of the releases."""
    line, column = place_of(fault, source, origin)
    lines = source.split("\n")
    text = lines[line - 1] if line <= len(lines) else ""
    found = WORD.match(text, column - 1)
    word = found.group() if found and not found.group().startswith("#") else ""
    end = column + max(1, len(word))
    span = origin.written(line, column, line, end)
    unclosed = bracket_fault(source, line, column, word, ended=getattr(getattr(fault, "token", None), "type", "") == "$END")
    if unclosed is not None:
        (at_line, at_column), message, hint = unclosed
        return ParseError(message, origin.written(at_line, at_column, at_line, at_column + 1), hint=hint)
    expected = expected_names(fault)
    if isinstance(fault, UnexpectedCharacters) and re.match(r"(?i)(?:[rbuf]{0,2})['\"]", text[column - 1 :]):
        return ParseError("this string is not terminated", span, hint="end it with the quotation mark it began with")
    kind = fault.token.type if isinstance(fault, UnexpectedToken) else ""
    if kind == "_INDENT":
        return ParseError("unexpected indentation", span, hint="align the line with the one before")
    above = lines[line - 2] if line > 1 else ""
    indent = "indent the line, or write `pass`"
    no_block = ParseError("expected an indented block", span, expected=expected, hint=indent)
    if expected == ("an indented block",) and not word:
        return no_block
    repair = repairs.find(
        repairs.Situation(text, column - 1 if word else len(text.rstrip()), word, above, released=released)
    )
    if repair is not None and repair.place is not None:
        start, stop = repair.place
        return ParseError(repair.message, origin.written(line, start + 1, line, stop + 1), hint=repair.hint)
    if repair is not None:
        return ParseError(repair.message, span, expected=expected, hint=repair.hint)
    if expected == ("an indented block",):
        return no_block
    return ParseError(unexpected(word, kind, expected), span, expected=expected)


def unexpected(word: str, kind: str, expected: tuple[str, ...]) -> str:
    """The message for a mistake that is not a known one."""
    what = f"unexpected `{word}`" if word else "the text ends too early" if kind == "$END" else "the line ends too early"
    return what + (f"; expected {' or '.join(expected[-3:] if len(expected) > 3 else expected)}" if expected else "")


def place_of(fault: UnexpectedInput, source: str, origin: TextOrigin) -> tuple[int, int]:
    """The 1-based line and column in `source` where parsing stopped."""
    if isinstance(fault, UnexpectedToken) and isinstance(fault.token, Token) and fault.token.type in ("$END", "_NEWLINE", "_DEDENT"):
        line, column = fault.token.end_line, fault.token.end_column
    else:
        line, column = getattr(fault, "line", None), getattr(fault, "column", None)
    if not isinstance(line, int) or not isinstance(column, int) or line < 1:
        return source.count("\n") or 1, 1
    return origin.joined.place(line, max(1, column))


def expected_names(fault: UnexpectedInput) -> tuple[str, ...]:
    """The human names of what could have stood there, at most EXPECTED_LIMIT."""
    state = getattr(fault, "state", None)
    if isinstance(state, ParserState):
        terminals = acceptable(state)
    else:
        terminals = set(getattr(fault, "allowed", None) or ())
    names = [name for name, kinds in HUMAN.items() if terminals & set(kinds)]
    if "an expression" in names:
        names = [name for name in names if name not in ("a name", "a string", "`from`", "`for`", "`import`", "an operator")]
    return tuple(names[:EXPECTED_LIMIT])


def acceptable(state: ParserState) -> set[str]:
    """The terminals with which parsing could go on: the table's candidates, each tried on a copy of the stack."""
    found: set[str] = set()
    for terminal in state.parse_conf.parse_table.states[state.position]:
        if not terminal.isupper():
            continue
        try:
            state.copy(deepcopy_values=False).feed_token(Token(terminal, ""), terminal == "$END")
        except UnexpectedToken:
            continue
        found.add(terminal)
    return found


def bracket_fault(source: str, line: int, column: int, word: str, *, ended: bool) -> tuple[tuple[int, int], str, str] | None:
    """The place, message and hint for a bracket that is closed too often, wrongly, or never."""
    stop = sum(len(text) + 1 for text in source.split("\n")[: line - 1]) + column - 1
    stack: list[tuple[str, int]] = []
    for match in BRACKET_OR_TEXT.finditer(source, 0, max(stop, 0) if not ended else len(source)):
        char = match.group()
        if char in PAIRS.values():
            stack.append((char, match.start()))
        elif char in PAIRS and stack:
            stack.pop()
    if word in PAIRS:
        if not stack:
            return (line, column), f"`{word}` closes no bracket", "remove it, or open a bracket before it"
        opening, start = stack[-1]
        if opening != PAIRS[word]:
            message = f"`{word}` does not close the `{opening}` of line {source.count(chr(10), 0, start) + 1}"
            closing = next(key for key, value in PAIRS.items() if value == opening)
            return (line, column), message, f"write `{closing}`"
    elif stack:
        opening, start = stack[-1]
        opened = source.count("\n", 0, start) + 1
        if ended or (opened < line and not is_closed(source, start)):
            message = f"this `{opening}` is never closed"
            closing = next(key for key, value in PAIRS.items() if value == opening)
            return (opened, start - source.rfind("\n", 0, start)), message, f"add `{closing}`"
    return None


def is_closed(source: str, start: int) -> bool:
    """Return whether the bracket at `start` is closed further on, so that the mistake is another one."""
    depth = 0
    for match in BRACKET_OR_TEXT.finditer(source, start):
        char = match.group()
        depth += (char in PAIRS.values()) - (char in PAIRS)
        if depth == 0:
            return True
    return False
