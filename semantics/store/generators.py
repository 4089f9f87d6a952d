"""Generators: iterators of a program whose elements the machine computes, each when it is asked for."""

from __future__ import annotations

from typing import NamedTuple

from .budget import Budget
from .errors import NeedsElements
from .scopes import Scope
from .undo_log import Slot


class Exhausted:
    """The marker that `next` finds behind the last element."""

    def __reduce__(self) -> str:
        return "EXHAUSTED"


EXHAUSTED = Exhausted()


class Generator:
    """An iterator of the program: the frame in which it goes on, in its scope; None while it runs, and after its end.

    Library code cannot step the machine: what asks for an element there raises `NeedsElements`, for the machine to compute the elements
    `ahead`; the call is then made again. `calls` is the number of calls that library code had made (`Door`) when the generator was made.
    """

    __slots__ = ("ahead", "budget", "calls", "place", "running", "suspended")

    def __init__(self, frame: NamedTuple, scope: Scope, budget: Budget, calls: int) -> None:
        self.calls = calls
        self.suspended: tuple[NamedTuple, Scope] | None = (frame, scope)
        self.running = False
        self.ahead: list[object] = []
        self.place = 0
        self.budget = budget

    def change(self, **changes: object) -> None:
        """Assign to attributes, noted first (`versions`)."""
        for name, value in changes.items():
            self.budget.versions.note(Slot(self, name, getattr(self, name)))
            setattr(self, name, value)

    def taken_ahead(self) -> list[object] | None:
        """The elements that were computed ahead and not yet given, given now; None if none were."""
        if not self.ahead:
            return None
        rest = self.ahead[self.place :]
        self.change(ahead=[], place=0)
        return rest

    def __iter__(self) -> Generator:
        return self

    def __next__(self) -> object:
        if self.running:
            raise ValueError("generator already executing")
        if self.place < len(self.ahead):
            self.change(place=self.place + 1)
            return self.ahead[self.place - 1]
        if self.suspended is not None:
            raise NeedsElements(self)
        raise StopIteration

    def __repr__(self) -> str:
        return "<generator>"
