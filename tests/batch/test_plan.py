"""The order in which requirements are looked at: always the cheapest next, for what it rejects."""

from __future__ import annotations

import numpy as np
import scenic_ref
from scenic_ref.inference.batch.evaluation_plan import LEAST_REJECTED, cone, cost, plan, roots_of, segments
from scenic_ref.inference.batch.graph import Graph

TEXT = """
W = RectangularRegion((0, 0), 0, 30, 30)
workspace = Workspace(W)
x = Range(0, 1)
ego = Object in W, facing x
require ego.position.x > x or x > 0.5
for i in range(6):
    Object in W, facing Range(0, 360) deg, with width x
require x < 0.9
"""


def one_by_one(graph: Graph, rejects: dict[int, float]) -> list[tuple[list[int], int]]:
    """The numbers of the nodes that are computed for each event, and that of what decides it, where every price is asked for anew."""
    done: set[int] = set()
    order: list[tuple[list[int], int]] = []
    for segment in segments(graph.events, range(len(graph.events))):
        pending = list(segment)
        while pending:
            chosen = min(pending, key=lambda k: cost(cone(roots_of(graph.events[k]), done)) / max(rejects.get(k, 0.5), LEAST_REJECTED))
            pending.remove(chosen)
            nodes = cone(roots_of(graph.events[chosen]), done)
            done.update(node.number for node in nodes)
            order.append(([node.number for node in nodes], graph.events[chosen].node.number))
    return order


def test_prices_that_are_kept_are_those_that_would_be_asked_for() -> None:
    batch = scenic_ref.loads(TEXT).batch
    assert batch is not None
    graph, random = batch.graph, np.random.default_rng(5)
    orders = set()
    for _ in range(5):
        rejects = {k: float(random.uniform(0, 0.2)) for k in range(len(graph.events)) if random.random() < 0.8}
        found = [([node.number for node in step.nodes], step.event.node.number) for step in plan(graph, [], rejects) if step.event is not None]
        assert found == one_by_one(graph, rejects)
        orders.add(tuple(number for _, number in found))
    assert len(orders) > 1
