"""The network of an OpenDRIVE file: lanes of sections, links between lanes, maneuvers of intersections, signals and crosswalks."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import shapely
from shapely.geometry import Polygon

from ..interpreter.runtime.process_sandbox import limit_time
from ..interpreter.runtime.regular_file import name_and_folder, read_regular_file
from ..semantics.space.vectors import Vector
from . import opendrive
from .immutable import complete
from .lane_edges import JOINT, SHORTEST, LaneShape, Points, SectionShape, area_between, areas, section_shapes
from .map_generator import generate_map
from .network import (
    BikeLane,
    Intersection,
    Lane,
    LaneGroup,
    LaneSection,
    LinearElement,
    Maneuver,
    Network,
    NetworkElement,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
    Signal,
    lights_on_way,
    maneuver_type,
)
from .network_arrays import keep_network, load_network
from .opendrive import ConnectionRecord, Contact, CrosswalkRecord, JunctionRecord, Notes, OpenDrive, RoadLink, RoadRecord
from .reference_lines import along
from .xml_elements import LARGEST, MapError

E = TypeVar("E", bound=NetworkElement)
L = TypeVar("L", bound=LinearElement)
Place = tuple[str, int, int]
"""A lane of a section: the id of the road, the number of the section, the number of the lane."""


@dataclass
class TravelledLane:
    """A lane of a section on its way into the network: its edges in the direction of traffic."""

    place: Place
    shape: LaneShape
    forward: bool
    left: Points
    right: Points
    polygon: shapely.Geometry
    element: LaneSection | None = None
    lane: Lane | None = None

    @property
    def center(self) -> Points:
        """The middle of the lane."""
        return (self.left + self.right) / 2


@dataclass
class Assembly:
    """A network in the making."""

    file: OpenDrive
    shapes: dict[str, list[SectionShape]] = field(default_factory=dict[str, "list[SectionShape]"])
    sections: dict[Place, TravelledLane] = field(default_factory=dict[Place, TravelledLane])
    chains: dict[Place, list[TravelledLane]] = field(default_factory=dict["Place", "list[TravelledLane]"])
    """The lanes: their sections in order, by the first."""
    roads: dict[str, Road] = field(default_factory=dict[str, Road])
    elements: dict[str, NetworkElement] = field(default_factory=dict[str, NetworkElement])
    maneuvers: dict[Lane, list[Maneuver]] = field(default_factory=dict["Lane", "list[Maneuver]"])

    @property
    def notes(self) -> Notes:
        """The oddities noted in the file."""
        return self.file.notes

    def of(self, kind: type[E]) -> tuple[E, ...]:
        """The elements of a kind."""
        return tuple(e for e in self.elements.values() if type(e) is kind)

    def add(self, kind: type[E], uid: str, **attributes: Any) -> E:
        """One more element, with a name of its own."""
        while uid in self.elements:
            uid += "'"
        self.elements[uid] = made = kind.of(**{"uid": uid, "name": uid, **attributes})
        return made

    def at(self, road: str, i: int) -> dict[int, TravelledLane]:
        """The lanes of a section of a road, by their numbers."""
        return {id: found for id in self.shapes[road][i].lanes if (found := self.sections.get((road, i, id))) is not None}

    def next_places(self, section: TravelledLane) -> Iterator[Place]:
        """The lanes of sections that a lane leads to, where no junction comes between."""
        road, i, _ = section.place
        record = section.shape.record
        ids = record.successors if section.forward else record.predecessors
        further = i + (1 if section.forward else -1)
        if 0 <= further < len(self.shapes[road]):
            found = ((road, further, id) for id in ids)
        else:
            link = self.file.roads[road].link_at("end" if section.forward else "start")
            if link is None or link.kind != "road" or link.id not in self.file.roads:
                return
            contact = link.contact or "start"
            found = ((link.id, self.file.roads[link.id].section_at(contact), id) for id in ids)
            found = (p for p in found if p in self.sections and self.sections[p].forward is (contact == "start"))
        yield from (p for p in found if p in self.sections and self.same_way(section, p))

    def same_way(self, section: TravelledLane, place: Place) -> bool:
        """Whether a lane of the same road has the same direction (of another road it is known already)."""
        return place[0] != section.place[0] or self.sections[place].forward is section.forward or len(self.shapes[place[0]]) == 1

    def linear(
        self, kind: type[L], uid: str, *, left: Points, right: Points, polygon: shapely.Geometry, center: Points | None = None, **more: Any
    ) -> L:
        """An element along its edges."""
        middle = (left + right) / 2 if center is None else center
        lines = {"left": left, "right": right, "middle": middle}
        return self.add(kind, uid, polygon=areas(polygon), across=center is None, **{k: np.ascontiguousarray(v) for k, v in lines.items()}, **more)


def lane_name(place: Place) -> str:
    """A lane, for a message."""
    road, _, lane = place
    return f"road {road} lane {lane}"


DRIVABLE = frozenset({"driving", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "slipLane", "bidirectional", "bus", "taxi", "HOV"})
SHOULDER = frozenset({"shoulder", "parking", "stop", "border"})
NARROWEST = 0.05
"""Metres: lanes that are nowhere as wide are none."""


def make_sections(net: Assembly, road: RoadRecord) -> None:
    """The lanes of each section, with their edges along traffic."""
    for i, shape in enumerate(net.shapes[road.id]):
        for id, lane in shape.lanes.items():
            forward = (id < 0) is not road.left_hand
            inner, outer = (lane.inner, lane.outer) if forward else (lane.inner[::-1], lane.outer[::-1])
            left, right = (outer, inner) if road.left_hand else (inner, outer)
            place = (road.id, i, id)
            if float(np.hypot(*np.diff((left + right) / 2, axis=0).T).sum()) < SHORTEST:
                net.notes.add("lanes without length, which are left out", lane_name(place))
            elif lane.width.max() > NARROWEST:
                net.sections[place] = TravelledLane(place, lane, forward, left, right, area_between(left, right))


def traffic_lanes(net: Assembly, road: str) -> list[TravelledLane]:
    """The lanes of a road on which cars drive, in the order of travel for each direction."""
    found = [s for i in range(len(net.shapes[road])) for s in net.at(road, i).values() if s.shape.record.type in DRIVABLE]
    return sorted(found, key=lambda s: (not s.forward, s.place[1] if s.forward else -s.place[1], abs(s.place[2])))


def make_road(net: Assembly, record: RoadRecord) -> None:
    """A road with its lanes, groups, sections, sidewalks and shoulders."""
    drivable = traffic_lanes(net, record.id)
    uid = f"road{record.id}"
    sides = {forward: roadside_elements(net, record, forward, uid) for forward in (True, False)}
    if not drivable:
        return
    about = {"id": record.id, "speedLimit": record.speed}
    edges = along_traffic(road_edges(net, record, drivable), record, {s.forward for s in drivable})
    road = net.linear(Road, uid, **edges, polygon=union_of_lanes(drivable), name=record.name or uid, **about)
    chains = list(chain_lanes(net, drivable))
    groups = {
        forward: group(net, record, road, [c for c in chains if c[0].forward is forward], forward, sides[forward])
        for forward in (True, False) if any(c[0].forward is forward for c in chains)
    }  # fmt: skip
    forward, backward = groups.get(True), groups.get(False)
    if forward and backward:
        complete(forward, _opposite=backward)
        complete(backward, _opposite=forward)
    walks = tuple(element for side in sides.values() for element in side if isinstance(element, Sidewalk))
    complete(
        road, forwardLanes=forward, backwardLanes=backward, laneGroups=tuple(groups.values()), signals=(), crossings=(), sidewalks=walks,
        lanes=tuple(lane for g in groups.values() for lane in g.lanes),
    )  # fmt: skip
    complete(road, sections=tuple(road_sections(net, record, road)))
    for lane in road.lanes:
        complete(lane, adjacentLanes=tuple(dict.fromkeys(other.lane for s in lane.sections for other in s.adjacentLanes)))
    for side in sides.values():
        for element in side:
            complete(element, _road=road)
    net.roads[record.id] = road


def road_edges(net: Assembly, record: RoadRecord, drivable: Sequence[TravelledLane]) -> dict[str, Points]:
    """The edges of a road in its own direction: of its outermost lanes on which cars drive."""
    lefts, rights, middles = list[Points](), list[Points](), list[Points]()
    for i, shape in enumerate(net.shapes[record.id]):
        ids = sorted(s.place[2] for s in drivable if s.place[1] == i)
        if ids:
            rights.append(shape.lanes[ids[0]].outer if ids[0] < 0 else shape.lanes[ids[0]].inner)
            lefts.append(shape.lanes[ids[-1]].outer if ids[-1] > 0 else shape.lanes[ids[-1]].inner)
            middles.append(shape.middle)
    return {"left": np.concatenate(lefts), "right": np.concatenate(rights), "center": np.concatenate(middles)}


def along_traffic(edges: Mapping[str, Points], record: RoadRecord, ways: Collection[bool]) -> dict[str, Points]:
    """The edges of a road, each in the direction of the traffic beside it: `ways` are those that there are, along the road or not."""
    ahead, back = ("left", "right") if record.left_hand else ("right", "left")
    against = {name for name, turned in ((ahead, True not in ways), (back, False in ways)) if turned}
    return {name: edge[::-1] if name in against else edge for name, edge in edges.items()}


def union_of_lanes(sections: Iterable[TravelledLane]) -> shapely.Geometry:
    """All of some lanes."""
    return shapely.union_all([section.polygon for section in sections])


def chain_lanes(net: Assembly, sections: Sequence[TravelledLane]) -> Iterator[list[TravelledLane]]:
    """The lanes of a road: each goes on into one lane of the next section, if that has not gone on from another."""
    taken: set[Place] = set()
    for first in sections:
        if first.place in taken:
            continue
        chain = [first]
        taken.add(first.place)
        while True:
            onward = (p for p in net.next_places(chain[-1]) if p[0] == first.place[0] and p not in taken)
            following = next((p for p in onward if net.sections[p].shape.record.type in DRIVABLE), None)
            if following is None or following[1] == chain[-1].place[1]:
                break
            taken.add(following)
            chain.append(net.sections[following])
        net.chains[first.place] = chain
        yield chain


def group(
    net: Assembly, record: RoadRecord, road: Road, chains: Sequence[list[TravelledLane]], forward: bool, beside: Sequence[LinearElement]
) -> LaneGroup:
    """The lanes of one direction."""
    uid = f"{road.uid}_{'forward' if forward else 'backward'}"
    order = sorted(chains, key=lambda chain: (-max(abs(s.place[2]) for s in chain), chain[0].place[1]))
    sections = sorted((s for chain in chains for s in chain), key=lambda s: s.place[1] if forward else -s.place[1])
    lefts, rights, curbs = list[Points](), list[Points](), list[Points]()
    for i in dict.fromkeys(s.place[1] for s in sections):
        here = sorted((s for s in sections if s.place[1] == i), key=lambda s: abs(s.place[2]))
        inner, outer = (here[0], here[-1])
        lefts.append(outer.left if record.left_hand else inner.left)
        rights.append(inner.right if record.left_hand else outer.right)
        edge = outermost(net, record, outer)
        curbs.append(edge.left if record.left_hand else edge.right)
    first = {kind: next((e for e in beside if type(e) is kind), None) for kind in (Sidewalk, Shoulder, BikeLane)}
    group = net.linear(
        LaneGroup, uid, left=np.concatenate(lefts), right=np.concatenate(rights), polygon=union_of_lanes(sections),
        id=record.id, road=road, speedLimit=record.speed, outermost=np.concatenate(curbs),
        _sidewalk=first[Sidewalk], _shoulder=first[Shoulder], _bikeLane=first[BikeLane],
    )  # fmt: skip
    complete(group, lanes=tuple(lane(net, record, road, group, chain, f"{uid}_lane{n}") for n, chain in enumerate(order)))
    return group


def outermost(net: Assembly, record: RoadRecord, section: TravelledLane) -> TravelledLane:
    """The lane at the curb beside the outermost lane of traffic: a shoulder or bike lane, if one is there."""
    road, i, id = section.place
    step = int(math.copysign(1, id))
    found = section
    while (further := net.sections.get((road, i, found.place[2] + step))) is not None and further.shape.record.type in SHOULDER | {"biking"}:
        found = further
    return found


def lane(net: Assembly, record: RoadRecord, road: Road, group: LaneGroup, chain: Sequence[TravelledLane], uid: str) -> Lane:
    """A lane with its sections."""
    limits = [s.shape.record.speed for s in chain if s.shape.record.speed is not None]
    made = net.linear(
        Lane, uid, left=np.concatenate([s.left for s in chain]), right=np.concatenate([s.right for s in chain]),
        polygon=union_of_lanes(chain), id=record.id, road=road, group=group, speedLimit=limits[0] if limits else record.speed,
    )  # fmt: skip
    for n, section in enumerate(chain):
        section.lane = made
        section.element = net.linear(
            LaneSection, f"{uid}_section{n}", left=section.left, right=section.right, polygon=section.polygon, id=record.id, lane=made, group=group,
            road=road, openDriveID=section.place[2], isForward=section.forward, speedLimit=section.shape.record.speed or record.speed,
        )  # fmt: skip
    parts = [s.element for s in chain if s.element is not None]
    for one, following in pairwise(parts):
        complete(one, _successor=following)
        complete(following, _predecessor=one)
    complete(made, sections=tuple(parts))
    return made


def road_sections(net: Assembly, record: RoadRecord, road: Road) -> Iterator[RoadSection]:
    """The sections of a road; its lanes get to know their neighbours."""
    before: RoadSection | None = None
    for i, shape in enumerate(net.shapes[record.id]):
        here = {id: s for id, s in net.at(record.id, i).items() if s.element is not None}
        if not here:
            continue
        lanes = {id: element for id in sorted(here) if (element := here[id].element) is not None}
        for id, element in lanes.items():
            complete(element, **neighbours(id, lanes, record.left_hand))
        edges = along_traffic(road_edges_at(shape, sorted(here)), record, {s.forward for s in here.values()})
        section = net.linear(
            RoadSection, f"{road.uid}_section{i}", **edges, polygon=union_of_lanes(here.values()), id=record.id, road=road,
            lanes=tuple(lanes.values()), by_id=lanes, forwardLanes=tuple(e for e in lanes.values() if e.isForward),
            backwardLanes=tuple(e for e in lanes.values() if not e.isForward),
        )  # fmt: skip
        if before is not None:
            complete(before, _successor=section)
            complete(section, _predecessor=before)
        before = section
        yield section


def road_edges_at(shape: SectionShape, ids: Sequence[int]) -> dict[str, Points]:
    """The edges of a section of a road, in its own direction."""
    right, left = shape.lanes[ids[0]], shape.lanes[ids[-1]]
    return {
        "right": right.outer if ids[0] < 0 else right.inner, "left": left.outer if ids[-1] > 0 else left.inner, "center": shape.middle,
    }  # fmt: skip


def roadside_elements(net: Assembly, record: RoadRecord, forward: bool, uid: str) -> list[LinearElement]:
    """The sidewalks, shoulders and bike lanes on one side of a road."""
    found: list[LinearElement] = []
    for kind, types, what in ((Sidewalk, {"sidewalk"}, "sidewalk"), (Shoulder, SHOULDER, "shoulder"), (BikeLane, {"biking"}, "bike")):
        there = sorted(runs(net, record, forward, types), key=len, reverse=True)
        for n, run in enumerate(there):
            lefts, rights, polygons = zip(*run, strict=True)
            polygon = shapely.union_all([p for section in polygons for p in section])
            name = f"{uid}_{'forward' if forward else 'backward'}_{what}{n}"
            found.append(net.linear(kind, name, left=np.concatenate(lefts), right=np.concatenate(rights), polygon=polygon, id=record.id, _road=None))
    return found


def runs(net: Assembly, record: RoadRecord, forward: bool, types: Iterable[str]) -> Iterator[list[tuple[Points, Points, list[shapely.Geometry]]]]:
    """Successive sections with lanes of some types on one side, in the direction of traffic: edges and areas of each."""
    run: list[tuple[Points, Points, list[shapely.Geometry]]] = []
    count = len(net.shapes[record.id])
    for i in range(count) if forward else range(count - 1, -1, -1):
        there = (s for s in net.at(record.id, i).values() if s.forward is forward and s.shape.record.type in types)
        here = sorted(there, key=lambda s: abs(s.place[2]))
        if here:
            ends = (here[-1].left, here[0].right) if record.left_hand else (here[0].left, here[-1].right)
            run.append((*ends, [s.polygon for s in here]))
        elif run:
            yield run
            run = []
    if run:
        yield run


def neighbours(id: int, lanes: Mapping[int, LaneSection], left_hand: bool) -> dict[str, object]:
    """The lanes beside a lane of a section, by side and by speed."""
    towards, away = (-1 if id == 1 else id - 1), (1 if id == -1 else id + 1)  # the next to the right and to the left of the road's direction
    right, left = (lanes.get(towards), lanes.get(away)) if lanes[id].isForward else (lanes.get(away), lanes.get(towards))
    faster, slower = (right, left) if left_hand else (left, right)
    own = lanes[id].isForward
    return {
        "_laneToLeft": left, "_laneToRight": right, "adjacentLanes": tuple(lane for lane in (left, right) if lane is not None),
        "_fasterLane": faster if faster is not None and faster.isForward is own else None,
        "_slowerLane": slower if slower is not None and slower.isForward is own else None,
    }  # fmt: skip


ENDS: tuple[Contact, Contact] = ("end", "start")


def note_dangling(net: Assembly) -> None:
    """Notice links to what there is not: roads, junctions, lanes of what comes before and after."""
    for id, record in net.file.roads.items():
        for end in ENDS:
            link = record.link_at(end)
            if link is not None and link.id not in (net.file.roads if link.kind == "road" else net.file.junctions):
                net.notes.add("links to roads or junctions that there are not", f"road {id} to {link.kind} {link.id}")
        for i, shape in enumerate(net.shapes[id]):
            for number, lane in shape.lanes.items():
                for end in ENDS:
                    there = beyond(net, record, i, end)
                    linked = lane.record.predecessors if end == "start" else lane.record.successors
                    for other in () if there is None else (n for n in linked if n not in there and n != 0):
                        net.notes.add("links to lanes that there are not", f"{lane_name((id, i, number))} to lane {other}")


def beyond(net: Assembly, road: RoadRecord, i: int, end: Contact) -> Collection[int] | None:
    """The numbers of the lanes before or after a section of a road; None where a junction is, or nothing."""
    further = i + (1 if end == "end" else -1)
    if 0 <= further < len(net.shapes[road.id]):
        return net.shapes[road.id][further].lanes
    link = road.link_at(end)
    if link is None or link.kind != "road" or link.id not in net.file.roads:
        return None
    return net.shapes[link.id][net.file.roads[link.id].section_at(link.contact or "start")].lanes


def link_lanes(net: Assembly) -> None:
    """Link lanes that lead into each other without an intersection: successors, and the maneuver ahead."""
    for chain in net.chains.values():
        last, lane = chain[-1], chain[-1].lane
        for place in net.next_places(last):
            following = net.sections[place].lane
            if lane is None or following is None or following is lane:
                continue
            joint(net, last, net.sections[place])
            lead(net, lane, following)
            net.maneuvers.setdefault(lane, []).append(Maneuver.of(type=maneuver_type(lane, following, None), startLane=lane, endLane=following))


def lead(net: Assembly, lane: Lane, following: Lane) -> None:
    """One lane leads to another: the first one that it leads to is its successor."""
    for one, other in ((lane, following), (lane.group, following.group), (lane.sections[-1], following.sections[0])):
        if one._successor is None:
            complete(one, _successor=other)
        if other._predecessor is None:
            complete(other, _predecessor=one)


def joint(net: Assembly, one: TravelledLane, other: TravelledLane) -> None:
    """Notice where lanes that are linked do not meet."""
    gap = float(np.hypot(*(one.center[-1] - other.center[0])))
    if gap > JOINT:
        told = f"{lane_name(one.place)} to {lane_name(other.place)} ({gap:.2f} m)"
        net.notes.add(f"joints of lanes that are further apart than {JOINT * 100:g} cm", told)


def intersection(net: Assembly, junction: JunctionRecord) -> Intersection | None:
    """An intersection with its maneuvers; None if no way leads through it."""
    found = dict[tuple[Place, Place, Place], tuple[TravelledLane, TravelledLane, TravelledLane]]()
    for connection in junction.connections:
        for one, over, other in ways(net, junction, connection):
            found[(one.place, over.place, other.place)] = (one, over, other)
    inside = [r for r in net.roads.values() if net.file.roads[str(r.id)].junction == junction.id]
    if not found or not inside:
        return None
    filled = [Polygon(p.exterior) for p in shapely.get_parts(shapely.union_all([r.polygon for r in inside]).buffer(1e-3, join_style="mitre"))]
    uid = f"intersection{junction.id}"
    made = net.add(Intersection, uid, id=junction.id, name=junction.name or uid, polygon=areas(shapely.union_all(filled)))
    center = made.polygon.centroid
    maneuvers: list[Maneuver] = []
    around, incoming, outgoing = dict[Road, float](), dict[Lane, float](), dict[Lane, float]()
    for one, over, other in found.values():
        assert one.lane is not None and over.lane is not None and other.lane is not None
        for lane, point, lanes in ((one.lane, one.center[-1], incoming), (other.lane, other.center[0], outgoing)):
            lanes[lane] = math.atan2(point[1] - center.y, point[0] - center.x)
            around.setdefault(lane.road, lanes[lane])
        maneuvers.append(Maneuver.of(
            type=maneuver_type(one.lane, other.lane, over.lane), startLane=one.lane, endLane=other.lane, connectingLane=over.lane, intersection=made
        ))  # fmt: skip
    for maneuver in sorted(maneuvers, key=lambda m: m.type.value):  # so that the way straight on is the successor
        lead(net, maneuver.startLane, maneuver.connectingLane or maneuver.endLane)
    from_lanes = {lane: [m for m in maneuvers if m.startLane is lane] for lane in incoming}
    for lane, ways_on in from_lanes.items():
        net.maneuvers.setdefault(lane, []).extend(ways_on)
    complete(
        made, maneuvers=tuple(m for ways_on in from_lanes.values() for m in ways_on), roads=tuple(sorted(around, key=around.__getitem__)),
        incomingLanes=tuple(sorted(incoming, key=incoming.__getitem__)), outgoingLanes=tuple(sorted(outgoing, key=outgoing.__getitem__)),
    )  # fmt: skip
    return made


def ways(net: Assembly, junction: JunctionRecord, connection: ConnectionRecord) -> Iterator[tuple[TravelledLane, TravelledLane, TravelledLane]]:
    """The ways of a connection: from a lane, over a connecting one, to a lane."""
    incoming, connecting = net.file.roads.get(connection.incoming), net.file.roads.get(connection.connecting)
    if incoming is None or connecting is None:
        net.notes.add("connections of roads that there are not", f"junction {junction.id}")
        return
    for start, over in connection.lanes:
        if over not in net.shapes[connecting.id][connecting.section_at(connection.contact)].lanes:
            net.notes.add("links to lanes that there are not", f"junction {junction.id} to road {connecting.id} lane {over}")
        way = net.sections.get((connecting.id, connecting.section_at(connection.contact), over))
        if way is None or way.forward is not (connection.contact == "start") or way.place not in net.chains:
            continue  # it leads towards the incoming road, or is no lane for cars
        ends: list[Contact] = [end for end in ENDS if leads_into(incoming.link_at(end), junction.id, connecting.id)]
        at_ends = [net.sections.get((incoming.id, incoming.section_at(end), start)) for end in ends]
        lanes = [s for s, end in zip(at_ends, ends, strict=True) if s is not None and s.lane is not None and s.forward is (end == "end")]
        others = [s for s in map(net.sections.__getitem__, net.next_places(net.chains[way.place][-1])) if s.lane is not None]
        if not lanes or not others:
            net.notes.add("lanes of junctions that lead nowhere", f"junction {junction.id}, {lane_name(way.place)}")
            continue
        begin = way.center[0]
        nearest = min(lanes, key=lambda s: float(np.hypot(*(s.center[-1] - begin))))
        joint(net, nearest, way)
        yield from ((nearest, way, other) for other in others)


def link_roads(net: Assembly, intersections: Sequence[Intersection]) -> None:
    """Link roads to the roads or intersections at their ends."""
    of_junction = {i.id: i for i in intersections}
    for road in net.roads.values():
        record = net.file.roads[str(road.id)]
        for name, link in (("_successor", record.successor), ("_predecessor", record.predecessor)):
            if link is not None:
                found = of_junction.get(link.id) if link.kind == "junction" else net.roads.get(link.id)
                complete(road, **{name: found})
                if isinstance(found, Intersection):
                    meet(road, name == "_successor", found)


def meet(road: Road, at_end: bool, intersection: Intersection) -> None:
    """The section and the lane groups of a road lead to the intersection where it ends, or begins, and come from there."""
    section, leading, coming = (-1, road.forwardLanes, road.backwardLanes) if at_end else (0, road.backwardLanes, road.forwardLanes)
    complete(road.sections[section], **{"_successor" if at_end else "_predecessor": intersection})
    if leading is not None:
        complete(leading, _successor=intersection)
    if coming is not None:
        complete(coming, _predecessor=intersection)


def leads_into(link: RoadLink | None, junction: str, connecting: str) -> bool:
    """Whether a road ends in a junction, or at a connecting road of it."""
    return link is not None and link.id == (junction if link.kind == "junction" else connecting)


SMALLEST = 0.05
"""Square metres of a crosswalk."""
BESIDE = 5.0
"""Metres from an end of a crosswalk to the sidewalk at which it ends."""


def signals(net: Assembly, intersections: Sequence[Intersection]) -> list[Signal]:
    """The signals of the map; intersections get those of their connecting roads, and those towards them that no connecting road names."""
    made: dict[str, Signal] = {}
    of_road: dict[str, list[Signal]] = {}
    towards: dict[str, list[Signal]] = {}
    for record in net.file.roads.values():
        for one in record.signals:
            [x], [y], [direction] = along(record.pieces, np.array([min(max(one.s, 0.0), record.length)]))
            where = Vector(float(x - math.sin(direction) * one.t), float(y + math.cos(direction) * one.t))
            found = Signal.of(uid=f"signal{one.id}_{record.id}", openDriveID=one.id, country=one.country, type=one.type, position=where, roads=())
            made.setdefault(one.id, found)
            if not one.valid:
                continue
            of_road.setdefault(record.id, []).append(made[one.id])
            ends = (("+", record.successor), ("-", record.predecessor))
            for link in (link for sign, link in ends if one.orientation in (sign, "none") and link is not None and link.kind == "junction"):
                towards.setdefault(link.id, []).append(made[one.id])
    for record in net.file.roads.values():
        of_road.setdefault(record.id, []).extend(made[id] for id in record.references if id in made)
    for road in net.roads.values():
        complete(road, signals=tuple(dict.fromkeys(of_road.get(str(road.id), ()))))
    for signal in made.values():
        complete(signal, roads=tuple(r for r in net.roads.values() if signal in r.signals))
    named = {s for id, record in net.file.roads.items() if record.junction is not None for s in of_road.get(id, ())}
    for i in intersections:
        inside = [s for id, record in net.file.roads.items() if record.junction == i.id for s in of_road.get(id, ())]
        complete(i, signals=tuple(dict.fromkeys((*inside, *(s for s in towards.get(str(i.id), ()) if s not in named)))))
    for signal in made.values():
        complete(signal, intersections=tuple(i for i in intersections if signal in i.signals))
    for maneuver in (m for i in intersections for m in i.maneuvers):
        lights = lights_on_way(maneuver)
        if lights and maneuver.startLane._trafficLight is None:
            complete(maneuver.startLane, _trafficLight=lights[0])
    return list(made.values())


def crossings(net: Assembly, intersections: Sequence[Intersection]) -> None:
    """The crosswalks of the map."""
    of_junction = {i.id: i for i in intersections}
    for record in net.file.roads.values():
        parent = of_junction.get(record.junction) if record.junction is not None else net.roads.get(record.id)
        for n, walk in enumerate(record.crosswalks):
            corners, across = crosswalk_corners(record, walk)
            polygon = Polygon(corners)
            if parent is None or not polygon.is_valid or polygon.area < SMALLEST:
                net.notes.add("crosswalks that have no area or no road, which are left out", f"road {record.id}")
                continue
            center, left, right = crossing_lines(corners, across)
            made = net.linear(
                PedestrianCrossing, f"road{record.id}_crossing{n}", left=left, right=right, center=center, polygon=polygon, id=walk.id, parent=parent
            )  # fmt: skip
            ends = [sidewalk_near(net, point) for point in (center[0], center[-1])]
            complete(made, startSidewalk=ends[0], endSidewalk=ends[1])
            for element in {parent, *(e for e in ends if e is not None)}:
                complete(element, crossings=(*element.crossings, made))


def sidewalk_near(net: Assembly, point: Points) -> Sidewalk | None:
    """The nearest sidewalk, if one is near enough."""
    where = shapely.Point(*point)
    found = min(net.of(Sidewalk), key=lambda walk: walk.polygon.distance(where), default=None)
    return found if found is not None and found.polygon.distance(where) < BESIDE else None


def crosswalk_corners(road: RoadRecord, walk: CrosswalkRecord) -> tuple[Points, Points]:
    """The corners of a crosswalk, and the direction across the road there."""
    [x], [y], [direction] = along(road.pieces, np.array([min(max(walk.s, 0.0), road.length)]))
    across = np.array([-math.sin(direction), math.cos(direction)])
    told = np.array(walk.corners)
    if not walk.local:
        xs, ys, directions = along(road.pieces, np.clip(told[:, 0], 0.0, road.length))
        return np.column_stack([xs - np.sin(directions) * told[:, 1], ys + np.cos(directions) * told[:, 1]]), across
    turn = direction + walk.heading
    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    return np.array([x, y]) + walk.t * across + told @ rotation, across


def crossing_lines(corners: Points, across: Points) -> tuple[Points, Points, Points]:
    """The centerline and the edges of a crosswalk, as long as it is in the direction across the road."""
    center = corners.mean(axis=0)
    beside = np.array([across[1], -across[0]])  # to the right of the direction across
    reach, width = (corners - center) @ across, (corners - center) @ beside
    ends = center + np.array([[reach.min()], [reach.max()]]) * across
    return ends, ends + width.min() * beside, ends + width.max() * beside


TOLERANCE = 0.05
"""Metres by which a point may miss an element."""
OVERLAP = 0.5
"""Square metres that two roads outside intersections may share."""


def read_map(path: Path | str, tolerance: float = TOLERANCE) -> Network:
    """The network of an OpenDRIVE file, `tolerance` in metres. Raises `MapError` for what is none or is broken."""
    try:
        data = read_regular_file(path, LARGEST)
    except FileNotFoundError:
        raise MapError(f"there is no map {name_and_folder(path)}") from None
    except OSError as error:
        raise MapError(f"the map {path} cannot be read: {error.strerror or error}") from None
    try:
        return network_within(data, tolerance)
    except MapError as problem:
        raise MapError(f"{path} is no usable OpenDRIVE map: {problem.message}") from None


@limit_time("reading a map")
def network_within(data: bytes, tolerance: float) -> Network:
    """As `network_from`, in the time that a program has for its maps."""
    return network_from(data, tolerance)


def made_map(kind: str, **parameters: bool | float) -> Network:
    """The network of a map that `making.made` makes. Raises `ValueError` as it does."""
    return network_from(generate_map(kind, **parameters).encode())


def network_from(data: bytes, tolerance: float = TOLERANCE) -> Network:
    """The network of what is in an OpenDRIVE file; the same one for the same file, since it is immutable. Raises `MapError`."""
    return cached_network(data, float(tolerance))


@lru_cache(maxsize=4)
def cached_network(data: bytes, tolerance: float) -> Network:
    """The network, once it is made; that of a large map also for other processes."""
    found = load_network(data, tolerance)
    if found is not None:
        return complete(found, source=data, again=partial(network_from, tolerance=tolerance))
    made = network_of(opendrive.parse_opendrive(data), tolerance)
    keep_network(made)
    return made


def network_of(file: OpenDrive, tolerance: float = TOLERANCE) -> Network:
    """The network that a file describes. Raises `MapError` if there is no lane to drive on."""
    net = Assembly(file)
    for road in file.roads.values():
        net.shapes[road.id] = list(section_shapes(road, net.notes))
        make_sections(net, road)
    for road in file.roads.values():
        make_road(net, road)
    note_dangling(net)
    link_lanes(net)
    intersections = [found for one in file.junctions.values() if (found := intersection(net, one)) is not None]
    link_roads(net, intersections)
    lights = signals(net, intersections)
    crossings(net, intersections)
    for lane in net.of(Lane):
        complete(lane, maneuvers=tuple(net.maneuvers.get(lane, ())))
    return finish_network(net, intersections, lights, tolerance)


def finish_network(net: Assembly, intersections: Sequence[Intersection], signals: Sequence[Signal], tolerance: float) -> Network:
    """The network, which every element then knows."""
    records = net.file.roads
    ordinary = [road for id, road in net.roads.items() if records[id].junction is None]
    connecting = [road for id, road in net.roads.items() if records[id].junction is not None]
    roads = (*ordinary, *connecting)
    lanes = [lane for road in roads for lane in road.lanes]
    if not lanes:
        raise MapError("; ".join(["it has no lanes on which to drive", *net.notes.lines()]))
    note_overlaps(ordinary, net.notes)
    made = Network.of(
        source=net.file.data, again=partial(network_from, tolerance=tolerance), by_uid=net.elements,
        roads=tuple(ordinary), connectingRoads=tuple(connecting), allRoads=roads, intersections=tuple(intersections),
        laneGroups=tuple(group for road in roads for group in road.laneGroups), lanes=tuple(lanes), crossings=net.of(PedestrianCrossing),
        sidewalks=net.of(Sidewalk), shoulders=net.of(Shoulder), bikeLanes=net.of(BikeLane), signals=tuple(signals),
        roadSections=tuple(section for road in ordinary for section in road.sections),
        laneSections=tuple(section for lane in lanes for section in lane.sections),
        driveOnLeft=sum(record.left_hand for record in records.values()) * 2 > len(records), tolerance=tolerance,
        warnings=tuple(net.notes.lines()),
    )  # fmt: skip
    for element in net.elements.values():
        complete(element, network=made)
    return made


def note_overlaps(roads: Sequence[Road], notes: Notes) -> None:
    """Note roads outside intersections that share an area, as bridges do in the plane."""
    if not roads:
        return
    polygons = [road.polygon for road in roads]
    for i, j in zip(*shapely.STRtree(polygons).query(polygons, predicate="intersects"), strict=True):
        if i < j and (shared := shapely.intersection(polygons[i], polygons[j]).area) > OVERLAP:
            notes.add("roads that overlap", f"{roads[i].uid} and {roads[j].uid} in {shared:.1f} m²")

