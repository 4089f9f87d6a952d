"""XML as maps need it: elements with their lines, no entities and no document types, bounded."""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.parsers import expat

from ..semantics.store.errors import UsageError

LARGEST = 256 << 20
"""Bytes that a file may have."""
MOST_ELEMENTS = 5_000_000
DEEPEST = 64


class MapError(UsageError):
    """The file is no map, or a broken one; the message names the road and what is wrong."""


class Element:
    """An element of a file: its name, attributes, children and line."""

    __slots__ = ("attributes", "children", "line", "name")

    def __init__(self, name: str, attributes: dict[str, str], line: int) -> None:
        self.name = name
        self.attributes = attributes
        self.line = line
        self.children: list[Element] = []

    def all(self, *path: str) -> Iterator[Element]:
        """The elements at the end of a path of names, in their order."""
        first, *rest = path
        for child in self.children:
            if child.name == first:
                yield from child.all(*rest) if rest else (child,)

    def first(self, *path: str) -> Element | None:
        """The first of `all`."""
        return next(self.all(*path), None)

    def text(self, name: str, default: str | None = None) -> str:
        """An attribute. Raises `MapError` if it is missing and there is no default."""
        found = self.attributes.get(name, default)
        if found is None:
            raise MapError(f"line {self.line}: <{self.name}> has no {name}")
        return found

    def number(self, name: str, default: float | None = None) -> float:
        """An attribute that is a number. Raises `MapError` if it is missing and there is no default, or is no finite number."""
        if default is not None and name not in self.attributes:
            return default
        text = self.text(name)
        try:
            found = float(text)
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            raise MapError(f"line {self.line}: {name} of <{self.name}> must be a number, not {text[:40]!r}")
        return found

    def whole(self, name: str) -> int:
        """An attribute that is a whole number. Raises `MapError`."""
        text = self.text(name)
        if not text.strip().lstrip("+-").isdecimal() or len(text) > 9:
            raise MapError(f"line {self.line}: {name} of <{self.name}> must be a whole number, not {text[:40]!r}")
        return int(text)


def parse(data: bytes) -> Element:
    """The root element. Raises `MapError` for what is not well-formed, for document types (and so entities), and for what is too large."""
    if len(data) > LARGEST:
        raise MapError(f"it has {len(data)} bytes, and a map may have {LARGEST}")
    parser = expat.ParserCreate()
    open_elements = [Element("", {}, 0)]
    count = 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MOST_ELEMENTS or len(open_elements) > DEEPEST:
            raise MapError(f"line {parser.CurrentLineNumber}: there are more than {MOST_ELEMENTS} elements, or more than {DEEPEST} within each other")
        element = Element(name, attributes, parser.CurrentLineNumber)
        open_elements[-1].children.append(element)
        open_elements.append(element)

    def end(name: str) -> None:
        open_elements.pop()

    def document_type(*told: object) -> None:
        raise MapError(f"line {parser.CurrentLineNumber}: a map has no document type, which could name other files or grow without bound")

    parser.StartElementHandler, parser.EndElementHandler, parser.StartDoctypeDeclHandler = start, end, document_type
    try:
        parser.Parse(data, True)
    except expat.ExpatError as problem:
        raise MapError(f"line {problem.lineno}: it is no XML: {expat.errors.messages[problem.code]}") from None
    except (LookupError, ValueError) as problem:  # an encoding that there is not
        raise MapError(f"it is no XML: {problem}") from None
    return open_elements[0].children[0]
