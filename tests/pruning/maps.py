"""Random maps and configurations: what the algorithms of pruning are held against."""

from __future__ import annotations

import math

import numpy as np
from scenic_ref.inference.pruning.algorithms import Cell
from shapely import affinity
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry


def random_polygon(rng: np.random.Generator, corners: int = 9, size: float = 20.0) -> Polygon:
    """A star-shaped polygon about the origin, seldom convex."""
    angles = np.sort(rng.uniform(0, 2 * math.pi, corners))
    angles = angles + np.linspace(0, 0.3, corners)
    radii = rng.uniform(0.3, 1.0, corners) * size
    return Polygon(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)).buffer(0)


def random_cells(rng: np.random.Generator, count: int = 7, extent: float = 30.0) -> list[Cell]:
    """Polygons with headings, some of them overlapping, thin and thick."""
    cells: list[Cell] = []
    for _ in range(count):
        box = Polygon([(-1, -1), (1, -1), (1, 1), (-1, 1)]) if rng.random() < 0.7 else random_polygon(rng, 7, 1.5)
        shape = affinity.scale(box, rng.uniform(1, 6), rng.uniform(3, 12), origin=(0, 0))
        heading = float(rng.uniform(-math.pi, math.pi))
        turned = affinity.rotate(shape, heading, origin=(0, 0), use_radians=True)
        cells.append((affinity.translate(turned, *rng.uniform(-extent, extent, 2)), heading))
    return [(shape, heading) for shape, heading in cells if isinstance(shape, Polygon)]


def random_points(rng: np.random.Generator, shape: BaseGeometry, n: int) -> np.ndarray:
    """Uniform points of a shape, (at most n, 2), by rejection from its bounds."""
    import shapely

    west, south, east, north = shape.bounds
    points = rng.uniform((west, south), (east, north), (4 * n, 2))
    return points[shapely.contains_xy(shape, points[:, 0], points[:, 1])][:n]


def turned(vectors: np.ndarray, headings: np.ndarray) -> np.ndarray:
    """rotate(v, h) of each vector, (n, 2)."""
    c, s = np.cos(headings), np.sin(headings)
    return np.stack([vectors[:, 0] * c - vectors[:, 1] * s, vectors[:, 0] * s + vectors[:, 1] * c], axis=1)
