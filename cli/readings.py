"""`scenic-ref readings`: where the paper leaves a choice."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

import typer

from . import shell_completion
from .options import DebugOption, ReadingOption, pairs

if TYPE_CHECKING:
    from ..semantics.readings import Reading


def readings(
    name: Annotated[
        str | None, typer.Argument(metavar="ID", autocompletion=shell_completion.words(shell_completion.readings), help="The reading to explain.")
    ] = None,
    profile: Annotated[
        str | None,
        typer.Option(
            "--profile", metavar="PROFILE", autocompletion=shell_completion.words(shell_completion.profiles), show_default="paper",
            help="A profile of readings.",
        ),
    ] = None,
    reading: ReadingOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
    debug: DebugOption = False,
) -> None:
    """List the places where the paper leaves a choice.

    Of the alternatives, * marks the selected one; one in parentheses is the only one.
    """
    from ..semantics.readings import READINGS, select
    from .text_columns import columns

    selected = select(profile or "paper", dict(pairs(reading, "--reading", "ID=ALT")))
    found = list(READINGS.values()) if name is None else [READINGS[name]] if name in READINGS else []
    if not found:
        raise unknown_reading(str(name), tuple(READINGS))
    if as_json:
        print(json.dumps([reading_json(r, selected) for r in found], ensure_ascii=False, indent=2))
    elif name is not None:
        print("\n".join(explain_reading(found[0], selected[name])))
    else:
        rows = [(r.id, answers(r, selected[r.id]), r.question) for r in found]
        print("\n".join(columns(("id", "alternatives", "question"), rows)))


def answers(reading: Reading, selected: str) -> str:
    """The alternatives in a list."""
    return f"({selected})" if reading.is_note else " | ".join(f"{a}*" if a == selected else a for a in reading.alternatives)


def unknown_reading(name: str, known: tuple[str, ...]) -> Exception:
    """The error for an unknown id."""
    from ..semantics.store.errors import UsageError
    from ..semantics.store.suggestions import did_you_mean

    return UsageError(f"there is no reading {name}", hint=did_you_mean(name, known, "`scenic-ref readings` lists them"))


def reading_json(reading: Reading, selected: Mapping[str, str]) -> dict[str, object]:
    """A reading in JSON."""
    probe = None if reading.probe is None else {"program": reading.probe.program, "shows": dict(reading.probe.shows)}
    return {
        "id": reading.id, "kind": reading.kind, "about": reading.about, "question": reading.question, "places": list(reading.places),
        "alternatives": dict(reading.alternatives), "selected": selected[reading.id], "profiles": dict(reading.profiles),
        "consequence": reading.consequence, "code": list(reading.code), "probe": probe,
    }


def explain_reading(reading: Reading, selected: str) -> list[str]:
    """A reading in full: question, places, alternatives, profiles, consequence, code, probe."""
    from .text_columns import paragraph

    kinds = {"conflict": "the paper contradicts itself", "silence": "the formal rules are silent"}
    about = {"policy": "; it concerns behaviors and the policy", "pruning": "; it concerns pruning"}
    lines = [f"{reading.id} ({kinds.get(reading.kind, reading.kind)}{about.get(reading.about, '')})", "", *paragraph("question", reading.question)]
    for number, place in enumerate(reading.places):
        lines += paragraph("" if number else "places", place)
    lines.append("")
    for alternative, meaning in reading.alternatives.items():
        lines += paragraph(f"{'*' if alternative == selected else ' '} {alternative}", meaning or alternative)
    if reading.is_note:
        lines += ["", *paragraph("profiles", "a note: there is one answer, under every profile")]
    if reading.profiles:
        others = ", ".join(f"{profile}: {alternative}" for profile, alternative in reading.profiles.items())
        lines += ["", *paragraph("profiles", f"{others}; all others: {reading.default}")]
    if reading.consequence:
        lines += ["", *paragraph("consequence", reading.consequence)]
    lines += paragraph("code", ", ".join(reading.code))
    if reading.probe is not None:
        lines += ["", "A program that shows it:" if reading.is_note else "A program that tells the alternatives apart:", ""]
        lines += [f"    {line}" for line in reading.probe.program.strip().splitlines()]
        lines += ["", *(line for a, shows in reading.probe.shows.items() for line in paragraph(f"  {a}", shows))]
    return lines
