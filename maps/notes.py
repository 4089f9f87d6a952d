"""What is strange in a map and does not keep it from being read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .opendrive import LaneRecord
    from .xml import Element

HEIGHTS = "roads with heights or superelevation, which the plane does not have"
"""A note that is no fault."""


@dataclass
class Notes:
    """What is strange in a map and does not keep it from being read: how often, and where first."""

    found: dict[str, list[str]] = field(default_factory=dict[str, list[str]])

    def add(self, what: str, where: str) -> None:
        """One more."""
        self.found.setdefault(what, []).append(where)

    def lines(self) -> list[str]:
        """A line each."""
        return [f"{what}: {_listed(where)}" for what, where in self.found.items()]


def _listed(where: Sequence[str]) -> str:
    return ", ".join(where[:3]) + (f" and {len(where) - 3} more" if len(where) > 3 else "")


def note_lane(side: str, element: Element, lane: LaneRecord, where: str, notes: Notes) -> None:
    """What is strange about a lane of a section."""
    if lane.id * (1 if side == "left" else -1) < 0:
        notes.add("lanes on the other side than their number says", where)
    if lane.id != 0 and not lane.widths.pieces and not lane.borders.pieces:
        notes.add("lanes without a width", where)
    if element.text("direction", "standard") != "standard":
        notes.add("lanes with a direction of traffic of their own, which is not heeded", where)
