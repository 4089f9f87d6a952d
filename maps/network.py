"""The network of a map: all its elements, the regions that they make up, and what is where (names of the released library)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TypeVar

import shapely
from shapely.geometry import LineString

from ..semantics.kernel.values import Special
from ..semantics.python.specials import NO_PICKLES
from ..semantics.space.absence import Absent
from ..semantics.space.boundaries import METRES
from ..semantics.space.fields import Cell, VectorField
from ..semantics.space.regions import Region, Workspace, everywhere, nowhere
from ..semantics.space.vectors import Vector
from .elements import (
    BikeLane,
    Lane,
    LaneGroup,
    LaneSection,
    NetworkElement,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
    vector,
)
from .fixed import Fixed
from .intersections import Intersection
from .regions import NetworkCurve, NetworkField, fringe, region, region_along
from .signals import Signal
from .storing import keep_cells, load_cells

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
        """It is pickled as that of its network."""
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
        """It is pickled as the file that it is read from."""
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
        """All intersections."""
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
        """All shoulders."""
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
        """Those of some elements that may be within `tolerance` of a point, in their order: what comes near its cell of a grid, looked up once."""
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
        v = vector(point)
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
        v = vector(point)
        there = [element for element in self.near(self._tree[1], v) if element in elems]
        return self.first_of(sorted(there, key=elems.index), v, reject)  # type: ignore[arg-type]
