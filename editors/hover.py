"""The text, in Markdown, that an editor shows for the word under the pointer."""

from __future__ import annotations

from typing import NamedTuple

from ..semantics.store.built_in_classes import BUILT_IN_CLASSES
from .name_scopes import Inherited, Meaning, NameFinder, definition_line
from .place_meanings import Subject, subject_at
from .positions import TextLines
from .tokens import pieces
from .word_meanings import about_built_in, about_built_in_property, about_word, escape_markdown, specifiers_of

MOST_PROPERTIES = 60


class HoverText(NamedTuple):
    """A text in Markdown about a stretch of the program."""

    markdown: str
    start: int
    end: int


def hover(finder: NameFinder, offset: int) -> HoverText | None:
    """Return the hover text for an index of the text, or None."""
    subject = subject_at(finder, offset)
    if subject is None:
        return None
    piece, phrase = subject.piece, subject.phrase
    start, end = (phrase.start, phrase.end) if phrase is not None else (piece.start, piece.end)
    text = about(finder, subject)
    return HoverText(text, start, end) if text else None


def about(finder: NameFinder, subject: Subject) -> str:
    """The Markdown of a subject; \"\" if there is nothing to say."""
    if subject.property:
        return about_property(subject)
    if subject.meaning is not None:
        return about_meaning(finder, subject.meaning, subject.piece.text)
    if subject.phrase is not None:
        return about_word(subject.phrase.word)
    return about_built_in(subject.piece.text)


def about_property(subject: Subject) -> str:
    """A property: the definitions that classes of programs give it, and what it means."""
    found = [defined_property(one) for one in subject.inherited if one.meaning is not None]
    return "\n\n".join(part for part in (*found, about_built_in_property(subject.piece.text)) if part)


def defined_property(one: Inherited) -> str:
    """A property to which a class of a program gives a default, or a method of it."""
    assert one.meaning is not None
    kind = "property" if kind_of_member(one) == "property" else "method"
    text = f"*{kind}* `{one.name}` of `{one.owner}`\n\n```scenic\n{definition_line(one.meaning)}\n```\n\n{where(one.meaning)}"
    return text + (f"  \nspecified by {specifiers_of(one.name)}" if kind == "property" and not about_built_in_property(one.name) else "")


def about_meaning(finder: NameFinder, meaning: Meaning, name: str) -> str:
    """A name that a text defines: its line, its place, the comment above it; of a class its properties as well."""
    if meaning.whole:
        return f"*module* `{marked_path(meaning)}`"
    if meaning.definition is None:
        return about_built_in(name) or f"```scenic\n{name}\n```\n\nof the module `{meaning.module.name}`"
    parts = [f"```scenic\n{definition_line(meaning)}\n```", escape_markdown(comment_above(meaning)), f"*{meaning.definition.kind}* {where(meaning)}"]
    if meaning.definition.kind == "class":
        parts.append(properties(finder, meaning))
    return "\n\n".join(part for part in parts if part)


def properties(finder: NameFinder, meaning: Meaning) -> str:
    """The properties of a class, with those that it inherits from other classes of programs, and the built-in class that it descends from."""
    module = meaning.module
    name = meaning.definition.name if meaning.definition is not None else ""
    names = finder.defined(module.outline, module, frozenset()) | {name: meaning}
    found = list(finder.properties(name, names))
    first = {one.name: one for one in reversed(found) if kind_of_member(one) == "property"}
    wanted = [one for one in found if first.get(one.name) is one][:MOST_PROPERTIES]
    lines = [f"- `{definition_line(one.meaning)}`" + owner(one, meaning) for one in wanted if one.meaning is not None]
    above = next((one.owner for one in found if one.meaning is None and one.owner in BUILT_IN_CLASSES), "")
    return "\n".join([*lines, f"- the properties of `{above}`"] if above else lines)


def kind_of_member(one: Inherited) -> str:
    """Whether it is a property or a method, where a class of a program defines it."""
    return "" if one.meaning is None or one.meaning.definition is None else one.meaning.definition.kind


def owner(one: Inherited, meaning: Meaning) -> str:
    """Of which class a property is, where it is inherited."""
    return f" of `{one.owner}`" if meaning.definition is not None and one.owner != meaning.definition.name else ""


def where(meaning: Meaning) -> str:
    """The file and line of a definition."""
    assert meaning.definition is not None
    line, _ = TextLines(meaning.module.text).place(meaning.definition.start)
    return f"in `{marked_path(meaning)}`, line {line + 1}"


def marked_path(meaning: Meaning) -> str:
    """The file of a module, or its name."""
    path = meaning.module.path
    return meaning.module.name if path is None or "." in meaning.module.name else path.name


def comment_above(meaning: Meaning) -> str:
    """The comment that stands right above a definition."""
    assert meaning.definition is not None
    found: list[str] = []
    ends = 0
    for piece in reversed([p for p in pieces(meaning.module.text) if p.end <= meaning.definition.first]):
        ends = ends + 1 if piece.kind == "end" else 0
        if ends > 1 or piece.kind not in ("end", "comment"):
            break
        if piece.kind == "comment":
            found.append(piece.text.lstrip("# "))
    return " ".join(reversed(found))
