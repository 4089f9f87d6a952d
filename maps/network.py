"""The network of a map: roads, lanes, intersections and what belongs to them, as plain immutable objects (names of the released library).

Positions are metres, headings radians anticlockwise from North, speeds m/s. Each area is a region. An attribute that begins with an underscore
is None where there is no such thing; the one without it rejects the run. Methods with a point take a vector, a pair or an object.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from inspect import get_annotations
from typing import Any, ClassVar, TypeVar

import shapely
from shapely.geometry import LineString, MultiPolygon, Point, Polygon

from ..semantics.space.absence import NotThere
from ..semantics.space.fields import Cell, PolygonalVectorField, VectorField
from ..semantics.space.numeric import lifted
from ..semantics.space.regions import PolygonalRegion, PolylineRegion, Region, nowhere
from ..semantics.space.vectors import Vector
from .shapes import united

TURN = math.radians(20)
"""The change of direction from which on a maneuver is a turn."""

T = TypeVar("T")
HIDDEN = frozenset({"polygon", "by_id", "by_uid", "first", "_tree", "strips", "gaps", "nearest", "scenic_names"})
"""What is no matter of programs."""


class VehicleType(enum.Enum):
    """Who may be on an element."""

    CAR = 1
    BICYCLE = 2


class ManeuverType(enum.Enum):
    """Kinds of maneuvers."""

    STRAIGHT = enum.auto()
    LEFT_TURN = enum.auto()
    RIGHT_TURN = enum.auto()
    U_TURN = enum.auto()


for _kind in (VehicleType, ManeuverType):
    _kind.scenic_names = frozenset()  # type: ignore[attr-defined]  # values of programs, with the attributes of any enumeration


class Fixed:
    """An object whose attributes are given once; programs may ask for those that its class tells of, as annotations, properties and methods."""

    scenic_names: ClassVar[frozenset[str]] = frozenset()

    def __init_subclass__(cls) -> None:
        """What programs may ask for."""
        members = (name for name, value in vars(cls).items() if callable(value) or isinstance(value, property | cached_property))
        told = {*get_annotations(cls), *members} - HIDDEN
        cls.scenic_names = frozenset(name for name in told if not name.startswith("__"))

    def __init__(self, **attributes: Any) -> None:
        vars(self).update(attributes)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable")


def complete(element: Fixed, **attributes: object) -> None:
    """Give an object, while the network is made, what did not exist when it was."""
    vars(element).update(attributes)


def there(found: T | None, what: str) -> T:
    """What was found. Raises `NotThere`."""
    if found is None:
        raise NotThere(what)
    return found


class NetworkElement(Fixed, PolygonalRegion):
    """A part of a network with an area, which is its region, oriented along traffic."""

    uid: str
    """Unique within the network."""
    id: str | None
    """Its id in the file."""
    network: Network
    polygon: Polygon | MultiPolygon
    vehicleTypes: frozenset[VehicleType] = frozenset([VehicleType.CAR])
    speedLimit: float | None = None
    tags: frozenset[str] = frozenset()

    def __init__(self, *, name: str = "", **attributes: Any) -> None:
        super().__init__(name=name or attributes["uid"], **attributes)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.uid}>"

    @cached_property
    def orientation(self) -> VectorField:  # type: ignore[override]
        """The direction of traffic."""
        return VectorField(f"direction of {self.uid}", self.heading_at)

    def heading_at(self, v: Vector) -> float:
        """The direction of traffic at a point."""
        raise NotImplementedError

    def nominalDirectionsAt(self, point: object) -> tuple[float, ...]:
        """The directions of traffic at a point."""
        return (self.heading_at(vector(point)),)


class LinearElement(NetworkElement):
    """An element that runs along a centerline, from its beginning to its end in the direction of traffic."""

    centerline: PolylineRegion
    leftEdge: PolylineRegion
    rightEdge: PolylineRegion
    strips: Sequence[tuple[Polygon, float]] = ()
    """It, cut across, with the heading of each part."""
    _successor: NetworkElement | None = None
    _predecessor: NetworkElement | None = None

    @property
    def successor(self) -> NetworkElement:
        """What comes after it; rejects if there is nothing."""
        return there(self._successor, f"{self.uid} has no successor")

    @property
    def predecessor(self) -> NetworkElement:
        """What comes before it; rejects if there is nothing."""
        return there(self._predecessor, f"{self.uid} has no predecessor")

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """Along the nearest part of the centerline."""
        return self.centerline.heading_at(v)

    def flowFrom(self, point: object, distance: float, steps: int | None = None, stepSize: float = 5) -> Vector:
        """The point that is reached along the direction of traffic: forward Euler in so many steps, or in steps of at most `stepSize`."""
        v = vector(point)
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
    sidewalkRegion: Region

    @property
    def is1Way(self) -> bool:
        """Whether all its lanes have one direction."""
        return self.forwardLanes is None or self.backwardLanes is None

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """That of the lane group there, else along the centerline."""
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
        """The point as far along another lane, so many to the right of the point's (to the left if negative); None if there is none."""
        v = vector(point)
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
    curb: PolylineRegion
    """The edge of the road on their side: that of the shoulder, if there is one; directed along traffic."""
    _sidewalk: Sidewalk | None = None
    _bikeLane: LaneSection | None = None
    _shoulder: Shoulder | None = None
    _opposite: LaneGroup | None = None

    @property
    def sidewalk(self) -> Sidewalk:
        """The sidewalk on their side; rejects if there is none."""
        return there(self._sidewalk, f"{self.uid} has no sidewalk")

    @property
    def bikeLane(self) -> BikeLane:
        """The bike lane on their side; rejects if there is none."""
        return there(self._bikeLane, f"{self.uid} has no bike lane")  # type: ignore[arg-type]

    @property
    def shoulder(self) -> Shoulder:
        """The shoulder on their side; rejects if there is none."""
        return there(self._shoulder, f"{self.uid} has no shoulder")

    @property
    def opposite(self) -> LaneGroup:
        """The lanes of the other direction; rejects on one-way roads."""
        return there(self._opposite, f"{self.uid} has no opposite lanes")

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """That of the lane there, else along the centerline."""
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

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """That of the lane there, else along the centerline."""
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
        found: LaneSection | None = self
        for _ in range(abs(offset)):
            found = None if found is None else found._laneToLeft if offset > 0 else found._laneToRight
        return found


