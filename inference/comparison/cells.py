"""How a feature is cut into cells, once and for all, by draws that are not used again or by the law it is compared with.

Numbers are cut at quantiles, finer towards the ends; a feature of few values, and anything that is not a number, has a cell for each
value and one for all others. Angles are cut open at their widest gap, so that values on both sides of ±π stay together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .betting import Array
from .exact_laws import EDGES, SAME, Categorical, Continuous
from .scene_columns import Column, is_angle

FEW = 24  # as many different values, or fewer, get a cell each
MOST_EXACT = 256  # against an exact law
QUARTERS = (0.25, 0.5, 0.75)
REPEATED, MOST_LEARNT, MOST_REPEATED = 3, 16, 256
"""How often a value must occur in one block to be remembered; the most values that are remembered of a block, and (about) in all."""
FEWEST = 5  # draws of the first block beyond the outermost edge


@dataclass(frozen=True)
class Values:
    """A cell for each of some values, and a last one for all others; `numbers` are sorted."""

    names: tuple[str, ...]
    numbers: Array | None
    opening: float | None = None
    tolerance: float = SAME

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
        values = unwrap_angles(column.values, self.opening)
        after = np.clip(np.searchsorted(self.numbers, values), 1, max(1, len(self.numbers) - 1))
        before = np.maximum(after - 1, 0)
        after = np.minimum(after, len(self.numbers) - 1)
        nearest = np.where(np.abs(self.numbers[before] - values) <= np.abs(self.numbers[after] - values), before, after)
        off = np.abs(self.numbers[nearest] - values)
        return np.where(off <= self.tolerance * np.maximum(1.0, np.abs(values)), nearest, len(self.names))

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        return (*self.names, "any other")


@dataclass(frozen=True)
class Intervals:
    """Cells between edges; what is not a number has the last cell."""

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
        found = np.searchsorted(self.edges, unwrap_angles(column.values, self.opening), side="right")
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
        """The probabilities of the cells."""
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


@dataclass(frozen=True)
class Codes:
    """A cell for each of the whole numbers from 0 on, and a last one for all other values: `names` says what they are."""

    names: tuple[str, ...]

    @property
    def count(self) -> int:
        """How many cells there are."""
        return len(self.names) + 1

    def assign(self, column: Column) -> Array:
        """The cell of each value."""
        codes = column.values.astype(int)
        return np.where(codes < 0, len(self.names), codes)

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        return (*self.names, "any other")


class Repeated:
    """Two cells: values that were seen more than once in a block that came before, which are learnt as one goes, and all others.

    What a bet is made on is known before the draw that it is made on, so that the bet is as fair as one on cells that stay.
    """

    count = 2

    def __init__(self) -> None:
        self.known = np.zeros(0)

    def assign(self, column: Column) -> Array:
        """The cell of each value."""
        if not len(self.known) or not column.is_number:
            return np.zeros(len(column.values), dtype=int)
        after = np.minimum(np.searchsorted(self.known, column.values), len(self.known) - 1)
        near = [np.abs(self.known[k] - column.values) for k in (after, np.maximum(after - 1, 0))]
        return (np.minimum(*near) <= SAME * np.maximum(1.0, np.abs(column.values))).astype(int)

    def learn(self, column: Column) -> None:
        """Look for values that come more than once, after the bets on them: those that come most often are remembered."""
        if column.is_number and len(self.known) < MOST_REPEATED:
            different, counts = np.unique(column.values[np.isfinite(column.values)], return_counts=True)
            often = np.argsort(-counts, kind="stable")[:MOST_LEARNT]
            self.known = np.union1d(self.known, different[often[counts[often] >= REPEATED]])

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        return "values seen at most twice before", f"one of {', '.join(f'{v:.9g}' for v in self.known[:6])}" if len(self.known) else "none yet"


Cells = Values | Intervals | OfLaw | Codes | Repeated


def cells_of(
    column: Column, weights: Array | None = None, levels: tuple[float, ...] = EDGES, *, exact: bool = False, tolerance: float = SAME
) -> Cells:
    """Cells for a feature, from values of it (each with a weight). `levels` are those of the quantiles; numbers that differ by no more than the
    tolerance (relative, from 1 on) are the same."""
    few = MOST_EXACT if exact else min(FEW, len(levels) + 1)
    if not column.is_number:
        return Values(tuple(dict.fromkeys(column.values))[:MOST_EXACT], None)
    known = np.isfinite(column.values)
    weights = weights[known] if weights is not None else None
    opening = opening_of(column.values) if is_angle(column.name) else None
    values = unwrap_angles(column.values[known], opening)
    every = np.unique(values)
    different = merge_close_values(every, tolerance, few)
    if len(different) <= few:
        return Values(tuple(f"{v:.9g}" for v in different), different, opening, tolerance)
    order = np.argsort(values, kind="stable")
    share = np.cumsum((np.ones(len(values)) if weights is None else weights)[order])
    enough = FEWEST / len(values) if weights is None else 0.0  # a law is known, however few values it has
    at = np.array([np.searchsorted(share, level * share[-1]) for level in levels if enough <= level <= 1 - enough], dtype=np.int64)
    edges = np.unique(values[order][np.minimum(at, len(values) - 1)])
    return Intervals(np.unique([clear_edge(float(edge), every, tolerance) for edge in edges]), opening)


def all_values(column: Column, tolerance: float) -> Values:
    """A cell for each value of a feature, however many there are."""
    if not column.is_number:
        return Values(tuple(dict.fromkeys(column.values)), None)
    opening = opening_of(column.values) if column.is_angle else None
    different = merge_close_values(np.unique(unwrap_angles(column.values, opening)), tolerance)
    return Values(tuple(f"{v:.9g}" for v in different), different, opening, tolerance)


def clear_edge(edge: float, values: Array, tolerance: float) -> float:
    """An edge near the given value where there is most room between the sorted `values`: one just below it unless rounding could cross that.

    Values that are the same but for rounding, such as those of an atom, so stay in one cell.
    """
    width = 2.0 * tolerance * max(1.0, abs(edge))
    low, high = np.searchsorted(values, [edge - width, edge + width])
    low, high = max(0, int(low) - 1), min(len(values) - 1, int(high))
    if high <= low:
        return edge - SAME * max(1.0, abs(edge))
    widest = low + int(np.argmax(np.diff(values[low : high + 1])))
    return float(values[widest] + values[widest + 1]) / 2


def merge_close_values(values: Array, tolerance: float = SAME, most: int | None = None) -> Array:
    """Sorted values without those that differ from one before, which is kept, by rounding only; the first ones, if there are more than `most`."""
    kept: list[int] = []
    at = 0
    while at < len(values) and (most is None or len(kept) <= most):
        kept.append(at)
        at = int(np.searchsorted(values, values[at] + tolerance * max(1.0, abs(values[at])), side="right"))
    return values[kept]


def opening_of(angles: Array) -> float:
    """The middle of the widest gap between the angles on the circle."""
    around = np.unique(angles[np.isfinite(angles)] % math.tau)
    if not len(around):
        return 0.0
    gaps = np.diff(np.append(around, around[0] + math.tau))
    widest = int(np.argmax(gaps))
    return float(around[widest] + gaps[widest] / 2)


def unwrap_angles(values: Array, opening: float | None) -> Array:
    """Angles as numbers within π of the angle opposite to `opening`; other values as they are."""
    if opening is None:
        return values
    return (values - opening) % math.tau + (opening - math.tau)
