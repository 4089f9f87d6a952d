"""The subject at a place of a text: a name with its meaning, a property, or a word of the language."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from typing import NamedTuple

from .name_scopes import Inherited, Meaning, NameFinder, around
from .outline import EVERYTHING, Definition, outline
from .tokens import CLOSING, OPENING, Line, Phrase, TextPiece, lines, phrase_at, piece_at

PARAMETERS = "globalParameters"


class Subject(NamedTuple):
    """A piece of a text: what its name means, or of which classes it is a property, and the phrase of the language that it is part of."""

    piece: TextPiece
    meaning: Meaning | None = None
    inherited: tuple[Inherited, ...] = ()
    property: bool = False
    phrase: Phrase | None = None


def subject_at(finder: NameFinder, offset: int) -> Subject | None:
    """Return the subject at an index of the text; None in comments, texts and between words."""
    text = finder.main.text
    piece = piece_at(text, offset)
    line = None if piece is None or piece.kind != "name" else line_at(text, piece.start)
    if piece is None or line is None:
        return None
    number = line.pieces.index(piece)
    names = finder.visible(piece.start)
    for asked in (in_import, behind_dot, behind_with, keyword_argument, own_definition):
        found = asked(finder, line, number, names)
        if found is not None:
            return found
    phrase = phrase_at(text, piece)
    meaning = names.get(piece.text)
    if meaning is not None and (phrase is None or meaning.module == finder.main):
        return Subject(piece, meaning)
    return Subject(piece, phrase=phrase)


def line_at(text: str, offset: int) -> Line | None:
    """The statement that an index is in."""
    found = lines(text)
    number = bisect_right(found, offset, key=lambda line: line.pieces[0].start) - 1
    return found[number] if number >= 0 and offset < found[number].pieces[-1].end else None


def in_import(finder: NameFinder, line: Line, number: int, names: Mapping[str, Meaning]) -> Subject | None:
    """A module, or a name of one, in the statement that imports it."""
    words, piece = line.words, line.pieces[number]
    if words[0] not in ("import", "from", "model") or number == 0:
        return None
    if phrase_at(finder.main.text, piece) is not None:
        return None
    dotted, level = dotted_name(line, number)
    if words[0] == "from" and "import" in words[:number]:
        one = next((d for d in imported_by(finder, line) if d.start == piece.start or d.member == piece.text), None)
        return Subject(piece, None if one is None else finder.imported(one, finder.main, frozenset()))
    source = finder.shelf.find(dotted, level, finder.main)
    return Subject(piece, None if source is None else Meaning(source, whole=True))


def imported_by(finder: NameFinder, line: Line) -> list[Definition]:
    """The definitions of an import statement."""
    scope = list(around(finder.main.outline, line.pieces[0].start))[-1]
    return [d for d in scope.children if d.kind == "import" and d.first == line.pieces[0].start and d.member != EVERYTHING]


def dotted_name(line: Line, number: int) -> tuple[str, int]:
    """The dotted name that goes on around a word, up to its end, and the dots before it."""
    words = line.words
    start = stop = number
    while start > 0 and (words[start - 1] == "." or (words[start] == "." and line.pieces[start - 1].kind == "name" and words[start - 1] != "from")):
        start -= 1
    while stop + 2 < len(words) and words[stop + 1] == "." and line.pieces[stop + 2].kind == "name":
        stop += 2
    source = "".join(words[start : stop + 1])
    name = source.lstrip(".")
    return name, len(source) - len(name)


def behind_dot(finder: NameFinder, line: Line, number: int, names: Mapping[str, Meaning]) -> Subject | None:
    """A name of a module, a global parameter, a property or method."""
    words, piece = line.words, line.pieces[number]
    if number < 2 or words[number - 1] != ".":
        return None
    receiver = words[number - 2]
    if receiver == PARAMETERS:
        return Subject(piece, param(finder, piece.text))
    start = number - 2
    while start > 1 and words[start - 1] == ".":
        start -= 2
    module = module_named(finder, "".join(words[start : number - 1]), names)
    if module is not None:
        return Subject(piece, finder.members(module).get(piece.text))
    class_ = finder.class_of(receiver, piece.start, names) if start == number - 2 else None
    return property_subject(finder, piece, class_, names)


def module_named(finder: NameFinder, dotted: str, names: Mapping[str, Meaning]) -> Meaning | None:
    """The module that a name stands for, or a dotted name that is imported as such."""
    meaning = names.get(dotted)
    if meaning is not None and meaning.whole:
        return meaning
    one = next((d for d in finder.main.outline.children if d.kind == "import" and d.module == dotted and not d.member and "." in dotted), None)
    return None if one is None else finder.imported(one, finder.main, frozenset())


def param(finder: NameFinder, name: str) -> Meaning | None:
    """A global parameter of the program."""
    one = next((d for d in finder.main.outline.children if d.kind == "param" and d.name == name), None)
    return None if one is None else Meaning(finder.main, one)


def behind_with(finder: NameFinder, line: Line, number: int, names: Mapping[str, Meaning]) -> Subject | None:
    """The property of `with property E`."""
    if number < 2 or line.words[number - 1] != "with":
        return None
    return property_subject(finder, line.pieces[number], class_built(finder, line, number, names), names)


def class_built(finder: NameFinder, line: Line, number: int, names: Mapping[str, Meaning]) -> str | None:
    """The class of the object whose specifiers stand before a piece, in the same brackets: the first class that is named there."""
    inside = same_brackets(line, number)
    return next((p.text for p in inside if p.kind == "name" and finder.is_class(p.text, names)), None)


def same_brackets(line: Line, number: int) -> list[TextPiece]:
    """The pieces before one in the innermost brackets around it, without what stands in brackets of its own."""
    found: list[TextPiece] = []
    depth = 0
    for piece in reversed(line.pieces[:number]):
        depth += (piece.text in CLOSING) - (piece.text in OPENING)
        if depth < 0:
            break
        if depth == 0 and piece.text not in OPENING:
            found.append(piece)
    return found[::-1]


def property_subject(finder: NameFinder, piece: TextPiece, class_: str | None, names: Mapping[str, Meaning]) -> Subject:
    """A property by its name: of the class, if it is known, else of any class that the text can name."""
    classes = [class_] if class_ is not None else ["Object", *(name for name in names if finder.is_class(name, names))]
    found = (one for name in classes for one in finder.properties(name, names) if one.name == piece.text)
    return Subject(piece, inherited=tuple(dict.fromkeys(found)) if class_ is None else tuple(found)[:1], property=True)


def keyword_argument(finder: NameFinder, line: Line, number: int, names: Mapping[str, Meaning]) -> Subject | None:
    """The name of a parameter in a call, `f(speed=3)`."""
    words = line.words
    if words[number + 1 : number + 2] != ("=",):
        return None
    depth = 0
    for at in range(number - 1, -1, -1):
        depth += (words[at] in CLOSING) - (words[at] in OPENING)
        if depth < 0:
            called = names.get(words[at - 1]) if at and words[at] == "(" else None
            inside = [] if called is None or called.definition is None else called.definition.children
            one = next((d for d in inside if d.kind == "parameter" and d.name == words[number]), None)
            return None if one is None or called is None else Subject(line.pieces[number], Meaning(called.module, one))
    return None


def own_definition(finder: NameFinder, line: Line, number: int, names: Mapping[str, Meaning]) -> Subject | None:
    """The name in its own definition."""
    piece = line.pieces[number]
    scope = list(around(outline(finder.main.text), piece.start))
    one = next((d for s in reversed(scope) for d in (*s.children, s) if d.start == piece.start and d.kind != "import" and d.name), None)
    if one is None:
        return None
    if one.kind == "property":
        return Subject(piece, inherited=(Inherited(one.name, Meaning(finder.main, one), scope[-1].name),), property=True)
    return Subject(piece, Meaning(finder.main, one))
