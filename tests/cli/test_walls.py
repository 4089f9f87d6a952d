"""The second wall: limits of memory and processor time, and a guard, for programs that nobody vouched for."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest
from scenic_ref.interpreter.runtime.limits import DEFAULT_LIMITS, Limits, bytes_of, seconds_of
from scenic_ref.interpreter.runtime.process_sandbox import RUNNING, WALL, guard_run
from scenic_ref.semantics.store.errors import UsageError

posix = pytest.mark.skipif(sys.platform == "win32", reason="this system has no limits of processes")
HOLE = """
import os, sys, socket, subprocess, ctypes, tempfile, shutil
from scenic_ref.semantics.python import builtins
from scenic_ref.semantics.machine.values import Native
from scenic_ref.cli import run_command_line
builtins.BUILTINS["hole"] = Native("hole", lambda: {deed})
sys.exit(run_command_line(sys.argv[1:]))
"""
DEEDS = {
    "write": "open('made', 'w')", "append": "open('p.scenic', 'a')", "low level": "os.open('made', os.O_CREAT | os.O_WRONLY)",
    "read": "open('/etc/passwd').read()", "read beside": "open('secret').read()", "remove": "os.remove('secret')",
    "rename": "os.rename('secret', 'made')", "shell": "os.system('touch made')", "process": "subprocess.run(['touch', 'made'])",
    "spawn": "os.posix_spawn('/bin/touch', ['touch', 'made'], {})", "fork": "os.fork()", "network": "socket.socket()",
    "name": "socket.getaddrinfo('localhost', 80)", "library": "ctypes.CDLL(None)", "list": "os.listdir('.')", "kill": "os.kill(os.getpid(), 9)",
    "folder": "os.mkdir('made')", "temporary": "tempfile.mkstemp(dir='.')", "tree": "shutil.rmtree('.')", "environment": "os.putenv('X', '1')",
    "link": "os.symlink('secret', 'made')", "chmod": "os.chmod('secret', 0)",
}  # fmt: skip


def command(folder: Path, text: str, *options: str, start: tuple[str, ...] = ("-m", "scenic_ref")) -> subprocess.CompletedProcess[str]:
    """The command `run` for a program, in a process of its own."""
    (folder / "p.scenic").write_text(text)
    return subprocess.run([sys.executable, *start, "run", "p.scenic", *options], cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.slow
@posix
@pytest.mark.parametrize("deed", DEEDS)
def test_a_hole_in_the_first_wall_leads_nowhere(deed, tmp_path):
    (tmp_path / "secret").write_text("the secret")
    made = HOLE.format(deed=DEEDS[deed])
    done = command(tmp_path, "x = hole()\nego = Object\nparam x = str(x)\n", start=("-c", made))
    assert done.returncode == 1, done.stderr
    assert "was kept from" in done.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["p.scenic", "secret"]
    assert (tmp_path / "secret").read_text() == "the secret"
    assert "the secret" not in done.stdout + done.stderr


@posix
def test_a_trusted_program_does_what_it_likes(tmp_path):
    done = command(tmp_path, "x = hole()\nego = Object\n", "--trust", start=("-c", HOLE.format(deed="open('made', 'w').close()")))
    assert (done.returncode, (tmp_path / "made").exists()) == (0, True), done.stderr


ENDLESS = "ego = Object at (0, 0)\nx = []\nwhile True: x = [x, 1]\n"


@pytest.mark.slow
@posix
@pytest.mark.parametrize("options", [(), ("-n", "20"), ("-n", "20", "--workers", "2"), ("--backend", "enumerate")], ids=" ".join)
def test_the_processor_time_of_a_run_is_limited(options, tmp_path):
    file = "x.json" if "enumerate" in options else "x.jsonl"
    done = command(tmp_path, ENDLESS, "--limit-seconds", "0.5", "--fuel", "1000000000", "-o", file, *options)
    assert done.returncode == 1
    assert "0.5 seconds of processor time" in done.stderr
    assert "--limit-seconds" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / file).exists() or not (tmp_path / file).read_bytes()


@pytest.mark.slow
@posix
def test_many_runs_may_take_longer_than_one(tmp_path):
    text = "ego = Object at (Range(0, 1), 0)\nx = sum([i for i in range(3000)])\nimport math\n"
    done = command(tmp_path, text, "-n", "150", "--backend", "interpreter", "--limit-seconds", "1")
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@posix
@pytest.mark.parametrize("options", [(), ("-n", "20"), ("-n", "20", "--workers", "2")], ids=" ".join)
def test_the_memory_of_a_program_is_limited(options, tmp_path):
    text = "ego = Object at (Range(0, 1), 0)\nx = [[0.5] * 1000000 for i in range(40)]\n"
    done = command(tmp_path, text, "--limit-memory", "128M", *options)
    assert done.returncode == 1, done.stderr
    assert "memory" in done.stderr
    assert "Traceback" not in done.stderr
    assert command(tmp_path, text, "--limit-memory", "none").returncode == 0


@pytest.mark.parametrize("command", ["run", "trace", "simulate", "check"])
def test_every_command_that_runs_programs_takes_limits(command):
    told = subprocess.run([sys.executable, "-m", "scenic_ref", command, "--help"], capture_output=True, text=True, check=True).stdout
    assert "--limit-memory" in told
    assert "--limit-seconds" in told


@pytest.mark.parametrize(("text", "size"), [
    ("16M", 16 << 20), ("4G", 4 << 30), ("4GiB", 4 << 30), ("4gb", 4 << 30), ("99999999", 99999999), ("none", None),
])  # fmt: skip
def test_sizes(text, size):
    assert bytes_of(text) == size


@pytest.mark.parametrize("text", ["", "x", "-1", "1", "1K", "G", "1e9", "١٦M", "9" * 40, "4GG", "nan"])
def test_sizes_that_are_none(text):
    with pytest.raises(UsageError, match="--limit-memory"):
        bytes_of(text)


@pytest.mark.parametrize("text", ["", "x", "-1", "0", "nan", "inf", "1e9"])
def test_times_that_are_none(text):
    with pytest.raises(UsageError, match="--limit-seconds"):
        seconds_of(text)


def test_the_api_has_no_wall_of_its_own():
    assert DEFAULT_LIMITS == (4 << 30, 60)
    assert not WALL.guarded


def test_what_a_program_runs_in_one_thread_is_no_fault_of_another():
    WALL.build(Limits(None, None))
    try:
        with ThreadPoolExecutor(2) as threads:
            met = Barrier(2)
            running = threads.submit(guard_run(lambda: (met.wait(60), met.wait(60))))
            met.wait(60)
            assert threads.submit(os.putenv, "SCENIC_REF_A_TEST", "1").result() is None
            met.wait(60)
            running.result()
        with pytest.raises(PermissionError, match=r"os\.putenv"):
            guard_run(os.putenv)("SCENIC_REF_A_TEST", "1")
    finally:
        WALL.open()


@posix
def test_the_guard_is_as_before_wherever_an_interrupt_comes():
    """What is caught holds the frames that it went through, as the commands do that finish their files after Ctrl-C."""
    outer, inner, caught, left = guard_run(lambda run: run()), guard_run(lambda: None), [], 0
    before = signal.getsignal(signal.SIGALRM)
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    WALL.build(Limits(None, 60))
    try:
        for number in range(300):
            try:
                signal.setitimer(signal.ITIMER_REAL, random.Random(number).uniform(1e-5, 2e-4), 1.0)  # again, where Python swallows it
                while True:
                    outer(inner)
            except KeyboardInterrupt as interrupt:
                signal.setitimer(signal.ITIMER_REAL, 0)
                caught.append(interrupt)
                left += RUNNING.depth + (signal.getitimer(signal.ITIMER_PROF)[0] > 0)
                RUNNING.depth = 0
    finally:
        WALL.open()
        signal.signal(signal.SIGALRM, before)
    assert (len(caught), left) == (300, 0)
