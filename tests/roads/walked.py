"""Maps read by code that shares nothing with their writer and their reader: where lanes begin and end, and what they are linked to."""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from scipy.integrate import quad
from scipy.special import fresnel

METRES, RADIANS = 1e-3, 1e-3
DRIVEN = {"driving", "entry", "exit", "onRamp", "offRamp"}

Placement = tuple[float, float, float]


def after_spiral(length: float, first: float, last: float) -> Placement:
    """Where a spiral ends that begins at the origin to the East, by Fresnel's integrals: the angle is (rate s² + 2 first s) / 2."""
    rate = (last - first) / length
    begin, scale = first / abs(rate), math.sqrt(math.pi / abs(rate))
    sign = math.copysign(1, rate)
    (s1, c1), (s0, c0) = fresnel((sign * begin + length) / scale), fresnel(sign * begin / scale)
    back = -first * first / (2 * rate)
    x, y = scale * (c1 - c0), sign * scale * (s1 - s0)
    turned = first * length + rate * length * length / 2
    return x * math.cos(back) - y * math.sin(back), x * math.sin(back) + y * math.cos(back), turned


def after(geometry: ET.Element) -> Placement:
    """Where a piece of a reference line ends, in its own coordinates."""
    [shape], length = geometry, float(geometry.get("length", ""))
    value = {name: float(text) for name, text in shape.attrib.items() if name != "pRange"}
    match shape.tag:
        case "line":
            return length, 0.0, 0.0
        case "arc":
            k = value["curvature"]
            return math.sin(k * length) / k, (1 - math.cos(k * length)) / k, k * length
        case "spiral":
            return after_spiral(length, value["curvStart"], value["curvEnd"])
        case "paramPoly3":
            assert shape.get("pRange") == "normalized"
            slope = [(value[f"b{c}"], 2 * value[f"c{c}"], 3 * value[f"d{c}"]) for c in "UV"]
            along = quad(lambda p: math.hypot(*(b + p * (c + p * d) for b, c, d in slope)), 0, 1)[0]
            assert 0 <= along - length < 2e-6
            u, v = (sum(value[f"{name}{c}"] for name in "abcd") for c in "UV")
            return u, v, math.atan2(sum(slope[1]), sum(slope[0]))
    raise AssertionError(shape.tag)


def placed(geometry: ET.Element, local: Placement) -> Placement:
    x, y, heading = (float(geometry.get(name, "")) for name in ("x", "y", "hdg"))
    u, v, turned = local
    return x + u * math.cos(heading) - v * math.sin(heading), y + u * math.sin(heading) + v * math.cos(heading), heading + turned


@dataclass
class PlannedLane:
    """A lane of a section at its beginning and its end: offsets of the inner and the outer edge, to the left."""

    type: str
    links: dict[str, int]
    edges: tuple[tuple[float, float], tuple[float, float]]


