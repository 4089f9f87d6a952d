"""The outline of a text, whether or not it is a program at the moment: classes, functions, behaviors, names,
with their places.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from .tokens import CLOSING, OPENING, Line, TextPiece, lines

OPENERS = {"class": "class", "constructor": "class", "def": "function", "behavior": "behavior", "monitor": "monitor", "scenario": "scenario"}
"""The first words of definitions, and what they define."""
AUGMENTED = "+-*/%&|^<>@!"
EVERYTHING = "*"


@dataclass(slots=True)
class Definition:
    """A name that a text defines, at `start` to `end`; what defines it reaches from `first` to `last`.

    `kind` is class, function, behavior, monitor, scenario, variable, parameter, property, param (a global parameter) or import. `made`
    is the class of what a variable is assigned, or a class is derived from. Of imports, `module` with `level` dots before it is the module, and
    `member` the name in it, \"*\" for all of them.
    """

    name: str
    kind: str
    start: int
    end: int
    first: int
    last: int
    made: tuple[str, ...] = ()
    module: str = ""
    level: int = 0
    member: str = ""
    children: list[Definition] = field(default_factory=list["Definition"])

    def holds(self, offset: int) -> bool:
        """Whether an index is in what defines the name."""
        return self.first <= offset <= self.last


@lru_cache(maxsize=64)
def outline(text: str) -> Definition:
    """The text as a definition without a name, which has all others below it."""
    root = Definition("", "module", 0, 0, 0, len(text))
    open_ = [(-1, root)]
    for line in lines(text):
        while line.indent <= open_[-1][0]:
            open_.pop()[1].last = line.pieces[0].start - 1
        home = open_[-1][1]
        found = list(definitions(line, home.kind))
        home.children += found
        if line.pieces[0].text in OPENERS and found:
            found[0].last = len(text)
            open_.append((line.indent, found[0]))
    return root


def definitions(line: Line, home: str) -> Iterator[Definition]:
    """Yield the definitions of a statement, in a text or in a definition of the kind `home`."""
    pieces = line.pieces
    words = list(line.words)
    if words[0] in OPENERS and len(words) > 1 and pieces[1].kind == "name":
        yield definition_of(line)
    elif words[0] == "import":
        yield from imports(line)
    elif words[0] == "from" and "import" in words:
        yield from imports_from(line)
    elif words[0] == "model" and len(words) > 1 and pieces[1].kind == "name":
        yield piece_definition(pieces[1], "import", line, module="".join(words[1:]), member=EVERYTHING)
    elif words[0] == "param":
        yield from (piece_definition(p, "param", line) for p, after in zip(pieces[1:], words[2:]) if after == "=" and p.kind in ("name", "string"))
    elif words[0] == "for":
        stop = words.index("in") if "in" in words else len(words)
        yield from (piece_definition(piece, "variable", line) for piece in pieces[1:stop] if piece.kind == "name")
    elif words[0] == "except" and "as" in words[:-2]:
        yield piece_definition(pieces[words.index("as") + 1], "variable", line)
    elif home == "class" and is_property(pieces):
        yield piece_definition(pieces[0], "property", line, made=constructed_class(pieces[words.index(":") + 1 :]))
    else:
        yield from assignments(line)


def piece_definition(
    piece: TextPiece, kind: str, line: Line, *, made: tuple[str, ...] = (), module: str = "", level: int = 0, member: str = ""
) -> Definition:
    """A definition by one piece of a statement."""
    name = piece.text.strip("\"'") if piece.kind == "string" else piece.text
    return Definition(name, kind, piece.start, piece.end, line.pieces[0].start, line.pieces[-1].end, made, module, level, member)


def definition_of(line: Line) -> Definition:
    """A class with the classes that it is derived from, or a function, behavior, monitor or scenario with its parameters."""
    kind = OPENERS[line.words[0]]
    inside = list(parameters(line.pieces[2:]))
    found = piece_definition(line.pieces[1], kind, line, made=tuple(p.text for p in inside) if kind == "class" else ())
    if kind != "class":
        found.children = [piece_definition(piece, "parameter", Line((piece,), line.indent)) for piece in inside]
    return found


def parameters(pieces: Sequence[TextPiece]) -> Iterator[TextPiece]:
    """The names that stand first between the commas of the brackets."""
    depth, expected = 0, False
    for piece in pieces:
        depth += (piece.text in OPENING) - (piece.text in CLOSING)
        if depth <= 0:
            return
        if depth == 1 and piece.text in ("(", ","):
            expected = True
        elif expected and piece.text not in ("*", "**"):
            if piece.kind == "name":
                yield piece
            expected = False


def imports(line: Line) -> Iterator[Definition]:
    """`import a.b as c, d`."""
    for part in split_at_commas(line.pieces[1:]):
        words = [piece.text for piece in part]
        if not part or part[0].kind != "name":
            continue
        stop = words.index("as") if "as" in words else len(words)
        alias = part[stop + 1] if stop + 1 < len(part) else part[0]
        yield piece_definition(alias, "import", line, module="".join(words[:stop]))


def imports_from(line: Line) -> Iterator[Definition]:
    """`from .a.b import c as d, e`, `from a import *`."""
    words = line.words
    place = words.index("import")
    source = "".join(words[1:place])
    module = source.lstrip(".")
    level = len(source) - len(module)
    for part in split_at_commas([piece for piece in line.pieces[place + 1 :] if piece.text not in "()"]):
        if part and (part[0].kind == "name" or part[0].text == EVERYTHING):
            alias = part[2] if len(part) > 2 and part[1].text == "as" else part[0]
            yield piece_definition(alias, "import", line, module=module, level=level, member=part[0].text)


def split_at_commas(pieces: Sequence[TextPiece]) -> Iterator[list[TextPiece]]:
    """The parts between commas."""
    current: list[TextPiece] = []
    for piece in pieces:
        if piece.text == ",":
            yield current
            current = []
        else:
            current.append(piece)
    yield current


def is_property(pieces: Sequence[TextPiece]) -> bool:
    """Whether a statement in a class is `name: default`, or `name[additive]: default`."""
    words = [piece.text for piece in pieces]
    return pieces[0].kind == "name" and (words[1:2] == [":"] or (words[1:2] == ["["] and "]" in words and words[words.index("]") + 1 :][:1] == [":"]))


def assignments(line: Line) -> Iterator[Definition]:
    """The names that stand before the `=` of an assignment, or before a colon and an `=`."""
    depth, start = 0, 0
    targets: list[TextPiece] = []
    pieces = line.pieces
    for number, piece in enumerate(pieces):
        depth += (piece.text in OPENING) - (piece.text in CLOSING)
        if piece.text == "=" and depth == 0:
            if number and pieces[number - 1].text in AUGMENTED and pieces[number - 1].end == piece.start:
                return
            targets += target_names(pieces[start:number])
            start = number + 1
    value = constructed_class(pieces[start:]) if targets else ()
    for piece in targets:
        yield piece_definition(piece, "variable", line, made=value)


def target_names(pieces: Sequence[TextPiece]) -> Iterator[TextPiece]:
    """The variables among what stands before a `=`: none in subscripts and calls, behind a dot, or before one; words in a row are no targets."""
    annotated = next((number for number, piece in enumerate(pieces) if piece.text == ":"), len(pieces))
    before, inside = "", 0
    found: list[TextPiece] = []
    for number, piece in enumerate(pieces[:annotated]):
        after = pieces[number + 1].text if number + 1 < len(pieces) else ""
        opened = piece.text in OPENING and (inside > 0 or before.isidentifier() or (before in CLOSING and before != ""))
        inside += opened - (piece.text in CLOSING and inside > 0)
        if piece.kind != "mark" and before.isidentifier():
            return
        if piece.kind == "name" and not inside and before != "." and after not in (".", "[", "("):
            found.append(piece)
        before = piece.text
    yield from found


def constructed_class(pieces: Sequence[TextPiece]) -> tuple[str, ...]:
    """The class of an object that an expression makes, as far as its first words tell: `Car at ...`, `new lib.Car`."""
    start = 1 if pieces and pieces[0].text == "new" else 0
    while start + 2 < len(pieces) and pieces[start + 1].text == ".":
        start += 2
    words = [piece.text for piece in pieces[start : start + 2]]
    is_class = bool(words) and words[0][:1].isupper() and words[1:] != ["("]
    return (words[0],) if is_class else ()
