"""Rejection on columns: the same scenes as the interpreter's, many at a time.

A scene is that of the first attempt that is accepted. A block of scenes is drawn in waves: the first attempt at all of them, then the
second at those without a scene, and so on; when few are left, several attempts at each. So a scene depends neither on the size of
the block nor on the order of evaluation. Runs that the graph does not describe are left to the interpreter, one by one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ...interpreter.choosers import from_stream
from ...interpreter.running import Accepted, run
from ...interpreter.scenes import Scene, scene_of
from ...semantics.config import Config
from ...semantics.errors import ScenicError
from ...semantics.outcome import Requirement
from ...semantics.symbols import NotLifted
from ..rejection import DEFAULT_ATTEMPTS, exhausted
from .columns import LEFT, REJECTED, Columns, evaluate
from .plan import Step, plan
from .scenes import Template, scenes_of, template_of
from .tracing import trace

WAVE = 1 << 14
"""Runs that are evaluated at a time: their columns fit into the caches."""
WASTE = 0.25
"""So many of the attempts at a scene that are evaluated at a time may be expected to be in vain."""


class Block(NamedTuple):
    """Scenes `start` to `start + len(attempts) - 1`: of those in `columns` row k is scene `rows[k]`; `others` were left to the interpreter.

    `error` is what ended the block early, at the scene behind the last.
    """

    start: int
    attempts: np.ndarray
    rows: np.ndarray
    columns: Columns
    others: dict[int, Scene]
    stuck: Counter[Requirement]
    runs: int
    left: int
    error: ScenicError | None


class Batch:
    """A program as a graph, ready to be evaluated. Raises `NotLifted` with the reason if it is none."""

    def __init__(self, start: Callable[[], Config], *, fuel: int) -> None:
        self.start = start
        self.fuel = fuel
        graph, state = trace(start, fuel)
        self.graph = graph
        self.template: Template = template_of(state)
        self.outputs = list({node.number: node for node in self.template.outputs}.values())
        self.steps: tuple[Step, ...] = plan(graph, self.outputs)

    def scenes(self, n: int, seed: int, *, start: int = 0, max_attempts: int = DEFAULT_ATTEMPTS) -> Iterator[Scene]:
        """Scenes `start` to `start + n - 1` of `seed`. Raises the program's errors, and `AttemptsExhausted`."""
        for first in range(start, start + n, WAVE):
            block = self.block(seed, first, min(first + WAVE, start + n), max_attempts=max_attempts)
            yield from self.scenes_of(block, seed)
            if block.error is not None:
                raise block.error

    def scenes_of(self, block: Block, seed: int) -> Iterator[Scene]:
        """The scenes of a block, in order."""
        made = scenes_of(self.template, block.columns, seed, block.rows, block.attempts[block.rows - block.start])
        for index in range(block.start, block.start + len(block.attempts)):
            yield block.others[index] if index in block.others else next(made)

    def block(self, seed: int, start: int, stop: int, *, max_attempts: int = DEFAULT_ATTEMPTS) -> Block:
        """Scenes `start` to `stop - 1`."""
        count = stop - start
        done = np.full(count, -1, dtype=np.int64)  # the attempt that gave the scene
        pending = np.arange(count)
        attempt = 0
        stuck: Counter[Requirement] = Counter()
        others: dict[int, Scene] = {}
        pieces: list[tuple[np.ndarray, Columns]] = []
        runs = left = accepted = 0
        error: ScenicError | None = None
        while len(pending):
            if attempt >= max_attempts:
                worst, often = stuck.most_common(1)[0]
                text = f"no scene in {max_attempts:,} attempts: most often ({often:,} times in this block) this failed: {worst.text}"
                error, stop = exhausted(text, max_attempts, stuck), start + int(pending[0])
                break
            rate = max(accepted, 1) / max(runs, 1) if runs else 1.0
            width = int(max(1, min(WAVE // len(pending), 2 * WASTE / rate, max_attempts - attempt)))
            scenes = np.repeat(pending, width)
            tried = np.tile(np.arange(attempt, attempt + width), len(pending))
            result = evaluate(self.steps, seed, (scenes + start).astype(np.uint64), tried.astype(np.uint64))
            runs += len(scenes)
            stuck += result.stuck
            fates = result.fate.reshape(len(pending), width)
            decided = fates != REJECTED
            has = decided.any(axis=1)
            first = decided.argmax(axis=1)
            take = np.zeros(len(scenes), dtype=bool)
            for place in np.flatnonzero(has & (fates[np.arange(len(pending)), first] == LEFT)):
                scene, column = int(pending[place]), int(first[place])
                while column < width and fates[place, column] == LEFT:
                    left += 1
                    try:
                        ended = run(self.start(), from_stream(seed, scene + start, attempt + column), fuel=self.fuel)
                    except ScenicError as problem:
                        if error is None or scene + start < stop:
                            error, stop = problem, scene + start
                        ended = None
                    if ended is None:
                        break
                    if isinstance(ended, Accepted):
                        others[scene + start] = scene_of(ended.state, seed, scene + start, attempt + column + 1)
                        break
                    stuck[ended.requirement] += 1
                    later = decided[place, column + 1 :]
                    column = column + 1 + int(later.argmax()) if later.any() else width
                has[place], first[place] = column < width, column
            winners = np.flatnonzero(has)
            done[pending[winners]] = attempt + first[winners]
            accepted += len(winners)
            flat = winners * width + first[winners]
            take[flat[result.fate[flat] != LEFT]] = True
            alive = np.flatnonzero((result.fate != REJECTED) & (result.fate != LEFT))
            chosen = take[alive]
            pieces.append((scenes[alive][chosen] + start, {n: c[chosen] for n, c in result.columns.items()}))
            pending = pending[~has]
            if error is not None:
                pending = pending[pending < stop - start]
            attempt += width
        return self._block(start, stop, done, pieces, others, stuck, runs, left, error)

    def _block(
        self, start: int, stop: int, done: np.ndarray, pieces: list[tuple[np.ndarray, Columns]], others: dict[int, Scene],
        stuck: Counter[Requirement], runs: int, left: int, error: ScenicError | None,
    ) -> Block:  # fmt: skip
        """The pieces put together, in the order of the scenes, without those behind an error."""
        rows = np.concatenate([r for r, _ in pieces]) if pieces else np.zeros(0, dtype=np.int64)
        order = np.argsort(rows)
        order = order[rows[order] < stop]
        columns = {node.number: np.concatenate([c[node.number] for _, c in pieces])[order] for node in self.outputs}
        kept = {index: scene for index, scene in others.items() if index < stop}
        return Block(start, done[: stop - start], rows[order], columns, kept, stuck, runs, left, error)


__all__ = ["Batch", "Block", "NotLifted"]
