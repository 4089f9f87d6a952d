"""Vectors against mutants: which lines each vector runs, and whether any vector notices a change."""

from __future__ import annotations

import hashlib
import json
import os
import resource
import signal
import sys
import tomllib
from dataclasses import dataclass, field
from inspect import unwrap
from itertools import accumulate
from pathlib import Path
from typing import Any

from .changes import ROOT, Mutant
from .processes import Tell, Work, allow, each
from .watching import Lines, forget

VECTORS = ROOT / "conformance" / "vectors"
SLOWER = 4
"""How many times as much processor time a vector may take under a mutant, ..."""
AT_LEAST = 4
"""... and so many seconds more."""
IMPORT = 60
"""Seconds of processor time for importing the package."""
OTHERS = 60.0
"""Seconds, as they were when the lines were watched, of the vectors that are tried though they do not run a line themselves that runs at import."""


@dataclass(slots=True)
class Covered:
    """What runs which lines: vectors or tests by number, with their seconds; `at_import` are lines that run when modules are imported."""

    names: list[str] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    lines: dict[str, dict[int, set[int]]] = field(default_factory=dict)
    at_import: dict[str, set[int]] = field(default_factory=dict)

    def add(self, name: str, seconds: float, lines: dict[str, list[int]]) -> None:
        """One more vector or test."""
        number = len(self.names)
        self.names.append(name)
        self.seconds.append(seconds)
        for file, numbers in lines.items():
            known = self.lines.setdefault(file, {})
            for line in numbers:
                known.setdefault(line, set()).add(number)

    def reaching(self, mutant: Mutant) -> list[int]:
        """Those that can notice a mutant, the quickest first: those that run its lines; then, if these run at import, the quickest of the others."""
        span = range(mutant.lines[0], mutant.lines[1] + 1)
        known = self.lines.get(mutant.file, {})
        found = {number for line in span for number in known.get(line, ())}
        first = sorted(found, key=self.seconds.__getitem__)
        if not mutant.at_import and self.at_import.get(mutant.file, set()).isdisjoint(span):
            return first
        others = sorted(set(range(len(self.names))) - found, key=self.seconds.__getitem__)
        return first + [n for n, spent in zip(others, accumulate(self.seconds[n] for n in others), strict=True) if spent <= OTHERS]


