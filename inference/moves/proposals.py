"""Moves between states, which are as likely back as forth, so that the uniform distribution on any set of states stays as it is.

- redraw: the numbers of one block (those of an object), or one of them, are drawn anew;
- step: they move by a normal step, around the unit interval as if its ends met;
- exchange: two blocks with as many numbers exchange them.

Which move a row makes, and how large its steps are, is drawn apart from its state.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .states import WORD_BITS, States

Block = tuple[frozenset[int], frozenset[int]]
REDRAW, STEP, EXCHANGE = 0, 1, 2
NAMES = ("redraw", "step", "exchange")
LARGEST, SMALLEST = 0.5, 1e-7
FIRST = 0.02
"""Steps are up to LARGEST, evenly in their logarithm; from FIRST on at the beginning, later from where some are taken, and some are not."""
FEW, MANY, ENOUGH = 0.3, 0.6, 20


class Moves:
    """The moves on states with these blocks of numbers and words; `shares` say how often each kind of move is made.

    Where no other block is like the one that is to be exchanged, it makes a step.
    """

    def __init__(self, blocks: Sequence[Block], shares: tuple[float, float, float] = (0.3, 0.55, 0.15)) -> None:
        self.numbers, self.words = Places([sorted(numbers) for numbers, _ in blocks]), Places([sorted(words) for _, words in blocks])
        alike: dict[tuple[int, int], list[int]] = {}
        for k, (numbers, words) in enumerate(blocks):
            alike.setdefault((len(numbers), len(words)), []).append(k)
        self.alike = Places([alike[len(numbers), len(words)] for numbers, words in blocks])
        self.rank = np.array([alike[len(numbers), len(words)].index(k) for k, (numbers, words) in enumerate(blocks)], dtype=np.int64)
        self.smallest = np.full(max(len(blocks), 1), FIRST)
        self.steps = np.zeros((len(self.smallest), 2))  # made, and taken, since they were last adapted
        self.shares = shares

    def __len__(self) -> int:
        """The number of blocks."""
        return len(self.rank)

    def adapt(self, taken: MovesMade) -> None:
        """Take smaller steps in blocks where few were taken so far, larger ones where many were."""
        self.steps += taken.counts[STEP]
        enough = self.steps[:, 0] >= ENOUGH
        with np.errstate(invalid="ignore"):
            parts = self.steps[:, 1] / self.steps[:, 0]
        self.smallest[enough & (parts < FEW)] /= 3
        self.smallest[enough & (parts > MANY)] *= 1.5
        self.smallest = np.clip(self.smallest, SMALLEST, LARGEST / 2)
        self.steps[enough] = 0

    def propose(self, states: States, random: np.random.Generator) -> tuple[States, np.ndarray, np.ndarray]:
        """A proposal for each state, of which kind it is, and which block it moves."""
        rows = len(states)
        if not len(self):  # nothing is drawn
            return states, np.full(rows, STEP), np.zeros(rows, dtype=np.int64)
        kinds = random.choice(3, rows, p=self.shares)
        block = random.integers(len(self), size=rows)
        others = self.alike.sizes[block] - 1
        kinds[(kinds == EXCHANGE) & (others == 0)] = STEP
        sizes = self.numbers.sizes[block]
        alone = (random.random(rows) < 0.5) & (sizes > 0)
        only = np.where(alone, np.floor(random.random(rows) * sizes), -1)
        uniforms, words = states.uniforms.copy(), states.words.copy()
        row, place = self.numbers.of(np.flatnonzero(kinds != EXCHANGE), block, only)
        stepped = (uniforms[place, row] + random.standard_normal(len(row)) * self.lengths(block, random)[row]) % 1.0
        stepped[stepped >= 1.0] = 0.0
        uniforms[place, row] = np.where(kinds[row] == REDRAW, random.random(len(row)), stepped)
        row, place = self.words.of(np.flatnonzero((kinds == REDRAW) & ~alone), block)
        words[place, row] = random.integers(0, 1 << WORD_BITS, len(row), dtype=np.uint64)
        exchanged = np.flatnonzero(kinds == EXCHANGE)
        partner = np.zeros(rows, dtype=np.int64)
        rank = self.rank[block[exchanged]] + 1 + random.integers(others[exchanged])
        partner[exchanged] = self.alike.places[rank % (others[exchanged] + 1), block[exchanged]]
        for values, places in ((uniforms, self.numbers), (words, self.words)):
            (row, one), (_, other) = places.of(exchanged, block), places.of(exchanged, partner)
            values[one, row], values[other, row] = values[other, row], values[one, row]
        return States(uniforms, words), kinds, block

    def lengths(self, block: np.ndarray, random: np.random.Generator) -> np.ndarray:
        """How far steps of these blocks go, evenly in their logarithm."""
        least = np.log(self.smallest[block])
        return np.exp(least + random.random(len(block)) * (np.log(LARGEST) - least))


class MovesMade:
    """How many moves of each kind were made in each block, and how many of them were taken: `counts`, (kinds, blocks, 2)."""

    def __init__(self, blocks: int) -> None:
        self.counts = np.zeros((len(NAMES), max(blocks, 1), 2))

    def add(self, kinds: np.ndarray, block: np.ndarray, taken: np.ndarray) -> None:
        """Count further moves, and those that were taken."""
        np.add.at(self.counts, (kinds, block), np.stack([np.ones(len(taken)), taken], axis=1))

    def parts(self) -> dict[str, float]:
        """By kind of move, if any were made, the part that was taken."""
        return {name: float(taken / made) for name, (made, taken) in zip(NAMES, self.counts.sum(axis=1), strict=True) if made}


class Places:
    """For each block some places, as columns of a table that ends in zeros."""

    def __init__(self, places: Sequence[Sequence[int]]) -> None:
        self.sizes = np.array([len(p) for p in places], dtype=np.int64)
        self.places = np.zeros((self.sizes.max(initial=0), len(places)), dtype=np.int64)
        for k, own in enumerate(places):
            self.places[: len(own), k] = own

    def of(self, rows: np.ndarray, block: np.ndarray, only: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """The places of the blocks of some rows, or only the one of that number where it is not negative; and the row of each."""
        order = np.arange(len(self.places))[:, None]
        wanted = order < self.sizes[block[rows]]
        if only is not None:
            wanted &= (only[rows] < 0) | (order == only[rows])
        which, k = np.nonzero(wanted)
        return rows[k], self.places[which, block[rows[k]]]
