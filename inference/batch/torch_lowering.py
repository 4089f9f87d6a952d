"""Arithmetic on tensors that knows how far its results may be from those of the columns.

Sums, products and quotients are rounded alike by torch and NumPy (IEEE 754), so that they are the same bits as long as their operands are.
Sines, square roots, logarithms and so on differ in the last bits, and what is computed from them differs by a bound that is computed with
it: a running error analysis, one bound for all rows. Where that bound could decide something (a comparison, a cell, a position), or where
an operation blows it up, the row is doubtful: the columns do it.

In rows that are not doubtful there is a NaN exactly where the columns have one.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
import torch
from scipy import special
from torch import Tensor

from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.numeric_functions import (
    arc_tangent,
    exponential,
    exponential_less_one,
    logarithm,
    logarithm_of_one_more,
)
from ...semantics.space.regions import PolygonalRegion
from ...semantics.space.vectors import Vector
from ...semantics.store.errors import UsageError
from .evaluation_plan import cone
from .graph import (
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
from .graph_builder import graph_of
from .primitives.point_in_polygon import FieldTests, PolygonTests, field_of, tests_of
from .primitives.torch_polygons import TensorField, TensorPolygon
from .row_calls import is_polygon_test
from .symbolic import Choice, Opaque, Traced, children

ROUNDING = 1e-9
"""No number of a scene is further than this from that of the columns (or than this share of it, if it is larger than 1)."""
LIMIT, UNUSUAL, LITTLE = ROUNDING / 8, 1000.0, 1e-13
"""What an operation may blow rounding up to, at most; and, since the bound is that of all rows, how many times what it does in a typical one,
unless that is less than little.
"""
STEP = 2.0**-51
"""More than what two roundings of one result can differ by, as a share of it."""
LIBRARY = 2.0**-48
"""More than what two libraries differ by in a function, as a share of the largest result, or of 1."""
UNDERFLOW = -700.0
"""The exponential of less than this is no normal number."""


class Rounded(NamedTuple):
    """A column as a tensor, (rows,) or () for a constant: in rows that are not doubtful, `error` is the most by which it differs from NumPy's
    column (0: the same bits), and `largest` the largest finite absolute value.
    """

    values: Tensor
    error: float
    largest: float


class Doubts:
    """Which rows rounding might decide, (rows,)."""

    def __init__(self, rows: int, device: torch.device) -> None:
        self.rows = torch.zeros(rows, dtype=torch.bool, device=device)

    def add(self, rows: Tensor) -> None:
        """Add the rows of a mask."""
        self.rows |= rows

    def keep(self, kept: Tensor) -> None:
        """Leave out all rows but these, of which the numbers are given."""
        self.rows = self.rows.index_select(0, kept)


Rule = Callable[..., Rounded]


def times(a: float, b: float) -> float:
    """A product of bounds, in which 0 wins over infinity."""
    return a * b if a and b else 0.0


def most(values: Tensor, rows: Tensor) -> float:
    """The largest of some values that are not negative, by a mask of rows; 0 if there are none."""
    return float(torch.where(rows, values, 0.0).max()) if values.numel() else 0.0


def largest_of(values: Tensor) -> float:
    """The largest finite absolute value."""
    plain = values.detach().abs()
    return most(plain, plain < math.inf)


def bound_rounding_error(doubts: Doubts, values: Tensor, error: Tensor) -> Rounded:
    """A result with an error for each row: rows in which it is large are doubtful."""
    plain = values.detach().abs()
    typical = error.nanmedian() if error.numel() else error.new_zeros(())
    limit = torch.minimum(LIMIT * plain.clamp(min=1.0), (UNUSUAL * typical).clamp(min=LITTLE))
    doubts.add(error > limit)
    fine = error <= limit
    return Rounded(values, most(error, fine), most(plain, fine & (plain < math.inf)))


# Rules: those of an operation take doubts and the operands


def sum_rule(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """A sum or a difference."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        error, largest = a.error + b.error, a.largest + b.largest
        return Rounded(operation(a.values, b.values), error and error + STEP * largest, largest)

    return rule


def product_rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
    """Bound the rounding error of a product."""
    error = times(a.largest, b.error) + times(b.largest, a.error) + times(a.error, b.error)
    largest = times(a.largest, b.largest)
    return Rounded(a.values * b.values, error and error + STEP * largest, largest)


def quotient_rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
    """A quotient: doubtful where the divisor might be 0."""
    values = a.values / b.values
    if not (a.error or b.error):
        return Rounded(values, 0.0, largest_of(values))
    if not (b.values.ndim or b.error) and b.largest:
        return Rounded(values, (a.error + STEP * a.largest) / b.largest, a.largest / b.largest)
    plain, divisor = values.detach().abs(), b.values.detach().abs()
    doubts.add(divisor <= b.error)
    return bound_rounding_error(doubts, values, (a.error + plain * b.error) / (divisor - b.error) + STEP * plain)


