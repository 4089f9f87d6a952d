"""Blocks of scenes drawn by the compiled evaluator, run after run."""

from __future__ import annotations

import signal
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NamedTuple

import numpy as np

from ...interpreter.runtime.random_streams import fold
from ...semantics.machine.outcome import Requirement
from .factorised_rejection import Stage
from .numba_codegen import ACCEPTED, EXHAUSTED, LEFT, PENDING, NotCompiled, compile_stage
from .row_calls import Columns

BUDGET = 1 << 22
"""Runs between which Python is asked whether it was interrupted."""


class BlockResult(NamedTuple):
    """Which scenes of a block were accepted, left to others, or had all attempts at a part of theirs."""

    accepted: np.ndarray
    left: np.ndarray
    exhausted: np.ndarray
    stuck: Counter[Requirement]
    runs: int


@contextmanager
def later_interrupts() -> Iterator[None]:
    """Let Ctrl-C wait until the block is over: the compiler's library calls Python, and ignores what is raised there."""
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) in (signal.SIG_IGN, signal.SIG_DFL, None):
        yield
        return
    heard: list[tuple[int, FrameType | None]] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: heard.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if heard and callable(before):
            before(*heard[0])


class CompiledStage:
    """A program's compiled evaluator. Raises `NotCompiled` if the graph has none; the first call takes seconds."""

    def __init__(self, stage: Stage) -> None:
        self.outputs = stage.outputs
        with later_interrupts():
            self.prepare(stage)

    def prepare(self, stage: Stage) -> None:
        """Compile, and call the evaluator for the first time. Raises `NotCompiled`."""
        self.evaluator, self.arrays, self.events = compile_stage(stage)
        self.floats = sum(node.kind == "float" for node in self.outputs)
        self.runs = 0
        """How many runs the call of `draw` that is under way has made."""
        try:
            self.call(0, 0, np.zeros((len(stage.all), 1), dtype=np.int64), np.zeros(0, dtype=np.int64), 1, self.room(1), *self.blank(1))
        except Exception as problem:  # whatever the compiler cannot do, the columns can
            raise NotCompiled(f"numba gives up ({type(problem).__name__})") from None

    def room(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Arrays for the results of `count` scenes: floats, and whole numbers and truth values."""
        return np.empty((self.floats, count)), np.empty((len(self.outputs) - self.floats, count), dtype=np.int64)

    def draw(self, seed: int, start: int, first: np.ndarray, live: np.ndarray, most: int, room: tuple[np.ndarray, np.ndarray]) -> BlockResult:
        """Scenes `start + live`, each from the attempts `first[:, live]` on, a row for each stage; `first` says afterwards where they stand."""
        fate, counts = self.blank(first.shape[1])
        self.runs = 0
        while len(live):
            self.runs += self.call(seed, start, first, live, most, room, fate, counts)
            live = live[(fate[live] == PENDING) & (first[0, live] < most)]
        stuck: Counter[Requirement] = Counter()
        for event, count in zip(self.events, counts.tolist(), strict=True):
            if event.requirement is not None and count:
                stuck[event.requirement] += count
        runs, self.runs = self.runs, 0
        return BlockResult(fate == ACCEPTED, fate == LEFT, fate == EXHAUSTED, stuck, runs)

    def blank(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """For `count` scenes, of which nothing is known: their fates, and how often each event rejected."""
        return np.full(count, PENDING, dtype=np.int64), np.zeros(len(self.events), dtype=np.int64)

    def call(
        self, seed: int, start: int, first: np.ndarray, live: np.ndarray, most: int, room: tuple[np.ndarray, np.ndarray],
        fate: np.ndarray, counts: np.ndarray,
    ) -> int:  # fmt: skip
        """Let the evaluator run, for so few runs that one can interrupt it; how many there were."""
        runs, _ = self.evaluator(np.uint64(fold(seed)), start, first, live, most, BUDGET, fate, *room, counts, *self.arrays)  # type: ignore[misc, call-arg, arg-type]
        return runs

    def columns(self, room: tuple[np.ndarray, np.ndarray], kept: np.ndarray) -> Columns:
        """The results of some scenes as the columns of the outputs."""
        floats, whole = iter(room[0]), iter(room[1])
        made: Columns = {}
        for node in self.outputs:
            column = next(floats if node.kind == "float" else whole)[kept]
            made[node.number] = column.astype(bool) if node.kind == "bool" else column
        return made
