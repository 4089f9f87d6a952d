"""Tests of many points and boxes against polygons at a time, by grids of squares that hold the edges or polygons near them.

They agree with shapely, which the interpreter asks: what lies within `TIE` metres of an edge is left to shapely itself, whose shapes
are prepared there and here, since what it says of ties may depend on that.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ....semantics.space.fields import PolygonalVectorField
from ....semantics.space.regions import PolygonalRegion

TIE = 1e-9
"""Metres (and a share of the coordinates): nearer to an edge than this, rounding might decide."""
MOST_SQUARES = 1 << 18
FINE = 8.0
"""The squares of a grid are so much smaller than what it holds, so that most hold no edge."""
OUTSIDE, INSIDE, UNSURE = 0, 1, 2
"""Where a point, a box or a square is."""


class Grid:
    """Squares of one size over the bounds of some shapes, and for each square the numbers of the shapes within `reach` of it."""

    def __init__(self, shapes: np.ndarray, side: float, reach: float) -> None:
        west, south, east, north = shapely.total_bounds(shapes)
        self.reach = reach
        width, height = east - west + 2 * reach, north - south + 2 * reach
        self.side = max(side, math.sqrt(width * height / MOST_SQUARES), 1e-6)
        self.west, self.south = west - reach, south - reach
        self.columns, self.rows = int(width / self.side) + 1, int(height / self.side) + 1
        xs, ys = self.west + self.side * np.arange(self.columns), self.south + self.side * np.arange(self.rows)
        x, y = (a.ravel() for a in np.meshgrid(xs, ys))
        margin = reach + TIE * (1 + max(map(abs, (west, south, east, north))))
        squares = shapely.box(x - margin, y - margin, x + self.side + margin, y + self.side + margin)
        pairs = shapely.STRtree(shapes).query(squares, predicate="intersects")
        order = np.lexsort((pairs[1], pairs[0]))
        square, shape = pairs[0][order], pairs[1][order]
        counts = np.bincount(square, minlength=len(squares))
        self.most = int(counts.max()) if len(counts) else 0
        starts = np.concatenate([[0], np.cumsum(counts)])
        self.lists = np.full((len(squares) + 1, self.most), -1, dtype=np.int64)
        self.lists[square, np.arange(len(square)) - starts[square]] = shape
        self.counts = np.concatenate([counts, [0]])

    @property
    def centres(self) -> tuple[np.ndarray, np.ndarray]:
        """A point inside each square but the last."""
        column, row = np.tile(np.arange(self.columns), self.rows), np.repeat(np.arange(self.rows), self.columns)
        return self.west + (column + 0.4817294) * self.side, self.south + (row + 0.5290163) * self.side

    def square_of(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """The number of the square in which a point lies; the last number for points beyond all squares."""
        with np.errstate(invalid="ignore"):
            column, row = np.floor((x - self.west) / self.side), np.floor((y - self.south) / self.side)
            inside = (column >= 0) & (column < self.columns) & (row >= 0) & (row < self.rows)
        return np.where(inside, np.where(inside, row, 0) * self.columns + np.where(inside, column, 0), len(self.lists) - 1).astype(np.int64)


def edges_of(shape: BaseGeometry) -> np.ndarray:
    """The edges of all rings of a polygon or multipolygon, (n, 4) as x and y of both ends."""
    rings = shapely.get_rings(shapely.get_parts(shape))
    coordinates, ring = shapely.get_coordinates(rings, return_index=True)
    same = ring[1:] == ring[:-1]
    return np.concatenate([coordinates[:-1], coordinates[1:]], axis=1)[same]


class PolygonTests:
    """Points and boxes in one polygon or multipolygon."""

    def __init__(self, shape: BaseGeometry) -> None:
        shapely.prepare(shape)
        self.shape = shape
        self.edges = edges_of(shape)
        self.lines: np.ndarray = shapely.linestrings(self.edges.reshape(-1, 2, 2))  # type: ignore[assignment]
        west, south, east, north = shape.bounds
        self.scale = 1 + max(map(abs, shape.bounds))
        self.size = max(east - west, north - south, 1e-9)
        self.grid = Grid(self.lines, self.size / max(4.0, math.sqrt(len(self.edges)) * FINE), 0.0)
        self.reference = np.append(np.stack(self.grid.centres, axis=1), [[0.0, 0.0]], axis=0)
        self.reference_inside = np.append(shapely.intersects_xy(shape, *self.grid.centres), False)
        self.near: dict[int, tuple[Grid, np.ndarray]] = {}

    def contains_point(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Whether each point is in the closed polygon: how often the way from a known point of its square crosses an edge."""
        square = self.grid.square_of(x, y)
        inside = self.reference_inside[square].copy()
        tie = np.zeros(len(x), dtype=bool)
        rows = np.flatnonzero(self.grid.counts[square])
        eps = TIE * self.scale
        for k in range(self.grid.most):
            rows = rows[self.grid.counts[square[rows]] > k]
            if not len(rows):
                break
            ax, ay, bx, by = self.edges[self.grid.lists[square[rows], k]].T
            rx, ry = self.reference[square[rows]].T
            px, py = x[rows], y[rows]
            dx, dy, ex, ey = bx - ax, by - ay, px - rx, py - ry
            point_side, reference_side = dx * (py - ay) - dy * (px - ax), dx * (ry - ay) - dy * (rx - ax)
            start_side, end_side = ex * (ay - ry) - ey * (ax - rx), ex * (by - ry) - ey * (bx - rx)
            length, way = np.hypot(dx, dy), np.hypot(ex, ey)
            crossing = ((point_side > 0) != (reference_side > 0)) & ((start_side > 0) != (end_side > 0))
            doubtful = (np.minimum(np.abs(point_side), np.abs(reference_side)) <= eps * length) | (
                np.minimum(np.abs(start_side), np.abs(end_side)) <= eps * way
            )
            inside[rows] ^= crossing
            tie[rows] |= doubtful
        if tie.any():
            inside[tie] = shapely.intersects_xy(self.shape, x[tie], y[tie])
        return inside

    def contains_box(self, x: np.ndarray, y: np.ndarray, heading: np.ndarray, width: np.ndarray, length: np.ndarray) -> np.ndarray:
        """Whether each closed box lies in the closed polygon: its centre does, and no edge passes through its inside."""
        half_width, half_length = width / 2, length / 2
        with np.errstate(invalid="ignore"):
            reach = np.hypot(half_width, half_length)
            small = (reach < self.size) & (half_width > TIE * self.scale) & (half_length > TIE * self.scale)
        tie, inside = ~small, np.zeros(len(x), dtype=bool)
        rows = np.flatnonzero(small)
        if len(rows):
            grid, known = self.grid_for(float(reach[rows].max()))
            square = grid.square_of(x, y)
            inside[rows] = known[square[rows]] == INSIDE
            rows = rows[known[square[rows]] == UNSURE]
            inside[rows] = self.contains_point(x[rows], y[rows])
            rows = rows[inside[rows]]
            cosine, sine = np.cos(heading), np.sin(heading)
            eps = 4 * TIE * self.scale
            for k in range(grid.most):
                rows = rows[inside[rows] & (grid.counts[square[rows]] > k)]
                if not len(rows):
                    break
                ax, ay, bx, by = self.edges[grid.lists[square[rows], k]].T
                c, s, hw, hl = cosine[rows], sine[rows], half_width[rows], half_length[rows]
                dx, dy = (bx - ax) / 2, (by - ay) / 2
                mx, my = (ax + bx) / 2 - x[rows], (ay + by) / 2 - y[rows]
                mx, my, hx, hy = mx * c + my * s, my * c - mx * s, dx * c + dy * s, dy * c - dx * s
                half = np.hypot(hx, hy)
                gap = np.maximum(np.abs(mx) - hw - np.abs(hx), np.abs(my) - hl - np.abs(hy))
                gap = np.maximum(gap, (np.abs(mx * hy - my * hx) - hw * np.abs(hy) - hl * np.abs(hx)) / half)
                inside[rows[gap < -eps]] = False
                tie[rows[np.abs(gap) <= eps]] = True
        large = np.flatnonzero(~small)
        inside[large] = self.contains_point(x[large], y[large])
        for row in np.flatnonzero(tie & inside):
            inside[row] = self.covers_box(x[row], y[row], heading[row], width[row], length[row])
        return inside

    def covers_box(self, x: float, y: float, heading: float, width: float, length: float) -> bool:
        """Return shapely's answer for one box."""
        from ....semantics.space.regions.approximation import box_shape
        from ....semantics.space.vectors import Vector

        return bool(self.shape.covers(box_shape(Vector(float(x), float(y)), float(heading), float(width), float(length))))

    def grid_for(self, reach: float) -> tuple[Grid, np.ndarray]:
        """A grid with the edges within `reach` metres of each square, and where squares with none are (INSIDE, OUTSIDE; else UNSURE)."""
        step = math.ceil(math.log2(max(reach, 1e-6)) * 2)
        if step not in self.near:
            bound = 2 ** (step / 2)
            grid = Grid(self.lines, max(bound / 4, self.size / math.sqrt(len(self.edges)) / 8), bound)
            known = np.where(shapely.intersects_xy(self.shape, *grid.centres), INSIDE, OUTSIDE)
            self.near[step] = grid, np.append(np.where(grid.counts[:-1] > 0, UNSURE, known), OUTSIDE).astype(np.int8)
        return self.near[step]


