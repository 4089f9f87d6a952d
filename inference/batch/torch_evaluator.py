"""The columns of a graph as tensors: what torch computes, and beside it what is left to NumPy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from ...interpreter.runtime.answerers import PER_SCENE
from ...interpreter.runtime.random_streams import (
    MULTIPLIER_0,
    MULTIPLIER_1,
    ROUNDS,
    UNIT,
    UNUSED_BITS,
    WEYL_0,
    WEYL_1,
    WORD,
    fold,
    site_code,
)
from ...semantics.machine.outcome import Requirement
from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.regions import PolygonalRegion
from . import numpy_evaluator
from .evaluation_plan import PlanStep
from .graph import Graph, GraphEvent, GraphNode, Macro, RowCall, Site
from .numpy_evaluator import ACCEPTED, LEFT, Evaluated, column
from .primitives.point_in_polygon import TIE
from .primitives.random_numbers import Numbers
from .row_calls import Columns, FailedRows
from .symbolic import Traced
from .torch_lowering import ROUNDING, Doubts, Kit, Rounded, constant_tensor, device_of, largest_of, operands_of, truth

LOW, HALF = 0xFFFFFFFF, 32


class TensorNumbers(Protocol):
    """The random numbers of some rows."""

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (rows,)."""
        ...

    def keep(self, kept: Tensor) -> None:
        """Leave out all rows but these, of which the numbers are given."""
        ...


class MovedNumbers:
    """The random numbers of columns on the host, moved to the device; those columns leave out rows."""

    def __init__(self, numbers: Numbers, device: torch.device) -> None:
        self.numbers, self.device = numbers, device

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (rows,)."""
        return torch.from_numpy(self.numbers.column(site)).to(self.device)

    def keep(self, kept: Tensor) -> None:
        """Nothing: the columns have done it."""


class DeviceNumbers:
    """The random numbers computed on the device, so that nothing need be moved there; `scenes` and `attempts`
    are uint64.
    """

    def __init__(self, seed: int, scenes: np.ndarray, attempts: np.ndarray, device: torch.device) -> None:
        self.seed = fold(seed)
        self.scenes, self.attempts = (torch.from_numpy(a.view(np.int64)).to(device) for a in (scenes, attempts))
        self.blocks: dict[tuple[object, ...], list[Tensor]] = {}

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (rows,)."""
        block, word = divmod(site.index, 4)
        name = (site.address, block, site.per_scene)
        if name not in self.blocks:
            attempts = torch.full_like(self.scenes, as_signed_word(PER_SCENE)) if site.per_scene else self.attempts
            self.blocks[name] = philox_tensors((self.seed, site_code(site.address)), self.scenes, attempts, block)
        return logical_shift_right(self.blocks[name][word], UNUSED_BITS).to(torch.float64) * UNIT

    def keep(self, kept: Tensor) -> None:
        """Leave out all rows but these, of which the numbers are given."""
        self.scenes, self.attempts = self.scenes.index_select(0, kept), self.attempts.index_select(0, kept)
        self.blocks = {name: [words.index_select(0, kept) for words in block] for name, block in self.blocks.items()}


def philox_tensors(key: tuple[int, int], scenes: Tensor, attempts: Tensor, block: int) -> list[Tensor]:
    """Philox4x64-10 of the counters (scene, attempt, block, 0): its four words, each (rows,), in int64 with the bits of uint64."""
    k0, k1 = key
    c0, c1, c2, c3 = scenes, attempts, torch.full_like(scenes, block), torch.zeros_like(scenes)
    for _ in range(ROUNDS):
        high0, low0 = product(MULTIPLIER_0, c0)
        high1, low1 = product(MULTIPLIER_1, c2)
        c0, c1, c2, c3 = high1 ^ c1 ^ as_signed_word(k0), low1, high0 ^ c3 ^ as_signed_word(k1), low0
        k0, k1 = (k0 + WEYL_0) & WORD, (k1 + WEYL_1) & WORD
    return [c0, c1, c2, c3]


def product(a: int, b: Tensor) -> tuple[Tensor, Tensor]:
    """The high and low words of the 128-bit product of words."""
    a_low, a_high, b_low, b_high = a & LOW, a >> HALF, b & LOW, logical_shift_right(b, HALF)
    middle = a_high * b_low + logical_shift_right(a_low * b_low, HALF)
    other = a_low * b_high + (middle & LOW)
    return a_high * b_high + logical_shift_right(middle, HALF) + logical_shift_right(other, HALF), as_signed_word(a) * b


def logical_shift_right(words: Tensor, bits: int) -> Tensor:
    """Words shifted right, zeros coming in."""
    return (words >> bits) & ((1 << 64 - bits) - 1)


def as_signed_word(word: int) -> int:
    """The number in int64 that has the bits of a word."""
    return word - (1 << 64) if word >> 63 else word


Watch = Callable[[int, Rounded], Rounded]


