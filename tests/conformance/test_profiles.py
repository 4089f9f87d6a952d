"""The profiles of the releases are what was measured: `conformance/results/profiles.json`."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from scenic_ref.conformance import Ourselves, judge, load_vectors
from scenic_ref.conformance.measurements import Measurement, measurements
from scenic_ref.conformance.vector_files import read_file
from scenic_ref.semantics.readings import READINGS

OWN = Path(__file__).parents[2] / "tools" / "profile_vectors.toml"
FOUND = measurements()
LINES = {(id, profile): line for id, lines in FOUND.readings.items() for profile, line in lines.items()}
PROFILES = ("scenic-2.1", "scenic-3")


def vectors_of_the_tool():
    return read_file(OWN.name, OWN.read_text("utf-8"))


def test_every_reading_with_alternatives_was_measured_in_both_releases_or_it_says_why_not() -> None:
    assert list(FOUND.releases) == list(PROFILES)
    assert set(LINES) == {(r.id, profile) for r in READINGS.values() if not r.is_note for profile in PROFILES}
    assert not [key for key, line in LINES.items() if None in (line.command_line, line.api) and not line.why]
    assert not [key for key, line in LINES.items() if line.found and not line.vectors]


@pytest.mark.parametrize("profile", PROFILES)
def test_the_profile_has_the_alternative_that_was_measured_unless_the_line_says_why_not(profile: str) -> None:
    for id in FOUND.readings:
        line = LINES[id, profile]
        assert line.ours == READINGS[id].under(profile), id
        assert line.found <= READINGS[id].alternatives.keys(), id
        assert not line.differs or line.note, (id, line)


@pytest.mark.parametrize(
    ("command_line", "api", "told"),
    [("a", "a", ""), (None, "a", ""), (None, None, ""), ("b", "b", "Ours"), (None, "b", "Ours"), ("a", "b", "differ"), ("b", "c", "Ours")],
)
def test_what_differs_is_told(command_line: str | None, api: str | None, told: str) -> None:
    differs = Measurement(command_line, api, "a", ()).differs
    assert told in differs and bool(told) == bool(differs)


def test_the_vectors_that_were_run_are_there() -> None:
    known = {vector.name for vector in (*load_vectors(), *vectors_of_the_tool())}
    assert not {name for line in LINES.values() for name in line.vectors} - known


@pytest.mark.parametrize("name", [table["name"] for table in tomllib.loads(OWN.read_text("utf-8"))["vector"]])
def test_the_vectors_of_the_tool_pass_here(name: str) -> None:
    vector = next(vector for vector in vectors_of_the_tool() if vector.name == name)
    for profile in PROFILES:
        assert judge(Ourselves(), vector, profile).verdict.status == "passed", profile
