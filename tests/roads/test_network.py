"""The network of a map: what leads to what, what is where, and what is beside what; everything is immutable."""

from __future__ import annotations

import itertools
import math
import random
import re
from functools import cache

import pytest
from scenic_ref.roads import Network, made_map, opendrive
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.map_summary import faults, summary
from scenic_ref.roads.network_builder import network_of
from scenic_ref.semantics.space.absence import Absent
from scenic_ref.semantics.space.vectors import Vector


@cache
def network(kind: str, *parameters: tuple[str, object]) -> Network:
    return made_map(kind, **dict(parameters))  # type: ignore[arg-type]


FULL = (("lanes", 2), ("shoulders", True), ("bike_lanes", True), ("signals", True), ("crosswalks", True))
COMBINATIONS = [
    ("grid",), ("grid", ("one_way", True)), ("grid", ("lanes", 3), ("block", 120.0)), ("crossing",), ("crossing", *FULL),
    ("crossing", *FULL, ("left_hand", True)), ("crossing", ("legs", 3), ("lanes", 2)), ("crossing", ("lanes", 4)), ("t",), ("t", *FULL),
    ("t", ("left_hand", True)), ("roundabout",), ("roundabout", ("left_hand", True)), ("highway",), ("highway", ("lanes", 4)),
    ("highway", ("left_hand", True)), ("suburb",), ("suburb", ("seed", 1)), ("suburb", ("seed", 3), ("left_hand", True)),
]  # fmt: skip


@pytest.mark.sampled(8)
@pytest.mark.parametrize("which", COMBINATIONS, ids=str)
def test_maps_that_are_made_have_no_faults_and_traffic_flows_through_them(which: tuple) -> None:
    """The writer of maps and their reader share no code but the tables of the standard."""
    found = network(*which)
    assert list(faults(found)) == []
    for intersection in found.intersections:
        for way in intersection.maneuvers:
            assert way.connectingLane is not None
            assert way.connectingLane._predecessor is way.startLane and way.connectingLane._successor is way.endLane
            assert intersection.polygon.buffer(0.01).covers(way.connectingLane.polygon)
    for lane in found.lanes:
        for section in lane.sections:
            assert lane.polygon.buffer(0.01).covers(section.polygon)
        [line] = lane.centerline.lines
        before, after = line[0], line[-1]
        side = lane.leftEdge.signedDistanceTo(before)  # the middle is to the right of the left edge
        assert side < 0 < lane.rightEdge.signedDistanceTo(after)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("which", COMBINATIONS, ids=str)
def test_left_hand_traffic_is_the_mirror_image(which: tuple) -> None:
    kind, *parameters = which
    given = dict(parameters)
    one = summary(network(kind, *(given | {"left_hand": False}).items()))
    other = summary(network(kind, *(given | {"left_hand": True}).items()))
    turned = {**one["maneuvers"], "left": one["maneuvers"]["right"], "right": one["maneuvers"]["left"]}  # type: ignore[dict-item,index]
    assert other["maneuvers"] == turned
    for name in ("roads", "lanes", "lane_sections", "intersections", "four_way", "signals"):
        assert one[name] == other[name]
    assert other["drivable_area_m2"] == pytest.approx(one["drivable_area_m2"], rel=1e-6)


def test_lanes_know_what_is_beside_them() -> None:
    found = network("crossing", *FULL)
    road = next(r for r in found.roads if r.centerline.lines[0][0].x < -50 or r.centerline.lines[0][-1].x < -50)
    forward, backward = road.forwardLanes, road.backwardLanes
    assert forward is not None and backward is not None and not road.is1Way
    assert (forward._opposite, backward.opposite) == (backward, forward)
    outer, inner = forward.lanes
    [section] = outer.sections
    assert section._laneToRight is None and section.laneToLeft is inner.sections[0]
    assert section.fasterLane is inner.sections[0] and section._slowerLane is None
    assert inner.sections[0].laneToLeft.isForward is not inner.sections[0].isForward
    assert inner.sections[0]._fasterLane is None and inner.sections[0].slowerLane is section
    assert section.shiftedBy(1) is inner.sections[0] and section.shiftedBy(-1) is None and section.shiftedBy(9) is None
    assert set(inner.adjacentLanes) == {outer, backward.lanes[-1]}
    [whole] = road.sections
    assert [s.openDriveID for s in whole.lanes] == sorted(whole.lanesByOpenDriveID)
    assert forward.sidewalk in road.sidewalks and forward.shoulder.road is road and forward.bikeLane.road is road
    middle = outer.centerline.pointAlongBy(0.5, normalized=True)
    assert forward.curb.distance_to(middle) > outer.centerline.distance_to(middle) + 1.75 + 1  # beyond the shoulder and bike lane
    assert forward.curb.signedDistanceTo(middle) > 0  # the curb is on the right of traffic


