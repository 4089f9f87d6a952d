"""Features that a program suggests by its text: margins of its requirements, and distances to the boundaries that its positions were drawn within.

A fault that moves few scenes moves those near such a limit. Each feature is a function of the features of a scene alone, so that it is the
same for the scenes of any sampler; what depends on draws that a scene does not show is left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from ...interpreter.runtime.answerers import Draws
from ...semantics.space.distributions import PointIn
from ...semantics.space.geometry import TAU, corners, distance_to_box
from ...semantics.space.regions import (
    CircularRegion,
    DifferenceRegion,
    IntersectionRegion,
    PolygonalRegion,
    RectangularRegion,
    Region,
    SectorRegion,
    UnionRegion,
    Workspace,
    everywhere,
)
from ...semantics.space.vectors import Vector
from ..comparison.known_features import Support
from ..comparison.relations import MOST_RELATED, box_of, pose_of
from ..comparison.scene_columns import FeatureTable
from .evaluation_plan import cone
from .features import nodes_by_feature
from .graph import Graph, GraphEvent, GraphNode, RowDraw, Site
from .numpy_evaluator import column
from .primitives.point_in_polygon import tests_of
from .primitives.random_numbers import Numbers
from .scene_template import Template
from .symbolic import Choice, Opaque, Traced

ColumnOf = Callable[[GraphNode], np.ndarray]
Array = np.ndarray
COMBINED = (IntersectionRegion, UnionRegion, DifferenceRegion)


def is_known(region: Region) -> bool:
    """Whether `inside_by` can tell of such a region."""
    match region:
        case Workspace():
            return is_known(region.region)
        case IntersectionRegion() | UnionRegion() | DifferenceRegion():
            return is_known(region.first) and is_known(region.second)
        case CircularRegion() | SectorRegion() | RectangularRegion():
            return all(isinstance(v, (int, float)) or (isinstance(v, Traced) and not isinstance(v, (Choice, Opaque))) for v in numbers_in(region))
        case _:
            return isinstance(region, PolygonalRegion)


def numbers_in(region: Region) -> list[object]:
    """The symbols among the numbers that make up a region."""
    match region:
        case Workspace():
            return numbers_in(region.region)
        case IntersectionRegion() | UnionRegion() | DifferenceRegion():
            return [*numbers_in(region.first), *numbers_in(region.second)]
        case CircularRegion(center=c, radius=r):
            found = [c.x, c.y, r]
        case SectorRegion(center=c, radius=r, heading=h, angle=a):
            found = [c.x, c.y, r, h, a]
        case RectangularRegion(position=c, heading=h, width=w, length=l):
            found = [c.x, c.y, h, w, l]
        case _:
            found = []
    return [v for v in found if isinstance(v, Traced)]


def sectors_in(region: Region) -> list[SectorRegion]:
    """The sectors that a region is made of, but for discs: near the arc of one its sides hide what is near the arc alone."""
    match region:
        case Workspace():
            return sectors_in(region.region)
        case IntersectionRegion() | UnionRegion() | DifferenceRegion():
            return [*sectors_in(region.first), *sectors_in(region.second)]
        case SectorRegion(angle=angle) if not isinstance(angle, (int, float)) or angle < TAU:
            return [region]
        case _:
            return []


def within_arc(region: SectorRegion, x: Array, y: Array, column_of: ColumnOf) -> Array:
    """How far within the circle of a sector's arc the points are."""
    x0, y0, radius = (column_of(v.node) if isinstance(v, Traced) else v for v in (region.center.x, region.center.y, region.radius))
    return radius - np.hypot(x - x0, y - y0)


def reach_of(region: Region) -> float | None:
    """The largest coordinate of a region, in metres."""
    bounds = region.bounds()
    return None if bounds is None else max(1.0, *map(abs, bounds))


