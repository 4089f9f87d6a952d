"""A compiled evaluator of one program: its graph written as a function of one run after the other, which ends at the first thing that fails.

It gives the same bits as the columns, which evaluate the same graph. `NotCompiled` says what of a graph it cannot do. To import this needs numba.

Each number of the graph becomes a line of straight code, in the order in which columns evaluate it, and each requirement a `continue` to the
next attempt. Of `x = Range(0, 9)` and `require x > 3` that is

    u0_0, u0_1, u0_2, u0_3 = philox(seed, np.uint64(6791897765849424158), scene, at0, np.uint64(0))
    v0 = u0_0
    v1 = v0 * (9.0)
    v2 = (0.0) + v1
    v3 = v2 if v2 <= (9.0) else (9.0)
    v5 = v3 > (3.0)
    if v5 != True:
        counts[0] += 1
        continue

in a loop over the scenes of a block, around a loop over the attempts at one (`docs/engines.md` has the whole).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import shapely

from ...interpreter.runtime.answerers import PER_SCENE
from ...interpreter.runtime.random_streams import site_code
from ...semantics.space.box_crowds import NUMBERS
from ...semantics.space.numeric_functions import Elementary
from ...semantics.space.regions import PolygonalRegion
from ...semantics.space.symbol_seam import NotLifted
from ...semantics.space.vectors import Vector
from .evaluation_plan import PlanStep
from .factorised_rejection import Stage
from .graph import (
    AsFloat,
    Crowd,
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
from .graph_builder import graph_of
from .primitives import numba_kernels
from .primitives.drawn_points import curve_tests, largest_radius
from .primitives.point_in_polygon import constant_cells, edges_of, field_of, tests_of
from .row_calls import column_methods, distance_from_polygon, heading_along, is_clipped, is_polygon_test
from .symbolic import Choice, Traced
from .violations import DIFFERENCES, IN_POLYGON, LEAST, UNKNOWN, decisive

PENDING, ACCEPTED, LEFT, EXHAUSTED = 0, 1, 2, 3
"""What is known of a scene; LEFT: the interpreter must do the attempt that comes next (or, where there are parts, columns the whole scene);
EXHAUSTED: a part of it has had all attempts.
"""


class NotCompiled(Exception):
    """A graph holds something that has no compiled form; the text says what."""


INFIX = {
    np.add: "+", np.subtract: "-", np.multiply: "*", np.true_divide: "/", np.less: "<", np.less_equal: "<=", np.greater: ">", np.greater_equal: ">=",
    np.equal: "==", np.not_equal: "!=", np.logical_and: "&", np.logical_or: "|", np.logical_xor: "!=",
}
PREFIX = {
    np.negative: "-", np.positive: "+", np.logical_not: "not ", np.absolute: "abs", np.sqrt: "math.sqrt", np.sin: "math.sin", np.cos: "math.cos",
}
LIBRARY = {"hypot": 2, "atan2": 2, "fmod": 2, "exp": 1, "expm1": 1, "log": 1, "log1p": 1}
SPECIAL = {"ndtri": "ndtri", "ndtri_exp": "ndtri_exp", "log_ndtr": "__pyx_fuse_1log_ndtr"}


class Writer:
    """The source of an evaluator, and what its names stand for; the texts of what it calls that is made of a graph as well (`callees`)."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.names: dict[str, object] = {"math": math, "np": np, "philox": numba_kernels.philox_uniforms, "bisect_right": numba_kernels.bisect_right}
        self.callees: list[str] = []
        self.arrays: dict[str, np.ndarray] = {}
        self.blocks: dict[tuple[object, ...], str] = {}
        self.macros: dict[object, str] = {}
        self.kept: dict[int, tuple[np.ndarray, str]] = {}  # by identity; the array is held, so that it stays the only one with it
        self.made: dict[int, tuple[object, Sequence[np.ndarray]]] = {}
        self.depth = 1
        self.stage = 0
        self.owners: dict[tuple[int, ...], int] = {}

    def array(self, values: np.ndarray) -> str:
        """The name of an array that is handed to the evaluator."""
        if id(values) not in self.kept:
            name = f"a{len(self.arrays)}"
            self.kept[id(values)] = values, name
            self.arrays[name] = np.ascontiguousarray(values)
        return self.kept[id(values)][1]

    def add(self, line: str, inner: int = 0) -> None:
        """Write a line, in the block that is being written, or in one inside."""
        self.lines.append("    " * (self.depth + inner) + line)

    # Nodes

    def write(self, node: GraphNode) -> None:
        """The computation of a node."""
        function, name = node.function, f"v{node.number}"
        operands = [self.operand(a) for a in node.arguments]
        match function:
            case Site():
                self.site(name, function)
            case Lookup(values=values):
                self.add(f"{name} = {self.array(values)}[{operands[0]}]")
            case Search(cumulative=cumulative):
                self.add(f"{name} = bisect_right({self.array(cumulative)}, {operands[0]})")
            case AsFloat():
                self.add(f"{name} = np.float64({operands[0]})")
            case Macro():
                self.add(f"{name} = {self.macro(function)}({', '.join(operands)})")
            case Crowd(closed=closed):
                self.crowd(name, operands, closed)
            case SearchPart(values=values, starts=starts):
                self.names["search_part"] = numba_kernels.search_part
                self.add(f"{name} = search_part({self.array(values)}, {self.array(starts)}, {', '.join(operands)})")
            case ItemOf(items=items, starts=starts) if items.dtype != object:
                self.add(f"{name} = {self.array(items)}[{self.array(starts)}[{operands[0]}] + np.int64({operands[1]})]")
            case HasValue(rejected=rejected, left=left) if not (rejected.any() or left.any()):
                self.add(f"{name} = {operands[0]}")
            case ItemOf() | HasValue() | PositionOf():
                raise NotCompiled("what is asked of something that is drawn from a list")
            case RowCall():
                self.call(name, function)
            case RowDraw():
                self.draw(name, function)
            case Part(name=part) if isinstance(node.arguments[0], GraphNode) and isinstance(node.arguments[0].function, RowDraw):
                self.add(f"{name} = {operands[0]}_{part}")
            case _:
                self.add(f"{name} = {self.expression(function, operands)}")

    def operand(self, value: object) -> str:
        """A node's variable, or a constant."""
        if isinstance(value, GraphNode):
            return f"v{value.number}"
        if isinstance(value, bool):
            return repr(value)
        number = float(value)  # type: ignore[arg-type]
        return f"({number!r})" if math.isfinite(number) else f"({'-' if number < 0 else ''}np.{'inf' if math.isinf(number) else 'nan'})"

    def expression(self, function: Any, operands: Sequence[str]) -> str:
        """An operation on numbers and truth values."""
        if function in INFIX:
            return f"{operands[0]} {INFIX[function]} {operands[1]}"
        if function in PREFIX:
            return f"{PREFIX[function]}({operands[0]})"
        if function is np.minimum or function is np.maximum:
            return f"{operands[0]} if {operands[0]} {'<' if function is np.minimum else '>'}= {operands[1]} else {operands[1]}"
        if function is np.where:
            return f"{operands[1]} if {operands[0]} else {operands[2]}"
        if function is int:
            return f"np.int64({operands[0]})"
        if function is np.mod:
            return f"np.mod({operands[0]}, {operands[1]})"
        name = getattr(function, "__name__", "")
        if isinstance(function, Elementary) or function in (np.hypot, np.fmod):
            self.names.setdefault(name, numba_kernels.from_libm(name, LIBRARY[name]))
        elif name in SPECIAL:
            self.names.setdefault(name, numba_kernels.from_scipy(SPECIAL[name]))
        else:
            raise NotCompiled(f"the function {name}" if name else "a point drawn row by row")
        return f"{name}({', '.join(operands)})"

    def site(self, name: str, site: Site) -> None:
        """A random number; the four of a block are made together."""
        block, word = divmod(site.index, 4)
        key = (site.address, block, site.per_scene)
        if key not in self.blocks:
            made = self.blocks[key] = f"u{len(self.blocks)}_"
            attempt = f"np.uint64({PER_SCENE})" if site.per_scene else f"at{self.owners.get(site.address, 0)}"
            targets = ", ".join(f"{made}{i}" for i in range(4))
            self.add(f"{targets} = philox(seed, np.uint64({site_code(site.address)}), scene, {attempt}, np.uint64({block}))")
        self.add(f"{name} = {self.blocks[key]}{word}")

    def macro(self, macro: Macro) -> str:
        """The name of a compiled macro: its function traced on symbols of its own."""
        if macro not in self.macros:
            name = self.macros[macro] = f"m{len(self.macros)}"
            self.names[name], text = compiled_macro(macro)
            self.callees.append(f"{name}: {text}")
        return self.macros[macro]

    def crowd(self, name: str, operands: Sequence[str], closed: bool) -> None:
        """Whether any two of many boxes meet."""
        self.names["row_meets"] = numba_kernels.row_meets
        self.add(f"{name}_boxes = np.empty(({len(operands) // NUMBERS}, {NUMBERS}))")
        for k, operand in enumerate(operands):
            self.add(f"{name}_boxes[{k // NUMBERS}, {k % NUMBERS}] = {operand}")
        self.add(f"{name} = row_meets({name}_boxes, {closed})")

    def draw(self, name: str, draw: RowDraw) -> None:
        """A point of a curve inside a sector."""
        found = is_clipped(draw)
        if found is None:
            raise NotCompiled("a point drawn row by row")
        tests = curve_tests(found.curve, largest_radius(found.radius))
        self.site(f"{name}_u", Site(draw.address, 0, draw.per_scene))
        self.names["clipped_point"] = numba_kernels.clipped_point
        values = [self.operand(v.node if isinstance(v, Traced) else v) for v in (found.x, found.y, found.radius, found.heading, found.angle)]
        grid = self.kept_arrays(tests.grid, lambda: numba_kernels.grid_arrays(tests.grid))
        arrays = [self.array(a) for a in (tests.start, tests.end, *grid)]
        self.add(f"{name}, {name}_x, {name}_y = clipped_point({', '.join([*values, f'{name}_u', *arrays])})")

    # Tests on polygons

    def call(self, name: str, call: RowCall) -> None:
        """A test on a polygon or the value of a field."""
        asked = owners_asked(call)
        if asked is None and not is_polygon_test(call):
            raise NotCompiled(f"a call of {call.text} that depends on what is drawn")
        subject, *rest = call.structure
        parts = [v for part in rest for v in (part if isinstance(part, Vector) else (part,))]
        values = [self.operand(v.node if isinstance(v, Traced) else v) for v in parts]
        if asked is not None:
            self.asked(name, *asked, self.operand(subject.node) if isinstance(subject, Choice) else "0", values)
        elif isinstance(subject, PolygonalRegion):
            self.region(name, call, subject, values)
        elif constant_cells(subject):
            self.field(name, subject, values)
        else:
            raise NotCompiled(f"a call of {call.text} that depends on what is drawn")

    def region(self, name: str, call: RowCall, region: PolygonalRegion, values: list[str]) -> None:
        """Whether a point or box lies in a polygonal region."""
        tests = tests_of(region)
        shared = [self.array(a) for a in self.kept_arrays(tests, lambda: (tests.edges, tests.reference, tests.reference_inside))]
        grid = [self.array(a) for a in self.kept_arrays(tests.grid, lambda: numba_kernels.grid_arrays(tests.grid))]
        scale = repr(float(tests.scale))
        if len(values) == 2:
            self.names["point_in"] = numba_kernels.point_in
            self.add(f"q = point_in({', '.join([*values, scale, *shared, *grid])})")
        else:
            self.names["box_in"] = numba_kernels.box_in
            largest = self.largest_box(call)
            near, known = tests.grid_for(largest)
            lists = [self.array(a) for a in (*self.kept_arrays(near, lambda: numba_kernels.grid_arrays(near)), known)]
            self.add(f"q = box_in({', '.join([*values, scale, repr(largest), *shared, *grid, *lists])})")
        self.add("if q == 2:")
        self.leave()
        self.add(f"{name} = q == 1")

    def kept_arrays(self, owner: object, make: Callable[[], Sequence[np.ndarray]]) -> Sequence[np.ndarray]:
        """The arrays of a test, made once."""
        if id(owner) not in self.made:
            self.made[id(owner)] = owner, make()
        return self.made[id(owner)][1]

    def largest_box(self, call: RowCall) -> float:
        """How far from its centre a corner of the box can be, in metres: from the bounds of its sizes, or 16 m."""
        bounds = [v.node.bounds if isinstance(v, Traced) else (0.0, float(v)) for v in call.structure[-2:]]  # type: ignore[arg-type]
        sizes = [22.0 if b is None else b[1] for b in bounds]
        return min(math.hypot(*sizes) / 2, 100.0) + 1e-6

    def field(self, name: str, field: Any, values: list[str]) -> None:
        """The heading of a field with constant cells."""
        tests, headings = field_of(field)
        self.names["first_cell"] = numba_kernels.first_cell
        grid = [self.array(a) for a in self.kept_arrays(tests.grid, lambda: numba_kernels.grid_arrays(tests.grid))]
        arrays = [self.array(a) for a in (tests.edges, tests.number)]
        self.add(f"q = first_cell({', '.join([*values, repr(float(tests.scale)), *arrays, *grid, self.array(tests.known)])})")
        self.add("if q == -2:")
        self.leave()
        self.add(f"{name} = {self.array(headings)}[q]")

    def asked(self, name: str, kernel: str, owners: Sequence[object], which: str, values: list[str]) -> None:
        """Write the query of a place to one of some curves or polygons, by a kernel that goes through its own
        edges.
        """
        *numbers, starts = self.kept_arrays(owners, lambda: arrays_of(owners))
        self.names[kernel] = getattr(numba_kernels, kernel)
        borders = [f"{self.array(starts)}[{which}{more}]" for more in ("", " + 1")]
        self.add(f"q, {name} = {kernel}({', '.join([*values, *map(self.array, numbers), *borders])})")
        self.add("if not q:")
        self.leave()

    def leave(self) -> None:
        """Leave this run to others."""
        self.add(f"fate[i] = {LEFT}; out = True", 1)
        self.add("break", 1)

    # Events

    def event(self, event: GraphEvent, number: int) -> None:
        """Write how an event decides the run."""
        fails = self.failing(event)
        if fails is None:
            return
        self.add(f"if {fails}:")
        if event.kind == "guard":
            self.leave()
            return
        self.add(f"counts[{number}] += 1", 1)
        self.add("continue", 1)

    def failing(self, event: GraphEvent) -> str | None:
        """When an event ends the run, if it ever does."""
        name = f"v{event.node.number}"
        if event.kind == "call":
            if event.node.kind == "bool":
                return None
            fails = f"not {name}" if isinstance(event.node.function, RowDraw) else f"math.isnan({name})"
        else:
            fails = f"{name} != {event.expected}"
        return fails if event.condition is None else f"v{event.condition.number} and ({fails})"

    # Stages

    def attempts(self, stage: Stage, events: list[GraphEvent], found: Callable[[], None]) -> None:
        """A loop over the attempts at a stage, its parts in loops of their own; `found` writes what is done with the first that is accepted."""
        number, over = stage.number, "" if stage.number else " or runs >= budget"
        self.add("while True:")
        self.depth += 1
        self.add(f"if c{number} >= most{over}:")
        if number:
            self.add(f"fate[i] = {EXHAUSTED}; out = True", 1)
        self.add("break", 1)
        self.add(f"at{number} = np.uint64(c{number})")
        self.add(f"c{number} += 1")
        self.add("runs += 1")
        self.owners |= dict.fromkeys(stage.own, number)
        for part in stage.parts:
            self.attempts(part, events, lambda: None)
            self.add("if out:")
            self.add("break", 1)
        for step in stage.steps:
            for node in step.nodes:
                self.write(node)
            if step.event is not None:
                self.event(step.event, len(events))
                events.append(step.event)
        found()
        self.add("break")
        self.depth -= 1


