"""Roads, lanes and what runs beside them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
import shapely

from .assembly import Assembly, Place, TravelledLane, lane_name
from .elements import BikeLane, Lane, LaneGroup, LaneSection, LinearElement, Road, RoadSection, Shoulder, Sidewalk
from .fixed import complete
from .opendrive import RoadRecord
from .shapes import SHORTEST, Points, SectionShape, between

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
                net.sections[place] = TravelledLane(place, lane, forward, left, right, between(left, right))


def traffic_lanes(net: Assembly, road: str) -> list[TravelledLane]:
    """The lanes of a road on which cars drive, in the order of travel for each direction."""
    found = [s for i in range(len(net.shapes[road])) for s in net.at(road, i).values() if s.shape.record.type in DRIVABLE]
    return sorted(found, key=lambda s: (not s.forward, s.place[1] if s.forward else -s.place[1], abs(s.place[2])))


def make_road(net: Assembly, record: RoadRecord) -> None:
    """A road with its lanes, groups, sections, sidewalks and shoulders."""
    drivable = traffic_lanes(net, record.id)
    uid = f"road{record.id}"
    sides = {forward: beside(net, record, forward, uid) for forward in (True, False)}
    if not drivable:
        return
    about = {"id": record.id, "speedLimit": record.speed}
    edges = along_traffic(road_edges(net, record, drivable), record, {s.forward for s in drivable})
    road = net.linear(Road, uid, **edges, polygon=united(drivable), name=record.name or uid, **about)
    chains = list(chained(net, drivable))
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


def united(sections: Iterable[TravelledLane]) -> shapely.Geometry:
    """All of some lanes."""
    return shapely.union_all([section.polygon for section in sections])


def chained(net: Assembly, sections: Sequence[TravelledLane]) -> Iterator[list[TravelledLane]]:
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
        LaneGroup, uid, left=np.concatenate(lefts), right=np.concatenate(rights), polygon=united(sections),
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
        polygon=united(chain), id=record.id, road=road, group=group, speedLimit=limits[0] if limits else record.speed,
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
            RoadSection, f"{road.uid}_section{i}", **edges, polygon=united(here.values()), id=record.id, road=road,
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


def beside(net: Assembly, record: RoadRecord, forward: bool, uid: str) -> list[LinearElement]:
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