def inside_by(region: Region, x: Array, y: Array, column_of: ColumnOf) -> Array:
    """How far inside the points are, where the numbers of the region may be symbols with columns."""

    def number(value: object) -> object:
        return column_of(value.node) if isinstance(value, Traced) else value

    match region:
        case Workspace():
            return inside_by(region.region, x, y, column_of)
        case IntersectionRegion():
            return np.minimum(inside_by(region.first, x, y, column_of), inside_by(region.second, x, y, column_of))
        case UnionRegion():
            return np.maximum(inside_by(region.first, x, y, column_of), inside_by(region.second, x, y, column_of))
        case DifferenceRegion():
            return np.minimum(inside_by(region.first, x, y, column_of), -inside_by(region.second, x, y, column_of))
        case CircularRegion(center=c, radius=r):
            return number(r) - np.hypot(x - number(c.x), y - number(c.y))  # type: ignore[operator]
        case SectorRegion(center=c, radius=r, heading=h, angle=a):
            return inside_sector(x - number(c.x), y - number(c.y), number(r), number(h), number(a))  # type: ignore[operator, arg-type]
        case RectangularRegion(position=c, heading=h, width=w, length=l):
            dx, dy, turn = x - number(c.x), y - number(c.y), number(h)  # type: ignore[operator]
            u, v = dx * np.cos(turn) + dy * np.sin(turn), dy * np.cos(turn) - dx * np.sin(turn)  # type: ignore[call-overload]
            return np.minimum(number(w) / 2 - np.abs(u), number(l) / 2 - np.abs(v))  # type: ignore[operator]
        case PolygonalRegion():
            return inside_polygon(region, x, y)
        case _:
            raise AssertionError(region)


def inside_sector(x: Array, y: Array, radius: Array | float, heading: Array | float, angle: Array | float) -> Array:
    """How far inside a sector with its apex at the origin the points are."""
    far = np.hypot(x, y)
    off = np.abs((np.arctan2(-x, y) - heading + math.pi) % TAU - math.pi)
    past = np.asarray(angle) / 2 - off
    side = np.where(np.abs(past) <= math.pi / 2, far * np.sin(past), np.sign(past) * far)
    return np.where(np.asarray(angle) >= TAU, radius - far, np.minimum(radius - far, side))


def inside_polygon(region: PolygonalRegion, x: Array, y: Array) -> Array:
    """How far inside a polygon the points are, up to `reach_within` of it: further inside and outside all are at that distance."""
    tests, reach = tests_of(region), reach_within(region)
    grid, _ = tests.grid_for(reach)
    known = np.isfinite(x) & np.isfinite(y)
    px, py = np.where(known, x, 0.0), np.where(known, y, 0.0)
    square, rows = grid.square_of(px, py), np.arange(len(px))
    nearest = np.full(len(px), reach * reach)
    for k in range(grid.most):
        rows = rows[grid.counts[square[rows]] > k]
        if not len(rows):
            break
        ax, ay, bx, by = tests.edges[grid.lists[square[rows], k]].T
        dx, dy, ux, uy = bx - ax, by - ay, px[rows] - ax, py[rows] - ay
        along = np.clip((ux * dx + uy * dy) / np.maximum(dx * dx + dy * dy, 1e-300), 0.0, 1.0)
        off = (ux - along * dx) ** 2 + (uy - along * dy) ** 2
        nearest[rows] = np.minimum(nearest[rows], off)
    distance = np.sqrt(nearest)
    return np.where(known, np.where(tests.contains_point(px, py), distance, -distance), np.nan)


@lru_cache(maxsize=64)
def reach_within(region: PolygonalRegion) -> float:
    """How far from the boundary of a polygon points are told apart, in metres: half the width of a road, for a net of them."""
    return float(region.polygon.area / region.polygon.length)


MOST_SUGGESTED = 40
SLOW = (Site, RowDraw)
Values = Callable[[FeatureTable], "np.ndarray | None"]


class Suggestion(NamedTuple):
    """A feature: its values in a table, None where this lacks what it needs; and its support, if that is known."""

    name: str
    values: Values
    support: Support | None = None