class Sidewalk(LinearElement):
    """A sidewalk along a road."""

    road: Road
    crossings: tuple[PedestrianCrossing, ...] = ()


class BikeLane(LinearElement):
    """A bike lane along a road."""

    road: Road
    vehicleTypes = frozenset([VehicleType.BICYCLE])


class Shoulder(LinearElement):
    """A shoulder along a road, with parking lanes."""

    road: Road


class PedestrianCrossing(LinearElement):
    """A crosswalk; its centerline runs from one side of the road to the other."""

    parent: Road | Intersection
    startSidewalk: Sidewalk | None = None
    endSidewalk: Sidewalk | None = None


class Intersection(NetworkElement):
    """An intersection."""

    roads: tuple[Road, ...]
    """Anticlockwise around it."""
    incomingLanes: tuple[Lane, ...]
    outgoingLanes: tuple[Lane, ...]
    maneuvers: tuple[Maneuver, ...]
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

    @lifted(float)
    def heading_at(self, v: Vector) -> float:
        """That of the nearest connecting lane, the first of several; where there is none, in triangles of their middle's heading."""
        return self.network.roadDirection.at(v) if self.contains_point(v) else self.nearest(v).heading_at(v)

    def nearest(self, v: Vector) -> Lane:
        """The nearest connecting lane, the first of several."""
        lanes = [m.connectingLane for m in self.maneuvers if m.connectingLane is not None]
        return min(lanes, key=lambda lane: lane.distance_to(v))

    def gaps(self) -> list[Cell]:
        """What of it is on no connecting lane, in triangles with the direction of the nearest one at the middle of each."""
        lanes = shapely.union_all([m.connectingLane.polygon for m in self.maneuvers if m.connectingLane is not None])
        left = shapely.difference(self.polygon, lanes)
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(left)) if not left.is_empty else ()
        middles = ((part, Vector(part.centroid.x, part.centroid.y)) for part in triangles if part.area > 1e-6)
        return [(part, self.nearest(middle).heading_at(middle)) for part, middle in middles]

    def maneuversAt(self, point: object) -> tuple[Maneuver, ...]:
        """The maneuvers whose connecting lanes have a point; of the nearest one, if none has it."""
        v = vector(point)
        distances = [m.connectingLane.distance_to(v) if m.connectingLane else math.inf for m in self.maneuvers]
        nearest = max(min(distances, default=0.0), self.network.tolerance)
        return tuple(m for m, d in zip(self.maneuvers, distances, strict=True) if d <= nearest)

    def nominalDirectionsAt(self, point: object) -> tuple[float, ...]:
        """The directions of the maneuvers at a point."""
        v = vector(point)
        return tuple(m.connectingLane.heading_at(v) for m in self.maneuversAt(v) if m.connectingLane)


