"""The network of a map: roads, lanes, intersections, maneuvers and traffic lights, the regions that they make up, and what is where.

The names are those of the released library.
"""

from __future__ import annotations

import enum
import itertools
import math
from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TypeVar

import numpy as np
import shapely
from shapely.geometry import LineString, MultiPolygon, Point, Polygon

from ..semantics.machine.values import Special
from ..semantics.python.builtin_rules import NO_PICKLES
from ..semantics.space.absence import Absent
from ..semantics.space.boundaries import METRES
from ..semantics.space.fields import Cell, PolygonalVectorField, VectorField
from ..semantics.space.numeric_functions import lift_method
from ..semantics.space.regions import AlongCurve, PolygonalRegion, PolylineRegion, Region, Workspace, everywhere, nowhere
from ..semantics.space.symbol_seam import Listed
from ..semantics.space.vectors import Vector
from ..semantics.store.sets import FrozenSet
from .immutable import Fixed, element_of
from .lane_edges import Points, directed_line, strips, union_closing_gaps
from .map_cache import keep_cells, load_cells

GREEN, YELLOW, CLEARING = 10.0, 3.0, 2.0
"""Seconds for which a light is green, then yellow, and for which all lights of its intersection are red before the next ones are green."""
NEAR = 25.0
"""Metres before the end of a lane within which a light stands beside the line at which its vehicles wait."""
TRAFFIC_LIGHTS = frozenset({"1000001", "1000008", "1000009", "1000010", "1000011", "1000012", "1000020"})


