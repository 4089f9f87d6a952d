"""OpenDRIVE 1.6 files (ASAM OpenDRIVE): roads as XML. For traffic on the left, everything is mirrored: West is East."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from itertools import groupby

from .road_curves import Bend, Piece, turn
from .road_plans import (
    DRIVEN,
    Neighbour,
    PlannedCrosswalk,
    PlannedRoad,
    PlannedSection,
    PlannedSignal,
    Side,
    breadth,
    driving_lane_indices,
)

DEPTH = 3.0
"""Metres that a crosswalk measures along the road."""
SPEED = {"town": 50, "motorway": 120}
"""Kilometres per hour."""

Value = str | bool | int | float


def child(parent: ET.Element, tag: str, **attributes: Value) -> ET.Element:
    """A new last child; floats are written with thirteen digits, those that are 0 but for rounding as 0."""

    def text(value: Value) -> str:
        if isinstance(value, float):
            return f"{value:.13g}" if abs(value) > 1e-13 else "0"
        return str(value).lower() if isinstance(value, bool) else str(value)

    return ET.SubElement(parent, tag, {name: text(value) for name, value in attributes.items()})


def opendrive_text(roads: Sequence[PlannedRoad], name: str, left_hand: bool) -> str:
    """The text of a file. Roads of one junction follow each other."""
    root = ET.Element("OpenDRIVE")
    writer = MapWriter(root, -1 if left_hand else 1)
    writer.header(roads, name)
    for road in roads:
        writer.road(road)
    for id, members in groupby(roads, lambda road: road.junction):
        if id is not None:
            writer.junction(id, list(members))
    ET.indent(root, "\t")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


GEOREFERENCE = "+proj=tmerc +lat_0=0 +lon_0=0 +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs"
"""Where the map lies on earth, which some readers insist on: the origin at 0 degrees North and East."""


class MapWriter:
    """Adds elements to the root; `hand` is 1 for traffic on the right, -1 for traffic on the left."""

    def __init__(self, root: ET.Element, hand: int) -> None:
        self.root, self.hand = root, hand

    def header(self, roads: Sequence[PlannedRoad], name: str) -> None:
        """The header, with a rectangle around all lanes."""
        reach = max(breadth(side) for road in roads for section in road.sections for side in (section.left, section.right))
        points = [piece.at(step / 16).point for road in roads for piece in road.line for step in range(17)]
        x, y = [self.hand * point.real for point in points], [point.imag for point in points]
        sides = {"north": max(y) + reach, "south": min(y) - reach, "east": max(x) + reach, "west": min(x) - reach}
        header = child(self.root, "header", revMajor=1, revMinor=6, name=name, version="1", **sides)
        child(header, "geoReference").text = GEOREFERENCE

    def road(self, road: PlannedRoad) -> None:
        """Write the element of a road."""
        rule, inside = "RHT" if self.hand == 1 else "LHT", -1 if road.junction is None else road.junction
        element = child(self.root, "road", name=f"road {road.id}", length=road.length, id=road.id, junction=inside, rule=rule)
        if road.predecessor or road.successor:
            link = child(element, "link")
            neighbour(link, "predecessor", road.predecessor)
            neighbour(link, "successor", road.successor)
        child(child(element, "type", s=0.0, type=road.type), "speed", max=SPEED[road.type], unit="km/h")
        view, s = child(element, "planView"), 0.0
        for piece in road.line:
            self.piece(view, s, piece)
            s += piece.length
        lanes = child(element, "lanes")
        for section in road.sections:
            self.section(lanes, section, marked=road.junction is None)
        if road.crosswalks:
            objects = child(element, "objects")
            for index, crosswalk in enumerate(road.crosswalks):
                self.crosswalk(objects, 2 * road.id + index, crosswalk)
        if road.signals or road.references:
            signals = child(element, "signals")
            for signal in road.signals:
                light = {"name": f"light {signal.id}", "dynamic": "yes", "zOffset": 5.0, "country": "OpenDRIVE", "type": "1000001", "subtype": "-1"}
                self.signal(signals, "signal", signal, **light)
            for signal in road.references:
                self.signal(signals, "signalReference", signal)

    def piece(self, view: ET.Element, s: float, piece: Piece) -> None:
        """A piece of the reference line."""
        point, heading = piece.start.point, piece.start.heading if self.hand == 1 else math.pi - piece.start.heading
        geometry = child(view, "geometry", s=s, x=self.hand * point.real, y=point.imag, hdg=turn(heading), length=piece.length)
        if isinstance(piece, Bend):
            if piece.first != piece.last:
                child(geometry, "spiral", curvStart=self.hand * piece.first, curvEnd=self.hand * piece.last)
            elif piece.first:
                child(geometry, "arc", curvature=self.hand * piece.first)
            else:
                child(geometry, "line")
        else:
            terms = list(zip("abcd", (0j, *piece.coefficients), strict=True))
            along, aside = (
                {f"{name}U": term.real for name, term in terms},
                {f"{name}V": self.hand * term.imag for name, term in terms},
            )
            child(geometry, "paramPoly3", **along, **aside, pRange="normalized")

    def section(self, lanes: ET.Element, section: PlannedSection, marked: bool) -> None:
        """A section of lanes, with marks between them unless the road is part of a junction."""
        element = child(lanes, "laneSection", s=section.start)
        left, right = (section.left, section.right)[:: self.hand]
        if left:
            group = child(element, "left")
            for index in reversed(range(len(left))):
                self.lane(group, 1 + index, left, marked)
        middle = child(child(element, "center"), "lane", id=0, type="none", level=False)
        if marked and driving_lane_indices(left) and driving_lane_indices(right):
            child(middle, "roadMark", sOffset=0.0, type="solid", color="yellow", width=0.12)
        if right:
            group = child(element, "right")
            for index in range(len(right)):
                self.lane(group, -1 - index, right, marked)

    def lane(self, group: ET.Element, id: int, side: Side, marked: bool) -> None:
        """A lane, with the mark at its outer edge."""
        lane = side[abs(id) - 1]
        element = child(group, "lane", id=id, type=lane.type, level=False)
        if lane.before is not None or lane.after is not None:
            link = child(element, "link")
            if lane.before is not None:
                child(link, "predecessor", id=self.hand * lane.before)
            if lane.after is not None:
                child(link, "successor", id=self.hand * lane.after)
        child(element, "width", sOffset=0.0, **dict(zip("abcd", (*lane.width, 0.0, 0.0, 0.0), strict=False)))
        if marked and lane.type in DRIVEN:
            kind = "broken" if any(other.type in DRIVEN for other in side[abs(id) :][:1]) else "solid"
            child(element, "roadMark", sOffset=0.0, type=kind, color="white", width=0.12)

    def crosswalk(self, objects: ET.Element, id: int, crosswalk: PlannedCrosswalk) -> None:
        """A crosswalk, across the road from curb to curb."""
        ends = {"name": f"crosswalk {id}", "type": "crosswalk", "orientation": "none", "hdg": 0.0}
        element = child(objects, "object", id=id, s=crosswalk.s, t=0.0, zOffset=0.0, **ends)
        outline = child(child(element, "outlines"), "outline", id=0, outer=True, closed=True)
        left, right = (crosswalk.left, crosswalk.right)[:: self.hand]
        for index, (u, v) in enumerate([(-0.5, -right), (0.5, -right), (0.5, left), (-0.5, left)]):
            child(outline, "cornerLocal", id=index, u=u * DEPTH, v=v, z=0.0, height=0.0)

    def signal(self, signals: ET.Element, tag: str, signal: PlannedSignal, **more: Value) -> None:
        """A signal or a reference to one."""
        element = child(signals, tag, id=signal.id, s=signal.s, t=self.hand * signal.t, orientation=signal.orientation, **more)
        first, last = sorted(self.hand * id for id in signal.lanes)
        child(element, "validity", fromLane=first, toLane=last)

    def junction(self, id: int, roads: Sequence[PlannedRoad]) -> None:
        """A junction with these roads; lanes of theirs to the left of the reference line lead nowhere new, and are linked by the roads alone."""
        element = child(self.root, "junction", id=id, name=f"junction {id}")
        for index, road in enumerate(roads):
            assert road.predecessor
            place = {"incomingRoad": road.predecessor.id, "connectingRoad": road.id, "contactPoint": "start"}
            connection = child(element, "connection", id=index, **place)
            for to, lane in enumerate(road.sections[0].right, 1):
                assert lane.before is not None
                child(connection, "laneLink", **{"from": self.hand * lane.before, "to": self.hand * -to})


def neighbour(link: ET.Element, tag: str, other: Neighbour | None) -> None:
    """Write the element for the neighbour before or after a road."""
    if other and other.contact:
        child(link, tag, elementType="road", elementId=other.id, contactPoint=other.contact)
    elif other:
        child(link, tag, elementType="junction", elementId=other.id)
