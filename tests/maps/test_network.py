"""The network of a map: what leads to what, what is where, and what is beside what; everything is immutable."""

from __future__ import annotations

import math
from functools import cache

import pytest
from scenic_ref.maps import Network, made_map
from scenic_ref.maps.summary import faults, summary
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
