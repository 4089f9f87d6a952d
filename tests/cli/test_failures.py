"""What is said, and with which exit code, when something is wrong."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from scenic_ref.cli import scene_run


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("run", "."), 2, "is a directory"),
        (("run", "missing.scenic"), 2, "there is no file missing.scenic"),
        (("run", "binary.scenic"), 2, "not a text file"),
        (("run", "ok.scenic", "-o", "missing/x.jsonl"), 2, "there is no directory"),
        (("run", "ok.scenic", "-o", "ok.scenic"), 2, "is the program itself"),
        (("run", "ok.scenic", "-o", "."), 2, "is a directory"),
        (("run", "ok.scenic", "--plot", "missing/x.png"), 2, "there is no directory"),
        (("run", "ok.scenic", "--plot", "x.gif"), 2, ".png, .pdf or .svg"),
        (("run", "ok.scenic", "--reading", "sof=run"), 2, "did you mean soft?"),
        (("run", "ok.scenic", "--reading", "soft=sometimes"), 2, "it has run, scene"),
        (("run", "ok.scenic", "--reading", "soft"), 2, "expects ID=ALT"),
        (("run", "ok.scenic", "--profile", "papers"), 2, "did you mean paper?"),
        (("run", "ok.scenic", "--dialect", "latin"), 2, "there is no dialect"),
        (("run", "ok.scenic", "--backend", "magic"), 2, "there is no backend magic"),
        (("run", "ok.scenic", "--resume"), 2, "-o PATH"),
        (("run", "ok.scenic", "--resume", "-o", "x.parquet"), 2, "cannot be resumed"),
        (("run", "ok.scenic", "--scene", "1", "-n", "2"), 2, "--scene draws a single scene"),
        (("run", "ok.scenic", "-n", "-1"), 2, "-n"),
        (("run", "ok.scenic", "--no-such-option"), 2, "--no-such-option"),
        (("run",), 2, "FILE"),
        (("rules", "S-SoftRek-Check"), 2, "did you mean S-SoftReq-Check?"),
        (("readings", "sof"), 2, "did you mean soft?"),
        (("run", "parse.scenic"), 1, "syntax error"),
        (("check", "parse.scenic"), 1, "syntax error"),
        (("run", "wrong.scenic"), 1, "program error"),
        (("check", "wrong.scenic"), 1, "program error"),
        (("trace", "wrong.scenic"), 1, "program error"),
        (("run", "endless.scenic", "--fuel", "1000"), 1, "endless loop"),
        (("run", "never.scenic", "--max-attempts", "7"), 3, "no scene in 7 attempts"),
        (("trace", "never.scenic", "--max-attempts", "7"), 3, "no scene in 7 attempts"),
    ],
)
def test_every_failure_has_its_exit_code_and_says_what_is_wrong(ask, arguments, code, message):
    Path("binary.scenic").write_bytes(b"\x00\xff\x01")
    Path("endless.scenic").write_text("while True:\n    pass\n")
    found = ask(*arguments)
    assert found.code == code
    assert message in found.err
    assert "{" not in found.out
    assert "Traceback" not in found.err


def test_a_full_disk_is_a_clear_error(ask):
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    found = ask("run", "ok.scenic", "-o", "/dev/full")
    assert found.code == 2
    assert "/dev/full cannot be written: No space left on device" in found.err


def test_a_fault_of_ours_asks_for_a_report_and_keeps_the_traceback_for_debug(ask, monkeypatch):
    def fail(*_: object) -> None:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr(scene_run, "check_paths", fail)
    found = ask("run", "ok.scenic", "--seed", 12)
    assert found.code == 4
    assert "internal error: ZeroDivisionError: oops" in found.err
    assert "the program ok.scenic and the seed 12" in found.err
    assert "Traceback" not in found.err
    for arguments in (("--debug", "run", "ok.scenic"), ("run", "ok.scenic", "--debug")):
        assert "Traceback" in ask(*arguments).err


def test_an_interrupt_has_exit_code_130(ask, monkeypatch):
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(scene_run, "check_paths", interrupt)
    found = ask("run", "ok.scenic")
    assert (found.code, found.out) == (130, "")
    assert found.err == "interrupted\n"


SYNTAX_ERROR = """\
syntax error: `=` assigns
 --> parse.scenic:2:21
  |
