"""How a feature is cut into cells, once and for all, by draws that are not used again or by the law it is compared with.

Numbers are cut at quantiles, finer towards the ends; a feature of few values, and anything that is no number, has a cell for each
value and one for all others. Angles are cut open at their widest gap, so that values on both sides of ±π stay together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .betting import Array
from .columns import Column, is_angle
from .laws import EDGES, SAME, Categorical, Continuous

FEW = 24  # as many different values, or fewer, get a cell each
MOST_EXACT = 256  # against an exact law
QUARTERS = (0.25, 0.5, 0.75)
FEWEST = 5  # draws of the first block beyond the outermost edge


@dataclass(frozen=True)
class Values:
    """A cell for each of some values, and a last one for all others; `numbers` are sorted."""

    names: tuple[str, ...]
    numbers: Array | None
    opening: float | None = None

    @property
    def count(self) -> int:
        """How many cells there are."""
        return len(self.names) + 1

    def assign(self, column: Column) -> Array:
        """The cell of each value."""
        if self.numbers is None:
            places = {name: i for i, name in enumerate(self.names)}
            texts = [f"{v:.9g}" for v in column.values] if column.is_number else column.values
            return np.array([places.get(v, len(places)) for v in texts], dtype=int)
        if not column.is_number:
            return np.full(len(column.values), len(self.names))
        values = opened(column.values, self.opening)
        after = np.clip(np.searchsorted(self.numbers, values), 1, max(1, len(self.numbers) - 1))
        before = np.maximum(after - 1, 0)
        after = np.minimum(after, len(self.numbers) - 1)
        nearest = np.where(np.abs(self.numbers[before] - values) <= np.abs(self.numbers[after] - values), before, after)
        off = np.abs(self.numbers[nearest] - values)
        return np.where(off <= SAME * np.maximum(1.0, np.abs(values)), nearest, len(self.names))

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        return (*self.names, "any other")


@dataclass(frozen=True)
class Intervals:
    """Cells between edges; what is no number has the last cell."""

    edges: Array
    opening: float | None = None

    @property
    def count(self) -> int:
        """How many cells there are."""
        return len(self.edges) + 2

    def assign(self, column: Column) -> Array:
        """The cell of each value."""
        if not column.is_number:
            return np.full(len(column.values), self.count - 1)
        found = np.searchsorted(self.edges, opened(column.values, self.opening), side="right")
        return np.where(np.isnan(column.values), self.count - 1, found)

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        shown = [f"{edge:.6g}" for edge in self.edges]
        between = [f"{low} to {high}" for low, high in pairwise(shown)]
        return (f"below {shown[0]}" if shown else "any number", *between, f"from {shown[-1]}" if shown else "-", "no number")


@dataclass(frozen=True)
class OfLaw:
    """The cells that a law in closed form has by itself."""

    law: Continuous | Categorical

    @property
    def probabilities(self) -> Array:
        """Those of the cells."""
        return self.law.cells(())[1]

    @property
    def count(self) -> int:
        """How many cells there are."""
        return len(self.probabilities)

    def assign(self, column: Column) -> Array:
        """The cell of each value."""
        return self.law.cells(column.values.tolist())[0]

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        return self.law.labels()


Cells = Values | Intervals | OfLaw


def cells_of(column: Column, weights: Array | None = None, levels: tuple[float, ...] = EDGES, *, exact: bool = False) -> Cells:
    """Cells for a feature, from values of it (each with a weight). `levels` are those of the quantiles."""
    few = MOST_EXACT if exact else min(FEW, len(levels) + 1)
    if not column.is_number:
        return Values(tuple(dict.fromkeys(column.values))[:MOST_EXACT], None)
    known = ~np.isnan(column.values)
    weights = weights[known] if weights is not None else None
    opening = opening_of(column.values) if is_angle(column.name) else None
    values = opened(column.values[known], opening)
    different = merged(np.unique(values))
    if len(different) <= few:
        return Values(tuple(f"{v:.9g}" for v in different), different, opening)
    order = np.argsort(values, kind="stable")
    share = np.cumsum((np.ones(len(values)) if weights is None else weights)[order])
    enough = FEWEST / len(values)
    at = [np.searchsorted(share, level * share[-1]) for level in levels if enough <= level <= 1 - enough]
    edges = np.unique(values[order][np.minimum(at, len(values) - 1)])
    return Intervals(edges - SAME * np.maximum(1.0, np.abs(edges)), opening)  # just below, so that rounding does not split an atom


def merged(values: Array) -> Array:
    """Sorted values without those that differ from the one before by rounding only."""
    if len(values) < 2:
        return values
    apart = np.diff(values) > SAME * np.maximum(1.0, np.abs(values[1:]))
    return values[np.concatenate([[True], apart])]


def opening_of(angles: Array) -> float:
    """The middle of the widest gap between the angles on the circle."""
    around = np.unique(angles[np.isfinite(angles)] % math.tau)
    if not len(around):
        return 0.0
    gaps = np.diff(np.append(around, around[0] + math.tau))
    widest = int(np.argmax(gaps))
    return float(around[widest] + gaps[widest] / 2)


def opened(values: Array, opening: float | None) -> Array:
    """Angles as numbers within π of the angle opposite to `opening`; other values as they are."""
    if opening is None:
        return values
    return (values - opening) % math.tau + (opening - math.tau)
