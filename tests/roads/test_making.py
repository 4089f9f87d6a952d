"""Maps that are made: their text is read here by itself, and linked lanes meet, in place, direction and width."""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET
from collections import Counter

import pytest
from scenic_ref.roads.map_generator import KINDS, generate_map

from .walked import DRIVEN, METRES, RADIANS, Map, after, ends_of, largest_gap

ALL = {"sidewalks": True, "shoulders": True, "bike_lanes": True, "signals": True, "crosswalks": True}
BARE = dict.fromkeys(ALL, False)

CASES = [
    *[(kind, {}) for kind in KINDS],
    *[(kind, {"left_hand": True}) for kind in KINDS],
    *[(kind, ALL) for kind in KINDS if kind != "highway"],
    *[(kind, {**ALL, "lanes": 2, "left_hand": True}) for kind in KINDS if kind != "highway"],
    *[(kind, {**BARE, "radius": 1.0}) for kind in KINDS if kind != "highway"],
    *[("crossing", {"lanes": lanes, "legs": legs, "lane_width": 3.1}) for lanes in (2, 3, 4) for legs in (3, 4)],
    *[("t", {"lanes": lanes, "shoulders": True}) for lanes in (2, 3, 4)],
    *[("grid", {"rows": 2, "columns": 2, "one_way": True, "lanes": lanes, **more}) for lanes in (1, 2, 3) for more in (ALL, BARE)],
    ("grid", {"rows": 3, "columns": 2, "one_way": True, "left_hand": True, **ALL}),
    *[("roundabout", {"lanes": lanes, "legs": legs, "island": 30.0, **more}) for lanes in (1, 2, 3) for legs in (3, 4) for more in (ALL, BARE)],
    *[
        ("highway", {"lanes": lanes, "shoulders": shoulders, "left_hand": left})
        for lanes in (1, 3, 4)
        for shoulders in (True, False)
        for left in (True, False)
    ],
    *[("suburb", {"seed": seed, **more}) for seed in range(1, 7) for more in ({}, {**ALL, "left_hand": True})],
    ("suburb", {"seed": 9, "rows": 5, "columns": 4, "lanes": 2, "block": 130.0}),
]
EACH = pytest.mark.parametrize("kind, parameters", CASES, ids=str)


@pytest.mark.sampled(8)
@EACH
def test_linked_lanes_meet_within_a_millimetre(kind: str, parameters: dict[str, float]):
    read = Map(generate_map(kind, **parameters))
    assert list(read.joints())
    assert largest_gap(read) < METRES


@pytest.mark.parametrize("attribute, by", [("x", 2 * METRES), ("y", 2 * METRES), ("hdg", 2 * RADIANS)])
def test_what_does_not_meet_is_found(attribute: str, by: float):
    read = Map(generate_map("crossing"))
    geometry = read.roads[501].find("planView/geometry")
    assert geometry is not None
    geometry.set(attribute, str(float(geometry.get(attribute, "")) + by))
    moved = Map(ET.tostring(read.root, encoding="unicode"))
    if attribute == "hdg":
        with pytest.raises(AssertionError):
            largest_gap(moved)
    else:
        assert largest_gap(moved) > METRES


@pytest.mark.sampled(8)
@EACH
def test_junctions_connect_what_their_roads_do(kind: str, parameters: dict[str, float]):
    read = Map(generate_map(kind, **parameters))
    mouths = set(read.mouths())
    inside = {int(road.get("id", "")): int(road.get("junction", "")) for road in read.roads.values() if road.get("junction") != "-1"}
    connected = []
    for id, junction in read.junctions.items():
        for connection in junction.iter("connection"):
            incoming, road = int(connection.get("incomingRoad", "")), int(connection.get("connectingRoad", ""))
            one, other = ends_of(read, road)
            assert (inside[road], connection.get("contactPoint"), incoming) == (id, "start", one[0])
            assert {(id, *one), (id, *other)} <= mouths
            links = {int(link.get("to", "")): int(link.get("from", "")) for link in connection.iter("laneLink")}
            assert links == {lane: found.links["predecessor"] for lane, found in read.sections[road][0].items() if read.along(lane)}
            connected.append(road)
    assert sorted(connected) == sorted(inside)


