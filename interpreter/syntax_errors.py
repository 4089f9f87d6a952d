"""What a user reads when the text is not a program: the place, what was expected, and one repair."""

from __future__ import annotations

import re

from lark import Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken
from lark.parsers.lalr_parser_state import ParserState

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Span
from . import repairs
from .tree_builder import TextOrigin

EXPECTED_LIMIT = 8
WORD = re.compile(r"[^\W\d]\w*|\d[\w.]*|\S")
BLOCK_WORD = re.compile(r"\s*(setup|compose|try|else|finally|precondition|invariant)\s*(?:#.*)?$")
BRACKET_OR_TEXT = re.compile(
    r"#[^\n]*|\"\"\"(?:[^\\]|\\[\s\S])*?\"\"\"|'''(?:[^\\]|\\[\s\S])*?'''|\"(?:[^\"\\\n]|\\[\s\S])*\"|'(?:[^'\\\n]|\\[\s\S])*'|[()\[\]{}]"
)
COMMA_OR_BRACKET = re.compile(
    rf"{BRACKET_OR_TEXT.pattern}|(?<!,)\n|,\s*(?P<word>(?!visible\s*[,)\]]){repairs.SPECIFIER_START})(?=\s+[\w(.\-\"']|\()"
)
CODE = re.compile(r"(?:\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'|[^#])*")
OBJECT = re.compile(
    r"\s*(?:return\s+|(?:[^\W\d][\w.]*\s*=\s*)+)?(?P<new>new\s+)?(?:[^\W\d]\w*\.)*[A-Z]\w*(?=\s*,?\s*$|\s+" + repairs.SPECIFIER_START + r")"
)
"""An object definition that is a statement, or the value of an assignment or `return`, up to its class."""
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
    bare = BLOCK_WORD.match(lines[line - 2]) if kind == "_INDENT" and line > 1 else None
    if bare is not None:
        place = origin.written(line - 1, bare.end(1) + 1, line - 1, bare.end(1) + 2)
        return ParseError("a `:` is missing at the end of the line", place, hint=f"write `{bare[1]}:`")
    if kind == "_INDENT":
        return specifiers_without_comma(lines[: line - 1], text, origin) or ParseError(
            "unexpected indentation", span, hint="align the line with the one before"
        )
    above = lines[line - 2] if line > 1 else ""
    if expected == ("an indented block",) and not word:
        return no_block(lines[: line - 1], text, span)
    repair = repairs.find(
        repairs.Situation(text, column - 1 if word else len(text.rstrip()), word, above, released=released)
    )
    if repair is not None and repair.place is not None:
        start, stop = repair.place
        return ParseError(repair.message, origin.written(line, start + 1, line, stop + 1), hint=repair.hint)
    if repair is not None:
        return ParseError(repair.message, span, expected=expected, hint=repair.hint)
    if expected == ("an indented block",):
        return no_block(lines[: line - 1], text, span)
    return ParseError(unexpected(word, kind, expected), span, expected=expected)


def code_of(line: str) -> str:
    """A line of the text without its comment and the white space around it on the right."""
    found = CODE.match(line)
    return "" if found is None else found.group().rstrip()


def specifiers_without_comma(above: list[str], text: str, origin: TextOrigin) -> ParseError | None:
    """The error for an indented line of specifiers behind a line of an object that does not end with a comma; None for other lines."""
    number = next((i for i in range(len(above), 0, -1) if code_of(above[i - 1])), 0)
    found = re.match(rf"\s*(?P<comma>,\s*)?(?P<rest>{repairs.SPECIFIER_START}(?!\s*[=.,)\]]).*)", code_of(text))
    if not number or found is None or text.rstrip().endswith(":"):
        return None
    first = number
    while first > 1 and code_of(above[first - 2]).endswith(","):
        first -= 1
    statement = " ".join(code_of(line) for line in above[first - 1 : number])
    head = OBJECT.match(statement)
    if head is None or statement.endswith(";") or re.search(r"\b[A-Z_\d]{2,}$", head.group()):  # a constant, by its letters
        return None
    column = len(code_of(above[number - 1])) + 1
    if found["comma"]:
        place = origin.written(len(above) + 1, found.start("comma") + 1, len(above) + 1, found.start("comma") + 2)
        return ParseError("a line of specifiers does not begin with a comma", place, hint="move it to the end of the line before")
    if head.end() == len(statement) and not head["new"]:
        place = origin.written(len(above) + 1, found.start("rest") + 1, len(above) + 1, found.end("rest") + 1)
        return ParseError("the first specifier stands in the line of its class", place, hint="move it to the end of the line before")
    hint = "end each line of specifiers but the last with `,`"
    return ParseError("a comma is missing at the end of the line", origin.written(number, column, number, column + 1), hint=hint)


