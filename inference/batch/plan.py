"""In which order a graph is evaluated: events as in the program, each after what it needs, and what may be forgotten when.

Requirements that follow each other without a guard between them may be checked in any order, since a run that fails any of them is
rejected; a guard must be looked at after the requirements before it and before those after it. What a requirement needs is computed
when it is checked, so that few rows are left for the costly ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .graph import Event, Graph, Node, children

ROW_COST = 300
"""What a node that is computed row by row costs, where an operation on columns costs 1."""


@dataclass(frozen=True, slots=True)
class Step:
    """Compute `nodes` in order, then look at `event` (None: these are the results); then `forget` is no longer needed."""

    nodes: tuple[Node, ...]
    event: Event | None
    forget: tuple[Node, ...]


def plan(graph: Graph, outputs: Sequence[Node]) -> tuple[Step, ...]:
    """The steps of an evaluation."""
    done: set[int] = set()
    order: list[tuple[list[Node], Event | None]] = []
    for segment in segments(graph.events):
        pending = list(segment)
        while pending:
            costs = [cost(cone(_roots(event), done)) for event in pending]
            event = pending.pop(costs.index(min(costs)))
            order.append((cone(_roots(event), done), event))
            done.update(node.number for node in order[-1][0])
    order.append((cone(list(outputs), done), None))
    last: dict[int, int] = {}
    for position, (nodes, event) in enumerate(order):
        for node in nodes:
            for child in (node, *children(node)):
                last[child.number] = position
        for root in _roots(event) if event is not None else outputs:
            last[root.number] = position
    for node in outputs:
        last[node.number] = len(order)
    forgotten: dict[int, list[Node]] = {}
    for number, position in last.items():
        forgotten.setdefault(position, []).append(graph.nodes[number])
    return tuple(Step(tuple(nodes), event, tuple(forgotten.get(i, ()))) for i, (nodes, event) in enumerate(order))


def segments(events: Sequence[Event]) -> list[list[Event]]:
    """Runs of requirements that may be checked in any order; a guard or call is alone."""
    result: list[list[Event]] = []
    for event in events:
        if event.kind == "require" and result and result[-1][0].kind == "require":
            result[-1].append(event)
        else:
            result.append([event])
    return result


def _roots(event: Event) -> list[Node]:
    return [event.node] if event.condition is None else [event.condition, event.node]


def cone(roots: list[Node], done: set[int]) -> list[Node]:
    """What must be computed for the roots, in order."""
    found: dict[int, Node] = {}
    waiting = list(roots)
    while waiting:
        node = waiting.pop()
        if node.number not in done and node.number not in found:
            found[node.number] = node
            waiting.extend(children(node))
    return [found[number] for number in sorted(found)]


def cost(nodes: Sequence[Node]) -> float:
    """A guess at the cost of computing the nodes."""
    from .columns import has_columns
    from .graph import RowCall, RowDraw

    return sum(
        ROW_COST if isinstance(n.function, RowDraw) or (isinstance(n.function, RowCall) and not has_columns(n.function)) else
        20 if isinstance(n.function, RowCall) else 1
        for n in nodes
    )
