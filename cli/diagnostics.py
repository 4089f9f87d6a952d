"""What `check` finds wrong with a program, as editors and continuous integration read it: JSON, GitHub's annotations, SARIF."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from urllib.parse import quote

from .. import __version__
from ..api.diagnostics import Diagnostic, record
from ..data.scene import in_json, in_utf8
from ..interpreter.language.lint import KINDS
from .session import escaped

SCHEMA = "scenic-ref/diagnostics/1"
SARIF = "https://json.schemastore.org/sarif-2.1.0.json"


def as_json(found: list[Diagnostic]) -> str:
    """One JSON object; lines and columns begin with 1, the end is one past the last character."""
    return in_json({"schema": SCHEMA, "diagnostics": [record(one) for one in found]}, indent=2)


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
    properties = ",".join(f"{name}={percented(str(value)).replace(':', '%3A').replace(',', '%2C')}" for name, value in place.items())
    return f"::{one.severity} {properties}::{percented(one.text)}"


def percented(text: str) -> str:
    """A text as a workflow command holds it."""
    return in_utf8(escaped(text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")))


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