def no_block(above: list[str], text: str, span: Span) -> ParseError:
    """The error for `text`, a line that should be the first of a block and is not indented."""
    expected, hint = ("an indented block",), "indent the line, or write `pass`"
    number = next((i for i in range(len(above), 0, -1) if code_of(above[i - 1])), 0)
    head = code_of(above[number - 1]).strip() if number else ""
    if not head.endswith(":") or re.match(repairs.BLOCK_START, head) is None or not text.strip():
        return ParseError("expected an indented block", span, expected=expected, hint=hint)
    if head.startswith("class") and re.match(r"\s*[^\W\d]\w*\s*(?:\[[\w\s,]*\]\s*)?:|\s*def\b", text):
        hint = "indent the lines of the class"
    return ParseError(f"the block of `{head}` (line {number}) is not indented", span, expected=expected, hint=hint)


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
    stack = open_brackets(source, len(source) if ended else offset_of(source, line, column))
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
            found = specifier_inside(source, start)
            hint = f"add `{closing}`" if found is None else f"add `{closing}` before `, {found}`"
            return (opened, start - source.rfind("\n", 0, start)), message, hint
    return None


def offset_of(source: str, line: int, column: int) -> int:
    """The offset of a place in a text."""
    return max(0, sum(len(text) + 1 for text in source.split("\n")[: line - 1]) + column - 1)


def open_brackets(source: str, stop: int) -> list[tuple[str, int]]:
    """The brackets that are open at an offset, with the offsets where they stand, the innermost last."""
    stack: list[tuple[str, int]] = []
    for match in BRACKET_OR_TEXT.finditer(source, 0, stop):
        char = match.group()
        if char in PAIRS.values():
            stack.append((char, match.start()))
        elif char in PAIRS and stack:
            stack.pop()
    return stack


def specifier_inside(source: str, start: int) -> str | None:
    """The first word of a specifier behind a comma in the bracket at `start`, if it is one of the object outside: the bracket belongs before it."""
    before = code_of(source[source.rfind("\n", 0, start) + 1 : start])
    depth = 0
    for match in COMMA_OR_BRACKET.finditer(source, start):
        char = match.group()
        depth += (char[0] in PAIRS.values()) - (char[0] in PAIRS)
        if depth == 0 or char == "\n":
            return None
        if match["word"] and depth == 1:
            outside = re.search(rf"[\w)\]]\s+{repairs.SPECIFIER_START}", before) is not None
            inside = re.search(rf"\b{repairs.SPECIFIER_START}", source[start : match.start()]) is not None
            return match["word"] if outside and not inside else None
    return None


def inside_brackets(source: str, specifier: Span) -> ParseError | None:
    """The error for a specifier that stands inside brackets, and belongs to the object outside of them; None for others."""
    stack = open_brackets(source, offset_of(source, specifier.line, specifier.column)) if source else []
    word = specifier_inside(source, stack[-1][1]) if stack else None
    if word is None:
        return None
    start = stack[-1][1]
    line = source.count("\n", 0, start) + 1
    where = "" if line == specifier.line else f"line {line}, "
    message = f"a specifier stands inside the brackets that begin at {where}column {start - source.rfind(chr(10), 0, start)}"
    return ParseError(message, specifier, hint=f"close them before `, {word}`")


def is_closed(source: str, start: int) -> bool:
    """Return whether the bracket at `start` is closed further on, so that the mistake is another one."""
    depth = 0
    for match in BRACKET_OR_TEXT.finditer(source, start):
        char = match.group()
        depth += (char in PAIRS.values()) - (char in PAIRS)
        if depth == 0:
            return True
    return False