@pytest.mark.sampled(8)
@EACH
def test_every_lane_goes_on_and_comes_from_somewhere_at_junctions(kind: str, parameters: dict[str, float]):
    """So do sidewalks, round corners, once each."""
    read = Map(generate_map(kind, **parameters))
    met = Counter(end for joint in read.joints() for end in joint[1:])
    for _, road, contact in read.mouths():
        for id, lane in read.sections[road][-1 if contact == "end" else 0].items():
            if lane.type in DRIVEN:
                assert met[road, contact, id] > 0
            elif lane.type == "sidewalk":
                assert met[road, contact, id] == 1


@pytest.mark.sampled(8)
@EACH
def test_ways_through_junctions_neither_loop_nor_turn_round(kind: str, parameters: dict[str, float]):
    read = Map(generate_map(kind, **parameters))
    for id, road in read.roads.items():
        if road.get("junction") != "-1":
            one, other = ends_of(read, id)
            assert one[0] != other[0]
            assert sum(abs(after(piece)[2]) for piece in road.iter("geometry")) < math.radians(125)


@pytest.mark.sampled(8)
@EACH
def test_signals_are_for_every_lane_that_comes_to_a_junction(kind: str, parameters: dict[str, float]):
    read = Map(generate_map(kind, **parameters))
    valid = set()
    for id, road in read.roads.items():
        for signal in road.iter("signal"):
            assert signal.get("type") == "1000001"
            [validity] = signal
            contact = "end" if signal.get("orientation") == "+" else "start"
            valid |= {(id, contact, lane) for lane in range(int(validity.get("fromLane", "")), int(validity.get("toLane", "")) + 1)}
            assert abs(float(signal.get("s", "")) - (float(road.get("length", "")) if contact == "end" else 0)) < 5
    legs = {(road, contact) for _, road, contact in read.mouths() if kind != "roundabout" or {1, -1} <= read.sections[road][0].keys()}
    incoming = {(road, contact, id) for road, contact in legs for id, lane in read.sections[road][0].items()
                if lane.type in DRIVEN and read.along(id) == (contact == "end")}  # fmt: skip
    assert valid == (incoming if parameters.get("signals") else set())
    signalled = {(road, contact) for road, contact, _ in valid}
    for id, road in read.roads.items():
        drives = road.get("junction") != "-1" and any(lane.type in DRIVEN for lane in read.sections[id][0].values())
        assert len(list(road.iter("signalReference"))) == (drives and ends_of(read, id)[0] in signalled)


@pytest.mark.sampled(8)
@EACH
def test_crosswalks_go_from_curb_to_curb_before_junctions(kind: str, parameters: dict[str, float]):
    read = Map(generate_map(kind, **parameters))
    found = Counter()
    for id, road in read.roads.items():
        for crosswalk in road.iter("object"):
            corners = [(float(corner.get("u", "")), float(corner.get("v", ""))) for corner in crosswalk.iter("cornerLocal")]
            across, s, length = sorted({v for _, v in corners}), float(crosswalk.get("s", "")), float(road.get("length", ""))
            edges = [edge for lane in read.sections[id][0].values() if lane.type != "sidewalk" for edge in lane.edges[0]]
            assert across == pytest.approx([min(edges), max(edges)])
            assert all(0 < s + u < length for u, _ in corners)
            found[id, "start" if s < length / 2 else "end"] += 1
    ring = {road for road in read.roads if kind == "roundabout" and not {1, -1} <= read.sections[road][0].keys()}
    expected = {(road, contact): 1 for _, road, contact in read.mouths() if road not in ring}
    assert found == (expected if parameters.get("crosswalks") else {})


