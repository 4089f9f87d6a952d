"""`(low, high)` in dialect `pldi19`: an interval, from which a value is drawn, or a pair (reading `intervals`)."""

from __future__ import annotations

from ..kernel.config import Stack, State
from ..kernel.draws import draw
from ..kernel.kinds import has_kind
from ..kernel.outcome import Outcome
from ..kernel.premises import premises
from ..kernel.values import Constructor, plain
from ..space.distributions.continuous import Range
from ..syntax import expressions as e
from .expressions import displayed


def interval_or_pair(node: e.IntervalOrPair, stack: Stack, state: State) -> Outcome:
    """`(low, high)` of dialect `pldi19` (reading `intervals`)."""
    return premises(node, [node.low, node.high], conclude_interval, stack, state)


def conclude_interval(node: e.IntervalOrPair, values: list[object], stack: Stack, state: State) -> Outcome:
    """Uniform on the interval if both ends are scalars, otherwise a pair."""
    if all(has_kind(plain(v), "scalar") for v in values):
        return draw(node, RANGE, tuple(values), {}, stack, state)
    return displayed(tuple, values, node, stack, state)


RANGE = Constructor("Range", Range, keeps_values=False, takes="low, high")