def owners_asked(call: RowCall) -> tuple[str, list[object]] | None:
    """The kernel that answers a call, and the curves or polygons one of which is asked in each row; None for another call."""
    methods = column_methods(call)
    if methods is None:
        return None
    owners, columns = [owner for owner, _ in methods], {column for _, column in methods}
    if columns == {heading_along}:
        return "nearest_heading", owners
    return ("polygon_distance", owners) if columns == {distance_from_polygon} else None


def arrays_of(owners: Sequence[Any]) -> tuple[np.ndarray, ...]:
    """The edges of curves or polygons (edges, 4), the headings of curves, and where those of each owner begin."""
    if isinstance(owners[0], PolygonalRegion):
        edges = [edges_of(region.polygon) for region in owners]
        return np.concatenate(edges), np.cumsum([0, *map(len, edges)]).astype(np.int64)
    ends = [shapely.get_coordinates(curve.segment_tree.geometries).reshape(-1, 4) for curve in owners]
    headings = np.concatenate([np.asarray(curve.headings, dtype=float) for curve in owners])
    return np.concatenate(ends), headings, np.cumsum([0, *map(len, ends)]).astype(np.int64)


def compile_stage(stage: Stage) -> tuple[Callable[..., tuple[int, int]], tuple[np.ndarray, ...], list[GraphEvent]]:
    """The evaluator of a plan, the arrays that it is called with, and the events that it counts.

    evaluator(seed, start, first, live, most, budget, fate, floats, ints, counts, *arrays) -> (runs, scenes looked at)
    """
    writer = Writer()
    events: list[GraphEvent] = []

    def results() -> None:
        places = {"floats": 0, "ints": 0}
        for node in stage.outputs:
            if node.kind == "object":
                raise NotCompiled("a property that is computed row by row")
            where = "floats" if node.kind == "float" else "ints"
            writer.add(f"{where}[{places[where]}, i] = v{node.number}")
            places[where] += 1
        writer.add(f"fate[i] = {ACCEPTED}")

    numbers = range(len(stage.all))
    writer.depth = 2
    writer.add("if runs >= budget:")
    writer.add("return runs, j", 1)
    writer.add("i = live[j]")
    writer.add("scene = np.uint64(start + i)")
    writer.add("out = False")
    for number in numbers:
        writer.add(f"c{number} = first[{number}, i]")
    writer.attempts(stage, events, results)
    writer.add(f"took = 1 if fate[i] == {ACCEPTED} or fate[i] == {LEFT} else 0")
    for number in numbers:
        writer.add(f"first[{number}, i] = c{number} - took")
    head = [
        f"def evaluator(seed, start, first, live, most, budget, fate, floats, ints, counts, {', '.join(writer.arrays)}):",
        "    runs = 0",
        "    for j in range(len(live)):",
    ]
    source = "\n".join([*head, *writer.lines, "    return runs, len(live)"])
    return numba_kernels.compile_function_text(source, "evaluator", writer.names, writer.callees), tuple(writer.arrays.values()), events


