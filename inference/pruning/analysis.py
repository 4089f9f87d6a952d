"""Each technique applied to one drawn point: the assumptions of `algorithms`, looked for among what is known of a program.

Each function gives the set to which the point may be restricted, or None, and the reason: what was found, or which assumption fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import NamedTuple, Protocol

import numpy as np

from ...interpreter.runtime.program_run import DEFAULT_FUEL
from ...semantics.machine.config import Config, State
from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.regions import PolygonalRegion, Region
from ..batch.graph import Graph, GraphEvent, GraphNode, RowCall
from .accepted_facts import (
    Contained,
    Located,
    Near,
    Truth,
    containment_facts,
    default_containers,
    default_distances,
    field_lookup_points,
    is_mutated,
    limits,
    object_report_name,
    points_apart,
    position_of,
    shape_of,
    truths,
)
from .algorithms import Cell, Shape, common_part, dilate, erode, prune_by_containment, prune_by_heading, prune_by_offset, prune_by_width, union_of
from .node_bounds import (
    ZERO,
    Aligned,
    Interval,
    Offset,
    Operand,
    Point,
    bounds_of_terms,
    field_alignment,
    field_looked_up,
    offset,
    terms,
)
from .report import TECHNIQUES, Finding, Pruned, Pruning, Technique
from .traced_points import DrawnPoint, Recorded, record_points

SHARP = 2.0
"""Metres: points whose places are known less well than this are of no use to `offset`."""


class Known(Protocol):
    """The facts of every accepted run, as an interface."""

    @property
    def graph(self) -> Graph: ...
    @property
    def facts(self) -> list[Truth]: ...
    @property
    def boxes(self) -> list[Contained]: ...
    @property
    def located(self) -> list[Located]: ...
    @property
    def apart(self) -> list[Near]: ...


Applied = tuple[Shape | None, str]


# Containment


def containment(point: Point, shape: Shape, known: Known) -> Applied:
    """Pruning based on containment: the point is the centre of a box that must lie in a polygon."""
    found = {(id(box.container), box.min_radius): box for box in known.boxes if box.point == point}
    if not found:
        return None, "no unmutated box with its centre there must lie in a polygonal container"
    for box in found.values():
        shape = prune_by_containment(shape, box.container, box.min_radius)
    return shape, f"minRadius {max(box.min_radius for box in found.values()):.3g} m"


# Orientation


def orientation(point: Point, shape: Shape, known: Known) -> Applied:
    """Pruning based on orientation: a requirement bounds the heading of another object, aligned to the same field, relative to that of this one."""
    reasons: list[str] = []
    kept: Shape | None = None
    for x, y, allowed in relative_headings(point, known):
        if y.field is not x.field:
            reasons.append("the two are aligned to different fields")
            continue
        distance = distance_between(x, y, known)
        if not math.isfinite(distance):
            reasons.append("nothing bounds the distance of the two")
            continue
        deviation = (x.deviation.largest + y.deviation.largest) / 2
        now = prune_by_heading(cells_of(x.field), allowed, distance, deviation, turn=math.inf)
        kept = now if kept is None else common_part(kept, now)
        reasons.append(f"M {distance:.3g} m, δ {deviation:.3g}, A {' or '.join(f'[{a.low:.3g}, {a.high:.3g}]' for a in allowed)}")
    if not reasons:
        only_soft = any(relative_headings(point, known, list(truths(known.graph, soft=True))))
        kind = "hard requirement" if only_soft else "requirement"
        return None, f"no {kind} bounds its heading relative to that of another object that is aligned to a polygonal field"
    return kept, "; ".join(dict.fromkeys(reasons))


def relative_headings(point: Point, known: Known, facts: list[Truth] | None = None) -> Iterator[tuple[Aligned, Aligned, list[Interval]]]:
    """X aligned at the point, Y aligned elsewhere, and the intervals, one of which holds Y's heading minus X's in every scene (as a plain number)."""
    for node, intervals in limits(known.facts if facts is None else facts).items():
        found = difference_of_headings(node)
        if found is None or found[0].point == found[1].point:
            continue
        first, second, less = found
        differences = [i + Interval(-less, -less) for i in intervals]
        if second.point == point:
            yield second, first, differences
        if first.point == point:
            yield first, second, [-i for i in differences]


def difference_of_headings(node: GraphNode) -> tuple[Aligned, Aligned, float] | None:
    """A number as the first heading minus the second plus a constant: two that are aligned to fields, if it is that."""
    if node.function is np.subtract and all(isinstance(a, (GraphNode, float)) for a in node.arguments):
        first, second = (field_alignment(a) for a in node.arguments)  # type: ignore[arg-type]
        if first is not None and second is not None:
            return first, second, 0.0
    sum_ = terms(node)
    less = sum_.pop(1.0, 0.0)
    plus, minus = ([p for p, s in sum_.items() if isinstance(p, GraphNode) and s == sign and field_looked_up(p) is not None] for sign in (1.0, -1.0))
    if len(plus) != 1 or len(minus) != 1:
        return None
    first, second = field_alignment(plus[0]), field_alignment(minus[0])
    deviation = bounds_of_terms({part: share for part, share in sum_.items() if part not in (plus[0], minus[0])})
    if first is None or second is None or not deviation.bounded:
        return None
    return first._replace(deviation=deviation), second, less


def distance_between(x: Aligned, y: Aligned, known: Known) -> float:
    """An upper bound on the distance of the points of two headings, in metres; infinite if none is known."""
    known_bounds = [a.distance for a in known.apart if {a.first, a.second} == {x.point, y.point}]
    offsets = [offset(x.point, h, y.point) for h in (*headings_at(x.point, known), None)]
    return min([*known_bounds, *(o.distance for o in offsets if o is not None)], default=math.inf)


def required_distances(known_limits: Mapping[GraphNode, list[Interval]]) -> Iterator[Near]:
    """The distances that requirements bound."""
    for node, intervals in known_limits.items():
        points = points_apart(node)
        high = max((i.high for i in intervals), default=math.inf)
        if points is not None and math.isfinite(high):
            yield Near(*points, max(high, 0.0))


def headings_at(point: Point, known: Known) -> list[Operand]:
    """The angles by which the program turns something, that are headings along a field which has a value at the point in every accepted run.

    A field that is only looked up under a coin need not have one, and then the point may lie outside its polygons.
    """
    fields = {id(there.field) for there in known.located if there.point == point}
    angles = {node.arguments[0]: None for node in known.graph.nodes if node.function in (np.sin, np.cos)}
    headings = [angle for angle in angles if isinstance(angle, GraphNode)]
    return [angle for angle in headings if (found := field_alignment(angle)) is not None and found.point == point and id(found.field) in fields]


def cells_of(field: PolygonalVectorField) -> tuple[Cell, ...]:
    """The polygons of a field, as closed sets, and their headings."""
    return tuple((polygon, float(heading)) for polygon, (_, heading) in zip(field.closed, field.cells, strict=True))  # type: ignore[arg-type]


# Size


def size(point: Point, shape: Shape, known: Known) -> Applied:
    """Pruning based on size: other points, in the same map, lie at known distances across the point's heading."""
    widest: tuple[float, float] = (0.0, 0.0)
    field: PolygonalVectorField | None = None
    for heading in headings_at(point, known):
        x = field_alignment(heading)
        assert x is not None
        points = {there.point for there in known.located if there.field is x.field and there.point != point}
        seen = [Offset(ZERO, ZERO, 0.0), *(o for q in points if (o := offset(point, heading, q)) is not None)]
        width, distance = max(((across(a, b, x.deviation), max(a.distance, b.distance)) for a in seen for b in seen), default=widest)
        if width > widest[0]:
            widest, field = (width, distance), x.field
    if field is None:
        return None, "no two points of its configuration are known to be apart across its heading"
    width, distance = widest
    return prune_by_width(cells_of(field), distance, width), f"minWidth {width:.3g} m, M {distance:.3g} m"


