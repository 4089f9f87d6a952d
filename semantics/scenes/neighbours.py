"""Which pairs of many objects may meet at all: the other premises of the rule about collisions are true, and are settled together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from ..kernel.config import State
from ..kernel.errors import ScenicError
from ..kernel.kinds import Reader, View
from ..kernel.values import Instance

MANY = 50
"""With so many objects a rule goes through all pairs, one by one: it is quick, and a reader of the trace sees each."""
MARGIN = 1e-6
"""Metres added around each object, and as a share of its coordinates: far more than the tolerance of boundaries and the rounding of both."""


def pairs_that_may_meet(objects: Sequence[Instance], state: State) -> list[tuple[int, int]] | None:
    """The pairs (i, j), i < j, ordered by j and then i, without those whose circumscribed circles have disjoint squares around them.

    None where all are to be looked at: few objects, and values that are no finite numbers (columns, a program's mistake).
    """
    if len(objects) <= MANY:
        return None
    reader = Reader(state)
    try:
        views = [View(o, reader) for o in objects]
        values = [value for o in views for value in (*o.position, o.width, o.length)]
    except ScenicError:
        return None  # said by the premise that needs the value
    if not all(isinstance(value, (int, float)) for value in values):
        return None
    x, y, width, length = np.array(values, dtype=float).reshape(-1, 4).T
    reach = np.hypot(width, length) / 2 + MARGIN * (1 + np.abs(x) + np.abs(y))
    if not np.isfinite(reach).all():
        return None
    squares = shapely.box(x - reach, y - reach, x + reach, y + reach)
    first, second = shapely.STRtree(squares).query(squares)
    ordered = np.lexsort((first, second))
    return [(int(i), int(j)) for i, j in zip(first[ordered], second[ordered], strict=True) if i < j]