class TensorColumns(dict[int, Rounded]):
    """The columns of some runs, by the numbers of nodes.

    `numbers` are those of the draws that the columns make, `drawn` the others; `doubts` says which rows rounding might decide. `watch` is
    told of each column that torch computes or is given, and may replace it. With `twice`, torch also computes what NumPy needs for what
    torch lacks, where it can: for gradients.
    """

    def __init__(
        self, kit: Kit, numbers: Numbers, drawn: TensorNumbers, watch: Watch = lambda number, made: made, *, twice: bool = False
    ) -> None:
        super().__init__()
        self.kit, self.numbers, self.drawn, self.watch = kit, numbers, drawn, watch
        self.not_here = kit.lacking if twice else kit.elsewhere
        self.beside: dict[int, np.ndarray] = {}
        self.failed: dict[int, FailedRows] = {}
        self.doubts = Doubts(len(numbers), kit.device)

    def compute(self, nodes: Sequence[GraphNode]) -> None:
        """The columns of some nodes, those before them being known."""
        for node in nodes:
            if node.number in self.kit.elsewhere:
                self.beside[node.number] = column(node, self.beside, self.numbers, self.failed)
            if node.number not in self.not_here:
                self[node.number] = self.watch(node.number, self.column(node))

    def column(self, node: GraphNode) -> Rounded:
        """The column of a node, those of its arguments being known."""
        match node.function:
            case Site() as site:
                return Rounded(self.drawn.column(site), 0.0, 1.0)
            case RowCall() as call:
                return self.test(call)
            case Macro() as macro:
                return self.over_rows(self.inside(macro, node.arguments)[1])
            case _:
                return self.over_rows(self.kit.operation(node)(self.doubts, self))

    def __missing__(self, number: int) -> Rounded:
        """The column of a node that NumPy has computed, moved to the device."""
        values = torch.from_numpy(np.ascontiguousarray(self.beside[number])).to(self.kit.device)
        largest = 1.0 if values.dtype == torch.bool else largest_of(values)
        self[number] = self.watch(number, Rounded(values, 0.0, largest))
        return self[number]

    def operand(self, argument: object) -> Rounded:
        """The column of a node, or a constant."""
        return self[argument.number] if isinstance(argument, GraphNode) else constant_tensor(argument)

    def over_rows(self, found: Rounded) -> Rounded:
        """A column, for a constant as well."""
        return found if found.values.ndim else found._replace(values=found.values.to(self.kit.device).expand(len(self.numbers)))

    def inside(self, macro: Macro, arguments: Sequence[object]) -> tuple[Mapping[int, Rounded], Rounded]:
        """The columns of a macro's own graph, and its result."""
        prepared = self.kit.macro(macro)
        known = dict(zip(prepared.arguments, map(self.operand, arguments), strict=True))
        for number, operation in prepared.steps:
            known[number] = operation(self.doubts, known)
        result = prepared.result
        return known, known[result.number] if isinstance(result, GraphNode) else constant_tensor(result)

    # Tests on polygons

    def operands(self, call: RowCall) -> tuple[list[Rounded], float]:
        """The numbers that a test is computed from, and how far what it tests may be moved by rounding, in metres."""
        found = [self.over_rows(self.operand(v.node if isinstance(v, Traced) else v)) for v in operands_of(call)]
        slack = 2 * (found[0].error + found[1].error)
        if len(found) > 2:
            heading, width, length = found[2:]
            slack += 2 * (width.error + length.error + heading.error * (width.largest + length.largest))
        return found, slack

    def test(self, call: RowCall) -> Rounded:
        """Whether points or boxes are in a polygon, or the values of a field there: NaN where it has none, which rejects the run."""
        numbers, slack = self.operands(call)
        plain = [n.values.detach() for n in numbers]
        subject = call.structure[0]
        if isinstance(subject, PolygonalRegion):
            polygon = self.kit.polygon(subject)
            inside, doubtful = polygon.contains_point(*plain, slack) if len(plain) == 2 else polygon.contains_box(*plain, slack)  # type: ignore[call-arg]
            self.doubts.add(doubtful if slack <= TIE * polygon.tests.scale else torch.ones_like(doubtful))
            return truth(inside)
        assert isinstance(subject, PolygonalVectorField)
        field, headings = self.kit.field(subject)
        cell, doubtful = field.first(*plain, slack)  # type: ignore[call-arg]
        self.doubts.add(doubtful)
        return Rounded(headings[cell], 0.0, largest_of(headings))

    # Rows

    def forget(self, nodes: Sequence[GraphNode]) -> None:
        """Leave out columns that are no longer needed."""
        for node in nodes:
            self.pop(node.number, None)
            self.beside.pop(node.number, None)

    def keep(self, kept: np.ndarray) -> None:
        """Leave out the rows where `kept` is False."""
        self.numbers.keep(kept)
        self.beside = {number: values[kept] for number, values in self.beside.items()}
        self.failed = {number: f.at(kept) for number, f in self.failed.items()}
        rows = torch.from_numpy(np.flatnonzero(kept)).to(self.kit.device)
        self.drawn.keep(rows)
        self.doubts.keep(rows)
        self.update({number: Rounded(made[0].index_select(0, rows), made[1], made[2]) for number, made in self.items()})

    def as_numpy(self, number: int) -> np.ndarray:
        """The column of a node for NumPy."""
        return self.beside[number] if number in self.beside else numpy_of(self[number].values)


def numpy_of(values: Tensor) -> np.ndarray:
    """A tensor's values for NumPy."""
    return values.detach().cpu().numpy()


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
        again = numpy_evaluator.evaluate(steps, seed, scenes[doubtful], attempts[doubtful])
        fate[doubtful] = again.fate
        reasons |= {int(doubtful[row]): reason for row, reason in again.reasons.items()}
        order = np.argsort(np.concatenate([rows, doubtful[again.fate == ACCEPTED]]))
        both = {number: np.concatenate([values, again.columns[number]])[order] for number, values in made.items()}
        return Evaluated(fate, both, reasons, len(doubtful))

    def first(
        self, steps: Sequence[PlanStep], seed: int, scenes: np.ndarray, attempts: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, Columns, dict[int, Requirement]]:
        """Return the fate of each row as far as tensors tell, the accepted rows, their outputs, and the
        `Evaluated.reasons`.
        """
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

