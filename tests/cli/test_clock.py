"""The clock of a program: all that it causes is limited, and what its own process cannot stop, another one does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from scenic_ref.interpreter.runtime.supervisor import HEARING

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems have no such clocks")

SLOW = "class A(object):\n    def __repr__(self):\n        s = 0\n        for i in range(10 ** 5): s += 1\n        return 'a'\n"
LONG = {
    "parsing": "ego = Object\nx = " + "+".join(["[" + ",".join(["1"] * 60_000) + "]"] * 12),
    "writing a scene": SLOW + "ego = Object with foo [A() for i in range(300)]",
    "one run of the program": "ego = Object\nx = []\nwhile True: x = [x, 1]",
    "writing a simulation": SLOW + "scenario Main():\n    setup:\n        ego = new Object\n        record [A() for i in range(100)] as r",
}  # fmt: skip
STARTED = """
import itertools, sys, time, ctypes, os, signal
from scenic_ref.semantics.python import builtins
from scenic_ref.semantics.machine.values import Native
from scenic_ref import cli
builtins.BUILTINS["hole"] = Native("hole", lambda: {deed})
cli.main()
"""


def started(folder: Path, text: str, *options: str, deed: str = "None", what: str = "run") -> subprocess.Popen[str]:
    (folder / "p.scenic").write_text(text + "\n")
    command = [sys.executable, "-c", STARTED.format(deed=deed), what, "p.scenic", *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ended(*arguments: object, **options: object) -> tuple[int, str, float]:
    """The exit code, what was told, and the processor time that it took."""
    before = os.times()
    with started(*arguments, **options) as process:  # type: ignore[arg-type]
        _, told = process.communicate()
    after = os.times()
    return process.returncode, told, after.children_user + after.children_system - before.children_user - before.children_system


@pytest.mark.slow
@pytest.mark.parametrize("what", LONG)
def test_all_that_a_program_causes_is_limited(what, tmp_path):
    command, options = ("simulate", ["--steps", "3", "--dialect", "scenic-3"]) if what == "writing a simulation" else ("run", [])
    code, told, _ = ended(tmp_path, LONG[what], "--limit-seconds", "1.5", "--fuel", "1000000000", *options, what=command)
    assert code == 1, told
    assert "1.5 seconds of processor time" in told
    assert "Traceback" not in told and "internal error" not in told


@pytest.mark.slow
def test_a_call_that_never_comes_back_is_ended_from_outside(tmp_path):
    code, told, _ = ended(tmp_path, "x = hole()\nego = Object", "--limit-seconds", "1", deed="sum(itertools.repeat(1, 10 ** 11))")
    assert (code, "more than 1 seconds of processor time" in told, "--limit-seconds" in told) == (1, True, True), told


@pytest.mark.slow
def test_what_waits_for_ever_is_ended_by_the_clock(tmp_path):
    code, told, _ = ended(tmp_path, "x = hole()\nego = Object", "--limit-seconds", "0.1", deed="time.sleep(1000)")
    assert (code, "seconds on the clock" in told) == (1, True), told


def test_a_process_that_dies_is_an_internal_error(tmp_path):
    code, told, _ = ended(tmp_path, "x = hole()\nego = Object", deed="signal.raise_signal(signal.SIGSEGV) or time.sleep(9)")
    assert (code, "SIGSEGV" in told, "internal error" in told) == (4, True, True), told


@pytest.mark.parametrize(("deed", "limit", "expected"), [
    ("os._exit(127)", "1G", (1, "program error: the program needs more memory than it may have\n  = hint: --limit-memory allows more\n")),
    ("os._exit(127)", "none", (4, "internal error: the process that ran the program died (exit code 127)\n")),
    ("os.abort()", "1G", (4, "hint: if it died for want of memory, --limit-memory allows more")),
    ("os.abort()", "none", (4, "internal error: the process that ran the program died (SIGABRT)\n")),
])  # fmt: skip
def test_a_process_that_dies_for_want_of_memory_is_an_error_of_the_program(deed, limit, expected, tmp_path):
    """The dynamic linker ends a process with exit code 127; of a signal nobody can say whether a lack of memory was behind it."""
    code, told, _ = ended(tmp_path, "x = hole()\nego = Object", "--limit-memory", limit, deed=deed)
    assert (code, expected[1] in told, "--limit-memory" in told) == (expected[0], True, limit != "none"), told


def test_a_trusted_program_has_no_supervisor(tmp_path):
    code, _, _ = ended(tmp_path, "x = hole()\nego = Object", "--trust", deed="os.kill(os.getpid(), 9)")
    assert code == -9


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_reach_the_program(number, tmp_path):
    with started(tmp_path, "x = hole()\nego = Object", deed="os.write(1, b'now\\n') and time.sleep(100)") as process:
        assert process.stdout is not None and process.stdout.readline() == "now\n"
        process.send_signal(number)
        process.communicate()
    assert process.returncode == (130 if number == signal.SIGINT else -signal.SIGTERM)


def test_a_program_does_not_go_on_when_its_supervisor_is_killed(tmp_path):
    with started(tmp_path, "x = hole()\nego = Object", deed="os.write(1, b'%d\\n' % os.getpid()) and time.sleep(100)") as process:
        assert process.stdout is not None
        child = int(process.stdout.readline())
        assert child != process.pid
        process.kill()
        process.wait()
        while Path(f"/proc/{child}").exists() and "Z" not in Path(f"/proc/{child}/stat").read_text().split()[2]:
            time.sleep(0.01)


COUNTING = """
import sys
from scenic_ref.interpreter.runtime.supervisor import supervise

supervise(["run"])
word = "ready"
while True:
    try:
        print(word, flush=True)
        sys.stdin.readline()
        break
    except KeyboardInterrupt:
        word = "interrupted"
"""


@pytest.mark.parametrize("send", [os.kill, os.killpg])
def test_an_interrupt_reaches_the_program_once_whether_its_process_or_the_whole_group_gets_it(send):
    """A supervisor that sends on whatever it gets, as it must where it alone is told, would make two of one for the group."""
    command = [sys.executable, "-c", COUNTING]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        for _ in range(2):
            send(process.pid, signal.SIGINT)
            assert process.stdout.readline() == "interrupted\n"
            time.sleep(2 * HEARING)  # for a second one, which must not come
        assert process.communicate("\n")[0] == ""
        assert process.returncode == 0
