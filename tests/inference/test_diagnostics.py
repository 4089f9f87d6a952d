"""How many draws correlated ones are worth, and whether chains agree: known laws, and another implementation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenic_ref.inference import chain_diagnostics


def autoregressive(chains: int, draws: int, by: float, seed: int) -> np.ndarray:
    random = np.random.Generator(np.random.Philox(seed))
    found = np.empty((chains, draws))
    found[:, 0] = random.standard_normal(chains)
    for t in range(1, draws):
        found[:, t] = by * found[:, t - 1] + math.sqrt(1 - by * by) * random.standard_normal(chains)
    return found


@pytest.mark.parametrize("by", [-0.5, 0.0, 0.5, 0.9])
def test_effective_draws_of_autoregressive_chains(by: float) -> None:
    """The effective number of draws of such chains is (1 - by) / (1 + by) of their number."""
    draws = autoregressive(16, 4_000, by, 1)
    assert chain_diagnostics.bulk_ess(draws) / draws.size == pytest.approx((1 - by) / (1 + by), rel=0.15)
    assert chain_diagnostics.rhat(draws) == pytest.approx(1.0, abs=0.005)
    assert 0.2 < chain_diagnostics.tail_ess(draws) / chain_diagnostics.bulk_ess(draws) < 3


@pytest.mark.slow
@pytest.mark.extra("arviz")
def test_diagnostics_are_those_of_arviz() -> None:
    import arviz

    found = []
    for seed in range(60):
        random = np.random.Generator(np.random.Philox([9, seed]))
        draws = autoregressive(int(random.integers(2, 20)), int(random.integers(50, 300)), random.uniform(-0.6, 0.95), seed)
        assert chain_diagnostics.rhat(draws) == pytest.approx(float(arviz.rhat(draws)), rel=1e-12)
        found.append(chain_diagnostics.bulk_ess(draws) / float(arviz.ess(draws, method="bulk")))
        found.append(chain_diagnostics.tail_ess(draws) / float(arviz.ess(draws, method="tail")))
    assert 0.9 < min(found) <= max(found) < 1.1  # the last pair of correlations is treated otherwise in very short chains
    assert sum(abs(ratio - 1) < 1e-9 for ratio in found) > 0.9 * len(found)


def test_chains_in_different_places_or_of_different_spread_do_not_agree() -> None:
    draws = autoregressive(4, 500, 0.0, 2)
    assert chain_diagnostics.rhat(draws + 2 * np.arange(4)[:, None]) > 1.5
    assert chain_diagnostics.rhat(draws * np.array([[1.0], [1.0], [1.0], [4.0]])) > 1.1
    assert chain_diagnostics.rhat(np.ones((4, 10))) == 1.0
    found = chain_diagnostics.diagnose(np.stack([draws, draws + np.arange(4)[:, None]]))
    assert found.worst == 1
    assert found.rhat > 1.1
    assert found.bulk < 100 < chain_diagnostics.bulk_ess(draws)


def test_independent_populations_are_worth_what_their_means_tell() -> None:
    draws = np.random.Generator(np.random.Philox(3)).standard_normal((1, 40, 1_000))
    assert chain_diagnostics.diagnose_repetitions(draws).rhat < 1.001
    shifted = draws + np.random.Generator(np.random.Philox(4)).standard_normal((1, 40, 1)) * 0.5
    assert chain_diagnostics.diagnose_repetitions(shifted).bulk == pytest.approx(40 / 0.25, rel=0.6)
    assert chain_diagnostics.diagnose_repetitions(shifted).rhat > 1.08
    assert chain_diagnostics.diagnose_repetitions(np.ones((1, 4, 10))) == (1.0, 40.0, 40.0, 0)
