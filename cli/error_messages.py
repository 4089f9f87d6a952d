"""Errors as a compiler shows them: what is wrong, where in the source, what was expected, and one repair."""

from __future__ import annotations

import errno
import sys
import traceback
import unicodedata
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ..semantics.store.errors import AttemptsExhausted, InternalError, RunError, ScenicError, UsageError
from ..semantics.store.memory_errors import is_out_of_memory
from .session import escape_controls, supports_colour, tell

if TYPE_CHECKING:
    from ..interpreter.language.lint import ProgramWarning
    from ..semantics.syntax.nodes import Span
    from .session import Session

Paint = Callable[[str, str], str]
RED, YELLOW, BLUE, BOLD, PLAIN = "\x1b[1;31m", "\x1b[1;33m", "\x1b[1;34m", "\x1b[1m", "\x1b[0m"
WIDEST = 150
WORST = 5
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def report_error(error: Exception, session: Session) -> int:
    """Report an error on standard error; gives the exit code."""
    if session.debug:
        tell("".join(traceback.format_exception(error)).rstrip())
    if isinstance(error, OSError) and error.errno in NO_ROOM:
        session.hang_up()
        error = UsageError(f"standard output cannot be written: {error.strerror}")
    if is_out_of_memory(error):
        error = RunError("this needs more memory than there is", hint="--limit-memory allows more, if the machine has it")
    if isinstance(error, ScenicError) and not isinstance(error, InternalError):
        print(render(error, session.texts, colours=supports_colour(sys.stderr)), file=sys.stderr, flush=True)
        return error.exit_code
    tell(internal(error, session))
    return InternalError.exit_code


def internal(error: Exception, session: Session) -> str:
    """The message of an internal error."""
    what = error.message if isinstance(error, InternalError) else f"{type(error).__name__}: {error}".rstrip(": ")
    about = [f"the program {session.program}"] if session.program else []
    about += [f"the seed {session.seed}"] if session.seed is not None else []
    lines = [
        f"internal error: {what}",
        "  This is a fault of scenic-ref, not of your program. Please report it" + (f", with {' and '.join(about)}." if about else "."),
    ]
    if isinstance(error, InternalError) and error.hint:
        lines.append(f"  hint: {error.hint}")
    return "\n".join(lines if session.debug else [*lines, "  hint: --debug shows the traceback; please add it to the report"])


def render(error: ScenicError, texts: Mapping[str, str], *, colours: bool = False) -> str:
    """The whole message. `texts` holds the sources that were read already, by file."""
    expected = ", ".join(getattr(error, "expected", ()))
    notes = [("expected", expected), ("hint", error.hint), ("rule", rule_named(error.rule))]
    lines = message_lines((error.kind, RED), error.message, error.span, notes, texts, colours=colours)
    if isinstance(error, AttemptsExhausted):
        lines += map(escape_controls, _worst(error, texts))
    return "\n".join(lines)


def render_warning(warning: ProgramWarning, texts: Mapping[str, str], *, colours: bool = False) -> str:
    """The whole message of a warning."""
    return "\n".join(message_lines(("warning", YELLOW), warning.message, warning.span, [("hint", warning.hint)], texts, colours=colours))


def message_lines(
    kind: tuple[str, str], message: str, span: Span, notes: Iterable[tuple[str, str]], texts: Mapping[str, str], *, colours: bool
) -> list[str]:
    """Return the lines of a message: the problem, its place with the source line, and the notes that have a
    text; `kind` is the word for it, and its colour.
    """
    paint = _painter(colours)
    margin = " " * max(1, len(str(span.line)))
    lines = [f"{paint(kind[1], kind[0])}{paint(BOLD, ': ' + message)}"]
    if span.line > 0:
        lines += _excerpt(span, texts, margin, paint, kind[1])
    return [*lines, *(f"{margin} {paint(BLUE, '=')} {paint(BOLD, name)}: {escape_controls(text)}" for name, text in notes if text)]


def _painter(colours: bool) -> Paint:
    return (lambda colour, text: f"{colour}{escape_controls(text)}{PLAIN}") if colours else (lambda colour, text: escape_controls(text))


def _excerpt(span: Span, texts: Mapping[str, str], margin: str, paint: Paint, colour: str) -> list[str]:
    """`--> place`, the source line, and carets under the span."""
    bar = paint(BLUE, "|")
    found = [f"{margin}{paint(BLUE, '-->')} {escape_controls(str(span))}"]
    line = source_line(span, texts)
    if line is None:
        return found
    start = min(max(span.column - 1, 0), len(line))
    stop = min(span.end_column - 1, len(line)) if span.end_line == span.line else len(line.rstrip())
    line, start, stop = _clip_line(line, start, max(stop, start))
    before, marked, line = escape_controls(line[:start]), escape_controls(line[start:stop]), escape_controls(line)
    lead = "".join("\t" if char == "\t" else " " * _columns(char) for char in before)
    carets = "^" * max(1, sum(_columns(char) for char in marked))
    number = paint(BLUE, str(span.line))
    return [*found, f"{margin} {bar}", f"{number} {bar} {line}", f"{margin} {bar} {lead}{paint(colour, carets)}"]


def _columns(char: str) -> int:
    if unicodedata.combining(char):
        return 0
    return 2 if unicodedata.east_asian_width(char) in ("W", "F") else 1


def _clip_line(line: str, start: int, stop: int) -> tuple[str, int, int]:
    """A very long line cut down to the neighbourhood of the place."""
    if len(line) <= WIDEST:
        return line, start, stop
    first = max(0, start - WIDEST // 2)
    last = min(len(line), first + WIDEST)
    before, after = "..." if first else "", "..." if last < len(line) else ""
    shift = len(before) - first
    return before + line[first:last] + after, start + shift, min(stop, last) + shift


def source_line(span: Span, texts: Mapping[str, str]) -> str | None:
    """The line of the source on which `span` begins, None if the source cannot be found."""
    text = source_text(span.file, texts)
    if text is None:
        return None
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines[span.line - 1] if 0 < span.line <= len(lines) else None


def source_text(file: str, texts: Mapping[str, str]) -> str | None:
    """The text of the program, of a module next to it, or of a module that is shipped (whose file is `<its name>`)."""
    if file in texts:
        return texts[file]
    if file.startswith("<") and file.endswith(">"):
        from ..simulators.worlds import WORLDS

        world = WORLDS.get(file[1:-1])
        text = world() if world is not None else None
        return text if isinstance(text, str) else None
    try:
        return Path(file).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return None


def rule_named(identifier: str) -> str:
    """The id of a rule with its name, \"\" without one."""
    if not identifier:
        return ""
    from ..semantics.rules import RULES

    return f"{identifier} ({RULES[identifier].name})" if identifier in RULES else identifier


def _worst(error: AttemptsExhausted, texts: Mapping[str, str]) -> list[str]:
    from ..semantics.machine.outcome import Requirement
    from .run_report import requirement_lines

    return ["", *requirement_lines([(r, count) for r, count in error.stuck if isinstance(r, Requirement)], texts, limit=WORST)]
