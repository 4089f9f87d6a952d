"""The records of an OpenDRIVE map (roads, lanes, signals, junctions), read from its file and checked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .xml_elements import Element, MapError, parse

HEIGHTS = "roads with heights or superelevation, which the plane does not have"
"""A note that is no fault."""


@dataclass
class Notes:
    """Oddities in a map that do not keep it from being read: how often each occurs, and where first."""

    found: dict[str, list[str]] = field(default_factory=dict[str, list[str]])

    def add(self, what: str, where: str) -> None:
        """Note one more oddity."""
        self.found.setdefault(what, []).append(where)

    def lines(self) -> list[str]:
        """Return one line for each oddity."""
        return [f"{what}: {_join_places(where)}" for what, where in self.found.items()]


def _join_places(where: Sequence[str]) -> str:
    return ", ".join(where[:3]) + (f" and {len(where) - 3} more" if len(where) > 3 else "")


def note_lane(side: str, element: Element, lane: LaneRecord, where: str, notes: Notes) -> None:
    """Note the oddities of a lane in a section."""
    if lane.id * (1 if side == "left" else -1) < 0:
        notes.add("lanes on the other side than their number says", where)
    if lane.id != 0 and not lane.widths.pieces and not lane.borders.pieces:
        notes.add("lanes without a width", where)
    if element.text("direction", "standard") != "standard":
        notes.add("lanes with a direction of traffic of their own, which is not heeded", where)


Numbers = NDArray[np.float64]
Contact = Literal["start", "end"]
LONGEST = 1e6
"""Metres that a road may have."""
MOST_TURNED = 64 * math.tau  # radians, of a piece of a road
FURTHEST = 1e8
"""Metres from the origin at which anything may be."""
MOST_LANES = 100


@dataclass(frozen=True, slots=True)
class Cubic:
    """a + b d + c d² + d d³, for d = s - `start`."""

    start: float
    a: float
    b: float
    c: float
    d: float


@dataclass(frozen=True, slots=True)
class Profile:
    """A piecewise cubic function of s: each piece holds from its start on; 0 before the first."""

    pieces: tuple[Cubic, ...]

    def at(self, s: Numbers) -> Numbers:
        """Return the values at some distances along the line."""
        found = np.zeros_like(s)
        if not self.pieces:
            return found
        table = np.array([(p.start, p.a, p.b, p.c, p.d) for p in self.pieces])
        which = np.searchsorted(table[:, 0], s, side="right") - 1
        start, a, b, c, d = table[np.maximum(which, 0)].T
        x = s - start
        return np.where(which >= 0, a + x * (b + x * (c + x * d)), 0.0)


@dataclass(frozen=True, slots=True)
class Piece:
    """A piece of a reference line: a line, arc, spiral, poly3 or paramPoly3, which begins at (x, y) with the direction `heading` (from East)."""

    s: float
    x: float
    y: float
    heading: float
    length: float
    kind: str
    parameters: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class RoadLink:
    """The road or lane to which a road or lane leads."""

    kind: Literal["road", "junction"]
    id: str
    contact: Contact | None = None


@dataclass(frozen=True, slots=True)
class LaneRecord:
    """A lane of a section: its width, or the t of its outer border, as a function of s from the start of the road."""

    id: int
    type: str
    widths: Profile
    borders: Profile
    predecessors: tuple[int, ...]
    successors: tuple[int, ...]
    speed: float | None
    """m/s"""


@dataclass(frozen=True, slots=True)
class SectionRecord:
    """The lanes from `start` to `end` of a road, by their numbers."""

    start: float
    end: float
    lanes: Mapping[int, LaneRecord]


@dataclass(frozen=True, slots=True)
class SignalRecord:
    """A signal: at s of its road, for traffic along the road ("+"), against it ("-") or both ("none")."""

    id: str
    s: float
    t: float
    orientation: str
    type: str
    country: str
    dynamic: bool
    valid: bool
    """Whether it is for a lane of this road: those that are for the lane 0 alone are for none, and stand here for other roads."""


@dataclass(frozen=True, slots=True)
class CrosswalkRecord:
    """A crosswalk: the corners of its outline, (s, t) or (u, v) around (s, t, heading)."""

    id: str
    s: float
    t: float
    heading: float
    corners: tuple[tuple[float, float], ...]
    local: bool


@dataclass(frozen=True, slots=True)
class RoadRecord:
    """A road; `junction` is the one that it connects roads within."""

    id: str
    name: str
    length: float
    junction: str | None
    left_hand: bool
    predecessor: RoadLink | None
    successor: RoadLink | None
    pieces: tuple[Piece, ...]
    offsets: Profile
    sections: tuple[SectionRecord, ...]
    signals: tuple[SignalRecord, ...]
    references: tuple[str, ...]
    """The ids of signals that stand elsewhere and mean this road."""
    crosswalks: tuple[CrosswalkRecord, ...]
    speed: float | None

    def link_at(self, contact: Contact) -> RoadLink | None:
        """Return the link at one of the road's ends."""
        return self.predecessor if contact == "start" else self.successor

    def section_at(self, contact: Contact) -> int:
        """The number of the section at one of its ends."""
        return 0 if contact == "start" else len(self.sections) - 1


