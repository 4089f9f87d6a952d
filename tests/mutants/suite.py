"""The test suite against mutants: which lines each test runs, and whether any test notices a change.

Python processes that a test starts have the mutant too, and their lines are seen unless they are killed.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from .changes import ROOT, Mutant
from .processes import Tell, Work, allow, each
from .results import digest
from .vectors import AT_LEAST, SLOWER, Covered, Trial
from .watching import Lines, left_in

OPTIONS = ("-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--assert=plain")
"""Assertions are left as they are: of a package with a plugin pytest loads the modules on its path itself, and the mutant would not be seen."""
BUDGET = 60.0
"""Seconds of processor time, as they were when the lines were watched, that the tests for one mutant may take together."""
COLLECTING = 120


class Watching:
    """A plugin that tells, for each test, which lines it runs, its seconds, and whether it passes."""

    def __init__(self, lines: Lines, folder: str, tell: Tell) -> None:
        self.lines = lines
        self.folder = folder
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
        before = os.times()
        found = yield
        took = sum(os.times()[:4]) - sum(before[:4])
        here, there = self.lines.take(), left_in(self.folder)
        self.tell(name=item.nodeid, seconds=took, lines={f: [*here.get(f, ()), *there.get(f, ())] for f in {*here, *there}}, passed=self.passed)
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


def for_started(variable: str, value: str) -> None:
    """Let the Python processes that this one starts load `started/sitecustomize.py`, with that variable."""
    os.environ[variable] = value
    paths = [str(Path(__file__).with_name("started")), os.environ.get("PYTHONPATH", "")]
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in paths if path)


def run_pytest(arguments: list[str], plugin: object) -> int:
    """The exit code of pytest, run on the tree."""
    os.chdir(ROOT)
    return int(pytest.main([*OPTIONS, *arguments], plugins=[plugin]))


def survey_tests(at_import: dict[str, set[int]], wanted: Sequence[str], jobs: int, kept: dict[str, Any], *, quick: bool = False) -> Covered:
    """Which tests run which lines, in files whose path contains one of the texts `wanted`; those that do not pass are left out.

    With `quick`, only those that are not marked slow. `kept` holds what an earlier run found, and takes over what is found.
    """

    def watch(file: Any, tell: Tell) -> None:
        with TemporaryDirectory() as folder:
            for_started("SCENIC_REF_LINES", folder)
            lines = Lines()
            lines.start()
            run_pytest([file, *chosen], Watching(lines, folder, tell))

    chosen = ("-m", "not slow") if quick else ()
    there = sorted((ROOT / "tests").rglob("test_*.py"), key=lambda path: -path.stat().st_size)
    paths = [str(path.relative_to(ROOT)) for path in there]
    known = {path: digest([ROOT / path]) + " ".join(chosen) for path in paths if any(text in path for text in wanted)}
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
        if not tried.names:  # pytest would collect all there are
            tell(how="missed")
            return
        finder = tried.mutant.finder()
        sys.meta_path.insert(0, finder)
        tell(at="collecting")
        allow(COLLECTING)
        wanted = sorted({name.partition("::")[0] for name in tried.names})
        with TemporaryDirectory() as folder:
            finder.keep(f"{folder}/mutant")
            for_started("SCENIC_REF_MUTANT", f"{folder}/mutant")
            if run_pytest(["-x", *wanted], Trying(tried, tell)) in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
                tell(how="missed")

    return work
