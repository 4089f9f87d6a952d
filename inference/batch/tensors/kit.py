"""What an evaluation on tensors needs of a graph, prepared once: the device, which nodes stay on columns and why, and constants on the device."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from ....semantics.kernel.errors import UsageError
from ....semantics.space.fields import PolygonalVectorField
from ....semantics.space.regions import PolygonalRegion
from ....semantics.space.vectors import Vector
from ..evaluate.column_calls import is_polygon_test
from ..evaluate.plan import cone
from ..evaluate.polygons import FieldTests, PolygonTests, field_of, tests_of
from ..trace.graph import (
    AsFloat,
    Graph,
    GraphNode,
    HasValue,
    ItemOf,
    Lookup,
    Macro,
    Part,
    PositionOf,
    RowCall,
    RowDraw,
    Search,
    SearchPart,
    Site,
)
from ..trace.macros import graph_of
from ..trace.structures import children
from ..trace.symbols import Choice, Opaque, Traced
from .arithmetic import NUMERIC, RULES, Doubts, Rounded, Rule, as_float, chosen, largest_of, on_floats, position, searched
from .polygons import TensorField, TensorPolygon

DEVICES = ("cpu", "cuda")


def device_of(name: str) -> torch.device:
    """The device of that name. Raises `UsageError` if torch cannot use it, and says what is missing."""
    if name not in DEVICES:
        raise UsageError(f"there is no device {name}", hint=f"the devices are {' and '.join(DEVICES)}")
    missing = missing_for_cuda() if name == "cuda" else ""
    if missing:
        raise UsageError(f"the device cuda cannot be used: {missing}", hint="the device cpu needs no GPU")
    return torch.device(name)


def missing_for_cuda() -> str:
    """What keeps torch from using a GPU; nothing if it can, and then all is ready to do so."""
    if torch.version.cuda is None and torch.version.hip is None:
        return f"torch {torch.__version__} is a build without CUDA"
    if not torch.cuda.is_available():
        return f"torch {torch.__version__} finds no GPU, or no driver for it"
    try:
        torch.zeros(1, device="cuda")
    except RuntimeError as problem:
        return str(problem)
    return ""


class Operation(NamedTuple):
    """How a node is computed: by `rule` of doubts and operands, which are other nodes (their numbers) or constants."""

    rule: Rule
    arguments: tuple[int | Rounded, ...]

    def __call__(self, doubts: Doubts, known: Mapping[int, Rounded]) -> Rounded:
        """The column of the node, those of its arguments being known."""
        return self.rule(doubts, *[known[a] if type(a) is int else a for a in self.arguments])


class MacroOperations(NamedTuple):
    """A macro: the numbers of its arguments' nodes, what is computed from them, by node, and the graph itself."""

    arguments: tuple[int, ...]
    steps: tuple[tuple[int, Operation], ...]
    result: object