@pytest.mark.sampled(8)
@EACH
def test_bounds_hold_the_map(kind: str, parameters: dict[str, float]):
    read = Map(generate_map(kind, **parameters))
    header = read.root.find("header")
    assert header is not None
    north, south, east, west = (float(header.get(side, "")) for side in ("north", "south", "east", "west"))
    for id in read.roads:
        for contact in ("start", "end"):
            for lane in read.sections[id][-1 if contact == "end" else 0]:
                assert all(west <= x <= east and south <= y <= north for x, y, _ in read.edges(id, contact, lane))


@pytest.mark.parametrize("kind, parameters, roads, junctions, left, straight, right", [
    ("crossing", {}, 4, 1, 4, 4, 4),
    ("crossing", {"left_hand": True}, 4, 1, 4, 4, 4),
    ("crossing", {"lanes": 3}, 4, 1, 4, 12, 4),
    ("crossing", {"legs": 3}, 3, 1, 3, 0, 3),
    ("crossing", {"legs": 3, "lanes": 4}, 3, 1, 6, 0, 6),
    ("t", {}, 3, 1, 2, 2, 2),
    ("t", {"lanes": 2}, 3, 1, 2, 4, 2),
    ("t", {"lanes": 3}, 3, 1, 4, 6, 4),
    ("grid", {}, 24, 9, 36, 36, 36),
    ("grid", {"rows": 2, "columns": 1}, 7, 2, 8, 8, 8),
    ("grid", {"one_way": True, "lanes": 2, "sidewalks": False}, 24, 9, 9, 36, 9),
    ("grid", {"one_way": True}, 24, 9, 9, 18 + 18, 9),  # two corners of each crossing have a road for the sidewalk alone
    ("roundabout", {}, 8, 4, 4, 0, 8),
    ("roundabout", {"legs": 3, "lanes": 2, "island": 30.0}, 6, 3, 6, 0, 12),
    ("highway", {}, 5, 2, 0, 10, 0),
    ("highway", {"lanes": 4}, 5, 2, 0, 18, 0),
])  # fmt: skip
def test_numbers_of_roads_and_turns(
    kind: str, parameters: dict[str, float], roads: int, junctions: int, left: int, straight: int, right: int
):  # fmt: skip
    read = Map(generate_map(kind, **parameters))
    inside = [id for id, road in read.roads.items() if road.get("junction") != "-1"]
    ways = [0 if not any(lane.type == "driving" for lane in read.sections[id][0].values()) else read.turned(id) for id in inside]
    turns = Counter("left" if turn > math.radians(20) else "right" if turn < -math.radians(20) else "straight" for turn in ways)
    assert (len(read.roads) - len(inside), len(read.junctions)) == (roads, junctions)
    assert (turns["left"], turns["straight"], turns["right"]) == (left, straight, right)


@pytest.mark.parametrize("seed", range(5))
def test_suburbs_have_dead_ends_and_junctions_of_three_and_four_and_bends(seed: int):
    read = Map(generate_map("suburb", seed=seed))
    legs = Counter(Counter(junction for junction, _, _ in read.mouths()).values())
    assert legs.keys() == {3, 4}
    own = [road for road in read.roads.values() if road.get("junction") == "-1"]
    assert any(road.find("link/successor") is None for road in own)
    assert {"line", "arc", "spiral"} <= {shape.tag for road in own for shape in road.iterfind("planView/geometry/*")}


