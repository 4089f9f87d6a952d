"""What came of mutants: the file of results, and the changes that nothing can tell."""

from __future__ import annotations

import gzip
import hashlib
import json
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from .changes import ROOT, Mutant
from .vectors import VECTORS

EQUIVALENT = Path(__file__).with_name("equivalent.toml")
PACKAGES = ("semantics", "interpreter", "inference", "simulators", "api", "conformance")


def digest(paths: Iterable[Path]) -> str:
    """Sixteen digits that tell these files, by name and content, from others."""
    found = hashlib.sha256()
    for path in sorted(paths):
        found.update(f"{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
    return found.hexdigest()[:16]


@dataclass(frozen=True, slots=True)
class State:
    """The tree that a result is about: the code, the vectors, the tests."""

    code: str
    vectors: str
    tests: str

    @classmethod
    def now(cls) -> State:
        """The tree's."""
        code = [p for package in PACKAGES for p in (ROOT / package).rglob("*") if p.suffix in (".py", ".lark", ".scenic")]
        return cls(digest(code), digest(VECTORS.rglob("*.toml")), digest((ROOT / "tests").rglob("*.py")))


class Kept:
    """What was found out about the tree before anything was changed, beside a file of results; empty if it is about other code."""

    def __init__(self, results: Path | None, state: State) -> None:
        self.path = None if results is None else results.with_suffix(".lines.gz")
        self.code = state.code
        found: dict[str, Any] = {}
        if self.path is not None and self.path.exists():
            found = json.loads(gzip.decompress(self.path.read_bytes()))
        same = found.get("code") == self.code
        self.vectors: dict[str, Any] = found["vectors"] if same else {}
        self.tests: dict[str, Any] = found["tests"] if same else {}

    def write(self) -> None:
        """Keep it for the next run."""
        if self.path is not None:
            text = json.dumps({"code": self.code, "vectors": self.vectors, "tests": self.tests})
            self.path.with_suffix(".new").write_bytes(gzip.compress(text.encode(), 1))
            self.path.with_suffix(".new").replace(self.path)


def key(mutant: Mutant) -> str:
    """The name of a mutant among those of the same code."""
    return f"{mutant.file}:{mutant.number}"


class Results:
    """A file with one line per result, appended at once: what it holds about this tree is not done again.

    Who noticed a mutant still does when vectors or tests are added; that nobody did holds only for the same vectors or tests.
    A line per state of the vectors says which there were, so that only those that came later are tried with what was missed.
    """

    def __init__(self, path: Path | None, state: State) -> None:
        self.path = path
        self.state = state
        self.vectors: dict[str, dict[str, Any]] = {}
        self.suite: dict[str, dict[str, Any]] = {}
        self.tables: dict[str, frozenset[str]] = {}
        self.missed: dict[str, frozenset[str]] = {}
        if path is not None and path.exists():
            for line in path.read_text("utf-8").splitlines():
                self.read(json.loads(line))

    def read(self, line: dict[str, Any]) -> None:
        """Take over a line, if it is about this tree."""
        if line["stage"] == "tables":
            self.tables[line["against"]] = frozenset(line["vectors"])
            return
        current = self.state.vectors if line["stage"] == "vectors" else self.state.tests
        if line["code"] == self.state.code and (line["outcome"]["by"] is not None or line["against"] == current):
            getattr(self, line["stage"])[line["mutant"]] = line["outcome"]
        if line["stage"] == "vectors" and line["code"] == self.state.code and line["outcome"]["by"] is None:
            self.missed[line["mutant"]] = self.missed.get(line["mutant"], frozenset()) | self.tables.get(line["against"], frozenset())

    def against(self, marks: Iterable[str]) -> None:
        """Note the vectors that there are now, by their marks."""
        if self.state.vectors not in self.tables:
            self.tables[self.state.vectors] = frozenset(marks)
            self.write({"stage": "tables", "against": self.state.vectors, "vectors": sorted(self.tables[self.state.vectors])})

    def add(self, stage: str, mutant: Mutant, outcome: dict[str, Any]) -> None:
        """One more result."""
        getattr(self, stage)[key(mutant)] = outcome
        against = self.state.vectors if stage == "vectors" else self.state.tests
        line = {
            "stage": stage, "mutant": key(mutant), "code": self.state.code, "against": against, "file": mutant.file, "line": mutant.line,
            "function": mutant.function, "kind": mutant.kind, "before": mutant.before, "after": mutant.after, "outcome": outcome,
        }
        self.write(line)

    def write(self, line: dict[str, Any]) -> None:
        """Append a line to the file, if there is one."""
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line, ensure_ascii=False) + "\n")

    def by_vectors(self, mutant: Mutant) -> bool:
        """Whether a vector noticed it."""
        return self.vectors.get(key(mutant), {}).get("by") is not None

    def by_suite(self, mutant: Mutant) -> bool:
        """Whether a vector, or a test, noticed it."""
        return self.by_vectors(mutant) or self.suite.get(key(mutant), {}).get("by") is not None


@dataclass(frozen=True, slots=True)
class Equivalent:
    """A change that no program can tell, with the reason; `after` is None where all changes of this kind in the text are meant."""

    file: str
    function: str
    kind: str
    before: str
    after: str | None
    reason: str

    def names(self, mutant: Mutant) -> bool:
        """Whether it is this change. A file is known by its last name, wherever it stands."""
        where = (PurePath(mutant.file).name, mutant.function, mutant.kind, mutant.before)
        return where == (self.file, self.function, self.kind, self.before) and self.after in (None, mutant.after)


def equivalents() -> list[Equivalent]:
    """The list of them."""
    entries = tomllib.loads(EQUIVALENT.read_text("utf-8")).get("equivalent", [])
    return [Equivalent(e["file"], e["function"], e["kind"], e["before"], e.get("after"), e["reason"]) for e in entries]
