"""The evaluation of runs on tensors: what becomes of each is what the columns say, and the numbers of the scenes are theirs up to `ROUNDING`.

Rows that rounding might decide are evaluated again, by the columns.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from ....semantics.kernel.outcome import Requirement
from ..evaluate import columns
from ..evaluate.columns import ACCEPTED, LEFT, Evaluated
from ..evaluate.numbers import Numbers
from ..evaluate.plan import PlanStep
from ..evaluate.rows import Columns
from ..trace.graph import Graph, GraphEvent, GraphNode
from .arithmetic import ROUNDING
from .columns import TensorColumns, numpy_of
from .draws import DeviceNumbers, MovedNumbers
from .kit import Kit, device_of

DOUBTFUL = -3
"""What becomes of a run is for the columns to say."""


class TensorEvaluator:
    """Evaluates the runs of a graph on a device, "cpu" or "cuda", for some outputs. Raises `UsageError` if the device cannot be used.

    With `draws_there`, random numbers are computed on the device.
    """

    def __init__(self, graph: Graph, outputs: Sequence[GraphNode], device: str) -> None:
        self.kit = Kit(graph, device_of(device))
        self.outputs = tuple(outputs)
        self.draws_there = device != "cpu"

    def evaluate(self, steps: Sequence[PlanStep], seed: int, scenes: np.ndarray, attempts: np.ndarray) -> Evaluated:
        """As `evaluate.columns.evaluate`; the columns are those of the outputs."""
        with torch.inference_mode():
            fate, rows, made, reasons = self.first(steps, seed, scenes, attempts)
        doubtful = np.flatnonzero(fate == DOUBTFUL)
        if not len(doubtful):
            return Evaluated(fate, made, reasons)
        again = columns.evaluate(steps, seed, scenes[doubtful], attempts[doubtful])
        fate[doubtful] = again.fate
        reasons |= {int(doubtful[row]): reason for row, reason in again.reasons.items()}
        order = np.argsort(np.concatenate([rows, doubtful[again.fate == ACCEPTED]]))
        both = {number: np.concatenate([values, again.columns[number]])[order] for number, values in made.items()}
        return Evaluated(fate, both, reasons, len(doubtful))

    def first(
        self, steps: Sequence[PlanStep], seed: int, scenes: np.ndarray, attempts: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, Columns, dict[int, Requirement]]:
        """What becomes of each row as far as tensors tell, the rows that are accepted, their outputs, and the `Evaluated.reasons`."""
        fate, rows = np.full(len(scenes), ACCEPTED, dtype=np.int32), np.arange(len(scenes))
        numbers = Numbers(seed, scenes, attempts)
        device = self.kit.device
        drawn = DeviceNumbers(seed, scenes, attempts, device) if self.draws_there else MovedNumbers(numbers, device)
        going = TensorColumns(self.kit, numbers, drawn)
        reasons: dict[int, Requirement] = {}
        for number, step in enumerate(steps):
            going.compute(step.nodes)
            if step.event is None:
                self.round(going)
                lost = left = np.zeros(len(rows), dtype=bool)
            else:
                lost, left = looked_at(step.event, going)
                going.forget(step.forget)
            doubtful = numpy_of(going.doubts.rows)
            fate[rows[lost]], fate[rows[left]], fate[rows[doubtful]] = number, LEFT, DOUBTFUL
            if step.event is not None and step.event.node.number in going.failed:
                own = going.failed[step.event.node.number].reasons_of(lost & ~doubtful, step.event)
                reasons |= {int(rows[k]): reason for k, reason in own.items()}
            kept = ~(lost | left | doubtful)
            if not kept.all():
                rows = rows[kept]
                going.keep(kept)
        return fate, rows, {node.number: going.as_numpy(node.number) for node in self.outputs}, reasons

    def round(self, going: TensorColumns) -> None:
        """Doubt the rows whose outputs might be further than `ROUNDING` from those of the columns."""
        for node in self.outputs:
            made = going.get(node.number)
            if made is not None and made.error > ROUNDING:
                going.doubts.add(made.error > ROUNDING * made.values.abs())


def looked_at(event: GraphEvent, going: TensorColumns) -> tuple[np.ndarray, np.ndarray]:
    """Which rows an event rejects, and which it leaves to the interpreter."""
    none = np.zeros(len(going.numbers), dtype=bool)
    applies = True if event.condition is None else going.as_numpy(event.condition.number)
    node = event.node
    if event.kind != "call":
        wrong = (going.as_numpy(node.number) != event.expected) & applies
        return (none, wrong) if event.kind == "guard" else (wrong, none)
    if node.number in going.failed:
        found = going.failed[node.number]
        return found.rejected & ~found.left & applies, found.left & applies
    made = going.get(node.number)
    if made is None or node.kind != "float":
        return none, none
    return numpy_of(made.values.isnan()) & applies, none


__all__ = ["TensorEvaluator"]
