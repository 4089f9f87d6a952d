"""The evaluation of a graph on NumPy columns: one element for each run; runs that are rejected are left out at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from ...semantics.machine.outcome import Requirement
from ...semantics.machine.stuck_runs import UNMET, unmet_requirement
from ...semantics.space.box_crowds import crowd_meets
from ...semantics.space.numeric_functions import Elementary
from ...semantics.space.symbol_seam import NotLifted
from ...semantics.space.vectors import Unchanging
from ...semantics.syntax.nodes import NOWHERE
from .evaluation_plan import PlanStep, cone, roots_of
from .graph import (
    AsFloat,
    Crowd,
    Graph,
    GraphEvent,
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
from .primitives.drawn_points import Clipped, Proposed, curve_tests, largest_radius, proposed_in, proposed_points
from .primitives.random_numbers import Numbers
from .row_calls import Columns, FailedRows, Owned, call_by_owner, column_methods, is_clipped, values_of
from .symbolic import Choice, nodes_in, row_maker, symbols_in

ACCEPTED, LEFT = -1, -2
"""What became of a run: one that is left must be done by the interpreter; one that is rejected has the number of the step that did it."""


class Evaluated(NamedTuple):
    """The fate of each row, and the columns of the accepted rows, in order; on tensors, rounding might have
    decided `doubtful` rows.

    `reasons` says what rejected rows failed whose step cannot tell, since it depends on the row.
    """

    fate: np.ndarray
    columns: Columns
    reasons: Mapping[int, Requirement] = MappingProxyType({})
    doubtful: int = 0


def evaluate(steps: Sequence[PlanStep], seed: int, scenes: np.ndarray, attempts: np.ndarray, known: Columns = MappingProxyType({})) -> Evaluated:
    """Evaluate the runs of attempt `attempts[k]` at scene `scenes[k]` of `seed`; the columns `known` are there already."""
    fate = np.full(len(scenes), ACCEPTED, dtype=np.int32)
    rows = np.arange(len(scenes))
    numbers = Numbers(seed, scenes, attempts)
    columns = dict(known)
    failed: dict[int, FailedRows] = {}
    reasons: dict[int, Requirement] = {}
    for number, step in enumerate(steps):
        for node in step.nodes:
            columns[node.number] = column(node, columns, numbers, failed)
        event = step.event
        if event is None:
            break
        count = len(rows)
        applies = True if event.condition is None else columns[event.condition.number]
        lost = np.zeros(count, dtype=bool)
        if event.kind == "call":
            found = failed.get(event.node.number)
            if event.node.number in known:
                found = without_value(columns[event.node.number])
            if found is not None:
                left = found.left & applies
                lost = (found.rejected & applies) | left
                fate[rows[left]] = LEFT
                reasons |= {int(rows[k]): reason for k, reason in found.reasons_of(lost, event).items()}
        else:
            lost = (columns[event.node.number] != event.expected) & applies
            if event.kind == "guard":
                fate[rows[lost]] = LEFT
        for node in step.forget:
            columns.pop(node.number, None)
        if lost.any():
            fate[rows[lost & (fate[rows] == ACCEPTED)]] = number
            kept = ~lost
            rows = rows[kept]
            numbers.keep(kept)
            columns = {name: values[kept] for name, values in columns.items()}
            failed = {name: f.at(kept) for name, f in failed.items()}
    return Evaluated(fate, columns, reasons)


def without_value(column: np.ndarray) -> FailedRows | None:
    """The rows of a node that was computed elsewhere in which it has no value, which rejects them; truth values are always there."""
    if column.dtype.kind != "f":
        return None
    missing = np.isnan(column if column.ndim == 1 else column[:, 0])
    return FailedRows(missing, np.zeros(len(missing), dtype=bool))


def rejection_rates(graph: Graph, runs: int, seed: int = 0) -> dict[int, float]:
    """How often each event would reject a run if it were the only one, estimated from `runs` runs."""
    return {place: float(rejected.mean()) for place, (_, rejected, _) in enumerate(each_alone(graph, runs, seed))}


def leavers(graph: Graph, runs: int, seed: int = 0) -> Counter[str]:
    """Count which parts of the graph leave runs to the interpreter, in words and with their places, and how
    many of `runs` runs each leaves.

    Guards do, and calls that fail or give something else than in the run that was traced.
    """
    found, going = Counter[str](), np.ones(runs, dtype=bool)
    for event, rejected, left in each_alone(graph, runs, seed):
        often = int((left & going).sum())
        if often and event.guarded is not None:
            found[f"{event.guarded.span}: {event.guarded.text}"] += often
        elif often and event.requirement is not None:
            found[f"{event.requirement.span}: {event.requirement.text} fails, or gives something of another type"] += often
        going &= ~(rejected | left)
    return found


def each_alone(graph: Graph, runs: int, seed: int) -> Iterator[tuple[GraphEvent, np.ndarray, np.ndarray]]:
    """Each event, the rows that it would reject if it were the only one, and those that it would leave; a guard does both."""
    scenes = np.arange(runs, dtype=np.uint64)
    numbers, columns, failed = Numbers(seed, scenes, np.zeros_like(scenes)), dict[int, np.ndarray](), dict[int, FailedRows]()
    none = np.zeros(runs, dtype=bool)
    done: set[int] = set()
    for event in graph.events:
        for node in cone(roots_of(event), done):
            columns[node.number] = column(node, columns, numbers, failed)
            done.add(node.number)
        if event.kind == "call":
            rejected, left, _ = failed.get(event.node.number, FailedRows(none, none))
        else:
            rejected = columns[event.node.number] != event.expected
            left = rejected if event.kind == "guard" else none
        applies = True if event.condition is None else columns[event.condition.number]
        yield event, rejected & applies, left & applies


def column(node: GraphNode, columns: Columns, numbers: Numbers, failed: dict[int, FailedRows]) -> np.ndarray:
    """The column of a node, those of its arguments being known."""
    function = node.function
    operands: list[Any] = [columns[a.number] if isinstance(a, GraphNode) else a for a in node.arguments]
    match function:
        case Site():
            return numbers.column(function)
        case np.ufunc():
            with np.errstate(all="ignore"):
                return function(*operands)
        case Macro():
            with np.errstate(all="ignore"):
                return np.broadcast_to(np.asarray(function.call(operands)), len(numbers))
        case Crowd(closed=closed):
            return np.array(np.broadcast_to(crowd_meets(closed, *operands), len(numbers)))
        case Elementary():
            return function(*operands)
        case Lookup(values=values):
            return values[operands[0]]
        case Search(cumulative=cumulative):
            return np.searchsorted(cumulative, operands[0], side="right")
        case SearchPart():
            return search_parts(function, *operands)
        case ItemOf(items=items, starts=starts):
            return items[starts[operands[0]] + operands[1].astype(np.int64)]
        case HasValue(rejected=rejected, left=left, reasons=reasons):
            failed[node.number] = FailedRows(rejected[operands[0]], left[operands[0]], reasons[operands[0]])
            return operands[0]
        case PositionOf(positions=positions):
            return np.fromiter((positions[id(value)] for value in operands[0]), dtype=np.int64, count=len(numbers))
        case AsFloat():
            return operands[0].astype(float)  # type: ignore[union-attr]
        case Part(name=name):
            return part_of(operands[0], name)  # type: ignore[arg-type]
        case RowCall():
            methods = column_methods(function)
            if methods is not None:
                return call_column(node, function, methods, columns, failed, len(numbers))
            return rows_of(node, _row_caller(function), columns, failed, len(numbers))
        case RowDraw():
            found = is_clipped(function)
            if found is not None:
                return _sample_clipped_points(node, function, found, columns, numbers, failed)
            proposed = proposed_in(function.distribution)
            if proposed is not None:
                return _sample_proposed_points(node, function, proposed, columns, numbers, failed)
            return rows_of(node, _row_drawer(function, numbers), columns, failed, len(numbers))
        case _ if function is int:
            return operands[0].astype(np.int64)  # type: ignore[union-attr]
        case _ if function is np.where:
            return np.where(*operands)  # type: ignore[arg-type]
        case _:
            raise AssertionError(function)


def part_of(objects: np.ndarray, name: str) -> np.ndarray:
    """The coordinates of points: rows of an array (rows, 2), or vectors."""
    if objects.ndim == 2:
        return objects[:, int(name == "y")]
    return np.fromiter((getattr(v, name) for v in objects), dtype=float, count=len(objects))


def _sample_clipped_points(
    node: GraphNode, draw: RowDraw, found: Clipped, columns: Columns, numbers: Numbers, failed: dict[int, FailedRows]
) -> np.ndarray:
    count = len(numbers)
    values = values_of((found.x, found.y, found.radius, found.heading), columns, count)
    tests = curve_tests(found.curve, largest_radius(found.radius))
    points = tests.sample(*values, found.angle, numbers.column(Site(draw.address, 0, draw.per_scene)))  # type: ignore[call-arg]
    empty = np.isnan(points[:, 0])
    if empty.any():
        failed[node.number] = FailedRows(empty, np.zeros(count, dtype=bool))
    return points


def _sample_proposed_points(
    node: GraphNode, draw: RowDraw, found: Proposed, columns: Columns, numbers: Numbers, failed: dict[int, FailedRows]
) -> np.ndarray:
    """The points that are found soon, and the others one by one."""
    points = proposed_points(found, columns, numbers, draw)
    rest = np.flatnonzero(np.isnan(points[:, 0]))
    if len(rest):
        drawn = rows_of(node, _row_drawer(draw, numbers), columns, failed, len(points), rest)
        points[rest] = [(v.x, v.y) for v in drawn[rest]]
    return points


def call_column(
    node: GraphNode, call: RowCall, methods: Sequence[Owned], columns: Columns, failed: dict[int, FailedRows], count: int
) -> np.ndarray:
    """Return the results of a call in all rows. Rows outside of a field are rejected: by the field's own name if fields differ."""
    owner, *rest = call.structure
    values = values_of(rest, columns, count)
    if isinstance(owner, Choice):
        result = call_by_owner(methods, columns[owner.node.number], values, node.kind)
    else:
        [(owner, method)] = methods
        result = method(owner, *values)
    missing = np.isnan(result)
    if missing.any() and len(methods) == 1:
        failed[node.number] = FailedRows(missing, np.zeros(count, dtype=bool))
    elif missing.any():
        rows = np.flatnonzero(missing)
        result[rows] = rows_of(node, _row_caller(call), columns, failed, count, rows)[rows]
    return result


