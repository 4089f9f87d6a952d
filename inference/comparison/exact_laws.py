"""One sample against a law that is known exactly: a distribution function, probabilities of values, or a mean.

`evidence` is the log10 of the largest e-value that a sequence of draws reached. It contradicts the law at level α if it is at
least -log10 α: by Ville's inequality draws from the law itself get there with probability at most α.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from .betting import Array, log_sum, one_sample_wealth

EDGES = (0.002, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.94, 0.97, 0.99, 0.998)
"""Levels at which distributions are cut into cells: finer towards the ends, where a wrong range shows."""

DEFAULT_ALPHA = 1e-9
"""The risk of a false alarm of one statistical test, here and in our own suite: a thousand of them share a millionth."""

SAME = 1e-9  # relative difference of two numbers that are the same but for rounding

STAKES = tuple(sign * 2.0**-k for k in range(1, 11) for sign in (1.0, -1.0))


@dataclass(frozen=True)
class Continuous:
    """A law on the reals with the continuous distribution function `cdf`; values outside [low, high] are impossible (but for rounding)."""

    name: str
    cdf: Callable[[float], float]
    low: float = -math.inf
    high: float = math.inf

    def cells(self, values: Sequence[object]) -> tuple[Array, Array]:
        """The cell of each value, and the probabilities of the cells. What cannot be is in the last, of probability 0."""
        levels = np.array([self._level(value) for value in values], dtype=float)
        inside = np.searchsorted(EDGES, levels, side="right")
        inside[np.isnan(levels)] = len(EDGES) + 1
        return inside, np.append(np.diff((0.0, *EDGES, 1.0)), 0.0)

    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        levels = (0.0, *EDGES, 1.0)
        return (*(f"{self.name}: level {low:g} to {high:g}" for low, high in pairwise(levels)), "impossible")

    def _level(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            return math.nan
        rounding = SAME * max(1.0, abs(value))
        return float(self.cdf(float(value))) if self.low - rounding <= value <= self.high + rounding else math.nan


@dataclass(frozen=True)
class Categorical:
    """A law on finitely many values."""

    probabilities: Mapping[Hashable, Fraction | float]

    def cells(self, values: Sequence[object]) -> tuple[Array, Array]:
        """The cell of each value, and the probabilities of the cells; all other values share the last, of probability 0."""
        places = {value: place for place, value in enumerate(self.probabilities)}
        other = len(places)
        found = np.array([places.get(value, other) if isinstance(value, Hashable) else other for value in values], dtype=int)
        return found, np.array([*(float(p) for p in self.probabilities.values()), 0.0])


    def labels(self) -> tuple[str, ...]:
        """A name for each cell."""
        return (*(str(value) for value in self.probabilities), "any other")


@dataclass(frozen=True)
class BoundedMean:
    """Any law on [low, high] with the given mean."""

    mean: float
    low: float
    high: float


Law = Continuous | Categorical | BoundedMean


def evidence(values: Sequence[object], law: Law) -> float:
    """The log10 of the largest e-value that the draws `values`, one after the other, reached against `law`."""
    if not len(values):
        return 0.0
    if isinstance(law, BoundedMean):
        return _evidence_on_mean(values, law)
    cells, p = law.cells(values)
    marks = checkpoints(len(cells))
    wealth = one_sample_wealth(np.array([np.bincount(cells[:n], minlength=len(p)) for n in marks]), p)
    return float(np.max(wealth)) / math.log(10.0)


def contradicts(values: Sequence[object], law: Law, alpha: float = DEFAULT_ALPHA) -> bool:
    """Whether the draws contradict the law; draws from the law do so with probability at most `alpha`."""
    return evidence(values, law) >= -math.log10(alpha)


def checkpoints(n: int, first: int = 16) -> list[int]:
    """Numbers of draws at which one looks: growing by a fifth, the last being all of them."""
    found, at = [], float(first)
    while at < n:
        found.append(int(at))
        at *= 1.2
    return [*found, n]


def _evidence_on_mean(values: Sequence[object], law: BoundedMean) -> float:
    """Bets 1 + s (v - mean) / scale on every draw, averaged over stakes s of both signs; 0 draws may lie outside [low, high]."""
    found = np.array([float(v) if isinstance(v, (int, float)) else math.nan for v in values])
    if not np.all((found >= law.low) & (found <= law.high)):
        return math.inf
    scale = max(law.high - law.mean, law.mean - law.low)
    gains = (found - law.mean) / scale if scale > 0 else np.zeros(len(found))
    wealth = np.array([np.cumsum(np.log1p(stake * gains)) for stake in STAKES])
    return float(np.max(log_sum(wealth, axis=0) - math.log(len(STAKES)))) / math.log(10.0)
