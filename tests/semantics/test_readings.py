"""The registry of readings: complete, consistent, and resolvable to code."""

from __future__ import annotations

from importlib import import_module
from importlib.resources import files

import pytest
import scenic_ref
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.readings import PROFILES, READINGS, Reading, always_decided, select
from scenic_ref.semantics.readings.reading import FILES, readings_in
from scenic_ref.semantics.store.errors import ProgramError, UsageError

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


def test_what_is_always_decided_is_a_conflict_that_every_profile_decides_alike() -> None:
    conflicts = {reading.id for reading in READINGS.values() if reading.kind == "conflict"}
    alike = {name for name in conflicts if len({READINGS[name].under(profile) for profile in PROFILES}) == 1}
    switched = {name for name in conflicts if len(READINGS[name].alternatives) > 1}
    assert set(always_decided()) == conflicts - switched and always_decided()
    assert set(always_decided()) <= alike


def test_every_file_is_loaded() -> None:
    folder = files("scenic_ref.semantics.readings")
    assert {entry.name for entry in folder.iterdir() if entry.name.endswith(".toml")} == {f"{name}.toml" for name in FILES}


GOOD = """
[x]
kind = "silence"
about = "scene"
question = "What?"
places = ["Here"]
consequence = "This."
code = []
[x.alternatives]
a = "one"
b = "other"
[x.profiles]
prose = "b"
"""


def test_a_good_file_is_read() -> None:
    (reading,) = readings_in(GOOD, "f.toml")
    assert (reading.default, reading.under("prose"), reading.under("formal")) == ("a", "b", "a")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("kind", "kinds"), ('"silence"', '"quiet"'), ("about = \"scene\"\n", ""), ('["Here"]', '"Here"'), ('["Here"]', '[""]'), ('["Here"]', "[1]"),
        ('b = "other"', "b = 2"), ('prose = "b"', 'prose = "c"'), ('prose = "b"', 'paper-2 = "b"'), ('"scene"', '"weather"'),
        ("[x.profiles]", "[x.probe]\nprogram = 'ego = Object'\n[x.probe.shows]\na = 'x'\n[x.profiles]"),
    ],
)  # fmt: skip
def test_a_file_that_is_not_as_it_should_be_is_refused(old: str, new: str) -> None:
    assert old in GOOD
    with pytest.raises(ValueError, match=r"^f.toml: \[x\]"):
        list(readings_in(GOOD.replace(old, new), "f.toml"))


def test_what_is_no_table_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^f.toml: \[x\] is not a table"):
        list(readings_in("x = 1", "f.toml"))


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
        resolve("semantics.scenes.termination.nothing")


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


OWN = {"view-distance": "own"}


def test_in_the_releases_view_distance_is_a_name_like_any_other() -> None:
    program = (
        "class C:\n    viewDistance: 'far'\n    visibleDistance: self.reach * 2\n    reach: 4\n"
        "p = OrientedPoint at (0, 0)\nego = C at p offset by (0, 1)\nparam side = (front of ego).visibleDistance"
    )
    scene = scenic_ref.loads(program, readings=OWN).sample()
    assert (scene.ego["viewDistance"], scene.ego["visibleDistance"], scene.params["side"]) == ("far", 8, 50)


@pytest.mark.parametrize("read", [", with visibleDistance -1", "\nparam x = ego.viewDistance"])
def test_in_the_releases_visible_distance_is_the_property(read: str) -> None:
    with pytest.raises(ProgramError, match="Distance"):
        scenic_ref.loads(f"ego = Object at (0, 0){read}", readings=OWN).sample()


def test_the_third_extent_of_scenic_3_is_refused_by_name_unless_an_object_is_given_one() -> None:
    text = "ego = new Object at (0, 0){}\nparam h = ego.height, there = hasattr(ego, 'height'), l = ego.length"
    with pytest.raises(ProgramError, match="Object has no property height") as found:
        scenic_ref.loads(text.format(""), dialect="scenic-3", profile="scenic-3").sample()
    assert "the third extent that Scenic 3 gives every object does not exist in the plane" in found.value.hint
    scene = scenic_ref.loads(text.format(", with height 4"), dialect="scenic-3", profile="scenic-3").sample()
    assert list(scene.params.values()) == [4, True, 1]
