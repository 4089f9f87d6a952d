"""How many scenes a comparison needs: the power that a verdict states.

Of all differences of total variation ε in the cells of a feature, the one that is spread evenly over the cells is the hardest to
see: a pair of draws then multiplies the wealth of the best bet by exp(ε²) on average (to second order; see the proof in
the documentation), and any other by more. The wealth that the mixture reaches is computed at the expected counts, and `QUANTILE` standard deviations
are taken off for chance.
"""

from __future__ import annotations

import math

import numpy as np

from .betting import one_sample_wealth, two_sample_wealth

QUANTILE = 2.3263478740408408  # of the standard normal, at 0.99
MOST = 1 << 40


def wealth_after(n: int, tv: float, cells: int, *, exact: bool) -> float:
    """The log wealth that is exceeded with probability 0.99 after `n` draws of each side that differ by `tv`, evenly, in `cells` cells."""
    cells = max(2, cells)
    sign = np.where(np.arange(cells) % 2 == 0, 1.0, -1.0)
    if cells % 2:
        sign[-1] = 0.0
    tilt = tv * cells / np.abs(sign).sum() * sign / cells
    if exact:
        p = np.full(cells, 1.0 / cells)
        return float(one_sample_wealth(n * (p + 2 * tilt).clip(0), p)) - QUANTILE * 2 * tv * math.sqrt(n)
    a, b = n * (1.0 / cells + tilt), n * (1.0 / cells - tilt)
    return float(two_sample_wealth(a.clip(0), b.clip(0))) - QUANTILE * tv * math.sqrt(2 * n)


def needed(tv: float, alpha: float, features: int, cells: int, *, exact: bool) -> int:
    """The number of draws of each side after which a difference of `tv` in any one of `features` is found with probability 0.99."""
    threshold = math.log(max(1, features)) - math.log(alpha)
    low, high = 1, 2
    while high < MOST and wealth_after(high, tv, cells, exact=exact) < threshold:
        low, high = high, 2 * high
    while high - low > max(1, low // 100):
        middle = (low + high) // 2
        low, high = (low, middle) if wealth_after(middle, tv, cells, exact=exact) >= threshold else (middle, high)
    return high


def detectable(n: int, alpha: float, features: int, cells: int, *, exact: bool) -> float:
    """The least total variation that `n` draws of each side would have shown; 1 if they would not have shown any."""
    threshold = math.log(max(1, features)) - math.log(alpha)
    low, high = 0.0, 0.5 if exact else 1.0
    if n < 1 or wealth_after(n, high, cells, exact=exact) < threshold:
        return 1.0
    while high - low > 1e-4 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if wealth_after(n, middle, cells, exact=exact) >= threshold else (middle, high)
    return high
