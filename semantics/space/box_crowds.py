"""Collisions among many boxes: which of them are near each other at all, and whether any two meet.

A crowd of n boxes has n (n - 1) / 2 pairs, of which few are near each other. Two boxes whose circumscribed circles lie in disjoint squares do
not meet; only the other pairs are looked at, by the very test for two boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from .geometry import turned_boxes_intersect, turned_boxes_overlap
from .symbol_seam import symbol_in
from .vectors import Vector

MARGIN = 1e-6
"""Metres added around each box, and as a share of its coordinates: far more than the tolerance of boundaries and the rounding of both."""
NUMBERS = 6
"""Numbers of a box in a crowd: x, y, the cosine and the sine of its heading, half its width, half its length."""


def near_pairs(crowd: Sequence[tuple[float, float, float, float, float]]) -> list[tuple[int, int]] | None:
    """The pairs (i, j), i < j, that may meet, ordered by j and then i, of boxes: each x, y, heading, width, length; metres, radians.

    Of the crowds of many scenes there are none that are the same in each. None if something is no number, as only a program's mistake makes it.
    """
    if any(symbol_in(box) is not None for box in crowd):
        return []
    if not all(isinstance(n, (int, float)) for box in crowd for n in box):
        return None
    x, y, _, width, length = np.array(crowd, dtype=float).T
    return [(int(i), int(j)) for i, j in zip(*close_pairs(x, y, width, length), strict=True)]


def close_pairs(x: np.ndarray, y: np.ndarray, width: np.ndarray, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pairs i < j of boxes that may meet, whatever their headings, ordered by j and then i: two arrays of positions; metres.

    All pairs are such where a number is not finite.
    """
    with np.errstate(all="ignore"):
        reach = np.hypot(width, length) / 2 + MARGIN * (1 + np.abs(x) + np.abs(y))
        low_x, low_y, high_x, high_y = x - reach, y - reach, x + reach, y + reach
    if not np.isfinite([low_x, low_y, high_x, high_y]).all():
        second, first = np.tril_indices(len(x), -1)
        return first, second
    squares = shapely.box(low_x, low_y, high_x, high_y)
    first, second = shapely.STRtree(squares).query(squares)
    first, second = first[first < second], second[first < second]
    order = np.lexsort((first, second))
    return first[order], second[order]


def crowd_meets(closed: bool, *numbers: float) -> bool:
    """Whether any two of many boxes share a point, as closed or as open sets; six `NUMBERS` of each box, floats or arrays of many scenes."""
    symbol = symbol_in(numbers)
    if symbol is not None:
        return symbol.apply(crowd_meets, (closed, *numbers), bool)
    columns = np.broadcast_arrays(*(np.asarray(n, dtype=float) for n in numbers))
    table = np.stack(columns).reshape(len(numbers) // NUMBERS, NUMBERS, columns[0].size)
    met = np.array([row_meets(table[:, :, k].T, closed) for k in range(table.shape[2])], dtype=bool)
    return bool(met[0]) if columns[0].ndim == 0 else met  # type: ignore[return-value]


def row_meets(boxes: np.ndarray, closed: bool) -> bool:
    """Return whether any two of the boxes of one scene share a point: an array (`NUMBERS`, boxes)."""
    x, y, c, s, half_width, half_length = boxes
    i, j = close_pairs(x, y, 2 * half_width, 2 * half_length)
    test = turned_boxes_intersect if closed else turned_boxes_overlap
    with np.errstate(all="ignore"):
        pairs: Any = test(
            Vector(x[j] - x[i], y[j] - y[i]), Vector(c[i], s[i]), Vector(half_width[i], half_length[i]),
            Vector(c[j], s[j]), Vector(half_width[j], half_length[j]),
        )  # fmt: skip
    return bool(np.any(pairs))