class Signal(Fixed):
    """A traffic light or sign."""

    uid: str
    openDriveID: str
    country: str
    type: str
    position: Vector
    roads: tuple[Road, ...]

    @property
    def isTrafficLight(self) -> bool:
        """Whether it is a traffic light for vehicles (OpenDRIVE: 1000001 and its kin)."""
        return self.type in TRAFFIC_LIGHTS

    def __repr__(self) -> str:
        return f"<Signal {self.uid}>"


TRAFFIC_LIGHTS = frozenset({"1000001", "1000008", "1000009", "1000010", "1000011", "1000012", "1000020"})


class Maneuver(Fixed):
    """A way on from the end of a lane: over a connecting lane through an intersection, or straight into the next lane."""

    type: ManeuverType
    startLane: Lane
    endLane: Lane
    connectingLane: Lane | None = None
    intersection: Intersection | None = None

    def __repr__(self) -> str:
        return f"<Maneuver {self.type.name} from {self.startLane.uid} to {self.endLane.uid}>"

    @cached_property
    def conflictingManeuvers(self) -> tuple[Maneuver, ...]:
        """The maneuvers of the intersection from other lanes whose connecting lanes' centerlines meet this one's."""
        if self.connectingLane is None or self.intersection is None:
            return ()
        line = self.connectingLane.centerline.polyline
        others = (m for m in self.intersection.maneuvers if m.startLane is not self.startLane and m.connectingLane is not None)
        return tuple(m for m in others if m.connectingLane is not None and m.connectingLane.centerline.polyline.intersects(line))

    @cached_property
    def reverseManeuvers(self) -> tuple[Maneuver, ...]:
        """The maneuvers of the intersection from the road at its end to the road at its start."""
        if self.intersection is None:
            return ()
        start, end = self.startLane.road, self.endLane.road
        return tuple(m for m in self.intersection.maneuvers if m.startLane.road is end and m.endLane.road is start)


def maneuver_type(start: Lane, end: Lane, connecting: Lane | None) -> ManeuverType:
    """By where it leads, and by how much the connecting lane turns between its ends."""
    if connecting is None:
        return ManeuverType.STRAIGHT
    if end.road is start.road:
        return ManeuverType.U_TURN
    [points] = connecting.centerline.lines
    first, last = points[1] - points[0], points[-1] - points[-2]
    turned = math.atan2(first.x * last.y - first.y * last.x, first.x * last.x + first.y * last.y)
    return ManeuverType.STRAIGHT if abs(turned) < TURN else ManeuverType.LEFT_TURN if turned > 0 else ManeuverType.RIGHT_TURN