def compiled_macro(macro: Macro, margin: Callable[[Writer, object], str] | None = None) -> tuple[Callable[..., object], str]:
    """A macro's function, compiled, and its text: its graph written as code. `margin` may write something else of its result."""
    try:
        graph = graph_of(macro)
    except NotLifted as reason:
        raise NotCompiled(str(reason)) from None
    writer = Writer()
    for node in graph.nodes:
        function, name = node.function, f"v{node.number}"
        operands = [writer.operand(a) for a in node.arguments]
        value = f"np.float64({operands[0]})" if isinstance(function, AsFloat) else writer.expression(function, operands)
        writer.add(f"{name} = {value}")
    returned = writer.operand(graph.result) if margin is None else margin(writer, graph.result)
    arguments = ", ".join(f"v{node.number}" for node in graph.arguments)
    source = "\n".join([f"def function({arguments}):", *writer.lines, f"    return {returned}"])
    return numba_kernels.compile_function_text(source, "function", writer.names, writer.callees), "\n".join([source, *writer.callees])


Address = tuple[int, ...]
Violations = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class StateWriter(Writer):
    """The source of a test of states; `numbers` and `words` say where those of a draw stand."""

    def __init__(self, numbers: Mapping[tuple[Address, int], int], words: Mapping[Address, int], attempt: int) -> None:
        super().__init__()
        self.numbers, self.words, self.attempt = numbers, words, attempt

    def site(self, name: str, site: Site) -> None:
        """A number of the state, or one from the stream that a word of it names."""
        own = self.numbers.get((site.address, site.index))
        if own is not None:
            self.add(f"{name} = uniforms[{own}, i]")
            return
        block, word = divmod(site.index, 4)
        made = f"{name}_w"
        counter = f"words[{self.words[site.address]}, i], np.uint64({self.attempt}), np.uint64({block})"
        self.add(f"{', '.join(f'{made}{k}' for k in range(4))} = philox(seed, np.uint64({site_code(site.address)}), {counter})")
        self.add(f"{name} = {made}{word}")

    def event(self, event: GraphEvent, number: int) -> None:
        """Write how an event decides the run."""
        fails = self.failing(event)
        if fails is None:
            return
        self.add(f"if {fails}:")
        if event.kind == "guard":
            self.leave()
        elif event.kind == "call":
            self.add("break", 1)
        else:
            self.add("if most[i] == 0:", 1)
            self.add("break", 2)
            self.add("least = np.inf", 1)
            for k, node in enumerate(decisive(event)):
                self.add(f"m = abs({margin(self, node)})", 1)
                self.add(f"least = min(least, (max(m, {LEAST}) if m < np.inf else {UNKNOWN}) / scales[{number}, {k}])", 1)
            self.add("total += least", 1)
            self.add("if total > most[i]:", 1)
            self.add("break", 2)

    def leave(self) -> None:
        """Leave this run to others, unless it is rejected already."""
        self.add("if total > 0:", 1)
        self.add("break", 2)
        self.add(f"fate[i] = {LEFT}", 1)
        self.add("break", 1)


