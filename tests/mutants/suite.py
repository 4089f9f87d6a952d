"""The test suite against mutants: which lines each test runs, and whether any test notices a change.

Only what runs in the process of the test is seen: a test that starts others is counted by what it does itself.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from .changes import ROOT, Mutant
from .processes import Tell, Work, allow, each
from .results import digest
from .vectors import AT_LEAST, SLOWER, Covered, Mutated, Trial, seconds
from .watching import Lines

OPTIONS = ("-q", "-p", "no:cacheprovider", "-p", "no:xdist")
BUDGET = 60.0
"""Seconds of processor time, as they were when the lines were watched, that the tests for one mutant may take together."""
COLLECTING = 120


class Watching:
    """A plugin that tells, for each test, which lines it runs, its seconds, and whether it passes."""

    def __init__(self, lines: Lines, tell: Tell) -> None:
        self.lines = lines
        self.tell = tell
        self.passed = True

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """What runs while the file is read counts for each of its tests."""
        self.tell(collecting=self.lines.take())

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """One test."""
        self.passed = True
        self.lines.take()
        before = seconds()
        found = yield
        took = seconds() - before
        self.tell(name=item.nodeid, seconds=took, lines=self.lines.take(), passed=self.passed)
        return found

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A test that fails or is skipped tells nothing about a mutant."""
        self.passed = self.passed and report.outcome == "passed"


class Trying:
    """A plugin that runs the chosen tests only, in the given order, each within its time, and tells which one notices."""

    def __init__(self, tried: Trial, tell: Tell) -> None:
        self.limits = dict(zip(tried.names, tried.limits, strict=True))
        self.tell = tell

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Those that are not there under the mutant are not missed."""
        there = {item.nodeid: item for item in items}
        items[:] = [there[name] for name in self.limits if name in there]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """One test."""
        self.tell(at=item.nodeid)
        allow(self.limits[item.nodeid])
        return (yield)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """A file that cannot be read any more."""
        if report.failed:
            self.tell(at=report.nodeid)
            self.tell(how="errored", reason=str(report.longrepr)[-300:])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A test that fails."""
        if report.failed:
            self.tell(how="failed", reason=str(report.longrepr)[-300:])


def run_pytest(arguments: list[str], plugin: object) -> int:
    """The exit code of pytest, run on the tree."""
    os.chdir(ROOT)
    return int(pytest.main([*OPTIONS, *arguments], plugins=[plugin]))


def survey_tests(at_import: dict[str, set[int]], jobs: int, kept: dict[str, Any]) -> Covered:
    """Which tests run which lines; those that do not pass are left out. `kept` holds what an earlier run found, and takes over what is found."""

    def watch(file: Any, tell: Tell) -> None:
        lines = Lines()
        lines.start()
        run_pytest([file], Watching(lines, tell))

    there = sorted((ROOT / "tests").rglob("test_*.py"), key=lambda path: -path.stat().st_size)
    known = {str(path.relative_to(ROOT)): digest([path]) for path in there}
    waiting = [name for name, content in known.items() if kept.get(name, {}).get("content") != content]
    for done, (file, told, _) in enumerate(each(waiting, watch, jobs), 1):
        kept[file] = {"content": known[file], "told": told}
        print(f"tests watched: {done} of {len(waiting)} files", file=sys.stderr)
    covered = Covered(at_import=at_import)
    for file in known:
        collecting: dict[str, list[int]] = {}
        for fields in kept[file]["told"]:
            if "collecting" in fields:
                collecting = {f: sorted(set(n) - at_import.get(f, set())) for f, n in fields["collecting"].items()}
            elif fields.get("passed"):
                lines = fields["lines"]
                covered.add(fields["name"], fields["seconds"], {f: [*lines.get(f, ()), *collecting.get(f, ())] for f in {*lines, *collecting}})
    return covered


def trial_by_tests(mutant: Mutant, covered: Covered, budget: float) -> Trial:
    """The trial of a mutant by the tests that run it, the quickest first, as many as the budget allows."""
    chosen: list[int] = []
    numbers = covered.reaching(mutant)
    spent = 0.0
    for number in numbers:
        spent += covered.seconds[number]
        if spent > budget and chosen:
            break
        chosen.append(number)
    limits = tuple(SLOWER * covered.seconds[n] + AT_LEAST for n in chosen)
    return Trial(mutant, tuple(covered.names[n] for n in chosen), limits, len(numbers) - len(chosen))


def by_tests() -> Work:
    """The work of a process: a mutant, tried by tests until one notices it."""

    def work(tried: Trial, tell: Tell) -> None:
        sys.meta_path.insert(0, Mutated(tried.mutant))
        tell(at="collecting")
        allow(COLLECTING)
        wanted = sorted({name.partition("::")[0] for name in tried.names})
        if run_pytest(["-x", *wanted], Trying(tried, tell)) in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
            tell(how="missed")

    return work