class Suggested:
    """The features that a program suggests, by its graph and its scenes' template; `pruned` are smaller regions for its points."""

    def __init__(self, graph: Graph, template: Template, pruned: Draws, *, sure: bool) -> None:
        self.template = template
        self.nodes = nodes_by_feature(template)
        found = [*self.of_regions(graph, pruned, sure=sure), *self.of_requirements(graph.events), *self.of_workspace(), *self.of_views()]
        self.all = list({s.name: s for s in found}.values())[:MOST_SUGGESTED]

    @property
    def supports(self) -> dict[str, Support]:
        """The known supports by name."""
        return {s.name: s.support for s in self.all if s.support is not None}

    def __call__(self, table: FeatureTable) -> Mapping[str, np.ndarray]:
        """The features that follow from those of a table."""
        with np.errstate(all="ignore"):
            found = {s.name: s.values(table) for s in self.all}
        return {name: values for name, values in found.items() if values is not None}

    # Requirements

    def of_requirements(self, events: Sequence[GraphEvent]) -> Iterator[Suggestion]:
        """By how much each comparison that is required holds."""
        number = 0
        for event in events:
            if event.kind == "require" and event.condition is None and event.requirement is not None:
                for smaller, larger in comparisons(event.node, event.expected):
                    parts = [part for part in (smaller, larger) if isinstance(part, GraphNode)]
                    if self.follows(parts):
                        number += 1
                        name = f"margin({number}, {event.requirement.text})"
                        yield Suggestion(name, partial(self.margin, smaller, larger))

    def follows(self, nodes: Sequence[GraphNode]) -> bool:
        """Whether nodes can be computed from the features of a scene."""
        known = {node.number for node in self.nodes.values()}
        return all(not isinstance(node.function, SLOW) for node in cone(list(nodes), known))

    def margin(self, smaller: object, larger: object, table: FeatureTable) -> np.ndarray | None:
        """The difference of two numbers of the graph."""
        found = self.evaluated([n for n in (smaller, larger) if isinstance(n, GraphNode)], table)
        if found is None:
            return None
        low, high = (found[n.number] if isinstance(n, GraphNode) else n for n in (smaller, larger))
        return np.broadcast_to(np.asarray(high, dtype=float) - np.asarray(low, dtype=float), table.n).copy()  # type: ignore[arg-type]

    def evaluated(self, nodes: Sequence[GraphNode], table: FeatureTable) -> dict[int, np.ndarray] | None:
        """The columns of nodes, None if the table lacks a feature that they follow from."""
        known = {node.number: table.arrays[name] for name, node in self.nodes.items() if is_numeric(table, name)}
        needed = cone(list(nodes), set(known))
        if any(isinstance(node.function, SLOW) for node in needed):
            return None
        zeros = np.zeros(table.n, dtype=np.uint64)
        numbers, failed = Numbers(0, zeros, zeros), {}
        for node in needed:
            known[node.number] = column(node, known, numbers, failed)
        return known

    # Regions

    def of_regions(self, graph: Graph, pruned: Draws, *, sure: bool) -> Iterator[Suggestion]:
        """How far inside the region that it was drawn from each position is; `sure`: that it is inside is known of all scenes."""
        for address, (region, drawn) in graph.points.items():
            for i, o in enumerate(self.template.objects):
                place = o.properties["position"]
                if not (isinstance(place, Vector) and isinstance(drawn, Vector)):
                    continue
                same = all(is_same(p, d) for p, d in zip(place, drawn, strict=True))
                if not (same or all(is_moved(p, d) for p, d in zip(place, drawn, strict=True))):
                    continue
                yield from self.inside(f"boundaryDistance({i}, its region)", i, region, exact=same and sure)
                smaller = pruned.get(address) if not same else None
                if isinstance(smaller, PointIn):
                    yield from self.inside(f"boundaryDistance({i}, its pruned region)", i, smaller.region, exact=False)

    def inside(self, name: str, i: int, region: Region, *, exact: bool) -> Iterator[Suggestion]:
        """How far inside a region the position of object `i` is."""
        parts = numbers_in(region)
        if is_known(region) and self.follows([v.node for v in parts if isinstance(v, Traced)]):
            reach = reach_of(region) if exact and not parts else None
            yield Suggestion(name, partial(self.depth, i, region, inside_by), None if reach is None else Support(low=0.0, scale=2.0 * reach))
            for sector in sectors_in(region):
                yield Suggestion(name.replace(")", ", from its arc)"), partial(self.depth, i, sector, within_arc))

    def depth(self, i: int, region: Region, how_far: Callable[..., np.ndarray], table: FeatureTable) -> np.ndarray | None:
        """The values of `inside`: how far, by a function of the region, the position and the columns of its numbers."""
        pose = pose_of(table.arrays, i)
        found = self.evaluated([v.node for v in numbers_in(region) if isinstance(v, Traced)], table)
        return None if pose is None or found is None else how_far(region, pose[0], pose[1], lambda node: found[node.number])

    def of_workspace(self) -> Iterator[Suggestion]:
        """How far inside the workspace the worst corner of each object is."""
        region = self.template.workspace
        if region is not everywhere and is_known(region) and not numbers_in(region):
            for i in range(min(len(self.template.objects), MOST_RELATED)):
                yield Suggestion(f"boundaryDistance({i}, workspace)", partial(self.corner_depth, i, region))

    def corner_depth(self, i: int, region: Region, table: FeatureTable) -> np.ndarray | None:
        """The least depth of the corners of object `i`."""
        pose = pose_of(table.arrays, i)
        if pose is None or len(pose) < 5:
            return None
        return np.min([inside_by(region, p.x, p.y, no_column) for p in corners(*box_of(pose))], axis=0)  # type: ignore[arg-type]

    # Views

    def of_views(self) -> Iterator[Suggestion]:
        """How much nearer than ego can see the box of each object is."""
        ego = self.template.ego_id
        if ego is None:
            return
        for i, o in enumerate(self.template.objects[:MOST_RELATED]):
            if i != ego and o.properties.get("requireVisible") is not False:
                yield Suggestion(f"viewMargin({i})", partial(self.view_margin, ego, i))

    def view_margin(self, number: int, i: int, table: FeatureTable) -> np.ndarray | None:
        """View distance of ego, which is object `number`, less the distance from it to the box."""
        ego, pose = pose_of(table.arrays, number), pose_of(table.arrays, i)
        own = f"objects[{number}].properties"
        reach = table.arrays.get(f"{own}.visibleDistance", table.arrays.get(f"{own}.viewDistance"))  # reading `view-distance`
        if ego is None or pose is None or len(pose) < 5 or reach is None or reach.dtype != np.float64:
            return None
        return reach - np.asarray(distance_to_box(*box_of(pose), Vector(ego[0], ego[1])))  # type: ignore[arg-type]


