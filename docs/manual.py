"""Writes the manual page, in the language of `man`, from the same source as `--help`: `python docs/manual.py scenic-ref.1`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import scenic_ref
import typer
from scenic_ref.cli.app import EXIT_CODES, app
from typer.core import TyperCommand, TyperGroup

NAME = "scenic-ref"


def manual(application: typer.Typer = app) -> str:
    """Return the whole manual page."""
    group = cast(TyperGroup, typer.main.get_command(application))
    lines = [
        f'.TH {NAME.upper()} 1 "" "{NAME} {scenic_ref.__version__}" "User Commands"',
        ".SH NAME", f"{NAME} \\- {escape_roff(first_sentence(group.help))}",
        ".SH SYNOPSIS", f".B {NAME}", escape_roff("[OPTIONS] COMMAND [ARGUMENTS]"),
        ".SH OPTIONS", *options(group, NAME),
        ".SH COMMANDS",
    ]
    for name, command in group.commands.items():
        lines += [f".SS {escape_roff(f'{NAME} {name}')}", *paragraphs(command.help), *options(cast(TyperCommand, command), f"{NAME} {name}")]
    lines.append(".SH EXIT STATUS")
    for code, meaning in EXIT_CODES.items():
        lines += [".TP", f".B {code}", escape_roff(meaning)]
    lines += [
        ".SH ENVIRONMENT", ".TP", ".B NO_COLOR", "If it is set and not empty, nothing is written in colours.",
        ".TP", ".B COLUMNS", "The width of help and tables, in place of that of the terminal.",
    ]
    return "\n".join(lines) + "\n"


def options(command: TyperCommand | TyperGroup, name: str) -> Iterator[str]:
    """Each argument and option, with what its help says."""
    context = command.make_context(name, [], resilient_parsing=True)
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if record is not None:
            yield from (".TP", f".B {escape_roff(record[0])}", escape_roff(record[1]))


def paragraphs(text: str | None) -> Iterator[str]:
    """The paragraphs of a help text."""
    for part in (text or "").split("\n\n"):
        yield from (".PP", escape_roff(" ".join(part.split())))


def first_sentence(text: str | None) -> str:
    """Return the text before the first full stop."""
    return " ".join((text or "").split()).partition(". ")[0].rstrip(".")


def escape_roff(text: str) -> str:
    """A text in which nothing is a command of the language, in one line."""
    escaped = " ".join(text.split()).replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{escaped}" if escaped.startswith((".", "'")) else escaped


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(manual(), encoding="utf-8")