@lru_cache(maxsize=4096)  # a program may draw from all lanes of a map
def tests_of(region: PolygonalRegion) -> PolygonTests:
    """The tests of a region, made once."""
    return PolygonTests(region.closed)


class FieldTests:
    """The first of some polygons that holds a point."""

    def __init__(self, polygons: tuple[BaseGeometry, ...]) -> None:
        self.polygons = np.array(polygons, dtype=object)
        bounds = shapely.bounds(self.polygons)
        self.scale = 1 + float(np.abs(bounds).max())
        extent = np.maximum(bounds[:, 2] - bounds[:, 0], bounds[:, 3] - bounds[:, 1])
        self.grid = Grid(self.polygons, float(np.median(extent)) / FINE, 0.0)
        self.known = self.where_known()  # by square
        edges = [edges_of(p) for p in polygons]
        self.most = max(map(len, edges))
        self.edges = np.zeros((len(edges), self.most, 4))
        self.number = np.array([len(e) for e in edges])
        for i, e in enumerate(edges):
            self.edges[i, : len(e)] = e

    def where_known(self) -> np.ndarray:
        """By square: the first polygon that holds a point of it, if it is the same for all (-1 for none), else -2."""
        grid = self.grid
        first = grid.lists[:-1, 0].copy() if grid.most else np.full(len(grid.counts) - 1, -1)
        there = np.flatnonzero(first >= 0)
        west, south = grid.west + there % grid.columns * grid.side, grid.south + there // grid.columns * grid.side
        margin = TIE * self.scale
        shapely.prepare(self.polygons)
        squares = shapely.box(west - margin, south - margin, west + grid.side + margin, south + grid.side + margin)
        covered = shapely.covers(self.polygons[first[there]], squares)
        first[there[~covered]] = -2
        return np.append(first, -1).astype(np.int32)

    def first(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """The number of the first polygon (closed) that holds each point, or -1."""
        square = self.grid.square_of(x, y)
        known = self.known[square]
        result = np.maximum(known, -1).astype(np.int64)
        rows = np.flatnonzero(known == -2)
        for k in range(self.grid.most):
            rows = rows[(result[rows] < 0) & (self.grid.counts[square[rows]] > k)]
            if not len(rows):
                break
            candidate = self.grid.lists[square[rows], k]
            found = self.holds(candidate, x[rows], y[rows])
            result[rows[found]] = candidate[found]
        return result

    def holds(self, polygon: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Whether each point is in the polygon of that number: how many edges a ray to the East crosses."""
        inside = np.zeros(len(x), dtype=bool)
        tie = np.zeros(len(x), dtype=bool)
        eps = TIE * self.scale
        for j in range(self.most):
            ax, ay, bx, by = self.edges[polygon, j].T
            dx, dy, px, py = bx - ax, by - ay, x - ax, y - ay
            side = dx * py - dy * px
            inside ^= ((ay > y) != (by > y)) & ((side > 0) == (dy > 0))
            tie |= (np.abs(side) <= eps * np.hypot(dx, dy)) & (j < self.number[polygon])
        if tie.any():
            inside[tie] = shapely.intersects_xy(self.polygons[polygon[tie]], x[tie], y[tie])
        return inside


@lru_cache(maxsize=64)
def constant_cells(field: object) -> bool:
    """Whether a polygonal field has a constant heading in each cell and none outside."""
    return isinstance(field, PolygonalVectorField) and bool(field.cells) and all(isinstance(h, (int, float)) for _, h in field.cells)


@lru_cache(maxsize=64)
def field_of(field: PolygonalVectorField) -> tuple[FieldTests, np.ndarray]:
    """The cells of a field and their headings."""
    headings = [float(h) for _, h in field.cells]  # type: ignore[arg-type]
    outside = np.nan if field.defaultHeading is None else field.defaultHeading
    return FieldTests(tuple(field.closed)), np.array([*headings, outside])
