"""Importance sampling: runs from the smaller regions of pruning, with the coins of soft requirements counted instead of thrown.

A run that meets all hard requirements is kept, with the probability that the coins of the soft requirements which it violates show tails as its
weight. So weights are exact: the scenes with their weights have the distribution of the program, and the mean weight of all runs is the
probability that a run is accepted.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.special import betaincinv

from ..data.scene import Scene, scene_of
from ..interpreter.runtime.random_streams import fold
from ..semantics.machine.outcome import Requirement
from .batch import Batch
from .batch.row_calls import FailedRows, note
from .batch.scene_template import scenes_of
from .chain_diagnostics import Diagnosis
from .moves.states import Evaluation, States
from .moves.target import Target
from .rejection import DEFAULT_ATTEMPTS, no_scene_error
from .result import LEVEL, Inferred, Probability

BLOCK = 1 << 14
OnScenes = Callable[[int], None]
"""Is told how many scenes there are."""


class Weighing:
    """The runs of a batch with their weights."""

    def __init__(self, batch: Batch, seed: int) -> None:
        self.target = Target(batch, seed)
        self.batch = batch
        self.coins = batch.graph.coins
        self.stuck: Counter[Requirement] = Counter()

    def weigh(self, states: States) -> tuple[np.ndarray, np.ndarray, dict[int, np.ndarray]]:
        """The weight of each run, the rows that the graph describes and whose weight is positive, and their columns."""
        going = Evaluation(self.target.space, states)
        weights = np.ones(len(states))
        left = np.zeros(len(states), dtype=bool)
        violated = {condition: np.zeros(len(states), dtype=bool) for condition in self.coins}
        for step in self.target.steps:
            going.compute(step)
            event, rows, columns = step.event, going.rows, going.columns
            if event is None:
                break
            none = np.zeros(len(rows), dtype=bool)
            found = going.failed.get(event.node.number, FailedRows(none, none)) if event.kind == "call" else None
            lost = found.rejected if found is not None else columns[event.node.number] != event.expected
            unsure = found.left if found is not None else lost if event.kind == "guard" else none
            condition = None if event.condition is None else event.condition.number
            if condition in self.coins and event.kind != "guard":
                violated[condition][rows[lost]] = True
                lost = none
            elif event.condition is not None:
                applies = columns[event.condition.number].astype(bool)
                lost, unsure = lost & applies, unsure & applies
            left[rows[unsure]] = True
            lost = lost & ~unsure
            if lost.any() or unsure.any():
                weights[rows[lost]] = 0.0
                note(self.stuck, event, lost, going.failed)
                going.keep(~(lost | unsure))
        for condition, share in self.coins.items():
            weights[violated[condition] & ~left] *= 1.0 - share
        for row in np.flatnonzero(left).tolist():  # with the coins that the state throws
            weights[row] = float(self.target.interpreted(states, row) is not None)
        own = weights[going.rows] > 0
        return weights, going.rows[own], {name: values[own] for name, values in going.columns.items()}


def draw_importance(
    batch: Batch, n: int, seed: int, *, share: float = 1.0, resample: bool = False, max_attempts: int = DEFAULT_ATTEMPTS,
    on_scenes: OnScenes | None = None,
) -> Inferred:  # fmt: skip
    """`n` scenes with weights; with `resample`, scenes of weight 1 instead, each run being kept with its weight as the probability.

    `share` is as in `smc.draw_smc`. Raises `AttemptsExhausted` after `max_attempts` runs for a scene, `UsageError`, and the program's errors.
    """
    begun = time.process_time()
    weighing = Weighing(batch, seed)
    target = weighing.target
    random = np.random.Generator(np.random.Philox(np.random.SeedSequence(fold(seed))))
    scenes: list[Scene] = []
    totals = np.zeros(3)  # runs, and the sums of their weights and of the squares of these
    is_simple = True
    last = 0
    while len(scenes) < n:
        states = target.simulate(BLOCK, random)
        target.evaluations += BLOCK
        weights, rows, columns = weighing.weigh(states)
        is_simple = is_simple and bool(np.isin(weights, (0.0, 1.0)).all())
        totals += (BLOCK, weights.sum(), (weights**2).sum())
        chosen = np.flatnonzero(random.random(BLOCK) < weights) if resample else np.flatnonzero(weights)
        made = dict(zip(rows.tolist(), scenes_of(batch.template, columns, seed, rows, np.zeros_like(rows)), strict=True)) if len(chosen) else {}
        for row in chosen[: n - len(scenes)].tolist():
            found = made[row] if row in made else interpret_row_scene(weighing, states, row, seed)
            runs = target.evaluations - BLOCK + row + 1
            scenes.append(replace(found, index=len(scenes), attempts=runs - last, weight=1.0 if resample else float(weights[row])))
            last = runs
        if on_scenes is not None:
            on_scenes(len(scenes))
        if len(scenes) < n and target.evaluations - last >= max_attempts:
            if not weighing.stuck:  # only the interpreter knows
                weighing.stuck[target.rejected_by(states, int(np.argmin(weights)))] += 1
            worst, count = weighing.stuck.most_common(1)[0]
            often, runs = f"{count:,} of {target.evaluations:,} runs", f"{target.evaluations - last:,} runs"
            text = f"no scene in {f'the last {runs}' if last else runs}: most often ({often}{' in all' * bool(last)}) this failed: {worst.text}"
            raise no_scene_error(text, target.evaluations, weighing.stuck)
    acceptance = mean_weight(*totals.tolist(), share=share, is_simple=is_simple)
    effective = float(totals[1] ** 2 / totals[2])
    own = np.array([s.weight for s in scenes])
    worth = own.sum() ** 2 / (own**2).sum()
    notes = () if worth > 0.999 * n else (f"the {n:,} scenes have weights: they are worth {worth:.0f} of weight 1; --resample gives such ones",)
    diagnosis = Diagnosis(1.0, effective, effective, 0)
    unseen = 0.0 if is_simple or resample else 1 - acceptance.estimate / acceptance.high
    return Inferred("importance", scenes, acceptance, target.evaluations, diagnosis, "", time.process_time() - begun, notes, unseen=unseen)


def interpret_row_scene(weighing: Weighing, states: States, row: int, seed: int) -> Scene:
    """The scene of a run that the interpreter did."""
    ended = weighing.target.interpreted(states, row)
    assert ended is not None
    return scene_of(ended.state, seed, 0, 1, pruned=bool(weighing.batch.draws))


def mean_weight(runs: float, total: float, squares: float, *, share: float, is_simple: bool) -> Probability:
    """The mean weight of independent runs, times `share`, with bounds that hold for any number of runs.

    They are those of Clopper and Pearson where weights are 0 and 1, else the empirical Bernstein bounds of Maurer and Pontil (2009, theorem 4).
    """
    if runs == 0:
        return Probability(math.nan, 0.0, share, LEVEL)
    mean, rest = total / runs, (1 - LEVEL) / 2
    if is_simple:
        low = float(betaincinv(total, runs - total + 1, rest)) if total else 0.0
        high = float(betaincinv(total + 1, runs - total, 1 - rest)) if total < runs else 1.0
    else:
        once = math.log(2 / rest)
        variance = max(squares - runs * mean**2, 0.0) / (runs - 1)
        half = math.sqrt(2 * variance * once / runs) + 7 * once / (3 * (runs - 1))
        low, high = max(mean - half, 0.0), min(mean + half, 1.0)
    return Probability(mean * share, low * share, high * share, LEVEL)