def across(a: Offset, b: Offset, deviation: Interval) -> float:
    """A lower bound on how far apart two points are across the heading of the polygon, metres; the object's own may deviate from it."""
    apart = (a.across + -b.across).smallest
    ahead = (a.along + -b.along).largest
    turned = min(deviation.largest, math.pi / 2)
    return max(0.0, apart * math.cos(turned) - ahead * math.sin(turned) - a.slack - b.slack)


# Reachability


def reachability(point: Point, shape: Shape, known: Known) -> Applied:
    """Pruning based on reachability: off, since it concerns what happens after the initial scene."""
    return None, "no requirement says that it must reach a region in a given time"


# Offset


def offsets(point: Point, shape: Shape, known: Known) -> Applied:
    """NON-SPEC: points at known offsets from the point must lie in containers, or where a field has a value."""
    done: dict[object, str] = {}
    kept: Shape | None = None
    for heading in headings_at(point, known):
        x = field_alignment(heading)
        assert x is not None
        for key, target, seen in targets(point, x, heading, known):
            if key in done:
                continue
            done[key] = f"[{seen.across.low:.3g}, {seen.across.high:.3g}] m across, [{seen.along.low:.3g}, {seen.along.high:.3g}] m ahead"
            now = prune_by_offset(cells_of(x.field), target, seen.across, seen.along, x.deviation.largest, seen.slack)
            kept = now if kept is None else common_part(kept, now)
    return kept, "; ".join(dict.fromkeys(done.values())) or "no other point is known to lie at a certain offset, and within a polygon"


