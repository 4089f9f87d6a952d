"""Nodes that stand for calls of Python, row by row, and that have columns all the same: tests on polygons, fields, clipped curves."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ....semantics.kernel.outcome import Requirement
from ....semantics.space.vectors import Vector
from ..trace.graph import GraphEvent, HasValue, RowCall, RowDraw
from ..trace.symbols import Traced
from .clipped import Clipped, clipped_curve, largest_radius
from .column_calls import column_methods
from .proposed import proposed_in

Columns = Mapping[int, np.ndarray]


class FailedRows(NamedTuple):
    """Rows of a node that is computed row by row: where a requirement failed, and where the interpreter must see what happens.

    `reasons` holds what rows failed, if that is known row by row: requirements, whose place is that of the node's event.
    """

    rejected: np.ndarray
    left: np.ndarray
    reasons: np.ndarray | None = None

    def at(self, kept: np.ndarray) -> FailedRows:
        """Only the rows where `kept` is True."""
        return FailedRows(self.rejected[kept], self.left[kept], None if self.reasons is None else self.reasons[kept])

    def among(self, rows: np.ndarray, count: int) -> FailedRows:
        """The same where these are some of so many rows, of whose others none failed."""
        reasons = None if self.reasons is None else np.full(count, None)
        found = FailedRows(np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), reasons)
        found.rejected[rows], found.left[rows] = self.rejected, self.left
        if reasons is not None:
            reasons[rows] = self.reasons
        return found

    def reasons_of(self, rows: np.ndarray, event: GraphEvent) -> dict[int, Requirement]:
        """What those of these rows failed that are rejected, by their position, where it is known row by row."""
        if self.reasons is None or event.requirement is None:
            return {}
        rejected = np.flatnonzero(rows & self.rejected & ~self.left).tolist()
        return {row: self.reasons[row]._replace(span=event.requirement.span) for row in rejected}


def note(stuck: Counter[Requirement], event: GraphEvent, lost: np.ndarray, failed: Mapping[int, FailedRows]) -> None:
    """Count what rows failed that an event ends."""
    if event.requirement is None:
        return
    own = failed[event.node.number].reasons_of(lost, event) if event.node.number in failed else {}
    stuck.update(own.values())
    if rest := int(np.count_nonzero(lost)) - len(own):
        stuck[event.requirement] += rest


def always_gives_a_value(function: object) -> bool:
    """Whether a node that decides runs has columns: then each row has a value, or is rejected since there is none."""
    if isinstance(function, HasValue):
        return not function.left.any()
    if isinstance(function, RowDraw):
        return is_clipped(function) is not None or proposed_in(function.distribution) is not None
    return isinstance(function, RowCall) and column_methods(function) is not None


def is_clipped(draw: RowDraw) -> Clipped | None:
    """The curve and the sector, if the draw is that of a point of a curve in a sector of bounded radius."""
    found = clipped_curve(draw.distribution)
    return found if found is not None and math.isfinite(largest_radius(found.radius)) else None


def values_of(structure: Sequence[object], columns: Columns, count: int) -> list[np.ndarray]:
    """Numbers and vectors as columns of numbers."""
    found: list[np.ndarray] = []
    for value in structure:
        for part in (value.x, value.y) if isinstance(value, Vector) else (value,):
            symbol = part.number() if isinstance(part, Traced) and part.node.kind == "int" else part
            found.append(columns[symbol.node.number].astype(float) if isinstance(symbol, Traced) else np.full(count, float(symbol)))  # type: ignore[arg-type]
    return found