class Signal(Fixed):
    """A traffic light or sign."""

    uid: str
    openDriveID: str
    country: str
    type: str
    position: Vector
    roads: tuple[Road, ...]
    intersections: tuple[Intersection, ...] = ()
    """Those whose signal it is."""

    @property
    def isTrafficLight(self) -> bool:
        """Whether it is a traffic light for vehicles (OpenDRIVE: 1000001 and its kin)."""
        return self.type in TRAFFIC_LIGHTS

    def __repr__(self) -> str:
        return f"<Signal {self.uid}>"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the signal as a name in its network."""
        return signal_of, (self.roads[0].network, self.uid)

    @cached_property
    def turn(self) -> tuple[int, int] | None:
        """When its approach is green: after how many others, and how many take turns; None if it is no light for an approach of an intersection."""
        for i in self.intersections:
            for group, lights in lights_of(i).items():
                if self in lights:
                    return i.turns[group], 1 + max(i.turns.values())
        return None

    def stateAt(self, seconds: float) -> str:
        """`green`, `yellow` or `red`, so many seconds after the beginning of a simulation; `off` for what is no light of an intersection."""
        if self.turn is None:
            return "off"
        turn, count = self.turn
        period = GREEN + YELLOW + CLEARING
        within = (seconds - turn * period) % (count * period)
        return "green" if within < GREEN else "yellow" if within < GREEN + YELLOW else "red"

    def changesUntil(self, seconds: float) -> int:
        """How often it has changed until then, counted from when the first light of its intersection became green."""
        if self.turn is None:
            return 0
        turn, count = self.turn
        period = GREEN + YELLOW + CLEARING
        cycles, within = divmod(seconds - turn * period, count * period)
        return 3 * int(cycles) + (within >= GREEN) + (within >= GREEN + YELLOW)

    def stopLine(self, lane: Lane) -> float:
        """Metres along a lane at which its vehicles wait: beside the light, if it stands near the end of the lane, else at this end."""
        place = lane.centerline.polyline.project(Point(self.position.x, self.position.y))
        length = lane.centerline.polyline.length
        return place if length - place < NEAR else length


def lights_on_way(maneuver: Maneuver) -> tuple[Signal, ...]:
    """The lights for a way through an intersection: those that its connecting road names, else those of the road that it comes from."""
    if maneuver.connectingLane is None or maneuver.intersection is None:
        return ()
    for road in (maneuver.connectingLane.road, maneuver.startLane.road):
        found = tuple(s for s in road.signals if s.isTrafficLight and s in maneuver.intersection.signals)
        if found:
            return found
    return ()


def lights_of(intersection: Intersection) -> Mapping[LaneGroup, tuple[Signal, ...]]:
    """The lights of each approach, the lanes of a road that lead to the intersection, that has any."""
    found: dict[LaneGroup, dict[Signal, None]] = {}
    for maneuver in intersection.maneuvers:
        for light in lights_on_way(maneuver):
            found.setdefault(maneuver.startLane.group, {})[light] = None
    return {group: tuple(lights) for group, lights in found.items()}


def turns_of(intersection: Intersection) -> Mapping[LaneGroup, int]:
    """The approaches with lights, each with its turn to be green: no two whose ways conflict have the same."""
    conflicts: dict[LaneGroup, set[LaneGroup]] = {group: set() for group in lights_of(intersection)}
    for maneuver in intersection.maneuvers:
        others = {m.startLane.group for m in maneuver.conflictingManeuvers}
        conflicts.setdefault(maneuver.startLane.group, set()).update(others)
    turns: dict[LaneGroup, int] = {}
    for group in lights_of(intersection):
        taken = {turns[other] for other in conflicts[group] if other in turns}
        turns[group] = next(n for n in itertools.count() if n not in taken)
    return turns


def signal_of(network: Network, uid: str) -> Signal:
    """The signal of that name."""
    return next(signal for signal in network.signals if signal.uid == uid)


T = TypeVar("T")


class VehicleType(enum.Enum):
    """Who may be on an element."""

    CAR = 1
    BICYCLE = 2
    PEDESTRIAN = 3


VehicleType.scenic_names = frozenset()  # type: ignore[attr-defined]  # its members are values of programs, with the attributes of any enumeration


def there(found: T | None, what: str) -> T:
    """Return the element that was found. Raises `Absent` if there is none."""
    if found is None:
        raise Absent(what)
    return found


class NetworkElement(Fixed, PolygonalRegion, Listed):
    """A part of a network with an area, which is its region, oriented along traffic."""

    uid: str
    """Unique within the network."""
    id: str | None
    """Its id in the file."""
    network: Network
    polygon: Polygon | MultiPolygon
    vehicleTypes: frozenset[VehicleType] = FrozenSet([VehicleType.CAR])
    speedLimit: float | None = None
    tags: frozenset[str] = FrozenSet()

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.uid}>"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the element as a name in its network."""
        return element_of, (self.network, self.uid)

    @cached_property
    def orientation(self) -> VectorField:  # type: ignore[override]
        """The direction of traffic."""
        return VectorField(f"direction of {self.uid}", self.heading_at)

    @property
    def siblings(self) -> tuple[NetworkElement, ...]:
        """All elements of its class in the network."""
        return self.network.by_class[type(self)]

    @abstractmethod
    def heading_at(self, v: Vector) -> float:
        """The direction of traffic at a point."""

    def nominalDirectionsAt(self, point: object) -> tuple[float, ...]:
        """The directions of traffic at a point."""
        return (self.heading_at(vector_at(point)),)


