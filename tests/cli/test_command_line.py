"""What holds of all commands: completion, the version, help as wide as the terminal, no colours where none are wanted, the manual page."""

from __future__ import annotations

import importlib.util
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from scenic_ref.cli.app import EXIT_CODES, app
from scenic_ref.cli.session import console

ROOT = Path(__file__).parents[2]


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def said(*arguments: str, **environment: str) -> str:
    """Standard output of the command, in a process of its own."""
    where = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment}
    ran = subprocess.run([sys.executable, "-m", "scenic_ref", *arguments], env=where, capture_output=True, text=True, timeout=120)
    return ran.stdout


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_can_be_had_for_a_shell(shell: str) -> None:
    assert "_SCENIC_REF_COMPLETE" in said(_SCENIC_REF_COMPLETE=f"source_{shell}")


def test_completion_is_offered() -> None:
    """The shell itself is found out by the processes above this one, which a test does not choose."""
    assert "--install-completion" in said("--help") and "--show-completion" in said("--help")


def test_completion_completes_commands_and_options() -> None:
    answer = {"_SCENIC_REF_COMPLETE": "complete_bash", "COMP_CWORD": "1"}
    assert said(COMP_WORDS="scenic-ref che", **answer).split() == ["check"]
    answer["COMP_CWORD"] = "2"
    assert said(COMP_WORDS="scenic-ref check --str", **answer).split() == ["--strict"]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("run p.scenic --backend ", ["batch", "interpreter", "enumerate", "smc", "mcmc", "importance"]),
        ("run p.scenic --dialect sc", ["scenic-2.1", "scenic-3"]), ("run p.scenic --reading soft=", ["soft=run", "soft=scene"]),
        ("run p.scenic --model gta", ["gtaLib"]), ("simulate p.scenic --simulator k", ["kinematic"]), ("map --make cr", ["crossing"]),
        ("readings sof", ["soft"]), ("check p.scenic --format j", ["json"]), ("convert p.scenic --to pl", ["pldi19"]),
        ("run --profile pap", ["paper"]),
    ],
)
def test_completion_completes_what_options_take(typed: str, expected: list[str]) -> None:
    words = f"scenic-ref {typed}"
    found = said(_SCENIC_REF_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=str(len(words.split(" ")) - 1)).split()
    assert found[: len(expected)] == expected and len(found) <= len(expected) + 2


def test_the_version_has_a_short_option(ask) -> None:
    assert ask("-V").out == ask("--version").out != ""


def test_help_is_as_wide_as_the_terminal() -> None:
    widths = {columns: max(map(len, said("run", "--help", COLUMNS=str(columns)).splitlines())) for columns in (60, 160)}
    assert widths[60] <= 60 < 120 < widths[160] <= 160


def test_what_options_take_is_said_in_words() -> None:
    commands = getattr(typer.main.get_command(app), "commands")  # noqa: B009 (of a group alone)
    short = [(name, p.metavar) for name, c in commands.items() for p in c.params if p.metavar is not None and len(p.metavar) < 2]
    assert not short


@pytest.mark.parametrize(("value", "coloured"), [("1", False), ("", True), (None, True)])
def test_tables_have_no_colours_with_no_color(monkeypatch: pytest.MonkeyPatch, value: str | None, coloured: bool) -> None:
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    if value is not None:
        monkeypatch.setenv("NO_COLOR", value)
    stream = Terminal()
    console(stream).print("[bold red]x[/]", 3)
    assert ("\x1b" in stream.getvalue()) == coloured


def test_no_scenes_are_one_line(ask) -> None:
    Path("p.scenic").write_text("ego = Object\n")
    found = ask("run", "p.scenic", "-n", "0")
    assert (found.code, found.out, found.err.count("\n")) == (0, "", 1)
    assert "no scenes were asked for" in found.err


def manual() -> str:
    """The manual page."""
    found = importlib.util.spec_from_file_location("manual", ROOT / "docs" / "manual.py")
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module.manual()


def test_the_manual_page_has_every_command_option_and_exit_code() -> None:
    page = manual().replace("\\-", "-")
    for name, command in getattr(typer.main.get_command(app), "commands").items():  # noqa: B009
        part = page[page.index(f".SS scenic-ref {name}\n") :]
        assert all(option in part for parameter in command.params for option in parameter.opts if option.startswith("-"))
    assert all(f"\n.B {code}\n" in page for code in EXIT_CODES)


def test_the_manual_page_has_no_line_that_man_takes_for_a_command_by_mistake() -> None:
    known = (".TH ", ".SH ", ".SS ", ".B ", ".PP", ".TP")
    assert not [line for line in manual().splitlines() if line.startswith((".", "'")) and not line.startswith(known)]


def test_readings_without_a_dialect_have_the_profile_of_the_paper() -> None:
    assert "default: (paper)" in said("readings", "--help") and "that of the dialect" not in said("readings", "--help")
    assert "that of the dialect" in " ".join(said("run", "--help").split())