def margin(writer: Writer, node: object) -> str:
    """By how much a condition holds; not where it is negative."""
    if not isinstance(node, GraphNode):
        return "np.inf" if node else "-np.inf"
    function, arguments = node.function, node.arguments
    if function in DIFFERENCES:
        left, right = (f"np.float64({writer.operand(a)})" for a in arguments)
        return f"({right} - {left})" if DIFFERENCES[function] > 0 else f"({left} - {right})"  # type: ignore[index]
    if function is np.logical_not:
        return f"(-{margin(writer, arguments[0])})"
    if function in (np.logical_and, np.logical_or):
        best = "min" if function is np.logical_and else "max"
        return f"{best}({', '.join(margin(writer, a) for a in arguments)})"
    if function is np.where:
        condition, *sides = arguments
        first, second = (margin(writer, a) for a in sides)
        return f"({first} if {writer.operand(condition)} else {second})"
    if isinstance(function, Macro):
        name = f"{writer.macro(function)}_margin"
        writer.names[name], text = compiled_macro(function, margin)
        writer.callees.append(f"{name}: {text}")
        return f"{name}({', '.join(map(writer.operand, arguments))})"
    if isinstance(function, RowCall) and function.function in IN_POLYGON and isinstance(function.structure[0], PolygonalRegion):
        region, *rest = function.structure
        parts = [v for part in rest for v in (part if isinstance(part, Vector) else (part,))]
        values = [writer.operand(v.node if isinstance(v, Traced) else v) for v in parts]
        writer.names |= {"point_away": numba_kernels.point_away, "box_away": numba_kernels.box_away}
        away = "point_away" if len(values) == 2 else "box_away"
        return f"({UNKNOWN} if v{node.number} else -{away}({', '.join([*values, writer.array(tests_of(region).edges)])}))"
    return f"({UNKNOWN} if v{node.number} else -{UNKNOWN})"


