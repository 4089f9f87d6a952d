"""What a program says, and what its names and files are called, never steers the terminal; what it links to is not told."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console
from scenic_ref.cli import run_command_line, scene_outputs
from scenic_ref.cli.error_messages import render
from scenic_ref.cli.session import escape_controls
from scenic_ref.semantics.store.errors import RunError
from scenic_ref.semantics.syntax.nodes import Span

ESC = "\x1b]0;owned\x07\x1b[2J"
CONTROL = [chr(n) for n in (*range(9), *range(11, 32), *range(127, 160))] + ["\u202e", "\u2066", "\u2028"]
PROGRAMS = {
    "print": f"print('{ESC}')\nego = Object\n",
    "error": f"ego = Object\nraise ValueError('{ESC}')\n",
    "source": f"ego = Object\nx = nosuch  # {ESC}\n",
    "parse": f"ego = = Object  # {ESC}\n",
    "requirement": f"x = Range(0, 1)\nego = Object\nrequire x > 2  # {ESC}\n",
    "parameter": f"ego = Object\nparam p = '{ESC}', q = '\\x1b[31m'\n",
    "name": f"ego = Object with name '{ESC}'\n",
}
MOST = ("--max-attempts", "5")
COMMANDS = [("run", *MOST), ("run", "-n", "12", *MOST), ("trace", *MOST), ("trace", "--all", *MOST), ("check",), ("simulate", "--steps", "1", *MOST)]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
@pytest.mark.parametrize("name", PROGRAMS)
def test_no_control_character_is_told(name, command, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    path = f"{ESC.replace('/', '')}{name}.scenic"
    Path(path).write_text(PROGRAMS[name])
    run_command_line([command[0], path, *command[1:]])
    out, err = capfd.readouterr()
    assert not [c for c in CONTROL if c in err]
    assert not [c for c in CONTROL if c in out]


def test_a_table_on_a_terminal_has_no_control_character():
    made = {
        "seed": 0, "scene": 0, "params": {"p": ESC}, "ego": 0,
        "objects": [{"id": 0, "name": ESC, "class": "C" + ESC, "position": [0, 0], "heading": 0, "width": 1, "length": 1}],
    }  # fmt: skip
    shown = io.StringIO()
    Console(file=shown, no_color=True, force_terminal=False, width=200).print(scene_outputs.table_of(made))
    assert not [c for c in CONTROL if c in shown.getvalue()]
    assert "\\x1b]0;owned" in shown.getvalue()


def test_our_colours_stay_and_others_are_shown():
    error = RunError(f"no{ESC}", Span("f\x1b[2J", 1, 5, 1, 6), hint="h\x1b[2J")
    shown = render(error, {"f\x1b[2J": "a = \x1b[31mb"}, colours=True)
    assert shown.startswith("\x1b[1;31m")
    assert not [found for found in ("\x1b[2J", "\x1b]0", "\x1b[31m") if found in shown]
    assert shown.count("\\x1b") == 5


def test_carets_stand_below_what_is_shown():
    error = RunError("no", Span("f", 1, 3, 1, 4))
    lines = render(error, {"f": "\x1b\x1bx = 1"}).splitlines()
    assert lines[-1].index("^") == lines[-2].index("x = 1")


def test_ordinary_text_stays():
    assert escape_controls("naïve\tx\nÄ 字 👩‍🚀") == "naïve\tx\nÄ 字 👩‍🚀"


# Links


@pytest.mark.parametrize("text", ["import away", "from away import x", "from .away import *", "model away"])
def test_of_a_file_behind_a_link_that_is_no_program_only_the_name_is_told(text, tmp_path, monkeypatch, capfd):
    (tmp_path / "secret.txt").write_text("root:x:0:secret\n")
    inside = tmp_path / "inside"
    inside.mkdir()
    (inside / "away.scenic").symlink_to(tmp_path / "secret.txt")
    (inside / "p.scenic").write_text(f"{text}\nego = Object\n")
    monkeypatch.chdir(inside)
    assert run_command_line(["run", "p.scenic"]) == 1
    _, err = capfd.readouterr()
    assert "away is a link to a file outside the program's folder" in err
    assert "root" not in err and "secret" not in err


def test_a_program_behind_a_link_is_imported(tmp_path, monkeypatch, capfd):
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "lib.scenic").write_text("x = 3\n")
    (inside / "away.scenic").symlink_to(tmp_path / "lib.scenic")
    (inside / "p.scenic").write_text("from away import x\nfrom ..lib import *\nego = Object with v x\n")
    monkeypatch.chdir(inside)
    assert run_command_line(["run", "p.scenic"]) == 0


# Two processes


def test_a_file_that_another_process_writes_is_refused_and_left_alone(tmp_path, monkeypatch, capfd):
    fcntl = pytest.importorskip("fcntl", reason="this system has no locks on files")
    monkeypatch.chdir(tmp_path)
    Path("p.scenic").write_text("ego = Object at (Range(0, 1), 0)\n")
    for command in (["run", "p.scenic", "-n", "3"], ["run", "p.scenic", "-n", "3", "--resume"], ["simulate", "p.scenic"]):
        Path("x.jsonl").write_text("precious\n")
        with open("x.jsonl") as other:
            fcntl.flock(other, fcntl.LOCK_EX)
            assert run_command_line([*command, "-o", "x.jsonl"]) == 2
        assert "x.jsonl is being written by another process" in capfd.readouterr().err
        assert Path("x.jsonl").read_text() == "precious\n"
    assert run_command_line(["run", "p.scenic", "-n", "3", "-o", "x.jsonl"]) == 0


@pytest.mark.slow
def test_a_process_that_is_killed_gives_its_file_back(tmp_path):
    (tmp_path / "p.scenic").write_text("ego = Object at (Range(0, 1), 0)\n")
    command = [sys.executable, "-m", "scenic_ref", "run", "p.scenic", "-o", "x.jsonl", "-n"]
    with subprocess.Popen([*command, "100000000"], cwd=tmp_path, stderr=subprocess.DEVNULL, env={**os.environ}) as first:
        try:
            while first.poll() is None and not ((tmp_path / "x.jsonl").exists() and (tmp_path / "x.jsonl").stat().st_size):
                pass
            second = subprocess.run([*command, "5"], cwd=tmp_path, capture_output=True, text=True, check=False)
        finally:
            first.kill()
    assert (second.returncode, second.stderr.count("another process")) == (2, 1)
    assert (tmp_path / "x.jsonl").read_bytes().count(b"\n") > 100
    subprocess.run([*command, "5"], cwd=tmp_path, capture_output=True, check=True)
    assert (tmp_path / "x.jsonl").read_bytes().count(b"\n") == 5