def test_plain_forms_reject_and_underscores_give_none() -> None:
    found = network("grid", ("one_way", True))
    [group] = found.roads[0].laneGroups
    assert group._opposite is None
    with pytest.raises(Absent, match="has no opposite lanes"):
        _ = group.opposite
    with pytest.raises(Absent, match="has no shoulder"):
        _ = group.shoulder
    assert found.laneAt((1e4, 0)) is None
    with pytest.raises(Absent, match="there is no such element"):
        found.laneAt((1e4, 0), reject=True)
    with pytest.raises(Absent, match="not here"):
        found.roadAt((1e4, 0), reject="not here")


def test_what_is_where() -> None:
    found = network("crossing", *FULL)
    [intersection] = found.intersections
    assert found.elementAt((0, 0)) is intersection is found.intersectionAt((0, 0))
    assert intersection.is4Way and not intersection.is3Way and intersection.isSignalized and len(intersection.signals) == 4
    assert all(signal.isTrafficLight for signal in intersection.signals)
    assert len(intersection.incomingLanes) == len(intersection.outgoingLanes) == 8
    assert len(found.nominalDirectionsAt((0.3, 0.3))) > 1
    lane = found.laneAt((1.75, -60))
    assert lane is not None and lane.heading_at(Vector(1.75, -60)) == pytest.approx(0)
    assert found.laneSectionAt((1.75, -60)) is lane.sections[0] and found.laneGroupAt((1.75, -60)) is lane.group
    assert found.roadDirection.at(Vector(1.75, -60)) == pytest.approx(0)
    assert abs(found.roadDirection.at(Vector(-1.75, -60))) == pytest.approx(math.pi)
    assert found.roadDirection.at(Vector(1e4, 0)) == 0.0
    assert found.nominalDirectionsAt((1e4, 0)) == ()
    assert lane.flowFrom((1.75, -60), 10) == pytest.approx((1.75, -50))
    assert found.sidewalkAt((1e4, 0)) is None
    assert len(found.crossings) == 4
    crossing = found.crossings[0]
    assert crossing.startSidewalk is not None and crossing.endSidewalk is not None and crossing in crossing.startSidewalk.crossings
    assert found.crossingAt(crossing.centerline.pointAlongBy(0.5, normalized=True)) is crossing


def test_maneuvers_know_their_conflicts() -> None:
    [intersection] = network("crossing").intersections
    for maneuver in intersection.maneuvers:
        assert maneuver not in maneuver.conflictingManeuvers
        assert all(other.startLane is not maneuver.startLane for other in maneuver.conflictingManeuvers)
        reverse = maneuver.reverseManeuvers
        assert [(m.startLane.road, m.endLane.road) for m in reverse] == [(maneuver.endLane.road, maneuver.startLane.road)]
        if maneuver.type.name == "LEFT_TURN":
            met = [other for other in maneuver.conflictingManeuvers if other.type.name == "STRAIGHT"]
            assert any(other.endLane.road is maneuver.startLane.road for other in met)  # oncoming traffic


def test_everything_is_immutable() -> None:
    found = network("t")
    lane = found.lanes[0]
    for subject, name in ((found, "lanes"), (lane, "road"), (lane, "anything"), (found.intersections[0].maneuvers[0], "type")):
        with pytest.raises(AttributeError, match="is immutable"):
            setattr(subject, name, None)
    with pytest.raises(AttributeError, match="is immutable"):
        del lane.road
    found.elements.clear()
    assert found.elements and found.roads[0].sections[0].lanesByOpenDriveID


def test_shifting_lanes_keeps_the_place_along_the_road() -> None:
    found = network("crossing", ("lanes", 2))
    here = Vector(1.75, -60)
    lane = found.laneAt(here)
    assert lane is not None
    there = lane.road.shiftLanes(here, -1)
    assert there is not None and tuple(there) == pytest.approx((5.25, -60))
    across = lane.road.shiftLanes(here, 1)
    assert across is not None and tuple(across) == pytest.approx((-1.75, -60))
    assert lane.road.shiftLanes(here, -2) is None


def test_edges_of_roads_are_directed_along_the_traffic_beside_them() -> None:
    for left_hand in (False, True):
        found = network("crossing", ("left_hand", left_hand))
        for road in found.allRoads:
            [begin, *_, end] = road.centerline.lines[0]
            for part in (road, *road.sections):
                for edge, ahead in ((part.rightEdge, not left_hand or road.is1Way), (part.leftEdge, left_hand or road.is1Way)):
                    line = edge.lines[0]
                    along = (line[-1].x - line[0].x) * (end.x - begin.x) + (line[-1].y - line[0].y) * (end.y - begin.y)
                    assert (along > 0) is ahead


def test_roads_have_all_their_sidewalks() -> None:
    found = network("grid", ("one_way", True))
    for road in found.roads:
        assert road.is1Way and len(road.sidewalks) == 2
        assert {walk.road for walk in road.sidewalks} == {road}
        assert road.sidewalks[0] is (road.laneGroups[0].sidewalk if road.forwardLanes else road.sidewalks[0])


