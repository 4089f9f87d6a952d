"""The distributions of the paper's table: with a density on the line, on finitely many values with exact probabilities, and on the points of a
region.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import accumulate

from scipy import special

from ..numeric_functions import (
    either,
    exponential,
    exponential_less_one,
    is_finite_number,
    larger,
    logarithm,
    logarithm_of_one_more,
    pick,
    plain_float,
    search,
    smaller,
)
from ..regions import Region, UnboundedRegion
from ..regions.point_sampling import Numbers
from ..vectors import Vector
from .distribution import LEAST, BadParameters, Named, NoValues, Support, exact

_LOG_ROOT_TAU = math.log(2 * math.pi) / 2


@dataclass(frozen=True)
class Range(Named):
    """Uniform on the interval [low, high]; a point mass if they are equal.

    Example: `ego = Object at Range(-1, 1) @ 0`
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        low, high = self._number("low"), self._number("high")
        if low > high:
            raise BadParameters(self.name, "low", f"is {low}, which is above high = {high}")
        if not is_finite_number(high - low):
            raise BadParameters(self.name, "high", "is too far from low for floating-point numbers")

    def sample(self, uniform: Numbers) -> float:
        return smaller(self.low + uniform() * (self.high - self.low), self.high)

    def log_density(self, value: object) -> float:
        if not (isinstance(value, (int, float)) and self.low <= value <= self.high):
            return -math.inf
        return -math.log(self.high - self.low) if self.low < self.high else 0.0

    def support(self) -> Support | None:
        return ((self.low, Fraction(1)),) if self.low == self.high else None


@dataclass(frozen=True)
class Normal(Named):
    """The normal distribution; a point mass if the standard deviation is 0 (reading `zero-stddev`).

    Example: `ego = Object at Normal(0, 2) @ 0`
    """

    mean: float
    stdDev: float

    def __post_init__(self) -> None:
        self._number("mean")
        _check_std(self.name, self._number("stdDev"))

    def sample(self, uniform: Numbers) -> float:
        return self.mean + self.stdDev * plain_float(special.ndtri(larger(uniform(), LEAST)))

    def log_density(self, value: object) -> float:
        if not isinstance(value, (int, float)):
            return -math.inf
        if self.stdDev == 0:
            return 0.0 if value == self.mean else -math.inf
        return -0.5 * ((value - self.mean) / self.stdDev) ** 2 - math.log(self.stdDev) - _LOG_ROOT_TAU

    def support(self) -> Support | None:
        return ((self.mean, Fraction(1)),) if self.stdDev == 0 else None


@dataclass(frozen=True)
class TruncatedNormal(Named):
    """The normal distribution given that the value is in [low, high]; the limits may be infinite, or far out in a tail.

    All is computed with logarithms of the lower tail (the window is mirrored if it lies to the right): in a window beyond
    9 standard deviations the distribution function itself would round to 0 or 1.

    Example: `ego = Object at TruncatedNormal(0, 2, -1, 5) @ 0`
    """

    mean: float
    stdDev: float
    low: float
    high: float

    def __post_init__(self) -> None:
        self._number("mean")
        stdDev = self._number("stdDev")
        low, high = self._number("low", infinite=True), self._number("high", infinite=True)
        _check_std(self.name, stdDev)
        if low > high or low == math.inf or high == -math.inf:
            raise BadParameters(self.name, "low", f"is {low}: there are no numbers from there to high = {high}")
        if stdDev == 0 and not low <= self.mean <= high:
            raise BadParameters(self.name, "stdDev", f"is 0, but the mean {self.mean} is not from {low} to {high}")

    @cached_property
    def mirrored(self) -> bool:
        """Whether the window lies more to the right of the mean."""
        return self.low + self.high > 2 * self.mean

    @cached_property
    def tails(self) -> tuple[float, float]:
        """Logarithms of the normal distribution function at the two ends of the window (mirrored to the left if need be)."""
        a, b = (self.low - self.mean) / self.stdDev, (self.high - self.mean) / self.stdDev
        return (_log_ndtr(-b), _log_ndtr(-a)) if self.mirrored else (_log_ndtr(a), _log_ndtr(b))

    def sample(self, uniform: Numbers) -> float:
        u = larger(uniform(), LEAST)
        if self.stdDev == 0:
            return self.mean
        least, most = self.tails
        if least == most:  # the density does not change across the window
            return smaller(self.low + u * (self.high - self.low), self.high)
        below, above = (1.0 - u, u) if self.mirrored else (u, 1.0 - u)  # the window's probability on both sides of z
        lost = above * exponential_less_one(least - most)
        share = either(lost > -0.5, lambda: logarithm_of_one_more(lost), lambda: logarithm(below + above * exponential(least - most)))
        z = plain_float(special.ndtri_exp(most + share))
        value = self.mean + self.stdDev * (-z if self.mirrored else z)
        return smaller(larger(value, self.low), self.high)

    def log_density(self, value: object) -> float:
        if not (isinstance(value, (int, float)) and self.low <= value <= self.high):
            return -math.inf
        if self.stdDev == 0 or self.low == self.high:
            return 0.0 if value == (self.mean if self.stdDev == 0 else self.low) else -math.inf
        least, most = self.tails
        if least == most:
            return -math.log(self.high - self.low)
        return Normal(self.mean, self.stdDev).log_density(value) - most - math.log(-math.expm1(least - most))

    def support(self) -> Support | None:
        if self.stdDev == 0 or self.low == self.high:
            return ((self.mean if self.stdDev == 0 else self.low, Fraction(1)),)
        return None


