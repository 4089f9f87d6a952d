"""Wrong programs of the first hour (`first_hour.toml`): each message names the mistake, marks it, and offers a repair that works.

Run as a script it gives the score, a point for each of the three.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest
from scenic_ref.api import Scenario, loads
from scenic_ref.api.diagnostics import warnings_about
from scenic_ref.semantics.store.errors import ScenicError
from scenic_ref.semantics.syntax import Span

PROGRAMS = tomllib.loads(Path(__file__).with_name("first_hour.toml").read_text(encoding="utf-8"))["program"]


class Found(NamedTuple):
    """What is said of a program: the message, its place, the hint; all empty where nothing is."""

    message: str
    span: Span
    hint: str


def found(text: str) -> Found:
    """The first error of a program, else its first warning."""
    scenario: Scenario | None = None
    try:
        scenario = loads(text, file="p.scenic")
        scenario.sample(max_attempts=200)
    except ScenicError as error:
        return Found(error.message, error.span, error.hint)
    return next((Found(w.message, w.span, w.hint) for w in warnings_about(scenario)), Found("", Span("", 0, 0, 0, 0), ""))


def marked(text: str, span: Span) -> str | None:
    """The text under the caret, "" at the end of a line, None without a place."""
    lines = text.split("\n")
    if not 0 < span.line <= len(lines):
        return None
    return lines[span.line - 1][span.column - 1 : span.end_column - 1 if span.end_line == span.line else None].rstrip()


def points(program: dict[str, str]) -> tuple[bool, bool, bool]:
    """Whether the message names the mistake, the caret stands on it, and a repair is offered or evident."""
    said = found(program["text"])
    named = program["says"] in said.message
    return named, marked(program["text"], said.span) == program["at"], named and program["repair"] in f"{said.message}\n{said.hint}"


def test_no_program_stands_twice() -> None:
    assert len({program["text"] for program in PROGRAMS}) == len(PROGRAMS) >= 148


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program["text"].split("\n")[-2 if program["text"] else 0][:40])
def test_a_mistake_of_the_first_hour_is_named_marked_and_mended(program: dict[str, str]) -> None:
    assert points(program) == (True, True, True), found(program["text"])
    assert found(program["mended"]) == ("", ("", 0, 0, 0, 0), "")


if __name__ == "__main__":
    scores = [points(program) for program in PROGRAMS]
    for program, score in zip(PROGRAMS, scores, strict=True):
        print(sum(score), program["text"].encode("unicode_escape").decode())
    print(sum(map(sum, scores)), "of", 3 * len(PROGRAMS), "points: named", *(sum(s[i] for s in scores) for i in (0,)), end=", ")
    print("caret", sum(s[1] for s in scores), "repair", sum(s[2] for s in scores))
