"""Programs in colours: the words are those of the grammar, the lexer knows all that programs are made of, the TextMate grammar is current."""

from __future__ import annotations

import importlib.util
import json
import re
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
from pygments import highlight
from pygments.formatters import NullFormatter
from pygments.token import Keyword, Name, Operator, Text, Token
from scenic_ref.conformance import load_vectors
from scenic_ref.editors.pygments_lexer import ScenicLexer
from scenic_ref.interpreter.language.keywords import keywords, terminals
from scenic_ref.interpreter.language.parser import tables

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def textmate() -> ModuleType:
    """The script that writes the TextMate grammar."""
    found = importlib.util.spec_from_file_location("textmate", ROOT / "docs" / "textmate.py")
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_terminals_are_those_of_the_parser() -> None:
    of_parser = {one.name: one.pattern.to_regexp() for one in tables(False).terminals}
    ours = {name: pattern for name, (_, pattern, _) in terminals().items() if name in of_parser}
    assert len(ours) > 100
    for name, pattern in ours.items():
        for text in ("with", "not  visible from", "front left of", "require x", "take x", "wait", "'a'", "0x1f", "# a", ":", "model m", "in"):
            assert bool(re.fullmatch(pattern, text)) == bool(re.fullmatch(of_parser[name], text)), name


def test_every_word_of_the_grammar_is_a_keyword() -> None:
    words = {one.name for one in tables(False).terminals if re.match(r"(?:\(\?:)*[a-z]", one.pattern.value)}
    assert words - {word.name for word in keywords()} == set()


@pytest.mark.parametrize(
    ("text", "part", "kind"),
    [
        ("ego = Object at (0, 0)", "at", Operator.Word), ("at = 3", "at", Name), ("x = ego.at", "at", Name.Attribute),
        ("ego = Object with color 3", "color", Name.Attribute), ("behavior Go(): wait", "Go", Name.Function), ("require x", "require", Keyword),
        ("require = 3", "require", Name), ("x = not  visible r", "not  visible", Operator.Word), ("x = True", "True", Keyword.Constant),
        ("new = 3", "new", Name), ("ego = new Car", "new", Keyword.Declaration), ("class Bus: pass", "Bus", Name.Class),
    ],
)
def test_a_word_has_its_kind(text: str, part: str, kind: object) -> None:
    assert (kind, part) in list(ScenicLexer().get_tokens(text))


def programs() -> list[str]:
    """Examples, and the vectors' programs."""
    examples = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "examples").rglob("*.scenic"))]
    return examples + [text for vector in load_vectors() for text in vector.texts.values()]


@pytest.mark.slow
def test_the_lexer_knows_all_that_programs_are_made_of_and_loses_nothing() -> None:
    lexer = ScenicLexer(stripnl=False, ensurenl=False)
    for text in programs():
        found = list(lexer.get_tokens(text))
        assert "".join(part for _, part in found) == text.replace("\r\n", "\n").replace("\r", "\n").removeprefix("\ufeff")
        odd = {part for kind, part in found if kind in (Token.Error, Text) and part.isascii() and part.isprintable()}
        assert odd <= set("?$`'\"")  # of programs that are none


def test_pygments_finds_the_lexer_by_its_entry_point() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    module, name = project["entry-points"]["pygments.lexers"]["scenic"].split(":")
    assert (module, name) == (ScenicLexer.__module__, ScenicLexer.__name__)
    assert highlight("ego = Car\n", ScenicLexer(), NullFormatter()) == "ego = Car\n"


def test_the_textmate_grammar_is_current(textmate: ModuleType) -> None:
    written = (ROOT / "docs" / "scenic.tmLanguage.json").read_text(encoding="utf-8")
    assert written == textmate.grammar_json()  # python docs/textmate.py
    for pattern in json.loads(written)["patterns"]:
        for key in ("match", "begin", "end"):
            re.compile(pattern.get(key, "")) if "(?i:[rbuf]" not in pattern.get(key, "") else None
