"""What users rely on stays as it is: the names that can be imported with their signatures, the help of each command, the exit codes.

A change that is meant is recorded anew by `python tests/test_public_interface.py`; the lines of `public_interface.json` that change belong into
the changelog.
"""

from __future__ import annotations

import importlib
import inspect
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

RECORDED = Path(__file__).with_name("public_interface.json")
MODULES = ("scenic_ref", "scenic_ref.compat", "scenic_ref.conformance", "scenic_ref.errors", "scenic_ref.testing")
COMMANDS = (
    "", "run", "simulate", "trace", "play", "rules", "readings", "check", "convert", "diff", "fuzz", "conformance", "map", "bench", "lsp",
)  # fmt: skip
EXITS = {
    "a scene": ("run", "ego = Object\n"),
    "a program error": ("run", "ego = Object at nowhere\n"),
    "a syntax error": ("check", "ego = = Object\n"),
    "a warning": ("check --strict", "ego = Object with colour 3, with color 4\nx = 3 deg\nego.heigth\n"),
    "wrong usage": ("run --backend no", "ego = Object\n"),
    "attempts exhausted": ("run --max-attempts 5", "ego = Object\nrequire Range(0, 1) > 2\n"),
}


def signatures(module: object) -> Iterator[tuple[str, str]]:
    """The public names of a module, or of a class, with their signatures."""
    for name in sorted(getattr(module, "__all__", None) or (n for n in dir(module) if n.isidentifier() and not n.startswith("_"))):
        value = getattr(module, name)
        if getattr(value, "__module__", "scenic_ref").partition(".")[0] != "scenic_ref":
            continue
        if inspect.isclass(value):
            yield name, "class"
            if not issubclass(value, BaseException):
                yield from ((f"{name}.{inner}", text) for inner, text in signatures(value))
        elif callable(value):
            yield name, str(inspect.signature(value))
        else:
            yield name, "property" if isinstance(value, property) else type(value).__name__


def of_module(name: str) -> dict[str, str]:
    """The public names of a module of the package."""
    return dict(signatures(importlib.import_module(name)))


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """The command line, with a hundred columns."""
    environment = {**os.environ, "COLUMNS": "100", "NO_COLOR": "1"}
    return subprocess.run([sys.executable, "-m", "scenic_ref", *arguments], check=False, capture_output=True, text=True, env=environment)


def help_of(command: str) -> list[str]:
    """The lines of a command's help."""
    return run(*([command] if command else []), "--help").stdout.splitlines()


def exit_code(name: str) -> int:
    """How a command line about a program ends."""
    command, text = EXITS[name]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "program.scenic"
        file.write_text(text)
        return run(*command.split(), str(file)).returncode


def recorded() -> dict[str, dict[str, object]]:
    return json.loads(RECORDED.read_text("utf-8"))


@pytest.mark.parametrize("name", MODULES)
def test_the_public_names_are_those_that_were_recorded(name: str) -> None:
    assert of_module(name) == recorded()["modules"][name]


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_is_what_was_recorded(command: str) -> None:
    assert help_of(command) == recorded()["help"][command]


@pytest.mark.parametrize("name", EXITS)
def test_the_exit_code_is_what_was_recorded(name: str) -> None:
    assert exit_code(name) == recorded()["exits"][name]


if __name__ == "__main__":
    found = {
        "modules": {name: of_module(name) for name in MODULES},
        "help": {command: help_of(command) for command in COMMANDS},
        "exits": {name: exit_code(name) for name in EXITS},
    }
    RECORDED.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", "utf-8")
