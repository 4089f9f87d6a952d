"""What `check` does without samples: whatever is wrong with a program, or looks wrong, in the format that was asked for."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from ..api.diagnostics import Diagnostic, checked, of_error, of_warning
from ..semantics.kernel.errors import ScenicError, UsageError
from ..semantics.kernel.suggestions import did_you_mean
from .diagnostics import FORMATS
from .drawing import tell_notes
from .errors import render, render_warning
from .progress import running_once
from .session import coloured

if TYPE_CHECKING:
    from ..interpreter.language.lint import ProgramWarning
    from .options import Source
    from .session import Session

WRONG = 1
"""The exit code for a program with an error, or with a warning that counts as one."""


def check_program(source: Source, form: str, session: Session, *, strict: bool) -> int:
    """Tell what is wrong with the program; gives the exit code. Raises `UsageError`, and what is no matter of the program."""
    if form != "text" and form not in FORMATS:
        known = ["text", *FORMATS]
        raise UsageError(f"there is no format {form}", hint=did_you_mean(form, known, f"the formats are {', '.join(known)}"))
    with running_once(source.fuel):
        scenario, warnings, error = checked(source.load)
    if form == "text":
        if scenario is not None and error is None:
            tell_notes(scenario)
        tell_text(warnings, error, session, strict=strict)
    else:
        print(FORMATS[form](diagnostics(warnings, error, source.file, strict=strict)), end="\n" if warnings or error or form != "github" else "")
    return error.exit_code if error is not None else WRONG if strict and warnings else 0


def diagnostics(warnings: list[ProgramWarning], error: ScenicError | None, file: str, *, strict: bool) -> list[Diagnostic]:
    """The error first, then the warnings, which are errors where they count as such."""
    found = [of_warning(warning)._replace(severity="error" if strict else "warning") for warning in warnings]
    return found if error is None else [of_error(error, file), *found]


def tell_text(warnings: list[ProgramWarning], error: ScenicError | None, session: Session, *, strict: bool) -> None:
    """Messages on standard error, and "ok" on standard output."""
    colours = coloured(sys.stderr)
    for warning in warnings:
        print(render_warning(warning, session.texts, colours=colours), file=sys.stderr)
    if error is not None:
        print(render(error, session.texts, colours=colours), file=sys.stderr, flush=True)
    elif strict and warnings:
        print("not ok: with --strict a warning is an error", file=sys.stderr)
    else:
        print("ok")