def _check_std(distribution: str, stdDev: float) -> None:
    if stdDev < 0:
        raise BadParameters(distribution, "stdDev", f"must not be negative, but it is {stdDev}")


def _log_ndtr(z: float) -> float:
    return plain_float(special.log_ndtr(z))


@dataclass(frozen=True)
class Uniform(Named):
    """Equally likely positions of a list: a value that stands twice in it is twice as likely."""

    values: tuple[object, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", tuple(self.values))
        if not self.values:
            raise NoValues(self.name, "values", "must not be empty")

    def sample(self, uniform: Numbers) -> object:
        return pick(self.values, uniform() * len(self.values))

    def log_density(self, value: object) -> float:
        count = sum(1 for entry in self.values if _same(entry, value))
        return math.log(count / len(self.values)) if count else -math.inf

    def support(self) -> Support:
        return tuple((value, Fraction(1, len(self.values))) for value in self.values)


@dataclass(frozen=True)
class Discrete(Named):
    """Values with probabilities in proportion to their weights, given as pairs (value, weight)."""

    weighted: tuple[tuple[object, float | Fraction], ...]

    def __post_init__(self) -> None:
        pairs = tuple((value, weight) for value, weight in self.weighted)
        object.__setattr__(self, "weighted", pairs)
        for number, (value, weight) in enumerate(pairs):
            if not (isinstance(weight, (int, float, Fraction)) and math.isfinite(weight)):
                reason = f"of {value!r} must be a finite number, not {weight!r}"
                raise BadParameters(self.name, "weight", reason, number)
            if weight < 0:
                reason = f"of {value!r} must not be negative, but it is {weight}"
                raise BadParameters(self.name, "weight", reason, number)
        if not pairs:
            raise NoValues(self.name, "weights", "must not be empty")
        if not any(weight > 0 for _, weight in pairs):
            raise BadParameters(self.name, "weights", "must not all be 0")

    @cached_property
    def choices(self) -> tuple[object, ...]:
        """The values, in order."""
        return tuple(value for value, _ in self.weighted)

    @cached_property
    def thresholds(self) -> list[float]:
        """The cumulative probabilities: position k is chosen by the numbers from thresholds[k - 1] up to thresholds[k]."""
        weights = [weight for _, weight in self.weighted]
        sums = list(accumulate(weights))
        if sums[-1] == math.inf:
            largest = max(weights)
            sums = list(accumulate(weight / largest for weight in weights))
        return [float(part / sums[-1]) for part in sums]

    def sample(self, uniform: Numbers) -> object:
        return pick(self.choices, search(self.thresholds, uniform()))

    def log_density(self, value: object) -> float:
        probability = sum(share for entry, share in self.support() if _same(entry, value))
        return math.log(probability) if probability else -math.inf

    def support(self) -> Support:
        weights = [exact(weight) for _, weight in self.weighted]
        total = sum(weights)
        return tuple((value, weight / total) for (value, _), weight in zip(self.weighted, weights, strict=True) if weight)


@dataclass(frozen=True)
class Coin(Named):
    """True with the given probability (of a soft requirement, say), else False."""

    probability: float | Fraction

    def __post_init__(self) -> None:
        if not isinstance(self.probability, (int, float, Fraction)):
            raise BadParameters(self.name, "probability", f"must be a number, not {self.probability!r}")
        if not 0 <= self.probability <= 1:
            raise BadParameters(self.name, "probability", f"must be from 0 to 1, but it is {self.probability}")

    def sample(self, uniform: Numbers) -> bool:
        return uniform() < float(self.probability)

    def log_density(self, value: object) -> float:
        share = self.probability if value is True else 1 - self.probability if value is False else 0
        return math.log(share) if share else -math.inf

    def support(self) -> Support:
        true = exact(self.probability)
        return tuple((value, share) for value, share in ((True, true), (False, 1 - true)) if share)


def _same(entry: object, value: object) -> bool:
    """Whether the two are one value: identical, or equal in Python's sense."""
    return entry is value or bool(entry == value)


@dataclass(frozen=True)
class PointIn(Named):
    """uniformPointIn(R): uniform by area, length or number of points, as the region's dimension says."""

    region: Region

    @property
    def name(self) -> str:
        return "uniformPointIn"

    def sample(self, uniform: Numbers) -> Vector:
        """A point of the region; raises `EmptyRegion` or `UnboundedRegion` if there is none."""
        return self.region.sample(uniform)

    def log_density(self, value: object) -> float:
        measure = self.region.measure()
        if measure is None:
            raise UnboundedRegion(self.region)
        return -math.log(measure) if measure and isinstance(value, Vector) and self.region.contains_point(value) else -math.inf

    def support(self) -> Support | None:
        if self.region.dimension:
            return None
        points = tuple(self.region.points())
        return tuple((point, Fraction(1, len(points))) for point in points) or None

