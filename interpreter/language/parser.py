"""From text to abstract syntax: `parse`."""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Literal

import lark
from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedInput
from lark.grammar import Rule
from lark.lexer import TerminalDef

from ...semantics.store.errors import ParseError
from ...semantics.syntax import Expression, Program, Span
from ...semantics.syntax.python_expressions import Constant, FormattedValue, FString
from ..runtime.cache_folders import cache_folder, read_kept, write_kept
from ..runtime.process_sandbox import limit_time
from . import dialects, literals, syntax_errors
from .dialects import Dialect
from .indentation import Layout
from .logical_lines import join_text
from .nesting import check_nesting
from .node_builders import DynamicsBuilder, ExpressionBuilder, ScenicBuilder, StatementBuilder
from .tree_builder import Parts, TextOrigin

Start = Literal["program", "interpolation"]
INTERPOLATION_LIMIT = 4
LARGEST_TABLES = 1 << 24
"""Bytes of the file that keeps the parser's tables; they take one million."""


def parse(text: str, file: str = "<string>", dialect: str | None = None) -> Program:
    """The program that `text` is, written in `dialect` (or in the one that its first line names, or in the paper's).

    Every node's span names `file`. Raises ParseError if the text is not a program, UsageError for an unknown dialect.
    """
    chosen = dialects.choose(text, dialect)
    tables(chosen.released)  # outside of the clock
    return parse_within(text, file, chosen)


@limit_time("parsing")
def parse_within(text: str, file: str, dialect: Dialect) -> Program:
    """As `parse`, in the time that the program has."""
    origin = TextOrigin(file)
    source = normal(text, origin)
    origin = replace(origin, source=source, joined=join_text(source, apart=not dialect.intervals))  # there, `import` brings names
    tree = parse_tree(source, "program", origin, dialect)
    statements = TreeBuilder(origin, dialect).build(tree)
    check_nesting(statements)
    return Program(statements=statements, file=file, text=text, dialect=dialect.name)


def normal(text: str, origin: TextOrigin) -> str:
    """`text` with `\\n` as the only line break, ending in one, and without a byte order mark. Raises ParseError for NUL."""
    source = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    place = source.find("\0")
    if place >= 0:
        line, start = source.count("\n", 0, place) + 1, source.rfind("\n", 0, place)
        raise ParseError("the text contains a NUL character", origin.span(line, place - start, line, place - start + 1))
    return source if source.endswith("\n") else source + "\n"


def parse_tree(source: str, start: Start, origin: TextOrigin, dialect: Dialect) -> Tree[Token]:
    """Lark's tree of `source`, which `origin` has joined. Raises ParseError, with its place in the file."""
    try:
        return tables(dialect.released).parse(origin.joined.text, start=start)
    except UnexpectedInput as fault:
        raise syntax_errors.explain(fault, source, origin, released=dialect.released) from None
    except ParseError as fault:  # from the post-lexer
        raise ParseError(fault.message, origin.move(fault.span), hint=fault.hint) from None


@cache
def tables(released: bool) -> Lark:
    """The parser's tables, built once per process or loaded from the user's cache directory, with the layout of the releases or without."""
    grammar = files("scenic_ref.interpreter.language").joinpath("grammar.lark").read_text("utf-8")
    key = hashlib.blake2b(f"{lark.__version__} {sys.version_info[:2]} {grammar}".encode()).hexdigest()
    layout, place = Layout(released), cache_file()
    kept = None if place is None else tables_in(place, key, layout)
    if kept is not None:
        return kept
    made = Lark(
        grammar, parser="lalr", lexer="contextual", start=["program", "interpolation"], propagate_positions=True, maybe_placeholders=True,
        postlex=layout,
    )  # fmt: skip
    if place is not None:
        data, memo = made.memo_serialize([TerminalDef, Rule])
        data["options"] = {name: value for name, value in data["options"].items() if name != "postlex"}
        write_kept(place, json.dumps({"key": key, "data": data, "memo": memo}).encode())
    return made


