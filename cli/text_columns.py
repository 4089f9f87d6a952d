"""Plain tables: aligned columns; on a terminal the last one is wrapped to its width."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Sequence

UNBOUNDED = 100_000


def columns(heading: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table; cells of all columns but the last keep their length."""
    widths = [max(len(row[i]) for row in (heading, *rows)) for i in range(len(heading) - 1)]
    total = shutil.get_terminal_size().columns if sys.stdout.isatty() else UNBOUNDED
    indent = sum(widths) + 2 * len(widths)
    lines: list[str] = []
    for row in (heading, tuple("-" * max(len(h), 3) for h in heading), *rows):
        lead = "".join(f"{cell:<{width}}  " for cell, width in zip(row, widths, strict=False))
        wrapped = textwrap.wrap(row[-1], max(30, total - indent)) or [""]
        lines += [(lead + wrapped[0]).rstrip(), *(" " * indent + rest for rest in wrapped[1:])]
    return lines


def paragraph(title: str, text: str, width: int = 100) -> list[str]:
    """A titled paragraph; nothing if there is no text."""
    if not text:
        return []
    lead = f"{title:<13} "
    return textwrap.wrap(text, width, initial_indent=lead, subsequent_indent=" " * 14, break_long_words=False, break_on_hyphens=False)
