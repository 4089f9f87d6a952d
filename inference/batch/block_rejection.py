"""Rejection on columns: the same scenes as the interpreter's, many at a time.

A scene is that of the first attempt that is accepted. A block of scenes is drawn in waves: the first attempt at all of them, then the
second at those without a scene, and so on; when few are left, several attempts at each. So a scene depends neither on the size of
the block nor on the order of evaluation. Runs that the graph does not describe are left to the interpreter, one by one.

Where rejection is factorised (see `components`), each component has attempts of its own, counted through the whole drawing of a scene: every
attempt at a component has the next number of each of its parts that is accepted.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...data.scene import Scene, scene_of
from ...interpreter.runtime.answerers import AS_THEY_ARE, Draws, from_stream
from ...interpreter.runtime.optional_packages import why_missing
from ...interpreter.runtime.program_run import Accepted, Beginnings, generate_scene
from ...semantics.machine.config import Config
from ...semantics.machine.outcome import Requirement
from ...semantics.space.symbol_seam import NotLifted
from ...semantics.store.errors import ScenicError
from ..rejection import DEFAULT_ATTEMPTS, no_scene_error
from .factorised_rejection import Component, Stage, components, describe_factorisation, stages, worthwhile
from .numpy_evaluator import ACCEPTED, LEFT, Evaluated, evaluate, rejection_rates
from .row_calls import Columns
from .scene_template import Template, scenes_of, template_of
from .symbolic import nodes_in
from .torch_devices import check_device
from .tracing import trace_program

if TYPE_CHECKING:
    from .numba_evaluator import CompiledStage
    from .torch_evaluator import TensorEvaluator

WAVE = 1 << 14
"""Runs that are evaluated at a time: their columns fit into the caches."""
LOOKED_AT = 512
"""Runs that show how often each requirement rejects."""
WASTE = 0.25
"""The share of the attempts at a scene, of those evaluated at a time, that may be expected to be in vain."""
FEW = 512
"""Fewer runs than this take no less time, if their scenes have no more than `FEW_OBJECTS` objects."""
FEW_OBJECTS = 200

COMPILE_LEAST, COMPILE_NODE = 2.5, 0.009
"""Seconds of a processor that compiling takes, by and large: at least (the compiler itself must be loaded), and for each node."""

PACE_KNOWN = 0.25
"""The share of that time after which the pace of the columns is known."""
LARGEST_COMPILED = 4000
"""Nodes of the largest graph that is compiled: the time grows faster than their number."""


class Block(NamedTuple):
    """Scenes `start` to `start + len(block) - 1`: of those in `columns` row k is scene `rows[k]`; `others` were left to the interpreter.

    `attempts_by_stage[s, k]` is the attempt, counted from 0, that gave component s of scene `start + k`; there is more than one component only where
    rejection is factorised. `error` is what ended the block early, at the scene behind the last.
    """

    start: int
    attempts_by_stage: np.ndarray
    rows: np.ndarray
    columns: Columns
    others: dict[int, Scene]
    stuck: Counter[Requirement]
    runs: int
    left: int
    error: ScenicError | None
    doubtful: int = 0
    """Runs that rounding might have decided on tensors, so that the columns did them."""

    @property
    def attempts(self) -> np.ndarray:
        """The attempt that gave each scene, counted from 0: the last one at the component with the most."""
        return self.attempts_by_stage.max(axis=0)


class Batch:
    """A program as a graph, ready to be evaluated. Raises `NotLifted` with the reason if it cannot be made one.

    `draws` are distributions that points are drawn from instead (see `inference.pruning`); with `factorised`, components are drawn apart.
    """

    may_compile = True
    """Whether `block` goes over to compiled code by itself."""

    def __init__(self, start: Callable[[], Config], *, fuel: int, draws: Draws = AS_THEY_ARE, factorised: bool = False) -> None:
        self.start = start
        self.fuel = fuel
        self.draws = draws
        graph, state = trace_program(start, fuel, draws)
        self.graph = graph
        rejects = rejection_rates(graph, LOOKED_AT)
        whole = worthwhile(graph, components(graph), rejects) if factorised else Component(frozenset(), tuple(range(len(graph.events))))
        self.template: Template = template_of(state, pruned=bool(draws or whole.parts))
        self.outputs = list({node.number: node for node in self.template.outputs}.values())
        self.whole = whole
        self.stage = stages(graph, whole, self.outputs, rejects)
        self.compiled: CompiledStage | None = None
        self.not_compiled = ""
        self.tensors: TensorEvaluator | None = None
        self.spent, self.pace = 0.0, 0.0  # seconds of a processor on columns, and for a scene of the last block
        self.drawing: BlockDrawing | None = None
        """What is being drawn, or was last: its `runs` tell how far that is."""

    def compile(self) -> bool:
        """Use the compiled evaluator from now on, if there is one; else `not_compiled` says why. Takes seconds."""
        if len(self.graph.nodes) > LARGEST_COMPILED:
            self.not_compiled = f"{len(self.graph.nodes):,} operations take minutes to compile"
        if self.compiled is None and not self.not_compiled:
            try:
                from .numba_codegen import NotCompiled
                from .numba_evaluator import CompiledStage
            except ImportError as problem:
                self.not_compiled = why_missing("numba", problem)
                return False
            try:
                self.compiled = CompiledStage(self.stage)
            except NotCompiled as problem:
                self.not_compiled = str(problem)
        return self.compiled is not None

    def use_tensors(self, device: str) -> None:
        """Evaluate by torch on a device from now on, unless components are drawn apart: columns do that. Raises as `devices.check_device` does."""
        check_device(device)
        if not self.stage.parts:
            from .torch_evaluator import TensorEvaluator

            self.tensors = TensorEvaluator(self.graph, self.outputs, device)

    def scenes(self, n: int, seed: int, *, start: int = 0, max_attempts: int = DEFAULT_ATTEMPTS) -> Iterator[Scene]:
        """Scenes `start` to `start + n - 1` of `seed`. Raises the program's errors, and `AttemptsExhausted`."""
        for first in range(start, start + n, WAVE):
            block = self.block(seed, first, min(first + WAVE, start + n), max_attempts=max_attempts)
            yield from self.scenes_of(block, seed)
            if block.error is not None:
                raise block.error

    @property
    def parts(self) -> list[str]:
        """The lines of a report: the parts that are drawn separately under factorised rejection, or the
        reason why none are.
        """
        objects = enumerate(self.template.objects)
        places = [(o.name or f"{o.class_name} (object {k})", nodes_in(o.properties["position"])) for k, o in objects]
        return describe_factorisation(self.graph, self.whole, places)

    def attempts_of(self, block: Block, index: int) -> Callable[[tuple[int, ...]], int]:
        """By the address of a draw, the attempt whose number scene `index` has."""
        stage_of = {address: stage.number for stage in self.stage.all for address in stage.own}
        attempts = block.attempts_by_stage[:, index - block.start].tolist()
        return lambda address: attempts[stage_of.get(address, 0)]

    def scenes_of(self, block: Block, seed: int) -> Iterator[Scene]:
        """The scenes of a block, in order."""
        made = scenes_of(self.template, block.columns, seed, block.rows, block.attempts[block.rows - block.start])
        for index in range(block.start, block.start + len(block.attempts)):
            yield block.others[index] if index in block.others else next(made)

    @property
    def compiling(self) -> float:
        """The seconds of a processor that compiling is expected to take."""
        return COMPILE_LEAST + COMPILE_NODE * len(self.graph.nodes)

    def block(
        self, seed: int, start: int, stop: int, *, max_attempts: int = DEFAULT_ATTEMPTS, ahead: int = 0, first: int = 0
    ) -> Block:
        """Scenes `start` to `stop - 1`, by attempts from number `first` on; about `ahead` more will be asked for, as far as is known.

        Once the columns have taken as long as compiling is expected to take, or will by what is known of their pace, the compiled evaluator
        does the rest. Small blocks, which come first, tell little of the pace.
        """
        compiling = self.compiling
        if self.may_compile and self.tensors is None and self.spent > PACE_KNOWN * compiling and self.spent + self.pace * ahead > compiling:
            self.compile()
        begun = time.thread_time()
        self.drawing = drawing = BlockDrawing(self, seed, start, stop, max_attempts, first)
        while len(drawing.pending):
            if self.compiled is None and self.may_compile and self.tensors is None and self.spent + time.thread_time() - begun > compiling:
                self.compile()
            if self.compiled is not None:
                drawing.on_compiled(self.compiled)
            else:
                drawing.wave()
        if self.compiled is None:
            took = time.thread_time() - begun
            self.spent, self.pace = self.spent + took, took / max(stop - start, 1)
        return drawing.block()


