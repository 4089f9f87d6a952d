"""`override` has the structure of an object definition: what it may specify, and how often."""

from __future__ import annotations

import pytest
from scenic_ref.semantics.store.errors import ProgramError, RunError, SpecifiedTwice
from scenic_ref.simulators.loop import Simulated

from .worlds import actions, simulated

PROGRAM = """
behavior B():
    while True:
        take self.x
scenario S():
    setup:
        override ego {}
scenario Main():
    setup:
        ego = Object at (0, 0), with x 0, with behavior B
    compose:
        do S() for 1 steps
        wait
"""


@pytest.mark.parametrize(
    ("specifiers", "error", "column", "message"),
    [
        ("with x 1, with x 2", SpecifiedTwice, 32, "the property x is specified twice: by `with x` and by `with x`"),
        ("with x 1, with x 1", SpecifiedTwice, 32, "the property x is specified twice: by `with x` and by `with x`"),
        ("with height 1, with length 2", SpecifiedTwice, 37, "the property length is specified twice: by `with height` and by `with length`"),
        ("with behavior B, with behavior B()", SpecifiedTwice, 39,
         "the property behavior is specified twice: by `with behavior` and by `with behavior`"),
        ("with width -1", RunError, 33, "the property width must be at least 0, not -1 (from `with width`)"),
        ("with width 'wide'", RunError, 33, "the property width must be a scalar, not a string (from `with width`)"),
        ("with requireVisible 1", RunError, 42, "the property requireVisible must be True or False, not 1 (from `with requireVisible`)"),
        ("with widht 2", RunError, 22, "<Object 0> has no property widht"),
    ],
)  # fmt: skip
def test_override_refuses_what_an_object_definition_refuses(specifiers: str, error: type[ProgramError], column: int, message: str) -> None:
    with pytest.raises(error) as raised:
        simulated(PROGRAM.format(specifiers))
    assert (raised.value.message, raised.value.span.line, raised.value.span.column) == (message, 7, column)


def test_override_of_a_property_that_is_nearly_there_names_it() -> None:
    with pytest.raises(RunError) as raised:
        simulated(PROGRAM.format("with widht 2"))
    assert raised.value.hint == "did you mean width?"


@pytest.mark.parametrize("spelling", ["height", "length"])
def test_override_knows_both_spellings_of_a_property_and_takes_it_back(spelling: str) -> None:
    run = simulated(PROGRAM.replace("self.x", "self.length").format(f"with {spelling} 3"))
    assert isinstance(run, Simulated)
    assert [moment.actions[0] for moment in run.moments[:-1]] == [(3,), (1,)]


def test_different_properties_may_be_overridden_at_once() -> None:
    assert actions(PROGRAM.format("with x 5, with width 3")) == [5, 0, "terminated"]
