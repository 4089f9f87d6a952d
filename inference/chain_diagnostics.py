"""Whether chains agree, and how many independent draws they are worth (Vehtari, Gelman, Simpson, Carpenter, Bürkner 2021).

Arrays are (chains, draws). Quantities that do not vary have R-hat 1 and as many effective draws as there are draws.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import special


class Diagnosis(NamedTuple):
    """The worst values over all features: the largest R-hat, the fewest effective draws for means and for the 5 % and 95 % quantiles."""

    rhat: float
    bulk: float
    tail: float
    worst: int
    """The feature with the largest R-hat."""


def diagnose(features: np.ndarray) -> Diagnosis:
    """Of features over chains, (features, chains, draws)."""
    rhats = [rhat(f) for f in features]
    worst = int(np.argmax(rhats)) if rhats else 0
    most = float(np.prod(features.shape[1:]))
    return Diagnosis(max(rhats, default=1.0), min(map(bulk_ess, features), default=most), min(map(tail_ess, features), default=most), worst)


def rhat(draws: np.ndarray) -> float:
    """The larger of the rank-normalised split R-hat of the draws and of their distances from the median."""
    halves = split_chains(draws)
    if varies_not(halves):
        return 1.0
    folded = np.abs(halves - np.median(halves))
    return max(plain_rhat(rank_normalised(halves)), 1.0 if varies_not(folded) else plain_rhat(rank_normalised(folded)))


def bulk_ess(draws: np.ndarray) -> float:
    """How many independent draws would tell as much about the mean."""
    halves = split_chains(draws)
    return float(halves.size) if varies_not(halves) else plain_ess(rank_normalised(halves))


def tail_ess(draws: np.ndarray) -> float:
    """Return the effective sample size of the 5 % and the 95 % quantile, whichever is smaller."""
    halves = split_chains(draws)
    below = [(halves <= np.quantile(draws, share)).astype(float) for share in (0.05, 0.95)]
    return min(float(b.size) if varies_not(b) else plain_ess(b) for b in below)


def split_chains(draws: np.ndarray) -> np.ndarray:
    """Each chain as two, (2 chains, draws / 2)."""
    half = draws.shape[1] // 2
    return np.concatenate([draws[:, :half], draws[:, draws.shape[1] - half :]])


def varies_not(draws: np.ndarray) -> bool:
    """Whether all draws are equal, or there are too few."""
    return draws.shape[1] < 2 or bool((draws == draws.flat[0]).all())


def rank_normalised(draws: np.ndarray) -> np.ndarray:
    """The normal quantiles of the ranks among all draws; equal ones share their mean rank."""
    from scipy.stats import rankdata  # with all of SciPy's statistics, which take long to import

    ranks = rankdata(draws, method="average").reshape(draws.shape)
    return special.ndtri((ranks - 0.375) / (draws.size + 0.25))


def plain_rhat(draws: np.ndarray) -> float:
    """The square root of the variance of all draws over that within chains."""
    count = draws.shape[1]
    within = draws.var(axis=1, ddof=1).mean()
    between = draws.mean(axis=1).var(ddof=1) if len(draws) > 1 else 0.0
    return float(np.sqrt((count - 1) / count + between / within)) if within > 0 else np.inf


def plain_ess(draws: np.ndarray) -> float:
    """The number of draws over the sum of their autocorrelations: in pairs that are positive and do not grow (Geyer), and half of the next if it is
    positive.
    """
    chains, count = draws.shape
    covariances = autocovariances(draws)
    within = covariances[:, 0].mean() * count / (count - 1)
    total = within * (count - 1) / count + (draws.mean(axis=1).var(ddof=1) if chains > 1 else 0.0)
    if total <= 0:
        return float(draws.size)
    correlations = 1 - (within - covariances.mean(axis=0)) / total
    correlations[0] = 1.0
    pairs = correlations[: count - count % 2].reshape(-1, 2).sum(axis=1)
    negative = np.flatnonzero(pairs[1:] < 0) + 1
    end = int(negative[0]) if len(negative) else len(pairs) - 1
    length = -1 + 2 * np.minimum.accumulate(pairs[:end]).sum() + max(float(correlations[2 * end]), 0.0)
    return float(draws.size / max(length, 1 / np.log10(max(draws.size, 10))))


def autocovariances(draws: np.ndarray) -> np.ndarray:
    """Return each chain's autocovariances at every lag, (chains, draws), by the fast Fourier transform."""
    count = draws.shape[1]
    centred = draws - draws.mean(axis=1, keepdims=True)
    spectrum = np.fft.rfft(centred, 2 * count, axis=1)
    return np.fft.irfft(spectrum * np.conj(spectrum), axis=1)[:, :count] / count


def diagnose_repetitions(features: np.ndarray) -> Diagnosis:
    """Of independent repetitions with many draws each, (features, repetitions, draws): the variance of their means tells what they are worth."""
    repetitions, draws = features.shape[1:]

    def over(values: np.ndarray) -> tuple[float, float]:
        within, between = values.var(axis=1, ddof=1).mean(), values.mean(axis=1).var(ddof=1)
        if within == 0:
            return (1.0, float(values.size)) if between == 0 else (np.inf, 0.0)
        return float(np.sqrt(1 + between / within)), min(repetitions * within / between if between > 0 else np.inf, float(repetitions * draws))

    means = [over(f) for f in features]
    tails: list[Callable[[np.ndarray], np.ndarray]] = [lambda f, s=share: (f <= np.quantile(f, s)).astype(float) for share in (0.05, 0.95)]
    quantiles = [over(tail(f))[1] for f in features for tail in tails]
    rhats = [r for r, _ in means]
    most = float(repetitions * draws)
    worst = int(np.argmax(rhats)) if rhats else 0
    return Diagnosis(max(rhats, default=1.0), min((e for _, e in means), default=most), min(quantiles, default=most), worst)