def test_maneuvers_into_the_same_lane_conflict() -> None:
    """Whatever the last bits of the points are where their middles end."""
    for found in (network("crossing"), network("suburb"), network("roundabout")):
        for intersection in found.intersections:
            for one in intersection.maneuvers:
                into = {m for m in intersection.maneuvers if m.endLane is one.endLane and m.startLane is not one.startLane}
                assert into <= set(one.conflictingManeuvers)
                assert all(one in other.conflictingManeuvers for other in one.conflictingManeuvers)


def test_maneuvers_at_a_point_are_those_whose_lanes_have_it_if_any_has() -> None:
    [intersection] = network("crossing").intersections
    for maneuver in intersection.maneuvers:
        lane = maneuver.connectingLane
        assert lane is not None
        for part in (0.13, 0.46, 0.83):
            point = lane.centerline.pointAlongBy(part, normalized=True)
            expected = [m for m in intersection.maneuvers if m.connectingLane is not None and m.connectingLane.contains_point(point)]
            assert list(intersection.maneuversAt(point)) == expected
            edge = lane.leftEdge.pointAlongBy(part, normalized=True)
            assert intersection.maneuversAt(edge)
    assert len({m.connectingLane for m in intersection.maneuversAt((100.0, 0.2))}) == 1  # the nearest one


def test_lanes_and_roads_are_in_their_order_around_an_intersection() -> None:
    [intersection] = network("crossing", ("lanes", 2)).intersections

    def angles(points: list[Vector]) -> list[float]:
        return [math.atan2(v.y, v.x) for v in points]

    incoming = angles([lane.centerline.lines[0][-1] for lane in intersection.incomingLanes])
    outgoing = angles([lane.centerline.lines[0][0] for lane in intersection.outgoingLanes])
    assert len(incoming) == 8 and incoming == sorted(incoming)
    assert len(outgoing) == 8 and outgoing == sorted(outgoing)
    starts = [maneuver.startLane for maneuver in intersection.maneuvers]
    assert [lane for lane, _ in itertools.groupby(starts)] == list(dict.fromkeys(starts))


def test_sections_and_lane_groups_end_at_intersections() -> None:
    for left_hand in (False, True):
        found = network("grid", ("left_hand", left_hand))
        for road in found.roads:
            forward, backward = road.forwardLanes, road.backwardLanes
            assert forward is not None and backward is not None
            assert road._successor is road.sections[-1]._successor is forward._successor is backward._predecessor
            assert road._predecessor is road.sections[0]._predecessor is forward._predecessor is backward._successor


def test_signals_for_the_lane_0_alone_stand_at_a_road_and_are_not_for_it() -> None:
    text = generate_map("crossing", signals=True)
    found = network_of(opendrive.parse_opendrive(text.encode()))
    assert all(len(road.signals) == 1 for road in found.roads)
    valid = re.compile(r'(<signal .*?<validity fromLane=")-?\d+(" toLane=")-?\d+', re.DOTALL)
    changed = network_of(opendrive.parse_opendrive(valid.sub(r"\g<1>0\g<2>0", text).encode()))
    assert len(changed.signals) == 4 and not any(road.signals for road in changed.roads)
    [intersection] = changed.intersections
    assert len(intersection.signals) == 4  # its own roads refer to them
    assert {signal.roads[0].id in {r.id for r in changed.connectingRoads} for signal in changed.signals} == {True}


@pytest.mark.parametrize("kind", ["roads", "lanes", "sidewalks", "crossings", "shoulders", "intersections"])
def test_regions_are_oriented_as_the_first_element_at_a_point(kind):
    """As the released library's: what stands on a sidewalk has its direction, unless it says otherwise."""
    net = network("grid", ("rows", 2), ("columns", 2), ("crosswalks", True), ("shoulders", True))
    found, draw = getattr(net, f"{kind[:-1]}Region"), random.Random(3)
    for _ in range(100):
        v = found.sample(draw.random)
        element = next(e for e in getattr(net, kind) if e.distance_to(v) < 0.01)
        assert math.remainder(found.orientation.at(v) - element.heading_at(v), 2 * math.pi) == pytest.approx(0, abs=0.06)


@pytest.mark.parametrize("which", [("suburb",), ("roundabout",), ("crossing", ("left_hand", True))], ids=str)
def test_the_direction_of_traffic_is_that_of_the_road_on_its_curb_and_within_the_tolerance(which: tuple) -> None:
    """Points of curbs may miss the road by rounding; there, and up to 5 cm off, the field is not 0."""
    found, numbers = network(*which), random.Random(1)
    ends = [pair for road in found.roads for group in road.laneGroups for line in group.curb.lines for pair in itertools.pairwise(line)]
    for start, end in numbers.choices(ends, k=300):
        step = end - start
        beside = Vector(step.y, -step.x) * (1 / math.hypot(step.x, step.y))
        for off in (-0.03, 0.0, 0.03):
            place = start + step * numbers.uniform(0.1, 0.9) + beside * off
            told = found.nominalDirectionsAt(place)
            assert told, "within the tolerance of a road"
            assert abs(math.remainder(found.roadDirection.at(place) - told[0], math.tau)) < 0.1
