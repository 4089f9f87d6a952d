"""Points and boxes in polygons, and the cells of fields, on tensors: the tests of `evaluate.polygons`, all pairs of rows and near edges at once.

What lies within `TIE` of an edge, where the columns ask shapely, is doubtful; `slack` is what is added for the rounding of the operands, in metres.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from .point_in_polygon import INSIDE, TIE, UNSURE, FieldTests, Grid, PolygonTests


class TensorGrid:
    """A grid on a device."""

    def __init__(self, grid: Grid, device: torch.device) -> None:
        self.grid, self.device = grid, device
        self.counts = torch.from_numpy(grid.counts).to(device)
        self.starts = torch.from_numpy(np.concatenate([[0], np.cumsum(grid.counts)])).to(device)
        self.shapes = torch.from_numpy(grid.lists[grid.lists >= 0]).to(device)

    def square_of(self, x: Tensor, y: Tensor) -> Tensor:
        """The number of the square in which a point lies; the last number for points beyond all squares."""
        grid = self.grid
        column, row = torch.floor((x - grid.west) / grid.side), torch.floor((y - grid.south) / grid.side)
        inside = (column >= 0) & (column < grid.columns) & (row >= 0) & (row < grid.rows)
        return torch.where(inside, row * grid.columns + column, float(len(grid.lists) - 1)).to(torch.int64)

    def pairs(self, square: Tensor) -> tuple[Tensor, Tensor]:
        """The shapes near each row's square: pairs of row and shape, rows in order and the shapes of each as well."""
        counts = self.counts[square]
        row = torch.repeat_interleave(torch.arange(len(square), device=self.device), counts)
        before = torch.cumsum(counts, 0) - counts
        place = torch.arange(len(row), device=self.device) - before[row]
        return row, self.shapes[self.starts[square[row]] + place]


def any_of(row: Tensor, truths: Tensor, rows: int) -> Tensor:
    """Which rows have a pair for which that is true."""
    return count_true_pairs(row, truths, rows) > 0


def count_true_pairs(row: Tensor, truths: Tensor, rows: int) -> Tensor:
    """For how many of its pairs that is true, by row."""
    return torch.zeros(rows, dtype=torch.int64, device=row.device).index_add_(0, row, truths.to(torch.int64))


