"""The kinds of maps: the roads of each."""

from __future__ import annotations

import cmath
import math
import random

from .junction_plans import PlannedManeuver, junction
from .road_curves import Bend, Placement, bends, bends_to
from .road_plans import Neighbour, PlannedLane, PlannedRoad, PlannedSection, Side, breadth, mouth, to_curb
from .street_networks import SHORTEST_STREET, Street, Style, network

EAST, NORTH, WEST, SOUTH = (quarter * math.pi / 2 for quarter in range(4))
MEDIAN, HARD_SHOULDER, GORE = 1.5, 2.5, 1.0
"""Of highways, in metres: half of what separates the directions, a shoulder, and what is between shoulder and ramp where a junction begins."""
MERGING = 60.0
"""Metres along a highway that a junction with a ramp takes."""
RAMP_TURN = math.radians(60)


def star(style: Style, headings: list[float], leg: float) -> list[PlannedRoad]:
    """Streets from one junction."""
    points = [0j, *(cmath.rect(leg, heading) for heading in headings)]
    return network(points, [Street(0, heading, end, heading + math.pi) for end, heading in enumerate(headings, 1)], style)


def crossing(style: Style, legs: int, leg: float) -> list[PlannedRoad]:
    """One junction of streets with equal angles between them."""
    return star(style, [index * math.tau / legs for index in range(legs)], leg)


def t(style: Style, leg: float) -> list[PlannedRoad]:
    """One junction of a street from West to East and one from the South."""
    return star(style, [EAST, WEST, SOUTH], leg)


def grid(style: Style, rows: int, columns: int, block: float, leg: float, one_way: bool) -> list[PlannedRoad]:
    """Straight streets that cross `block` metres apart and end `leg` metres after the outermost crossings; the origin is in their middle."""

    def coordinates(number: int) -> list[float]:
        half = block * (number - 1) / 2
        return [-half - leg, *(block * index - half for index in range(number)), half + leg]

    def street(one: int, other: int, heading: float, back: bool) -> Street:
        if one_way and back:
            return Street(other, heading + math.pi, one, heading, True)
        return Street(one, heading, other, heading + math.pi, one_way)

    wide = columns + 2
    points = [complex(x, y) for y in coordinates(rows) for x in coordinates(columns)]
    eastward = [(row * wide + column, row) for row in range(1, rows + 1) for column in range(columns + 1)]
    northward = [(row * wide + column, column) for column in range(1, columns + 1) for row in range(rows + 1)]
    streets = [street(here, here + 1, EAST, row % 2 == 0) for here, row in eastward]
    return network(points, streets + [street(here, here + wide, NORTH, column % 2 == 0) for here, column in northward], style)


def roundabout(style: Style, legs: int, leg: float, island: float) -> list[PlannedRoad]:
    """A ring of one-way roads around an island of this radius, with a junction for each leg. Raises `ValueError` if it does not fit."""
    section = style.section()
    reach = island + to_curb(section.right) + style.radius  # from the middle to those of the corners
    half = math.asin((to_curb(section.right) + style.radius) / reach)  # of the angle that a junction takes
    back = reach * math.cos(half)
    arc = island * (math.tau / legs - 2 * half)
    if arc < 1.0:
        raise ValueError(f"with these lanes and this turning radius, junctions of {legs} legs do not fit around an island of {island:g} m")
    if leg < back + SHORTEST_STREET:
        raise ValueError(f"with these lanes and this turning radius, leg must be at least {back + SHORTEST_STREET:.1f} m, not {leg:g}")
    headings = [index * math.tau / legs for index in range(legs)]
    junctions = [Neighbour(2 * legs + 1 + index) for index in range(legs)]
    roads: list[PlannedRoad] = []
    for index, heading in enumerate(headings):
        line = (Bend(Placement(cmath.rect(back, heading), heading), leg - back),)
        roads.append(style.furnished(PlannedRoad(1 + index, line, (section,), junctions[index]), ["start"]))
    for index, heading in enumerate(headings):
        line = (Bend(Placement(cmath.rect(island, heading + half), heading + half + NORTH), arc, 1 / island, 1 / island),)
        roads.append(PlannedRoad(legs + 1 + index, line, (PlannedSection(0.0, (), section.right),), junctions[index], junctions[(index + 1) % legs]))
    maneuvers = [PlannedManeuver(start, lane, end, lane) for lane in range(style.lanes) for start, end in ((0, 2), (0, 1), (1, 2))]
    for index, other in enumerate(junctions):
        mouths = [mouth(roads[legs + (index - 1) % legs], "end"), mouth(roads[index], "start"), mouth(roads[legs + index], "start")]
        roads += junction(other.id, mouths, maneuvers)
    return roads