def no_column(node: GraphNode) -> np.ndarray:
    """For regions without symbols."""
    raise AssertionError(node)


def is_numeric(table: FeatureTable, name: str) -> bool:
    """Whether a table has that feature, as numbers."""
    return name in table.arrays and table.arrays[name].dtype == np.float64


def comparisons(node: GraphNode, expected: bool) -> Iterator[tuple[object, object]]:
    """The comparisons a < b that must all hold, or fail to be wrong, for a condition to be as expected: pairs of a and b."""
    function = node.function
    if function in (np.less, np.less_equal, np.greater, np.greater_equal):
        a, b = node.arguments
        yield (a, b) if (function in (np.less, np.less_equal)) == expected else (b, a)
    elif function is np.logical_not:
        yield from (pair for part in node.arguments if isinstance(part, GraphNode) for pair in comparisons(part, not expected))
    elif function in (np.logical_and, np.logical_or) and (function is np.logical_and) == expected:
        yield from (pair for part in node.arguments if isinstance(part, GraphNode) for pair in comparisons(part, expected))


def is_same(position: object, drawn: object) -> bool:
    """Whether a coordinate is the one that was drawn."""
    return is_plain(position) and is_plain(drawn) and position.node is drawn.node  # type: ignore[attr-defined]


def is_moved(position: object, drawn: object) -> bool:
    """Whether a coordinate is the sum of the one that was drawn and something else, such as noise."""
    if not (is_plain(position) and is_plain(drawn)):
        return False
    return position.node.function is np.add and drawn.node in position.node.arguments  # type: ignore[attr-defined]


def is_plain(value: object) -> bool:
    """Whether a value is a number of the graph."""
    return isinstance(value, Traced) and not isinstance(value, (Choice, Opaque))