def search_parts(search: SearchPart, part: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Search each value in its part by bisection, in all rows at a time; return positions in the whole array."""
    low, high = search.starts[part], search.starts[part + 1] - 1
    while (low < high).any():
        middle = (low + high) // 2
        beyond = (search.values[middle] <= value) & (low < high)
        low, high = np.where(beyond, middle + 1, low), np.where(beyond, high, np.minimum(middle, high))
    return low


MOST_KEPT = 20_000
"""So many results of a call are kept."""
InRow = Callable[[Callable[[GraphNode], object], int], object]
"""What is done in a row, of which the first argument gives the values of nodes."""


@lru_cache(maxsize=256)
def _row_caller(call: RowCall) -> InRow:
    """Return what makes the call in a row; only once for the same elements of a map, truth values and whole numbers, if it depends on nothing
    else and its result stays what it is.
    """
    arguments, keywords = row_maker(call.structure), row_maker(call.keywords)
    nodes = list(dict.fromkeys(nodes_in((call.structure, call.keywords))))
    may_keep = all(node.kind != "float" for node in nodes)

    def in_row(resolve: Callable[[GraphNode], object], row: int) -> object:
        values = [resolve(node) for node in nodes] if may_keep else []
        if not may_keep or not all(type(value) in (bool, int) or isinstance(value, Unchanging) for value in values):
            return called(resolve)
        key = tuple([(type(value), value) if type(value) in (bool, int) else id(value) for value in values])
        if key in call.kept:
            result = call.kept[key][1]
            return list(result) if type(result) is list else result
        result = called(resolve)
        if stays(result):
            if len(call.kept) >= MOST_KEPT:
                call.kept.clear()
            call.kept[key] = values, result  # with the values, so that no other gets the identity of one
        return list(result) if type(result) is list else result

    def called(resolve: Callable[[GraphNode], object]) -> object:
        call.budget.renew()
        result = call.function(*arguments(resolve), **keywords(resolve))
        result = float(result) if call.converts and type(result) is not bool else result  # type: ignore[arg-type]
        if not call.gives(result) or symbols_in(result):
            raise NotLifted("another type than in the traced run")
        return result

    return in_row


def stays(result: object) -> bool:
    """Return whether nobody can change a result of a call, or a list of such results apart from the list itself."""
    if type(result) in (list, tuple):
        return all(isinstance(item, Unchanging) for item in result)  # type: ignore[attr-defined]
    return isinstance(result, Unchanging) or type(result) in (bool, int, float, str, type(None))


def _row_drawer(draw: RowDraw, numbers: Numbers) -> InRow:
    distribution = row_maker(draw.distribution)
    return lambda resolve, row: distribution(resolve).sample(numbers.stream(row, draw.address, draw.per_scene))


def rows_of(
    node: GraphNode, function: InRow, columns: Columns, failed: dict[int, FailedRows], count: int, rows: Iterable[int] | None = None
) -> np.ndarray:
    """A column made by calling a Python function for one row after the other, or for some rows."""
    result: Any = np.empty(count, dtype={"float": float, "bool": bool}.get(node.kind, object))
    rejected, left, reasons = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), np.full(count, None)
    for row in range(count) if rows is None else rows:
        try:
            result[row] = function(lambda child, row=row: _item(columns[child.number][row]), row)
        except UNMET as problem:
            rejected[row], result[row], reasons[row] = True, node.example, unmet_requirement(problem, NOWHERE)
        except (NotLifted, Exception):  # whatever it is, the interpreter will say it where it belongs
            left[row], result[row] = True, node.example
    if rejected.any() or left.any():
        failed[node.number] = FailedRows(rejected, left, reasons if rejected.any() else None)
    return result


def _item(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value
