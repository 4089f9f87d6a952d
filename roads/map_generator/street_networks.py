"""Street networks: what streets are like, and the roads of streets between points."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

from .junction_plans import junction, setbacks, turns
from .opendrive_writer import DEPTH
from .road_curves import Line, Placement, sharpest, street
from .road_plans import (
    Contact,
    Mouth,
    Neighbour,
    PlannedCrosswalk,
    PlannedLane,
    PlannedRoad,
    PlannedSection,
    PlannedSignal,
    Side,
    breadth,
    driving_lane_indices,
    mouth,
    to_curb,
)

BIKE_LANE, SIDEWALK = 1.8, 2.0
"""Widths in metres."""
SHORTEST_STREET = 10.0
"""Metres; less would be too short for two crosswalks."""
BEFORE = 1.0
"""Metres between a junction and the crosswalk before it."""


@dataclass(frozen=True)
class Style:
    """The style that all streets of a map share."""

    lanes: int
    lane_width: float
    radius: float
    sidewalks: bool
    shoulders: bool
    shoulder_width: float
    bike_lanes: bool
    signals: bool
    crosswalks: bool

    def __post_init__(self) -> None:
        if self.sidewalks and self.radius < SIDEWALK + 0.5:
            least = f"{SIDEWALK + 0.5:g} m with sidewalks, which lie inside the curbs of corners"
            raise ValueError(f"radius must be at least {least}, not {self.radius:g}")

    def section(self, one_way: bool = False) -> PlannedSection:
        """The lanes of a street; those of a one-way street are to the right of its reference line, with a sidewalk on either side."""
        driving = (PlannedLane("driving", (self.lane_width,)),) * self.lanes
        beside = (PlannedLane("shoulder", (self.shoulder_width,)),) * self.shoulders + (PlannedLane("sidewalk", (SIDEWALK,)),) * self.sidewalks
        right = driving + (PlannedLane("biking", (BIKE_LANE,)),) * self.bike_lanes + beside
        return PlannedSection(0.0, beside if one_way else right, right)

    def furnished(self, road: PlannedRoad, contacts: Sequence[Contact]) -> PlannedRoad:
        """The road with traffic lights and crosswalks before junctions at these of its ends."""
        signals: list[PlannedSignal] = []
        crosswalks: list[PlannedCrosswalk] = []
        section = road.sections[0]
        for contact in contacts:
            at_end = contact == "end"
            incoming, sign = (section.right, -1) if at_end else (section.left, 1)
            middle, stop = BEFORE + DEPTH / 2, BEFORE + DEPTH + 0.5 if self.crosswalks else 0.5
            lanes = [sign * (1 + index) for index in driving_lane_indices(incoming)]
            if self.signals and lanes:
                s, t = road.length - stop if at_end else stop, sign * (to_curb(incoming) + 0.5)
                signals.append(PlannedSignal(2 * road.id + at_end, s, t, "+" if at_end else "-", (min(lanes), max(lanes))))
            if self.crosswalks:
                crosswalks.append(PlannedCrosswalk(road.length - middle if at_end else middle, to_curb(section.left), to_curb(section.right)))
        return replace(road, signals=tuple(signals), crosswalks=tuple(crosswalks))


@dataclass(frozen=True)
class Street:
    """A street between two points, by their indices, with the headings in which it leaves them; traffic of a one-way street goes to `end`."""

    start: int
    start_heading: float
    end: int
    end_heading: float
    one_way: bool = False


def network(points: Sequence[complex], streets: Sequence[Street], style: Style) -> list[PlannedRoad]:
    """Streets that meet at a junction where three or more have an end, and go over into each other where two have."""
    meeting: dict[int, list[Mouth]] = defaultdict(list)
    for id, way in enumerate(streets, 1):
        meeting[way.start].append(Mouth(id, "start", Placement(points[way.start], way.start_heading % math.tau), style.section(way.one_way)))
        meeting[way.end].append(Mouth(id, "end", Placement(points[way.end], way.end_heading % math.tau), style.section(way.one_way)))
    junctions: dict[int, list[Mouth]] = {}
    poses: dict[tuple[int, Contact], Placement] = {}
    beyond: dict[tuple[int, Contact], Neighbour] = {}
    for ends in meeting.values():
        ends.sort(key=lambda end: end.pose.heading)
        back = setbacks(ends, style.radius) if len(ends) > 2 else [0.0] * len(ends)
        for end, distance, other in zip(ends, back, ends[::-1], strict=True):
            poses[end.road, end.contact] = end.pose.moved(distance)
            if len(ends) > 2:
                beyond[end.road, end.contact] = Neighbour(len(streets) + 1 + len(junctions))
            elif other is not end:
                beyond[end.road, end.contact] = Neighbour(other.road, other.contact)
        if len(ends) > 2:
            junctions[len(streets) + 1 + len(junctions)] = ends
    roads: list[PlannedRoad] = []
    for id, way in enumerate(streets, 1):
        section = style.section(way.one_way)
        line = way_between(poses[id, "start"], poses[id, "end"].reversed(), abs(points[way.end] - points[way.start]), section)
        before, after = beyond.get((id, "start")), beyond.get((id, "end"))
        road = PlannedRoad(id, line, (link_section(section, before, after),), before, after)
        contacts: list[tuple[Contact, Neighbour | None]] = [("start", before), ("end", after)]
        roads.append(style.furnished(road, [contact for contact, other in contacts if other and not other.contact]))
    for id, ends in junctions.items():
        mouths = [mouth(roads[end.road - 1], end.contact) for end in ends]
        roads += junction(id, mouths, turns(mouths))
    return roads


def way_between(start: Placement, end: Placement, distance: float, section: PlannedSection) -> Line:
    """The reference line of a street between points `distance` metres apart. Raises `ValueError` if its junctions or its bends leave no room."""
    ahead = ((end.point - start.point) / cmath.rect(1.0, start.heading)).real
    if ahead < SHORTEST_STREET:
        least = f"{distance - ahead + SHORTEST_STREET:.1f} m from the middle of a junction to the next, or to the end of a leg"
        raise ValueError(f"with these lanes and this turning radius it must be at least {least}, not {distance:.1f}")
    line = street(start, end)
    if sharpest(line) * (breadth(section.right) + 1) > 1:
        raise ValueError(f"these lanes are too broad for the bends of a street of {distance:.1f} m: let block or leg be larger")
    return line


def link_section(section: PlannedSection, before: Neighbour | None, after: Neighbour | None) -> PlannedSection:
    """The section with its lanes linked to those of the roads that it goes over into."""

    def linked(side: Side, sign: int) -> Side:
        def other(neighbour: Neighbour | None, same: Contact, index: int) -> int | None:
            return (sign if neighbour.contact == same else -sign) * (1 + index) if neighbour and neighbour.contact else None

        return tuple(replace(lane, before=other(before, "end", index), after=other(after, "start", index)) for index, lane in enumerate(side))

    return PlannedSection(section.start, linked(section.left, 1), linked(section.right, -1))
