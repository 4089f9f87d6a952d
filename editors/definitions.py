"""The definition of the name under the pointer, and the outline of a text."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from .name_scopes import Meaning, NameFinder
from .place_meanings import subject_at


class DefinedAt(NamedTuple):
    """A stretch of a file; `path` is None for the text that was asked about."""

    path: Path | None
    text: str
    start: int
    end: int


def targets(finder: NameFinder, offset: int) -> list[DefinedAt]:
    """The definitions of what stands at an index: one for a name; of a property, one for each class that gives it a default."""
    subject = subject_at(finder, offset)
    if subject is None:
        return []
    meanings = [subject.meaning] if subject.meaning is not None else [one.meaning for one in subject.inherited if one.meaning is not None]
    return [target for meaning in meanings for target in target_of(finder, meaning)]


def target_of(finder: NameFinder, meaning: Meaning) -> list[DefinedAt]:
    """Return the place of a definition or a module; none if it stands in no file."""
    module = meaning.module
    if module.path is None and module != finder.main:
        return []
    path = None if module == finder.main else module.path
    if meaning.definition is not None:
        return [DefinedAt(path, module.text, meaning.definition.start, meaning.definition.end)]
    return [DefinedAt(path, module.text, 0, 0)] if meaning.whole else []
