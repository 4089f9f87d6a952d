"""The dynamic listings of the paper as they are printed, and the programs that complete them (examples/paper/dynamic/manifest.toml)."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from textwrap import dedent

HOLE = "..."
"""What the paper leaves out."""


@dataclass(frozen=True)
class PrintedListing:
    """A listing of the paper: the section in which it stands, and its text."""

    name: str
    section: str
    printed: str

    @property
    def lines(self) -> list[str]:
        """The lines of the listing, the outermost ones without indentation."""
        return dedent(self.printed).strip("\n").splitlines()


@dataclass(frozen=True)
class CompletedProgram:
    """A program with listings in it: what stands around them, what must happen, in how many time steps; which of these are shown, of which seed."""

    file: str
    listings: tuple[str, ...]
    around: str
    fires: str
    steps: int
    shown: tuple[int, ...] = ()
    seed: int = 0
    readings: Mapping[str, str] = field(default_factory=dict[str, str])


class LineOrigin(Enum):
    """The origin of a line of a program."""

    PRINTED = " "
    FILLED = "+"
    ADDED = "+ "


@dataclass(frozen=True)
class ProgramLine:
    """A line of a program; `printed` is what it fills, empty unless it does."""

    text: str
    origin: LineOrigin
    printed: str = ""


def read_manifest(folder: Path) -> tuple[dict[str, PrintedListing], list[CompletedProgram]]:
    """The listings by name, and the programs, of a folder. Raises `OSError`, `tomllib.TOMLDecodeError`, `TypeError` for unknown keys."""
    data = tomllib.loads((folder / "manifest.toml").read_text(encoding="utf-8"))
    listings = [PrintedListing(**entry) for entry in data["listing"]]
    programs = [
        CompletedProgram(listings=tuple(entry.pop("listings")), shown=tuple(entry.pop("shown", ())), **entry) for entry in data["program"]
    ]  # fmt: skip
    return {listing.name: listing for listing in listings}, programs


def complete_listings(program: str, listings: Sequence[PrintedListing]) -> list[ProgramLine]:
    """The lines of a program, with where each comes from. Raises `ValueError` if a listing does not stand in it as it is printed.

    The lines of a listing stand in the program in their order, as they are printed, all of them indented equally further; other lines may stand
    between them. A line with `...` has something else in place of it; a line that is nothing else, further lines.
    """
    texts = program.splitlines()
    found = [ProgramLine(text, LineOrigin.ADDED) for text in texts]
    after = 0
    for listing in listings:
        starts = (start for start in range(after, len(texts)) if place_listing(listing.lines, texts, start) is not None)
        start = next(starts, None)
        if start is None:
            raise ValueError(f"the listing {listing.name} does not stand in the program as it is printed")
        places = place_listing(listing.lines, texts, start) or []
        for place, line in places:
            found[place] = ProgramLine(texts[place], LineOrigin.FILLED if HOLE in line else LineOrigin.PRINTED, line if HOLE in line else "")
        after = max(place for place, _ in places) + 1
    return found


def place_listing(lines: Sequence[str], texts: Sequence[str], start: int) -> list[tuple[int, str]] | None:
    """Return the places of a listing's lines if the first stands at `start`; None if they do not match."""
    indent = texts[start][: len(texts[start]) - len(texts[start].lstrip())]
    found: list[tuple[int, str]] = []
    at = start
    for line in lines:
        pattern = re.compile(re.escape(indent + line).replace(re.escape(HOLE), ".+"))
        while at < len(texts) and not pattern.fullmatch(texts[at]):
            if not found:
                return None
            at += 1
        if at == len(texts):
            return None
        found.append((at, indent + line))
        at += 1
    return found
