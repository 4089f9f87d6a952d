"""Whether any two of many boxes meet, compiled by numba: `crowds.crowd_meets` for one scene, the same test for the pairs that are near."""

from __future__ import annotations

import math

import numpy as np

from ....semantics.space.boundaries import METRES
from ....semantics.space.crowds import MARGIN
from .kernels import compile_


@compile_
def within(away: float, reach: float, closed: bool) -> bool:
    """Whether a distance is at most the reach, or less for open sets."""
    return away <= reach if closed else away < reach


@compile_
def pair_meets(boxes: np.ndarray, i: int, j: int, closed: bool) -> bool:
    """Whether two of the boxes share a point: `geometry.boxes_intersect`, its comparisons one by one."""
    x, y = boxes[j, 0] - boxes[i, 0], boxes[j, 1] - boxes[i, 1]
    c1, s1, hw1, hl1 = boxes[i, 2], boxes[i, 3], boxes[i, 4], boxes[i, 5]
    c2, s2, hw2, hl2 = boxes[j, 2], boxes[j, 3], boxes[j, 4], boxes[j, 5]
    c, s = abs(c1 * c2 + s1 * s2), abs(s2 * c1 - c2 * s1)
    margin = METRES if closed else -METRES
    return (
        within(abs(x * c1 + y * s1), hw1 + (hw2 * c + hl2 * s) + margin, closed)
        and within(abs(y * c1 - x * s1), hl1 + (hw2 * s + hl2 * c) + margin, closed)
        and within(abs(x * c2 + y * s2), hw2 + (hw1 * c + hl1 * s) + margin, closed)
        and within(abs(y * c2 - x * s2), hl2 + (hw1 * s + hl1 * c) + margin, closed)
    )


@compile_
def row_meets(boxes: np.ndarray, closed: bool) -> bool:
    """Whether any two boxes share a point; (boxes, `NUMBERS`). From West to East, each is compared with those that begin before it ends."""
    count = len(boxes)
    low, high = np.empty(count), np.empty(count)
    finite = True
    for k in range(count):
        x, y, hw, hl = boxes[k, 0], boxes[k, 1], boxes[k, 4], boxes[k, 5]
        reach = math.sqrt(hw * hw + hl * hl) + MARGIN * (1 + abs(x) + abs(y) + abs(hw) + abs(hl))
        low[k], high[k] = x - reach, x + reach
        finite = finite and math.isfinite(low[k]) and math.isfinite(high[k])
    order = np.argsort(low) if finite else np.arange(count)
    for place in range(count):
        for later in range(place + 1, count):
            k, m = order[place], order[later]
            if finite and low[m] > high[k]:
                break
            if pair_meets(boxes, min(k, m), max(k, m), closed):
                return True
    return False