class LinearElement(NetworkElement):
    """An element that runs along a centerline, from its beginning to its end in the direction of traffic."""

    left: Points
    """The points of its left edge, those of its right one and those of its middle, each in the direction of the traffic there."""
    right: Points
    middle: Points
    across: bool = True
    """Whether both edges have a point where one has, in the same direction, so that it can be cut across."""
    _successor: NetworkElement | None = None
    _predecessor: NetworkElement | None = None

    @cached_property
    def centerline(self) -> PolylineRegion:
        """The middle line of the element, in its direction."""
        return self.along(self.middle)

    @cached_property
    def orientation(self) -> VectorField:  # type: ignore[override]
        """The direction of traffic: that of the centerline, unless the element's own parts say more."""
        name = f"direction of {self.uid}"
        of_centerline = type(self).heading_at is LinearElement.heading_at
        return AlongCurve(name, self.centerline) if of_centerline else VectorField(name, self.heading_at)

    @cached_property
    def leftEdge(self) -> PolylineRegion:
        """The left edge, seen along the centerline, and directed along the traffic beside it: on roads with
        two directions against the right one.
        """
        return self.along(self.left)

    @cached_property
    def rightEdge(self) -> PolylineRegion:
        """The right edge, seen along the centerline."""
        return self.along(self.right)

    def along(self, line: Points) -> PolylineRegion:
        """A line along the element; one around which it turns is short."""
        return directed_line(line, self.middle[-1] - self.middle[0])

    @property
    def strips(self) -> Sequence[tuple[Polygon, float]]:
        """The element cut across, with the heading of each part; the whole element if its edges do not run
        along each other.
        """
        if self.across:
            return strips(self.left, self.right)
        heading = self.centerline.heading_at(Vector(self.polygon.centroid.x, self.polygon.centroid.y))
        return [(part, heading) for part in polygons(self.polygon)]

    @property
    def successor(self) -> NetworkElement:
        """The element after this one; rejects if there is none."""
        return there(self._successor, f"{self.uid} has no successor")

    @property
    def predecessor(self) -> NetworkElement:
        """The element before this one; rejects if there is none."""
        return there(self._predecessor, f"{self.uid} has no predecessor")

    def heading_at(self, v: Vector) -> float:
        """Along the nearest part of the centerline."""
        return self.centerline.heading_at(v)

    def flowFrom(self, point: object, distance: float, steps: int | None = None, stepSize: float = 5) -> Vector:
        """The point that is reached along the direction of traffic: forward Euler in so many steps, or in steps of at most `stepSize`."""
        v = vector_at(point)
        count = steps or max(1, math.ceil(abs(distance) / stepSize))
        for _ in range(count):
            heading = self.heading_at(v)
            v = v + Vector(-math.sin(heading), math.cos(heading)) * (distance / count)
        return v


class Road(LinearElement):
    """A road; its own direction is that in which the file draws it."""

    lanes: tuple[Lane, ...]
    forwardLanes: LaneGroup | None
    backwardLanes: LaneGroup | None
    laneGroups: tuple[LaneGroup, ...]
    sections: tuple[RoadSection, ...]
    signals: tuple[Signal, ...]
    crossings: tuple[PedestrianCrossing, ...] = ()
    sidewalks: tuple[Sidewalk, ...]
    """All of them, the one beside `forwardLanes` first."""

    @cached_property
    def sidewalkRegion(self) -> Region:
        """All of them, oriented along traffic."""
        return region(self.sidewalks, f"{self.uid} sidewalks")

    @property
    def strips(self) -> Sequence[tuple[Polygon, float]]:
        """The strips of the road's lanes."""
        return [cell for lane in self.lanes for cell in lane.strips]

    @property
    def is1Way(self) -> bool:
        """Whether all its lanes have one direction."""
        return self.forwardLanes is None or self.backwardLanes is None

    @lift_method(float)
    def heading_at(self, v: Vector) -> float:
        """Return the heading of the lane group at a point, else along the centerline."""
        group = self.laneGroupAt(v)
        return (group or self.centerline).heading_at(v)

    def sectionAt(self, point: object, reject: bool | str = False) -> RoadSection | None:
        """The section at a point."""
        return self.network.first(self.sections, point, reject)

    def laneSectionAt(self, point: object, reject: bool | str = False) -> LaneSection | None:
        """The section of a lane at a point."""
        lane = self.laneAt(point, reject)
        return None if lane is None else lane.sectionAt(point, reject)

    def laneAt(self, point: object, reject: bool | str = False) -> Lane | None:
        """The lane at a point."""
        return self.network.first(self.lanes, point, reject)

    def laneGroupAt(self, point: object, reject: bool | str = False) -> LaneGroup | None:
        """The lanes of one direction at a point."""
        return self.network.first(self.laneGroups, point, reject)

    def crossingAt(self, point: object, reject: bool | str = False) -> PedestrianCrossing | None:
        """The crosswalk at a point."""
        return self.network.first(self.crossings, point, reject)

    def shiftLanes(self, point: object, offset: int) -> Vector | None:
        """The point as far along another lane, so many to the left of the point's (to the right if negative); None if there is none."""
        v = vector_at(point)
        section = self.laneSectionAt(v)
        other = None if section is None else section.shiftedBy(offset)
        if section is None or other is None:
            return None
        along = section.centerline.polyline.project(Point(v.x, v.y), normalized=True)
        same = other.isForward == section.isForward
        return other.centerline.pointAlongBy(along if same else 1 - along, normalized=True)


