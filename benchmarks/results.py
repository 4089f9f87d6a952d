"""Helpers that the scripts beside this file share: the programs of the gallery, and figures as a Markdown
table or as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from .figures import machine, versions

GALLERY = Path(__file__).parent.parent / "examples" / "gallery"
"""The gallery of the source tree, which no wheel holds."""


def gallery() -> list[Path]:
    """The gallery's programs, sorted by name."""
    return sorted(GALLERY.glob("*.scenic"))


def print_row(cells: Sequence[object]) -> None:
    """One row of a Markdown table, at once."""
    print(" | ".join(map(str, cells)), flush=True)


def print_head(columns: Sequence[str]) -> None:
    """The head of a Markdown table."""
    print_row(columns)
    print_row(["---"] * len(columns))


def save(path: Path | None, rows: Sequence[Mapping[str, object]], **options: object) -> None:
    """Write the rows as JSON, with versions, the machine and the options that decide the figures; nothing without a path."""
    if path is not None:
        found = {"versions": versions(), "machine": machine(), **options, "rows": rows}
        path.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
