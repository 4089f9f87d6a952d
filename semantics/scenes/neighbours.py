"""Which pairs of many objects may meet at all: the other premises of the rule about collisions are true, and are settled together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..kernel.config import State
from ..kernel.errors import ScenicError
from ..kernel.kinds import Reader, View
from ..kernel.values import Instance
from ..space.crowds import close_pairs
from ..space.symbols import symbol_in

MANY = 50
"""With so many objects a rule goes through all pairs, one by one: it is quick, and a reader of the trace sees each."""

Crowd = Sequence[tuple[float, float, float, float, float]]
"""Of many objects x, y, heading, width and length: metres, radians; numbers of one scene, or symbols."""


def crowd_of(objects: Sequence[Instance], state: State) -> Crowd | None:
    """The objects as a crowd; None for few, or where a value is none that a box has, which the premise that needs it says."""
    if len(objects) <= MANY:
        return None
    reader = Reader(state)
    try:
        views = [View(o, reader) for o in objects]
        crowd = [(o.position.x, o.position.y, o.heading, o.width, o.length) for o in views]
    except (ScenicError, AttributeError):
        return None
    return crowd if all(isinstance(n, (int, float)) or symbol_in((n,)) is not None for box in crowd for n in box) else None


def has_symbols(crowd: Crowd) -> bool:
    """Whether the crowd stands for those of many scenes."""
    return any(symbol_in(box) is not None for box in crowd)


def pairs_that_may_meet(crowd: Crowd) -> list[tuple[int, int]]:
    """The pairs (i, j), i < j, ordered by j and then i, without those that are too far from each other."""
    x, y, _, width, length = np.array(crowd, dtype=float).T
    return [(int(i), int(j)) for i, j in zip(*close_pairs(x, y, width, length), strict=True)]