class BlockDrawing:
    """The drawing of a block: which scenes are pending, at which attempt they are, and what is done."""

    def __init__(self, batch: Batch, seed: int, start: int, stop: int, max_attempts: int, first: int = 0) -> None:
        self.batch, self.seed, self.start, self.stop, self.max_attempts = batch, seed, start, stop, max_attempts
        self.begin = Beginnings(batch.start, batch.fuel)
        self.stages = batch.stage.all
        self.done = np.zeros(stop - start, dtype=bool)
        self.pending = np.arange(stop - start)
        self.next = np.full((len(self.stages), stop - start), first, dtype=np.int64)  # by stage: the attempt that comes next, or that was accepted
        self.exhausted = np.zeros(stop - start, dtype=bool)  # a part of the scene has had all attempts
        self.stuck: Counter[Requirement] = Counter()
        self.others: dict[int, Scene] = {}
        self.pieces: list[tuple[np.ndarray, Columns]] = []
        self.found, self.tried = np.zeros(len(self.stages)), np.zeros(len(self.stages))  # by stage: successes, attempts
        self.few = FEW * FEW_OBJECTS // max(len(batch.template.objects), FEW_OBJECTS)
        self.runs = self.left = self.doubtful = 0
        self.error: ScenicError | None = None

    # On columns

    def wave(self) -> None:
        """The next attempts at all pending scenes, on columns."""
        whole, pending = self.batch.stage, self.pending
        found, left, columns = self.attempt(whole, pending)
        self.accept(pending[found & ~left], columns)
        for place in pending[left].tolist():
            self.interpret(place)
        self.go_on()

    def attempt(self, stage: Stage, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, Columns]:
        """The next attempts at a stage of some scenes, after its parts: where one is accepted, where the interpreter must do it, and the
        columns of those that are accepted.

        Where few scenes are left, several attempts are made at each, unless their parts would have to be drawn for each.
        """
        number = stage.number
        known = {name: column for part in stage.parts for name, column in self.settled(part, places).items()}
        alive = np.flatnonzero(~self.exhausted[places])
        scenes_at, count = places[alive], len(alive)
        found, left = np.zeros(len(places), dtype=bool), np.zeros(len(places), dtype=bool)
        if not count:
            return found, left, {}
        rate = max(self.found[number], 1) / self.tried[number] if self.tried[number] else 1.0
        room = self.max_attempts - int(self.next[number, scenes_at].max())
        width = 1 if stage.parts else int(max(1, min(WAVE // count, max(2 * WASTE / rate, self.few // count), room)))
        scenes = np.repeat(scenes_at, width)
        attempts = self.next[number, scenes] + np.tile(np.arange(width), count)
        numbers = (scenes + self.start).astype(np.uint64), attempts.astype(np.uint64)
        if self.batch.tensors is not None:
            result = self.batch.tensors.evaluate(stage.steps, self.seed, *numbers)
        else:
            result = evaluate(stage.steps, self.seed, *numbers, {name: column[alive] for name, column in known.items()})
        self.doubtful += result.doubtful
        fate = result.fate.reshape(count, width)
        has, first = (fate < 0).any(axis=1), (fate < 0).argmax(axis=1)
        used = np.where(has, first, width)
        self.next[number, scenes_at] += used
        self.tried[number] += len(scenes)
        self.found[number] += has.sum()
        self.runs += len(scenes)
        self.count(stage, result, (np.arange(width) < used[:, None]).ravel())
        self.again(stage, scenes_at[~has])
        found[alive], left[alive] = has, has & (fate[np.arange(count), first] == LEFT)
        kept = np.isin(np.flatnonzero(result.fate == ACCEPTED), np.flatnonzero(has) * width + first[has])
        return found, left, {name: column[kept] for name, column in result.columns.items()}

    def settled(self, stage: Stage, places: np.ndarray) -> Columns:
        """A part of some scenes, drawn until it is accepted; anything at all for those where attempts are exhausted."""
        columns: dict[int, np.ndarray] = {n.number: np.zeros(len(places), dtype=n.kind) for n in stage.outputs}
        waiting = np.flatnonzero(~self.exhausted[places])
        while True:
            out = self.next[stage.number, places[waiting]] >= self.max_attempts
            self.exhausted[places[waiting[out]]] = True
            waiting = waiting[~self.exhausted[places[waiting]]]
            if not len(waiting):
                return columns
            here = places[waiting]
            found, _, made = self.attempt(stage, here)
            for name, column in made.items():
                if columns[name].shape[1:] != column.shape[1:]:  # points are rows of two numbers
                    columns[name] = np.zeros((len(places), *column.shape[1:]), dtype=column.dtype)
                columns[name][waiting[found]] = column
            waiting = waiting[~found]

    def again(self, stage: Stage, places: np.ndarray) -> None:
        """The parts of a stage that failed will be drawn anew, from their next attempts on."""
        for part in stage.parts:
            for inner in part.all:
                self.next[inner.number, places] += 1

    def count(self, stage: Stage, result: Evaluated, rejected: np.ndarray) -> None:
        """Count the attempts at a stage that were rejected, by their requirement."""
        own = [row for row in result.reasons if rejected[row]]
        self.stuck.update(result.reasons[row] for row in own)
        rejected[own] = False
        for number, often in enumerate(np.bincount(result.fate[rejected]).tolist()):
            event = stage.steps[number].event
            if often and event is not None and event.requirement is not None:
                self.stuck[event.requirement] += often

    # Otherwise

    def on_compiled(self, compiled: CompiledStage) -> None:
        """All pending scenes, one after the other. Where only shapely can tell and there are parts, the scene is drawn on columns afterwards."""
        room = compiled.room(self.next.shape[1])
        drawn = compiled.draw(self.seed, self.start, self.next, self.pending, self.max_attempts, room)
        self.runs += drawn.runs
        self.stuck += drawn.stuck
        self.exhausted |= drawn.exhausted
        self.accept(np.flatnonzero(drawn.accepted), compiled.columns(room, drawn.accepted))
        left = np.flatnonzero(drawn.left)
        if len(self.stages) > 1:
            self.on_columns(left, compiled)
        else:
            for place in left.tolist():
                self.interpret(place)
        self.go_on()

    def on_columns(self, left: np.ndarray, compiled: CompiledStage) -> None:
        """Draw scenes from the first attempt on again, which the compiled code has left; what it did for them does not count."""
        if not len(left):
            return
        self.next[:, left] = 0
        before = compiled.draw(self.seed, self.start, self.next.copy(), left, self.max_attempts, compiled.room(self.next.shape[1]))
        self.runs -= before.runs
        self.stuck -= before.stuck
        others = np.setdiff1d(self.pending, left)
        self.pending = left
        while len(self.pending):
            self.wave()
        self.pending = others

    def accept(self, places: np.ndarray, columns: Columns) -> None:
        """Accept scenes that the next attempts have drawn."""
        self.done[places] = True
        if len(places):
            self.pieces.append((places + self.start, columns))

    def interpret(self, place: int) -> None:
        """The next attempt at a scene, by the interpreter: the graph does not describe it."""
        self.left += 1
        index, attempt = place + self.start, int(self.next[0, place])
        try:
            ended = generate_scene(self.begin(), from_stream(self.seed, index, attempt, self.batch.draws), fuel=self.batch.fuel)
        except ScenicError as problem:
            self.fail(problem, index)
            return
        if isinstance(ended, Accepted):
            self.others[index] = scene_of(ended.state, self.seed, index, attempt + 1, pruned=bool(self.batch.draws))
            self.done[place] = True
        else:
            self.stuck[ended.requirement] += 1
            self.next[0, place] += 1

    def fail(self, problem: ScenicError, index: int) -> None:
        """The block ends before scene `index`, if it does not end earlier."""
        if index < self.stop:
            self.error, self.stop = problem, index

    def go_on(self) -> None:
        """Find out which scenes are still to be drawn."""
        pending = self.pending[~self.done[self.pending]]
        out = pending[(self.next[0, pending] >= self.max_attempts) | self.exhausted[pending]]
        if len(out):
            worst, often = self.stuck.most_common(1)[0]
            text = f"no scene in {self.max_attempts:,} attempts: most often ({often:,} times in {self.runs:,} runs) this failed: {worst.text}"
            self.fail(no_scene_error(text, self.max_attempts, self.stuck, seldom=True), int(out[0]) + self.start)
        self.pending = pending[pending < self.stop - self.start]

    def block(self) -> Block:
        """The pieces put together, in the order of the scenes, without those behind an error."""
        rows = np.concatenate([r for r, _ in self.pieces]) if self.pieces else np.zeros(0, dtype=np.int64)
        order = np.argsort(rows)
        order = order[rows[order] < self.stop]
        empty = np.zeros(0)
        columns = {node.number: np.concatenate([c[node.number] for _, c in self.pieces] or [empty])[order] for node in self.batch.outputs}
        others = {index: scene for index, scene in self.others.items() if index < self.stop}
        attempts = self.next[:, : self.stop - self.start]
        assert len(order) + len(others) == attempts.shape[1]
        return Block(self.start, attempts, rows[order], columns, others, self.stuck, self.runs, self.left, self.error, self.doubtful)


__all__ = ["Batch", "Block", "NotLifted"]
