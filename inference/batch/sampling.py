"""Rejection on columns: the same scenes as the interpreter's, many at a time.

A scene is that of the first attempt that is accepted. A block of scenes is drawn in waves: the first attempt at all of them, then the
second at those without a scene, and so on; when few are left, several attempts at each. So a scene depends neither on the size of
the block nor on the order of evaluation. Runs that the graph does not describe are left to the interpreter, one by one.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...interpreter.choosers import AS_THEY_ARE, Draws, from_stream
from ...interpreter.running import Accepted, run
from ...interpreter.scenes import Scene, scene_of
from ...semantics.config import Config
from ...semantics.errors import ScenicError
from ...semantics.outcome import Requirement
from ...semantics.symbols import NotLifted
from ..rejection import DEFAULT_ATTEMPTS, exhausted
from .columns import ACCEPTED, LEFT, Columns, evaluate, rejection_rates
from .plan import Step, plan
from .scenes import Template, scenes_of, template_of
from .tracing import trace

if TYPE_CHECKING:
    from .compiling import Fused

WAVE = 1 << 14
"""Runs that are evaluated at a time: their columns fit into the caches."""
LOOKED_AT = 512
"""Runs by which it is found out how often each requirement rejects."""
WASTE = 0.25
"""So many of the attempts at a scene that are evaluated at a time may be expected to be in vain."""


COMPILE_LEAST, COMPILE_NODE = 1.5, 0.012
"""Seconds that compiling takes, by and large: at least, and for each node."""


LARGEST_COMPILED = 4000
"""Nodes of the largest graph that is compiled: the time grows faster than their number."""


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
    """A program as a graph, ready to be evaluated. Raises `NotLifted` with the reason if it is none.

    `draws` are distributions that points are drawn from instead (see `inference.pruning`).
    """

    def __init__(self, start: Callable[[], Config], *, fuel: int, draws: Draws = AS_THEY_ARE) -> None:
        self.start = start
        self.fuel = fuel
        self.draws = draws
        graph, state = trace(start, fuel, draws)
        self.graph = graph
        self.template: Template = template_of(state, pruned=bool(draws))
        self.outputs = list({node.number: node for node in self.template.outputs}.values())
        self.steps: tuple[Step, ...] = plan(graph, self.outputs, rejection_rates(graph, LOOKED_AT))
        self.fused: Fused | None = None
        self.not_fused = ""
        self.spent = 0.0

    def compile(self) -> bool:
        """Use the compiled evaluator from now on, if there is one; else `not_fused` says why. Takes seconds."""
        if len(self.graph.nodes) > LARGEST_COMPILED:
            self.not_fused = f"{len(self.graph.nodes):,} operations take minutes to compile"
        if self.fused is None and not self.not_fused:
            try:
                from .compiling import Fused
                from .fused import NotFused
            except ImportError:
                self.not_fused = "numba is not installed"
                return False
            try:
                self.fused = Fused(self.steps, self.outputs)
            except NotFused as problem:
                self.not_fused = str(problem)
        return self.fused is not None

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
        """Scenes `start` to `stop - 1`.

        Once the columns have taken as long as compiling is expected to take, the compiled evaluator does the rest.
        """
        if self.spent > COMPILE_LEAST + COMPILE_NODE * len(self.graph.nodes):
            self.compile()
        begun = time.monotonic()
        drawing = Drawing(self, seed, start, stop, max_attempts)
        while len(drawing.pending):
            if self.fused is not None:
                drawing.compiled(self.fused)
            else:
                drawing.wave()
        self.spent += 0.0 if self.fused is not None else time.monotonic() - begun
        return drawing.block()


class Drawing:
    """The drawing of a block: which scenes are pending, at which attempt they are, and what is done."""

    def __init__(self, batch: Batch, seed: int, start: int, stop: int, max_attempts: int) -> None:
        self.batch, self.seed, self.start, self.stop, self.max_attempts = batch, seed, start, stop, max_attempts
        self.done = np.full(stop - start, -1, dtype=np.int64)  # the attempt that gave the scene
        self.pending = np.arange(stop - start)
        self.next = np.zeros(stop - start, dtype=np.int64)  # the attempt that comes next
        self.stuck: Counter[Requirement] = Counter()
        self.others: dict[int, Scene] = {}
        self.pieces: list[tuple[np.ndarray, Columns]] = []
        self.runs = self.left = self.found = 0
        self.error: ScenicError | None = None

    def wave(self) -> None:
        """The next attempts at all pending scenes, on columns."""
        pending, count = self.pending, len(self.pending)
        rate = max(self.found, 1) / self.runs if self.runs else 1.0
        room = self.max_attempts - int(self.next[pending].max())
        width = int(max(1, min(WAVE // count, 2 * WASTE / rate, room)))
        scenes = np.repeat(pending, width)
        attempts = self.next[scenes] + np.tile(np.arange(width), count)
        result = evaluate(self.batch.steps, self.seed, (scenes + self.start).astype(np.uint64), attempts.astype(np.uint64))
        self.runs += len(scenes)
        decided = result.fate.reshape(count, width) < 0
        has, first = decided.any(axis=1), decided.argmax(axis=1)
        chosen = np.flatnonzero(has) * width + first[has]
        self.next[pending] += np.where(has, first, width)
        self.count(result.fate.reshape(count, width)[np.arange(width) < np.where(has, first, width)[:, None]])
        left = result.fate[chosen] == LEFT
        alive = np.flatnonzero(result.fate == ACCEPTED)
        accepted = chosen[~left]
        kept = np.isin(alive, accepted)
        self.accept(scenes[accepted], {number: column[kept] for number, column in result.columns.items()})
        for place in scenes[chosen[left]].tolist():
            self.interpret(place)
        self.go_on()

    def count(self, steps: np.ndarray) -> None:
        """Runs were rejected at these steps."""
        for number, often in enumerate(np.bincount(steps).tolist()):
            event = self.batch.steps[number].event
            if often and event is not None and event.requirement is not None:
                self.stuck[event.requirement] += often

    def compiled(self, fused: Fused) -> None:
        """All pending scenes, one after the other."""
        room = fused.room(len(self.done))
        drawn = fused.draw(self.seed, self.start, self.next, self.pending, self.max_attempts, room)
        self.runs += drawn.runs
        self.stuck += drawn.stuck
        here = self.pending[(drawn.done[self.pending] >= 0) & ~drawn.left[self.pending]]
        self.next[drawn.done >= 0] = drawn.done[drawn.done >= 0]
        self.accept(here, fused.columns(room, here))
        for place in np.flatnonzero(drawn.left).tolist():
            self.interpret(place)
        self.go_on()

    def accept(self, places: np.ndarray, columns: Columns) -> None:
        """These scenes are drawn, by the attempts that came next."""
        self.done[places] = self.next[places]
        self.found += len(places)
        self.pieces.append((places + self.start, columns))

    def interpret(self, place: int) -> None:
        """The next attempt at a scene, by the interpreter: the graph does not describe it."""
        self.left += 1
        index, attempt = place + self.start, int(self.next[place])
        try:
            ended = run(self.batch.start(), from_stream(self.seed, index, attempt, self.batch.draws), fuel=self.batch.fuel)
        except ScenicError as problem:
            self.fail(problem, index)
            return
        if isinstance(ended, Accepted):
            self.others[index] = scene_of(ended.state, self.seed, index, attempt + 1, pruned=bool(self.batch.draws))
            self.done[place] = attempt
            self.found += 1
        else:
            self.stuck[ended.requirement] += 1
            self.next[place] += 1

    def fail(self, problem: ScenicError, index: int) -> None:
        """The block ends before scene `index`, if it does not end earlier."""
        if index < self.stop:
            self.error, self.stop = problem, index

    def go_on(self) -> None:
        """Find out which scenes are still to be drawn."""
        pending = self.pending[self.done[self.pending] < 0]
        out = pending[self.next[pending] >= self.max_attempts]
        if len(out):
            worst, often = self.stuck.most_common(1)[0]
            text = f"no scene in {self.max_attempts:,} attempts: most often ({often:,} times in {self.runs:,} runs) this failed: {worst.text}"
            self.fail(exhausted(text, self.max_attempts, self.stuck), int(out[0]) + self.start)
        self.pending = pending[pending < self.stop - self.start]

    def block(self) -> Block:
        """The pieces put together, in the order of the scenes, without those behind an error."""
        rows = np.concatenate([r for r, _ in self.pieces]) if self.pieces else np.zeros(0, dtype=np.int64)
        order = np.argsort(rows)
        order = order[rows[order] < self.stop]
        columns = {node.number: np.concatenate([c[node.number] for _, c in self.pieces])[order] for node in self.batch.outputs}
        others = {index: scene for index, scene in self.others.items() if index < self.stop}
        done = self.done[: self.stop - self.start]
        return Block(self.start, done, rows[order], columns, others, self.stuck, self.runs, self.left, self.error)


__all__ = ["Batch", "Block", "NotLifted"]