def seconds() -> float:
    """The processor time of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


Table = tuple[str, str, dict[str, object], int]
"""A vector as it is written: file, chapter, table, number in the file."""


def tables() -> dict[str, Table]:
    """Every vector of the tree by its name, read without the package."""
    found: dict[str, Table] = {}
    for path in sorted(VECTORS.rglob("*.toml")):
        content = tomllib.loads(path.read_text("utf-8"))
        for number, table in enumerate(content["vector"], 1):
            found[table["name"]] = (path.relative_to(VECTORS).as_posix(), content["chapter"], table, number)
    return found


@dataclass(frozen=True, slots=True)
class Catalogued:
    """A rule of the catalogue with its function: file, name and first line."""

    rule: str
    file: str
    function: str
    line: int

    def holds(self, mutant: Mutant) -> bool:
        """Whether the mutant changes the function."""
        return mutant.file == self.file and f"{mutant.function}.".startswith(f"{self.function}.")


@dataclass(frozen=True, slots=True)
class Known:
    """What is known before anything is changed: the vectors, what they run and show, the rules, the libraries that are used."""

    tables: dict[str, Table]
    covered: Covered
    shown: dict[str, frozenset[str]]
    rules: list[Catalogued]
    libraries: list[str]


def imported_package() -> None:
    """Import what judges vectors. Raises `RuntimeError` if the package is imported from elsewhere than this tree."""
    import scenic_ref.conformance.reports
    import scenic_ref.conformance.vector_files

    if Path(scenic_ref.__file__).resolve().parent != ROOT.resolve():
        raise RuntimeError(f"scenic_ref is imported from {scenic_ref.__file__}, and not from {ROOT}")


def catalogued() -> list[Catalogued]:
    """The rules of the package that is imported."""
    from scenic_ref.semantics.rules import RULES

    found = []
    for rule in RULES.values():
        code = unwrap(rule.function).__code__
        file = Path(code.co_filename).resolve().relative_to(ROOT.resolve()).as_posix()
        found.append(Catalogued(rule.id, file, code.co_qualname.replace("<locals>.", ""), code.co_firstlineno))
    return found


def survey(jobs: int, kept: dict[str, Any]) -> Known:
    """What each vector runs; `kept` holds what an earlier run found, and takes over what is found. Raises SystemExit if a vector does not pass."""
    known = tables()
    names = [name for name, table in known.items() if kept.get(name, {}).get("table") != list(table)]

    def watch(chosen: Any, tell: Tell) -> None:
        lines = Lines()
        lines.start()
        imported_package()
        tell(at_import=lines.take(), rules=[(r.rule, r.file, r.function, r.line) for r in catalogued()])
        for name in chosen:
            forget()
            lines.take()
            before = seconds()
            vector, verdict = judged(known[name])
            took, ran = seconds() - before, lines.take()
            tell(name=name, table=known[name], seconds=took, lines=ran, shows=sorted(shows(vector)), status=verdict.status, reason=verdict.reason)
        tell(libraries=[name for name in sys.modules if name.partition(".")[0] not in ("scenic_ref", "tests", "__main__")])

    about_all = {"at_import", "libraries", "rules"} - set(kept)
    for _, told, _ in each([names[i::jobs] for i in range(jobs) if names[i::jobs] or about_all], watch, jobs):
        for fields in told:
            if "crash" in fields:
                raise SystemExit(f"the vectors cannot be watched:\n{fields['crash']}")
            if fields.get("status", "passed") != "passed":
                raise SystemExit(f"the vector {fields['name']} does not pass before any change: {fields['reason']}")
            kept |= {fields["name"]: fields} if "name" in fields else fields
    if missing := [name for name in known if name not in kept]:
        raise SystemExit(f"a process that watches the vectors ended early: nothing is known about {', '.join(missing[:5])}")
    covered = Covered(at_import={file: set(numbers) for file, numbers in kept["at_import"].items()})
    for name in known:
        covered.add(name, kept[name]["seconds"], kept[name]["lines"])
    shown = {name: frozenset(kept[name]["shows"]) for name in known}
    return Known(known, covered, shown, [Catalogued(*rule) for rule in kept["rules"]], kept["libraries"])


def shows(vector: Any) -> frozenset[str]:
    """The rules that a vector shows."""
    from scenic_ref.conformance.reports import shows

    return shows(vector)


def judged(table: Table) -> tuple[Any, Any]:
    """A vector, and the verdict on ourselves."""
    from scenic_ref.conformance import Ourselves, judge
    from scenic_ref.conformance.vector_files import read_vector

    vector = read_vector(*table)
    return vector, judge(Ourselves(), vector).verdict


@dataclass(frozen=True, slots=True)
class Trial:
    """A mutant, and the vectors or tests that may notice it, in the order in which they are run; `left` were left out for want of time."""

    mutant: Mutant
    names: tuple[str, ...]
    limits: tuple[float, ...]
    left: int = 0
    rule: str = ""


def mark(table: Table) -> str:
    """Sixteen digits that tell a vector, as it is written, from others."""
    return hashlib.sha256(json.dumps(table[2], sort_keys=True, default=str).encode()).hexdigest()[:16]


def trial(mutant: Mutant, known: Known, rule: str = "", missed: frozenset[str] = frozenset()) -> Trial:
    """The trial of a mutant by the vectors that run it, or by those of a rule; without those that missed it before, given by their marks."""
    covered = known.covered
    numbers = covered.reaching(mutant)
    if rule:
        numbers = [n for n in sorted(range(len(covered.names)), key=covered.seconds.__getitem__) if rule in known.shown[covered.names[n]]]
    numbers = [n for n in numbers if mark(known.tables[covered.names[n]]) not in missed] if missed else numbers
    limits = tuple(SLOWER * covered.seconds[n] + AT_LEAST for n in numbers)
    return Trial(mutant, tuple(covered.names[n] for n in numbers), limits, rule=rule)


def by_vectors(known: Known) -> Work:
    """The work of a process: a mutant, tried by vectors until one notices it."""

    def work(tried: Trial, tell: Tell) -> None:
        sys.meta_path.insert(0, tried.mutant.finder())
        tell(at="import")
        allow(IMPORT)
        imported_package()
        for name, limit in zip(tried.names, tried.limits, strict=True):
            tell(at=name)
            allow(limit)
            verdict = judged(known.tables[name])[1]
            if verdict.status != "passed":
                tell(how=verdict.status, reason=verdict.reason[:300])
                return
        tell(how="missed")

    return work


def outcome(told: list[dict[str, Any]], status: int) -> dict[str, Any]:
    """Who noticed a mutant, and how: failed, errored, crash (of the process), time (limit reached); `by` is None if nobody did."""
    by = "import"
    for fields in told:
        by = fields.get("at", by)
        if "crash" in fields:
            return {"by": by, "how": "errored", "reason": fields["crash"].strip().splitlines()[-1][:300]}
        if "how" in fields:
            return {"by": None, "how": "missed"} if fields["how"] == "missed" else {"by": by, **fields}
    late = os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL)
    return {"by": by, "how": "time" if late else "crash"}
