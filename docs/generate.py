"""Writes docs/reference/: the pages that are generated from the code, so that they cannot be out of date."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from scenic_ref.conformance import load_vectors
from scenic_ref.conformance.reports import shows
from scenic_ref.semantics.kernel import allowed
from scenic_ref.semantics.readings import PROFILES, READINGS, always_decided
from scenic_ref.semantics.rules import CATALOGUE

HERE = Path(__file__).parent / "reference"
COMMANDS = ("run", "simulate", "trace", "rules", "readings", "check", "conformance", "bench")
MOST_NAMED = 3


def cell(text: str) -> str:
    """Text inside a Markdown table."""
    return text.replace("|", "\\|").replace("\n", " ").replace("<", "&lt;")


def rules_page() -> str:
    """Every rule with its function and its test."""
    lines = [
        "# Rules, functions, tests", "",
        "Every inference rule, equation and algorithm of the paper, under the paper's own name; then what is "
        "inherited from Python. The last column names [vectors](../vectors.md) that fire the rule (or in which it refuses the program) and compare "
        "what comes out with what was worked out by hand; `scenic-ref conformance --vector NAME` runs one.", "",
        "| rule | the paper's name or left-hand side | place in the paper | function | vectors |", "| --- | --- | --- | --- | --- |",
    ]
    named_by: dict[str, list[str]] = {}
    for vector in load_vectors():
        for rule in shows(vector):
            named_by.setdefault(rule, []).append(vector.name)
    for rule in CATALOGUE:
        names = named_by.get(rule.id, ["tests/semantics/test_resolution.py"])
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        named = ", ".join(f"`{name}`" for name in names[:MOST_NAMED]) + more
        lines.append(f"| `{rule.id}` | {cell(rule.name)} | {cell(rule.place)} | `{rule.code}` | {named} |")
    return "\n".join(lines) + "\n"


def readings_page() -> str:
    """Every reading with its alternatives and profiles."""
    notes = sum(reading.is_note for reading in READINGS.values())
    decided = ", ".join(f"`{name}`" for name in always_decided())
    lines = [
        "# Readings", "",
        f"Where the paper contradicts itself or is silent: {len(READINGS)} places, of which {notes} are notes, with one answer that stands under "
        "every profile, and the others have alternatives. `--reading ID=ALTERNATIVE` selects one, `--profile` all.", "",
        "- `paper` (default) sets an equation aside only where a definition, a table or a drawn figure of the same paper contradicts it.",
        "- `formal` takes the formal rules to the letter in each place that has an alternative that does. These conflicts have none, and are decided "
        f"alike under every profile: {decided}.",
        "- `prose` lets the prose win; `scenic-2.1` and `scenic-3` do what the released implementations do.", "",
    ]
    for reading in READINGS.values():
        lines += [f"## `{reading.id}`", "", reading.question, ""]
        first = "" if reading.is_note else " (default)"
        lines += [f"- **`{name}`**{first if name == reading.default else ''}: {meaning}" for name, meaning in reading.alternatives.items()]
        deviating = {p: reading.under(p) for p in PROFILES if reading.under(p) != reading.default}
        if deviating:
            lines += ["", "Other profiles: " + ", ".join(f"`{p}`: `{a}`" for p, a in deviating.items()) + "."]
        if reading.consequence:
            lines += ["", reading.consequence]
        if reading.places:
            lines += ["", "In the paper: " + "; ".join(reading.places) + "."]
        if reading.probe is not None:
            lines += ["", "```scenic", reading.probe.program.strip(), "```", ""]
            lines += [f"- `{name}`: {shown}" for name, shown in reading.probe.shows.items()]
        lines.append("")
    return "\n".join(lines)


def allowed_page() -> str:
    """The table of what programs without `--trust` may ask of values."""
    lines = [
        "# What a program may ask for", "",
        "The values that a program meets without `--trust`, and the attributes and methods that it may ask each for; those of the types from which a "
        "type is derived are its own as well. See [running programs of others](../security.md).", "",
        "| type | attributes and methods |", "| --- | --- |",
    ]
    lines += [f"| `{type_.__name__}` | {' '.join(f'`{name}`' for name in sorted(known)) or '-'} |" for type_, known in allowed.ATTRIBUTES.items()]
    for title, known in (
        ("Builtins of Python", allowed.BUILTINS), ("Names that a class may define", allowed.OVERRIDES),
        ("Classes that a class may be derived from", {base.__name__ for base in allowed.BASES}),
    ):
        lines += ["", f"## {title}", "", " ".join(f"`{name}`" for name in sorted(known))]
    return "\n".join(lines) + "\n"


def commands_page() -> str:
    """What `--help` says, for every command."""
    lines = ["# Command line", ""]
    for command in ("", *COMMANDS):
        arguments = [sys.executable, "-m", "scenic_ref", *([command] if command else []), "--help"]
        shown = subprocess.run(
            arguments, check=True, capture_output=True, text=True, env={"PATH": "", "COLUMNS": "110", "NO_COLOR": "1", "TERM": "dumb"}
        ).stdout
        lines += [f"## `scenic-ref {command}`".rstrip(" `") + "`", "", "```text", shown.rstrip(), "```", ""]
    return "\n".join(lines)


def main() -> None:
    """Write all pages."""
    HERE.mkdir(exist_ok=True)
    (HERE / "rules.md").write_text(rules_page())
    (HERE / "readings.md").write_text(readings_page())
    (HERE / "commands.md").write_text(commands_page())
    (HERE / "allowed.md").write_text(allowed_page())


if __name__ == "__main__":
    main()