def test_lanes_of_ramps_end_and_begin_without_a_width():
    read = Map(generate_map("highway", lanes=2))
    sections = read.sections[2]
    assert [[lane.type for id, lane in section.items() if id < -3] for section in sections] == [
        ["entry", "shoulder"], ["entry", "shoulder"], ["shoulder"], ["exit", "shoulder"], ["exit", "shoulder"]
    ]  # fmt: skip
    widths = [abs(a - b) for a, b in sections[1][-4].edges + sections[3][-4].edges]
    assert widths == pytest.approx([3.5, 0, 0, 3.5])
    assert [sections[i][-4].links for i in (0, 1, 3, 4)] == [{"successor": -4}, {"predecessor": -4}, {"successor": -4}, {"predecessor": -4}]
    for one, other in itertools.pairwise(sections):
        for id, lane in one.items():
            if "successor" in lane.links:
                following = other[lane.links["successor"]]
                assert following.links["predecessor"] == id
                assert following.type == lane.type
                assert following.edges[0] == pytest.approx(lane.edges[1])


def test_traffic_on_the_left_is_the_mirror_image():
    right, left = Map(generate_map("suburb", shoulders=True)), Map(generate_map("suburb", shoulders=True, left_hand=True))
    assert (right.rule, left.rule) == ("RHT", "LHT")
    for id in right.roads:
        for lane in right.sections[id][0]:
            for (x, y, heading), (u, v, turned) in zip(right.edges(id, "start", lane), left.edges(id, "start", -lane), strict=True):
                assert (x, y) == pytest.approx((-u, v))
                assert math.remainder(math.pi - heading - turned, math.tau) == pytest.approx(0)


@pytest.mark.sampled(8)
@EACH
def test_equal_parameters_give_equal_bytes(kind: str, parameters: dict[str, float]):
    assert generate_map(kind, **parameters) == generate_map(kind, **parameters)


def test_seeds_give_different_suburbs():
    assert len({generate_map("suburb", seed=seed) for seed in range(10)}) == 10


@pytest.mark.parametrize("kind, parameters, message", [
    ("town", {}, "no kind of map 'town': there are grid, crossing"),
    ("crossing", {"lane": 2}, "no parameter 'lane': they have legs"),
    ("highway", {"sidewalks": True}, "no parameter 'sidewalks'"),
    ("crossing", {"lanes": 0}, "lanes must be a whole number from 1 to 4, not 0"),
    ("crossing", {"lanes": 5}, "lanes must be a whole number from 1 to 4, not 5"),
    ("crossing", {"lanes": 2.0}, "lanes must be a whole number from 1 to 4, not 2.0"),
    ("crossing", {"lanes": True}, "lanes must be a whole number from 1 to 4, not True"),
    ("crossing", {"legs": 5}, "legs must be a whole number from 3 to 4"),
    ("crossing", {"sidewalks": 1}, "sidewalks must be True or False, not 1"),
    ("crossing", {"lane_width": "3"}, "lane_width must be a number from 2 to 6, not '3'"),
    ("crossing", {"lane_width": math.nan}, "lane_width must be a number from 2 to 6, not nan"),
    ("crossing", {"radius": math.inf}, "radius must be a number from 0.5 to 200, not inf"),
    ("crossing", {"radius": 2.0}, "radius must be at least 2.5 m with sidewalks"),
    ("crossing", {"radius": 100.0}, r"at least 113\.5 m from the middle of a junction .* not 80\.0"),
    ("grid", {"block": 20.0}, "must be at least"),
    ("grid", {"leg": 12.0}, "must be at least"),
    ("roundabout", {"leg": 30.0}, "leg must be at least"),
    ("roundabout", {"island": 5.0, "lanes": 3}, "do not fit around an island of 5 m"),
    ("suburb", {"rows": 1}, "rows must be a whole number from 2"),
    ("suburb", {"seed": -1}, "seed must be a whole number from 0"),
    ("suburb", {"lanes": 4, "shoulders": True}, "too broad for the bends|must be at least"),
])  # fmt: skip
def test_wrong_parameters_are_refused_with_what_is_allowed(kind: str, parameters: dict[str, object], message: str):
    with pytest.raises(ValueError, match=message):
        generate_map(kind, **parameters)  # type: ignore[arg-type]


def test_whole_numbers_are_lengths_too():
    assert generate_map("crossing", leg=80) == generate_map("crossing", leg=80.0)