class LaneGroup(LinearElement):
    """The lanes of a road with one direction: `lanes[0]` is nearest to the curb."""

    road: Road
    lanes: tuple[Lane, ...]
    outermost: Points
    """The points of the edge of the road on their side: that of the shoulder, if there is one."""
    _sidewalk: Sidewalk | None = None
    _bikeLane: BikeLane | None = None
    _shoulder: Shoulder | None = None
    _opposite: LaneGroup | None = None

    @cached_property
    def curb(self) -> PolylineRegion:
        """The edge of the road on their side: that of the shoulder, if there is one; directed along traffic."""
        return self.along(self.outermost)

    @property
    def sidewalk(self) -> Sidewalk:
        """The sidewalk on their side; rejects if there is none."""
        return there(self._sidewalk, f"{self.uid} has no sidewalk")

    @property
    def bikeLane(self) -> BikeLane:
        """The bike lane on their side; rejects if there is none."""
        return there(self._bikeLane, f"{self.uid} has no bike lane")

    @property
    def shoulder(self) -> Shoulder:
        """The shoulder on their side; rejects if there is none."""
        return there(self._shoulder, f"{self.uid} has no shoulder")

    @property
    def opposite(self) -> LaneGroup:
        """The lanes of the other direction; rejects on one-way roads."""
        return there(self._opposite, f"{self.uid} has no opposite lanes")

    @lift_method(float)
    def heading_at(self, v: Vector) -> float:
        """Return the heading of the lane at a point, else along the centerline."""
        return (self.laneAt(v) or self.centerline).heading_at(v)

    def laneAt(self, point: object, reject: bool | str = False) -> Lane | None:
        """The lane at a point."""
        return self.network.first(self.lanes, point, reject)


class Lane(LinearElement):
    """A lane of a road, from where it begins to where it ends."""

    group: LaneGroup
    road: Road
    sections: tuple[LaneSection, ...]
    adjacentLanes: tuple[Lane, ...] = ()
    maneuvers: tuple[Maneuver, ...] = ()
    _trafficLight: Signal | None = None
    """The light for those who leave it through an intersection."""

    @property
    def trafficLight(self) -> Signal:
        """The light for those who leave it through an intersection; rejects if there is none."""
        return there(self._trafficLight, f"{self.uid} has no traffic light")

    def sectionAt(self, point: object, reject: bool | str = False) -> LaneSection | None:
        """The section at a point."""
        return self.network.first(self.sections, point, reject)


class RoadSection(LinearElement):
    """A part of a road in which its lanes stay the same; `lanes[0]` is the rightmost."""

    road: Road
    lanes: tuple[LaneSection, ...]
    forwardLanes: tuple[LaneSection, ...]
    backwardLanes: tuple[LaneSection, ...]
    by_id: Mapping[int, LaneSection]

    @property
    def lanesByOpenDriveID(self) -> dict[int, LaneSection]:
        """The lanes by their numbers in the file."""
        return dict(self.by_id)

    @lift_method(float)
    def heading_at(self, v: Vector) -> float:
        """Return the heading of the lane at a point, else along the centerline."""
        return (self.laneAt(v) or self.centerline).heading_at(v)

    def laneAt(self, point: object, reject: bool | str = False) -> LaneSection | None:
        """The lane at a point."""
        return self.network.first(self.lanes, point, reject)


class LaneSection(LinearElement):
    """The part of a lane in a section of its road."""

    lane: Lane
    group: LaneGroup
    road: Road
    openDriveID: int
    isForward: bool
    """Whether traffic has the road's own direction."""
    adjacentLanes: tuple[LaneSection, ...] = ()
    _laneToLeft: LaneSection | None = None
    _laneToRight: LaneSection | None = None
    _fasterLane: LaneSection | None = None
    _slowerLane: LaneSection | None = None

    @property
    def laneToLeft(self) -> LaneSection:
        """The lane to the left, whatever its direction; rejects if there is none."""
        return there(self._laneToLeft, f"{self.uid} has no lane to its left")

    @property
    def laneToRight(self) -> LaneSection:
        """The lane to the right, whatever its direction; rejects if there is none."""
        return there(self._laneToRight, f"{self.uid} has no lane to its right")

    @property
    def fasterLane(self) -> LaneSection:
        """The next lane with this direction away from the curb; rejects if there is none."""
        return there(self._fasterLane, f"{self.uid} has no faster lane")

    @property
    def slowerLane(self) -> LaneSection:
        """The next lane with this direction towards the curb; rejects if there is none."""
        return there(self._slowerLane, f"{self.uid} has no slower lane")

    def shiftedBy(self, offset: int) -> LaneSection | None:
        """The lane so many to the left, or to the right if negative; None if there is none."""
        found, away = self, offset
        for _ in range(abs(offset)):
            following = None if found is None else found._laneToLeft if away > 0 else found._laneToRight
            turned = found is not None and following is not None and following.isForward is not found.isForward
            found, away = following, -away if turned else away
        return found


