"""Paths that vehicles follow: along lanes, one after the other."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import shapely
from shapely.geometry import LineString, Point
from shapely.ops import substring

from ..semantics.kernel.kinds import kind_name
from ..semantics.space.regions import PolylineRegion
from ..semantics.space.vectors import Vector
from .elements import LinearElement, vector
from .fixed import Fixed
from .opendrive import Numbers
from .shapes import Points

SIDEWAYS, SLOWING = 2.5, 3.0
"""Metres per second squared that a comfortable driver allows in a bend, and when braking before it."""
BEHIND, AHEAD = 5.0, 30.0
"""Metres around the last place along a path within which the next one is looked for."""
SHORTEST = 4.0
"""Metres that a driver looks ahead at least."""
LOOKED_AT, WINDOW = 60.0, 3.0
"""Metres ahead in which a driver looks for bends, and over which the direction changes there."""
STEP = 1.0
"""Metres between two points of a path at most, so that a bend is where it is."""
SECONDS = 0.7
"""How far a driver looks ahead, in seconds."""


class Trajectory(Fixed):
    """A line along elements, lines or points, from the first to the last. Raises `ValueError` for what has no length."""

    length: float
    points: Points
    line: LineString
    middles: Numbers
    directions: Numbers

    def __init__(self, parts: object, reverse: bool = False) -> None:
        points = np.array([tuple(v) for v in points_of(parts)], dtype=float).reshape(-1, 2)
        points = points[np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-3])] if len(points) else points
        if len(points) < 2:
            raise ValueError("a trajectory needs at least two different points")
        points = points[::-1] if reverse else points
        points = shapely.get_coordinates(LineString(points).segmentize(STEP))
        lengths = np.hypot(*np.diff(points, axis=0).T)
        ahead = np.diff(points, axis=0)
        vars(self).update(
            points=points, line=LineString(points), length=float(lengths.sum()), middles=np.cumsum(lengths) - lengths / 2,
            directions=np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0])),
        )  # fmt: skip

    def __repr__(self) -> str:
        return f"<Trajectory of {self.length:.1f} m>"

    def along(self, position: object, last: float | None = None) -> float:
        """How many metres along the path the point nearest to a position is; near the `last` such place, if that is given."""
        v = vector(position)
        if last is None:
            return float(self.line.project(Point(v.x, v.y)))
        low, high = max(0.0, last - BEHIND), min(self.length, last + AHEAD)
        return low + float(substring(self.line, low, high).project(Point(v.x, v.y)))

    def point(self, place: float) -> Vector:
        """The point that many metres along the path; behind its end it goes on straight."""
        if place > self.length:
            (a, b), (c, d) = self.points[-2:]
            length = math.hypot(c - a, d - b)
            return Vector(c + (c - a) / length * (place - self.length), d + (d - b) / length * (place - self.length))
        found = self.line.interpolate(max(0.0, place))
        return Vector(found.x, found.y)

    def steering(self, position: object, heading: float, speed: float, length: float, place: float) -> float:
        """The steering, from -1 (left) to 1 (right), that leads a vehicle of this length back onto the path: pure pursuit.

        The vehicle turns by speed · sin(steering · 90°) / length (radians per second), as in the simulators.
        """
        v = vector(position)
        target = self.point(place + max(SHORTEST, SECONDS * abs(speed))) - v
        distance = max(math.hypot(target.x, target.y), 1e-3)
        aside = math.atan2(-target.x, target.y) - heading  # to the left
        curvature = 2 * math.sin(aside) / distance
        return -math.asin(max(-1.0, min(1.0, curvature * length))) / (math.pi / 2)

    def speed_limit(self, place: float) -> float:
        """The speed (m/s) from which one can slow down in time for every bend ahead; very high on straight paths."""
        ahead = np.arange(0.0, LOOKED_AT, 1.0)
        at = np.minimum(place + ahead, self.length)
        turned = np.interp(at + WINDOW / 2, self.middles, self.directions) - np.interp(at - WINDOW / 2, self.middles, self.directions)
        return float(np.sqrt((SIDEWAYS / np.maximum(np.abs(turned) / WINDOW, 1e-9) + 2 * SLOWING * ahead).min()))


Trajectory.scenic_names = frozenset({"length", "along", "point", "steering", "speed_limit"})


def points_of(part: object) -> Iterable[Vector]:
    """The points of an element's centerline, of a line, of a list of parts, or a point. Raises `TypeError` for what has none."""
    if isinstance(part, LinearElement):
        return part.centerline
    if isinstance(part, PolylineRegion):
        return part
    if isinstance(part, (list, tuple)) and not (part and all(isinstance(x, (int, float)) for x in part)):
        return [v for inner in part for v in points_of(inner)]
    try:
        return [vector(part)]
    except (TypeError, ValueError):
        raise TypeError(f"a trajectory leads along lanes, lines and points, not along {kind_name(part)}") from None