def compile_violations(
    steps: Sequence[PlanStep], seed: int, numbers: Mapping[tuple[Address, int], int], words: Mapping[Address, int], attempt: int,
    scales: Mapping[int, float],
) -> Violations:  # fmt: skip
    """The violations of states up to a level for each, infinity beyond, and which states are left to others. Raises `NotCompiled`."""
    writer = StateWriter(numbers, words, attempt)
    writer.depth = 3
    own: list[list[float]] = []
    for step in steps:
        if step.event is not None:
            for node in step.nodes:
                writer.write(node)
            writer.event(step.event, len(own))
            own.append([*(scales.get(node.number, 1.0) for node in decisive(step.event)), 1.0][:2])
    writer.add("found[i] = total")
    writer.add("break")
    head = [
        f"def violations(seed, uniforms, words, most, scales, found, fate, {', '.join(writer.arrays)}):",
        "    for i in range(len(found)):",
        "        total = 0.0",
        "        while True:",
    ]
    compiled = numba_kernels.compile_function_text("\n".join([*head, *writer.lines]), "violations", writer.names, writer.callees)
    arrays = tuple(writer.arrays.values())

    def violations(uniforms: np.ndarray, words: np.ndarray, most: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found, fate = np.full(len(most), np.inf), np.zeros(len(most), dtype=np.int64)
        compiled(np.uint64(seed), uniforms, words, most, np.array(own).reshape(-1, 2), found, fate, *arrays)
        return found, fate == LEFT

    try:
        violations(np.zeros((len(numbers), 1)), np.zeros((len(words) + 1, 1), dtype=np.uint64), np.zeros(1))
    except Exception as problem:  # whatever the compiler cannot do, the columns can
        raise NotCompiled(f"numba gives up ({type(problem).__name__})") from None
    return violations

