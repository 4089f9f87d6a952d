"""Sampled scenes against distribution functions in closed form.

Each test compares n samples with the exact distribution function by the Dvoretzky-Kiefer-Wolfowitz inequality (Massart's
constant), false-alarm rate 1e-9, and asserts that a named rival would be rejected with the same n.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
import scenic_ref
from scipy.stats import norm

ALPHA = 1e-9
N = 4000
BOUND = math.sqrt(math.log(2 / ALPHA) / (2 * N))

Cdf = Callable[[float], float]


def largest_gap(values: list[float], cdf: Cdf) -> float:
    """The largest distance between the empirical and the given distribution function."""
    n = len(values)
    return max(max(cdf(v) - i / n, (i + 1) / n - cdf(v)) for i, v in enumerate(sorted(values)))


def distance_between(one: Cdf, other: Cdf, low: float, high: float) -> float:
    """The largest distance between two distribution functions, on a grid."""
    return max(abs(one(x) - other(x)) for x in (low + (high - low) * i / 2000 for i in range(2001)))


def samples(text: str, read: Callable[[scenic_ref.Scene], float]) -> list[float]:
    scenario = scenic_ref.loads(text)
    return [read(scene) for scene in scenario.sample_many(N, seed=7)]


def clip(x: float) -> float:
    return min(max(x, 0.0), 1.0)


CASES = {
    "the noise of mutate by 2 has twice the standard deviation": (
        "ego = Object at (5, 0), with positionStdDev 0.5\nmutate ego by 2\n", lambda s: s.ego.position.x - 5,
        norm(0, 1).cdf, norm(0, 0.5).cdf, (-4, 4),
    ),
    "the noise on the heading has standard deviation 5 degrees": (
        "ego = Object\nmutate\n", lambda s: math.degrees(s.ego.heading), norm(0, 5).cdf, norm(0, 1).cdf, (-20, 20),
    ),
    "x is uniform above one half": (
        "x = Range(0, 1)\nrequire x > 0.5\nego = Object with v x\n", lambda s: s.ego["v"], lambda x: clip(2 * x - 1), clip, (0, 1),
    ),
    "a point in a disc is uniform by area": (
        "ego = Object in CircularRegion((0, 0), 2)\n", lambda s: math.hypot(s.ego.position.x, s.ego.position.y),
        lambda r: clip(r * r / 4), lambda r: clip(r / 2), (0, 2),
    ),
    "visible is uniform in the view sector": (
        "ego = Object with viewAngle 90 deg, with viewDistance 2\no = Object visible, with allowCollisions True\n",
        lambda s: math.atan2(-s.objects[1].position.x, s.objects[1].position.y),
        lambda a: clip((a + math.pi / 4) / (math.pi / 2)), lambda a: clip((a + math.pi) / math.tau), (-math.pi, math.pi),
    ),
    "the sum of x and resample(x) is triangular": (
        "x = Range(0, 1)\nego = Object with v x + resample(x)\n", lambda s: s.ego["v"],
        lambda t: t * t / 2 if t < 1 else 1 - (2 - t) ** 2 / 2, lambda t: clip(t / 2), (0, 2),
    ),
    "x + x is uniform on (0, 2)": (
        "x = Range(0, 1)\nego = Object with v x + x\n", lambda s: s.ego["v"], lambda t: clip(t / 2),
        lambda t: t * t / 2 if t < 1 else 1 - (2 - t) ** 2 / 2, (0, 2),
    ),
    "a default value is drawn anew for every object": (
        "class A:\n    w: Range(0, 1)\nego = A\nb = A at (3, 0)\nego.d = abs(ego.w - b.w)\n", lambda s: s.ego["d"], lambda t: clip(2 * t - t * t),
        lambda t: 1.0 if t > 0 else 0.0, (0, 1),
    ),
    "a position on a curve is uniform by length": (
        "ego = Object on PolylineRegion([(0, 0), (1, 0), (1, 3)])\n", lambda s: s.ego.position.x + s.ego.position.y, lambda t: clip(t / 4),
        lambda t: clip(t / 2) if t < 1 else clip(0.5 + (t - 1) / 6), (0, 4),
    ),
    "overlapping polygons count once": (
        "r = RectangularRegion((1, 0), 0, 2, 1).union(RectangularRegion((2, 0), 0, 4, 1))\nego = Object in r\n", lambda s: s.ego.position.x,
        lambda t: clip(t / 4), lambda t: clip(t / 3) if t < 2 else clip(2 / 3 + (t - 2) / 6), (0, 4),
    ),
    "a truncated normal keeps to its window": (
        "ego = Object with v TruncatedNormal(0, 1, 1, 3)\n", lambda s: s.ego["v"],
        lambda t: clip((norm.cdf(t) - norm.cdf(1)) / (norm.cdf(3) - norm.cdf(1))), lambda t: clip((t - 1) / 2), (1, 3),
    ),
}  # fmt: skip


@pytest.mark.parametrize("claim", CASES)
def test_samples_follow_the_closed_form(claim):
    text, read, cdf, rival, (low, high) = CASES[claim]
    assert largest_gap(samples(text, read), cdf) < BOUND
    assert distance_between(cdf, rival, low, high) > 2 * BOUND