def tables_in(place: Path, key: str, layout: Layout) -> Lark | None:
    """The tables that a file keeps, as JSON, which holds nothing that could be run; None if they are damaged, or made of another grammar."""
    written = read_kept(place, LARGEST_TABLES)
    if written is None:
        return None
    try:
        kept = json.loads(bytes(written), object_hook=with_numbers)
        if kept["key"] != key:
            return None
        kept["data"]["options"]["postlex"] = layout
        return Lark.load(kept)
    except MemoryError:
        raise
    except Exception:  # whoever wrote the file may have written anything
        return None


def with_numbers(entries: dict[str, object]) -> dict[str | int, object]:
    """The entries, with those keys as numbers that JSON has made texts."""
    return {int(key) if key.isdecimal() else key: value for key, value in entries.items()}


def cache_file() -> Path | None:
    """The file that keeps the tables between processes, or None where none can be written."""
    folder = cache_folder()
    return None if folder is None else folder / "grammar.tables"


class TreeBuilder(ExpressionBuilder, ScenicBuilder, StatementBuilder, DynamicsBuilder):
    """The whole builder; strings are here because an f-string parses its interpolations."""

    def __init__(self, origin: TextOrigin, dialect: Dialect, interpolated: int = 0) -> None:
        super().__init__(origin, dialect)
        self.interpolated = interpolated

    def make_strings(self, span: Span, parts: Parts) -> Expression:
        """Adjacent literals as one: a constant, or an f-string if any of them is one."""
        pieces: list[str | bytes | FormattedValue] = []
        for token in parts:
            pieces.extend(self.string_pieces(token))
        if any(token.type == "FSTRING" for token in parts):
            if any(isinstance(piece, bytes) for piece in pieces):
                raise ParseError("bytes and text cannot be joined", span)
            return FString(span=span, parts=_join_texts(pieces))
        text = [piece for piece in pieces if isinstance(piece, str)]
        binary = [piece for piece in pieces if isinstance(piece, bytes)]
        if text and binary:
            raise ParseError("bytes and text cannot be joined", span)
        return Constant(span=span, value=b"".join(binary) if binary else "".join(text))

    def string_pieces(self, token: Token) -> list[str | bytes | FormattedValue]:
        """Return the pieces that one literal contributes."""
        try:
            if token.type == "STRING":
                return [literals.string(str(token))]
            return [*self.formatted(literals.f_string(str(token)), token)]
        except literals.LiteralFault as fault:
            raise ParseError(fault.message, self.token_span(token)) from None

    def formatted(self, pieces: tuple[literals.Piece, ...], token: Token) -> list[str | FormattedValue]:
        """Pieces of the f-string `token` with their interpolations parsed."""
        return [piece if isinstance(piece, str) else self.formatted_value(piece, token) for piece in pieces]

    def formatted_value(self, piece: literals.Replacement, token: Token) -> FormattedValue:
        """`{...}` of the f-string `token`, its expression parsed where it stands in the file."""
        if self.interpolated >= INTERPOLATION_LIMIT:
            raise ParseError("f-strings are nested too deeply", self.token_span(token))
        line, column = (token.line or 1), (token.column or 1)
        before = str(token)[: piece.offset]
        breaks = before.count("\n")
        column = len(before) - before.rfind("\n") if breaks else column + piece.offset
        start = self.origin.span(line + breaks, column, line + breaks, column)
        source = f"({piece.expression})"
        joined = join_text(source, apart=False, names=self.origin.joined.names)
        origin = TextOrigin(self.origin.file, start.line - 1, start.column - 2, joined)  # the added "(" has column 1
        builder = TreeBuilder(origin, self.dialect, self.interpolated + 1)
        value = builder.build(parse_tree(source, "interpolation", origin, self.dialect))
        layout = None
        if piece.format is not None:
            layout = FString(span=self.token_span(token), parts=tuple(self.formatted(piece.format, token)))
        return FormattedValue(span=value.span, value=value, conversion=piece.conversion, format=layout)  # pyright: ignore[reportArgumentType]


def _join_texts(pieces: list[str | bytes | FormattedValue]) -> tuple[str | FormattedValue, ...]:
    """The pieces with neighbouring texts joined and empty ones left out."""
    parts: list[str | FormattedValue] = []
    for piece in pieces:
        if isinstance(piece, FormattedValue):
            parts.append(piece)
        elif isinstance(piece, str) and piece:
            if parts and isinstance(parts[-1], str):
                parts[-1] += piece
            else:
                parts.append(piece)
    return tuple(parts)