def highway(lanes: int, lane_width: float, radius: float, leg: float, ramp_lane: float, taper: float, shoulders: bool) -> list[PlannedRoad]:
    """A highway from West to East, with an on-ramp, whose lane ends after a while, and an off-ramp, before which a lane begins."""
    inner: Side = (PlannedLane("median", (MEDIAN,)), *(PlannedLane("driving", (lane_width,)),) * lanes)
    shoulder = (PlannedLane("shoulder", (HARD_SHOULDER,)),) * shoulders
    closing = lane_width, 0.0, -3 * lane_width / taper**2, 2 * lane_width / taper**3
    opening = 0.0, 0.0, -closing[2], -closing[3]
    types = (("entry", (lane_width,)), ("entry", closing), None, ("exit", opening), ("exit", (lane_width,)))
    beside: list[Side] = [() if found is None else (PlannedLane(*found),) for found in types]
    starts = [0.0, ramp_lane, ramp_lane + taper, 2 * ramp_lane + taper, 2 * ramp_lane + 2 * taper]
    sections = link_sections([PlannedSection(start, inner + shoulder, inner + lane + shoulder) for start, lane in zip(starts, beside, strict=True)])
    plain = (PlannedSection(0.0, inner + shoulder, inner + shoulder),)
    aside, length = breadth(shoulder) + GORE, starts[-1] + ramp_lane
    angle, edge, away = 2 * math.atan(aside / MERGING), breadth(inner) + aside, 2 * MERGING + length
    turning, k = (RAMP_TURN - 0.4) * radius, -1 / radius
    straight, curve = (leg, 0.0, 0.0), [(0.4 * radius, 0.0, k), (turning, k, k), (0.4 * radius, k, 0.0)]
    on_line = bends_to(Placement(complex(0, -edge), angle), [straight, *curve])
    off_line = bends(Placement(complex(away, -edge), -angle), [*curve, straight])
    merge, fork = Neighbour(6), Neighbour(7)
    west = PlannedRoad(1, bends(Placement(-leg + 0j, EAST), [straight]), plain, None, merge, type="motorway")
    middle = PlannedRoad(2, bends(Placement(MERGING + 0j, EAST), [(length, 0.0, 0.0)]), sections, merge, fork, type="motorway")
    east = PlannedRoad(3, bends(Placement(away + 0j, EAST), [straight]), plain, fork, type="motorway")
    on = PlannedRoad(4, on_line, (PlannedSection(0.0, (), (PlannedLane("onRamp", (lane_width,)), *shoulder)),), None, merge, type="motorway")
    off = PlannedRoad(5, off_line, (PlannedSection(0.0, (), (PlannedLane("offRamp", (lane_width,)), *shoulder)),), fork, type="motorway")
    through = [PlannedManeuver(start, lane, end, lane) for lane in range(1, lanes + 1) for start, end in ((0, 1), (1, 0))]
    merging = junction(6, [mouth(middle, "start"), mouth(west, "end"), mouth(on, "end")], [*through, PlannedManeuver(2, 0, 0, lanes + 1)])
    forking = junction(7, [mouth(east, "start"), mouth(middle, "end"), mouth(off, "start")], [*through, PlannedManeuver(1, lanes + 1, 2, 0)])
    return [west, middle, east, on, off, *merging, *forking]


