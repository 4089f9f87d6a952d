"""Exceptions of rules and of the library for a run that cannot go on, and the requirement that is then said
to fail.
"""

from __future__ import annotations

from ..space.absence import Absent
from ..space.fields import OutsideField
from ..space.regions import EmptyRegion
from ..syntax.nodes import Span
from .outcome import Requirement


class NothingToDraw(Exception):
    """A distribution over the values of a container of random length has no value where that is empty (reading `random-length`)."""

    def __init__(self, name: str) -> None:
        super().__init__(f"{name} of an empty list")


Unmet = OutsideField | EmptyRegion | Absent | NothingToDraw
UNMET = (OutsideField, EmptyRegion, Absent, NothingToDraw)
KINDS_OF_UNMET = frozenset({"field", "region", "element", "parameters"})
"""The kinds of requirement that `unmet_requirement` gives: a value is missing."""


def unmet_requirement(problem: Unmet, span: Span) -> Requirement:
    """The requirement that the run fails."""
    match problem:
        case OutsideField():
            return Requirement("field", span, problem.premise)
        case EmptyRegion():
            return Requirement("region", span, str(problem))
        case Absent():
            return Requirement("element", span, str(problem))
        case NothingToDraw():
            return Requirement("parameters", span, str(problem))
