"""The contents of a map, and its faults."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import shapely

from ..semantics.space.regions import PolylineRegion
from .network import Lane, LinearElement, ManeuverType, Network
from .opendrive import HEIGHTS

JOINT, TURNED = 0.01, math.radians(1)
"""Metres, and radians, by which lanes may differ where one leads to the other."""
BESIDE = 0.5
"""Metres from the end of a lane within which the next one begins, if it is the same lane."""


def summary(network: Network) -> dict[str, object]:
    """Return the contents of a map, as `scenic-ref map --json` prints them; lengths in metres.

    `roads` are those outside intersections, `lanes` are all, with those that lead through intersections;
    `maneuvers` counts the ways through intersections by their type, and as `merge` the ways from lane to lane
    outside them.
    """
    kinds = Counter(m.type for i in network.intersections for m in i.maneuvers)
    merges = sum(m.connectingLane is None for road in network.roads for lane in road.lanes for m in lane.maneuvers)
    west, south, east, north = shapely.total_bounds([element.polygon for element in network.by_uid.values()])
    names = {"straight": ManeuverType.STRAIGHT, "left": ManeuverType.LEFT_TURN, "right": ManeuverType.RIGHT_TURN, "u_turn": ManeuverType.U_TURN}
    return {
        "roads": len(network.roads), "lanes": len(network.lanes), "lane_sections": len(network.laneSections),
        "intersections": len(network.intersections), "four_way": sum(i.is4Way for i in network.intersections),
        "maneuvers": {**{name: kinds[kind] for name, kind in names.items()}, "merge": merges},
        "drivable_area_m2": round(network.drivableRegion.measure() or 0.0, 3), "sidewalk_area_m2": round(network.sidewalkRegion.measure() or 0.0, 3),
        "crosswalks": len(network.crossings), "shoulders": len(network.shoulders), "signals": len(network.signals),
        "bounds": [round(float(b), 3) for b in (west, south, east, north)], "warnings": list(network.warnings),
    }  # fmt: skip


def faults(network: Network) -> Iterator[str]:
    """Yield the faults of a map: joints that do not meet, roads that overlap, lanes that cannot be reached or
    left.
    """
    yield from (line for line in network.warnings if not line.startswith((HEIGHTS, "joints of lanes")))  # joints are told one by one
    for lane in network.lanes:
        yield from bad_joints(lane)
    for lane in network.lanes:
        yield from unreachable(lane)


def bad_joints(lane: Lane) -> Iterator[str]:
    """Yield the joints at which a lane does not continue smoothly: with a gap, or in another direction."""
    following = [m.connectingLane or m.endLane for m in lane.maneuvers]
    for one, other in [*((lane, f) for f in dict.fromkeys(following)), *pairwise(lane.sections)]:
        gap, turn = joint(one, other)
        if gap > JOINT:
            yield f"gap of {gap:.3f} m from {one.uid} to {other.uid}"
        elif turn > TURNED:
            yield f"bend of {math.degrees(turn):.1f} degrees from {one.uid} to {other.uid}"


def joint(one: LinearElement, other: LinearElement) -> tuple[float, float]:
    """Metres from the end of a lane to the beginning of another, and by how much their directions differ there."""
    (before, end), (begin, after) = points(one.centerline)[-2:], points(other.centerline)[:2]
    out, on = end - before, after - begin
    turn = math.remainder(math.atan2(out[1], out[0]) - math.atan2(on[1], on[0]), math.tau)
    chords = bend(one, end - before) + bend(other, after - begin)  # the points are on the curves, so that chords turn less than these
    return float(np.hypot(*(begin - end))), max(0.0, abs(turn) - chords)


def bend(element: LinearElement, chord: np.ndarray) -> float:
    """By how much the direction of a curve may differ from the line between two of its points."""
    return math.radians(2) if len(points(element.centerline)) > 2 else 0.0


def points(line: PolylineRegion) -> np.ndarray:
    """The points of a centerline."""
    return np.array([tuple(v) for v in line.lines[0]])


def unreachable(lane: Lane) -> Iterator[str]:
    """Yield that no lane leads to a lane, or from it, though its road goes on there; a lane may begin, or
    end, along its road.
    """
    road, ends = lane.road, (lane.road.sections[0], lane.road.sections[-1])
    (first, before), (last, after) = (ends[0], road._predecessor), (ends[1], road._successor)
    if not lane.sections[0].isForward:
        (first, before), (last, after) = (last, after), (first, before)
    if before is not None and lane.sections[0] in first.lanes and lane._predecessor is None:
        yield f"no lane leads to {lane.uid}"
    if after is not None and lane.sections[-1] in last.lanes and not lane.maneuvers and lane._successor is None:
        yield f"{lane.uid} leads nowhere"
    yield from unlinked_lane_ends(lane)


def unlinked_lane_ends(lane: Lane) -> Iterator[str]:
    """Yield that a lane ends along its road where another one begins, without a link."""
    last = lane.sections[-1]
    sections = lane.road.sections if last.isForward else lane.road.sections[::-1]
    end, place = points(last.centerline)[-1], next(k for k, section in enumerate(sections) if last in section.lanes)
    for other in sections[place + 1].lanes if place + 1 < len(sections) and lane._successor is None else ():
        if other.isForward == last.isForward and other._predecessor is None and np.hypot(*(points(other.centerline)[0] - end)) < BESIDE:
            yield f"{last.uid} ends where {other.uid} begins, without a link"
