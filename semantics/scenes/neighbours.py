"""Which pairs of many objects may meet at all; the other premises of the rule about collisions are settled together."""

from __future__ import annotations

from collections.abc import Sequence

from ..kernel.config import State
from ..kernel.errors import ScenicError
from ..kernel.kinds import Reader, View
from ..kernel.values import Instance
from ..space.crowds import near_pairs

MANY = 50
"""Up to so many objects, a rule goes through all pairs, one by one: it is quick, and a reader of the trace sees each."""


def pairs_that_may_meet(objects: Sequence[Instance], state: State) -> list[tuple[int, int]] | None:
    """The pairs of many objects that are near each other, by their places; None for few, or where one has a position or a size that is none."""
    if len(objects) <= MANY:
        return None
    try:
        return near_pairs(crowd_of(objects, state))
    except (ScenicError, AttributeError):  # the premise that needs the value will say it
        return None


def crowd_of(objects: Sequence[Instance], state: State) -> list[tuple[float, float, float, float, float]]:
    """The bounding boxes of the objects."""
    views = [View(o, Reader(state)) for o in objects]
    return [(o.position.x, o.position.y, o.heading, o.width, o.length) for o in views]
