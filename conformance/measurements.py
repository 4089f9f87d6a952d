"""Which alternative of each reading a user of a release gets: `conformance/results/profiles.json`, which `tools/measure_profiles.py` writes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files

SCHEMA = "scenic-ref/profiles/1"


@dataclass(frozen=True, slots=True)
class Measurement:
    """A reading in a release, by command line and by API: the alternative that it follows, None where it was not found, and ours.

    `vectors` were run; `why` says why none was found; `note` why ours is another, or what else is to be known.
    """

    command_line: str | None
    api: str | None
    ours: str
    vectors: tuple[str, ...]
    why: str = ""
    note: str = ""

    @property
    def found(self) -> set[str]:
        """The alternatives that were found."""
        return {way for way in (self.command_line, self.api) if way is not None}

    @property
    def differs(self) -> str:
        """How the release differs from itself or from us; nothing where it does not."""
        if self.found and self.ours not in self.found:
            return "Ours is another."
        return "Command line and API differ." if len(self.found) > 1 else ""


@dataclass(frozen=True, slots=True)
class Measurements:
    """All of them: the day, the versions by profile, and for each reading the measurements by profile."""

    date: str
    releases: Mapping[str, str]
    readings: Mapping[str, Mapping[str, Measurement]]


def measurements() -> Measurements:
    """Return the measurements that come with the package. Raises `ValueError` for a file of another schema."""
    found = json.loads(files("scenic_ref.conformance").joinpath("results", "profiles.json").read_text("utf-8"))
    if found["schema"] != SCHEMA:
        raise ValueError(f"profiles.json is {found['schema']}, and not {SCHEMA}")
    readings = {id: {profile: measurement(line) for profile, line in entry.items()} for id, entry in found["readings"].items()}
    return Measurements(found["date"], found["releases"], readings)


def measurement(line: Mapping[str, object]) -> Measurement:
    """One line of the file."""
    fields = {key.lower().replace(" ", "_"): tuple(value) if isinstance(value, list) else value for key, value in line.items()}
    return Measurement(**fields)  # type: ignore[arg-type]
