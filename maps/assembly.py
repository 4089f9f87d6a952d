"""A network in the making: the lanes of a file's sections, and what has become of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
import shapely

from .elements import Lane, LaneSection, LinearElement, NetworkElement, Road
from .intersections import Maneuver
from .notes import Notes
from .opendrive import OpenDrive
from .shapes import LaneShape, Points, SectionShape, areas

E = TypeVar("E", bound=NetworkElement)
L = TypeVar("L", bound=LinearElement)
Place = tuple[str, int, int]
"""A lane of a section: the id of the road, the number of the section, the number of the lane."""


@dataclass
class TravelledLane:
    """A lane of a section on its way into the network: its edges in the direction of traffic."""

    place: Place
    shape: LaneShape
    forward: bool
    left: Points
    right: Points
    polygon: shapely.Geometry
    element: LaneSection | None = None
    lane: Lane | None = None

    @property
    def center(self) -> Points:
        """Its middle."""
        return (self.left + self.right) / 2


@dataclass
class Assembly:
    """A network in the making."""

    file: OpenDrive
    shapes: dict[str, list[SectionShape]] = field(default_factory=dict[str, "list[SectionShape]"])
    sections: dict[Place, TravelledLane] = field(default_factory=dict[Place, TravelledLane])
    chains: dict[Place, list[TravelledLane]] = field(default_factory=dict["Place", "list[TravelledLane]"])
    """The lanes: their sections in order, by the first."""
    roads: dict[str, Road] = field(default_factory=dict[str, Road])
    elements: dict[str, NetworkElement] = field(default_factory=dict[str, NetworkElement])
    maneuvers: dict[Lane, list[Maneuver]] = field(default_factory=dict["Lane", "list[Maneuver]"])

    @property
    def notes(self) -> Notes:
        """What was noticed."""
        return self.file.notes

    def of(self, kind: type[E]) -> tuple[E, ...]:
        """The elements of a kind."""
        return tuple(e for e in self.elements.values() if type(e) is kind)

    def add(self, kind: type[E], uid: str, **attributes: Any) -> E:
        """One more element, with a name of its own."""
        while uid in self.elements:
            uid += "'"
        self.elements[uid] = made = kind.of(**{"uid": uid, "name": uid, **attributes})
        return made

    def at(self, road: str, i: int) -> dict[int, TravelledLane]:
        """The lanes of a section of a road, by their numbers."""
        return {id: found for id in self.shapes[road][i].lanes if (found := self.sections.get((road, i, id))) is not None}

    def next_places(self, section: TravelledLane) -> Iterator[Place]:
        """The lanes of sections that a lane leads to, where no junction comes between."""
        road, i, _ = section.place
        record = section.shape.record
        ids = record.successors if section.forward else record.predecessors
        further = i + (1 if section.forward else -1)
        if 0 <= further < len(self.shapes[road]):
            found = ((road, further, id) for id in ids)
        else:
            link = self.file.roads[road].link_at("end" if section.forward else "start")
            if link is None or link.kind != "road" or link.id not in self.file.roads:
                return
            contact = link.contact or "start"
            found = ((link.id, self.file.roads[link.id].section_at(contact), id) for id in ids)
            found = (p for p in found if p in self.sections and self.sections[p].forward is (contact == "start"))
        yield from (p for p in found if p in self.sections and self.same_way(section, p))

    def same_way(self, section: TravelledLane, place: Place) -> bool:
        """Whether a lane of the same road has the same direction (of another road it is known already)."""
        return place[0] != section.place[0] or self.sections[place].forward is section.forward or len(self.shapes[place[0]]) == 1

    def linear(
        self, kind: type[L], uid: str, *, left: Points, right: Points, polygon: shapely.Geometry, center: Points | None = None, **more: Any
    ) -> L:
        """An element along its edges."""
        middle = (left + right) / 2 if center is None else center
        lines = {"left": left, "right": right, "middle": middle}
        return self.add(kind, uid, polygon=areas(polygon), across=center is None, **{k: np.ascontiguousarray(v) for k, v in lines.items()}, **more)


def lane_name(place: Place) -> str:
    """A lane, for a message."""
    road, _, lane = place
    return f"road {road} lane {lane}"
