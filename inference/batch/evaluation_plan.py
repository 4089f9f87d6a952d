"""In which order a graph is evaluated: events as in the program, each after what it needs, and what may be forgotten when.

Requirements that follow each other without a guard between them may be checked in any order, since a run that fails any of them is
rejected; a guard must be looked at after the requirements before it and before those after it. What a requirement needs is computed
when it is checked. The next one is that which is cheapest for what it rejects, so that few rows are left for the costly ones.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from .graph import Crowd, Graph, GraphEvent, GraphNode, Macro, RowCall, RowDraw, Site
from .row_calls import always_gives_a_value
from .symbolic import children

SITE_COST, POLYGON_COST, MACRO_COST, ROW_COST = 4.0, 30.0, 40.0, 1000.0
"""What nodes cost, where an operation on numbers costs 1: draws, tests on polygons, tests of two boxes or a sector, calls row by row."""


LEAST_REJECTED = 0.002
"""What rejects no more runs than this comes late, the cheapest first."""


@dataclass(frozen=True, slots=True)
class PlanStep:
    """Compute `nodes` in order, then look at `event` (None: these are the results); then `forget` is no longer needed."""

    nodes: tuple[GraphNode, ...]
    event: GraphEvent | None
    forget: tuple[GraphNode, ...]


def plan(
    graph: Graph, outputs: Sequence[GraphNode], rejects: Mapping[int, float] = MappingProxyType({}), events: Sequence[int] | None = None,
    known: Collection[int] = (),
) -> tuple[PlanStep, ...]:  # fmt: skip
    """The steps of an evaluation, of all events or of those at some places of the graph, where the nodes `known` need not be computed.

    `rejects` says how often an event rejects a run, by its place in the graph; half of the time if not known.
    """
    done = set(known)
    order: list[tuple[list[GraphNode], GraphEvent | None]] = []
    for segment in segments(graph.events, range(len(graph.events)) if events is None else sorted(events)):
        order.extend(cheapest_first(graph, segment, done, rejects))
    order.append((cone(list(outputs), done), None))
    last: dict[int, int] = {}
    for position, (nodes, event) in enumerate(order):
        for node in nodes:
            for child in (node, *children(node)):
                last[child.number] = position
        for root in roots_of(event) if event is not None else outputs:
            last[root.number] = position
    for node in outputs:
        last[node.number] = len(order)
    forgotten: dict[int, list[GraphNode]] = {}
    for number, position in last.items():
        forgotten.setdefault(position, []).append(graph.nodes[number])
    return tuple(PlanStep(tuple(nodes), event, tuple(forgotten.get(i, ()))) for i, (nodes, event) in enumerate(order))


def cheapest_first(
    graph: Graph, segment: Sequence[int], done: set[int], rejects: Mapping[int, float]
) -> Iterator[tuple[list[GraphNode], GraphEvent]]:
    """The events at some places, each with what is still to be computed for it, which is `done` then; the next one is the cheapest."""
    cones = {place: cone(roots_of(graph.events[place]), done) for place in segment}
    costs = {place: cost(nodes) for place, nodes in cones.items()}
    needing: dict[int, list[int]] = {}
    for place, nodes in cones.items():
        for node in nodes:
            needing.setdefault(node.number, []).append(place)
    pending = list(segment)
    while pending:
        prices = [costs[place] / max(rejects.get(place, 0.5), LEAST_REJECTED) for place in pending]
        chosen = pending.pop(prices.index(min(prices)))
        nodes = [node for node in cones[chosen] if node.number not in done]
        for node in nodes:
            done.add(node.number)
            for place in needing[node.number]:
                costs[place] -= cost_of(node)
        yield nodes, graph.events[chosen]


def segments(events: Sequence[GraphEvent], places: Iterable[int]) -> list[list[int]]:
    """Runs of events, by their places, that may be looked at in any order: those that only reject. Any other event is alone."""
    result: list[list[int]] = []
    for place in places:
        if only_rejects(events[place]) and result and only_rejects(events[result[-1][0]]):
            result[-1].append(place)
        else:
            result.append([place])
    return result


def only_rejects(event: GraphEvent) -> bool:
    """Whether the runs that an event ends are rejected; those that a guard or a function of Python ends take another course."""
    return event.kind == "require" or (event.kind == "call" and always_gives_a_value(event.node.function))


def roots_of(event: GraphEvent) -> list[GraphNode]:
    """The nodes that decide about an event."""
    return [event.node] if event.condition is None else [event.condition, event.node]


def cone(roots: list[GraphNode], done: set[int]) -> list[GraphNode]:
    """Return the nodes that must be computed for the roots, in order."""
    found: dict[int, GraphNode] = {}
    waiting = list(roots)
    while waiting:
        node = waiting.pop()
        if node.number not in done and node.number not in found:
            found[node.number] = node
            waiting.extend(children(node))
    return [found[number] for number in sorted(found)]


def cost(nodes: Sequence[GraphNode]) -> float:
    """A guess at the cost of computing the nodes; an operation on numbers costs 1."""
    return sum(map(cost_of, nodes))


def cost_of(node: GraphNode) -> float:
    """A guess at the cost of computing a node."""
    match node.function:
        case RowDraw() | RowCall() as function:
            return POLYGON_COST if always_gives_a_value(function) else ROW_COST
        case Macro():
            return MACRO_COST
        case Crowd():
            return len(node.arguments) * MACRO_COST
        case Site():
            return SITE_COST
        case _:
            return 1.0
