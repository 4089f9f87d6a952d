"""The violation of states, compiled: the graph written as a function of the numbers and words of one state after the other.

It is that of `evaluate.margins`, up to rounding; which states are accepted is the same, bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ....interpreter.streams import site_code
from ....semantics.space.regions import PolygonalRegion
from ....semantics.space.vectors import Vector
from ..evaluate.margins import DIFFERENCES, IN_POLYGON, LEAST, UNKNOWN, decisive
from ..evaluate.plan import PlanStep
from ..evaluate.polygons import tests_of
from ..trace.graph import GraphEvent, GraphNode, Macro, RowCall, Site
from ..trace.symbols import Traced
from . import kernels
from .source import LEFT, NotCompiled, Writer, compiled_macro

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
        """What becomes of the run."""
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
        writer.names |= {"point_away": kernels.point_away, "box_away": kernels.box_away}
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
    compiled = kernels.made("\n".join([*head, *writer.lines]), "violations", writer.names, writer.callees)
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