class Map:
    """A file, read."""

    def __init__(self, text: str) -> None:
        self.root = ET.fromstring(text)
        self.roads = {int(road.get("id", "")): road for road in self.root.iter("road")}
        self.junctions = {int(junction.get("id", "")): junction for junction in self.root.iter("junction")}
        [self.rule] = {road.get("rule") for road in self.roads.values()}
        self.ends = {id: self.checked_line(road) for id, road in self.roads.items()}
        self.sections = {id: list(self.lanes(road)) for id, road in self.roads.items()}

    def checked_line(self, road: ET.Element) -> tuple[Placement, Placement]:
        """The ends of the reference line, whose pieces follow each other."""
        pieces = list(road.iter("geometry"))
        total = 0.0
        for piece in pieces:
            assert float(piece.get("s", "")) == pytest.approx(total, abs=1e-9)
            assert float(piece.get("length", "")) > 1e-7
            total += float(piece.get("length", ""))
        assert float(road.get("length", "")) == pytest.approx(total, abs=1e-9)
        for one, other in itertools.pairwise(pieces):
            assert gap(placed(one, after(one)), placed(other, (0.0, 0.0, 0.0))) < METRES
        return placed(pieces[0], (0.0, 0.0, 0.0)), placed(pieces[-1], after(pieces[-1]))

    def lanes(self, road: ET.Element) -> Iterator[dict[int, PlannedLane]]:
        sections = list(road.iter("laneSection"))
        starts = [float(section.get("s", "")) for section in sections] + [float(road.get("length", ""))]
        assert starts == sorted(starts)
        for section, start, end in zip(sections, starts, starts[1:], strict=False):
            found: dict[int, PlannedLane] = {}
            for side, sign in (("left", 1), ("right", -1)):
                lanes = {int(lane.get("id", "")): lane for lane in section.iterfind(f"{side}/lane")}
                assert sorted(sign * id for id in lanes) == list(range(1, len(lanes) + 1))
                offset = [0.0, 0.0]
                for id in sorted(lanes, key=abs):
                    [width] = lanes[id].iterfind("width")
                    a, b, c, d = (float(width.get(name, "")) for name in "abcd")
                    widths = [a + x * (b + x * (c + x * d)) for x in (0.0, end - start)]
                    assert min(widths) > -1e-9
                    outer = [o + sign * w for o, w in zip(offset, widths, strict=True)]
                    links = {link.tag: int(link.get("id", "")) for link in lanes[id].iterfind("link/*")}
                    found[id] = PlannedLane(lanes[id].get("type", ""), links, ((offset[0], outer[0]), (offset[1], outer[1])))
                    offset = outer
            yield found

    def along(self, id: int) -> bool:
        """Whether traffic on a lane goes along the reference line."""
        return (id < 0) == (self.rule == "RHT")

    def edges(self, road: int, contact: str, id: int) -> list[Placement]:
        """Inner edge, middle and outer edge of a lane at an end of a road; directions are those of traffic."""
        last = contact == "end"
        x, y, heading = self.ends[road][last]
        inner, outer = self.sections[road][-1 if last else 0][id].edges[last]
        direction = heading if self.along(id) else heading + math.pi
        return [(x - t * math.sin(heading), y + t * math.cos(heading), direction) for t in (inner, (inner + outer) / 2, outer)]

    def joints(self) -> Iterator[tuple[tuple[int, str, int], tuple[int, str, int]]]:
        """Ends of lanes that are linked: road, end, lane."""
        for id, road in self.roads.items():
            for tag, contact in (("predecessor", "start"), ("successor", "end")):
                other = road.find(f"link/{tag}")
                for lane, found in self.sections[id][0 if contact == "start" else -1].items():
                    if other is not None and other.get("elementType") == "road" and tag in found.links:
                        yield (id, contact, lane), (int(other.get("elementId", "")), other.get("contactPoint", ""), found.links[tag])
                    else:
                        assert tag not in found.links

    def lane(self, road: int, contact: str, id: int) -> PlannedLane:
        return self.sections[road][-1 if contact == "end" else 0][id]

    def mouths(self) -> Iterator[tuple[int, int, str]]:
        """Junction, road, end: where roads that are in no junction meet one."""
        for id, road in self.roads.items():
            for tag, contact in (("predecessor", "start"), ("successor", "end")):
                link = road.find(f"link/{tag}")
                if link is not None and link.get("elementType") == "junction":
                    yield int(link.get("elementId", "")), id, contact

    def turned(self, road: int) -> float:
        """Radians by which a road turns, to the left."""
        return sum(after(piece)[2] for piece in self.roads[road].iter("geometry"))


def ends_of(read: Map, road: int) -> tuple[tuple[int, str], tuple[int, str]]:
    """What the beginning and the end of a road of a junction meet."""
    links = [read.roads[road].find(f"link/{tag}") for tag in ("predecessor", "successor")]
    one, other = ((int(link.get("elementId", "")), link.get("contactPoint", "")) for link in links if link is not None)
    return one, other


def gap(one: Placement, other: Placement) -> float:
    """Metres between two points whose directions are the same."""
    assert abs(math.remainder(one[2] - other[2], math.tau)) < RADIANS
    return math.dist(one[:2], other[:2])


def largest_gap(read: Map) -> float:
    """The largest distance between edges or middles of linked lanes; directions are equal, and traffic goes on in them.

    Sidewalks, shoulders and medians have no direction.
    """
    gaps = [0.0]
    for one, other in read.joints():
        types = {read.lane(*end).type for end in (one, other)}
        assert len(types) == 1 or types <= DRIVEN
        if not types & {"sidewalk", "shoulder", "median"}:
            assert ((one[1] == "end") == read.along(one[2])) != ((other[1] == "end") == read.along(other[2]))
            gaps += [gap(*pair) for pair in zip(read.edges(*one), read.edges(*other), strict=True)]
        else:
            gaps += [min(math.dist(a[:2], b[:2]) for b in read.edges(*other)) for a in read.edges(*one)]
    return max(gaps)
