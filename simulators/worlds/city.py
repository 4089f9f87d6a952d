"""A made-up city that stands in for the map of the paper's case study (GTA): roads, curbs and traffic directions.

It is a pure function of the constants below: a grid of gently winding avenues (three lanes a side) and streets (one lane a
side), a boulevard across it, and one-way ramps round the corners of some junctions. Traffic keeps to the right. It covers
about 300 m by 300 m around the coordinates of the gallery's scenes: (-628.8, -540.6) is on the left northbound lane of an avenue. Metres; headings
in radians anticlockwise from North.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, MultiPolygon, Polygon

from ...semantics.space.boundaries import unite_shapes, without
from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.regions import PolygonalRegion, PolylineRegion

WEST, SOUTH, EAST, NORTH = -785.0, -690.0, -485.0, -390.0
LANE = 3.5  # width of a lane
SHOULDER = 0.6  # width of the strip between the outermost lane and the edge of the road
CURB_INSET = 0.25  # how far inside the edge of the road a curb runs, so that its points have a traffic direction
SHORTEST_CURB = 4.0
STEP = 10.0  # length of a cell along a road that is not a ramp
RAMP_RADIUS = 38.0
SLIT = 0.2  # a gap between roads that is narrower than this is road

# Centre lines: (coordinate, amplitude of the winding, its wave length, where it starts), across the whole city.
NORTH_SOUTH_AVENUES = ((-635.1, 5.0, 820.0, 0.9711), (-520.0, 7.0, 330.0, 0.80))
EAST_WEST_AVENUES = ((-645.0, 6.0, 420.0, 0.65), (-440.0, 7.0, 400.0, 0.05))
NORTH_SOUTH_STREETS = ((-725.0, 5.0, 280.0, 0.75),)
EAST_WEST_STREETS = ((-580.0, 4.0, 320.0, 0.90),)
BOULEVARD = ((-775.0, -405.0), (-750.0, -520.0), (-690.0, -610.0), (-560.0, -682.0))  # a cubic Bézier curve
RAMP_JUNCTIONS = ((0, 0), (0, 1))  # of which avenues: (north-south, east-west)

Cell = tuple[Polygon, float]


@dataclass(frozen=True, eq=False)
class CityRoad:
    """A road: its cells, its outline, and its curbs (right edges, in the direction of traffic) before junctions cut them."""

    cells: tuple[Cell, ...]
    outline: Polygon
    curbs: tuple[LineString, ...]


@dataclass(frozen=True, eq=False)
class City:
    """The map. In `cells`, (polygon, heading of traffic), earlier ones take precedence; `road` is their union, slits closed."""

    cells: tuple[Cell, ...]
    road: Polygon | MultiPolygon
    curbs: tuple[LineString, ...]

    @functools.cached_property
    def _direction(self) -> PolygonalVectorField:
        return PolygonalVectorField("roadDirection", self.cells)

    @functools.cached_property
    def _road(self) -> PolygonalRegion:
        return PolygonalRegion(polygon=self.road, orientation=self._direction, name="road")

    @functools.cached_property
    def _curb(self) -> PolylineRegion:
        return PolylineRegion(polyline=self.curbs, orientation=self._direction, name="curb")

    def road_direction(self) -> PolygonalVectorField:
        """The heading of traffic, on the road only."""
        return self._direction

    def road_region(self) -> PolygonalRegion:
        """All roads, oriented along traffic."""
        return self._road

    def curb_region(self) -> PolylineRegion:
        """All curbs, oriented along traffic: the road is to their left."""
        return self._curb


@functools.cache
def city() -> City:
    """The city; made once."""
    roads = tuple(_roads())
    cells = tuple(cell for road in roads for cell in road.cells)
    union = unite_shapes([polygon for polygon, _ in cells])
    closed = union.buffer(SLIT / 2, join_style="mitre").buffer(-SLIT / 2, join_style="mitre")  # no slits between roads that cross
    assert isinstance(closed, (Polygon, MultiPolygon))
    return City(cells, closed, tuple(_cut_curbs(roads)))


def _roads() -> Iterator[CityRoad]:
    for line in NORTH_SOUTH_AVENUES:
        yield _two_way(_north_south(line), lanes=3)
    for line in EAST_WEST_AVENUES:
        yield _two_way(_north_south(line, swap=True), lanes=3)
    yield _two_way(_bezier(BOULEVARD), lanes=3)
    for line in NORTH_SOUTH_STREETS:
        yield _two_way(_north_south(line), lanes=1)
    for line in EAST_WEST_STREETS:
        yield _two_way(_north_south(line, swap=True), lanes=1)
    for i, j in RAMP_JUNCTIONS:
        yield _ramp(*_crossing_point(NORTH_SOUTH_AVENUES[i], EAST_WEST_AVENUES[j]))


def _winding_coordinate(line: tuple[float, float, float, float], along: np.ndarray) -> np.ndarray:
    """The coordinate across the road where the coordinate along it is `along`."""
    middle, amplitude, wave, start = line
    return middle + amplitude * np.sin(2 * math.pi * (along / wave + start))


def _north_south(line: tuple[float, float, float, float], *, swap: bool = False) -> np.ndarray:
    """A centre line, (n, 2), from South to North; from West to East if `swap`."""
    low, high = (WEST, EAST) if swap else (SOUTH, NORTH)
    along = np.linspace(low, high, round((high - low) / STEP) + 1)
    across = _winding_coordinate(line, along)
    return np.stack([along, across] if swap else [across, along], axis=1)


def _bezier(control: tuple[tuple[float, float], ...]) -> np.ndarray:
    """A cubic Bézier curve as a centre line, (n, 2), in steps of about `STEP` metres."""
    a, b, c, d = (np.array(point) for point in control)
    count = round(sum(math.dist(p, q) for p, q in itertools.pairwise(control)) / STEP)
    t = np.linspace(0.0, 1.0, count + 1)[:, None]
    return (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t * t * (1 - t) * c + t**3 * d


def _crossing_point(
    north_south: tuple[float, float, float, float], east_west: tuple[float, float, float, float]
) -> tuple[float, float]:  # fmt: skip
    """Return the point at which two centre lines cross, by iteration (both are nearly straight)."""
    x, y = np.array(north_south[0]), np.array(east_west[0])
    for _ in range(20):
        x, y = _winding_coordinate(north_south, y), _winding_coordinate(east_west, x)
    return float(x), float(y)


def _two_way(center: np.ndarray, lanes: int) -> CityRoad:
    half = lanes * LANE + SHOULDER
    right, left = _beside(center, half), _beside(center, -half)
    with_line = _quads(center, right)
    against = _quads(center[::-1], left[::-1])
    curbs = (LineString(_beside(center, half - CURB_INSET)), LineString(_beside(center, CURB_INSET - half)[::-1]))
    return CityRoad((*with_line, *against), _outline(left, right), curbs)


def _ramp(x: float, y: float) -> CityRoad:
    """A one-way ramp from the right northbound lane to the right eastbound lane of the avenues that cross at (x, y)."""
    offset, half = 2.2 * LANE, LANE / 2 + SHOULDER
    middle = np.array([x + offset + RAMP_RADIUS, y - offset - RAMP_RADIUS])
    angles = np.linspace(math.pi, math.pi / 2, 13)
    center = middle + RAMP_RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    left, right = _beside(center, -half), _beside(center, half)
    return CityRoad(_quads(left, right), _outline(left, right), (LineString(_beside(center, half - CURB_INSET)),))


def _beside(center: np.ndarray, distance: float) -> np.ndarray:
    """The line `distance` metres to the right of a line (to the left if negative)."""
    ahead = np.gradient(center, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    return center + distance * np.stack([ahead[:, 1], -ahead[:, 0]], axis=1)


def _quads(left: np.ndarray, right: np.ndarray) -> tuple[Cell, ...]:
    """The cells of one direction of a road between its left and right edges, with the heading of each one's middle line."""
    middle = (left + right) / 2
    ahead = np.diff(middle, axis=0)
    headings = np.arctan2(-ahead[:, 0], ahead[:, 1])
    rings = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
    return tuple((Polygon(ring), float(heading)) for ring, heading in zip(rings, headings, strict=True))


def _outline(left: np.ndarray, right: np.ndarray) -> Polygon:
    return Polygon(np.concatenate([left, right[::-1]]))


def _cut_curbs(roads: tuple[CityRoad, ...]) -> Iterator[LineString]:
    """The curbs without the parts on other roads: curbs are interrupted at junctions."""
    outlines = [road.outline for road in roads]
    tree = shapely.STRtree(outlines)
    for number, road in enumerate(roads):
        for curb in road.curbs:
            others = unite_shapes([outlines[i] for i in tree.query(curb, predicate="intersects") if i != number])
            pieces = shapely.get_parts(without(curb, others))
            yield from (piece for piece in pieces if piece.length >= SHORTEST_CURB)
