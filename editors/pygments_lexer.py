"""Programs in colours: a lexer for Pygments, which finds it by the name `scenic` and by `*.scenic`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups
from pygments.token import STANDARD_TYPES, Comment, Keyword, Name, Number, Operator, Punctuation, String, Text, Whitespace, _TokenType

from ..interpreter.language.keywords import keywords, pattern
from ..semantics.python.builtins import BUILTINS
from ..semantics.store.built_in_classes import BUILT_IN_CLASSES

TOKENS: Mapping[str, object] = {
    "keyword": Keyword, "statement": Keyword, "constant": Keyword.Constant, "specifier": Keyword.Declaration, "operator": Operator.Word,
}
"""What the kinds of words are to Pygments."""


PARTS: Sequence[tuple[str, Sequence[_TokenType]]] = (
    (r"(def|behavior|monitor|scenario)([ \t]+)([^\W\d]\w*)(?=[ \t]*[(:])", (Keyword, Whitespace, Name.Function)),
    (r"(class)([ \t]+)([^\W\d]\w*)", (Keyword, Whitespace, Name.Class)),
    (r"(with)([ \t]+)([^\W\d]\w*)(?=[ \t]+[^\s=,)])", (Keyword.Declaration, Whitespace, Name.Attribute)),
    (r"(\.)([^\W\d]\w*)", (Operator, Name.Attribute)),
)
"""Patterns whose groups are of kinds of their own."""


class ScenicLexer(RegexLexer):
    """Scenic programs in any of the dialects; its words are those of the grammar."""

    name = "Scenic"
    url = "https://scenic-lang.org"
    aliases: ClassVar[Sequence[str]] = ["scenic"]
    filenames: ClassVar[Sequence[str]] = ["*.scenic"]
    mimetypes: ClassVar[Sequence[str]] = ["text/x-scenic"]
    flags = re.MULTILINE

    tokens: ClassVar[dict[str, list[object]]] = {
        "root": [
            (r"\n", Whitespace),
            (r"[ \t\f]+", Whitespace),
            (pattern("COMMENT"), Comment.Single),
            (pattern("FSTRING"), String.Interpol),
            (pattern("STRING"), String),
            *((parts, bygroups(*kinds)) for parts, kinds in PARTS),
            *((word.pattern, TOKENS[word.kind]) for word in keywords()),
            (r"(?:ego|self|workspace)\b", Name.Builtin.Pseudo),
            (rf"(?:{'|'.join(BUILT_IN_CLASSES)})\b", Name.Class),
            (rf"(?:{'|'.join(sorted(sorted(BUILTINS), key=len, reverse=True))})\b", Name.Builtin),
            (pattern("NUMBER"), Number),
            (r"[^\W\d]\w*", Name),
            (r"[-+*/%@&|^~<>=!]+", Operator),
            (r"[()\[\]{},:;.\\]", Punctuation),
            (r".", Text),
        ]
    }


def rules_for_browsers() -> list[list[object]]:
    """The lexer for JavaScript: patterns, the first that matches first, each with the class of what it matches, or with those of its groups.

    The classes are those of Pygments' pages, "" for what has no colour.
    """
    found: list[list[object]] = []
    parts = {pattern: [STANDARD_TYPES[kind] for kind in kinds] for pattern, kinds in PARTS}
    for rule in ScenicLexer.tokens["root"]:
        assert isinstance(rule, tuple)
        kinds = parts.get(rule[0]) or STANDARD_TYPES[rule[1]]
        found.append([in_javascript(rule[0]), kinds])
    return found


def in_javascript(regex: str) -> str:
    """A pattern of the grammar as JavaScript has it, for its flag u: letters and digits are those of all writing."""
    found, inside, place = [], False, 0
    while place < len(regex):
        step = 2 if regex[place] == "\\" else 1
        piece = regex[place : place + step]
        if not inside and regex.startswith(r"[^\W\d]", place):
            piece, step = r"[\p{L}_]", len(r"[^\W\d]")
        elif piece == r"\w":
            piece = r"\p{L}\p{N}_" if inside else r"[\p{L}\p{N}_]"
        elif piece in ("[", "]"):
            inside = piece == "["
        found.append(piece)
        place += step
    return "".join(found)
