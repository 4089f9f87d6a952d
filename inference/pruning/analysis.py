"""Which draws of a program can be pruned, and by what: the assumptions of the algorithms, established from the program's graph.

Pruning rests on what holds in all runs that the graph describes. So it is off altogether for a program in which some runs may
take another course: one that branches on a random value, or calls a function that is not part of the language on one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from typing import NamedTuple

import numpy as np

from ...interpreter.running import DEFAULT_FUEL
from ...semantics.kernel.config import Config, State
from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.regions import PolygonalRegion, Region
from ..batch.trace.graph import Graph, GraphEvent, RowCall
from . import applicability as apply
from .facts import Located, Truth, contained, limits, located, shape_of, truths
from .recording import DrawnPoint, Recorded, record
from .report import TECHNIQUES, Finding, Pruned, Pruning, Technique
from .scene_facts import Near, default_containers, default_distances, is_mutated, name_of, position_of
from .shapes import Shape, common_part, dilate

LEAST_SAVING = 1e-6
"""A technique that saves a smaller share of the area is left out."""


def prune(start: Callable[[], Config], fuel: int = DEFAULT_FUEL, techniques: Collection[Technique] = TECHNIQUES) -> Pruning:
    """The smaller regions that points of a program may be drawn from. Raises `NotLifted` for a program without a graph."""
    return prune_recorded(record(start, fuel), techniques)


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
    """What holds in every accepted run."""

    graph: Graph
    state: State
    facts: list[Truth]
    boxes: list[apply.Contained]
    located: list[Located]
    apart: list[Near]


def knowledge_of(recorded: Recorded) -> Knowledge:
    """What the requirements of a program say."""
    graph, state, _ = recorded
    facts = list(truths(graph))
    distances = [*default_distances(state), *apply.required_distances(limits(facts))]
    return Knowledge(graph, state, facts, [*default_containers(state), *contained(facts)], list(located(graph)), distances)


# Points


def objects_at(drawn: DrawnPoint, state: State) -> str:
    """The names of the objects whose final position is the point; "" if there are none."""
    return ", ".join(name_of(state, o) for o in state.scene if position_of(state, o) == drawn.point)


def not_uniform(recorded: Recorded, techniques: Collection[Technique]) -> Iterator[Finding]:
    """A finding for each object with a position that is not a drawn point: the assumption that fails for all techniques."""
    points = {drawn.point for drawn in recorded.points.values() if shape_of(drawn.region) is not None}
    for instance in recorded.state.scene:
        position = position_of(recorded.state, instance)
        if position not in points:
            constant = position is not None and all(isinstance(c, float) for c in position)
            reason = "its position is not drawn uniformly from a fixed polygonal region"
            reason = "its position is mutated" if is_mutated(recorded.state, instance) else "its position is not random" if constant else reason
            yield from (Finding(name_of(recorded.state, instance), t, None, None, reason) for t in techniques)


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


APPLY: dict[Technique, Callable[[apply.Point, Shape, Knowledge], apply.Applied]] = {
    "containment": apply.containment,
    "orientation": apply.orientation,
    "size": apply.size,
    "reachability": apply.reachability,
    "offset": apply.offsets,
}