class TensorPolygon:
    """Points and boxes in one polygon or multipolygon."""

    def __init__(self, tests: PolygonTests, device: torch.device) -> None:
        self.tests, self.device = tests, device
        self.edges = torch.from_numpy(tests.edges).to(device)
        self.reference = torch.from_numpy(tests.reference).to(device)
        self.reference_inside = torch.from_numpy(tests.reference_inside).to(device)
        self.grid = TensorGrid(tests.grid, device)
        self.near: dict[int, tuple[TensorGrid, Tensor]] = {}

    def contains_point(self, x: Tensor, y: Tensor, slack: float) -> tuple[Tensor, Tensor]:
        """Whether each point is in the closed polygon, and where that is doubtful."""
        square = self.grid.square_of(x, y)
        row, edge = self.grid.pairs(square)
        ax, ay, bx, by = self.edges[edge].unbind(1)
        rx, ry = self.reference[square[row]].unbind(1)
        px, py = x[row], y[row]
        dx, dy, ex, ey = bx - ax, by - ay, px - rx, py - ry
        point_side, reference_side = dx * (py - ay) - dy * (px - ax), dx * (ry - ay) - dy * (rx - ax)
        start_side, end_side = ex * (ay - ry) - ey * (ax - rx), ex * (by - ry) - ey * (bx - rx)
        eps = TIE * self.tests.scale + slack
        near = torch.minimum(point_side.abs(), reference_side.abs()) <= eps * torch.hypot(dx, dy)
        near |= torch.minimum(start_side.abs(), end_side.abs()) <= eps * torch.hypot(ex, ey)
        crossing = ((point_side > 0) != (reference_side > 0)) & ((start_side > 0) != (end_side > 0))
        inside = self.reference_inside[square] ^ (count_true_pairs(row, crossing, len(x)) % 2 == 1)
        return inside, any_of(row, near, len(x))

    def contains_box(self, x: Tensor, y: Tensor, heading: Tensor, width: Tensor, length: Tensor, slack: float) -> tuple[Tensor, Tensor]:
        """Whether each closed box is in the closed polygon, and where that is doubtful: where it is very small or very large as well."""
        half_width, half_length = width / 2, length / 2
        reach = torch.hypot(half_width, half_length)
        least = TIE * self.tests.scale + slack
        small = (reach < self.tests.size) & (half_width > least) & (half_length > least)
        grid, known = self.grid_for(float(torch.where(small, reach, 0.0).max()) if len(x) else 0.0)
        square = grid.square_of(x, y)
        where = known[square]
        inside, doubtful = where == INSIDE, torch.zeros_like(small)
        open_ = torch.nonzero((where == UNSURE) | ~small).squeeze(1)
        inside[open_], doubtful[open_] = self.contains_point(x[open_], y[open_], slack)
        doubtful |= ~small & inside
        left = torch.nonzero((where == UNSURE) & small & inside).squeeze(1)
        row, edge = grid.pairs(square[left])
        gap = self.gaps(edge, *(v[left][row] for v in (x, y, heading, half_width, half_length)))
        eps = 4 * least
        outside = any_of(row, gap < -eps, len(left))
        inside[left] = ~outside
        doubtful[left] = (doubtful[left] | any_of(row, gap.abs() <= eps, len(left))) & ~outside
        return inside, doubtful

    def gaps(self, edge: Tensor, x: Tensor, y: Tensor, heading: Tensor, half_width: Tensor, half_length: Tensor) -> Tensor:
        """How far a box and an edge are apart on the axis that separates them best, in metres; negative if none does."""
        ax, ay, bx, by = self.edges[edge].unbind(-1)
        c, s = torch.cos(heading), torch.sin(heading)
        dx, dy, px, py = (bx - ax) / 2, (by - ay) / 2, (ax + bx) / 2 - x, (ay + by) / 2 - y
        mx, my, hx, hy = px * c + py * s, py * c - px * s, dx * c + dy * s, dy * c - dx * s
        gap = torch.maximum(mx.abs() - half_width - hx.abs(), my.abs() - half_length - hy.abs())
        half = torch.hypot(hx, hy).clamp(min=1e-300)
        return torch.maximum(gap, ((mx * hy - my * hx).abs() - half_width * hy.abs() - half_length * hx.abs()) / half)

    def grid_for(self, reach: float) -> tuple[TensorGrid, Tensor]:
        """As `PolygonTests.grid_for`, on the device."""
        grid, known = self.tests.grid_for(reach)
        if id(grid) not in self.near:
            self.near[id(grid)] = TensorGrid(grid, self.device), torch.from_numpy(known).to(self.device)
        return self.near[id(grid)]


class TensorField:
    """The first of some polygons that holds a point."""

    def __init__(self, tests: FieldTests, device: torch.device) -> None:
        self.tests = tests
        self.grid = TensorGrid(tests.grid, device)
        self.known = torch.from_numpy(tests.known.astype(np.int64)).to(device)
        self.edges = torch.from_numpy(tests.edges).to(device)
        self.number = torch.from_numpy(tests.number).to(device)

    def first(self, x: Tensor, y: Tensor, slack: float) -> tuple[Tensor, Tensor]:
        """The number of the first polygon (closed) that holds each point, or -1, and where that is doubtful."""
        square = self.grid.square_of(x, y)
        found = self.known[square]
        doubtful = torch.zeros(len(x), dtype=torch.bool, device=x.device)
        eps = TIE * self.tests.scale
        if slack > eps:
            return found.clamp(min=-1), ~doubtful
        open_ = torch.nonzero(found == -2).squeeze(1)
        row, cell = self.grid.pairs(square[open_])
        ax, ay, bx, by = self.edges[cell].unbind(-1)
        px, py = x[open_][row].unsqueeze(1), y[open_][row].unsqueeze(1)
        dx, dy = bx - ax, by - ay
        side = dx * (py - ay) - dy * (px - ax)
        crossed = ((ay > py) != (by > py)) & ((side > 0) == (dy > 0))
        there = torch.arange(self.edges.shape[1], device=x.device) < self.number[cell].unsqueeze(1)
        near = (side.abs() <= (eps + slack) * torch.hypot(dx, dy)) & there
        none = len(self.tests.polygons)
        inside = torch.where(crossed.sum(1) % 2 == 1, cell, none)
        first = torch.full((len(open_),), none, device=x.device).scatter_reduce_(0, row, inside, "amin")
        found[open_] = torch.where(first < none, first, -1)
        doubtful[open_] = any_of(row, near.any(1), len(open_))
        return found, doubtful