class BesideRoad(LinearElement):
    """An element that lies along a road."""

    _road: Road | None

    @property
    def road(self) -> Road:
        """The road that it belongs to; rejects if that has no lanes."""
        return there(self._road, f"{self.uid} belongs to no road with lanes")


class Sidewalk(BesideRoad):
    """A sidewalk along a road."""

    crossings: tuple[PedestrianCrossing, ...] = ()


class BikeLane(BesideRoad):
    """A bike lane along a road."""

    vehicleTypes = FrozenSet([VehicleType.BICYCLE])


class Shoulder(BesideRoad):
    """A shoulder along a road, with parking lanes."""


class PedestrianCrossing(LinearElement):
    """A crosswalk; its centerline runs from one side of the road to the other."""

    parent: Road | Intersection
    startSidewalk: Sidewalk | None = None
    endSidewalk: Sidewalk | None = None


def vector_at(point: object) -> Vector:
    """A vector, a pair of numbers, or the position of an object."""
    if isinstance(point, Vector):
        return point
    position = getattr(point, "position", point)
    x, y = position  # type: ignore[misc]
    return Vector(float(x), float(y))


TURN = math.radians(20)
"""The change of direction from which on a maneuver is a turn."""


class ManeuverType(enum.Enum):
    """The kinds of maneuvers: straight on, a left turn, a right turn, a U-turn."""

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
    """An intersection of several roads."""

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

    @lift_method(float)
    def heading_at(self, v: Vector) -> float:
        """Return the heading of the nearest connecting lane, the first of several; where there is none, in
        triangles of their middle's heading.
        """
        return self.network.roadDirection.at(v) if self.contains_point(v) else self.nearest(v).heading_at(v)

    def nearest(self, v: Vector) -> Lane:
        """The nearest connecting lane, the first of several."""
        return min(self.connecting, key=lambda lane: lane.distance_to(v))

    @property
    def connecting(self) -> list[Lane]:
        """Return the connecting lanes of the maneuvers, in their order."""
        return [m.connectingLane for m in self.maneuvers if m.connectingLane is not None]

    def gaps(self) -> list[Cell]:
        """Return the parts on no connecting lane, as triangles with the direction of the nearest one at the
        middle of each.
        """
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
        v = vector_at(point)
        distances = [m.connectingLane.distance_to(v) if m.connectingLane else math.inf for m in self.maneuvers]
        nearest = min(distances, default=0.0)
        within = 0.0 if nearest == 0.0 else max(nearest, self.network.tolerance)
        return tuple(m for m, d in zip(self.maneuvers, distances, strict=True) if d <= within)

    def nominalDirectionsAt(self, point: object) -> tuple[float, ...]:
        """The directions of the maneuvers at a point."""
        v = vector_at(point)
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
        """Pickle the maneuver as one of its lane's."""
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


class OfNetwork:
    """A part of a network that is pickled by its name there."""

    scenic_made = True

    network: Network

    def __reduce__(self) -> tuple[object, ...]:
        return getattr, (self.network, self.name)  # type: ignore[attr-defined]


class NetworkRegion(OfNetwork, PolygonalRegion):
    """A region of a network."""


class NetworkCurve(OfNetwork, PolylineRegion):
    """A curve of a network."""


class NetworkField(OfNetwork, PolygonalVectorField):
    """A field of a network."""


def region(elements: Sequence[LinearElement], name: str, network: Network | None = None) -> Region:
    """The union of elements, oriented by the first of them at a point; the empty region if there are none."""
    cells: list[Cell] = [cell for element in elements for cell in element.strips]
    return region_along(elements, name, PolygonalVectorField(f"direction of {name}", cells), network)


