"""The edges of lanes in the plane, from the records of a road."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPolygon, Polygon

from ..semantics.space.regions import PolylineRegion
from ..semantics.space.vectors import Vector
from . import reference_lines
from .opendrive import LaneRecord, Notes, Numbers, Profile, RoadRecord, SectionRecord

Points = NDArray[np.float64]
"""Of shape (n, 2), in metres."""
LEAST = 1e-6
"""Metres between two sampled distances along a road; so far from its ends a section is looked at, where another may begin."""
JOINT = 0.01
"""Metres by which what joins may be apart."""
SHORTEST = 1e-8
"""Metres that a line is long at least: files have sections of a few micrometres, by which the lanes before and after them are linked."""
TURNING = 2e-3
"""Metres of an edge around which a lane turns."""
WIDEST = 1000.0
"""Metres that a lane may be wide."""


@dataclass(frozen=True)
class LaneShape:
    """A lane of a section: its edges from the start of the road on, the nearer one to its middle first."""

    record: LaneRecord
    inner: Points
    outer: Points

    @property
    def width(self) -> Numbers:
        """Metres between the edges, at each point."""
        return np.hypot(*(self.outer - self.inner).T)


@dataclass(frozen=True)
class SectionShape:
    """The lanes of a section with their edges, and its middle line."""

    record: SectionRecord
    middle: Points
    lanes: Mapping[int, LaneShape]


def section_shapes(road: RoadRecord, notes: Notes) -> Iterator[SectionShape]:
    """The sections of a road with the edges of their lanes."""
    for at, gap in reference_lines.breaks(road.pieces, JOINT):
        notes.add(f"gaps in reference lines of more than {JOINT * 100:g} cm", f"road {road.id} at {at:g} m ({gap:.2f} m)")
    widest = max((sum(lane_width(lane, one) for lane in one.lanes.values()) for one in road.sections), default=0.0)
    grid = reference_lines.sample_distances(road.pieces, min(widest, WIDEST))
    for one in road.sections:
        yield section_shape(road, one, grid, notes)


def lane_width(lane: LaneRecord, section: SectionRecord) -> float:
    """About the largest width of a lane."""
    s = np.linspace(section.start + LEAST, section.end - LEAST, 9)
    return float(np.abs(lane.widths.at(s)).max(initial=0.0))


def section_shape(road: RoadRecord, section: SectionRecord, grid: Numbers, notes: Notes) -> SectionShape:
    """A section of a road; `grid` are the distances at which its reference line is looked at."""
    s = distances(road, section, grid)
    x, y, direction = reference_lines.along(road.pieces, s)
    left = np.column_stack([-np.sin(direction), np.cos(direction)])
    line = np.column_stack([x, y])
    middle = road.offsets.at(s)

    def at(t: Numbers) -> Points:
        return line + t[:, None] * left

    lanes: dict[int, LaneShape] = {}
    for side in (1, -1):
        t = middle
        for id in sorted((id for id in section.lanes if id * side > 0), key=abs):
            lane = section.lanes[id]
            outer = border(lane, s, t, middle, side, f"road {road.id} lane {id}", notes)
            lanes[id] = LaneShape(lane, at(t), at(outer))
            t = outer
    return SectionShape(section, at(middle), lanes)


def border(lane: LaneRecord, s: Numbers, inner: Numbers, middle: Numbers, side: int, where: str, notes: Notes) -> Numbers:
    """The t of the outer border: by the width of the lane, or as it is written."""
    width = lane.widths.at(s) if lane.widths.pieces or not lane.borders.pieces else side * (middle + lane.borders.at(s) - inner)
    if width.min() < -1e-3:
        notes.add("lanes that are less than 0 m wide", where)
    if width.max() > WIDEST:
        notes.add(f"lanes that are more than {WIDEST:g} m wide", where)
    return inner + side * np.clip(width, 0.0, WIDEST)


def distances(road: RoadRecord, section: SectionRecord, grid: Numbers) -> Numbers:
    """The distances along a road at which the edges of a section bend."""
    start, end = section.start + LEAST, section.end - LEAST
    if end <= start:
        return np.array([section.start, section.end])
    profiles: list[Profile] = [road.offsets, *(p for lane in section.lanes.values() for p in (lane.widths, lane.borders))]
    found = np.concatenate([grid, *(reference_lines.where_bent(p, section.end) for p in profiles)])
    found = np.unique(found[(found > start + LEAST) & (found < end - LEAST)])
    kept = found[np.diff(found, prepend=-math.inf) > 1e-4]
    return np.concatenate([[start], kept, [end]])


def drop_repeated_points(line: Points) -> Points:
    """A line without points that stand twice."""
    apart = np.hypot(*np.diff(line, axis=0).T) > 1e-4
    return line[np.concatenate([[True], apart])] if apart.any() else line[[0, -1]]


def simplify_line(line: Points) -> Points:
    """A line without the points that are no bends."""
    return shapely.get_coordinates(LineString(line).simplify(1e-4)) if len(line) > 2 else line


def area_between(left: Points, right: Points) -> Polygon | MultiPolygon:
    """The area between two edges with the same direction; where they cross, all that they enclose."""
    polygon = Polygon(np.concatenate([left, right[::-1]])) if len(left) + len(right) > 3 else Polygon()
    if polygon.is_valid:
        return polygon
    quads = [Polygon([a, b, d, c]) for a, b, c, d in zip(left, left[1:], right, right[1:], strict=False)] if len(left) == len(right) else []
    return areas(shapely.union_all([q if q.is_valid else q.convex_hull for q in quads or [polygon.buffer(0)]]))


def strips(left: Points, right: Points) -> list[tuple[Polygon, float]]:
    """The area between two edges cut across at their points, each part with its heading: that of the middle line there."""
    ahead = np.diff((left + right) / 2, axis=0)
    corners = np.stack([left[:-1], left[1:], right[1:], right[:-1]], axis=1)
    parts = [part if part.is_valid else part.convex_hull for part in map(Polygon, corners)]
    headings = np.arctan2(-ahead[:, 0], ahead[:, 1])
    return [(part, float(heading)) for part, heading in zip(parts, headings, strict=True) if isinstance(part, Polygon) and part.area > 1e-9]


def areas(shape: shapely.Geometry) -> Polygon | MultiPolygon:
    """Return the parts of a shape that have an area."""
    if isinstance(shape, (Polygon, MultiPolygon)):
        return shape
    return MultiPolygon([part for part in shapely.get_parts(shape) if isinstance(part, Polygon)])


def union_closing_gaps(polygons: Sequence[Polygon | MultiPolygon], gap: float = 0.005) -> Polygon | MultiPolygon:
    """The union of areas, with gaps of up to twice `gap` metres between them closed."""
    whole = shapely.union_all(polygons)
    closed = whole.buffer(gap, join_style="mitre").buffer(-gap, join_style="mitre")
    return areas(closed if closed.is_valid and not closed.is_empty else whole)


def directed_line(points: Points, ahead: Points) -> PolylineRegion:
    """A directed line through points; an edge around which a lane turns is a short line in its direction."""
    found = simplify_line(drop_repeated_points(points))
    if np.hypot(*np.diff(found, axis=0).T).sum() < SHORTEST:
        length = float(np.hypot(*ahead))
        found = np.array([found[0], found[0] + TURNING * (ahead / length if length > SHORTEST else np.array([1.0, 0.0]))])
    return PolylineRegion(points=[Vector(float(x), float(y)) for x, y in found])
