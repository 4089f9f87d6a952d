"""Reference lines of roads: points and directions along lines, arcs, spirals and cubic curves (ASAM OpenDRIVE, "Geometry")."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from .opendrive import Cubic, Numbers, Piece, Profile

CHORD = 0.002
"""Metres by which a curve may be away from the line through its sampled points."""
TURN = math.radians(2)
"""The most that a curve turns between two sampled points."""
LONGEST_STEP = 1.0
"""Metres between points where a width changes as a cubic function."""
MOST_POINTS = 20_000
"""On a piece of a reference line."""

Local = Callable[[Sequence[float], float, Numbers], tuple[Numbers, Numbers, Numbers]]
"""From the parameters, the length, and the distances along a piece to u, v and the direction, where it begins at (0, 0) along u."""


def line(parameters: Sequence[float], length: float, t: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Return the points and directions of a straight line."""
    return t, np.zeros_like(t), np.zeros_like(t)


def arc(parameters: Sequence[float], length: float, t: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """A circle with this curvature in 1/m, to the left if it is positive."""
    [k] = parameters
    if abs(k) < 1e-12:
        return line((), length, t)
    return np.sin(k * t) / k, (1 - np.cos(k * t)) / k, k * t


def spiral(parameters: Sequence[float], length: float, t: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """A clothoid: the curvature goes from one value to the other in proportion to the distance."""
    first, last = parameters
    rate = (last - first) / length if length > 0 else 0.0
    if abs(rate) < 1e-12:
        return arc((first,), length, t)
    scale = math.sqrt(math.pi / abs(rate))
    begin = first / rate  # distance from where the curvature is 0
    turned = begin * begin * rate / 2
    from scipy.special import fresnel  # with which maps without spirals need not wait

    sines, cosines = fresnel((begin + t) / scale)
    sine, cosine = fresnel(begin / scale)
    x, y = scale * (cosines - cosine), math.copysign(scale, rate) * (sines - sine)
    back = -turned
    return x * math.cos(back) - y * math.sin(back), x * math.sin(back) + y * math.cos(back), first * t + rate * t * t / 2


def poly3(parameters: Sequence[float], length: float, t: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """v = a + b u + c u² + d u³, where t is the length of the curve from its beginning."""
    a, b, c, d = parameters
    fine = np.linspace(0.0, length, 1001)
    slope = b + fine * (2 * c + fine * 3 * d)
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(1, (slope[1:] + slope[:-1]) / 2) * np.diff(fine))])
    u = np.interp(t, lengths, fine)
    return u, a + u * (b + u * (c + u * d)), np.arctan(b + u * (2 * c + u * 3 * d))


def param_poly3(parameters: Sequence[float], length: float, t: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Two cubic functions of a parameter that runs from 0 to 1, or to the length, in proportion to the distance."""
    au, bu, cu, du, av, bv, cv, dv = parameters[:8]
    p = t if len(parameters) == 9 else t / (length or 1.0)
    along, aside = bu + p * (2 * cu + p * 3 * du), bv + p * (2 * cv + p * 3 * dv)
    return au + p * (bu + p * (cu + p * du)), av + p * (bv + p * (cv + p * dv)), np.arctan2(aside, along)


LOCAL: Mapping[str, Local] = {"line": line, "arc": arc, "spiral": spiral, "poly3": poly3, "paramPoly3": param_poly3}


def points(piece: Piece, t: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """x, y and the direction (from East) at distances along a piece."""
    u, v, turn = LOCAL[piece.kind](piece.parameters, piece.length, t)
    cosine, sine = math.cos(piece.heading), math.sin(piece.heading)
    return piece.x + u * cosine - v * sine, piece.y + u * sine + v * cosine, piece.heading + turn


def along(pieces: Sequence[Piece], s: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """x, y and the direction at distances along a reference line."""
    starts = np.array([p.s for p in pieces])
    which = np.maximum(np.searchsorted(starts, s, side="right") - 1, 0)
    x, y, direction = np.empty_like(s), np.empty_like(s), np.empty_like(s)
    for i in np.unique(which):
        here = which == i
        x[here], y[here], direction[here] = points(pieces[i], np.minimum(s[here] - starts[i], pieces[i].length))
    return x, y, direction


def breaks(pieces: Sequence[Piece], least: float) -> Iterator[tuple[float, float]]:
    """Yield the breaks at which a piece does not begin at the end of the one before it: the distance along
    the line, and the metres between them.
    """
    for one, following in pairwise(pieces):
        (x, y, _), (u, v, _) = (points(piece, np.array([at])) for piece, at in ((one, one.length), (following, 0.0)))
        gap = math.hypot(float(u[0] - x[0]), float(v[0] - y[0]))
        if gap > least:
            yield following.s, gap


def sample_distances(pieces: Sequence[Piece], width: float) -> Numbers:
    """Distances between which a reference line, and what runs up to `width` metres beside it, is nearly straight."""
    found: list[Numbers] = []
    for piece in pieces:
        count = 1
        if piece.kind != "line" and piece.length > 0:
            fine = np.linspace(0.0, piece.length, min(2000, max(33, int(piece.length) * 4)))
            _, _, direction = points(piece, fine)
            turns = np.abs(np.diff(np.unwrap(direction)))
            sharpest = float((turns / np.diff(fine)).max())
            outer = 1 + width * sharpest
            chord = math.sqrt(8 * CHORD / (sharpest * outer)) if sharpest > 1e-9 else piece.length
            count = max(1, math.ceil(piece.length * sharpest / TURN), math.ceil(piece.length / max(chord, 1e-3)))
        found.append(piece.s + np.linspace(0.0, piece.length, min(count, MOST_POINTS) + 1))
    return np.concatenate(found)


def where_bent(profile: Profile, end: float) -> Numbers:
    """The distances at which a width has to be looked at: where its pieces begin, and along those that are not straight."""
    found: list[Numbers] = []
    ends = [*(piece.start for piece in profile.pieces), end][1:]
    for piece, stop in zip(profile.pieces, ends, strict=False):
        found.append(np.array([piece.start]))
        if not is_straight(piece) and stop > piece.start:
            count = min(math.ceil((stop - piece.start) / LONGEST_STEP), MOST_POINTS)
            found.append(np.linspace(piece.start, stop, count + 1))
    return np.concatenate(found) if found else np.empty(0)


def is_straight(piece: Cubic) -> bool:
    """Whether a cubic function is linear."""
    return piece.c == piece.d == 0
