"""The files of readings, read strictly: a misspelt key or a missing one is an error of ours, found at the first import."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Literal

PROFILES = ("paper", "formal", "prose", "scenic-2.1", "scenic-3")


@dataclass(frozen=True, slots=True)
class Probe:
    """A program that tells the alternatives of a reading apart; `shows` says, per alternative, exactly what it must show."""

    program: str
    shows: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A question that the paper leaves open, or answers twice.

    `alternatives` maps each alternative to what it means, the `paper` profile's first; `places` are those of the paper;
    `code` names the functions in which the choice is made; `profiles` lists the profiles that deviate from `paper`.
    `about` says what the reading decides: the scene, the policy (behaviors, monitors, scenarios while they run) or the
    pruning of the sample space. `code` is empty where the part that decides is not built yet.
    """

    id: str
    kind: Literal["conflict", "silence"]
    question: str
    places: tuple[str, ...]
    alternatives: Mapping[str, str]
    code: tuple[str, ...]
    consequence: str = ""
    about: Literal["scene", "policy", "pruning"] = "scene"
    profiles: Mapping[str, str] = field(default_factory=dict)
    probe: Probe | None = None

    @property
    def default(self) -> str:
        """The alternative of the `paper` profile."""
        return next(iter(self.alternatives))

    @property
    def is_note(self) -> bool:
        """Whether there is one answer only: a decision that is written down, not one that can be switched."""
        return len(self.alternatives) == 1

    def under(self, profile: str) -> str:
        """The alternative of a profile."""
        return self.profiles.get(profile, self.default)


FILES = (
    "conflicts", "conflicts_of_examples", "conflicts_of_policy",
    "silences", "silences_of_language", "silences_of_policy", "silences_of_scenarios", "second_look",
)  # fmt: skip
"""In the order of the catalogue."""
REQUIRED = {"kind": str, "about": str, "question": str, "places": list, "consequence": str, "code": list, "alternatives": dict}
OPTIONAL = {"profiles": dict, "probe": dict}
PROBE = {"program": str, "shows": dict}
CHOICES = {"kind": ("conflict", "silence"), "about": ("scene", "policy", "pruning")}


def load_readings() -> Mapping[str, Reading]:
    """All readings, by id. Raises `ValueError` for a file whose entries are not those of a `Reading`."""
    found: dict[str, Reading] = {}
    for name in FILES:
        text = files("scenic_ref.semantics.readings").joinpath(f"{name}.toml").read_text("utf-8")
        for reading in readings_in(text, f"{name}.toml"):
            if reading.id in found:
                raise ValueError(f"{name}.toml: the reading {reading.id} is there twice")
            found[reading.id] = reading
    return found


def readings_in(text: str, file: str) -> Iterator[Reading]:
    """The readings of one file. Raises `ValueError`."""
    for id, entry in tomllib.loads(text).items():
        place = f"{file}: [{id}]"
        check_entry(entry, REQUIRED, OPTIONAL, place)
        for key, known in CHOICES.items():
            if entry[key] not in known:
                raise ValueError(f"{place}: {key} is one of {', '.join(known)}, not {entry[key]}")
        texts(entry["places"], f"{place}: places")
        texts(entry["code"], f"{place}: code")
        alternatives, profiles = entry["alternatives"], entry.get("profiles", {})
        texts(alternatives.values(), f"{place}: alternatives")
        for profile, alternative in profiles.items():
            if profile not in PROFILES or alternative not in alternatives:
                raise ValueError(f"{place}: {profile} = {alternative} is not a profile with one of the alternatives")
        yield Reading(
            id=id, kind=entry["kind"], about=entry["about"], question=entry["question"], places=tuple(entry["places"]),
            consequence=entry["consequence"], code=tuple(entry["code"]), alternatives=alternatives, profiles=profiles,
            probe=probe_of(entry["probe"], alternatives, place) if "probe" in entry else None,
        )  # fmt: skip


def probe_of(entry: dict[str, object], alternatives: Mapping[str, str], place: str) -> Probe:
    """The probe of a reading, which says what each alternative shows. Raises `ValueError`."""
    check_entry(entry, PROBE, {}, f"{place}: probe")
    program, shows = entry["program"], entry["shows"]
    assert isinstance(program, str) and isinstance(shows, dict)
    texts(shows.values(), f"{place}: shows")
    if shows.keys() != alternatives.keys():
        raise ValueError(f"{place}: the probe shows {', '.join(shows)}, and the alternatives are {', '.join(alternatives)}")
    return Probe(program, shows)


def check_entry(entry: object, required: Mapping[str, type], optional: Mapping[str, type], place: str) -> None:
    """Raise `ValueError` unless the entry has all of these keys, no others, and values of these types."""
    if not isinstance(entry, dict):
        raise ValueError(f"{place} is not a table")
    missing, unknown = required.keys() - entry.keys(), entry.keys() - required.keys() - optional.keys()
    if missing or unknown:
        raise ValueError(f"{place}: missing {sorted(missing)}, unknown {sorted(unknown)}")
    for key, value in entry.items():
        kind = required.get(key) or optional[key]
        if not isinstance(value, kind):
            raise ValueError(f"{place}: {key} is a {kind.__name__}")


def texts(values: object, place: str) -> None:
    """Raise `ValueError` unless these are texts, none of them empty."""
    for value in values:  # type: ignore[attr-defined]
        if not isinstance(value, str) or not value:
            raise ValueError(f"{place}: {value!r} is not a text")

