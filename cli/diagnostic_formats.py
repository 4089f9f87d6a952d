"""The findings of `check` as text, JSON, GitHub annotations, JUnit and SARIF."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from .. import __version__
from ..api.diagnostics import Diagnostic, check_and_rehearse, diagnostic_json, of_error, of_warning, warnings_about
from ..data.scene import in_json, in_utf8
from ..interpreter.language.dialects import DEFAULT, DIALECTS
from ..interpreter.language.lint import KINDS
from ..semantics.store.errors import ScenicError, UsageError
from ..semantics.store.suggestions import did_you_mean
from ..simulators.worlds.driving import notes
from .error_messages import render, render_warning
from .progress_bar import running_once
from .session import escape_controls, supports_colour, tell

if TYPE_CHECKING:
    from ..api import Scenario
    from ..interpreter.language.lint import ProgramWarning
    from ..sampling.program_source import Source
    from .session import Session


SCHEMA = "scenic-ref/diagnostics/1"
MOST_WARNINGS = 10
SARIF = "https://json.schemastore.org/sarif-2.1.0.json"


def as_json(found: list[Diagnostic]) -> str:
    """One JSON object; lines and columns begin with 1, the end is one past the last character."""
    return in_json({"schema": SCHEMA, "diagnostics": [diagnostic_json(one) for one in found]}, indent=2)


def as_github(found: list[Diagnostic]) -> str:
    """Workflow commands, one a line, which GitHub shows beside the lines of a pull request."""
    return "\n".join(map(annotation, found))


def annotation(one: Diagnostic) -> str:
    """`::error file=...,line=...::message`; the columns only where the place is in one line, as GitHub asks."""
    span = one.span
    place: dict[str, object] = {"file": span.file}
    if span.line:
        place |= {"line": span.line, "endLine": span.end_line}
    if span.line and span.line == span.end_line:
        place |= {"col": span.column, "endColumn": max(span.column, span.end_column - 1)}
    place["title"] = one.kind
    properties = ",".join(f"{name}={escape_workflow_text(str(value)).replace(':', '%3A').replace(',', '%2C')}" for name, value in place.items())
    return f"::{one.severity} {properties}::{escape_workflow_text(one.text)}"


def escape_workflow_text(text: str) -> str:
    """A text as a workflow command holds it."""
    return in_utf8(escape_controls(text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")))


def as_sarif(found: list[Diagnostic]) -> str:
    """One run in the Static Analysis Results Interchange Format 2.1.0; the kinds are its rules."""
    kinds = list(dict.fromkeys(one.kind for one in found))
    rules = [{"id": identifier(kind), "shortDescription": {"text": KINDS.get(kind, kind)}} for kind in kinds]
    driver = {"name": "scenic-ref", "version": __version__, "rules": rules}
    results = [result(one, kinds.index(one.kind)) for one in found]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return in_json({"$schema": SARIF, "version": "2.1.0", "runs": [run]}, indent=2)


def result(one: Diagnostic, rule: int) -> dict[str, object]:
    """A diagnostic as SARIF has it."""
    span = one.span
    region = {"startLine": span.line, "startColumn": span.column, "endLine": span.end_line, "endColumn": span.end_column}
    place: dict[str, object] = {"artifactLocation": {"uri": address_of(span.file)}, **({"region": region} if span.line else {})}
    where = [{"physicalLocation": place}]
    return {"ruleId": identifier(one.kind), "ruleIndex": rule, "level": one.severity, "message": {"text": one.text}, "locations": where}


def address_of(file: str) -> str:
    """The address of a file, as SARIF and the web have it: relative as it was given, else with `file://`."""
    path = Path(file)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))


def identifier(kind: str) -> str:
    """The kind in one word."""
    return kind.replace(" ", "-")


FORMATS: Mapping[str, Callable[[list[Diagnostic]], str]] = {"json": as_json, "github": as_github, "sarif": as_sarif}
"""The formats beside text, each a function to the text of a document."""


WRONG = 1
"""The exit code for a program with an error, or with a warning that counts as one."""


def check_program(source: Source, form: str, session: Session, *, strict: bool) -> int:
    """Tell what is wrong with the program; gives the exit code. Raises `UsageError`, and what is no matter of the program."""
    if form != "text" and form not in FORMATS:
        known = ["text", *FORMATS]
        raise UsageError(f"there is no format {form}", hint=did_you_mean(form, known, f"the formats are {', '.join(known)}"))
    with running_once(source.fuel):
        scenario, warnings, error = check_and_rehearse(source.load)
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
    colours = supports_colour(sys.stderr)
    for warning in warnings:
        print(render_warning(warning, session.texts, colours=colours), file=sys.stderr)
    if error is not None:
        print(render(error, session.texts, colours=colours), file=sys.stderr, flush=True)
    elif strict and warnings:
        print("not ok: with --strict a warning is an error", file=sys.stderr)
    else:
        print("ok")


def tell_notes(scenario: Scenario) -> None:
    """Tell which profile the dialect brought, what the program's model stands for, and what to know about its map."""
    dialect = DIALECTS[scenario.program.dialect]
    if scenario.profile is None and dialect.profile != DEFAULT:
        tell(f"the dialect {dialect.name} brings the profile {dialect.profile}: the program means what that release makes of it")
    for note in notes(scenario.settings.library, scenario.program, scenario.params):
        tell(escape_controls(note))


def tell_warnings(scenario: Scenario) -> None:
    """Tell what looks like a slip in the program, a line for each of the first."""
    warnings = warnings_about(scenario)
    for warning in warnings[:MOST_WARNINGS]:
        place = f"{warning.span}: " if warning.span.line else ""
        tell(f"warning: {place}{warning.message}: {warning.hint}")
    if len(warnings) > MOST_WARNINGS:
        tell(f"and {len(warnings) - MOST_WARNINGS:,} more warnings, which `scenic-ref check` tells")