def link_sections(sections: list[PlannedSection]) -> tuple[PlannedSection, ...]:
    """The sections of a road, with lanes linked that have the same type and the same place among those of this type."""

    def names(side: Side) -> list[tuple[str, int]]:
        return [(lane.type, sum(other.type == lane.type for other in side[:index])) for index, lane in enumerate(side)]

    def joined(before: Side, side: Side, after: Side, sign: int) -> Side:
        ids = [{name: sign * id for id, name in enumerate(names(other), 1)} for other in (before, after)]
        return tuple(PlannedLane(lane.type, lane.width, ids[0].get(name), ids[1].get(name)) for lane, name in zip(side, names(side), strict=True))

    nothing = PlannedSection(0.0, (), ())
    triples = zip([nothing, *sections], sections, [*sections[1:], nothing], strict=False)
    return tuple(PlannedSection(s.start, joined(a.left, s.left, b.left, 1), joined(a.right, s.right, b.right, -1)) for a, s, b in triples)


def suburb(style: Style, rows: int, columns: int, block: float, leg: float, seed: int) -> list[PlannedRoad]:
    """Winding streets: a grid whose points are moved and turned, without some of its streets, and with dead ends."""
    chance = random.Random(seed)
    streets, ends = draw_suburb_streets(chance, rows, columns)
    points: list[complex] = []
    headings: dict[tuple[int, int], float] = {}
    for place in range(rows * columns):
        row, column = divmod(place, columns)
        moved = complex(chance.uniform(-0.1, 0.1), chance.uniform(-0.1, 0.1))
        points.append(block * (complex(column - (columns - 1) / 2, row - (rows - 1) / 2) + moved))
        turning, ways = chance.uniform(-0.26, 0.26), sorted(way for one, way in streets | ends if one == place)
        for way in ways:
            headings[place, way] = way * NORTH + turning + (chance.uniform(-0.08, 0.08) if len(ways) > 2 else 0.0)
        if len(ways) == 2:
            one, other = ((place, way) for way in ways)
            bent = (math.pi - (headings[other] - headings[one])) / 2
            headings[one], headings[other] = headings[one] - bent, headings[other] + bent
    made = [Street(place, headings[place, way], next_to(place, way, columns), headings[next_to(place, way, columns), way + 2])
            for place, way in sorted(streets) if way < 2]  # fmt: skip
    for place, way in sorted(ends):
        heading, winding = headings[place, way], chance.uniform(-0.5, 0.5)
        points.append(points[place] + cmath.rect(leg, heading + winding / 2))
        made.append(Street(place, heading, len(points) - 1, heading + winding + math.pi))
    return network(points, made, style)


def next_to(place: int, way: int, columns: int) -> int:
    """The place to the East, North, West or South of one."""
    return place + (1, columns, -1, -columns)[way]


def draw_suburb_streets(chance: random.Random, rows: int, columns: int) -> tuple[set[tuple[int, int]], set[tuple[int, int]]]:
    """Places and ways from them: of the streets between places, in both directions, and of the dead ends.

    Every place can be reached; there are junctions of three and of four streets, and dead ends.
    """
    inner: list[tuple[int, int]] = []
    outer: list[tuple[int, int]] = []
    for place in range(rows * columns):
        row, column = divmod(place, columns)
        for way, inside in enumerate((column + 1 < columns, row + 1 < rows, column > 0, row > 0)):
            (inner if inside else outer).append((place, way))
    while True:
        streets = set(inner)
        for place, way in chance.sample(inner, len(inner)):
            both = {(place, way), (next_to(place, way, columns), (way + 2) % 4)}
            if way < 2 and chance.random() < 0.3 and count_reachable(streets - both, columns) == rows * columns:
                streets -= both
        ends = {end for end in outer if chance.random() < 0.35}
        if ends and {3, 4} <= {sum(one == place for one, _ in streets | ends) for place in range(rows * columns)}:
            return streets, ends


def count_reachable(streets: set[tuple[int, int]], columns: int) -> int:
    """How many places can be reached from the first."""
    seen, pending = {0}, [0]
    while pending:
        here = pending.pop()
        found = {next_to(here, way, columns) for one, way in streets if one == here} - seen
        seen |= found
        pending += found
    return len(seen)
