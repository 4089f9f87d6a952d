"""The network of a map: roads, lanes, intersections and what belongs to them, as plain immutable objects (names of the released library).

Positions are metres, headings radians anticlockwise from North, speeds m/s. Each area is a region. An attribute that begins with an underscore
is None where there is no such thing; the one without it rejects the run. Methods with a point take a vector, a pair or an object.
"""

from __future__ import annotations

import enum
import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from shapely.geometry import MultiPolygon, Point, Polygon

from ..semantics.kernel.sets import FrozenSet
from ..semantics.space.absence import Absent
from ..semantics.space.fields import VectorField
from ..semantics.space.numeric import lifted
from ..semantics.space.regions import AlongCurve, PolygonalRegion, PolylineRegion, Region
from ..semantics.space.symbols import Listed
from ..semantics.space.vectors import Vector
from .fixed import Fixed, element_of
from .regions import polygons, region
from .shapes import Points, directed, strips

if TYPE_CHECKING:
    from .intersections import Intersection, Maneuver
    from .network import Network
    from .signals import Signal

T = TypeVar("T")


class VehicleType(enum.Enum):
    """Who may be on an element."""

    CAR = 1
    BICYCLE = 2
    PEDESTRIAN = 3


VehicleType.scenic_names = frozenset()  # type: ignore[attr-defined]  # its members are values of programs, with the attributes of any enumeration


def there(found: T | None, what: str) -> T:
    """What was found. Raises `Absent`."""
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
        """It is pickled as a name in its network."""
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
        return (self.heading_at(vector(point)),)


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
        """Its middle, in its direction."""
        return self.along(self.middle)

    @cached_property
    def orientation(self) -> VectorField:  # type: ignore[override]
        """The direction of traffic: that of the centerline, unless the element's own parts say more."""
        name = f"direction of {self.uid}"
        of_centerline = type(self).heading_at is LinearElement.heading_at
        return AlongCurve(name, self.centerline) if of_centerline else VectorField(name, self.heading_at)

    @cached_property
    def leftEdge(self) -> PolylineRegion:
        """Its left edge, seen along the centerline, and directed along the traffic beside it: on roads with two directions against the right one."""
        return self.along(self.left)

    @cached_property
    def rightEdge(self) -> PolylineRegion:
        """Its right edge."""
        return self.along(self.right)

    def along(self, line: Points) -> PolylineRegion:
        """A line along the element; one around which it turns is short."""
        return directed(line, self.middle[-1] - self.middle[0])

    @property
    def strips(self) -> Sequence[tuple[Polygon, float]]:
        """It, cut across, with the heading of each part; as a whole where its edges do not run along each other."""
        if self.across:
            return strips(self.left, self.right)
        heading = self.centerline.heading_at(Vector(self.polygon.centroid.x, self.polygon.centroid.y))
        return [(part, heading) for part in polygons(self.polygon)]

    @property
    def successor(self) -> NetworkElement:
        """What comes after it; rejects if there is nothing."""
        return there(self._successor, f"{self.uid} has no successor")

    @property
    def predecessor(self) -> NetworkElement:
        """What comes before it; rejects if there is nothing."""
        return there(self._predecessor, f"{self.uid} has no predecessor")

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
    """All of them, the one beside `forwardLanes` first."""

    @cached_property
    def sidewalkRegion(self) -> Region:
        """All of them, oriented along traffic."""
        return region(self.sidewalks, f"{self.uid} sidewalks")

    @property
    def strips(self) -> Sequence[tuple[Polygon, float]]:
        """Those of its lanes."""
        return [cell for lane in self.lanes for cell in lane.strips]

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
        """The point as far along another lane, so many to the left of the point's (to the right if negative); None if there is none."""
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
        found, away = self, offset
        for _ in range(abs(offset)):
            following = None if found is None else found._laneToLeft if away > 0 else found._laneToRight
            turned = found is not None and following is not None and following.isForward is not found.isForward
            found, away = following, -away if turned else away
        return found


class BesideRoad(LinearElement):
    """What is along a road."""

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


def vector(point: object) -> Vector:
    """A vector, a pair of numbers, or the position of an object."""
    if isinstance(point, Vector):
        return point
    position = getattr(point, "position", point)
    x, y = position  # type: ignore[misc]
    return Vector(float(x), float(y))
