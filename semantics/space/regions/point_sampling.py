"""Uniformly random points as deterministic maps of uniform numbers: on triangles by area, on segments by length.

The batch backend evaluates the same formulas on the arrays `triangles` and `cumulative`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from itertools import accumulate

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..numeric_functions import pick, search, smaller, square_root
from ..vectors import Vector

Numbers = Callable[[], float]  # the next number of a draw's own stream, uniform in [0, 1)
Segment = tuple[Vector, Vector]


class PieceSampler(ABC):
    """Uniform points of `pieces` that overlap nowhere. `ends` are the measures of all but the last, added up; `total` is the measure of all."""

    pieces: Sequence[tuple[float, ...]]
    ends: list[float]
    total: float

    def sample(self, uniform: Numbers) -> Vector:
        """A uniform point: the first number chooses the piece."""
        along = uniform() * self.total
        return self.point(pick(self.pieces, search(self.ends, along)), along, uniform)

    @staticmethod
    @abstractmethod
    def point(piece: Iterable[float], along: float, uniform: Numbers) -> Vector:
        """A uniform point of a piece; `along` is what chose it."""


class TriangleSampler(PieceSampler):
    """Uniform points of a polygonal shape. `triangles` is (n, 3, 2), disjoint but for edges; `cumulative` their areas added up."""

    def __init__(self, shape: BaseGeometry) -> None:
        rings = shapely.get_coordinates(shapely.constrained_delaunay_triangles(shape)).reshape(-1, 4, 2)
        self.triangles: np.ndarray = rings[:, :3]
        edges = self.triangles[:, 1:] - self.triangles[:, :1]
        areas = np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) / 2
        self.cumulative: np.ndarray = np.cumsum(areas)
        self.total = float(self.cumulative[-1]) if len(areas) else 0.0
        self.pieces = [tuple(corners) for corners in self.triangles.reshape(-1, 6).tolist()]
        self.ends = self.cumulative[:-1].tolist()

    @staticmethod
    def point(piece: Iterable[float], along: float, uniform: Numbers) -> Vector:
        """A uniform point of a triangle, by two more numbers."""
        ax, ay, bx, by, cx, cy = piece
        root, share = square_root(uniform()), uniform()
        a, b, c = 1.0 - root, root * (1.0 - share), root * share
        return Vector(a * ax + b * bx + c * cx, a * ay + b * by + c * cy)


class SegmentSampler(PieceSampler):
    """Uniform points of a set of segments that overlap nowhere, by length; one number is used."""

    def __init__(self, segments: Sequence[Segment]) -> None:
        self.segments = tuple(segments)
        lengths = np.hypot([end.x - start.x for start, end in self.segments], [end.y - start.y for start, end in self.segments]).tolist()
        self.cumulative: list[float] = list(accumulate(lengths))
        self.total = self.cumulative[-1] if self.cumulative else 0.0
        self.ends = self.cumulative[:-1]
        before = (0.0, *self.cumulative)
        self.pieces = [
            (start.x, start.y, end.x - start.x, end.y - start.y, low, high - low)
            for (start, end), low, high in zip(self.segments, before, self.cumulative, strict=False)
        ]

    @staticmethod
    def point(piece: Iterable[float], along: float, uniform: Numbers) -> Vector:
        """The point of a segment that is so far along all of them."""
        x, y, dx, dy, before, length = piece
        share = smaller((along - before) / length, 1.0)
        return Vector(x + dx * share, y + dy * share)
