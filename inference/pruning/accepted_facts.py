"""Facts of every accepted run: the requirements of a graph, taken apart. Soft requirements are left out,
since runs pass without them.

A requirement event without a coin rejects every run in which its node is not as expected, so that the node is
so in every scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...semantics.machine.config import State
from ...semantics.machine.values import Instance, unwrap
from ...semantics.scenes.default_requirements import (
    default_requirements,
    in_region_of_its_own,
    in_workspace,
    visible,
    workspace_of,
)
from ...semantics.space.boundaries import widen_shape
from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.regions import PolygonalRegion, RectangularRegion, Region, Workspace
from ...semantics.space.regions.approximation import box_shape
from ...semantics.store.built_in_classes import view_distance
from ..batch.graph import Graph, GraphNode, RowCall
from ..batch.symbolic import symbols_in
from .algorithms import Shape, polygons_of
from .node_bounds import Interval, Point, bounds, bounds_of_value, field_looked_up, point_of


class Truth(NamedTuple):
    """A node for truth values that is `holds` in every accepted run."""

    node: GraphNode
    holds: bool


class Contained(NamedTuple):
    """A box with its centre at `point` lies in `container` in every accepted run; its edges are at least `min_radius` from the centre."""

    point: Point
    container: Shape
    min_radius: float


class Located(NamedTuple):
    """A field has a value at `point` in every accepted run, so that the point lies in a polygon of the field."""

    point: Point
    field: PolygonalVectorField


def truths(graph: Graph, *, soft: bool = False) -> Iterator[Truth]:
    """Yield the truths in the hard requirements (or, for reports only, the soft ones), conjunctions taken
    apart.
    """
    for event in graph.events:
        if event.kind == "require" and (event.condition is not None) is soft:
            yield from _conjuncts(Truth(event.node, event.expected))


def _conjuncts(truth: Truth) -> Iterator[Truth]:
    node, holds = truth
    if node.function is np.logical_not:
        yield from (part for a in node.arguments if isinstance(a, GraphNode) for part in _conjuncts(Truth(a, not holds)))
    elif node.function is (np.logical_and if holds else np.logical_or):
        yield from (part for a in node.arguments if isinstance(a, GraphNode) for part in _conjuncts(Truth(a, holds)))
    else:
        yield truth


def field_lookup_points(graph: Graph) -> Iterator[Located]:
    """The points at which a field must have a value: a run in which it has none is stuck (reading `field-outside`)."""
    for event in graph.events:
        field = field_looked_up(event.node) if event.kind == "call" and event.condition is None else None
        if field is not None:
            assert isinstance(event.node.function, RowCall)
            point = point_of(event.node.function.structure[1])
            if point is not None:
                yield Located(point, field)


def containment_facts(facts: list[Truth]) -> Iterator[Contained]:
    """The boxes that requirements place in a polygonal region: `X in R`, the workspace and `regionContainedIn` of unmutated objects."""
    for node, holds in facts:
        call = node.function
        if holds and isinstance(call, RowCall) and call.function is PolygonalRegion.contains_box and not symbols_in(call.structure[0]):
            region, position, _, width, length = call.structure
            point, shape = point_of(position), container_of(region)
            if point is not None and shape is not None:
                yield Contained(point, shape, min_radius(width, length))


def min_radius(width: object, length: object) -> float:
    """A lower bound on the distance from the centre of a box to its edges, in metres: half its smaller side."""
    return max(0.0, min(bounds_of_value(width).low, bounds_of_value(length).low) / 2)


def container_of(region: object) -> Shape | None:
    """`shape_of` for a region that boxes must lie in: with its boundary, which closes what gaps rounding leaves between its parts."""
    shape = shape_of(region)
    return None if shape is None else polygons_of(widen_shape(shape))


def shape_of(region: object) -> Shape | None:
    """A region that is a polygon and the same in all runs as a shape; None for any other."""
    while isinstance(region, Workspace):
        region = region.region
    if not isinstance(region, Region) or symbols_in(region):
        return None
    match region:
        case PolygonalRegion(polygon=polygon):
            return polygon
        case RectangularRegion(position=position, heading=heading, width=width, length=length):
            return polygons_of(box_shape(position, heading, width, length))
        case _:
            return None


def limits(facts: list[Truth]) -> dict[GraphNode, list[Interval]]:
    """Intervals, one of which holds each number that is compared with another in a requirement."""
    found: dict[GraphNode, list[Interval]] = {}
    for node, holds in facts:
        for number, interval in _comparison_bounds(node, holds):
            for inner, intervals in _inside(number, [interval]):
                found[inner] = [c for known in found.get(inner, intervals) for i in intervals if (c := known.common(i)).low <= c.high]
    return found


def _comparison_bounds(node: GraphNode, holds: bool) -> Iterator[tuple[GraphNode, Interval]]:
    """Both sides of a comparison, and where they are."""
    if node.function not in (np.less, np.less_equal, np.greater, np.greater_equal) or len(node.arguments) != 2:
        return
    left, right = node.arguments
    if (node.function in (np.less, np.less_equal)) is not holds:
        left, right = right, left
    if isinstance(left, GraphNode):
        yield left, Interval(-np.inf, _bounds(right).high)
    if isinstance(right, GraphNode):
        yield right, Interval(_bounds(left).low, np.inf)


def _bounds(operand: object) -> Interval:
    return bounds(operand) if isinstance(operand, GraphNode) else Interval(float(operand), float(operand))  # type: ignore[arg-type]


def _inside(node: GraphNode, intervals: list[Interval]) -> Iterator[tuple[GraphNode, list[Interval]]]:
    """The node, and what an absolute value says about the number in it."""
    yield node, intervals
    if node.function is np.absolute and isinstance(node.arguments[0], GraphNode):
        yield node.arguments[0], [inner for interval in intervals if interval.high >= 0 for inner in _without_sign(interval)]


def _without_sign(interval: Interval) -> tuple[Interval, ...]:
    """The numbers whose absolute value is in the interval."""
    return (Interval(-interval.high, interval.high),) if interval.low <= 0 else (interval, -interval)


def points_apart(node: GraphNode) -> tuple[Point, Point] | None:
    """The two points whose distance |V2 - V1| the node is, or None."""
    if node.function is not np.hypot:
        return None
    match node.arguments:
        case (GraphNode(function=np.subtract, arguments=(x2, x1)), GraphNode(function=np.subtract, arguments=(y2, y1))):
            return (x1, y1), (x2, y2)  # type: ignore[return-value]
        case _:
            return None


class Near(NamedTuple):
    """Two points are at most `distance` metres apart in every accepted run."""

    first: Point
    second: Point
    distance: float


def property_of(state: State, instance: Instance, name: str) -> object:
    """A property at the end, with symbols in it."""
    return unwrap(state.objects[instance.number].get(name))[0]


def position_of(state: State, instance: Instance) -> Point | None:
    """Return the final position of an object."""
    return point_of(property_of(state, instance, "position"))


def object_report_name(state: State, instance: Instance) -> str:
    """Return the name of an object in a report."""
    return state.names.get(instance.number) or f"{instance.class_.name} (object {state.scene.index(instance)})"


def is_mutated(state: State, instance: Instance) -> bool:
    """Whether noise may be added to the position."""
    scale = property_of(state, instance, "mutationScale")
    return not (isinstance(scale, (int, float)) and scale == 0)


def default_containers(state: State) -> Iterator[Contained]:
    """boundingBox(o) ⊆ workspace, and ⊆ o.regionContainedIn, for containers that are polygons."""
    for premise in default_requirements(state):
        if premise.holds in (in_workspace, in_region_of_its_own):
            (o,) = premise.objects
            region = workspace_of(state) if premise.holds is in_workspace else property_of(state, o, "regionContainedIn")
            point, shape = position_of(state, o), container_of(region)
            if point is not None and shape is not None:
                yield Contained(point, shape, min_radius(*(property_of(state, o, n) for n in ("width", "length"))))


def default_distances(state: State) -> Iterator[Near]:
    """An object that ego must see is no farther than ego sees, and half the diagonal of its own box."""
    for premise in default_requirements(state):
        if premise.holds is not visible or property_of(state, premise.objects[0], "requireVisible") is not True:
            continue
        o, ego = premise.objects
        viewer, seen = position_of(state, ego), position_of(state, o)
        if ego is not o and viewer is not None and seen is not None:
            sizes = [bounds_of_value(property_of(state, o, n)).largest / 2 for n in ("width", "length")]
            distance = bounds_of_value(property_of(state, ego, view_distance(state.settings.readings))).high + math.hypot(*sizes)
            if math.isfinite(distance):
                yield Near(viewer, seen, max(distance, 0.0))

