"""Closed intervals of numbers, and of angles on the circle: bounds of what a program computes."""

from __future__ import annotations

import math
from typing import NamedTuple

TAU = 2 * math.pi
SLACK = 1e-9
"""Radians by which an angle may be off by rounding."""


class Interval(NamedTuple):
    """The numbers from `low` to `high`; either may be infinite."""

    low: float
    high: float

    def __add__(self, other: object) -> Interval:
        assert isinstance(other, Interval)
        return Interval(self.low + other.low, self.high + other.high)

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def times(self, other: Interval) -> Interval:
        """All products."""
        products = [x * y for x in self for y in other]
        return Interval(min(products), max(products)) if all(map(math.isfinite, products)) else ALL

    def meets(self, other: Interval) -> bool:
        """Whether the two share a number."""
        return self.low <= other.high and other.low <= self.high

    def common(self, other: Interval) -> Interval:
        """The numbers in both; empty if `low` > `high`."""
        return Interval(max(self.low, other.low), min(self.high, other.high))

    @property
    def largest(self) -> float:
        """The largest absolute value."""
        return max(abs(self.low), abs(self.high))

    @property
    def smallest(self) -> float:
        """The smallest absolute value."""
        return 0.0 if self.low <= 0 <= self.high else min(abs(self.low), abs(self.high))

    @property
    def bounded(self) -> bool:
        """Whether both ends are finite."""
        return math.isfinite(self.low) and math.isfinite(self.high)


ALL = Interval(-math.inf, math.inf)
ZERO = Interval(0.0, 0.0)


def angles_meet(angle: float, spread: float, allowed: Interval, turn: float = TAU) -> bool:
    """Whether [angle - spread, angle + spread] meets `allowed`, for angles that are equal if they differ by a multiple of `turn`.

    An infinite `turn` compares numbers as they are. `allowed` may begin and end anywhere, say at 170 and 190 degrees.
    """
    spread += SLACK
    if not math.isfinite(turn):
        return Interval(angle - spread, angle + spread).meets(allowed)
    if allowed.high < allowed.low:
        return False
    if not allowed.bounded or allowed.high - allowed.low + 2 * spread >= turn:
        return True
    return (angle + spread - allowed.low) % turn <= allowed.high - allowed.low + 2 * spread
