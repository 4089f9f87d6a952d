"""What holds for the whole suite: nothing is skipped but for a missing extra, no test depends on the clock, and what a test starts ends with it.

`@pytest.mark.extra("fast")` says which extra a test needs, and stands also among the `marks` of a single parameter.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import time
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from scenic_ref.interpreter.runtime.optional_packages import EXTRAS, is_installed

PACKAGE_OF = {extra: package for package, extra in EXTRAS.items()}
REASON = "needs the extra "
REASONS = (REASON, "this system has no ")
PROBLEMS = pytest.StashKey[list[str]]()
SECONDS = pytest.StashKey[Counter[str]]()
RUN = "SCENIC_REF_TEST_RUN"
"""The variable by which processes that tests started, and those that they started, are known."""
ENDING = 60
"""Seconds that a process which was told to end may still take at the end of the run."""

settings.register_profile("whatever the clock says", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("whatever the clock says")


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--seconds`: what the tests of each folder took; `--share`: a part of the tests."""
    parser.addoption("--seconds", action="store_true", help="tell what the tests of each folder took of the processor, with what they started")
    parser.addoption("--share", type=share, metavar="K/N", help="of N shares of the tests only number K, from 0 on; together they are all tests")


def share(text: str) -> tuple[int, int]:
    """Which share of how many. Raises `ValueError`."""
    number, _, of = text.partition("/")
    if not 0 <= int(number) < int(of):
        raise ValueError
    return int(number), int(of)


def pytest_configure(config: pytest.Config) -> None:
    """The marker; a list of what is wrong with the run as a whole; a mark on all that it, or this worker of it (`pytest -n 2`), starts."""
    config.addinivalue_line("markers", "extra(name): the test needs the packages of this extra of scenic-ref")
    config.addinivalue_line("markers", "slow: the test takes long, and is left to `make test-all`")
    config.addinivalue_line("markers", "sampled(n): of the cases of the test only every n-th is quick, the others are slow")
    config.stash[PROBLEMS] = []
    config.stash[SECONDS] = Counter()
    os.environ[RUN] = str(os.getpid())
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in the background of a shell: what tests start, and interrupt, would ignore it too
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Of a test that is sampled, all cases but some are slow; before those that are asked for are chosen. Then the share of them."""
    cases: Counter[str] = Counter()
    for item in items:
        mark = item.get_closest_marker("sampled")
        if mark is not None:
            name = item.nodeid.partition("[")[0]
            if cases[name] % mark.args[0]:
                item.add_marker("slow")
            cases[name] += 1
    if (wanted := config.getoption("--share")) is not None:
        number, of = wanted
        shares = [zlib.crc32(item.nodeid.encode()) % of for item in items]
        config.hook.pytest_deselected(items=[item for item, its in zip(items, shares, strict=True) if its != number])
        items[:] = [item for item, its in zip(items, shares, strict=True) if its == number]


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Take over what a worker of the run found wrong; one that crashed has told nothing, and its test failed."""
    told = getattr(node, "workeroutput", {})
    node.config.stash[PROBLEMS] += told.get("problems", [])
    node.config.stash[SECONDS].update(told.get("seconds", {}))


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test that needs an extra which is not installed."""
    for mark in item.iter_markers("extra"):
        if not is_installed(PACKAGE_OF[mark.args[0]]):
            pytest.skip(REASON + mark.args[0])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """Note what a test takes, with its fixtures and the processes that it started and waited for."""
    begun = sum(os.times()[:4])
    try:
        return (yield)
    finally:
        folder = item.path.relative_to(Path(__file__).parent).parts[0]
        item.config.stash[SECONDS][folder] += sum(os.times()[:4]) - begun  # type: ignore[assignment]
        walls = sys.modules.get("scenic_ref.interpreter.runtime.process_sandbox")
        if walls is not None and walls.WALL.guarded:
            walls.WALL.open()
            item.config.stash[PROBLEMS].append(f"{item.nodeid} left this process limited and guarded, as `run` makes it")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """A test that is skipped for another reason is one that nobody runs."""
    report: pytest.TestReport = yield  # pyright: ignore[reportAssignmentType]
    if report.skipped and call.excinfo is not None and not str(call.excinfo.value).startswith(REASONS):
        item.config.stash[PROBLEMS].append(f"{item.nodeid} was skipped, and not for an extra: {call.excinfo.value}")
    return report  # pyright: ignore[reportReturnType]


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """What the tests started is gone, or the run fails; then it is ended here."""
    problems = session.config.stash[PROBLEMS]
    problems += [f"a process is left: {process}" for process in ended_here()]
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput |= {  # pyright: ignore[reportAttributeAccessIssue]
            "problems": problems, "seconds": dict(session.config.stash[SECONDS]),
        }
    elif problems and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Tell what was wrong with the run as a whole."""
    for problem in config.stash[PROBLEMS]:
        terminalreporter.write_line(f"FAILED {problem}", red=True)
    if any("no Coq" in str(report.longrepr) for report in terminalreporter.stats.get("skipped", ())):
        terminalreporter.write_line("no proof was checked and no tie to the program run: they need Coq 8.16 (Debian: apt-get install coq)")
    if config.getoption("--seconds"):
        seconds = config.stash[SECONDS]
        for folder, taken in sorted(seconds.items()):
            terminalreporter.write_line(f"{taken:7.0f} s  {folder}")
        terminalreporter.write_line(f"{sum(seconds.values()):7.0f} s of the processor in all")


