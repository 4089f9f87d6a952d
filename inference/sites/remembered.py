"""What calls and draws that are made row by row gave in the states of some chains, so that a move computes again only what it changes.

A value follows from the numbers and words that are below its node. Where a move leaves these as they are, the value stays as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..batch.evaluate.columns import column
from ..batch.evaluate.plan import PlanStep, cone
from ..batch.evaluate.rows import FailedRows
from ..batch.trace.graph import GraphNode, RowCall, RowDraw
from .states import Evaluation, Space, States


class SomeRows(dict[int, np.ndarray]):
    """Columns in some of their rows, each taken when it is asked for."""

    def __init__(self, columns: Mapping[int, np.ndarray], rows: np.ndarray) -> None:
        super().__init__()
        self.columns, self.rows = columns, rows

    def __missing__(self, number: int) -> np.ndarray:
        self[number] = found = self.columns[number][self.rows]
        return found


Below = Mapping[int, tuple[np.ndarray, np.ndarray]]
"""The numbers and the words, by their places, that are below each node which is computed row by row."""


def below_rows(space: Space, steps: Sequence[PlanStep]) -> Below:
    """These of a plan."""
    nodes = [node for step in steps for node in step.nodes if isinstance(node.function, (RowCall, RowDraw))]
    places = {node.number: space.of_nodes(cone([node], set())) for node in nodes}
    return {k: (np.array(sorted(numbers), dtype=np.int64), np.array(sorted(words), dtype=np.int64)) for k, (numbers, words) in places.items()}


class Remembered:
    """The values of nodes that are computed row by row, in the states of some chains; `there` says of which chains each is known."""

    def __init__(self, space: Space, below: Below) -> None:
        self.space, self.below = space, below
        self.values: dict[int, np.ndarray] = {}
        self.there: dict[int, np.ndarray] = {}
        self.last: Again | None = None

    def move(self, states: States, proposed: States) -> None:
        """A move from these states to others will be looked at."""
        self.numbers, self.words = states.uniforms != proposed.uniforms, states.words != proposed.words
        self.last = None

    def evaluation(self, proposed: States) -> Again:
        """The runs of the proposed states."""
        self.last = Again(self, proposed)
        return self.last

    def taken(self, taken: np.ndarray) -> None:
        """The move was taken in these chains; of those that the evaluation came to the end of, it has all values."""
        if self.last is None:
            return
        own = taken[self.last.rows]
        rows = self.last.rows[own]
        for number in self.below.keys() & self.last.columns.keys():
            found, failed = self.last.columns[number], self.last.failed.get(number)
            if number not in self.values:
                self.values[number] = np.empty((len(taken), *found.shape[1:]), dtype=found.dtype)
                self.there[number] = np.zeros(len(taken), dtype=bool)
            self.values[number][rows] = found[own]
            self.there[number][taken] = False
            self.there[number][rows] = True if failed is None else ~(failed.rejected | failed.left)[own]

    def unchanged(self, number: int, rows: np.ndarray) -> np.ndarray:
        """In which of these rows the value of a node is known and the same."""
        if number not in self.there:
            return np.zeros(len(rows), dtype=bool)
        numbers, words = self.below[number]
        return self.there[number][rows] & ~(self.numbers[np.ix_(numbers, rows)].any(axis=0) | self.words[np.ix_(words, rows)].any(axis=0))


class Again(Evaluation):
    """The runs of proposed states, where what a move does not change is not computed again."""

    def __init__(self, known: Remembered, proposed: States) -> None:
        super().__init__(known.space, proposed)
        self.known = known

    def column(self, node: GraphNode) -> np.ndarray:
        """The column of a node."""
        if node.number not in self.known.below:
            return super().column(node)
        same = self.known.unchanged(node.number, self.rows)
        if not same.any():
            return super().column(node)
        values, rest = self.known.values[node.number][self.rows], np.flatnonzero(~same)
        if len(rest):
            failed: dict[int, FailedRows] = {}
            values[rest] = column(node, SomeRows(self.columns, rest), self.numbers.at(rest), failed)
            if node.number in failed:
                self.failed[node.number] = failed[node.number].among(rest, len(values))
        return values
