"""Completion in a text that is not yet a program: specifiers, properties, names, modules, words."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import NamedTuple

from ..interpreter.language.dialects import DIALECTS, MARK
from ..interpreter.language.keywords import LanguageWord, keywords
from ..semantics.machine.values import Constructor
from ..semantics.python.builtins import BUILTINS
from ..semantics.store.built_in_classes import BUILT_IN_CLASSES
from ..semantics.store.scenic_classes import ScenicClass
from .name_scopes import Meaning, NameFinder, around, definition_line
from .place_meanings import PARAMETERS, class_built, module_named, param, same_brackets
from .tokens import Line, TextPiece, lines, phrase_at, piece_at
from .word_meanings import about_built_in_property, about_word, signature

SPECIFIERS = (
    "at", "in", "on", "offset by", "offset along", "left of", "right of", "ahead of", "behind", "beyond", "visible", "visible from", "following",
    "facing", "facing toward", "facing away from", "apparently facing", "with",
)  # fmt: skip
RELEASED_SPECIFIERS = ("contained in", "not visible", "not visible from")
PREFIXES = (
    "relative heading of", "apparent heading of", "distance to", "distance from", "angle to", "angle from", "follow", "visible", "front of",
    "back of", "left of", "right of", "front left of", "front right of", "back left of", "back right of", "distance past", "not",
    "lambda", "True", "False", "None",
)  # fmt: skip
RELEASED_PREFIXES = ("new", "relative position of", "not visible", "initial scenario")
INFIXES = (
    "at", "offset by", "offset along", "relative to", "can see", "visible from", "deg", "seconds", "by", "from", "to", "for", "in", "not in", "is",
    "is not", "and", "or", "if", "else", "as", "until", "steps", "past", "of", "in initial scenario",
)  # fmt: skip
RELEASED_INFIXES = ("intersects", "not visible from", "every", "after")
PYTHON = ("if", "for", "while", "try", "def", "assert", "raise", "del", "pass")
CLAUSES = ("elif", "else", "except", "finally", "break", "continue")
DECLARATIONS = (
    "class", "import", "from", "model", "param", "require", "require always", "require eventually", "terminate when", "mutate", "behavior", "monitor",
    "scenario",
)  # fmt: skip
RELEASED_DECLARATIONS = (
    "require monitor", "terminate simulation when", "terminate after", "record", "record initial", "record final", "simulator", "mutate by",
)  # fmt: skip
DYNAMIC = ("take", "wait", "terminate", "do", "do choose", "do shuffle", "interrupt when", "abort", "return")
RELEASED_DYNAMIC = ("wait for", "wait until", "terminate simulation")
STATEMENTS: Mapping[str, tuple[str, ...]] = {
    "module": (*DECLARATIONS, *PYTHON, *CLAUSES),
    "class": ("def", "pass"),
    "function": ("return", "global", "nonlocal", *PYTHON, *CLAUSES),
    "behavior": ("precondition", "invariant", *DYNAMIC, *PYTHON, *CLAUSES),
    "monitor": (*DYNAMIC, *PYTHON, *CLAUSES, "require"),
    "scenario": ("precondition", "invariant", "setup", "compose", "override", *DECLARATIONS, *DYNAMIC, *PYTHON, *CLAUSES),
}
"""The first words of statements, by the kind of definition that they stand in."""
RELEASED_STATEMENTS: Mapping[str, tuple[str, ...]] = {
    "module": RELEASED_DECLARATIONS, "behavior": RELEASED_DYNAMIC, "monitor": RELEASED_DYNAMIC,
    "scenario": (*RELEASED_DECLARATIONS, *RELEASED_DYNAMIC),
}  # fmt: skip
POSTFIXES = frozenset({"DEG", "SECONDS", "STEPS", "VISIBLE_LONE", "NOT_VISIBLE_LONE", "TRUE", "FALSE", "NONE", "INITIAL_SCENARIO", "PASS"})
"""Words behind which an expression is complete."""
BEHIND = (" x", " x:", ":", "", " x = 1", " from x")
"""What may follow, since the patterns of some words look at it."""


@cache
def word_of(phrase: str, kinds: tuple[str, ...] = ("specifier", "operator", "statement", "keyword", "constant")) -> LanguageWord | None:
    """The terminal of the grammar that a phrase is, of one of these kinds rather than of others."""
    found = [
        word for behind in BEHIND for word in keywords()
        if (match := re.compile(word.pattern).match(phrase + behind)) is not None and match.end() == len(phrase)
    ]  # fmt: skip
    if not found and " " in phrase:
        return word_of(phrase.rpartition(" ")[0], kinds)  # `distance to`: the terminal is the first word
    return next((word for word in found if word.kind in kinds), found[0] if found else None)


HOLE = "_"
"""The word that stands for what is not written yet."""
LOOKED_AT = 4000
"""Characters before a place, from the beginning of a line that is not indented, that tell what can stand there."""
PREFIX = re.compile(r"(?:[^\W\d]\w*)?$")
DOTTED = re.compile(r"[\w.]*$")


class Completion(NamedTuple):
    """A text that can replace what stands from `start` on; `kind` is class, distribution, function, property, variable, module, keyword, ..."""

    label: str
    kind: str
    start: int
    detail: str = ""
    markdown: str = ""


class CompletedPlace(NamedTuple):
    """A place to complete: the statement up to it, which ends with a hole, the names there, and where the word began."""

    finder: NameFinder
    line: Line
    names: Mapping[str, Meaning]
    start: int
    prefix: str
    written: str

    @property
    def words(self) -> tuple[str, ...]:
        """The words of the statement before the place."""
        return self.line.words[:-1]

    @property
    def released(self) -> bool:
        """Whether the text is in a dialect of the released implementations."""
        mark = MARK.match(self.finder.main.text)
        return mark is not None and mark.group(1) in DIALECTS and DIALECTS[mark.group(1)].released


def suggestions(finder: NameFinder, offset: int, *, unasked: bool = False) -> list[Completion]:
    """Return the completions at an index of the text, each once; none in comments and texts. With `unasked`,
    return only likely ones.
    """
    text = finder.main.text
    inside = piece_at(text, offset)
    if inside is not None and inside.start < offset and is_dumb(inside, offset):
        return []
    prefix = PREFIX.search(text[max(0, offset - 200) : offset])
    start = offset - len(prefix[0] if prefix is not None else "")
    before = text[statement_start_before(text, start) : start]
    written = before + HOLE
    place = CompletedPlace(finder, lines(written)[-1], finder.visible(start), start, text[start:offset], written)
    found: dict[str, Completion] = {}
    for one in (*begun_phrases(place), *possible_completions(place)):
        found.setdefault(one.label, one)
    likely = place.words[:1] in (("import",), ("from",), ("model",))
    return [one for one in found.values() if not unasked or likely or (one.kind == "property" and place.words) or one.detail == "specifier"]


def is_dumb(piece: TextPiece, offset: int) -> bool:
    """Whether nothing is suggested at an index of a piece: in comments, texts and numbers."""
    return piece.kind in ("comment", "number") or (piece.kind == "string" and not is_string_closed(piece, offset))


def is_string_closed(string: TextPiece, offset: int) -> bool:
    """Whether an index is behind the end of a text, rather than in one that nobody closed yet."""
    body = string.text.lstrip("rRbBuUfF")
    return offset == string.end and len(body) > 1 and body[-1] == body[0] and not (body.startswith(body[0] * 3) and len(body) < 6)


def statement_start_before(text: str, offset: int) -> int:
    """The beginning of a line that is not indented, some way before an index."""
    if offset <= LOOKED_AT:
        return 0
    found = [match.end() for match in re.finditer(r"[\r\n](?=[^\s)\]}#])", text[: offset - LOOKED_AT])]
    return found[-1] if found else 0


def begun_phrases(place: CompletedPlace) -> Iterator[Completion]:
    """Phrases of which the first words are written already."""
    for phrase in every_phrase(place.released):
        words = tuple(phrase.split(" "))
        for count in range(1, len(words)):
            if place.words[-count:] == words[:count] and words[count].startswith(place.prefix):
                length = len(place.written) - len(HOLE) - place.line.pieces[-1 - count].start
                yield phrase_suggestion(phrase, place.start - length)


def every_phrase(released: bool) -> Iterator[str]:
    """The phrases of a dialect."""
    yield from (*SPECIFIERS, *PREFIXES, *INFIXES, *(p for each in STATEMENTS.values() for p in each))
    if released:
        yield from (*RELEASED_SPECIFIERS, *RELEASED_PREFIXES, *RELEASED_INFIXES, *(p for e in RELEASED_STATEMENTS.values() for p in e))


def phrase_suggestion(phrase: str, start: int, *kinds: str) -> Completion:
    """A phrase of the language, with its rules."""
    word = word_of(phrase, kinds) if kinds else word_of(phrase)
    return Completion(phrase, "keyword", start, kinds[0] if kinds else "" if word is None else word.kind, "" if word is None else about_word(word))


def possible_completions(place: CompletedPlace) -> Iterator[Completion]:
    """Yield the completions at a place, chosen by the words before it."""
    words = place.words
    first, last = words[0] if words else "", words[-1] if words else ""
    if first in ("import", "from", "model") and len(words) + bool(place.prefix):
        yield from in_import(place, first)
    elif last == ".":
        yield from behind_dot(place)
    elif last == "with" and len(words) > 1:
        yield from properties(place, class_built(place.finder, place.line, len(words), place.names))
    elif not words:
        yield from statement(place)
    elif not complete(place):
        if last == "," and is_in_object(place):
            yield from specifiers(place)
        yield from expression(place)
    else:
        if is_in_object(place):
            yield from specifiers(place)
        yield from (phrase_suggestion(p, place.start, "operator") for p in (*INFIXES, *(RELEASED_INFIXES if place.released else ())))


def in_import(place: CompletedPlace, first: str) -> Iterator[Completion]:
    """Modules, `import`, and the names of a module."""
    finder, words = place.finder, place.words
    if not words[1:] and not place.prefix and place.line.pieces[-1].start == 0:
        return
    if first == "from" and "import" in words:
        source = "".join(words[1 : words.index("import")])
        name = source.lstrip(".")
        module = finder.shelf.find(name, len(source) - len(name), finder.main)
        yield from () if module is None else (name_completion(n, m, place) for n, m in finder.exported(module, frozenset()).items())
    elif words[1:] and words[-1] not in (".", ",") and words[1:2] != (".",):
        yield Completion("import" if first == "from" else "as", "keyword", place.start)
    else:
        dotted = DOTTED.search(place.written.removesuffix(HOLE) + place.prefix)
        start = place.start + len(place.prefix) - len(dotted[0] if dotted is not None else "")
        yield from (Completion(name, "module", start) for name in finder.shelf.names(finder.main))


def behind_dot(place: CompletedPlace) -> Iterator[Completion]:
    """Names of a module, global parameters, properties and methods."""
    finder, words = place.finder, place.words
    receiver = words[-2] if len(words) > 1 else ""
    chain = re.search(r"([\w.]+)\.$", place.written.removesuffix(HOLE))
    module = None if chain is None else module_named(finder, chain[1], place.names)
    if receiver == PARAMETERS:
        found = (d.name for d in finder.main.outline.children if d.kind == "param")
        yield from (Completion(name, "variable", place.start, definition_line(m)) for name in found if (m := param(finder, name)) is not None)
    elif module is not None:
        yield from (name_completion(name, meaning, place) for name, meaning in finder.members(module).items())
    else:
        class_ = finder.class_of(receiver, place.start, place.names) if chain is not None and "." not in chain[1] else None
        yield from properties(place, class_, methods=True)


def properties(place: CompletedPlace, class_: str | None, *, methods: bool = False) -> Iterator[Completion]:
    """The properties of a class, or those of all classes that can be named."""
    finder = place.finder
    classes = [class_] if class_ else ["Object", *(name for name in place.names if finder.is_class(name, place.names))]
    for one in (one for name in classes for one in finder.properties(name, place.names)):
        if one.meaning is None:
            yield Completion(one.name, "property", place.start, f"property of {one.owner}", about_built_in_property(one.name))
        elif one.meaning.definition is not None and (one.meaning.definition.kind == "property" or methods):
            kind = one.meaning.definition.kind if one.meaning.definition.kind == "property" else "method"
            yield Completion(one.name, kind, place.start, f"{definition_line(one.meaning)} (of {one.owner})", about_built_in_property(one.name))


def is_in_object(place: CompletedPlace) -> bool:
    """Whether the words before a place, in the same brackets, make an object: a class begins them, or a name that is not known but looks like one."""
    if place.words[0] == "override":
        return True
    inside = same_brackets(place.line, len(place.words))
    start = max((number for number, piece in enumerate(inside) if piece.text in ("=", ":", "return")), default=-1) + 1
    inside = inside[start:]
    inside = inside[1:] if inside and inside[0].text == "new" else inside
    qualified = len(inside) > 2 and inside[1].text == "."
    while len(inside) > 2 and inside[1].text == ".":
        inside = inside[2:]
    if not inside or inside[0].kind != "name" or place.line.pieces[place.line.pieces.index(inside[0]) + 1].text == "(":
        return False
    name = inside[0].text
    return place.finder.is_class(name, place.names) or ((qualified or is_undefined(name, place.names)) and name[:1].isupper())


def is_undefined(name: str, names: Mapping[str, Meaning]) -> bool:
    """Whether nothing that can be found defines a name."""
    return name not in names and name not in BUILTINS


def complete(place: CompletedPlace) -> bool:
    """Whether an expression may end before a place."""
    last = place.line.pieces[-2]
    if last.kind != "name":
        return last.kind in ("number", "string") or last.text in (")", "]", "}")
    phrase = phrase_at(place.written, last)
    return phrase is None or phrase.word.name in POSTFIXES


def specifiers(place: CompletedPlace) -> Iterator[Completion]:
    """Yield the specifiers that can stand at a place."""
    found = (*SPECIFIERS, *(RELEASED_SPECIFIERS if place.released else ()))
    yield from (phrase_suggestion(phrase, place.start, "specifier") for phrase in found)


def statement(place: CompletedPlace) -> Iterator[Completion]:
    """Yield the beginnings of a statement; in a class also the properties of its superclasses."""
    home = list(around(place.finder.main.outline, place.start))[-1] if place.line.indent else place.finder.main.outline
    if home.kind == "class":
        yield from (one._replace(label=f"{one.label}: ") for one in properties(place, home.name))
    found = (*STATEMENTS[home.kind], *(RELEASED_STATEMENTS.get(home.kind, ()) if place.released else ()))
    yield from (phrase_suggestion(phrase, place.start, "statement") for phrase in found)
    yield from () if home.kind == "class" else expression(place)


def expression(place: CompletedPlace) -> Iterator[Completion]:
    """Yield the beginnings of an expression: names of the text and of the language, and prefix operators."""
    yield from (name_completion(name, meaning, place) for name, meaning in place.names.items())
    yield from (built_in(name, place.start) for name in BUILTINS)
    yield from (Completion(name, "variable", place.start) for name in ("ego", "self", "workspace"))
    yield from (phrase_suggestion(p, place.start, "operator") for p in (*PREFIXES, *(RELEASED_PREFIXES if place.released else ())))


def name_completion(name: str, meaning: Meaning, place: CompletedPlace) -> Completion:
    """A name that a text or a module defines."""
    kind = "module" if meaning.whole else "variable" if meaning.definition is None else meaning.definition.kind
    return Completion(name, kind, place.start, definition_line(meaning) if meaning.definition is not None else meaning.module.name)


def built_in(name: str, start: int) -> Completion:
    """A name of the language."""
    value = BUILTINS[name]
    kind = "class" if isinstance(value, (ScenicClass, type)) else "distribution" if isinstance(value, Constructor) else "function"
    return Completion(name, kind if callable(value) or name in BUILT_IN_CLASSES else "variable", start, signature(name))

