"""How samples were rounded: both sides of a comparison are rounded in the same way, so that a format with few digits makes no difference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .betting import Array
from .scene_columns import FeatureTable

DEFAULT_TOLERANCE = 5e-6
"""Half a unit in the sixth significant digit of a number, at the worst (of 1.00000): what `%g` or `%.6f` do to one, and float32 does not reach."""


@dataclass(frozen=True)
class Rounding:
    """How the numbers of a feature were rounded: to float32, to `digits` decimals, or to `digits` significant ones; None: not at all."""

    kind: str
    digits: int = 0

    @property
    def error(self) -> float:
        """The most that it changes a number, relative from 1 on."""
        return 2.0**-24 if self.kind == "float32" else (0.5 if self.kind == "decimals" else 5.0) * 10.0**-self.digits

    def __call__(self, values: Array) -> Array:
        """The numbers, rounded so."""
        with np.errstate(all="ignore"):
            if self.kind == "float32":
                return values.astype(np.float32).astype(np.float64)
            if self.kind == "decimals":
                return np.round(values, self.digits)
            scale = 10.0 ** (self.digits - 1 - np.floor(np.log10(np.abs(np.where(values == 0, 1.0, values)))))
            return np.where(np.isfinite(values) & np.isfinite(scale), np.round(values * scale) / scale, values)

    def keeps(self, values: Array) -> bool:
        """Whether the numbers are rounded so already, up to the last bits of a double."""
        known = values[np.isfinite(values)]
        return bool(np.all(np.abs(self(known) - known) <= 1e-14 * np.abs(known)))


ROUNDINGS = sorted(
    [Rounding("float32"), *(Rounding(kind, digits) for kind in ("decimals", "significant") for digits in range(3, 12))], key=lambda r: -r.error
)
"""Coarsest first."""


def roundings_of(a: FeatureTable, b: FeatureTable | None, tolerance: float) -> dict[str, Rounding]:
    """How the numbers of each feature were rounded, on the side where that was more coarsely: at most by the tolerance.

    Both sides are then rounded in this way before they are compared. The scenes that show it are used for nothing else.
    """
    allowed = [r for r in ROUNDINGS if r.error <= tolerance * (1 + 1e-9)]
    found: dict[str, Rounding] = {}
    for name, values in a.arrays.items():
        if values.dtype != np.float64 or name == "attempts":
            continue
        columns = [values] + ([b.arrays[name]] if b is not None and name in b.arrays and b.arrays[name].dtype == np.float64 else [])
        kept = next((r for r in allowed if any(r.keeps(column) for column in columns)), None)
        if kept is not None:
            found[name] = kept
    return found


def round_table(table: FeatureTable, roundings: Mapping[str, Rounding]) -> FeatureTable:
    """The table with its numbers rounded."""
    changed = {name: r(table.arrays[name]) for name, r in roundings.items() if name in table.arrays and table.arrays[name].dtype == np.float64}
    return FeatureTable({**table.arrays, **changed}, table.n, table.numbers)