def targets(point: Point, x: Aligned, heading: Operand, known: Known) -> Iterator[tuple[object, Shape, Offset]]:
    """The polygons in which points at sharp offsets must lie, each with a key for what was met before."""
    for box in known.boxes:
        seen = sharp(point, x, heading, box.point)
        if seen is not None:
            yield (seen, id(box.container), box.min_radius), erode(box.container, box.min_radius), seen
    for there in known.located:
        seen = sharp(point, x, heading, there.point)
        if seen is not None:
            yield (seen, id(there.field)), union_of([polygon for polygon, _ in cells_of(there.field)]), seen


def sharp(point: Point, x: Aligned, heading: Operand, other: Point) -> Offset | None:
    """Another point seen from the point, if its place relative to the polygon's heading is known well."""
    seen = offset(point, heading, other) if other != point else None
    return seen if seen is not None and seen.slack + x.deviation.largest * seen.distance <= SHARP else None


LEAST_SAVING = 1e-6
"""A technique that saves a smaller share of the area is left out."""


def prune(start: Callable[[], Config], fuel: int = DEFAULT_FUEL, techniques: Collection[Technique] = TECHNIQUES) -> Pruning:
    """The smaller regions that points of a program may be drawn from. Raises `NotLifted` for a program without a graph."""
    return prune_recorded(record_points(start, fuel), techniques)


def prune_recorded(recorded: Recorded, techniques: Collection[Technique] = TECHNIQUES) -> Pruning:
    """`prune` for a program that was traced already."""
    obstacle = obstacle_of(recorded.graph)
    if obstacle is not None:
        return Pruning((), tuple(Finding("all objects", t, None, None, obstacle) for t in techniques))
    known = knowledge_of(recorded)
    pruned: list[Pruned] = []
    findings = list(not_uniform(recorded, techniques))
    for drawn in recorded.points.values():
        one, found = prune_point(drawn, known, recorded.state, techniques)
        findings += found
        if one is not None:
            pruned.append(one)
    return Pruning(tuple(pruned), tuple(findings))


def obstacle_of(graph: Graph) -> str | None:
    """Why nothing may be pruned: some runs may take another course than the one that was traced."""
    for event in graph.events:
        if event.kind == "guard" and not is_finiteness(event):
            return "the program branches on a random value"
        if event.kind == "call" and isinstance(event.node.function, RowCall) and not is_of_the_language(event.node.function):
            return f"the program calls {event.node.function.text} with random values"
    return None


