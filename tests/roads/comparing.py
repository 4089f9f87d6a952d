"""How two descriptions of a network (`described`) differ, and by how much."""

from __future__ import annotations

import ast
import math
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from scenic_ref.roads import Network
from scenic_ref.semantics.space.vectors import Vector

from .described import Asked, Pairs, described

LINES = ("centerline", "leftEdge", "rightEdge", "curb")
PLACES = ("elementAt", "roadAt", "laneAt", "laneSectionAt", "laneGroupAt", "intersectionAt", "sidewalkAt", "shoulderAt")
NEAR_BORDER = 0.1
"""Metres from the border of an element within which a point may count as on it or not, since curves are drawn by chords."""

Described = Mapping[str, Mapping[str, Any]]
"""What a network says of itself: by the name of the element, by what is said."""


@dataclass(frozen=True)
class Difference:
    """Something that two networks say differently: of which element, what, and how far apart (None where it has no measure)."""

    element: str
    what: str
    ours: Any
    theirs: Any
    amount: float | None = None

    @property
    def kind(self) -> str:
        """What sort of element it is about."""
        words = self.element.split()
        if words[0] != "road":
            return words[0]
        return "lane section" if "lane" in words and "from" not in words else "lane" if "lane" in words else (
            words[-2] if len(words) == 4 and words[2] == "section" else "road" if len(words) == 2 else "group" if len(words) == 3 else words[-1]
        )  # fmt: skip


def of_ours(network: Network, lanes: Pairs, anywhere: Pairs) -> dict[str, dict[str, Any]]:
    """The description of our own network."""
    ask = Asked(
        vector=Vector, points=lambda line: [(v.x, v.y) for v in line], area=lambda region: region.measure() or 0.0,
        direction=lambda field, v: field.at(v), angles=list,
    )  # fmt: skip
    return described(network, ask, lanes, anywhere)


def points_of(network: Network, draw: random.Random, some: int = 10) -> tuple[Pairs, Pairs]:
    """Points along the middles of lanes, and points anywhere on the map; none of them is at a border."""
    middles = [lane.centerline.pointAlongBy((i + draw.random()) / some, normalized=True) for lane in network.lanes for i in range(some)]
    elements = [element.polygon for element in network.elements.values()]
    borders = shapely.STRtree([polygon.boundary for polygon in elements])
    west, south, east, north = shapely.total_bounds(elements)
    anywhere: list[tuple[float, float]] = []

    def clear(x: float, y: float) -> bool:
        return not len(borders.query(shapely.Point(x, y), predicate="dwithin", distance=NEAR_BORDER))

    while len(anywhere) < 100:
        near = draw.choice(middles) if draw.random() < 0.7 else Vector(draw.uniform(west, east), draw.uniform(south, north))
        x, y = near.x + draw.gauss(0, 4), near.y + draw.gauss(0, 4)
        if clear(x, y):
            anywhere.append((float(x), float(y)))
    return [(v.x, v.y) for v in middles if clear(v.x, v.y)], anywhere


def differences(ours: Described, theirs: Described) -> Iterator[Difference]:
    """All differences; those with a measure whatever it is."""
    for name in dict.fromkeys([*ours, *theirs]):
        if name not in ours or name not in theirs:
            yield Difference(name, "exists", name in ours, name in theirs)
            continue
        for what, mine in ours[name].items():
            other = theirs[name][what]
            yield from compared(name, what, mine, other)


def compared(name: str, what: str, mine: Any, other: Any) -> Iterator[Difference]:
    """The differences in one attribute."""
    if what in LINES:
        apart = furthest(mine, other)
        yield Difference(name, what, f"{len(mine)} points", f"{len(other)} points", apart)
        if along(mine, other) is False:
            yield Difference(name, f"direction of {what}", mine, other)
    elif what == "outline":
        one, two = shapely.from_wkt([mine, other])
        yield Difference(name, what, one.area, two.area, one.symmetric_difference(two).area / one.area)
    elif "area" in what:
        yield Difference(name, what, mine, other, abs(mine - other) / max(mine, other, 1.0))
    elif what == "roadDirection":
        yield Difference(name, what, mine, other, abs(math.remainder(mine - other, math.tau)))
    elif what == "nominalDirectionsAt":
        if len(mine) != len(other):
            yield Difference(name, f"number of {what}", mine, other)
        elif mine:
            yield Difference(name, what, mine, other, max(min(abs(math.remainder(a - b, math.tau)) for b in other) for a in mine))
    elif what in ("conflictingManeuvers", "reverseManeuvers"):
        for way in {*mine, *other}:
            one, two = mine.get(way, []), other.get(way, [])
            if one != two:
                yield Difference(f"{name} {ast.literal_eval(way)}", what, one, two)
    elif what in ("roads", "incomingLanes", "outgoingLanes") and isinstance(mine, list):
        if sorted(mine) != sorted(other):
            yield Difference(name, what, mine, other)
        elif turned(mine, mine[0]) != turned(other, mine[0]):
            yield Difference(name, f"order of {what}", mine, other)
    elif what == "maneuvers":
        if sorted(map(str, mine)) != sorted(map(str, other)):
            yield Difference(name, what, mine, other)
        elif mine != other:
            yield Difference(name, f"order of {what}", mine, other)
    elif json_like(mine) != json_like(other):
        yield Difference(name, what, mine, other)


def json_like(value: Any) -> Any:
    """A value with lists for tuples, as JSON has it."""
    return [json_like(one) for one in value] if isinstance(value, (list, tuple)) else value


def turned(cycle: Sequence[str], first: str) -> list[str]:
    """A cycle from one of its elements on."""
    start = cycle.index(first)
    return [*cycle[start:], *cycle[:start]]


def furthest(one: Pairs, other: Pairs) -> float:
    """Metres from a point of one line to the other line, at most."""
    return shapely.hausdorff_distance(shapely.LineString(one), shapely.LineString(other), densify=0.2)


def along(one: Pairs, other: Pairs) -> bool | None:
    """Whether two lines that are near each other have the same direction; None for lines of no length."""
    line = shapely.LineString(one)
    if line.length < 0.1:
        return None
    [start, end] = [line.project(shapely.Point(other[i]), normalized=True) for i in (0, -1)]
    return bool(np.sign(end - start) >= 0)
