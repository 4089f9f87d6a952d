"""Texts that need not be programs: places, words, what is defined, and what there is to say; no server, and no parser, is needed."""

from __future__ import annotations

from pathlib import Path

import pytest
from scenic_ref.editors import completion, word_meanings
from scenic_ref.editors.completion import suggestions
from scenic_ref.editors.definitions import targets
from scenic_ref.editors.hover import hover
from scenic_ref.editors.module_library import ModuleShelf, SourceModule
from scenic_ref.editors.name_scopes import NameFinder
from scenic_ref.editors.outline import Definition, outline
from scenic_ref.editors.positions import TextLines
from scenic_ref.editors.tokens import lines, pieces
from scenic_ref.interpreter.language.keywords import keywords
from scenic_ref.semantics.rules import CATALOGUE
from scenic_ref.semantics.store.built_in_classes import OBJECT_CLASS, SPELLINGS
from scenic_ref.simulators.worlds import WORLDS

ODD = 'a\t"😋"\r\né\u0301\u2028b\rc\n\nend'


def finder(text: str, folder: Path | None = None) -> NameFinder:
    """What looks names up in a text, in a file of the folder."""
    return NameFinder(ModuleShelf(lambda path: None), SourceModule("main", None if folder is None else folder / "main.scenic", text))


def shown(text: str) -> str:
    """What is shown at the `|`."""
    found = hover(finder(text.replace("|", "", 1)), text.index("|"))
    return "" if found is None else found.markdown


def labels(text: str) -> list[str]:
    """What is suggested at the `|`."""
    return [one.label for one in suggestions(finder(text.replace("|", "", 1)), text.index("|"))]


def names(definition: Definition) -> list[object]:
    """The outline in kinds and names."""
    return [(one.kind, one.name, *([names(one)] if one.children else [])) for one in definition.children]


# Places


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-32"])
def test_places_and_indices_are_inverse_to_each_other(encoding):
    found = TextLines(ODD, encoding)
    inside_ends = {ODD.index("\r\n") + 1}
    for offset in set(range(len(ODD) + 1)) - inside_ends:
        assert found.offset(*found.place(offset)) == offset


def test_a_place_that_is_none_is_moved_to_one():
    found = TextLines(ODD)
    assert found.place(ODD.index("😋") + 1) == (0, 5)
    assert found.offset(0, 4) == ODD.index("😋")  # within the character
    assert found.offset(0, 99) == ODD.index("\r\n")
    assert found.offset(99, 0) == len(ODD)
    assert found.offset(-1, 0) == 0
    assert found.index(99, 99) == len(ODD)


# Outlines


def test_definitions_are_found_in_what_does_not_parse():
    text = (
        "from a.b import c as d, (e\nclass Car(Object:\n    width: 2\n    def f(self, x=(1, 2), *rest):\n        y = = 3\n"
        "ego = (1,\nbehavior B(s: int = 3): take s\nfor i, j in\nparam time = 3, 'weather' = 4\np, (q.r, t[0]) = u = 5\nv += 1\nw == 2\n"
    )
    parts = ["self", "x", "rest"]
    method = ("function", "f", [*(("parameter", name) for name in parts), ("variable", "y")])
    assert names(outline(text)) == [
        ("import", "d"), ("import", "e"), ("class", "Car", [("property", "width"), method]), ("variable", "ego"),
        ("behavior", "B", [("parameter", "s")]), ("variable", "i"), ("variable", "j"), ("param", "time"),
        ("param", "weather"), ("variable", "p"), ("variable", "u"),
    ]  # fmt: skip