@dataclass(frozen=True, slots=True)
class ConnectionRecord:
    """A way through a junction: which lanes of the incoming road lead to which of the connecting one."""

    incoming: str
    connecting: str
    contact: Contact
    lanes: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class JunctionRecord:
    """A junction with its connections."""

    id: str
    name: str
    connections: tuple[ConnectionRecord, ...]


@dataclass(frozen=True)
class OpenDrive:
    """A file: what is in it, its roads and junctions, by their ids, and what was noticed."""

    data: bytes
    roads: Mapping[str, RoadRecord]
    junctions: Mapping[str, JunctionRecord]
    notes: Notes


@contextmanager
def prefix_map_errors(what: str) -> Iterator[None]:
    """Errors inside say where they are."""
    try:
        yield
    except MapError as problem:
        raise MapError(f"{what}: {problem.message}") from None


def parse_opendrive(data: bytes) -> OpenDrive:
    """The roads and junctions of a file. Raises `MapError` for what is no OpenDRIVE or is broken."""
    root = parse(data)
    if root.name != "OpenDRIVE":
        raise MapError(f"line {root.line}: an OpenDRIVE map is an <OpenDRIVE> element, not <{root.name[:40]}>")
    notes = Notes()
    roads: dict[str, RoadRecord] = {}
    for element in root.all("road"):
        id = element.text("id")
        with prefix_map_errors(f"road {id}"):
            if id in roads:
                raise MapError(f"line {element.line}: there are two roads with this id")
            roads[id] = road(element, notes)
    junctions: dict[str, JunctionRecord] = {}
    for element in root.all("junction"):
        id = element.text("id")
        with prefix_map_errors(f"junction {id}"):
            junctions[id] = junction(element)
    if not roads:
        raise MapError("it has no roads")
    return OpenDrive(data, roads, junctions, notes)


def road(element: Element, notes: Notes) -> RoadRecord:
    """Read the record of a road. Raises `MapError`."""
    id, length = element.text("id"), element.number("length")
    if not 0 < length <= LONGEST:
        raise MapError(f"line {element.line}: its length must be between 0 and {LONGEST:g} m, not {length:g}")
    pieces = tuple(sorted((piece(g) for g in element.all("planView", "geometry")), key=lambda p: p.s))
    if not pieces:
        raise MapError(f"line {element.line}: it has no reference line (<planView> with <geometry>)")
    end = pieces[-1].s + pieces[-1].length
    if abs(end - length) > 0.01:
        notes.add("roads that are not as long as their reference lines", f"road {id} ({length:.2f} m, {end:.2f} m)")
    offsets = profile(element.all("lanes", "laneOffset"), "s", 0.0)
    speed = next((limit for limit in map(speed_of, element.all("type", "speed")) if limit is not None), None)
    unheeded = [*element.all("elevationProfile", "elevation"), *element.all("lateralProfile", "superelevation")]
    if any(e.number(name, 0.0) != 0.0 for e in unheeded for name in "abcd"):
        notes.add(HEIGHTS, f"road {id}")
    inside, rule = element.text("junction", "-1"), element.text("rule", "RHT")
    if rule.upper() not in ("RHT", "LHT"):
        notes.add("rules of traffic that are neither RHT nor LHT, and taken for RHT", f"road {id}")
    return RoadRecord(
        id=id, name=element.text("name", ""), length=length, junction=None if inside == "-1" else inside,
        left_hand=rule.upper() == "LHT",
        predecessor=link(element, "predecessor"), successor=link(element, "successor"), pieces=pieces, offsets=offsets,
        sections=tuple(sections(element, min(length, end), notes)),
        signals=tuple(signal(s) for s in element.all("signals", "signal")),
        references=tuple(e.text("id") for e in element.all("signals", "signalReference") if valid(e)),
        crosswalks=tuple(c for o in element.all("objects", "object") if o.text("type", "") == "crosswalk" for c in crosswalk(o, notes)),
        speed=speed,
    )  # fmt: skip