def remainder(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """Return the rule for the remainder of a division: doubtful near the multiples of the divisor."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        values = operation(a.values, b.values)
        if not (a.error or b.error):
            return Rounded(values, 0.0, b.largest)
        left, divisor = values.detach().abs(), b.values.detach().abs()
        error = a.error + b.error * (a.values.detach().abs() / divisor + 1) + STEP * divisor
        doubts.add((left <= error) | (divisor - left <= error))
        return bound_rounding_error(doubts, values, error)

    return rule


def isometry_rule(operation: Callable[[Tensor], Tensor]) -> Rule:
    """Return the rule for an operation that moves a number by as much as its operand moves."""
    return lambda doubts, a: Rounded(operation(a.values), a.error, a.largest)


def extreme(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """The smaller or the larger of two numbers."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        finite = [v for v in (a.largest, b.largest) if v < math.inf]
        return Rounded(operation(a.values, b.values), max(a.error, b.error), max(finite, default=math.inf))

    return rule


def circular(operation: Callable[[Tensor], Tensor]) -> Rule:
    """A sine or a cosine."""
    return lambda doubts, a: Rounded(operation(a.values), min(a.error, 2.0) + LIBRARY, 1.0)


def monotone(operation: Callable[[Tensor], Tensor]) -> Rule:
    """A monotone function: its result lies between those of the ends of what its operand might be."""

    def rule(doubts: Doubts, a: Rounded) -> Rounded:
        values = operation(a.values)
        if not a.error:
            largest = largest_of(values)
            return Rounded(values, LIBRARY * max(largest, 1.0), largest)
        plain, operand = values.detach(), a.values.detach()
        low, high = operation(operand - a.error), operation(operand + a.error)
        doubts.add(low.isnan() != high.isnan())
        spread = torch.maximum((high - plain).abs(), (low - plain).abs())
        found = bound_rounding_error(doubts, values, spread)
        return found._replace(error=found.error + 4 * LIBRARY * max(found.largest, 1.0))

    return rule


def of_c(operation: Callable[[Tensor], Tensor]) -> Callable[[Tensor], Tensor]:
    """A function as `numeric.Elementary` has it: NaN where Python's own raises an error, at poles and where the result is too large."""

    def function(a: Tensor) -> Tensor:
        values = operation(a)
        return torch.where(values.isinf() & a.isfinite(), torch.nan, values)

    return function


def ndtri_exp(y: Tensor) -> Tensor:
    """The number below which a standard normal one is with probability exp(y)."""
    upper = -torch.special.ndtri(-torch.expm1(torch.where(y > -0.5, y, -1.0)))
    return torch.where(y > -0.5, upper, torch.special.ndtri(torch.exp(y)))


def normal_quantile(doubts: Doubts, a: Rounded) -> Rounded:
    """`ndtri_exp`: doubtful where the probability is no normal number."""
    doubts.add(a.values.detach() < UNDERFLOW)
    return monotone(ndtri_exp)(doubts, a)


def hypotenuse(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
    """The length of a vector."""
    largest = a.largest + b.largest
    return Rounded(torch.hypot(a.values, b.values), a.error + b.error + LIBRARY * largest, largest)


def angle(doubts: Doubts, y: Rounded, x: Rounded) -> Rounded:
    """The arctangent of a vector: doubtful where it might be 0 or change its sign at π."""
    values = torch.atan2(y.values, x.values)
    error = y.error + x.error
    if not error:
        return Rounded(values, LIBRARY * math.pi, math.pi)
    across, along = y.values.detach(), x.values.detach()
    away = torch.hypot(across, along)
    doubts.add(away <= 2 * error)
    if y.error:
        doubts.add((across.abs() <= y.error) & (along < x.error))
    found = bound_rounding_error(doubts, values, 2 * error / (away - error))
    return found._replace(error=found.error + LIBRARY * math.pi)


def comparison_rule(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """A comparison: doubtful where the sides are as near as rounding."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        error = a.error + b.error
        if error:
            doubts.add((a.values.detach() - b.values.detach()).abs() <= error)
        return truth(operation(a.values, b.values))

    return rule


def logical(operation: Callable[..., Tensor]) -> Rule:
    """An operation on truth values."""
    return lambda doubts, *operands: truth(operation(*(o.values for o in operands)))


def truth(values: Tensor) -> Rounded:
    """Truth values, which are those of the columns."""
    return Rounded(values, 0.0, 1.0)


def select_rule(doubts: Doubts, condition: Rounded, then: Rounded, otherwise: Rounded) -> Rounded:
    """`then` where the condition holds, else `otherwise`."""
    values = torch.where(condition.values, then.values, otherwise.values)
    return Rounded(values, max(then.error, otherwise.error), max(then.largest, otherwise.largest))


def position(doubts: Doubts, a: Rounded) -> Rounded:
    """A float that is a whole number, or is cut off to one."""
    if a.error:
        doubts.add((a.values - a.values.round()).abs() <= a.error)
    return Rounded(a.values.detach().to(torch.int64), 0.0, a.largest)


def as_float(doubts: Doubts, a: Rounded) -> Rounded:
    """Truth values or whole numbers as floats."""
    return Rounded(a.values.to(torch.float64), 0.0, a.largest)


def on_floats(rule: Rule) -> Rule:
    """A rule for numbers, with truth values taken for 0 and 1."""
    return lambda doubts, *operands: rule(doubts, *(as_float(doubts, o) for o in operands))


def search_rule(cumulative: Tensor, doubts: Doubts, a: Rounded) -> Rounded:
    """How many of the increasing numbers are at most the operand."""
    values = a.values.detach().contiguous()
    found = torch.searchsorted(cumulative, values, right=True)
    if a.error:
        ends = (torch.searchsorted(cumulative, values + by, right=True) for by in (-a.error, a.error))
        doubts.add(operator.ne(*ends))
    return Rounded(found, 0.0, float(len(cumulative)))


COMPARISONS: dict[object, Rule] = {
    np.less: comparison_rule(torch.lt), np.less_equal: comparison_rule(torch.le), np.greater: comparison_rule(torch.gt),
    np.greater_equal: comparison_rule(torch.ge),
    np.equal: comparison_rule(torch.eq), np.not_equal: comparison_rule(torch.ne),
}  # fmt: skip
LOGICAL: dict[object, Rule] = {
    np.logical_and: logical(torch.logical_and), np.logical_or: logical(torch.logical_or), np.logical_xor: logical(torch.logical_xor),
    np.logical_not: logical(torch.logical_not),
}  # fmt: skip
NUMERIC: dict[object, Rule] = {
    np.add: sum_rule(torch.add), np.subtract: sum_rule(torch.sub), np.multiply: product_rule, np.true_divide: quotient_rule,
    np.mod: remainder(torch.remainder), np.fmod: remainder(torch.fmod),
    np.negative: isometry_rule(torch.neg), np.positive: isometry_rule(torch.clone), np.absolute: isometry_rule(torch.abs),
    np.minimum: extreme(torch.minimum), np.maximum: extreme(torch.maximum),
    np.sqrt: monotone(torch.sqrt), np.sin: circular(torch.sin), np.cos: circular(torch.cos), np.hypot: hypotenuse, arc_tangent: angle,
    exponential: monotone(of_c(torch.exp)), exponential_less_one: monotone(of_c(torch.expm1)),
    logarithm: monotone(of_c(torch.log)), logarithm_of_one_more: monotone(of_c(torch.log1p)),
    special.ndtri: monotone(torch.special.ndtri), special.log_ndtr: monotone(torch.special.log_ndtr),
    special.ndtri_exp: normal_quantile,
}  # fmt: skip
"""The operations on numbers, by what stands for them in a graph."""
RULES: dict[object, Rule] = {**NUMERIC, **COMPARISONS, **LOGICAL}

__all__ = [
    "NUMERIC", "ROUNDING", "RULES", "Doubts", "Rounded", "Rule", "as_float", "largest_of", "on_floats", "position", "search_rule", "select_rule"
]


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
    """Make the GPU ready for torch and return "", or return the reason why torch cannot use it."""
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
            arguments = tuple(a.number if isinstance(a, GraphNode) else constant_tensor(a) for a in node.arguments)
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
                return partial(search_rule, self.table(cumulative))
            case AsFloat():
                return as_float
            case _ if function is int:
                return position
            case _ if function is np.where:
                return select_rule
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


def constant_tensor(value: object) -> Rounded:
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
            return None if is_polygon_test(function) and all(map(is_number_node, operands_of(function))) else text
        case _ if function is int or function is np.where:
            return None
        case _ if function in NUMERIC and all(isinstance(a, GraphNode) and a.kind == "bool" for a in node.arguments):
            return f"{operation_name(function)} of truth values"
        case _:
            return None if function in RULES else operation_name(function)


def operation_name(function: object) -> str:
    """An operation as reports call it."""
    return getattr(function, "__name__", str(function))


def operands_of(call: RowCall) -> list[object]:
    """Return the operands from which a test on a polygon or a field is computed: numbers, with the components
    of a vector one after the other.
    """
    return [part for value in call.structure[1:] for part in (value if isinstance(value, Vector) else (value,))]


def is_number_node(value: object) -> bool:
    """Whether a value is a number, or a symbol for one with a node of its own."""
    if isinstance(value, Traced):
        return not isinstance(value, (Choice, Opaque)) and value.node.kind == "float"
    return isinstance(value, (int, float))

