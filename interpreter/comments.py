"""The comments of a source text, and where they stand among its lines of code: for `convert`, which prints a program anew.

A line of code is what ends at a line break that the layout does not drop: it may go over several lines of the file, and hold several statements.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from ..semantics.kernel.scopes import descendants
from ..semantics.syntax import Node, Program, Statement
from ..semantics.syntax.statements import PropertyDefault
from .dialects import DIALECTS, MARK, Dialect
from .indentation import TAB
from .joined_text import join_text
from .parser import normal, tables
from .tree_builder import TextOrigin

Place = tuple[int, int]
UNREACHED = 10**9
"""Deeper than any line is indented: of a block without lines of its own."""
LAYOUT = ("_NEWLINE", "_INDENT", "_DEDENT")


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment; `alone`: nothing else is in its line, which is indented by `width` columns."""

    place: Place
    text: str
    alone: bool
    width: int


@dataclass(frozen=True, slots=True)
class CodeLine:
    """A line of code, from its first character to behind its last one, indented by `width` columns."""

    start: Place
    end: Place
    width: int


class Comments:
    """The comments of a program, told one after the other, each once, while the lines of code that they belong to are printed in their order."""

    def __init__(self, program: Program) -> None:
        source = normal(program.text, TextOrigin(program.file))
        self.source = source.split("\n")[:-1]
        released = DIALECTS[program.dialect].released
        self.code = list(self.code_lines(source, DIALECTS[program.dialect]))
        self.pending = deque(self.comments(source, released))
        self.last = {self.code_at(place): place for place in sorted(map(place_of, parts_of(program)))}
        """Where the last statement (or property) of a line of code begins."""
        self.told = 0
        """The last line of the file that is printed, or whose comment is."""
        self.inner = 0
        """How deep the block is indented whose head was told last."""
        self.mark = ""
        """What the comment that names the dialect says besides."""
        mark = MARK.match(source)
        if mark is not None:
            self.pending.popleft()
            self.mark, self.told = self.source[0][mark.end() :].rstrip(), 1

    def code_lines(self, source: str, dialect: Dialect) -> Iterator[CodeLine]:
        """The lines of code, as the layout tells them."""
        first = last = None
        joined = join_text(source, apart=not dialect.intervals)
        for token in tables(dialect.released).parse_interactive(joined.text, start="program").iter_parse():
            if token.type not in LAYOUT:
                first, last = first or token, token
            elif token.type == "_NEWLINE" and first is not None and last is not None:
                start = joined.place(first.line or 0, first.column or 0)
                end = joined.place(last.end_line or 0, last.end_column or 0)
                yield CodeLine(start, end, self.width(start))
                first = None

    def comments(self, source: str, released: bool) -> Iterator[Comment]:
        """The comments: what looks like one and is in no string."""
        terminals = [tables(released).get_terminal(name).pattern.to_regexp() for name in ("STRING", "FSTRING", "COMMENT")]
        line, begins = 1, 0
        for found in re.finditer("|".join(terminals), source):
            line, begins = line + source.count("\n", begins, found.start()), source.rfind("\n", 0, found.start()) + 1
            if found.group().startswith("#"):
                place = (line, found.start() - begins + 1)
                yield Comment(place, found.group().rstrip(), not source[begins : found.start()].strip(), self.width(place))

    def width(self, place: Place) -> int:
        """By how many columns the text at a place is indented, if nothing is before it."""
        return len(self.source[place[0] - 1][: place[1] - 1].replace("\f", "").expandtabs(TAB))

    def code_at(self, place: Place) -> int:
        """The number of the line of code that a place is in."""
        return bisect_right(self.code, place, key=lambda code: code.start) - 1

    def next_code(self) -> int:
        """The number of the first line of code that is not printed."""
        return bisect_right(self.code, self.told, key=lambda code: code.start[0])

    def above(self, number: int) -> Iterator[str]:
        """The lines of comments and the empty lines above a line of code, and the comments inside of it."""
        code = self.code[number]
        yield from self.until(code.start[0])
        yield from (comment.text for comment in self.taken(code.end))
        self.told = max(self.told, code.end[0])

    def behind(self, number: int) -> str:
        """The comment behind a line of code."""
        return "".join("  " + comment.text for comment in self.taken((self.code[number].end[0] + 1, 0)))

    def until(self, line: int) -> Iterator[str]:
        """The lines of comments and the empty lines that stand before a line of the file."""
        for number in range(self.told + 1, line):
            if self.pending and self.pending[0].place[0] <= number:
                yield from (comment.text for comment in self.taken((number + 1, 0)))
            elif not self.source[number - 1].strip():
                yield ""
        self.told = max(self.told, line - 1)

    def taken(self, place: Place) -> Iterator[Comment]:
        """The comments before a place."""
        while self.pending and self.pending[0].place < place:
            yield self.pending.popleft()

    def head(self, text: str, first: Place | None) -> Iterator[str]:
        """The head of a block, whose first statement (if any) is at a place; `inner` is then how deep the block is indented.

        What is printed as a head may be none in the source, as the `setup:` of a scenario without blocks.
        """
        number = self.next_code()
        inside = len(self.code) if first is None else self.code_at(first)
        if number < inside or (number == inside < len(self.code) and self.code[inside].start != first):
            yield from self.above(number)
            following = self.code[number + 1].width if number + 1 < len(self.code) else 0
            self.inner = following if following > self.code[number].width else UNREACHED
            yield text + (self.behind(number) if number < inside else "")
        else:
            self.inner = self.code[inside].width if inside < len(self.code) and self.code[inside].start == first else UNREACHED
            yield text

    def ending(self, width: int) -> Iterator[str]:
        """The comments at the end of a block that is indented by so many columns."""
        following = self.next_code()
        limit = self.code[following].start[0] if following < len(self.code) else len(self.source) + 1
        last = 0
        for comment in self.pending:
            if comment.place[0] >= limit or not comment.alone or comment.width < width:
                break
            last = comment.place[0]
        if last:
            yield from self.until(last + 1)

    def trailing(self) -> Iterator[str]:
        """What is left at the end of the file."""
        yield from self.until(len(self.source) + 1)


def parts_of(program: Program) -> Iterator[Node]:
    """The statements and properties of a program."""
    for statement in program.statements:
        yield from (node for node in descendants(statement) if isinstance(node, Statement | PropertyDefault))


def place_of(node: Node) -> Place:
    """Where a node begins."""
    return (node.span.line, node.span.column)
