"""Whole numbers of any size: where a number of the plane is meant they are that real number, or refused at their place."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import ProgramError, RunError

FIELD = "f = VectorField('f', lambda p: {})\n"


@pytest.mark.parametrize(
    "program",
    [
        "ego = Object facing {}",
        "ego = Object facing -{}",
        "ego = Object with heading {}",
        "ego = Object facing Uniform({0}, {0})",
        "ego = Object facing 1 relative to {}",
        "ego = Object\nego.heading = {}",
        "class Turned:\n    heading: {}\nego = Turned",
        FIELD + "ego = Object facing f",
        FIELD + "ego = Object at follow f from (0, 0) for 3",
        FIELD + "ego = Object at (1, 1), facing (f at (1, 1))",
        "ego = Object at (1, 1), apparently facing {} from (5, 5)",
        "ego = Object at Vector(1, 2).rotatedBy({})",
        "ego = Object at (1, 1)\nego = Object at (OrientedPoint facing {}) offset by (1, 2)",
        "ego = Object with length {0}, with width {0}",
        "ego = Object at (0, {})",
    ],
)
@pytest.mark.parametrize("whole", [2**63, 2**64, 10**300])
def test_a_large_whole_number_is_that_real_number(program: str, whole: int) -> None:
    found, expected = (scenic_ref.loads(program.format(number)).sample().ego for number in (f"({whole})", f"({float(whole)!r})"))
    assert (found.position, found.heading, found["width"]) == (expected.position, expected.heading, expected["width"])


@pytest.mark.parametrize(
    ("program", "place"),
    [
        ("ego = Object with width {}", (1, 25)),
        ("ego = Object with viewDistance {}", (1, 32)),
        ("ego = Object with positionStdDev {}\nmutate", (1, 34)),
        ("ego = Object with speed -{}", (1, 25)),
        ("ego = Object\nego.width = {}", (2, 1)),
        ("class Wide:\n    width: {}\nego = Wide", (3, 7)),
        (FIELD + "ego = Object facing f", (2, 14)),
        ("ego = Object facing {}", (1, 14)),
        ("ego = Object at ({}, 0)", (1, 14)),
        ("ego = Object\nmutate ego by {}", (2, 1)),
        ("ego = Object with width DiscreteRange(1, {})", (1, 25)),
    ],
)
def test_a_whole_number_beyond_the_real_numbers_is_refused_at_its_place(program: str, place: tuple[int, int]) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program.format("10**400")).sample()
    assert type(raised.value) is RunError
    assert "too large" in raised.value.message
    assert (raised.value.span.line, raised.value.span.column) == place


def test_a_small_whole_number_stays_one() -> None:
    params = scenic_ref.loads("ego = Object with width 2, with foo 2**64\nparam width = ego.width, foo = ego.foo").sample().params
    assert [(type(value), value) for value in params.values()] == [(int, 2), (int, 2**64)]
