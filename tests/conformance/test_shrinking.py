"""Programs are made small: whole statements first, nothing is tried twice, and it ends when its time is over."""

from __future__ import annotations

import pytest
from scenic_ref.conformance.fuzz.shrinking import shrunk


def never() -> bool:
    return False


@pytest.mark.parametrize("text, needle, small", [
    ("x = Range(1, 2)\nego = Object at (x, 3), facing 30 deg, with foo Uniform(1, 2)\nrequire ego.foo < 3\nparam y = x\n", "facing",
     "Object facing 0\n"),
    ("class A:\n    foo: 17.25\n    bar: 3\nego = A at 1 @ 2\nif True:\n    for i in range(3):\n        Object at i @ 9\n", "foo:",
     "class A:\n    foo: 0\n"),
    ("ego = = 3\nx = 1\ny = 2\n", "= =", "ego = = 3\n"),
    ("ego = Object\nmutate ego\nrequire (distance to (3 + 4, 5)) < abs(-2)\n", "distance", "require (distance)\n"),
])
def test_what_is_left_out_is_all_that_can_be(text: str, needle: str, small: str) -> None:
    tried: list[str] = []

    def holds(candidate: str) -> bool:
        tried.append(candidate)
        return needle in candidate

    assert shrunk(text, holds, never) == small
    assert len(tried) == len(set(tried)), "nothing is tried twice"


def test_whole_statements_are_left_out_before_their_parts() -> None:
    """Where expressions come first, the thirty tries are spent on the one that has to stay."""
    lines = "".join(f"    if self.x + {i} < max({i}, 2 * self.y):\n        take (Uniform({i}, 2), 3)\n" for i in range(3))
    kept = "1 + Range(2, 3) * max(4, 5)"
    text = f"behavior A():\n    need = {kept}\n{lines}behavior B():\n{lines}    need = 2\nego = Object with behavior B\n"
    tried: list[str] = []

    def holds(candidate: str) -> bool:
        tried.append(candidate)
        return "behavior A()" in candidate and "behavior B()" in candidate and "Range(2, 3) * max(4, 5)" in candidate.replace("(Range", "Range")

    assert len(shrunk(text, holds, lambda: len(tried) >= 30).splitlines()) == 4


def test_shrinking_ends_when_its_time_is_over() -> None:
    asked: list[str] = []
    text = "ego = Object at 1 @ 2\nx = 3\n"
    assert shrunk(text, lambda candidate: not asked.append(candidate), lambda: len(asked) > 0) in (text, asked[0])
    assert len(asked) <= 1


def test_what_cannot_be_printed_is_no_smaller_program() -> None:
    text = "ego = Object\nrequire (Uniform(0, 1) <= 2) and (Uniform(0, 1) <= 3)\n"
    tried: list[str] = []
    assert shrunk(text, lambda candidate: bool(tried.append(candidate)), lambda: False) == text
    assert "ego = Object\n" in tried and len(tried) > 20
