"""The state of one command line that the commands and the report of a failure share."""

from __future__ import annotations

import os
import re
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.console import Console

CONTROL = re.compile("[\\x00-\\x08\\x0b-\\x1f\\x7f-\\x9f\\u061c\\u200e\\u200f\\u2028-\\u202e\\u2066-\\u2069]")
"""Control characters except tabs and ends of lines, and those that change the direction of writing."""


@dataclass
class Session:
    """One command line: which program and seed it is about, the texts of its files, and whether to show tracebacks.

    `finished` is what is said of the work that was done, should the rest be interrupted.
    """

    debug: bool = False
    program: str = ""
    seed: int | None = None
    texts: dict[str, str] = field(default_factory=dict)
    finished: str = ""

    def hang_up(self) -> None:
        """Nobody reads standard output any more: drop what is still to be written to it."""
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, sys.stdout.fileno())


def supports_colour(stream: object) -> bool:
    """Whether colours may be written to `stream`: a terminal, with neither NO_COLOR set nor a dumb terminal."""
    is_terminal = getattr(stream, "isatty", lambda: False)()
    return bool(is_terminal) and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def console(stream: TextIO) -> Console:
    """A console on standard output or standard error; without colours, and anything of their kind, where none may be written."""
    from rich.console import Console

    return Console(file=stream, color_system="auto" if supports_colour(stream) else None)


def escape_controls(text: str) -> str:
    """`text` with control characters as Python writes them: what a program, its names and its files say never steers the terminal."""
    return CONTROL.sub(lambda found: found[0].encode("unicode_escape").decode("ascii"), text)


def tell(text: str = "") -> None:
    """Lines on standard error."""
    print(escape_controls(text), file=sys.stderr, flush=True)
