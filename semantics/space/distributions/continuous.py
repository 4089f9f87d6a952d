"""Distributions with a density on the line; those of zero width are point masses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from scipy import special

from ..numeric import either, exponential, exponential_less_one, is_finite_number, larger, logarithm, logarithm_of_one_more, plain_float, smaller
from ..regions.sampling import Numbers
from .distribution import LEAST, BadParameters, Named, Support

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
