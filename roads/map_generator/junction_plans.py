"""Junctions: how far from their middle roads end, which turns there are, and a road for each turn from a lane to a lane.

The mouths of a junction are in the order of their headings, anticlockwise, so that what comes out of one finds the next on its right.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from .road_curves import Line, junction_curve, turn
from .road_plans import (
    Mouth,
    Neighbour,
    PlannedLane,
    PlannedRoad,
    PlannedSection,
    PlannedSignal,
    Side,
    breadth,
    driving_lane_indices,
    to_curb,
)

STRAIGHT = math.radians(45)
"""What turns by less goes straight on."""


@dataclass(frozen=True)
class PlannedManeuver:
    """A way through a junction: from an incoming lane of one of its mouths to an outgoing lane of another, each by its index."""

    start: int
    lane: int
    end: int
    to: int


def setbacks(mouths: Sequence[Mouth], radius: float) -> list[float]:
    """How many metres from the point where their reference lines meet roads have to end, so that the curbs of corners have this radius."""
    least = [0.0] * len(mouths)
    for one, mouth in enumerate(mouths):
        other = (one + 1) % len(mouths)
        angle = (mouths[other].pose.heading - mouth.pose.heading) % math.tau
        if abs(angle - math.pi) > 1e-6:
            curb, next_curb = to_curb(mouth.incoming), to_curb(mouths[other].outgoing)
            tangent = radius / math.tan(angle / 2)
            least[one] = max(least[one], (next_curb + curb * math.cos(angle)) / math.sin(angle) + tangent)
            least[other] = max(least[other], (curb + next_curb * math.cos(angle)) / math.sin(angle) + tangent)
    return least


def turns(mouths: Sequence[Mouth]) -> Iterator[PlannedManeuver]:
    """All lanes go straight on, the leftmost one turns left, the rightmost one right.

    Where the road that is left or the one that is entered has none opposite to it, the inner half of the lanes turns left, the outer half right.
    """
    pairs = [
        (i, j) for i in range(len(mouths))
        for j in range(len(mouths)) if i != j and driving_lane_indices(mouths[i].incoming) and driving_lane_indices(mouths[j].outgoing)
    ]
    angles = {(i, j): turn(mouths[j].pose.heading - mouths[i].pose.heading - math.pi) for i, j in pairs}
    straight = {pair for pair, angle in angles.items() if abs(angle) < STRAIGHT}
    for (i, j), angle in angles.items():
        lanes, to = driving_lane_indices(mouths[i].incoming), driving_lane_indices(mouths[j].outgoing)
        if (i, j) not in straight:
            opposite = any(i == one for one, _ in straight) and any(j == other for _, other in straight)
            number = 1 if opposite else (len(lanes) + 1) // 2
            lanes, to = (lanes[:number], to[:number]) if angle > 0 else (lanes[-number:], to[-number:])
        yield from (PlannedManeuver(i, lane, j, index) for lane, index in zip(lanes, to, strict=True))


def junction(id: int, mouths: Sequence[Mouth], maneuvers: Iterable[PlannedManeuver]) -> list[PlannedRoad]:
    """The roads of a junction: one for each maneuver, and one for each corner with a sidewalk along which none of these goes."""
    roads: list[PlannedRoad] = []

    def add(start: Mouth, end: Mouth, line: Line, left: Side, right: Side, references: tuple[PlannedSignal, ...] = ()) -> None:
        ends = Neighbour(start.road, start.contact), Neighbour(end.road, end.contact)
        roads.append(PlannedRoad(100 * id + len(roads), line, (PlannedSection(0.0, left, right),), *ends, junction=id, references=references))

    corners = {(i, (i + 1) % len(mouths)) for i in range(len(mouths))}
    for way in maneuvers:
        start, end = mouths[way.start], mouths[way.end]
        corner, left, right = lanes_beside_maneuver(mouths, way)
        corners.discard(corner)
        driving = PlannedLane("driving", start.incoming[way.lane].width, start.incoming_id(way.lane), end.outgoing_id(way.to))
        references = (PlannedSignal(start.signal, 0.0, 0.0, "+", (-1, -1)),) if start.signal is not None else ()
        add(start, end, maneuver_line(start, way.lane, end, way.to), left, (driving, *right), references)
    for one, other in sorted(corners):
        start, end = mouths[one], mouths[other]
        lanes = common(reversed(incoming_lanes(start)), reversed(outgoing_lanes(end)))[::-1]
        if any(lane.type == "sidewalk" for lane in lanes):
            add(start, end, maneuver_line(start, len(start.incoming) - len(lanes), end, len(end.outgoing) - len(lanes)), (), lanes)
    return roads


def maneuver_line(start: Mouth, lane: int, end: Mouth, to: int) -> Line:
    """The reference line from the left edge of an incoming lane to that of an outgoing one."""
    return junction_curve(start.pose.reversed().moved(0.0, breadth(start.incoming[:lane])), end.pose.moved(0.0, breadth(end.outgoing[:to])))


def lanes_beside_maneuver(mouths: Sequence[Mouth], way: PlannedManeuver) -> tuple[tuple[int, int] | None, Side, Side]:
    """The corner along which a maneuver goes, if any, and the lanes to its left and to its right that its road has too.

    These are all lanes along the corner; else a bike lane to the right, and what separates the directions of a road to the left.
    """
    start, end = mouths[way.start], mouths[way.end]
    lanes, to = driving_lane_indices(start.incoming), driving_lane_indices(end.outgoing)
    left, right, corner = (), (), None
    if (way.lane, way.to) == (lanes[-1], to[-1]):
        right = common(incoming_lanes(start)[way.lane + 1 :], outgoing_lanes(end)[way.to + 1 :])
        if way.end == (way.start + 1) % len(mouths):
            corner = way.start, way.end
        else:
            right = tuple(lane for lane in right if lane.type == "biking")
    if (way.lane, way.to) == (lanes[0], to[0]):
        left = common(reversed(incoming_lanes(start)[: way.lane]), reversed(outgoing_lanes(end)[: way.to]))
        if way.start == (way.end + 1) % len(mouths) and not driving_lane_indices(start.outgoing) and not driving_lane_indices(end.incoming):
            corner, left = (way.end, way.start), common(outgoing_lanes(start), incoming_lanes(end))
    return corner, left, right


def incoming_lanes(mouth: Mouth) -> list[tuple[PlannedLane, int]]:
    """The incoming lanes with their ids."""
    return [(lane, mouth.incoming_id(index)) for index, lane in enumerate(mouth.incoming)]


def outgoing_lanes(mouth: Mouth) -> list[tuple[PlannedLane, int]]:
    """The outgoing lanes with their ids."""
    return [(lane, mouth.outgoing_id(index)) for index, lane in enumerate(mouth.outgoing)]


def common(before: Iterable[tuple[PlannedLane, int]], after: Iterable[tuple[PlannedLane, int]]) -> Side:
    """Lanes that join those before to those after, up to the first that differ in type."""
    lanes: list[PlannedLane] = []
    for (one, id), (other, next_id) in zip(before, after, strict=False):
        if one.type != other.type:
            break
        lanes.append(PlannedLane(one.type, one.width, id, next_id))
    return tuple(lanes)
