"""Where the points of a program lie in its accepted runs, without pruning: what no pruning may remove."""

from __future__ import annotations

import numpy as np
from scenic_ref.inference.batch.evaluation_plan import plan
from scenic_ref.inference.batch.graph import GraphNode
from scenic_ref.inference.batch.numpy_evaluator import evaluate
from scenic_ref.inference.pruning.report import Pruning
from scenic_ref.inference.pruning.traced_points import Address, Recorded
from shapely import intersects_xy

BLOCK = 1 << 14


def accepted_points(recorded: Recorded, runs: int, seed: int = 0) -> dict[Address, np.ndarray]:
    """The drawn points of those of the first `runs` runs that are accepted, (n, 2) for each address."""
    nodes = [c for drawn in recorded.points.values() for c in drawn.point if isinstance(c, GraphNode)]
    steps = plan(recorded.graph, nodes)
    found: dict[Address, list[np.ndarray]] = {address: [] for address in recorded.points}
    for first in range(0, runs, BLOCK):
        scenes = np.arange(first, min(first + BLOCK, runs), dtype=np.uint64)
        columns = evaluate(steps, seed, scenes, np.zeros_like(scenes)).columns
        for address, drawn in recorded.points.items():
            found[address].append(np.stack([columns[c.number] if isinstance(c, GraphNode) else np.full(len(scenes), c) for c in drawn.point], axis=1))
    return {address: np.concatenate(parts) for address, parts in found.items()}


def lost(pruning: Pruning, points: dict[Address, np.ndarray]) -> int:
    """How many points of accepted runs lie outside the regions that are left."""
    return sum(
        int((~intersects_xy(p.region.polygon, *points[p.address].T)).sum()) for p in pruning.pruned if len(points[p.address])
    )
