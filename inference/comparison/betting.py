"""Betting against a null hypothesis with counts in cells: e-processes in closed form.

Wealth begins at 1 and is multiplied by a bet on every draw. Under the null hypothesis it is a (super)martingale, so that by
Ville's inequality P(it ever reaches 1/α) <= α, however often one looks and whenever one stops. Bets are averaged over priors
(mixtures of martingales are martingales), which makes the wealth a function of the counts alone:

- one sample against probabilities p: a Dirichlet(c p) mixture of ∏ (q / p)^counts;
- two samples, drawn in pairs (a, b): a mixture over r, independent Beta(c, c) in each cell, of ∏ 2 r(a) · 2 (1 - r(b)). For every fixed r a pair
  multiplies it by 4 m (1 - m) <= 1 on average, where m is the mean of r under the common law.

Each is averaged with bets on a single cell, which find a difference that sits in one place without paying for the other cells, and
over concentrations c, from broad priors that find gross differences at once to narrow ones that find small differences soonest.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import betaln, gammaln

CONCENTRATIONS = (0.5, 4.0, 32.0, 256.0, 2048.0, 16384.0, 131072.0)
Array = np.ndarray


def log_sum(logs: Array, axis: int | tuple[int, ...] | None = None) -> Array:
    """log Σ exp(logs), over all axes unless one is given."""
    most = np.max(logs, axis=axis, keepdims=True)
    shift = np.where(np.isfinite(most), most, 0.0)
    with np.errstate(divide="ignore"):
        return np.log(np.sum(np.exp(logs - shift), axis=axis)) + np.squeeze(shift, axis=axis)


def two_sample_wealth(a: Array, b: Array) -> Array:
    """The log wealth after counts `a` and `b` in cells, both (..., cells) with equal totals: shape (...)."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    c = np.array(CONCENTRATIONS).reshape((-1,) + (1,) * a.ndim)
    cells = betaln(c + a, c + b) - betaln(c, c) + (a + b) * math.log(2.0)
    return _average_log_bets(cells.sum(-1), cells, a.shape[-1])


def one_sample_wealth(counts: Array, p: Array) -> Array:
    """The log wealth after `counts` (..., cells) in cells of probabilities `p` (..., cells): shape (...).

    Infinite where a cell of probability 0 was hit.
    """
    counts, p = np.asarray(counts, float), np.asarray(p, float)
    impossible = ((p <= 0) & (counts > 0)).any(-1)
    possible = p > 0
    safe, n = np.where(possible, p, 0.5), np.where(possible, counts, 0.0)
    total = n.sum(-1, keepdims=True)
    cells = np.maximum(possible.sum(-1, keepdims=True), 1)
    c = np.array(CONCENTRATIONS).reshape((-1,) + (1,) * counts.ndim) * cells
    per_cell = np.where(possible, gammaln(c * safe + n) - gammaln(c * safe) - n * np.log(safe), 0.0)
    dense = per_cell.sum(-1) + (gammaln(c) - gammaln(c + total))[..., 0]
    rest = np.clip(1.0 - safe, 1e-300, 1.0)
    single = betaln(c * safe + n, c * rest + total - n) - betaln(c * safe, c * rest) - n * np.log(safe) - (total - n) * np.log(rest)
    single = np.where(possible, np.where(p < 1 - 1e-12, single, 0.0), -np.inf)
    return np.where(impossible, np.inf, _average_log_bets(dense, single, cells[..., 0]))


def _average_log_bets(dense: Array, single: Array, cells: Array | int) -> Array:
    """The log of the average of bets on all cells, (priors, ...), and of those on a single one, (priors, ..., cells).

    The number of cells is that of the feature, whether they were seen or not: an average over a number that grows would not be a martingale.
    """
    both = np.stack([dense, log_sum(single, axis=-1) - np.log(cells)])
    return log_sum(both, axis=(0, 1)) - math.log(2 * len(CONCENTRATIONS))


def average_e_values(wealths: Array) -> float:
    """The log of the average of e-values whose logs are given: an e-value under any dependence between them."""
    flat = np.ravel(wealths)
    return float(log_sum(flat) - math.log(len(flat)))
