"""Errors and warnings of a program as records for tools: `check --format`, and the language server."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from ..interpreter.language.dialects import DIALECTS
from ..interpreter.language.lint import (
    IMPLAUSIBLE,
    ProgramWarning,
    misspelt_params,
    slips,
    unread_params,
    warnings_of,
)
from ..interpreter.language.modules import Library
from ..pictures.map_layers import FEATURES, SITE
from ..semantics.python.builtins import BUILTINS, OF_RELEASES
from ..semantics.store.errors import AttemptsExhausted, ProgramError, ScenicError
from ..semantics.syntax import Program, Span
from ..semantics.syntax.statements import Param
from ..simulators.protocol import PROPERTIES_READ
from ..simulators.worlds import PARAMS_READ
from ..simulators.worlds.names import MODELS_BY_NAME
from .scenario import Scenario

ALWAYS = ("ego", "workspace", "self")
"""Names that are bound without a statement that says so."""


def warnings_about(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about a scenario: those about the parameters that it was given, then those about its program, in the order of its text."""
    library: Library = scenario.settings.library  # type: ignore[assignment]
    released = DIALECTS[scenario.program.dialect].released
    found = [
        *warnings_of(scenario.program, library, PROPERTIES_READ, trust=scenario.trust),
        *about_map(scenario.program, library),
        *misspelt_params(scenario.program, library, PARAMS_READ),
        *slips(scenario.program, library, scenario.model, {*BUILTINS, *ALWAYS, *(OF_RELEASES if released else ())}, MODELS_BY_NAME),
    ]  # fmt: skip
    return [*given_in_vain(scenario), *sorted(dict.fromkeys(found), key=lambda warning: (warning.span.line, warning.span.column))]


def given_in_vain(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about the global parameters that a scenario was given."""
    return unread_params(scenario.program, scenario.settings.library, scenario.params, PARAMS_READ)  # type: ignore[arg-type]


def about_map(program: Program, library: Library) -> Iterator[ProgramWarning]:
    """A warning about a map of one's own, where the program names it, if its coordinates are most likely others than those that are read."""
    module = library.get(FEATURES)
    doubt = getattr(module.get(SITE), "doubt", None) if isinstance(module, Mapping) else None
    if doubt is not None:
        named = [one for st in program.statements if isinstance(st, Param) for one in st.assignments if one.name == "map"]
        yield ProgramWarning(IMPLAUSIBLE, doubt.what, named[-1].span if named else Span(program.file, 0, 0, 0, 0), doubt.remedy)


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


def check_and_rehearse(load: Callable[[], Scenario]) -> CheckedProgram:
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
    """Return the diagnostic for a warning."""
    return Diagnostic("warning", warning.kind, warning.message, warning.span, warning.hint)


def diagnostic_json(one: Diagnostic) -> dict[str, object]:
    """A diagnostic in JSON; without a place it has a file alone."""
    span = one.span
    place = {"line": span.line, "column": span.column, "end_line": span.end_line, "end_column": span.end_column} if span.line else {}
    return {
        "severity": one.severity, "kind": one.kind, "message": one.message, "file": span.file, **place, "hint": one.hint, "rule": one.rule,
        "expected": list(one.expected),
    }  # fmt: skip

