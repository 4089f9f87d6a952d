"""Intersections of a road network, and the maneuvers through them (names of the released library)."""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping
from functools import cached_property

import numpy as np
import shapely

from ..semantics.space.fields import Cell
from ..semantics.space.numeric import lifted
from ..semantics.space.vectors import Vector
from .elements import Lane, LaneGroup, NetworkElement, PedestrianCrossing, Road, vector
from .fixed import Fixed
from .signals import Signal, turns_of

TURN = math.radians(20)
"""The change of direction from which on a maneuver is a turn."""


class ManeuverType(enum.Enum):
    """Kinds of maneuvers."""

    STRAIGHT = enum.auto()
    LEFT_TURN = enum.auto()
    RIGHT_TURN = enum.auto()
    U_TURN = enum.auto()

    @classmethod
    def guessTypeFromLanes(cls, start: Lane, end: Lane, connecting: Lane | None, turnThreshold: float = TURN) -> ManeuverType:
        """The type of a maneuver between two lanes, by another or None, if it turns from so many radians on (of the released library)."""
        if not isinstance(start, Lane) or not isinstance(end, Lane) or not isinstance(connecting, Lane | None):
            raise TypeError("guessTypeFromLanes(start, end, connecting) takes lanes")
        return maneuver_type(start, end, connecting, turnThreshold)


ManeuverType.scenic_names = frozenset({"guessTypeFromLanes"})  # type: ignore[attr-defined]  # its members are values of programs, with the attributes of any enumeration


class Intersection(NetworkElement):
    """An intersection."""

    roads: tuple[Road, ...]
    """Anticlockwise around it, as are the lanes."""
    incomingLanes: tuple[Lane, ...]
    outgoingLanes: tuple[Lane, ...]
    maneuvers: tuple[Maneuver, ...]
    """Those from one lane after each other, in the order of the file."""
    signals: tuple[Signal, ...] = ()
    crossings: tuple[PedestrianCrossing, ...] = ()

    @property
    def is3Way(self) -> bool:
        """Whether three roads meet."""
        return len(self.roads) == 3

    @property
    def is4Way(self) -> bool:
        """Whether four roads meet."""
        return len(self.roads) == 4

    @property
    def isSignalized(self) -> bool:
        """Whether there are signals."""
        return len(self.signals) > 0

    @cached_property
    def turns(self) -> Mapping[LaneGroup, int]:
        """The approaches with traffic lights, each with its turn to be green."""
        return turns_of(self)

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """That of the nearest connecting lane, the first of several; where there is none, in triangles of their middle's heading."""
        return self.network.roadDirection.at(v) if self.contains_point(v) else self.nearest(v).heading_at(v)

    def nearest(self, v: Vector) -> Lane:
        """The nearest connecting lane, the first of several."""
        return min(self.connecting, key=lambda lane: lane.distance_to(v))

    @property
    def connecting(self) -> list[Lane]:
        """Those of its maneuvers, in their order."""
        return [m.connectingLane for m in self.maneuvers if m.connectingLane is not None]

    def gaps(self) -> list[Cell]:
        """What of it is on no connecting lane, in triangles with the direction of the nearest one at the middle of each."""
        lanes = self.connecting
        shapes = np.array([lane.polygon for lane in lanes])
        left = shapely.difference(self.polygon, shapely.union_all(shapes))
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(left)) if not left.is_empty else np.array([])
        triangles = triangles[shapely.area(triangles) > 1e-6]
        middles = shapely.centroid(triangles)
        nearest = shapely.distance(middles[:, None], shapes[None]).argmin(axis=1) if len(triangles) else ()
        return [(part, lanes[k].heading_at(Vector(v.x, v.y))) for part, v, k in zip(triangles, middles, nearest, strict=True)]

    def maneuversAt(self, point: object) -> tuple[Maneuver, ...]:
        """The maneuvers whose connecting lanes have a point; if none has it, those within `tolerance` of it, else of the nearest one."""
        v = vector(point)
        distances = [m.connectingLane.distance_to(v) if m.connectingLane else math.inf for m in self.maneuvers]
        nearest = min(distances, default=0.0)
        within = 0.0 if nearest == 0.0 else max(nearest, self.network.tolerance)
        return tuple(m for m, d in zip(self.maneuvers, distances, strict=True) if d <= within)

    def nominalDirectionsAt(self, point: object) -> tuple[float, ...]:
        """The directions of the maneuvers at a point."""
        v = vector(point)
        return tuple(m.connectingLane.heading_at(v) for m in self.maneuversAt(v) if m.connectingLane)


class Maneuver(Fixed):
    """A way on from the end of a lane: over a connecting lane through an intersection, or straight into the next lane."""

    type: ManeuverType
    startLane: Lane
    endLane: Lane
    connectingLane: Lane | None = None
    intersection: Intersection | None = None

    def __repr__(self) -> str:
        return f"<Maneuver {self.type.name} from {self.startLane.uid} to {self.endLane.uid}>"

    def __reduce__(self) -> tuple[object, ...]:
        """It is pickled as one of its lane's."""
        return maneuver_of, (self.startLane, self.startLane.maneuvers.index(self))

    @cached_property
    def conflictingManeuvers(self) -> tuple[Maneuver, ...]:
        """The maneuvers of the intersection from other lanes whose connecting lanes' centerlines meet this one's: cross it, or end where it ends."""
        if self.connectingLane is None or self.intersection is None:
            return ()
        line = self.connectingLane.centerline.polyline
        others = (m for m in self.intersection.maneuvers if m.startLane is not self.startLane and m.connectingLane is not None)
        met = ((m, m.connectingLane.centerline.polyline) for m in others if m.connectingLane is not None)
        return tuple(m for m, other in met if m.endLane is self.endLane or other.intersects(line))

    @cached_property
    def reverseManeuvers(self) -> tuple[Maneuver, ...]:
        """The maneuvers of the intersection from the road at its end to the road at its start."""
        if self.intersection is None:
            return ()
        start, end = self.startLane.road, self.endLane.road
        return tuple(m for m in self.intersection.maneuvers if m.startLane.road is end and m.endLane.road is start)


def maneuver_type(start: Lane, end: Lane, connecting: Lane | None, turn: float = TURN) -> ManeuverType:
    """By where it leads, and by how much the connecting lane turns between its ends."""
    if connecting is None:
        return ManeuverType.STRAIGHT
    if end.road is start.road:
        return ManeuverType.U_TURN
    [points] = connecting.centerline.lines
    first, last = points[1] - points[0], points[-1] - points[-2]
    turned = math.atan2(first.x * last.y - first.y * last.x, first.x * last.x + first.y * last.y)
    return ManeuverType.STRAIGHT if abs(turned) < turn else ManeuverType.LEFT_TURN if turned > 0 else ManeuverType.RIGHT_TURN


def maneuver_of(lane: Lane, index: int) -> Maneuver:
    """The maneuver of a lane."""
    return lane.maneuvers[index]
