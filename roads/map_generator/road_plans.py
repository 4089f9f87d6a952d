"""Roads as they are written: lanes, where roads end, what stands beside them. Plans are for traffic on the right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .road_curves import Line, Placement

Contact = Literal["start", "end"]
DRIVEN = frozenset({"driving", "entry", "exit", "onRamp", "offRamp"})
"""The types of lanes on which cars drive."""


@dataclass(frozen=True)
class PlannedLane:
    """A lane: the coefficients of its width, in metres, by the distance along it; the ids of the lanes before and after it, along the road."""

    type: str
    width: tuple[float, ...]
    before: int | None = None
    after: int | None = None


Side = tuple[PlannedLane, ...]
"""The lanes on one side of a reference line, from it outwards."""


@dataclass(frozen=True)
class PlannedSection:
    """The lanes from `start` on, in metres."""

    start: float
    left: Side
    right: Side


@dataclass(frozen=True)
class PlannedSignal:
    """A traffic light, or on the roads of a junction a reference to one; valid for the lanes from the lowest id to the highest."""

    id: int
    s: float
    t: float
    orientation: Literal["+", "-"]
    lanes: tuple[int, int]


@dataclass(frozen=True)
class PlannedCrosswalk:
    """A crosswalk: the distance along the road of its middle, and how far it goes to the left and to the right."""

    s: float
    left: float
    right: float


@dataclass(frozen=True)
class Neighbour:
    """The neighbour at the end of a road: an end of another road, or a junction."""

    id: int
    contact: Contact | None = None


@dataclass(frozen=True)
class PlannedRoad:
    """A road. Those of a junction begin where an incoming road meets it."""

    id: int
    line: Line
    sections: tuple[PlannedSection, ...]
    predecessor: Neighbour | None = None
    successor: Neighbour | None = None
    junction: int | None = None
    type: Literal["town", "motorway"] = "town"
    signals: tuple[PlannedSignal, ...] = ()
    references: tuple[PlannedSignal, ...] = ()
    crosswalks: tuple[PlannedCrosswalk, ...] = ()

    @property
    def length(self) -> float:
        """The length of the road, in metres."""
        return sum(piece.length for piece in self.line)


@dataclass(frozen=True)
class Mouth:
    """An end of a road that meets a junction; its pose looks out of the junction, along the road."""

    road: int
    contact: Contact
    pose: Placement
    section: PlannedSection
    signal: int | None = None

    @property
    def incoming(self) -> Side:
        """The lanes that lead into the junction."""
        return self.section.right if self.contact == "end" else self.section.left

    @property
    def outgoing(self) -> Side:
        """The lanes that lead out of it."""
        return self.section.left if self.contact == "end" else self.section.right

    def incoming_id(self, index: int) -> int:
        """The id of a lane of `incoming`."""
        return -1 - index if self.contact == "end" else 1 + index

    def outgoing_id(self, index: int) -> int:
        """The id of a lane of `outgoing`."""
        return -self.incoming_id(index)


def mouth(road: PlannedRoad, contact: Contact) -> Mouth:
    """One of the two ends of a road."""
    at_end = contact == "end"
    pose = road.line[-1].at(1).reversed() if at_end else road.line[0].start
    signal = next((signal.id for signal in road.signals if signal.orientation == ("+" if at_end else "-")), None)
    return Mouth(road.id, contact, pose, road.sections[-1 if at_end else 0], signal)


def breadth(side: Sequence[PlannedLane]) -> float:
    """The width of lanes together, in metres, where their section begins."""
    return sum(lane.width[0] for lane in side)


def driving_lane_indices(side: Side) -> list[int]:
    """The indices of the lanes on which cars drive."""
    return [index for index, lane in enumerate(side) if lane.type in DRIVEN]


def to_curb(side: Side) -> float:
    """Metres from the reference line to the curb, where the sidewalk begins."""
    return breadth([lane for lane in side if lane.type != "sidewalk"])
