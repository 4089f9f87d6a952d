"""The verdicts of an implementation on every vector, a line each: a file to keep, in which a change of
behaviour is a change of a line.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path

from ..interpreter.language.modules import read_text
from ..semantics.store.errors import UsageError
from .judge import Result
from .verdict import STATUSES

SCHEMA = "scenic-ref/results/1"
LONGEST = 160
"""Characters of a reason that are kept."""
ADDRESS = re.compile(r"0x[0-9a-f]{6,}|(?<=\()\d{12,}(?=\))")
SECONDS = re.compile(r"within [\d.e+]+ s\b")
PATH = re.compile(r"(?:/[\w.+-]+){2,}")


def results_text(implementation: str, results: Sequence[Result]) -> str:
    """The file: JSON with a line for each vector, in the order of their names."""
    lines = [
        f"  {json.dumps(r.vector.name)}: {json.dumps(verdict_line(r), ensure_ascii=False)}" for r in sorted(results, key=lambda r: r.vector.name)
    ]
    head = f'{{"schema": {json.dumps(SCHEMA)}, "implementation": {json.dumps(implementation)}, "results": {{\n'
    return head + ",\n".join(lines) + "\n}}\n"


def verdict_line(result: Result) -> str:
    """The verdict with the beginning of its reason, without what differs from run to run."""
    verdict = result.verdict
    if not verdict.reason:
        return verdict.status
    reason = SECONDS.sub("in time", PATH.sub("...", ADDRESS.sub("0x...", " ".join(verdict.reason.split()))))
    return f"{verdict.status}: {reason if len(reason) <= LONGEST else reason[:LONGEST] + '...'}"


def status_in(line: str) -> str:
    """The verdict in a line of the file."""
    return line.partition(":")[0]


def parse_results(text: str, file: str) -> tuple[str, Mapping[str, str]]:
    """The implementation, and a line for each vector. Raises `UsageError` for anything else."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{file} is not JSON: {error}") from error
    if not isinstance(found, dict) or found.get("schema") != SCHEMA or not isinstance(found.get("results"), dict):
        raise UsageError(f"{file} is no file of results ({SCHEMA})")
    if any(not isinstance(line, str) or status_in(line) not in STATUSES for line in found["results"].values()):
        raise UsageError(f"{file}: a result begins with {', '.join(STATUSES)}")
    return str(found.get("implementation")), found["results"]


def shipped_results() -> dict[str, Mapping[str, str]]:
    """The results that ship, by implementation."""
    folder = files("scenic_ref.conformance").joinpath("results")
    shipped = sorted((p for p in folder.iterdir() if p.name.startswith("scenic-")), key=lambda p: p.name)
    return dict(parse_results(p.read_text("utf-8"), p.name) for p in shipped)


def lines_at(path: Path) -> Mapping[str, str]:
    """The line of each vector in a file of results. Raises `UsageError` if it cannot be read, or is none."""
    return parse_results(read_text(path, "a file of results"), str(path))[1]


def changes(before: Mapping[str, str], results: Sequence[Result]) -> list[str]:
    """Return the changed verdicts: a line for each vector in both whose verdict differs."""
    now = {result.vector.name: verdict_line(result) for result in results}
    return [f"{name}: was {before[name]}; is {now[name]}" for name in sorted(now) if name in before and before[name] != now[name]]
