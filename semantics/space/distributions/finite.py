"""Distributions on finitely many values, with exact rational probabilities."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import accumulate

from ..numeric import pick, search
from ..regions.sampling import Numbers
from .distribution import BadParameters, Named, NoValues, Support, exact


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
