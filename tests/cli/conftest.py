"""The command line as a test calls it."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, NamedTuple

import pytest
from scenic_ref.cli import run_command_line

PROGRAMS = {
    "ok": "ego = Object at (0, 0)\n",
    "random": "x = Range(0, 1)\nego = Object at (x, 0), with width 1, with length 2\nother = Object at (5, Range(0, 3)), facing Range(-90, 90) deg\n"
    "require x > 0.3\nparam time = 7 * x\n",
    "never": "x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 2\n",
    "parse": "ego = Object at (0, 0)\nrequire ego.heading = 3\n",
    "wrong": 'ego = Object at (0, 0),\n    facing "north"\n',
    "soft": "x = Range(0, 1)\nego = Object at (0, 0), with v x\nrequire[0.5] x < 0.1\n",
    "prints": 'x = Range(0, 1)\nprint("x is", x)\nego = Object at (0, 0)\nrequire x > 0.5\n',
    "prints_then_fails": 'print("before")\nego = Object at (nosuch, 0)\n',
}


class Answer(NamedTuple):
    """The exit code, and what was said on standard output and standard error."""

    code: int
    out: str
    err: str


Ask = Callable[..., Answer]


@pytest.fixture
def ask(capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Ask:
    """Answers a command line, in a directory that holds the programs above."""
    for name, text in PROGRAMS.items():
        (tmp_path / f"{name}.scenic").write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def command(*arguments: object) -> Answer:
        code = run_command_line([str(a) for a in arguments])
        out, err = capfd.readouterr()
        return Answer(code, out, err)

    return command


class Started(subprocess.Popen):
    """A process in a group of its own, which is killed when the `with` is left."""

    stdout: IO[str]
    stderr: IO[str]

    def until(self, condition: Callable[[], bool]) -> None:
        """Wait until something is so, or the process has ended: how long that takes does not matter, but for ever is too long."""
        begun = time.monotonic()
        while not condition():
            assert time.monotonic() < begun + 300, "what is waited for does not come"
            with suppress(subprocess.TimeoutExpired):
                self.wait(0.001)
                return

    def __exit__(self, *of_exception: object) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        super().__exit__(*of_exception)  # type: ignore[arg-type]


Start = Callable[[Sequence[str]], Started]


@pytest.fixture
def start(tmp_path: Path) -> Start:
    """Starts a command in the directory of the test."""

    def command(arguments: Sequence[str]) -> Started:
        return Started(arguments, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)

    return command