def ended_here() -> Iterator[str]:
    """The processes that tests of this run started and that do not end, each with its test and command; they are killed. Nothing without /proc."""
    for number in started_by_tests():
        with suppress(OSError):
            handle = os.pidfd_open(number)
            try:
                if select.select([handle], [], [], ENDING)[0]:
                    continue
                test, command = variables(number).get("PYTEST_CURRENT_TEST", "?"), content(number, "cmdline")
                os.kill(number, signal.SIGKILL)
                yield f"{command.replace(bytes(1), b' ').decode(errors='replace').strip()} (started by {test})"
            finally:
                os.close(handle)


def started_by_tests() -> list[int]:
    """The numbers of other processes that this one started or that carry the mark of this run; not multiprocessing's own, which ends with it."""
    if not hasattr(os, "pidfd_open") or not Path("/proc").is_dir():
        return []
    found = [int(p.name) for p in Path("/proc").iterdir() if p.name.isdigit() and int(p.name) != os.getpid()]
    started = [n for n in found if parent(n) == os.getpid() or variables(n).get(RUN) == os.environ[RUN]]
    return [n for n in started if b"resource_tracker" not in content(n, "cmdline")]


def content(number: int, name: str) -> bytes:
    """A file that the system has of a process; empty if the process is gone, or another's."""
    try:
        return Path(f"/proc/{number}/{name}").read_bytes()
    except OSError:
        return b""


def parent(number: int) -> int:
    """The process that started this one, also where it does not have its own variables and command yet; 0 if it is gone."""
    fields = content(number, "stat").rpartition(b")")[2].split()
    return int(fields[1]) if fields else 0


def variables(number: int) -> dict[str, str]:
    """The environment that a process was started with; empty if it is gone, or another's."""
    text = content(number, "environ").decode(errors="replace")
    return dict(entry.split("=", 1) for entry in text.split("\0") if "=" in entry)


# Processor time


def calculation() -> int:
    """A fixed piece of work, of the kind that the reference does: about a tenth of a second."""
    found: dict[str, int] = {}
    for number in range(400_000):
        key = str(number * number % 9973)
        found[key] = found.get(key, 0) + len(key)
    return sum(found.values())


def seconds_of(action: Callable[[], object]) -> float:
    """The processor time of this thread: what other tests left running, here or as processes that end now, does not count."""
    before = time.thread_time()
    action()
    return time.thread_time() - before


@pytest.fixture
def effort() -> Callable[[Callable[[], object]], float]:
    """Gives how many times as much processor time a call takes as a fixed calculation that is made before and after it.

    Neither other processes nor a slow machine change it much, so that a limit on it says something about the program.
    """

    def measured(action: Callable[[], object]) -> float:
        before = seconds_of(calculation)
        took = seconds_of(action)
        return took / max(before, seconds_of(calculation), 1e-3)

    return measured
