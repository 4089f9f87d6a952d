"""The places at which errors in library modules are reported: where the program called the module."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..syntax.nodes import NOWHERE, Node, Span
from .config import Stack

OF_LIBRARY = "<scenic."
"""The files of library modules begin so."""


def frames_of(stack: Stack) -> Iterator[object]:
    """The frames of a stack, the innermost first."""
    while stack:
        frame, stack = stack
        yield frame


def caller_in(frames: Iterable[object]) -> Span:
    """The innermost place of the program itself, below frames of library modules, whose import is one."""
    for frame in frames:
        for node in (getattr(frame, "node", None), getattr(frame, "then", None)):
            if isinstance(node, Node) and node.span.line > 0 and not node.span.file.startswith(OF_LIBRARY):
                return node.span
    return NOWHERE


def of_program(span: Span, caller: Span) -> tuple[Span, str]:
    """Return the place at which an error found at `span` is reported, and a hint where it was found, if that
    is in a library module that the program called.
    """
    if not span.file.startswith(OF_LIBRARY) or caller == NOWHERE:
        return span, ""
    return caller, f"found on line {span.line} of the library's module {span.file.strip('<>')}"
