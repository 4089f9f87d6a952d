"""Uniformly random points as deterministic maps of uniform numbers: on triangles by area, on segments by length.

The batch backend evaluates the same formulas on the arrays `triangles` and `cumulative`.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..vectors import Vector

Numbers = Callable[[], float]  # the next number of a draw's own stream, uniform in [0, 1)
Segment = tuple[Vector, Vector]


class TriangleSampler:
    """Uniform points of a polygonal shape. `triangles` is (n, 3, 2), disjoint but for edges; `cumulative` their areas added up."""

    def __init__(self, shape: BaseGeometry) -> None:
        rings = shapely.get_coordinates(shapely.constrained_delaunay_triangles(shape)).reshape(-1, 4, 2)
        self.triangles: np.ndarray = rings[:, :3]
        edges = self.triangles[:, 1:] - self.triangles[:, :1]
        areas = np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2
        self.cumulative: np.ndarray = np.cumsum(areas)
        self.area = float(self.cumulative[-1]) if len(areas) else 0.0
        self._triangles = [tuple(corners) for corners in self.triangles.reshape(-1, 6).tolist()]
        self._cumulative: list[float] = self.cumulative.tolist()

    def sample(self, uniform: Numbers) -> Vector:
        """A uniform point; of the three numbers used, one chooses the triangle by area, two the point in it."""
        chosen = min(bisect_right(self._cumulative, uniform() * self.area), len(self._cumulative) - 1)
        ax, ay, bx, by, cx, cy = self._triangles[chosen]
        root, share = math.sqrt(uniform()), uniform()
        a, b, c = 1.0 - root, root * (1.0 - share), root * share
        return Vector(a * ax + b * bx + c * cx, a * ay + b * by + c * cy)


class SegmentSampler:
    """Uniform points of a set of segments that overlap nowhere, by length; one number is used."""

    def __init__(self, segments: Sequence[Segment]) -> None:
        self.segments = tuple(segments)
        self.cumulative: list[float] = []
        total = 0.0
        for start, end in self.segments:
            total += math.hypot(end.x - start.x, end.y - start.y)
            self.cumulative.append(total)
        self.length = total

    def sample(self, uniform: Numbers) -> Vector:
        """A uniform point."""
        along = uniform() * self.length
        chosen = min(bisect_right(self.cumulative, along), len(self.segments) - 1)
        (start, end), before = self.segments[chosen], self.cumulative[chosen - 1] if chosen else 0.0
        share = min((along - before) / (self.cumulative[chosen] - before), 1.0)
        return start + (end - start) * share
