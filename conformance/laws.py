"""Distributions that a vector may name: distribution functions in closed form, and moments of bounded quantities."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..inference.comparison.exact_laws import DEFAULT_ALPHA, BoundedMean, Continuous, evidence
from .fields import VectorFields

THRESHOLD = -math.log10(DEFAULT_ALPHA)
"""log10 of the e-value that contradicts a law: a statistical vector accuses a correct implementation with probability at most `DEFAULT_ALPHA`."""

Cdf = Callable[[float], float]
Family = tuple[Cdf, float, float]
"""A distribution function, and the ends of the interval outside of which there are no values."""


@dataclass(frozen=True, slots=True)
class Moments:
    """The mean of a quantity that lies between `low` and `high`, and perhaps the mean of its square."""

    mean: float
    low: float
    high: float
    second: float | None = None


Law = Continuous | Moments


def contradiction(values: Sequence[float], law: Law) -> float:
    """How strongly the values contradict the law: the logarithm to base 10 of the largest e-value that they reached.

    With the mean of the squares there are two bets, with half of the stake on each: half of the larger is at most what they reach together.
    (The larger one alone would not be an e-value.)
    """
    if isinstance(law, Continuous):
        return evidence(values, law)
    if not all(law.low <= value <= law.high for value in values):
        return math.inf
    strongest = evidence(values, BoundedMean(law.mean, law.low, law.high))
    if law.second is None:
        return strongest
    most = max(law.low**2, law.high**2)
    return max(strongest, evidence([value**2 for value in values], BoundedMean(law.second, 0.0, most))) - math.log10(2)


def read_law(fields: VectorFields) -> Law:
    """The distribution function or the moments that a table holds. Raises `UsageError`."""
    if fields.has("cdf") == fields.has("moments"):
        raise fields.wrong("either cdf or moments is needed, and not both")
    return read_cdf(fields.table("cdf")) if fields.has("cdf") else read_moments(fields.table("moments"))


def read_moments(fields: VectorFields) -> Moments:
    """`{mean, low, high, second}`."""
    second = fields.number("second") if fields.has("second") else None
    law = Moments(fields.number("mean"), fields.number("low"), fields.number("high"), second)
    fields.done()
    if not law.low <= law.mean <= law.high:
        raise fields.wrong("the mean must lie between low and high")
    return law


def read_cdf(fields: VectorFields) -> Continuous:
    """`{name = "uniform", low = 0, high = 1}` and so on."""
    name = fields.text("name")
    if name not in FAMILIES:
        raise fields.wrong(f"there is no distribution function {name!r}: there are {', '.join(FAMILIES)}")
    cdf, low, high = FAMILIES[name](fields)
    fields.done()
    return Continuous(name, cdf, low, high)


def ordered_interval(fields: VectorFields) -> tuple[float, float]:
    """`low` and `high`, in this order."""
    low, high = fields.number("low"), fields.number("high")
    if not low < high:
        raise fields.wrong("low must be below high")
    return low, high


def deviation(fields: VectorFields) -> float:
    """`deviation`, above 0."""
    found = fields.number("deviation")
    if found <= 0:
        raise fields.wrong("deviation must be above 0")
    return found


def clipped(value: float) -> float:
    """The value, moved into [0, 1]."""
    return min(max(value, 0.0), 1.0)


def standard_normal(z: float) -> float:
    """The distribution function of the standard normal, precise in both tails."""
    return 0.5 * math.erfc(-z / math.sqrt(2))


def uniform(fields: VectorFields) -> Family:
    """F(x) = (x - low) / (high - low)."""
    low, high = ordered_interval(fields)
    return lambda x: clipped((x - low) / (high - low)), low, high


def normal(fields: VectorFields) -> Family:
    """F(x) = Φ((x - mean) / deviation)."""
    mean, std = fields.number("mean"), deviation(fields)
    return lambda x: standard_normal((x - mean) / std), -math.inf, math.inf


def truncated_normal(fields: VectorFields) -> Family:
    """F(x) = (Φ(z(x)) - Φ(z(low))) / (Φ(z(high)) - Φ(z(low))) with z(x) = (x - mean) / deviation."""
    mean, std = fields.number("mean"), deviation(fields)
    low, high = ordered_interval(fields)
    below, within = standard_normal((low - mean) / std), standard_normal((high - mean) / std) - standard_normal((low - mean) / std)
    return lambda x: clipped((standard_normal((x - mean) / std) - below) / within), low, high


def triangular(fields: VectorFields) -> Family:
    """The density rises linearly from low to mode and falls linearly to high."""
    low, high = ordered_interval(fields)
    mode = fields.number("mode")
    if not low <= mode <= high:
        raise fields.wrong("mode must lie between low and high")

    def cdf(x: float) -> float:
        if x <= low or x >= high:
            return 0.0 if x <= low else 1.0
        if x < mode:
            return (x - low) ** 2 / ((high - low) * (mode - low))
        return 1 - (high - x) ** 2 / ((high - low) * (high - mode))

    return cdf, low, high


def power(fields: VectorFields) -> Family:
    """F(x) = ((x - low) / (high - low)) ** exponent."""
    low, high = ordered_interval(fields)
    exponent = fields.number("exponent")
    if exponent <= 0:
        raise fields.wrong("exponent must be above 0")
    return lambda x: clipped((x - low) / (high - low)) ** exponent, low, high


def piecewise_linear(fields: VectorFields) -> Family:
    """F goes through the knots [x, F(x)] in straight lines, from [.., 0] to [.., 1]."""
    knots = fields.points("knots")
    rising = all(a[0] < b[0] and a[1] <= b[1] for a, b in pairwise(knots))
    if not rising or len(knots) < 2 or knots[0][1] != 0 or knots[-1][1] != 1:
        raise fields.wrong("the knots must rise from [.., 0] to [.., 1]")
    places = [x for x, _ in knots]

    def cdf(x: float) -> float:
        after = bisect_right(places, x)
        if after in (0, len(knots)):
            return 0.0 if after == 0 else 1.0
        (x0, f0), (x1, f1) = knots[after - 1], knots[after]
        return f0 + (f1 - f0) * (x - x0) / (x1 - x0)

    return cdf, places[0], places[-1]


FAMILIES: Mapping[str, Callable[[VectorFields], Family]] = {
    "uniform": uniform,
    "normal": normal,
    "truncated-normal": truncated_normal,
    "triangular": triangular,
    "power": power,
    "piecewise-linear": piecewise_linear,
}
"""The closed table of distribution functions."""
