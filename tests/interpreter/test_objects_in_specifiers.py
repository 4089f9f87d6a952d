"""What follows an object in a specifier: in dialect `scenic-2.1` it belongs to that object, as in the release."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.interpreter.parser import parse
from scenic_ref.interpreter.printer import to_source

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