2 | require ego.heading = 3
  |                     ^
  = expected: the end of the line
  = hint: write `==` to compare
"""

RUN_ERROR = """\
program error: nosuch is not defined
 --> prints_then_fails.scenic:2:18
  |
2 | ego = Object at (nosuch, 0)
  |                  ^^^^^^
  = hint: assign it first, or import it; a text stands in quotation marks
  = rule: E-Variable (variables)
"""


def test_a_syntax_error_is_shown_with_its_line_what_was_expected_and_a_repair(ask):
    assert ask("run", "parse.scenic").err == SYNTAX_ERROR


def test_a_run_error_is_shown_with_its_line_and_rule(ask):
    assert ask("check", "prints_then_fails.scenic").err == RUN_ERROR


@pytest.mark.parametrize(
    ("text", "name", "line"),
    [
        ("ego = Object with behavior B\nbehavior B():\n    wait\n", "B", 2),
        ("ego = Object with size f(1)\n\ndef f(x):\n    return x\n", "f", 3),
        ("ego = Object at other offset by 0 @ 3\nother = Object\n", "other", 2),
    ],
)
def test_a_name_that_is_defined_below_is_told_with_its_line(ask, text, name, line):
    Path("below.scenic").write_text(text)
    told = ask("run", "below.scenic").err
    assert f"{name} is not defined" in told
    assert f"hint: it is defined below, on line {line}: move that above its first use" in told


def test_a_name_that_the_same_line_defines_has_the_usual_hint(ask):
    Path("same.scenic").write_text("ego = Object\nx, y = y, 3\n")
    assert "hint: assign it first" in ask("run", "same.scenic").err


def test_carets_stand_below_wide_characters_and_tabs(ask):
    Path("wide.scenic").write_text('if True:\n\tx = "漢字" + nosuch\n')
    lines = ask("run", "wide.scenic").err.splitlines()
    source, carets = lines[3].partition("| ")[2], lines[4].partition("| ")[2]
    assert source == '\tx = "漢字" + nosuch'
    assert carets == "\t" + " " * 13 + "^^^^^^"


def test_an_error_in_a_shipped_world_shows_the_line_of_the_program_and_says_where_in_the_world(ask):
    Path("world.scenic").write_text("model scenic.simulators.gta.model\nego = Car with model 3\n")
    told = ask("run", "world.scenic").err
    assert "world.scenic:2:7" in told.splitlines()[1]
    assert "of the library's module scenic.simulators.gta.model" in told


def test_exhausted_attempts_list_the_requirements_that_failed(ask):
    found = ask("run", "never.scenic", "--max-attempts", 9)
    assert "never.scenic:3: require x > 2" in found.err
    assert "        9  100%  the requirement on line 3" in found.err


def test_the_version_is_the_package_s(ask):
    from scenic_ref import __version__

    assert ask("--version") == (0, f"scenic-ref {__version__}\n", "")


def test_a_file_of_something_else_is_not_cut_off_by_resuming(ask):
    Path("other.jsonl").write_bytes(b"\x80\x04not a line of ours")
    found = ask("run", "ok.scenic", "--resume", "-o", "other.jsonl")
    assert found.code == 2 and "its line 1 is not a scene" in found.err
    assert Path("other.jsonl").read_bytes() == b"\x80\x04not a line of ours"
    for torn in (b"", b'{"sch', b'{"schema": "scenic-ref/scene/1", "seed": 0, "sce'):
        Path("torn.jsonl").write_bytes(torn)
        assert ask("run", "ok.scenic", "--resume", "-o", "torn.jsonl").code == 0
        assert Path("torn.jsonl").read_text() == ask("run", "ok.scenic").out


def test_a_folder_that_is_gone_and_a_closed_standard_error_are_no_internal_errors(ask, tmp_path):
    program = tmp_path / "ok.scenic"
    (tmp_path / "gone").mkdir()
    script = f"cd gone && rmdir ../gone && exec {sys.executable} -m scenic_ref run {program} -o x.jsonl"
    found = subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=False)
    assert (found.returncode, "x.jsonl cannot be written" in found.stderr) == (2, True)
    script = f"exec {sys.executable} -m scenic_ref run {program} 2>&-"
    found = subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout) == (0, ask("run", program).out)