def test_every_world_has_the_definitions_that_it_has():
    text = str(WORLDS["scenic.simulators.gta.model"]())
    assert {"Car", "EgoCar", "Bus", "Compact", "createPlatoonAt"} <= {one.name for one in outline(text).children}


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "piece",
    ['"""', "(", '"', "x = ", "\n", " \n", "[\n", "class A:\n", "\\\n", "f'{", "'\\", "#\n", "import a as b,", "with with ", "x.", "\t", "; ", ": "],
)
def test_reading_takes_time_in_proportion_to_the_text(piece, effort):
    def read(size: int) -> None:
        text = piece * (size // len(piece))
        for cached in (pieces, lines, outline):
            cached.cache_clear()
        outline(text)

    assert any(effort(lambda: read(200_000)) < 10 + 60 * effort(lambda: read(20_000)) for _ in range(3))  # more would be so each time


# What is said


def test_every_word_of_the_language_is_explained_or_belongs_to_another():
    silent = {"IS_NOT", "NOT_IN", "IS_IN", "_NONLOCAL", "_GLOBAL", "_LAMBDA", "FALSE", "TRUE", "NONE", "_ELSE", "_FROM"}
    silent |= {"_AND", "_NOT", "_AS", "IS", "_OR", "_BY", "_TO", "_OF"}
    assert {word.name for word in keywords()} == set(word_meanings.WORDS) | silent


def test_every_rule_that_is_named_is_in_the_catalogue_and_every_specifier_is_shown():
    named = [beginning for uses in word_meanings.WORDS.values() for use in uses for beginning in use.rules]
    assert all(word_meanings.rules_of((beginning,)) for beginning in named)
    shown_ = {rule.id for beginning in named for rule in word_meanings.rules_of((beginning,))}
    assert {rule.id for rule in CATALOGUE if rule.id.startswith(("P-", "O-"))} - shown_ == {"P-Default", "O-VectorOf"}


def test_every_built_in_property_has_a_meaning():
    assert set(word_meanings.MEANINGS) == {*OBJECT_CLASS.defaults, "visibleDistance"}
    assert "visibleDistance" in SPELLINGS
    assert all(word_meanings.about_built_in_property(name) for name in word_meanings.MEANINGS)


def test_a_property_says_its_kind_its_default_and_who_specifies_it():
    found = word_meanings.about_built_in_property("heading")
    assert "`heading` of `OrientedPoint`" in found
    assert "a number, by default `0.0`" in found
    assert "specified by `with heading E`, `facing H`, `facing F`" in found
    assert "; optionally by " in found
    assert "`in R`" in found.partition("optionally by")[2]


def test_a_distribution_is_shown_with_its_parameters_and_its_rule():
    assert "Normal(mean, stdDev)" in shown("x = Nor|mal(0, 1)")
    assert "**E-Distributions**" in shown("x = Nor|mal(0, 1)")


def test_a_name_is_shown_with_its_line_and_the_comment_above_it():
    text = "# How fast.\nspeed = Range(1, 2)  # in m/s\nx = sp|eed\n"
    assert shown(text) == "```scenic\nspeed = Range(1, 2)\n```\n\nHow fast.\n\n*variable* in `main.scenic`, line 2".replace("main.scenic", "main")


def test_a_name_of_the_program_comes_before_a_word_of_the_language():
    assert "visible = 3" in shown("visible = 3\nx = visi|ble\n")
    assert "**P-Visible" in shown("ego = Object\nx = Object visi|ble\n")


def test_what_is_shown_of_a_rule_is_its_text_and_no_markup():
    assert "require\\[p\\] B" in shown("require|[0.5] x")


# What is suggested


def test_every_phrase_that_is_suggested_is_one_of_the_language():
    every = [*completion.SPECIFIERS, *completion.PREFIXES, *completion.INFIXES]
    every += [*completion.RELEASED_SPECIFIERS, *completion.RELEASED_PREFIXES, *completion.RELEASED_INFIXES]
    every += [p for table in (completion.STATEMENTS, completion.RELEASED_STATEMENTS) for found in table.values() for p in found]
    assert not [phrase for phrase in every if completion.word_of(phrase) is None]
    found = {word.name for phrase in every if (word := completion.word_of(phrase)) is not None}
    found |= {word.name for phrase in every if (word := completion.word_of(phrase, ("specifier",))) is not None}
    others = {"CONSTRUCTOR", "ALWAYS", "EVENTUALLY", "_REQUIRE_SOFT", "IS_IN"}  # another spelling, or behind another word
    assert {word.name for word in keywords()} - found == others


@pytest.mark.parametrize(
    ("text", "wanted", "unwanted"),
    [
        ("behavior B():\n    t|", "take", "model"), ("|", "model", "take"), ("class A(Object):\n    |", "width: ", "model"),
        ("scenario S():\n    |", "compose", "elephant"), ("x = rel|", "relative heading of", "relative to"), ("x = 3 rel|", "relative to", "take"),
        ("from mars import |", "Rover", "Car"), ("import mars as m\nx = m.|", "Rover", "Range"),
        ("param a = 3\nx = globalParameters.|", "a", "Range"),
        ("class A:\n    foo: 3\n    def f(self):\n        self.|", "foo", "Range"), ("from mars |", "import", "Rover"),
        ("def f(a):\n    b = 1\n    |\nc = 2", "b", "with"), ("def f(a):\n    b = 1\nc = |\n", "c", "b"), ("ego = mars.Rover |", "at", "Range"),
        ("# dialect: scenic-3\nego = new Object |", "contained in", "Range"), ("ego = Object |", "at", "contained in"),
        ("x = Range(1, 2) |", "offset by", "facing"), ("ego = Object at 1 @ 2,\n    with width 3,\n    |", "facing", "model"),
    ],
)  # fmt: skip
def test_what_can_stand_at_a_place(text, wanted, unwanted):
    found = labels(text)
    assert wanted in found
    assert unwanted not in found


@pytest.mark.parametrize("text", ["# Obj|", 'x = "Obj|', "x = '''\nObj|", "x = 12|", "x = 1.|", 'x = f"{Obj|'])
def test_nothing_is_suggested_in_comments_texts_and_numbers(text):
    assert labels(text) == []


@pytest.mark.parametrize(
    "text", ["|", ".|", "x.y.|", ")))|", "import |", "from . import |", "from |", "with |", "model |", "\\|", "override |", "x = new |"]
)
def test_whatever_stands_there_something_is_answered(text):
    labels(text)
    for offset in range(len(text)):
        hover(finder(text.replace("|", "x", 1)), offset)
        targets(finder(text.replace("|", "x", 1)), offset)


# Where it is


def test_imports_that_go_round_end(tmp_path):
    (tmp_path / "a.scenic").write_text("from b import *\nfrom b import x\n")
    (tmp_path / "b.scenic").write_text("from a import *\nfrom a import x\n")
    assert targets(finder("from a import *\ny = x", tmp_path), 20) is not None
    labels("from a import *\n|")


def test_a_class_that_is_derived_from_itself_ends():
    assert "width" in labels("class A(A):\n    width: 1\nego = A with |")


def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "secret.scenic").write_text("secret = 1\n")
    (inner / "lib.scenic").symlink_to(tmp_path / "secret.scenic")
    assert targets(finder("import lib", inner), 8) == []


def test_the_last_definition_before_a_place_counts():
    text = "x = 1\ny = x\nx = 2\nz = x\n"
    found = [targets(finder(text), text.index(word) + 4)[0].start for word in ("y = x", "z = x")]
    assert found == [0, text.index("x = 2")]
