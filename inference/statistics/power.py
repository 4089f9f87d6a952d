"""How many scenes a comparison needs: the power that a verdict states.

Let two laws differ by ε in total variation in the cells of a feature. The best bet gains at least ε² on average from a pair of draws (2 ε²
from one draw against an exact law), and least where the difference is spread evenly over two halves of the probability: each cell of one half
becomes more frequent by the same factor, each of the other half less. The power is computed for this difference, which is the hardest to see, in
the feature in which it is hardest: the wealth at the expected counts, less `QUANTILE` standard deviations of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .betting import Array, one_sample_wealth, two_sample_wealth
from .verdict import MOST

QUANTILE = 2.3263478740408408  # of the standard normal, at 0.99


class Hardest:
    """For each of some features, the laws that are hardest to tell apart: `p` is (features, cells), padded with zeros."""

    def __init__(self, laws: Sequence[Array], *, exact: bool) -> None:
        self.exact = exact
        known = [p[p > 0] for p in laws]
        known = [np.sort(p / p.sum())[::-1] for p in known if len(p) > 1] or [np.array([0.5, 0.5])]
        self.p = np.zeros((len(known), max(len(p) for p in known)))
        self.half = np.zeros(self.p.shape, dtype=bool)
        for row, p in enumerate(known):
            self.p[row, : len(p)] = p
            self.half[row, : len(p)] = lighter_half(p)

    def tilted(self, by: float) -> Array:
        """The laws with `by` more probability in the lighter halves, as much as there is room for."""
        light = np.where(self.half, self.p, 0.0).sum(-1, keepdims=True)
        moved = np.clip(light + by, 0.0, 1.0)
        return np.where(self.half, self.p * moved / light, self.p * (1.0 - moved) / (1.0 - light))

    def wealth(self, n: int, tv: float) -> Array:
        """For each feature, the log wealth that is exceeded with probability 0.99 after `n` draws of each side that differ by `tv`."""
        if self.exact:
            q = self.tilted(tv)
            gain = logarithm(q, self.p)
            return one_sample_wealth(n * q, self.p) - QUANTILE * np.sqrt(n * variance(q, gain))
        a, b = self.tilted(tv / 2), self.tilted(-tv / 2)
        spread = variance(a, logarithm(a, (a + b) / 2)) + variance(b, logarithm(b, (a + b) / 2))
        return two_sample_wealth(n * a, n * b) - QUANTILE * np.sqrt(n * spread)

    def found(self, n: int, tv: float, threshold: float) -> bool:
        """Whether `n` draws of each side show a difference of `tv` in any one feature with probability 0.99."""
        return bool(np.min(self.wealth(n, tv)) >= threshold)


def lighter_half(p: Array) -> Array:
    """Which cells of a law, the most probable first, make up the lighter of two halves that are as equal as can be had greedily."""
    sides, weights = np.zeros(len(p), dtype=bool), [0.0, 0.0]
    for cell, share in enumerate(p):
        side = int(weights[1] < weights[0])
        sides[cell] = side
        weights[side] += share
    return sides if weights[1] <= weights[0] else ~sides


def logarithm(q: Array, p: Array) -> Array:
    """log(q / p), and 0 where there is nothing."""
    return np.log(np.where((q > 0) & (p > 0), q, 1.0) / np.where((q > 0) & (p > 0), p, 1.0))


def variance(q: Array, gain: Array) -> Array:
    """The variance of the gain of one draw from `q`."""
    return np.maximum((q * gain**2).sum(-1) - (q * gain).sum(-1) ** 2, 0.0)


def threshold_of(alpha: float, features: int) -> float:
    """The log wealth of one feature that makes the average of all reach 1/α."""
    return math.log(max(1, features)) - math.log(alpha)


def needed(tv: float, alpha: float, features: int, hardest: Hardest) -> int:
    """The number of draws of each side after which a difference of `tv` in any one of `features` is found with probability 0.99."""
    threshold = threshold_of(alpha, features)
    low, high = 1, 2
    while high < MOST and not hardest.found(high, tv, threshold):
        low, high = high, 2 * high
    while high - low > max(1, low // 100):
        middle = (low + high) // 2
        low, high = (low, middle) if hardest.found(middle, tv, threshold) else (middle, high)
    return high


def detectable(n: int, alpha: float, features: int, hardest: Hardest) -> float:
    """The least total variation that `n` draws of each side would have shown; 1 if they would not have shown any."""
    threshold = threshold_of(alpha, features)
    low, high = 0.0, 1.0
    if n < 1 or not hardest.found(n, high, threshold):
        return 1.0
    while high - low > 1e-3 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if hardest.found(n, middle, threshold) else (middle, high)
    return high
