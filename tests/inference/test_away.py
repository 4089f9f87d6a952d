"""How far points are outside of a polygon: what one edge after the other would say, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
from scenic_ref.inference.batch.primitives.point_in_polygon import tests_of as polygon_tests
from scenic_ref.inference.batch.violations import PAIRS, points_away
from scenic_ref.roads import made_map


def edge_by_edge(edges: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A plain version."""
    least, inside = np.full(len(x), np.inf), np.zeros(len(x), dtype=bool)
    for ax, ay, bx, by in edges.tolist():
        dx, dy = bx - ax, by - ay
        squared = dx * dx + dy * dy
        share = np.clip(((x - ax) * dx + (y - ay) * dy) / squared, 0.0, 1.0) if squared else 0.0
        least = np.minimum(least, (ax + share * dx - x) ** 2 + (ay + share * dy - y) ** 2)
        if dy:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / dy * dx)
    return np.where(inside, 0.0, np.sqrt(least))


@pytest.mark.parametrize("kind", ["roundabout", "suburb"])
def test_all_edges_at_once_are_one_after_the_other(kind: str) -> None:
    edges = polygon_tests(made_map(kind).drivableRegion).edges
    edges = np.concatenate([edges, edges[:2, [0, 1, 0, 1]]])  # and edges that are points
    random = np.random.default_rng(1)
    low, high = edges.reshape(-1, 2).min(axis=0) - 20, edges.reshape(-1, 2).max(axis=0) + 20
    some = random.integers(0, len(edges), 100)
    on = (edges[some, :2] + edges[some, 2:]) / 2
    points = np.concatenate([
        random.uniform(low, high, (200, 2)), on, edges[some, :2], on + random.normal(0, 1e-9, on.shape), [[np.nan, 1], [3, np.inf]],
    ])  # fmt: skip
    x, y = points.T
    with np.errstate(invalid="ignore"):
        found, wanted = points_away(edges, x, y), edge_by_edge(edges, x, y)
    assert len(points) * len(edges) > 2 * PAIRS  # in several parts
    assert np.array_equal(found, wanted, equal_nan=True)
    assert 0 < np.count_nonzero(found == 0) < len(found)
    assert len(points_away(edges, x[:0], y[:0])) == 0
