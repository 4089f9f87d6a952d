"""What takes too long is not begun again: by the machine what was compiled, or for a trace."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest

ENDLESS = {
    "simulate": "def f():\n    i = 0\n    while True: i = i + 1\nego = Object at (0, 0)\nrequire always f()\n",
    "trace --steps 3": "behavior B():\n    while True: x = 1\nego = Object at (0, 0), with behavior B\n",
    "trace": "while True: pass\nego = Object at (0, 0)\n",
}
LIMIT = 4


@pytest.mark.slow
@pytest.mark.parametrize("command", ENDLESS)
def test_the_limit_of_time_is_not_spent_twice(command: str, tmp_path: Path) -> None:
    (tmp_path / "p.scenic").write_text(ENDLESS[command])
    word, *options = command.split()
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    arguments = [word, "p.scenic", *options, "--limit-seconds", str(LIMIT)]
    done = subprocess.run([sys.executable, "-m", "scenic_ref", *arguments], cwd=tmp_path, capture_output=True, text=True, check=False)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    assert done.returncode == 1
    assert f"took {LIMIT} seconds of processor time without ending" in done.stderr
    assert spent < 2 * LIMIT  # the program takes four seconds, the command itself less than four


def test_a_file_without_an_end_is_too_large(tmp_path: Path) -> None:
    (tmp_path / "zero.scenic").symlink_to("/dev/zero")
    (tmp_path / "large.scenic").write_bytes(b"# a\n" * (5 << 20))
    for name in ("zero", "large"):
        command = [sys.executable, "-m", "scenic_ref", "check", f"{name}.scenic"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert f"{name}.scenic is too large: a Scenic program has at most 16 MiB" in done.stderr
