"""What is wrong with a program, or looks wrong, as records for tools: `check --format`, and the language server."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..interpreter.language.lint import ProgramWarning
from ..semantics.kernel.errors import AttemptsExhausted, ProgramError, ScenicError
from ..semantics.syntax import Span
from .noticing import warnings_about
from .scenario import Scenario


class Diagnostic(NamedTuple):
    """One error or warning; `line` is 0 where it has no place."""

    severity: str
    kind: str
    message: str
    span: Span
    hint: str = ""
    rule: str = ""
    expected: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The sentence with its hint."""
        return f"{self.message}; {self.hint}" if self.hint else self.message


class CheckedProgram(NamedTuple):
    """A program that was checked: the scenario, if it could be loaded, the warnings, and the error that ended it."""

    scenario: Scenario | None
    warnings: list[ProgramWarning]
    error: ScenicError | None


def checked(load: Callable[[], Scenario]) -> CheckedProgram:
    """Load a program and run it once. Raises `UsageError`, and what is no matter of the program."""
    scenario, warnings = None, []
    try:
        scenario = load()
        warnings = warnings_about(scenario)
        scenario.rehearse()
    except (ProgramError, AttemptsExhausted) as problem:
        others = [one for one in warnings if (one.message, one.span) != (problem.message, problem.span)]
        return CheckedProgram(scenario, others, problem)
    return CheckedProgram(scenario, warnings, None)


def of_error(error: ScenicError, file: str) -> Diagnostic:
    """An error; one without a place is one of the whole file."""
    span = error.span if error.span.line > 0 else Span(file, 0, 0, 0, 0)
    return Diagnostic("error", error.kind, error.message, span, error.hint, error.rule, tuple(getattr(error, "expected", ())))


def of_warning(warning: ProgramWarning) -> Diagnostic:
    """A warning."""
    return Diagnostic("warning", warning.kind, warning.message, warning.span, warning.hint)


def record(one: Diagnostic) -> dict[str, object]:
    """A diagnostic in JSON; without a place it has a file alone."""
    span = one.span
    place = {"line": span.line, "column": span.column, "end_line": span.end_line, "end_column": span.end_column} if span.line else {}
    return {
        "severity": one.severity, "kind": one.kind, "message": one.message, "file": span.file, **place, "hint": one.hint, "rule": one.rule,
        "expected": list(one.expected),
    }  # fmt: skip
