"""The columns of a graph as tensors: what torch computes, and beside it what is left to NumPy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import torch
from torch import Tensor

from ....semantics.space.fields import PolygonalVectorField
from ....semantics.space.regions import PolygonalRegion
from ..evaluate.columns import column
from ..evaluate.numbers import Numbers
from ..evaluate.polygons import TIE
from ..evaluate.rows import FailedRows
from ..trace.graph import GraphNode, Macro, RowCall, Site
from ..trace.symbols import Traced
from .arithmetic import Doubts, Rounded, largest_of, truth
from .draws import TensorNumbers
from .kit import Kit, constant, operands_of

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
        return self[argument.number] if isinstance(argument, GraphNode) else constant(argument)

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
        return known, known[result.number] if isinstance(result, GraphNode) else constant(result)

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