def link(element: Element, name: str) -> RoadLink | None:
    """The predecessor or successor of a road."""
    found = element.first("link", name)
    if found is None:
        return None
    kind = found.text("elementType", "road")
    if kind == "junction":
        return RoadLink("junction", found.text("elementId"))
    if kind != "road":
        raise MapError(f"line {found.line}: elementType of <{name}> must be road or junction, not {kind[:40]!r}")
    return RoadLink("road", found.text("elementId"), contact(found))


def contact(element: Element) -> Contact:
    """The end of another road at which it is met."""
    found = element.text("contactPoint", "start")
    if found not in ("start", "end"):
        raise MapError(f"line {element.line}: contactPoint of <{element.name}> must be start or end, not {found[:40]!r}")
    return "start" if found == "start" else "end"


def piece(element: Element) -> Piece:
    """A piece of a reference line."""
    s, x, y, heading, length = (element.number(name) for name in ("s", "x", "y", "hdg", "length"))
    if not (0 <= s <= LONGEST and 0 <= length <= LONGEST and math.hypot(x, y) < FURTHEST and abs(heading) < 1e6):
        raise MapError(f"line {element.line}: the place or length of this <geometry> is out of range")
    shape = next((c for c in element.children if c.name in SHAPES), None)
    if shape is None:
        raise MapError(f"line {element.line}: <geometry> must be one of {', '.join(SHAPES)}")
    parameters = tuple(bounded_coordinate(shape, name) for name in SHAPES[shape.name])
    if shape.name in ("arc", "spiral") and max(map(abs, parameters)) * length > MOST_TURNED:
        raise MapError(f"line {element.line}: this <{shape.name}> turns more than {MOST_TURNED / math.tau:.0f} times")
    if shape.name == "paramPoly3" and shape.text("pRange", "normalized") == "arcLength":
        parameters = (*parameters, 1.0)
    return Piece(s, x, y, math.remainder(heading, math.tau), length, shape.name, parameters)


SHAPES: Mapping[str, tuple[str, ...]] = {
    "line": (), "arc": ("curvature",), "spiral": ("curvStart", "curvEnd"), "poly3": ("a", "b", "c", "d"),
    "paramPoly3": ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"),
}  # fmt: skip
"""The kinds of pieces of a reference line, with their parameters."""


def bounded_coordinate(element: Element, name: str) -> float:
    """A number of a map. Raises `MapError` where nothing can be so large."""
    found = element.number(name)
    if abs(found) > FURTHEST:
        raise MapError(f"line {element.line}: {name} of <{element.name}> is out of range")
    return found


def profile(elements: Iterator[Element], place: str, start: float) -> Profile:
    """A piecewise cubic function; `place` is the attribute that says where each piece begins, counted from `start`."""
    pieces = [Cubic(start + bounded_coordinate(e, place), *(bounded_coordinate(e, name) for name in "abcd")) for e in elements]
    return Profile(tuple(sorted(pieces, key=lambda piece: piece.start)))


UNITS = {"m/s": 1.0, "km/h": 1 / 3.6, "mph": 0.44704}


def speed_of(element: Element) -> float | None:
    """A speed limit in m/s, None for "no limit" and "undefined"."""
    told = element.text("max")
    unit = element.text("unit", "m/s")
    if told in ("no limit", "undefined"):
        return None
    if unit not in UNITS:
        raise MapError(f"line {element.line}: the unit of a speed must be one of {', '.join(UNITS)}, not {unit[:40]!r}")
    return element.number("max") * UNITS[unit]


