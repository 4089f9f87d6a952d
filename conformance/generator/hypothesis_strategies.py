"""Hypothesis strategies for programs; this is the only module of the package that needs Hypothesis."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from hypothesis import strategies as st

from ...semantics.syntax import Program
from .choice_sources import Choices
from .mistakes import IllFormed, ill_formed
from .programs import DEFAULT, generate
from .settings import ProgramSettings

T = TypeVar("T")


class DrawnChoices(Choices):
    """Choices that Hypothesis makes, and shrinks towards the simplest."""

    def __init__(self, draw: st.DrawFn) -> None:
        self._draw = draw

    def integer(self, low: int, high: int) -> int:
        return low if low == high else self._draw(st.integers(low, high))


@st.composite
def write_from_draws(draw: st.DrawFn, write: Callable[[Choices, ProgramSettings], T], settings: ProgramSettings) -> T:
    """Draw the value that `write` makes from Hypothesis's choices."""
    return write(DrawnChoices(draw), settings)


def programs(settings: ProgramSettings = DEFAULT) -> st.SearchStrategy[Program]:
    """Return a strategy for well-formed programs."""
    return write_from_draws(generate, settings)


def finite_programs(settings: ProgramSettings = DEFAULT) -> st.SearchStrategy[Program]:
    """Well-formed programs of finitely many runs: `Scenario.enumerate` gives their exact distributions."""
    return write_from_draws(generate, settings.as_finite())


def ill_formed_programs(settings: ProgramSettings = DEFAULT) -> st.SearchStrategy[IllFormed]:
    """Programs with a single mistake, each with the error that it gives."""
    return write_from_draws(ill_formed, settings)
