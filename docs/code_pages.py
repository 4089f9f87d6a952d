"""The pages of what the code says of itself: commands with their options, and what programs make regions, fields and distributions with."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator
from typing import cast

import typer
from scenic_ref.cli.app import EXIT_CODES, app
from scenic_ref.semantics.python.builtins import CONSTRUCTORS, GEOMETRY
from scenic_ref.semantics.space.regions import Region
from typer.core import TyperCommand, TyperGroup

WIDTH = 100  # the longest line, but for tables and code
COLUMN = 80  # what fits beside the table of contents on a laptop
MARK, JOIN = re.compile(r"\s+(?=([-+*>#]+|\d+[.)])(\s|$))"), "\0"
"""The space before what would be a mark of Markdown at the beginning of a line, and what stands for it while lines are broken."""


def cell(text: str) -> str:
    """Text inside a Markdown table."""
    return text.replace("|", "\\|").replace("\n", " ").replace("<", "&lt;")


def paragraph(text: str, lead: str = "", more: str = "") -> str:
    """A paragraph in lines that are not too long; the first begins with `lead`, the others with `more`. No line begins like an entry of a list."""
    joined = MARK.sub(JOIN, text)
    filled = textwrap.fill(joined, WIDTH, initial_indent=lead, subsequent_indent=more, break_long_words=False, break_on_hyphens=False)
    return filled.replace(JOIN, " ")


def commands_page(application: typer.Typer = app) -> str:
    """Return the help of the application, its commands with their pages, and the exit codes."""
    (_, text), *commands = helps_of(application)
    lines = ["# Command line", "", "```text", text, "```", "", "| command | what it does |", "| --- | --- |"]
    lines += [f"| [`{name}`]({page_of(name)}) | {cell(first_words(text))} |" for name, text in commands]
    lines += ["", "## Exit codes", "", "| code | meaning |", "| --- | --- |", *(f"| {code} | {cell(text)} |" for code, text in EXIT_CODES.items())]
    return "\n".join(lines) + "\n"


def command_pages(application: typer.Typer = app) -> dict[str, str]:
    """A page for each command: what its `--help` says."""
    _, *commands = helps_of(application)
    return {page_of(name): f"# `{name}`\n\n```text\n{text}\n```\n\n[All commands](../commands.md)\n" for name, text in commands}


def first_words(text: str) -> str:
    """Return the first paragraph below the usage of a command, which says what it does."""
    return " ".join(text.split("\n\n")[1].split())


def page_of(name: str) -> str:
    """The place of a command's page."""
    return f"commands/{name.partition(' ')[2].replace(' ', '-')}.md"


def helps_of(application: typer.Typer) -> list[tuple[str, str]]:
    """Return the help of the application, then of each of its commands."""
    return list(helps(cast(TyperGroup, typer.main.get_command(application)), "scenic-ref"))  # typer draws them from click, or a copy of it


def helps(command: TyperCommand | TyperGroup, name: str) -> Iterator[tuple[str, str]]:
    """The name and the `--help` text of a command, then those of its commands."""
    context = command.make_context(name, [], resilient_parsing=True, terminal_width=COLUMN, max_content_width=COLUMN)
    yield name, command.get_help(context)
    for inner, found in getattr(command, "commands", {}).items():
        yield from helps(found, f"{name} {inner}")


def constructors_page() -> str:
    """Every region, field and distribution that a program can make: how it is called, what it is, and an example."""
    lines = ["# Regions, fields and distributions", "", "Lengths are in metres, headings in radians to the left of North (`30 deg` writes degrees)."]
    lines += ["", "## Regions and fields"]
    for constructor in sorted(made_by_programs(), key=lambda one: one.__name__):
        parameters = [one.replace(annotation=inspect.Parameter.empty) for one in inspect.signature(constructor).parameters.values()]
        lines += constructor_section(f"{constructor.__name__}{inspect.Signature(parameters)}".replace("<everywhere>", "everywhere"), constructor)
    lines += ["", "## Distributions"]
    for name, constructor in CONSTRUCTORS.items():
        if not name.startswith("Verifai"):
            lines += constructor_section(f"{name}({constructor.takes})", constructor.make)
    return "\n".join(lines) + "\n"


def made_by_programs() -> list[type]:
    """The classes of regions and fields."""
    return [found for found in GEOMETRY.values() if isinstance(found, type) and found is not Region]


def constructor_section(call: str, made: object) -> Iterator[str]:
    """The docstring of what a call makes, which ends with an example, as a section."""
    text, _, example = (inspect.getdoc(made) or "").rpartition("\n\nExample: ")
    paragraphs = [paragraph(" ".join(part.split())) for part in text.split("\n\n")]
    yield from ("", f"### {call.partition('(')[0]}", "", "```python", call, "```", "", "\n\n".join(paragraphs))
    yield from ("", "```scenic", example.strip().strip("`"), "```")