def sections(element: Element, end: float, notes: Notes) -> Iterator[SectionRecord]:
    """The lane sections of a road, in their order."""
    found = sorted(element.all("lanes", "laneSection"), key=lambda e: e.number("s"))
    if not found:
        raise MapError(f"line {element.line}: it has no lanes (<lanes> with <laneSection>)")
    starts = [e.number("s") for e in found]
    for i, one in enumerate(found):
        start, stop = starts[i], starts[i + 1] if i + 1 < len(starts) else end
        if stop - start <= 1e-9 or start >= end:
            notes.add("lane sections without length, which are left out", f"road {element.text('id')} at {start:g} m")
            continue
        sides = [(side, e, lane(e, start)) for side in ("left", "right") for e in one.all(side, "lane")]
        for side, e, found in sides:
            note_lane(side, e, found, f"road {element.text('id')} lane {found.id}", notes)
        lanes = {found.id: found for _, _, found in sides}
        if len(lanes) > MOST_LANES:
            raise MapError(f"line {one.line}: a section has more than {MOST_LANES} lanes")
        for id in lanes:
            if id != 0 and id - int(math.copysign(1, id)) not in (0, *lanes):
                raise MapError(f"line {one.line}: there is a lane {id}, and none between it and the lane 0")
        lanes.pop(0, None)
        yield SectionRecord(start, min(stop, end), lanes)


def lane(element: Element, start: float) -> LaneRecord:
    """A lane of a section that begins at `start`."""
    speeds = (speed_of(e) for e in element.all("speed"))
    return LaneRecord(
        element.whole("id"), element.text("type", "none"), profile(element.all("width"), "sOffset", start),
        profile(element.all("border"), "sOffset", start),
        tuple(e.whole("id") for e in element.all("link", "predecessor")), tuple(e.whole("id") for e in element.all("link", "successor")),
        next((speed for speed in speeds if speed is not None), None),
    )  # fmt: skip


def signal(element: Element) -> SignalRecord:
    """Read the record of a signal."""
    return SignalRecord(
        element.text("id", ""), element.number("s"), element.number("t", 0.0), element.text("orientation", "none"), element.text("type", ""),
        element.text("country", ""), element.text("dynamic", "no") == "yes", valid(element),
    )  # fmt: skip


def valid(element: Element) -> bool:
    """Whether a signal, or a reference to one, is for a lane of its road: for all, if it does not tell for which."""
    told = [(one.whole("fromLane"), one.whole("toLane")) for one in element.all("validity")]
    return not told or any(lanes != (0, 0) for lanes in told)


def crosswalk(element: Element, notes: Notes) -> Iterator[CrosswalkRecord]:
    """The outline of a crosswalk, if it has one; else its box."""
    place = element.text("id", ""), element.number("s"), element.number("t", 0.0), element.number("hdg", 0.0)
    outlines = [*element.all("outline"), *element.all("outlines", "outline")]
    for outline in outlines[:1]:
        around = tuple((c.number("u"), c.number("v")) for c in outline.all("cornerLocal"))
        along = tuple((c.number("s"), c.number("t")) for c in outline.all("cornerRoad"))
        if max(len(around), len(along)) >= 3:
            yield CrosswalkRecord(*place, corners=around or along, local=bool(around))
            return
    length, width = element.number("length", 0.0) / 2, element.number("width", 0.0) / 2
    if length > 0 and width > 0:
        yield CrosswalkRecord(*place, corners=((-length, -width), (length, -width), (length, width), (-length, width)), local=True)
    else:
        notes.add("crosswalks without an outline, which are left out", f"object {place[0]}")


def junction(element: Element) -> JunctionRecord:
    """Read the record of a junction."""
    connections = tuple(
        ConnectionRecord(
            found.text("incomingRoad"), found.text("connectingRoad"), contact(found),
            tuple((link.whole("from"), link.whole("to")) for link in found.all("laneLink")),
        )
        for found in element.all("connection") if found.text("type", "default") == "default"
    )  # fmt: skip
    return JunctionRecord(element.text("id"), element.text("name", ""), connections)