class Network(Fixed):
    """All of a map."""

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

    def __repr__(self) -> str:
        return f"<Network of {len(self.roads)} roads and {len(self.intersections)} intersections>"

    @property
    def elements(self) -> dict[str, NetworkElement]:
        """All elements by their `uid`."""
        return dict(self.by_uid)

    @cached_property
    def roadRegion(self) -> Region:
        """All roads outside intersections."""
        return region(self.roads, "roadRegion")

    @cached_property
    def laneRegion(self) -> Region:
        """All lanes, with connecting lanes."""
        return region(self.lanes, "laneRegion")

    @cached_property
    def intersectionRegion(self) -> Region:
        """All intersections."""
        return region(self.intersections, "intersectionRegion", self.roadDirection)

    @cached_property
    def crossingRegion(self) -> Region:
        """All crosswalks."""
        return region(self.crossings, "crossingRegion")

    @cached_property
    def sidewalkRegion(self) -> Region:
        """All sidewalks."""
        return region(self.sidewalks, "sidewalkRegion")

    @cached_property
    def shoulderRegion(self) -> Region:
        """All shoulders."""
        return region(self.shoulders, "shoulderRegion", self.roadDirection)

    @cached_property
    def drivableRegion(self) -> Region:
        """Lanes, roads and intersections, oriented along traffic."""
        return region((*self.lanes, *self.roads, *self.intersections), "drivableRegion", self.roadDirection)

    @cached_property
    def roadOrShoulder(self) -> Region:
        """All that is drivable, and shoulders, oriented along traffic."""
        return region((*self.lanes, *self.roads, *self.intersections, *self.shoulders), "roadOrShoulder", self.roadDirection)

    @cached_property
    def walkableRegion(self) -> Region:
        """Sidewalks and crosswalks."""
        return region((*self.sidewalks, *self.crossings), "walkableRegion")

    @cached_property
    def curbRegion(self) -> Region:
        """The curbs of the roads outside intersections, each along traffic."""
        curbs = [LineString([tuple(v) for v in line]) for road in self.roads for group in road.laneGroups for line in group.curb.lines]
        return PolylineRegion(polyline=curbs, name="curbRegion") if curbs else nowhere

    @cached_property
    def roadDirection(self) -> VectorField:
        """The direction of traffic in an intersection (of the first connecting lane there), else on a road or shoulder; 0 away from them."""
        within = [lane for i in self.intersections for lane in dict.fromkeys(m.connectingLane for m in i.maneuvers) if lane is not None]
        others = [lane for lane in self.lanes if lane not in set(within)]
        cells: list[Cell] = [cell for lane in within for cell in lane.strips]
        cells += [cell for i in self.intersections for cell in i.gaps()]
        cells += [cell for element in (*others, *self.shoulders) for cell in element.strips]
        return PolygonalVectorField("roadDirection", cells, defaultHeading=0.0)

    @cached_property
    def _tree(self) -> tuple[shapely.STRtree, tuple[NetworkElement, ...]]:
        found = tuple(self.by_uid.values())
        return shapely.STRtree([element.polygon for element in found]), found

    def first(self, among: Sequence[T], point: object, reject: bool | str = False) -> T | None:
        """The first of some elements that has a point, or, if none has it, that is within `tolerance` of it.

        If there is none: None, or, if `reject` is true, the run is rejected (`NotThere`).
        """
        v = vector(point)
        tree, elements = self._tree
        for distance in (0.0, self.tolerance):
            near = tree.query(Point(v.x, v.y), predicate="dwithin", distance=distance)
            candidates = {elements[i] for i in near}
            found = next((element for element in among if element in candidates), None) if candidates else None
            if found is not None:
                return found
        if reject:
            raise NotThere(reject if isinstance(reject, str) else "there is no such element of the road network")
        return None

    def elementAt(self, point: object, reject: bool | str = False) -> NetworkElement | None:
        """The intersection, road, shoulder or sidewalk at a point."""
        return self.first((*self.intersections, *self.roads, *self.shoulders, *self.sidewalks), point, reject)

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
        found = self.first((*self.intersections, *self.roads, *self.shoulders), point, reject)
        return () if found is None else found.nominalDirectionsAt(point)

    def findPointIn(self, point: object, elems: Sequence[T], reject: bool | str) -> T | None:
        """`first`, under the released library's name."""
        return self.first(elems, point, reject)


def region(elements: Iterable[NetworkElement], name: str, orientation: VectorField | None = None) -> Region:
    """The union of elements; the empty region if there are none."""
    polygons = [element.polygon for element in elements]
    return PolygonalRegion(polygon=united(polygons), orientation=orientation, name=name) if polygons else nowhere


def vector(point: object) -> Vector:
    """A vector, a pair of numbers, or the position of an object."""
    if isinstance(point, Vector):
        return point
    position = getattr(point, "position", point)
    x, y = position  # type: ignore[misc]
    return Vector(float(x), float(y))
