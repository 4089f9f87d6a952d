"""Broken and hostile files: a message that names the road and says what is wrong; strange ones load, with notes that are counted."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from scenic_ref.roads import MapError, Network, opendrive, read_map
from scenic_ref.roads.map_summary import faults
from scenic_ref.roads.network_builder import network_of
from scenic_ref.semantics.space.vectors import Vector

LANES = (
    '<laneSection s="0"><left><lane id="1" type="driving"><link/><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left>'
    '<right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>'
    '<lane id="-2" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane></right></laneSection>'
)
ROAD = '<road id="7" length="100" junction="-1">{link}<planView><geometry s="0" x="0" y="0" hdg="0" length="100">{shape}</geometry></planView><lanes>{lanes}</lanes></road>'


def file(road: str = ROAD, *, link: str = "", shape: str = "<line/>", lanes: str = LANES, more: str = "") -> bytes:
    return f"<OpenDRIVE>{road.format(link=link, shape=shape, lanes=lanes)}{more}</OpenDRIVE>".encode()


def test_the_file_without_faults_loads() -> None:
    network = network_of(opendrive.parse_opendrive(file()))
    assert (len(network.roads), len(network.lanes), len(network.sidewalks), network.warnings) == (1, 2, 1, ())
    assert network.drivableRegion.measure() == pytest.approx(700, rel=1e-4)


STRANGE: dict[str, tuple[bytes, str]] = {
    "a gap in the reference line": (
        file().replace(b'hdg="0" length="100"><line/></geometry>',
            b'hdg="0" length="50"><line/></geometry><geometry s="50" x="51" y="0" hdg="0" length="50"><line/></geometry>'),
        "gaps in reference lines of more than 1 cm: road 7 at 50 m (1.00 m)"),
    "a road that there is not": (
        file(link='<link><successor elementType="road" elementId="99" contactPoint="start"/></link>'),
        "links to roads or junctions that there are not: road 7 to road 99"),
    "a junction that there is not": (
        file(link='<link><predecessor elementType="junction" elementId="5"/></link>'),
        "links to roads or junctions that there are not: road 7 to junction 5"),
    "a lane that there is not": (
        file(link='<link><successor elementType="road" elementId="7" contactPoint="start"/></link>',
            lanes=LANES.replace("<link/>", '<link><successor id="9"/></link>')),
        "links to lanes that there are not: road 7 lane 1 to lane 9"),
    "lanes on the wrong side": (
        file(lanes=re.sub('<lane id="(1|-1)"', lambda found: f'<lane id="{-int(found[1])}"', LANES.replace("-2", "2"))),
        "lanes on the other side than their number says: road 7 lane -1, road 7 lane 1, road 7 lane 2"),
    "a lane without a width": (
        file(lanes=LANES.replace('<width sOffset="0" a="2" b="0" c="0" d="0"/>', "")), "lanes without a width: road 7 lane -2"),
    "a direction of its own": (
        file(lanes=LANES.replace('<lane id="1"', '<lane id="1" direction="reversed"')),
        "lanes with a direction of traffic of their own, which is not heeded: road 7 lane 1"),
    "roads that cross": (
        file(ROAD + ROAD.replace('id="7"', 'id="8"').replace('x="0" y="0" hdg="0"', 'x="50" y="-50" hdg="1.5707963267948966"')),
        "roads that overlap: road7 and road8 in 49.0 m²"),
    "a rule that there is not": (
        file(ROAD.replace('junction="-1"', 'junction="-1" rule="left"')), "rules of traffic that are neither RHT nor LHT, and taken for RHT: road 7"),
}  # fmt: skip


@pytest.mark.parametrize("name", STRANGE)
def test_what_is_strange_is_noted_and_a_fault(name: str) -> None:
    data, note = STRANGE[name]
    network = network_of(opendrive.parse_opendrive(data))
    assert [line for line in network.warnings if line.startswith(note)]
    assert [line for line in faults(network) if line.startswith(note)]


LINKED = LANES.replace("<link/>", '<link><predecessor id="1"/><successor id="1"/></link>').replace(
    '<lane id="-1" type="driving">', '<lane id="-1" type="driving"><link><predecessor id="-1"/><successor id="-1"/></link>'
)


def in_sections(lanes: str, *starts: float) -> Network:
    """The map of a road whose lane sections, all alike, begin there."""
    return network_of(opendrive.parse_opendrive(file(lanes="".join(lanes.replace('s="0"', f's="{start}"', 1) for start in starts))))


def test_lanes_that_are_not_linked_to_those_of_the_next_section_are_a_fault() -> None:
    found = [sorted(faults(in_sections(lanes, 0, 50))) for lanes in (LANES, LINKED)]
    assert len(found[0]) == 2
    assert all("without a link" in fault for fault in found[0])
    assert found[1] == []


@pytest.mark.parametrize("length", [1e-7, 1.7e-5, 1e-3])
def test_lanes_go_on_across_a_section_of_micrometres(length: float) -> None:
    network = in_sections(LINKED, 0, 50, 50 + length)
    assert (network.warnings, list(faults(network))) == ((), [])
    assert [len(lane.sections) for lane in network.lanes] == [3, 3]
    assert [lane.centerline.polyline.length for lane in network.lanes] == pytest.approx([100, 100])
    assert network.roadDirection.at(Vector(50.00001, 2)) == pytest.approx(network.lanes[1].heading_at(Vector(1, 2)))


def test_heights_are_noted_and_no_fault() -> None:
    hilly = ROAD.replace("<lanes>", '<elevationProfile><elevation s="0" a="3" b="0.1" c="0" d="0"/></elevationProfile><lanes>')
    network = network_of(opendrive.parse_opendrive(file(hilly)))
    assert network.warnings == ("roads with heights or superelevation, which the plane does not have: road 7",)
    assert not list(faults(network))


def test_the_rule_of_traffic_is_read_in_small_letters() -> None:
    assert network_of(opendrive.parse_opendrive(file(ROAD.replace('junction="-1"', 'junction="-1" rule="lht"')))).driveOnLeft


def test_a_map_without_lanes_says_what_was_strange_about_it() -> None:
    with pytest.raises(MapError, match=r"no lanes on which to drive; lanes that are less than 0 m wide: road 7 lane 1, road 7 lane -1"):
        network_of(opendrive.parse_opendrive(file().replace(b'a="3.5"', b'a="-3.5"')))


MESSAGES: dict[str, tuple[bytes, str]] = {
    "not XML": (b"PK\x03\x04", "it is no XML"),
    "nothing": (b"", "it is no XML: no element found"),
    "another language": (b"<html/>", "an OpenDRIVE map is an <OpenDRIVE> element, not <html>"),
    "no roads": (b"<OpenDRIVE/>", "it has no roads"),
    "an encoding that there is not": (b'<?xml version="1.0" encoding="klingon"?><OpenDRIVE/>', "it is no XML: unknown encoding"),
    "a number that is a word": (
        file().replace(b'length="100" junction', b'length="long" junction'),
        "road 7: line 1: length of <road> must be a number",
    ),
    "a number that is none": (file().replace(b'a="3.5"', b'a="nan"'), "road 7: line 1: a of <width> must be a number, not 'nan'"),
    "a missing number": (file(shape="<arc/>"), "road 7: line 1: <arc> has no curvature"),
    "a shape that there is not": (file(shape="<bezier/>"), "road 7: line 1: <geometry> must be one of line, arc, spiral, poly3, paramPoly3"),
    "no length": (
        file().replace(b'length="100" junction', b'length="0" junction'),
        "road 7: line 1: its length must be between 0 and 1e+06 m, not 0",
    ),
    "no reference line": (file('<road id="7" length="5"><lanes>{lanes}</lanes></road>'), "road 7: line 1: it has no reference line"),
    "no lanes": (file(lanes=""), "road 7: line 1: it has no lanes"),
    "lanes with a gap": (file(lanes=LANES.replace('"-2"', '"-3"')), "road 7: line 1: there is a lane -3, and none between it and the lane 0"),
    "a lane with half a number": (file(lanes=LANES.replace('id="1"', 'id="1.5"')), "road 7: line 1: id of <lane> must be a whole number, not '1.5'"),
    "nowhere to drive": (file(lanes=LANES.replace("driving", "tram")), "it has no lanes on which to drive"),
    "a road twice": (file(more=ROAD.format(link="", shape="<line/>", lanes=LANES)), "road 7: line 1: there are two roads with this id"),
    "a link to who knows what": (
        file(link='<link><successor elementType="sea" elementId="1"/></link>'),
        "elementType of <successor> must be road or junction",
    ),
    "far away": (file().replace(b'x="0"', b'x="1e12"'), "the place or length of this <geometry> is out of range"),
    "a huge coefficient": (file().replace(b'a="3.5" b="0"', b'a="3.5" b="1e300"'), "road 7: line 1: b of <width> is out of range"),
    "a document type": (b'<!DOCTYPE OpenDRIVE [<!ENTITY a "aaaa">]><OpenDRIVE>&a;</OpenDRIVE>', "a map has no document type"),
    "an external entity": (b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><OpenDRIVE>&a;</OpenDRIVE>', "a map has no document type"),
    "elements without end": (b"<OpenDRIVE>" + b"<road>" * 100, "elements, or more than 64 within each other"),
    "a junction of nothing": (
        file(more='<junction id="3"><connection incomingRoad="7"/></junction>'),
        "junction 3: line 1: <connection> has no connectingRoad",
    ),
}


@pytest.mark.parametrize("fault", MESSAGES)
def test_a_broken_file_gets_a_message(fault: str, tmp_path: Path) -> None:
    data, message = MESSAGES[fault]
    path = tmp_path / "broken.xodr"
    path.write_bytes(data)
    with pytest.raises(MapError) as told:
        read_map(path)
    assert told.value.message.startswith(f"{path} is no usable OpenDRIVE map: ")
    assert message in told.value.message


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(MapError, match="there is no map "):
        read_map(tmp_path / "nothing.xodr")


NOTES: dict[str, tuple[bytes, str]] = {
    "a reference line that is too short": (
        file().replace(b'length="100" junction', b'length="120" junction'),
        "roads that are not as long as their reference lines: road 7 (120.00 m, 100.00 m)",
    ),
    "a width below 0": (file().replace(b'a="2"', b'a="2" x="" ').replace(b'b="0" c="0" d="0"/></lane></right>', b'b="-0.1" c="0" d="0"/></lane></right>'), "lanes that are less than 0 m wide: road 7 lane -2"),
    "heights": (file(ROAD.replace("<lanes>", '<elevationProfile><elevation s="0" a="3" b="0" c="0" d="0"/></elevationProfile><lanes>')), "roads with heights or superelevation, which the plane does not have: road 7"),
    "a section without length": (file(lanes=LANES.replace("<laneSection", "<laneSection", 1) + LANES.replace('s="0"', 's="100"', 1)), "lane sections without length, which are left out: road 7 at 100 m"),
    "a junction of roads that there are not": (
        file(more='<junction id="3"><connection incomingRoad="7" connectingRoad="8" contactPoint="start"/></junction>'),
        "connections of roads that there are not: junction 3",
    ),
}  # fmt: skip


@pytest.mark.parametrize("strange", NOTES)
def test_a_strange_file_loads_with_notes(strange: str) -> None:
    data, note = NOTES[strange]
    assert network_of(opendrive.parse_opendrive(data)).warnings == (note,)


def test_a_gap_between_linked_lanes_is_counted() -> None:
    link = '<link><successor elementType="road" elementId="8" contactPoint="start"/></link>'
    linked = LANES.replace('<lane id="-1" type="driving">', '<lane id="-1" type="driving"><link><successor id="-1"/></link>')
    other = ROAD.replace('id="7"', 'id="8"').replace('x="0"', 'x="100.5"').format(link="", shape="<line/>", lanes=LANES)
    network = network_of(opendrive.parse_opendrive(file(link=link, lanes=linked, more=other)))
    assert network.warnings == ("joints of lanes that are further apart than 1 cm: road 7 lane -1 to road 8 lane -1 (0.50 m)",)
    [straight] = network.laneAt((50, -1)).maneuvers  # type: ignore[union-attr]
    assert (straight.type.name, straight.endLane.road.id, straight.connectingLane) == ("STRAIGHT", "8", None)


def degenerate() -> list[tuple[str, Callable[[bytes], bytes]]]:
    return [
        ("a width of nothing", lambda data: data.replace(b'a="3.5"', b'a="0"', 1)),
        ("a bend around the inner edge", lambda data: data.replace(b"<line/>", b'<arc curvature="0.2857142857142857"/>')),
        ("a road shorter than a hair", lambda data: data.replace(b'length="100"', b'length="1e-7"')),
        ("a spiral without end", lambda data: data.replace(b"<line/>", b'<spiral curvStart="-50" curvEnd="50"/>')),
        ("a parametric point", lambda data: data.replace(b"<line/>", b'<paramPoly3 aU="0" bU="0" cU="0" dU="0" aV="0" bV="0" cV="0" dV="0"/>')),
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "change"), degenerate(), ids=lambda v: v if isinstance(v, str) else "")
def test_degenerate_shapes_are_a_map_or_a_message(name: str, change: Callable[[bytes], bytes]) -> None:
    try:
        network = network_of(opendrive.parse_opendrive(change(file())))
    except MapError as problem:
        assert problem.message
    else:
        assert network.lanes


@pytest.mark.parametrize("shape", ['<arc curvature="50"/>', '<spiral curvStart="0" curvEnd="1000000"/>', '<spiral curvStart="-50" curvEnd="0"/>'])
def test_a_road_that_turns_without_end_is_refused(shape: str) -> None:
    with pytest.raises(MapError, match="turns more than 64 times"):
        opendrive.parse_opendrive(file(shape=shape))


def test_a_map_whose_roads_all_belong_to_a_junction_is_read() -> None:
    assert not network_of(opendrive.parse_opendrive(file(ROAD.replace('junction="-1"', 'junction="4"')))).roads
