"""Moves between states, which are as likely back as forth, so that the uniform distribution on any set of states stays as it is.

- redraw: the numbers of one object, or one of them, are drawn anew;
- step: they move by a normal step, around the unit interval as if its ends met;
- exchange: two objects with as many numbers exchange them.

Which move a row makes, and how large its steps are, is drawn apart from its state.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .states import WORD_BITS, States

Block = tuple[frozenset[int], frozenset[int]]
REDRAW, STEP, EXCHANGE = 0, 1, 2
NAMES = ("redraw", "step", "exchange")
LARGEST, SMALLEST = 0.5, 1e-5
FIRST = 0.02
"""Steps are up to LARGEST, evenly in their logarithm; from FIRST on at the beginning, later from where some are taken, and some are not."""
FEW, MANY = 0.3, 0.6


class Moves:
    """The moves on states with these blocks of numbers and words; `shares` say how often each kind of move is made."""

    def __init__(self, blocks: Sequence[Block], uniforms: int, words: int, shares: tuple[float, float, float] = (0.3, 0.55, 0.15)) -> None:
        ordered = [(sorted(numbers), sorted(own)) for numbers, own in blocks]
        self.uniforms = np.zeros((len(blocks), uniforms), dtype=bool)
        self.words = np.zeros((len(blocks), words), dtype=bool)
        for k, (numbers, own) in enumerate(ordered):
            self.uniforms[k, numbers] = self.words[k, own] = True
        sizes = [(len(numbers), len(own)) for numbers, own in ordered]
        pairs = [(i, j) for i in range(len(sizes)) for j in range(i) if sizes[i] == sizes[j]]
        self.exchanged = np.tile(np.arange(uniforms), (len(pairs), 1))
        self.exchanged_words = np.tile(np.arange(words), (len(pairs), 1))
        for k, (i, j) in enumerate(pairs):
            for table, a, b in ((self.exchanged, ordered[i][0], ordered[j][0]), (self.exchanged_words, ordered[i][1], ordered[j][1])):
                table[k, a], table[k, b] = b, a
        self.smallest = FIRST
        kept = shares if pairs else (*shares[:2], 0.0)
        self.shares = np.array(kept) / sum(kept)

    def adapt(self, taken: float | None) -> None:
        """Take smaller steps from now on where few were taken, larger ones where many were."""
        if taken is not None and taken < FEW:
            self.smallest = max(self.smallest / 3, SMALLEST)
        elif taken is not None and taken > MANY:
            self.smallest = min(self.smallest * 1.5, LARGEST / 2)

    def propose(self, states: States, random: np.random.Generator) -> tuple[States, np.ndarray]:
        """A proposal for each state, and of which kind it is."""
        rows = len(states)
        if not len(self.uniforms):  # nothing is drawn
            return states, np.full(rows, STEP)
        kinds = random.choice(3, rows, p=self.shares)
        block = random.integers(len(self.uniforms), size=rows)
        of_block = self.uniforms[block].T
        keys = np.where(of_block, random.random(of_block.shape), -1.0)
        alone = (keys == keys.max(axis=0, initial=0.0)) & (random.random(rows) < 0.5) & of_block.any(axis=0)
        moved = np.where(alone.any(axis=0), alone, of_block)
        fresh = random.random(moved.shape)
        by = random.standard_normal(moved.shape) * np.exp(random.uniform(np.log(self.smallest), np.log(LARGEST), rows))
        stepped = (states.uniforms + by) % 1.0
        stepped[stepped >= 1.0] = 0.0
        uniforms = np.where(moved & (kinds == REDRAW), fresh, np.where(moved & (kinds == STEP), stepped, states.uniforms))
        renamed = self.words[block].T & (kinds == REDRAW) & ~alone.any(axis=0)
        words = np.where(renamed, random.integers(0, 1 << WORD_BITS, renamed.shape, dtype=np.uint64), states.words)
        if len(self.exchanged):
            pair = random.integers(len(self.exchanged), size=rows)
            exchanging = kinds == EXCHANGE
            uniforms = np.where(exchanging, np.take_along_axis(uniforms, self.exchanged[pair].T, axis=0), uniforms)
            words = np.where(exchanging, np.take_along_axis(words, self.exchanged_words[pair].T, axis=0), words)
        return States(uniforms, words), kinds
