"""Facts about a program's scenes before any is drawn: constants, supports, and features that its own text
suggests.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Protocol, runtime_checkable

import numpy as np

from .betting import Array
from .scene_columns import ABSENT, FeatureTable, comparable_text


@dataclass(frozen=True)
class Support:
    """A bound on a feature: numbers in [low, high] and, with `values`, only these (numbers or texts).

    `scale` is the size of the numbers that it was computed from: their rounding is its error.
    """

    low: float = -math.inf
    high: float = math.inf
    values: tuple[object, ...] | None = None
    scale: float = 1.0

    def outside(self, column: Array, tolerance: float) -> Array:
        """Return a mask of the values outside the support; NaN is judged elsewhere. `tolerance` is relative,
        from 1 on.
        """
        if self.values is not None:
            return ~np.any([equal(column, v, tolerance) for v in self.values], axis=0) & ~missing_mask(column)
        if column.dtype != np.float64:
            return np.ones(len(column), dtype=bool)
        return (column < self.low - slack(self.low, tolerance, self.scale)) | (column > self.high + slack(self.high, tolerance, self.scale))

    def __str__(self) -> str:
        if self.values is not None:
            return "one of " + ", ".join(f"{v:.9g}" if isinstance(v, float) else str(v) for v in self.values[:6])
        if math.isinf(self.high):
            return f"at least {self.low:.9g}"
        return f"between {self.low:.9g} and {self.high:.9g}"


def slack(bound: float, tolerance: float, scale: float = 1.0) -> float:
    """How far a number may be from a bound and be the bound, rounded."""
    return tolerance * max(scale, abs(bound)) if math.isfinite(bound) else 0.0


def missing_mask(column: Array) -> Array:
    """Return a mask of the rows in which a column has no number, or no value at all."""
    return np.isnan(column) if column.dtype == np.float64 else column == ABSENT


def equal(column: Array, value: object, tolerance: float, *, angle: bool = False) -> Array:
    """Return a mask of the rows in which a column equals `value`, up to the tolerance (and whole turns)."""
    if column.dtype == np.float64 and isinstance(value, (int, float)) and not isinstance(value, bool):
        with np.errstate(invalid="ignore"):
            off = np.abs(column - value)
            off = np.minimum(off % math.tau, math.tau - off % math.tau) if angle else off
        return off <= slack(float(value), tolerance)
    return column == comparable_text(value) if column.dtype != np.float64 else np.zeros(len(column), dtype=bool)


Derived = Callable[[FeatureTable], Mapping[str, Array]]
"""Features that follow from others, each a function of the columns of a table: none where these are missing."""


def no_derived_features(table: FeatureTable) -> Mapping[str, Array]:
    """Return no derived features."""
    return {}


@dataclass(frozen=True)
class Facts:
    """Facts about a program's scenes: features that no draw changes, the supports of others (derived ones as
    well), derived features.
    """

    constants: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    supports: Mapping[str, Support] = field(default_factory=lambda: MappingProxyType({}))
    derived: Derived = no_derived_features

    def without(self, ignored: Callable[[str], bool]) -> Facts:
        """Return the facts without some features."""
        constants = {name: value for name, value in self.constants.items() if not ignored(name)}
        return replace(self, constants=constants, supports={name: s for name, s in self.supports.items() if not ignored(name)})


@runtime_checkable
class WithFacts(Protocol):
    """Something of whose scenes facts are known, such as a scenario."""

    @property
    def facts(self) -> Facts:
        """The facts about the program's scenes."""
        ...
