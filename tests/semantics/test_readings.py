"""The registry of readings: complete, consistent, and resolvable to code."""

from __future__ import annotations

from importlib import import_module

import pytest
from scenic_ref.interpreter.parser import parse
from scenic_ref.semantics.errors import UsageError
from scenic_ref.semantics.readings import PROFILES, READINGS, Reading, select
from scenic_ref.semantics.readings.conflicts import CONFLICTS
from scenic_ref.semantics.readings.conflicts_of_examples import CONFLICTS_OF_EXAMPLES
from scenic_ref.semantics.readings.conflicts_of_policy import CONFLICTS_OF_POLICY
from scenic_ref.semantics.readings.second_look import SECOND_LOOK
from scenic_ref.semantics.readings.silences import SILENCES
from scenic_ref.semantics.readings.silences_of_language import SILENCES_OF_LANGUAGE
from scenic_ref.semantics.readings.silences_of_policy import SILENCES_OF_POLICY
from scenic_ref.semantics.readings.silences_of_scenarios import SILENCES_OF_SCENARIOS

TABLES = (
    CONFLICTS, CONFLICTS_OF_EXAMPLES, CONFLICTS_OF_POLICY, SILENCES, SILENCES_OF_LANGUAGE, SILENCES_OF_POLICY, SILENCES_OF_SCENARIOS, SECOND_LOOK,
)
ALL = pytest.mark.parametrize("reading", READINGS.values(), ids=READINGS)


def resolve(name: str) -> object:
    """The object of a dotted name below the package: the longest prefix that is a module, then attributes."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found: object = import_module("scenic_ref." + ".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[length:]:
            found = getattr(found, attribute)
        return found
    raise ModuleNotFoundError(name)


def test_ids_are_unique() -> None:
    assert sum(len(table) for table in TABLES) == len(READINGS)
    assert all(name == reading.id for name, reading in READINGS.items())


@ALL
def test_every_field_is_filled(reading: Reading) -> None:
    assert reading.question.endswith("?")
    assert reading.consequence.endswith(".")
    assert reading.places and all(reading.places)
    assert reading.alternatives and all(reading.alternatives.values())
    assert reading.about in ("scene", "policy", "pruning")


@ALL
def test_a_conflict_names_both_places(reading: Reading) -> None:
    assert reading.kind in ("conflict", "silence")
    assert reading.kind == "silence" or len(reading.places) >= 2


@ALL
def test_profiles_deviate_to_other_alternatives_of_the_reading(reading: Reading) -> None:
    assert set(reading.profiles) <= set(PROFILES) - {"paper"}
    assert all(alternative in reading.alternatives for alternative in reading.profiles.values())
    assert reading.default not in reading.profiles.values()
    assert reading.under("paper") == reading.default


@ALL
def test_code_names_exist(reading: Reading) -> None:
    assert all(resolve(name) is not None for name in reading.code)
    assert reading.code or reading.about != "scene"


def test_a_name_that_does_not_exist_is_not_resolved() -> None:
    with pytest.raises(AttributeError):
        resolve("semantics.termination.nothing")


@ALL
def test_probes_are_short_programs_that_parse(reading: Reading) -> None:
    assert reading.probe is not None
    assert len(reading.probe.program.splitlines()) <= 12
    assert parse(reading.probe.program).statements


@ALL
def test_probes_show_every_alternative(reading: Reading) -> None:
    assert reading.probe is not None
    assert list(reading.probe.shows) == list(reading.alternatives)
    assert all(reading.probe.shows.values())


@pytest.mark.parametrize("profile", PROFILES)
def test_a_profile_selects_one_alternative_of_each_reading(profile: str) -> None:
    selected = select(profile)
    assert selected.keys() == READINGS.keys()
    assert all(selected[name] == reading.under(profile) for name, reading in READINGS.items())


def test_the_formal_profile_keeps_the_rules_and_prose_sets_them_aside() -> None:
    assert select("formal")["offset-by"] == "global"
    assert select("formal")["soft"] == select("paper")["soft"] == "run"
    assert select("prose")["soft"] == "scene"
    assert select("prose")["require-time"] == "end"


def test_a_chosen_alternative_wins_over_the_profile() -> None:
    assert select("prose", {"soft": "run"})["soft"] == "run"


@pytest.mark.parametrize(
    "profile, chosen, hint",
    [
        ("pepar", {}, "did you mean paper?"),
        ("paper", {"sotf": "run"}, "did you mean soft?"),
        ("paper", {"soft": "never"}, "it has run, scene"),
    ],
    ids=["profile", "reading", "alternative"],
)
def test_unknown_names_are_usage_errors_with_a_hint(profile: str, chosen: dict[str, str], hint: str) -> None:
    with pytest.raises(UsageError) as error:
        select(profile, chosen)
    assert error.value.hint == hint
