"""Reference lines: points along lines, arcs, spirals and cubic curves, against numerical integration of their directions."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scenic_ref.roads import reference_lines
from scenic_ref.roads.opendrive import Cubic, Piece, Profile

LENGTH = 30.0
PIECES = {
    "line": (),
    "arc to the left": (0.05,),
    "arc to the right": (-0.2,),
    "spiral from straight": (0.0, 0.1),
    "spiral to straight": (-0.1, 0.0),
    "spiral through straight": (-0.05, 0.08),
    "spiral that keeps its sign": (0.02, 0.3),
    "spiral that is an arc": (0.1, 0.1),
}


def kind_of(name: str) -> str:
    return name.split()[0]


def curvature(name: str, t: np.ndarray) -> np.ndarray:
    first, last = (PIECES[name] * 2)[:2] if PIECES[name] else (0.0, 0.0)
    return first + (last - first) * t / LENGTH


@pytest.mark.parametrize("name", PIECES)
def test_points_and_directions_are_the_integrals_of_the_curvature(name: str) -> None:
    t = np.linspace(0.0, LENGTH, 60_001)
    step = t[1]
    middle = t[:-1] + step / 2
    directions = 0.7 + np.concatenate([[0.0], np.cumsum(curvature(name, middle) * step)])
    halfway = (directions[1:] + directions[:-1]) / 2
    x = 3.0 + np.concatenate([[0.0], np.cumsum(np.cos(halfway) * step)])
    y = -2.0 + np.concatenate([[0.0], np.cumsum(np.sin(halfway) * step)])
    found = reference_lines.points(Piece(0.0, 3.0, -2.0, 0.7, LENGTH, kind_of(name), PIECES[name]), t)
    for one, other in zip(found, (x, y, directions), strict=True):
        assert np.abs(one - other).max() < 1e-6


def test_poly3_is_as_long_as_it_says_and_goes_where_its_polynomial_goes() -> None:
    piece = Piece(0.0, 0.0, 0.0, 0.0, 20.0, "poly3", (0.5, 0.1, -0.02, 0.001))
    t = np.linspace(0.0, 20.0, 2001)
    x, y, direction = reference_lines.points(piece, t)
    assert np.abs(y - (0.5 + x * (0.1 + x * (-0.02 + x * 0.001)))).max() < 1e-9
    assert np.abs(np.hypot(np.diff(x), np.diff(y)) / t[1] - 1).max() < 2e-3
    assert np.abs(np.diff(y) / np.diff(x) - np.tan((direction[1:] + direction[:-1]) / 2)).max() < 1e-3


@pytest.mark.parametrize("arc_length", [False, True])
def test_param_poly3(arc_length: bool) -> None:
    """A quarter of a circle of 10 m, as a cubic curve (Hermite): within 2 cm of it."""
    radius, length = 10.0, 10.0 * math.pi / 2
    d = 1.657 * radius  # the derivatives at the ends, of a parameter from 0 to 1: the nearest to a circle
    u = (0.0, d, 3 * radius - 2 * d, d - 2 * radius)
    v = (0.0, 0.0, 3 * radius - d, d - 2 * radius)
    if arc_length:
        u, v = (tuple(c / length**i for i, c in enumerate(w)) for w in (u, v))
    parameters = (*u, *v, *((1.0,) if arc_length else ()))
    x, y, direction = reference_lines.points(Piece(0.0, 0.0, 0.0, 0.0, length, "paramPoly3", parameters), np.linspace(0.0, length, 200))
    assert np.abs(np.hypot(x, y - radius) - radius).max() < 0.02
    assert (x[-1], y[-1], direction[-1]) == pytest.approx((radius, radius, math.pi / 2))


@pytest.mark.parametrize("name", PIECES)
def test_between_sampled_points_the_curve_is_straight_within_what_is_promised(name: str) -> None:
    piece = Piece(5.0, 0.0, 0.0, 0.0, LENGTH, kind_of(name), PIECES[name])
    for width in (0.0, 8.0):
        s = reference_lines.sample_distances([piece], width)
        assert (s[0], s[-1]) == (5.0, 5.0 + LENGTH)
        for a, b in pairwise(s):
            x, y, direction = reference_lines.points(piece, np.linspace(a, b, 9) - 5.0)
            x, y = x + width * np.sin(direction), y - width * np.cos(direction)  # to the right, the outer side of a left bend
            chord = np.array([x[-1] - x[0], y[-1] - y[0]]) / max(math.hypot(x[-1] - x[0], y[-1] - y[0]), 1e-12)
            assert np.abs((x - x[0]) * chord[1] - (y - y[0]) * chord[0]).max() < 2 * reference_lines.CHORD
            assert abs(direction[-1] - direction[0]) < 1.2 * reference_lines.TURN


def test_profiles_hold_from_where_they_begin() -> None:
    profile = Profile((Cubic(0.0, 1.0, 0.0, 0.0, 0.0), Cubic(10.0, 2.0, 0.5, 0.0, 0.1)))
    assert profile.at(np.array([-1.0, 0.0, 9.9, 10.0, 12.0])).tolist() == pytest.approx([0.0, 1.0, 1.0, 2.0, 3.8])
    assert Profile(()).at(np.array([1.0])).tolist() == [0.0]
    bent = reference_lines.where_bent(profile, 12.0)
    assert set(bent.tolist()) >= {0.0, 10.0, 11.0, 12.0}