def region_along(elements: Sequence[NetworkElement], name: str, orientation: VectorField, network: Network | None) -> Region:
    """The union of elements, oriented by a field; the empty region if there are none."""
    if not elements:
        return nowhere
    whole = union_closing_gaps([element.polygon for element in elements])
    if network is None:
        return PolygonalRegion(polygon=whole, orientation=orientation, name=name)
    made = NetworkRegion(polygon=whole, orientation=orientation, name=name)
    made.network = network
    return made


def fringe(cells: Sequence[Cell], elements: Sequence[NetworkElement], width: float) -> list[Cell]:
    """Return the surroundings of elements up to `width`: their cells widened so much, in their order, where
    they come out of the elements.
    """
    if not cells:
        return []
    whole = union_closing_gaps([element.polygon for element in elements])
    shapely.prepare(whole)
    wider = shapely.buffer([polygon for polygon, _ in cells], width, quad_segs=2)
    outside = ~shapely.covers(whole, wider)
    return [(polygon, heading) for polygon, (_, heading), kept in zip(wider, cells, outside, strict=True) if kept]


def polygons(shape: Polygon | MultiPolygon) -> list[Polygon]:
    """The polygons of an area."""
    return list(shape.geoms) if isinstance(shape, MultiPolygon) else [shape]


Element = TypeVar("Element", bound=NetworkElement)

CELL = 8.0
"""Metres from one line to the next of the grid in which elements are looked up."""
MOST_CELLS = 100_000
"""So many cells are kept."""