class Kit:
    """A graph's nodes on a device. `lacking` are those that torch does not have (by number), `reasons` says what they do, and `elsewhere` are
    they and what they are computed from: that NumPy computes.
    """

    def __init__(self, graph: Graph, device: torch.device) -> None:
        self.device = device
        found = {node.number: reason for node in graph.nodes if (reason := why_not(node)) is not None}
        self.lacking = frozenset(found)
        self.elsewhere = frozenset(node.number for node in cone([graph.nodes[k] for k in found], set()))
        first = [k for k in found if not any(child.number in found for child in children(graph.nodes[k]))]
        self.reasons = tuple(dict.fromkeys(found[k] for k in first))
        self.tables: dict[int, Tensor] = {}
        self.polygons: dict[PolygonTests, TensorPolygon] = {}
        self.fields: dict[FieldTests, TensorField] = {}
        self.operations: dict[GraphNode, Operation] = {}
        self.macros: dict[Macro, MacroOperations] = {}

    def operation(self, node: GraphNode) -> Operation:
        """An operation on numbers and truth values, prepared once."""
        if node not in self.operations:
            arguments = tuple(a.number if isinstance(a, GraphNode) else constant(a) for a in node.arguments)
            self.operations[node] = Operation(self.rule(node), arguments)
        return self.operations[node]

    def rule(self, node: GraphNode) -> Rule:
        """The rule of a node's function."""
        function = node.function
        match function:
            case Lookup(values=values):
                table = self.table(values)
                largest = largest_of(table) if table.dtype == torch.float64 else 1.0
                return lambda doubts, index: Rounded(table[index.values], 0.0, largest)
            case Search(cumulative=cumulative):
                return partial(searched, self.table(cumulative))
            case AsFloat():
                return as_float
            case _ if function is int:
                return position
            case _ if function is np.where:
                return chosen
            case _:
                truths = [isinstance(a, bool) or (isinstance(a, GraphNode) and a.kind == "bool") for a in node.arguments]
                return on_floats(RULES[function]) if function in NUMERIC and any(truths) else RULES[function]

    def macro(self, macro: Macro) -> MacroOperations:
        """A macro's own graph, prepared once."""
        if macro not in self.macros:
            graph = graph_of(macro)
            steps = tuple((node.number, self.operation(node)) for node in graph.nodes)
            self.macros[macro] = MacroOperations(tuple(node.number for node in graph.arguments), steps, graph.result)
        return self.macros[macro]

    def table(self, values: np.ndarray) -> Tensor:
        """A constant array on the device; the graph holds it, so that its identity is its own."""
        if id(values) not in self.tables:
            self.tables[id(values)] = torch.from_numpy(np.ascontiguousarray(values)).to(self.device)
        return self.tables[id(values)]

    def polygon(self, region: PolygonalRegion) -> TensorPolygon:
        """The tests of a region."""
        tests = tests_of(region)
        if tests not in self.polygons:
            self.polygons[tests] = TensorPolygon(tests, self.device)
        return self.polygons[tests]

    def field(self, field: PolygonalVectorField) -> tuple[TensorField, Tensor]:
        """The cells of a field and their headings, the last for where there is none."""
        tests, headings = field_of(field)
        if tests not in self.fields:
            self.fields[tests] = TensorField(tests, self.device)
        return self.fields[tests], self.table(headings)


def constant(value: object) -> Rounded:
    """A number or truth value of the graph as a tensor without rows, which any device takes."""
    number = value if isinstance(value, bool) else float(value)  # type: ignore[arg-type]
    return Rounded(torch.tensor(number, dtype=torch.bool if isinstance(value, bool) else torch.float64), 0.0, abs(float(number)))


def why_not(node: GraphNode) -> str | None:
    """The operation of a node that tensors do not have, None if they have it."""
    function = node.function
    match function:
        case Site() | Lookup() | Search() | AsFloat() | Macro():
            return None
        case Part():
            return "a part of an object"
        case SearchPart() | ItemOf() | HasValue() | PositionOf():
            return "what is asked of something that is drawn from a list"
        case RowDraw():
            return "a point that is drawn in a region which differs from run to run"
        case RowCall(text=text):
            return None if is_polygon_test(function) and all(map(is_number, operands_of(function))) else text
        case _ if function is int or function is np.where:
            return None
        case _ if function in NUMERIC and all(isinstance(a, GraphNode) and a.kind == "bool" for a in node.arguments):
            return f"{name_of(function)} of truth values"
        case _:
            return None if function in RULES else name_of(function)


def name_of(function: object) -> str:
    """An operation as reports call it."""
    return getattr(function, "__name__", str(function))


def operands_of(call: RowCall) -> list[object]:
    """What a test on a polygon or a field is computed from: numbers, the ones of a vector following each other."""
    return [part for value in call.structure[1:] for part in (value if isinstance(value, Vector) else (value,))]


def is_number(value: object) -> bool:
    """Whether a value is a number, or a symbol for one with a node of its own."""
    if isinstance(value, Traced):
        return not isinstance(value, (Choice, Opaque)) and value.node.kind == "float"
    return isinstance(value, (int, float))
