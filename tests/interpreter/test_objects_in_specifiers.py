"""What follows an object in a specifier: in dialect `scenic-2.1` it belongs to that object, as in the release."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.language.printer import to_source
from scenic_ref.semantics.store.scopes import descendants
from scenic_ref.semantics.syntax import expressions as e
from scenic_ref.semantics.syntax import python_expressions as p

BEFORE = "class Car:\n    friend: None\nego = Object at (0, 0), "
SAME = {
    "with friend Object at (5, 6), with width 3": "with friend (Object at (5, 6), with width 3)",
    "with friend Object at (5, 6), facing 1, with width 3": "with friend (Object at (5, 6), facing 1, with width 3)",
    "with friend Car at (5, 6), with friend Point at (1, 1), with n 3": "with friend (Car at (5, 6), with friend (Point at (1, 1), with n 3))",
}
FLAT = [
    "with friend (Object at (5, 6)), with width 3", "with friend field at (5, 6), with width 3", "with friend Elsewhere at (5, 6), with width 3",
    "with friend Object, with width 3", "with width 3, with friend Object at (5, 6)",
]  # fmt: skip
"""In brackets, no class, no class of this text (it may be a field), no object, nothing that follows."""


def source(specifiers: str, dialect: str = "scenic-2.1") -> str:
    return to_source(parse(BEFORE + specifiers, dialect=dialect))


@pytest.mark.parametrize("text", SAME)
def test_what_follows_an_object_belongs_to_it(text: str) -> None:
    assert source(text) == source(SAME[text])
    assert source(text, "paper") != source(SAME[text], "paper")


@pytest.mark.parametrize("text", FLAT)
def test_what_follows_anything_else_belongs_to_the_outer_object(text: str) -> None:
    assert source(text).split("\n")[1:] == source(text, "paper").split("\n")


@pytest.mark.parametrize("dialect, widths", [("scenic-2.1", [1, 3]), ("paper", [3, 1]), ("pldi19", [3, 1])])
def test_the_widths_are_those_of_the_dialect(dialect: str, widths: list[float]) -> None:
    text = "ego = Object at (0, 0), with friend Object at (5, 6), with width 3\nparam a = ego.width, b = ego.friend.width"
    assert list(scenic_ref.loads(text, dialect=dialect).sample().params.values()) == widths


@pytest.mark.parametrize(
    "value",
    ["lambda x: x", "lambda: 3", "lambda x, y=3: x + y", "lambda x: lambda y: x", "lambda x: {1: x}[1]", "{1: 2}", "xs[1:2]", "(lambda x: x)"],
)
@pytest.mark.parametrize("rest", ["visible", "facing(3)"])
@pytest.mark.parametrize("text", ["o = Object with f {}, {}", "o = [Object with f {}, {}]", "o = f(Object with f {}, {})"])
def test_a_specifier_may_stand_behind_a_value_with_a_colon(text: str, rest: str, value: str) -> None:
    found = [n for n in descendants(parse(text.format(value, rest) + "\n").statements[0]) if isinstance(n, e.ObjectDefinition)]
    assert [len(n.specifiers) for n in found] == [2]


@pytest.mark.parametrize("text", ["f = lambda x: (Object at x, visible)", "o = (lambda x: x, visible)", "o = f(lambda x, y: y, visible)"])
def test_without_a_specifier_before_it_visible_is_a_name(text: str) -> None:
    names = [n.name for n in descendants(parse(text + "\n").statements[0]) if isinstance(n, p.Name)]
    assert ("visible" in names) is ("Object" not in text)
