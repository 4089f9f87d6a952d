"""Paths that vehicles follow: along lanes, one after the other.

What a driver asks in each time step (how far along, which point is ahead, how sharp the bends are) is read off tables of the path: they are made once
for a path along the same elements of a map.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable
from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry import LineString

from ..semantics.machine.operand_kinds import kind_name
from ..semantics.space.regions import PolylineRegion
from ..semantics.space.vectors import Vector
from .immutable import Fixed
from .network import LinearElement, vector_at

SIDEWAYS, SLOWING = 2.5, 3.0
"""Metres per second squared that a comfortable driver allows in a bend, and when braking before it."""
BEHIND, AHEAD = 5.0, 30.0
"""Metres around the last place along a path within which the next one is looked for."""
SHORTEST = 4.0
"""Metres that a driver looks ahead at least."""
LOOKED_AT, WINDOW = 60, 3.0
"""Metres ahead in which a driver looks for bends, each metre, and over which the direction changes there."""
STEP = 1.0
"""Metres between two points of a path at most, so that a bend is where it is."""
SECONDS = 0.7
"""How far a driver looks ahead, in seconds."""
STRAIGHT = 1e-9
"""Radians per metre that every path turns by at least, so that its speed limit is a number."""
UNTURNED = 1e-11
"""Radians between two segments that are too few to matter, also where all that a driver looks at turn by so much."""
ROUNDING = 1e-6
"""Metres by which a bound of a distance may be wrong."""


class PathTable:
    """The segments of a path, as lists: its points, how far along each begins (and the last one ends), the direction of each, and its middle.

    `changes` are the segments that turn away from the one before. `nearest` are those that had the nearest points of the last two places: looking
    there first makes the next search short, and changes nothing of what it finds.
    """

    __slots__ = ("along", "changes", "directions", "length", "middles", "nearest", "xs", "ys")

    def __init__(self, points: np.ndarray) -> None:
        ahead = np.diff(points, axis=0)
        lengths = np.hypot(*ahead.T)
        self.xs: list[float] = points[:, 0].tolist()
        self.ys: list[float] = points[:, 1].tolist()
        self.along: list[float] = [0.0, *np.cumsum(lengths).tolist()]
        self.length = self.along[-1]
        self.middles: list[float] = (np.cumsum(lengths) - lengths / 2).tolist()
        directions = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        self.directions: list[float] = directions.tolist()
        self.changes: list[int] = (np.flatnonzero(np.abs(np.diff(directions)) > UNTURNED) + 1).tolist()
        self.nearest = 0, 0

    def project(self, x: float, y: float, low: float, high: float) -> float:
        """How many metres along the path, from `low` to `high` of them, the point nearest to a place is; the first one, if there are several.

        No point of the path is nearer to the place than the distance of another one less the way between the two: what is too far is passed over.
        """
        xs, ys, along = self.xs, self.ys, self.along
        first, last = self.segment(low), self.segment(high)
        bound = ROUNDING + min(self.nearest_on(min(max(k, first), last), x, y, low, high)[0] for k in self.nearest)
        best, found, at = math.inf, low, first
        k = first
        while k <= last:
            free = math.hypot(x - xs[k], y - ys[k]) - bound
            if free > STEP:
                beyond = bisect_right(along, along[k] + free - ROUNDING, k) - 1
                if beyond > k:
                    k = beyond
                    continue
            distance, place = self.nearest_on(k, x, y, low, high)
            if distance < best:
                best, found, at = distance, place, k
                bound = min(bound, best + ROUNDING)
            k += 1
        self.nearest = at, self.nearest[0]
        return found

    def segment(self, place: float) -> int:
        """The segment that has a place along the path."""
        return min(max(bisect_right(self.along, place) - 1, 0), len(self.xs) - 2)

    def nearest_on(self, k: int, x: float, y: float, low: float, high: float) -> tuple[float, float]:
        """The distance of a place from a segment, and how far along the path its nearest point is, from `low` to `high`."""
        ax, ay, begin, end = self.xs[k], self.ys[k], self.along[k], self.along[k + 1]
        dx, dy = self.xs[k + 1] - ax, self.ys[k + 1] - ay
        length = end - begin
        place = begin + ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy) * length
        low, high = low if low > begin else begin, high if high < end else end
        place = low if place < low else high if place > high else place
        share = (place - begin) / length
        return math.hypot(x - ax - share * dx, y - ay - share * dy), place

    def point(self, place: float) -> Vector:
        """The point that many metres along the path; behind its end it goes on straight."""
        k = self.segment(place)
        begin = self.along[k]
        share = (max(place, 0.0) - begin) / (self.along[k + 1] - begin)
        x, y = self.xs[k], self.ys[k]
        return Vector(x + share * (self.xs[k + 1] - x), y + share * (self.ys[k + 1] - y))

    def direction(self, place: float) -> float:
        """The direction there (radians): between the middles of two segments from that of one to that of the other."""
        middles, directions = self.middles, self.directions
        k = bisect_right(middles, place) - 1
        if k < 0:
            return directions[0]
        if k == len(middles) - 1:
            return directions[-1]
        begin = middles[k]
        return directions[k] + (directions[k + 1] - directions[k]) / (middles[k + 1] - begin) * (place - begin)

    def speed_limit(self, place: float) -> float:
        """The speed (m/s) from which one can slow down in time for every bend ahead; very high on straight paths."""
        least = SIDEWAYS / STRAIGHT
        bend = self.straight_until(place - WINDOW / 2) - WINDOW / 2 - place
        for ahead in range(max(0, math.floor(min(bend, LOOKED_AT))), LOOKED_AT):
            slowing = 2 * SLOWING * ahead
            if slowing >= least:
                break
            at = min(place + ahead, self.length)
            turned = abs(self.direction(at + WINDOW / 2) - self.direction(at - WINDOW / 2))
            least = min(least, SIDEWAYS / max(turned / WINDOW, STRAIGHT) + slowing)
        return math.sqrt(least)

    def straight_until(self, place: float) -> float:
        """Up to where the direction stays what it is at a place: to the middle of the segment before that in which it changes."""
        k = bisect_right(self.middles, place) - 1
        change = bisect_right(self.changes, k)
        return math.inf if change == len(self.changes) else self.middles[self.changes[change] - 1]


class Trajectory(Fixed):
    """A line along elements, lines or points, from the first to the last. Raises `ValueError` for what has no length."""

    length: float
    table: PathTable

    def __init__(self, parts: object, reverse: bool = False) -> None:
        elements = tuple(parts) if isinstance(parts, (list, tuple)) else (parts,)
        of_map = elements and all(isinstance(part, LinearElement) for part in elements)
        table = table_along(elements, bool(reverse)) if of_map else path_table(parts, reverse)
        vars(self).update(length=table.length, table=table)

    def __repr__(self) -> str:
        return f"<Trajectory of {self.length:.1f} m>"

    def along(self, position: object, last: float | None = None) -> float:
        """How many metres along the path the point nearest to a position is; near the `last` such place, if that is given."""
        v = vector_at(position)
        if last is None:
            return self.table.project(v.x, v.y, 0.0, self.length)
        return self.table.project(v.x, v.y, max(0.0, last - BEHIND), min(self.length, last + AHEAD))

    def point(self, place: float) -> Vector:
        """The point that many metres along the path; behind its end it goes on straight."""
        return self.table.point(place)

    def steering(self, position: object, heading: float, speed: float, length: float, place: float) -> float:
        """The steering, from -1 (left) to 1 (right), that leads a vehicle of this length back onto the path: pure pursuit.

        The vehicle turns by speed · sin(steering · 90°) / length (radians per second), as in the simulators.
        """
        v = vector_at(position)
        target = self.table.point(place + max(SHORTEST, SECONDS * abs(speed))) - v
        distance = max(math.hypot(target.x, target.y), 1e-3)
        aside = math.atan2(-target.x, target.y) - heading  # to the left
        curvature = 2 * math.sin(aside) / distance
        return -math.asin(max(-1.0, min(1.0, curvature * length))) / (math.pi / 2)

    def speed_limit(self, place: float) -> float:
        """The speed (m/s) from which one can slow down in time for every bend ahead; very high on straight paths."""
        return self.table.speed_limit(place)


Trajectory.scenic_names = frozenset({"length", "along", "point", "steering", "speed_limit"})


@lru_cache(maxsize=1024)
def table_along(elements: tuple[LinearElement, ...], reverse: bool) -> PathTable:
    """The table of a path along elements of a map, made once."""
    return path_table(elements, reverse)


def path_table(parts: object, reverse: bool) -> PathTable:
    """The table of a path. Raises `ValueError` for one that has no length."""
    points = np.array([tuple(v) for v in points_of(parts)], dtype=float).reshape(-1, 2)
    points = points[np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-3])] if len(points) else points
    if len(points) < 2:
        raise ValueError("a trajectory needs at least two different points")
    points = points[::-1] if reverse else points
    return PathTable(shapely.get_coordinates(LineString(points).segmentize(STEP)))


def points_of(part: object) -> Iterable[Vector]:
    """The points of an element's centerline, of a line, of a list of parts, or a point. Raises `TypeError` for what has none."""
    if isinstance(part, LinearElement):
        return part.centerline
    if isinstance(part, PolylineRegion):
        return part
    if isinstance(part, (list, tuple)) and not (part and all(isinstance(x, (int, float)) for x in part)):
        return [v for inner in part for v in points_of(inner)]
    try:
        return [vector_at(part)]
    except (TypeError, ValueError):
        raise TypeError(f"a trajectory leads along lanes, lines and points, not along {kind_name(part)}") from None
