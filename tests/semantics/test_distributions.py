"""The paper's distributions: inverse distribution functions, densities, exact supports, and refused parameters.

The samples are those of fixed seeds, so a passing test stays passing; for a fresh seed each statistical test raises a false alarm with
probability at most `DEFAULT_ALPHA`, and its rival must be contradicted by the same samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenic_ref import loads
from scenic_ref.inference.comparison import Continuous, contradicts
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import generate_scene
from scenic_ref.interpreter.runtime.random_streams import Stream
from scenic_ref.interpreter.runtime.trace import log_density_of
from scenic_ref.semantics.machine.outcome import Draw
from scenic_ref.semantics.space.distributions import (
    BadParameters,
    Coin,
    Discrete,
    Distribution,
    Normal,
    PointIn,
    Range,
    TruncatedNormal,
    Uniform,
)
from scenic_ref.semantics.space.regions import CircularRegion, PointSetRegion, RectangularRegion, UnboundedRegion, everywhere
from scenic_ref.semantics.space.vectors import Vector
from scipy import integrate, stats

COUNT = 20_000
INFINITY = math.inf


def at(number: float) -> Callable[[], float]:
    return lambda: number


def values(distribution: Distribution, seed: int) -> list:
    numbers = Stream(seed, 0, 0).at((1,))
    return [distribution.sample(numbers) for _ in range(COUNT)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("distribution", "cdf", "rival"),
    [
        (Range(-2, 3), stats.uniform(-2, 5).cdf, stats.uniform(-2, 5.3).cdf),
        (Normal(1, 2), stats.norm(1, 2).cdf, stats.norm(1, 2.3).cdf),
        (TruncatedNormal(1, 2, 0, 4), stats.truncnorm(-0.5, 1.5, 1, 2).cdf, stats.norm(1, 2).cdf),
        (TruncatedNormal(0, 1, 9, 10), stats.truncnorm(9, 10).cdf, stats.truncnorm(8.9, 10).cdf),
        (TruncatedNormal(0, 1, -10, -9), stats.truncnorm(-10, -9).cdf, stats.uniform(-10, 1).cdf),
    ],
)
def test_samples_follow_the_distribution_function(distribution: Distribution, cdf: Callable, rival: Callable) -> None:
    """The rival is a slightly different distribution."""
    sample = values(distribution, 11)
    law, other = (dict(zip(sample, levels(np.array(sample)), strict=True)) for levels in (cdf, rival))  # scipy is quick with arrays only
    assert not contradicts(sample, Continuous("law", law.__getitem__))
    assert contradicts(sample, Continuous("rival", other.__getitem__))


@pytest.mark.parametrize(
    "distribution",
    [Range(-2, 3), Normal(1, 2), TruncatedNormal(1, 2, 0, 4), TruncatedNormal(0, 1, 9, 10), TruncatedNormal(0, 1, -INFINITY, -3)],
)
def test_densities_are_the_derivatives_of_the_distribution_functions(distribution: Distribution) -> None:
    """By the inverse: between the values at u and at u', the density integrates to u' - u."""
    marks = [0.01, 0.2, 0.5, 0.8, 0.999]
    points = [float(distribution.sample(at(u))) for u in marks]  # pyright: ignore[reportArgumentType]
    for (u, v), (a, b) in zip(pairwise(marks), pairwise(points), strict=True):
        area, _ = integrate.quad(lambda x: math.exp(distribution.log_density(x)), a, b)
        assert area == pytest.approx(v - u, rel=1e-8)


@given(st.floats(0, 1, exclude_max=True), st.floats(0, 1, exclude_max=True), st.floats(-45, 45), st.floats(0, 20))
def test_truncated_normals_are_monotone_and_within_their_limits(u: float, v: float, low: float, width: float) -> None:
    distribution = TruncatedNormal(0, 1, low, low + width)
    first, second = (distribution.sample(at(min(number, 1 - 2**-53))) for number in sorted((u, v)))
    assert low <= first <= second <= low + width


def test_truncated_normal_far_in_the_tail_matches_its_asymptotic_law() -> None:
    """Beyond 40 standard deviations the excess is nearly exponential: z² = 40² - 2 log(1 - u), up to terms in 1/40²."""
    for u in (0.1, 0.5, 0.9):
        z = TruncatedNormal(0, 1, 40, INFINITY).sample(at(u))
        assert z == pytest.approx(math.sqrt(1600 - 2 * math.log(1 - u)), rel=1e-5)
        assert TruncatedNormal(0, 1, -INFINITY, -40).sample(at(1 - u)) == pytest.approx(-z, rel=1e-12)
    assert TruncatedNormal(0, 1, 40, 41).log_density(40) == pytest.approx(math.log(40), rel=1e-3)
    assert TruncatedNormal(0, 1, 40, 41).log_density(39.9) == -INFINITY


def test_normals_are_finite_at_the_ends_of_the_numbers() -> None:
    for number in (0.0, 2.0**-53, 1 - 2.0**-53):
        assert math.isfinite(Normal(0, 1).sample(at(number)))
        assert math.isfinite(TruncatedNormal(0, 1, -INFINITY, INFINITY).sample(at(number)))
        assert math.isfinite(TruncatedNormal(0, 1, -INFINITY, -40).sample(at(number)))
    assert Normal(0, 1).sample(at(0.5)) == 0


@pytest.mark.parametrize("distribution", [Normal(3, 0), Range(3, 3), TruncatedNormal(3, 0, 1, 4), TruncatedNormal(0, 1, 3, 3)])
def test_zero_width_is_a_point_mass(distribution: Distribution) -> None:
    assert distribution.support() == ((3, Fraction(1)),)
    assert [distribution.sample(at(number)) for number in (0.0, 0.3, 0.999)] == [3, 3, 3]
    assert (distribution.log_density(3), distribution.log_density(3.1)) == (0, -INFINITY)


def test_uniform_weighs_positions_equally() -> None:
    distribution = Uniform(("a", "b", "b"))
    assert distribution.support() == (("a", Fraction(1, 3)), ("b", Fraction(1, 3)), ("b", Fraction(1, 3)))
    assert distribution.log_density("b") == pytest.approx(math.log(2 / 3))
    assert distribution.log_density("c") == -INFINITY
    assert [distribution.sample(at(number)) for number in (0.0, 0.33, 0.34, 1 - 2**-53)] == ["a", "a", "b", "b"]


def test_discrete_is_proportional_to_the_weights() -> None:
    distribution = Discrete((("never", 0), ("a", 1), ("b", 3), ("never", 0)))
    assert distribution.support() == (("a", Fraction(1, 4)), ("b", Fraction(3, 4)))
    assert [distribution.sample(at(number)) for number in (0.0, 0.2499, 0.25, 1 - 2**-53)] == ["a", "a", "b", "b"]
    assert distribution.log_density("never") == -INFINITY


@given(st.lists(st.floats(0, 1e6), min_size=1, max_size=6).filter(any))
def test_probabilities_of_discrete_add_up_to_one_exactly(weights: list[float]) -> None:
    support = Discrete(tuple(enumerate(weights))).support()
    assert sum(share for _, share in support) == 1
    assert [value for value, _ in support] == [number for number, weight in enumerate(weights) if weight]


def test_values_need_not_be_hashable() -> None:
    assert Discrete((([1], 1), ([2], 1))).log_density([2]) == pytest.approx(math.log(0.5))


@pytest.mark.parametrize(
    ("probability", "support"), [(0.25, ((True, Fraction(1, 4)), (False, Fraction(3, 4)))), (1, ((True, 1),)), (0, ((False, 1),))]
)
def test_a_coin_shows_true_with_its_probability(probability: float, support: tuple) -> None:
    coin = Coin(probability)
    assert coin.support() == support
    assert coin.sample(at(0.2)) is (probability > 0.2)
    assert math.exp(coin.log_density(True)) == probability


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Range(2, 1), "Range: low is 2.0, which is above high = 1.0"),
        (lambda: Range(math.nan, 1), "Range: low must be a finite number"),
        (lambda: Range(0, INFINITY), "Range: high must be a finite number"),
        (lambda: Range("a", 1), "Range: low must be a number, not 'a'"),  # pyright: ignore[reportArgumentType]
        (lambda: Normal(0, -1), "Normal: stdDev must not be negative"),
        (lambda: Normal(0, math.nan), "Normal: stdDev must be a finite number"),
        (lambda: TruncatedNormal(0, 1, 3, 2), "TruncatedNormal: low is 3.0"),
        (lambda: TruncatedNormal(0, 0, 3, 4), "TruncatedNormal: stdDev is 0, but the mean"),
        (lambda: TruncatedNormal(0, 1, INFINITY, INFINITY), "TruncatedNormal: low is inf"),
        (lambda: Uniform(()), "Uniform: values must not be empty"),
        (lambda: Discrete(()), "Discrete: weights must not be empty"),
        (lambda: Discrete((("a", 0),)), "Discrete: weights must not all be 0"),
        (lambda: Discrete((("a", -1),)), "Discrete: weight of 'a' must not be negative"),
        (lambda: Discrete((("a", math.nan),)), "Discrete: weight of 'a' must be a finite number"),
        (lambda: Coin(1.5), "Coin: probability must be from 0 to 1"),
        (lambda: Coin(math.nan), "Coin: probability must be from 0 to 1"),
    ],
)
def test_wrong_parameters_are_refused_by_name(make: Callable[[], Distribution], message: str) -> None:
    with pytest.raises(BadParameters) as refused:
        make()
    assert str(refused.value).startswith(message)


def test_the_density_of_a_point_is_one_over_the_measure() -> None:
    assert PointIn(CircularRegion(Vector(0.0, 0.0), 2.0)).log_density(Vector(1.0, 1.0)) == pytest.approx(-math.log(4 * math.pi))
    assert PointIn(RectangularRegion(Vector(0.0, 0.0), 0.0, 2.0, 2.0)).log_density(Vector(1.5, 1.0)) == -INFINITY
    points = PointSetRegion("p", [(0, 0), (1, 0), (0, 0)])
    assert PointIn(points).support() == ((Vector(0.0, 0.0), Fraction(1, 2)), (Vector(1.0, 0.0), Fraction(1, 2)))
    with pytest.raises(UnboundedRegion):
        PointIn(everywhere).sample(at(0.5))


def test_names_and_parameters_are_those_of_the_language() -> None:
    assert (Range(1, 2).name, Range(1, 2).parameters) == ("Range", {"low": 1, "high": 2})
    assert PointIn(everywhere).name == "uniformPointIn"


def test_an_entry_that_is_itself_random_counts_by_its_value() -> None:
    program = "x = Uniform(0, Uniform(0, 0))\nego = Object with v x\n"
    densities: list[float] = []

    def look(outcome: object, drawn: object) -> None:
        if isinstance(outcome, Draw):
            densities.append(log_density_of(outcome.distribution, drawn))

    generate_scene(loads(program).start(), from_stream(0, 0, 0), witness=look)
    assert densities == [0.0, 0.0]


@pytest.mark.parametrize("weights", [(1e308, 1e308), (1e308, 1e308, 1e308, 1.7e308), (10**308, 10**308), (5e-324, 5e-324)])
def test_weights_whose_sum_is_no_number_have_their_shares(weights):
    drawn = Discrete(tuple(enumerate(weights)))
    shares = [w / max(weights) for w in weights]
    expected = [sum(shares[: k + 1]) / sum(shares) for k in range(len(shares))]
    assert drawn.thresholds == pytest.approx(expected)
    assert [drawn.sample(lambda u=u: u) for u in (0.0, 0.999)] == [0, len(weights) - 1]