def is_finiteness(event: GraphEvent) -> bool:
    """Whether a guard says that a number is finite, as it is unless the program is wrong."""
    node = event.node
    return event.expected and node.function is np.less and node.arguments[1] == np.inf


def is_of_the_language(call: RowCall) -> bool:
    """Whether a call is a test or look-up of the language itself, which gives a value or a stuck run, and nothing of the user's."""
    if call.function is PolygonalVectorField._value_at:  # pyright: ignore[reportPrivateUsage]
        field = call.structure[0]
        return isinstance(field, PolygonalVectorField) and all(isinstance(heading, (int, float)) for _, heading in field.cells)
    return hasattr(call.function, "__wrapped__") and call.function.__module__.startswith(LANGUAGE)


LANGUAGE = Region.__module__.rsplit(".", 2)[0] + ".regions"


# Knowledge


class Knowledge(NamedTuple):
    """The facts of every accepted run."""

    graph: Graph
    state: State
    facts: list[Truth]
    boxes: list[Contained]
    located: list[Located]
    apart: list[Near]


def knowledge_of(recorded: Recorded) -> Knowledge:
    """Return the facts that the requirements of a program state."""
    graph, state, _ = recorded
    facts = list(truths(graph))
    distances = [*default_distances(state), *required_distances(limits(facts))]
    return Knowledge(graph, state, facts, [*default_containers(state), *containment_facts(facts)], list(field_lookup_points(graph)), distances)


# Points


def objects_at(drawn: DrawnPoint, state: State) -> str:
    """The names of the objects whose final position is the point; "" if there are none."""
    return ", ".join(object_report_name(state, o) for o in state.scene if position_of(state, o) == drawn.point)


def not_uniform(recorded: Recorded, techniques: Collection[Technique]) -> Iterator[Finding]:
    """A finding for each object with a position that is not a drawn point: the assumption that fails for all techniques."""
    points = {drawn.point for drawn in recorded.points.values() if shape_of(drawn.region) is not None}
    for instance in recorded.state.scene:
        position = position_of(recorded.state, instance)
        if position not in points:
            constant = position is not None and all(isinstance(c, float) for c in position)
            reason = "its position is not drawn uniformly from a fixed polygonal region"
            reason = "its position is mutated" if is_mutated(recorded.state, instance) else "its position is not random" if constant else reason
            yield from (Finding(object_report_name(recorded.state, instance), t, None, None, reason) for t in techniques)


def prune_point(
    drawn: DrawnPoint, known: Knowledge, state: State, techniques: Collection[Technique]
) -> tuple[Pruned | None, list[Finding]]:  # fmt: skip
    """The smaller region for one draw, and what each technique did."""
    before = shape_of(drawn.region)
    if before is None:
        return None, []
    name, shape, used = objects_at(drawn, state), before, []
    shown = name or f"the point drawn at {drawn.address}"
    findings: list[Finding] = []
    for technique in TECHNIQUES:
        if technique not in techniques:
            continue
        kept, reason = APPLY[technique](drawn.point, shape, known)
        smaller = None if kept is None else common_part(shape, dilate(kept, 0.0))
        if smaller is None or smaller.area > (1 - LEAST_SAVING) * shape.area or smaller.is_empty:
            why = reason if smaller is None else "nothing would be left: is a scene possible?" if smaller.is_empty else f"nothing to remove: {reason}"
            findings.append(Finding(shown, technique, shape.area, None, why))
            continue
        findings.append(Finding(shown, technique, shape.area, smaller.area, reason))
        shape = smaller
        used.append(technique)
    if not used:
        return None, findings if name else []
    region = PolygonalRegion(polygon=shape, orientation=drawn.region.orientation)
    return Pruned(drawn.address, drawn.region, region, before.area, shape.area, tuple(used)), findings


APPLY: dict[Technique, Callable[[Point, Shape, Knowledge], Applied]] = {
    "containment": containment,
    "orientation": orientation,
    "size": size,
    "reachability": reachability,
    "offset": offsets,
}

