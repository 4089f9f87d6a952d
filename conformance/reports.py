"""The results of a run over many vectors: counts by chapter, the rules that fired, and a JSON report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..semantics.rules import RULES
from .judge import Result
from .matchers.errors import Error
from .vector import ConformanceVector
from .verdict import STATUSES, Status

SCHEMA = "scenic-ref/conformance/1"

UNREACHABLE = frozenset({"R-SpecifiedTwiceOptionally"})
"""Rules that no program reaches: every specifier that specifies something optionally also specifies position, so that two of them are
specified twice non-optionally first."""


@dataclass(frozen=True, slots=True)
class Chapter:
    """The results of one chapter of the paper."""

    title: str
    counts: Counter[Status]

    @property
    def vectors(self) -> int:
        """How many vectors it has."""
        return self.counts.total()


def by_chapter(results: Iterable[Result]) -> list[Chapter]:
    """The counts of each chapter, in the order of the results."""
    found: dict[str, Counter[Status]] = {}
    for result in results:
        found.setdefault(result.vector.chapter, Counter())[result.verdict.status] += 1
    return [Chapter(title, counts) for title, counts in found.items()]


def total(results: Iterable[Result]) -> Counter[Status]:
    """How many vectors passed, failed and so on."""
    return Counter(result.verdict.status for result in results)


def shows(vector: ConformanceVector) -> frozenset[str]:
    """The rules that a vector shows when it passes: those that fire, and the one that refuses its program."""
    refusing = vector.matcher.rule if isinstance(vector.matcher, Error) else None
    return vector.fires if refusing is None else vector.fires | {refusing}


def rules_shown(results: Iterable[Result]) -> frozenset[str]:
    """The rules that vectors which passed show."""
    return frozenset(rule for result in results if result.verdict.status == "passed" for rule in shows(result.vector))


def rules_missing(results: Iterable[Result]) -> tuple[str, ...]:
    """The rules of the catalogue that programs can reach and that no vector which passed shows."""
    shown = rules_shown(results)
    return tuple(rule for rule in RULES if rule not in shown and rule not in UNREACHABLE)


def all_passed(results: Iterable[Result]) -> bool:
    """Whether nothing failed and nothing errored; what is skipped is not a failure."""
    counts = total(results)
    return not (counts["failed"] or counts["errored"])


def report_json(implementation: str, results: Sequence[Result]) -> dict[str, object]:
    """The results as a JSON object."""
    counts = total(results)
    return {
        "schema": SCHEMA, "implementation": implementation, "totals": {status: counts[status] for status in STATUSES},
        "rules": {"shown": sorted(rules_shown(results)), "missing": list(rules_missing(results)), "unreachable": sorted(UNREACHABLE)},
        "results": [entry(result) for result in results],
    }


def entry(result: Result) -> dict[str, object]:
    """One result in the JSON report."""
    vector = result.vector
    return {
        "name": vector.name, "chapter": vector.chapter, "file": vector.file, "paper": vector.paper, "matcher": vector.kind, "dialect": result.dialect,
        "readings": dict(vector.readings), "status": result.verdict.status, "reason": result.verdict.reason,
    }