class MapWorkspace(Workspace):
    """The workspace of programs on a map: the whole plane, for pictures with the map."""

    scenic_made = True

    def __init__(self, network: Network) -> None:
        super().__init__(everywhere)
        self.network = network

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the workspace as that of its network."""
        return getattr, (self.network, "workspace")


class Network(Fixed):
    """All of a map."""

    as_region = "the network is the whole map: write one of its regions, such as `road` or `network.lanes[0]`"
    """What to write for it where a region is meant."""
    source: bytes
    """The file that it was read from."""
    again: Callable[[bytes], Network]
    """What reads it again."""
    by_uid: Mapping[str, NetworkElement]
    roads: tuple[Road, ...]
    """Those outside intersections."""
    connectingRoads: tuple[Road, ...]
    """Those within."""
    allRoads: tuple[Road, ...]
    laneGroups: tuple[LaneGroup, ...]
    lanes: tuple[Lane, ...]
    """With connecting lanes."""
    intersections: tuple[Intersection, ...]
    crossings: tuple[PedestrianCrossing, ...]
    sidewalks: tuple[Sidewalk, ...]
    shoulders: tuple[Shoulder, ...]
    bikeLanes: tuple[BikeLane, ...]
    roadSections: tuple[RoadSection, ...]
    laneSections: tuple[LaneSection, ...]
    signals: tuple[Signal, ...]
    driveOnLeft: bool
    tolerance: float
    """Metres within which a point still counts as on an element, where it is on none."""
    warnings: tuple[str, ...]
    """What is strange in the file, a line each."""

    fromFile = Special("Network.fromFile")
    """In programs: the map of a file."""
    fromOpenDrive = fromFile
    """The same: there is one format."""
    fromPickle = Special("Network.fromPickle")
    """In programs: an error that says what to do instead."""

    def __repr__(self) -> str:
        return f"<Network of {len(self.roads)} roads and {len(self.intersections)} intersections>"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the network as the file from which it is read."""
        return self.again, (self.source,)

    @property
    def elements(self) -> dict[str, NetworkElement]:
        """All elements by their `uid`."""
        return dict(self.by_uid)

    @cached_property
    def workspace(self) -> MapWorkspace:
        """The whole plane, with the map below pictures."""
        return MapWorkspace(self)

    @cached_property
    def roadRegion(self) -> Region:
        """All roads outside intersections, oriented along traffic."""
        return region(self.roads, "roadRegion", self)

    @cached_property
    def laneRegion(self) -> Region:
        """All lanes, with connecting lanes, oriented along traffic."""
        return region(self.lanes, "laneRegion", self)

    @cached_property
    def intersectionRegion(self) -> Region:
        """The region of all intersections."""
        return region_along(self.intersections, "intersectionRegion", self.roadDirection, self)

    @cached_property
    def crossingRegion(self) -> Region:
        """All crosswalks, each oriented across the road."""
        return region(self.crossings, "crossingRegion", self)

    @cached_property
    def sidewalkRegion(self) -> Region:
        """All sidewalks, oriented along the traffic beside them."""
        return region(self.sidewalks, "sidewalkRegion", self)

    @cached_property
    def shoulderRegion(self) -> Region:
        """The region of all shoulders."""
        return region_along(self.shoulders, "shoulderRegion", self.roadDirection, self)

    @cached_property
    def drivableRegion(self) -> Region:
        """Lanes, roads and intersections, oriented along traffic."""
        return region_along((*self.lanes, *self.roads, *self.intersections), "drivableRegion", self.roadDirection, self)

    @cached_property
    def roadOrShoulder(self) -> Region:
        """All that is drivable, and shoulders, oriented along traffic."""
        return region_along((*self.lanes, *self.roads, *self.intersections, *self.shoulders), "roadOrShoulder", self.roadDirection, self)

    @cached_property
    def walkableRegion(self) -> Region:
        """Sidewalks and crosswalks, each with its orientation."""
        return region((*self.sidewalks, *self.crossings), "walkableRegion", self)

    @cached_property
    def curbRegion(self) -> Region:
        """The curbs of the roads outside intersections, each along traffic."""
        curbs = [LineString([tuple(v) for v in line]) for road in self.roads for group in road.laneGroups for line in group.curb.lines]
        if not curbs:
            return nowhere
        made = NetworkCurve(polyline=curbs, name="curbRegion")
        made.network = self
        return made

    @cached_property
    def roadDirection(self) -> VectorField:
        """The direction of traffic in an intersection (of the first connecting lane there), else on a road or shoulder; 0 away from them.

        What is within `tolerance` of one has its direction, as for `first`: points of curbs may miss the road by rounding.
        """
        cells = load_cells(self.source, self.tolerance)
        if cells is None:
            cells = self.direction_cells()
            keep_cells(self.source, self.tolerance, cells)
        made = NetworkField("roadDirection", cells, defaultHeading=0.0)
        made.network = self
        return made

    def direction_cells(self) -> list[Cell]:
        """The parts of `roadDirection`, the first that has a point being the one that counts."""
        within = [lane for i in self.intersections for lane in dict.fromkeys(m.connectingLane for m in i.maneuvers) if lane is not None]
        others = [lane for lane in self.lanes if lane not in set(within)]
        cells: list[Cell] = [cell for lane in within for cell in lane.strips]
        cells += [cell for i in self.intersections for cell in i.gaps()]
        cells += [cell for element in (*others, *self.shoulders) for cell in element.strips]
        return [*cells, *fringe(cells, (*self.lanes, *self.shoulders, *self.intersections), self.tolerance)]

    @cached_property
    def by_class(self) -> Mapping[type, tuple[NetworkElement, ...]]:
        """The elements of each class."""
        elements = self.by_uid.values()
        return {kind: tuple(one for one in elements if type(one) is kind) for kind in set(map(type, elements))}

    @cached_property
    def _tree(self) -> tuple[shapely.STRtree, tuple[NetworkElement, ...]]:
        found = tuple(self.by_uid.values())
        for element in found:
            shapely.prepare(element.polygon)
        return shapely.STRtree([element.polygon for element in found]), found

    @cached_property
    def _near(self) -> dict[tuple[int, int, int], tuple[tuple[NetworkElement, ...], tuple[NetworkElement, ...]]]:
        return {}

    def near(self, among: tuple[Element, ...], v: Vector) -> tuple[Element, ...]:
        """Return those of some elements that may be within `tolerance` of a point, in their order; the
        elements near each cell of a grid are looked up once.
        """
        if not (math.isfinite(v.x) and math.isfinite(v.y)):
            return ()
        column, row = math.floor(v.x / CELL), math.floor(v.y / CELL)
        found = self._near.get((id(among), column, row))
        if found is None:
            tree, elements = self._tree
            margin = 2 * self.tolerance + METRES
            cell = shapely.box(CELL * column - margin, CELL * row - margin, CELL * (column + 1) + margin, CELL * (row + 1) + margin)
            within = {elements[i] for i in tree.query(cell)}
            if len(self._near) >= MOST_CELLS:
                self._near.clear()
            found = self._near[id(among), column, row] = among, tuple(element for element in among if element in within)
        return found[1]  # type: ignore[return-value]

    def first(self, among: tuple[Element, ...], point: object, reject: bool | str = False) -> Element | None:
        """The first of some elements that has a point, or, if none has it, that is within `tolerance` of it.

        If there is none: None, or, if `reject` is true, the run is rejected (`Absent`).
        """
        v = vector_at(point)
        return self.first_of(self.near(among, v), v, reject)

    def first_of(self, candidates: Iterable[Element], v: Vector, reject: bool | str) -> Element | None:
        """`first`, of some elements in their order, one of which is the first if there is one."""
        place = shapely.points(v.x, v.y)
        for distance in (0.0, self.tolerance):
            for element in candidates:
                if shapely.dwithin(element.polygon, place, distance):
                    return element
        if reject:
            raise Absent(reject if isinstance(reject, str) else "there is no such element of the road network")
        return None

    @cached_property
    def _surfaces(self) -> tuple[NetworkElement, ...]:
        return (*self.intersections, *self.roads, *self.shoulders, *self.sidewalks)

    @cached_property
    def _directed(self) -> tuple[NetworkElement, ...]:
        return (*self.intersections, *self.roads, *self.shoulders)

    def elementAt(self, point: object, reject: bool | str = False) -> NetworkElement | None:
        """The intersection, road, shoulder or sidewalk at a point."""
        return self.first(self._surfaces, point, reject)

    def roadAt(self, point: object, reject: bool | str = False) -> Road | None:
        """The road at a point, or the connecting road."""
        return self.first(self.allRoads, point, reject)

    def laneAt(self, point: object, reject: bool | str = False) -> Lane | None:
        """The lane at a point."""
        return self.first(self.lanes, point, reject)

    def laneSectionAt(self, point: object, reject: bool | str = False) -> LaneSection | None:
        """The section of a lane at a point."""
        lane = self.laneAt(point, reject)
        return None if lane is None else lane.sectionAt(point)

    def laneGroupAt(self, point: object, reject: bool | str = False) -> LaneGroup | None:
        """The lanes of one direction at a point."""
        road = self.roadAt(point, reject)
        return None if road is None else road.laneGroupAt(point, reject)

    def crossingAt(self, point: object, reject: bool | str = False) -> PedestrianCrossing | None:
        """The crosswalk at a point."""
        return self.first(self.crossings, point, reject)

    def intersectionAt(self, point: object, reject: bool | str = False) -> Intersection | None:
        """The intersection at a point."""
        return self.first(self.intersections, point, reject)

    def sidewalkAt(self, point: object, reject: bool | str = False) -> Sidewalk | None:
        """The sidewalk at a point."""
        return self.first(self.sidewalks, point, reject)

    def shoulderAt(self, point: object, reject: bool | str = False) -> Shoulder | None:
        """The shoulder at a point."""
        return self.first(self.shoulders, point, reject)

    def nominalDirectionsAt(self, point: object, reject: bool | str = False) -> tuple[float, ...]:
        """The directions of traffic at a point: several in an intersection, none away from roads."""
        found = self.first(self._directed, point, reject)
        return () if found is None else found.nominalDirectionsAt(point)

    def dumpPickle(self, path: object = None, digest: object = None, optionsDigest: object = None) -> None:
        """Refused, since nobody may read what it would write. Raises `ValueError`."""
        raise ValueError(NO_PICKLES)

    def show(self, labelIncomingLanes: bool = False, showCurbArrows: bool = False) -> None:
        """Nothing: in a program nobody looks. `scenic-ref map FILE --plot PICTURE` draws a map (of the released library)."""

    def findPointIn(self, point: object, elems: Sequence[Element], reject: bool | str) -> Element | None:
        """`first`, under the released library's name."""
        v = vector_at(point)
        there = [element for element in self.near(self._tree[1], v) if element in elems]
        return self.first_of(sorted(there, key=elems.index), v, reject)  # type: ignore[arg-type]

