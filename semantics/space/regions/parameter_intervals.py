"""Sets of parameters t in [0, 1] along a segment a + t (b - a), as sorted disjoint closed intervals.

They say which part of a segment lies in a region, exactly (true arcs included), and so give lengths of polylines clipped by
regions. Complements are closed again: single points are of no account, only lengths are.
"""

from __future__ import annotations

import math
from itertools import chain

Intervals = tuple[tuple[float, float], ...]

ALL: Intervals = ((0.0, 1.0),)
NONE: Intervals = ()


def intersection(first: Intervals, second: Intervals) -> Intervals:
    """The parameters in both sets."""
    pairs = ((max(a, c), min(b, d)) for a, b in first for c, d in second)
    return tuple(sorted((low, high) for low, high in pairs if low <= high))


def union(first: Intervals, second: Intervals) -> Intervals:
    """The parameters in either set."""
    merged: list[tuple[float, float]] = []
    for low, high in sorted(chain(first, second)):
        if merged and low <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(merged[-1][1], high))
        else:
            merged.append((low, high))
    return tuple(merged)


def complement(intervals: Intervals) -> Intervals:
    """The closure of the parameters of [0, 1] outside the set."""
    ends = [0.0, *chain.from_iterable(intervals), 1.0]
    return tuple((low, high) for low, high in zip(ends[::2], ends[1::2], strict=True) if low < high)


def where_nonnegative(at_start: float, at_end: float) -> Intervals:
    """Return the intervals of t on which a linear function with these values at t = 0 and t = 1 is at least
    0.
    """
    if at_start >= 0 and at_end >= 0:
        return ALL
    if at_start < 0 and at_end < 0:
        return NONE
    crossing = at_start / (at_start - at_end)
    return ((crossing, 1.0),) if at_start < 0 else ((0.0, crossing),)


def where_within_disc(x: float, y: float, dx: float, dy: float, radius: float) -> Intervals:
    """Return the intervals of t on which ⟨x, y⟩ + t ⟨dx, dy⟩ lies in the disc with this radius about the
    origin.
    """
    a, b, c = dx * dx + dy * dy, x * dx + y * dy, x * x + y * y - radius * radius
    discriminant = b * b - a * c
    if a == 0:
        return ALL if c <= 0 else NONE
    if discriminant < 0:
        return NONE
    root = math.sqrt(discriminant)
    return intersection(ALL, (((-b - root) / a, (-b + root) / a),))
