"""What leads to what: lanes, roads, and the maneuvers of intersections."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np
import shapely
from shapely.geometry import Polygon

from .assembly import Assembly, Place, TravelledLane, lane_name
from .elements import Lane, Road
from .fixed import complete
from .intersections import Intersection, Maneuver, maneuver_type
from .opendrive import ConnectionRecord, Contact, JunctionRecord, RoadLink, RoadRecord
from .shapes import JOINT, areas

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
    """Where a lane leads into another without an intersection: successors, and the maneuver straight on."""
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
    """What roads lead to: other roads, or intersections."""
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
