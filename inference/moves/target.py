"""The states of a program and how far each is from being an accepted run: `simulate`, `assess` and `update`, for many at a time.

The contract, for the map T from states to runs, the uniform distribution U of states, and E(u), the violation of T(u)'s requirements together:

    simulate(n)        n independent states from U
    assess(u, level)   E(u), or infinity where that is more than `level`; E(u) = 0 if and only if the machine accepts T(u)
    update(u, u')      u' where E(u') is at most the level, else u; it leaves the uniform distribution on {E <= level} as it is if the
                       proposal of u' from u is symmetric

A run that ends otherwise than by a requirement (an empty region, a point outside a field) has E = infinity, and so has one that the graph does
not describe, unless the interpreter accepts it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...data.scene import Scene, scene_of
from ...interpreter.runtime.optional_packages import why_missing
from ...interpreter.runtime.program_run import Accepted, Rejected, generate_scene
from ...semantics.machine.outcome import Requirement
from ...semantics.store.errors import UsageError
from ..batch.block_rejection import COMPILE_LEAST, COMPILE_NODE, LARGEST_COMPILED, Batch
from ..batch.evaluation_plan import PlanStep, cone, only_rejects, plan
from ..batch.features import features_by_name
from ..batch.graph import GraphEvent, GraphNode, RowCall, RowDraw
from ..batch.numpy_evaluator import column
from ..batch.row_calls import Columns, FailedRows, note
from ..batch.scene_template import scenes_of
from ..batch.symbolic import nodes_in
from ..batch.violations import decisive, violation
from .states import ATTEMPT, Evaluation, Space, States


class SomeRows(dict[int, np.ndarray]):
    """Columns in some of their rows, each taken when it is asked for."""

    def __init__(self, columns: Mapping[int, np.ndarray], rows: np.ndarray) -> None:
        super().__init__()
        self.columns, self.rows = columns, rows

    def __missing__(self, number: int) -> np.ndarray:
        self[number] = found = self.columns[number][self.rows]
        return found


Below = Mapping[int, tuple[np.ndarray, np.ndarray]]
"""The numbers and the words, by their places, that are below each node which is computed row by row."""


def below_rows(space: Space, steps: Sequence[PlanStep]) -> Below:
    """Return the numbers and words below each node of a plan that is computed row by row."""
    nodes = [node for step in steps for node in step.nodes if isinstance(node.function, (RowCall, RowDraw))]
    places = {node.number: space.of_nodes(cone([node], set())) for node in nodes}
    return {k: (np.array(sorted(numbers), dtype=np.int64), np.array(sorted(words), dtype=np.int64)) for k, (numbers, words) in places.items()}


class Remembered:
    """The values of nodes that are computed row by row, in the states of some chains; `there` says of which chains each is known."""

    def __init__(self, space: Space, below: Below) -> None:
        self.space, self.below = space, below
        self.values: dict[int, np.ndarray] = {}
        self.there: dict[int, np.ndarray] = {}
        self.last: Again | None = None

    def move(self, states: States, proposed: States) -> None:
        """A move from these states to others will be looked at."""
        self.numbers, self.words = states.uniforms != proposed.uniforms, states.words != proposed.words
        self.last = None

    def evaluation(self, proposed: States) -> Again:
        """The runs of the proposed states."""
        self.last = Again(self, proposed)
        return self.last

    def taken(self, taken: np.ndarray) -> None:
        """The move was taken in these chains; of those that the evaluation came to the end of, it has all values."""
        if self.last is None:
            return
        own = taken[self.last.rows]
        rows = self.last.rows[own]
        for number in self.below.keys() & self.last.columns.keys():
            found, failed = self.last.columns[number], self.last.failed.get(number)
            if number not in self.values:
                self.values[number] = np.empty((len(taken), *found.shape[1:]), dtype=found.dtype)
                self.there[number] = np.zeros(len(taken), dtype=bool)
            self.values[number][rows] = found[own]
            self.there[number][taken] = False
            self.there[number][rows] = True if failed is None else ~(failed.rejected | failed.left)[own]

    def unchanged(self, number: int, rows: np.ndarray) -> np.ndarray:
        """In which of these rows the value of a node is known and the same."""
        if number not in self.there:
            return np.zeros(len(rows), dtype=bool)
        numbers, words = self.below[number]
        return self.there[number][rows] & ~(self.numbers[np.ix_(numbers, rows)].any(axis=0) | self.words[np.ix_(words, rows)].any(axis=0))


class Again(Evaluation):
    """The runs of proposed states, where what a move does not change is not computed again."""

    def __init__(self, known: Remembered, proposed: States) -> None:
        super().__init__(known.space, proposed)
        self.known = known

    def column(self, node: GraphNode) -> np.ndarray:
        """The column of a node."""
        if node.number not in self.known.below:
            return super().column(node)
        same = self.known.unchanged(node.number, self.rows)
        if not same.any():
            return super().column(node)
        values, rest = self.known.values[node.number][self.rows], np.flatnonzero(~same)
        if len(rest):
            failed: dict[int, FailedRows] = {}
            values[rest] = column(node, SomeRows(self.columns, rest), self.numbers.at(rest), failed)
            if node.number in failed:
                self.failed[node.number] = failed[node.number].among(rest, len(values))
        return values


CALL_SECONDS, ROW_SECONDS = 30e-6, 15e-6
"""What columns take for each node of the graph, and for each state, roughly."""

if TYPE_CHECKING:
    from ..batch.numba_codegen import Violations

MOST_LEFT = 0.1
"""Of the runs: if more are left to the interpreter, splitting and chains would take hours."""
SCALED_BY = 2_000
"""So many runs tell what a typical violation of each requirement is."""


class Assessed(NamedTuple):
    """The violation of each state, infinity above the level; which runs the interpreter accepted; columns of those accepted by the graph."""

    violation: np.ndarray
    interpreted: np.ndarray
    columns: Columns
    accepted: np.ndarray
    """The rows whose columns these are."""


def has_alternatives(node: object, expected: bool = True) -> bool:
    """Whether a condition holds (or not, as `expected`) where one of several others does: `or`, or `and` under `not`."""
    if not isinstance(node, GraphNode):
        return False
    if node.function is np.logical_not:
        return has_alternatives(node.arguments[0], not expected)
    if node.function not in (np.logical_or, np.logical_and):
        return False
    return (node.function is np.logical_or) == expected or any(has_alternatives(a, expected) for a in node.arguments)


class Target:
    """The program of a batch. Raises `UsageError` where coins are thrown once for a scene (reading `soft=scene`)."""

    def __init__(self, batch: Batch, seed: int) -> None:
        self.batch = batch
        self.graph = batch.graph
        self.space = Space(batch.graph, seed)
        if any(site.per_scene for site in self.space.sites):
            raise UsageError(
                "with the reading soft=scene, coins are thrown before the scenes are drawn: this backend draws given the requirements, coins and all",
                hint="choose --reading soft=run, or the backend batch",
            )
        self.steps: tuple[PlanStep, ...] = plan(batch.graph, batch.outputs)
        self.scales: dict[int, float] = {}
        self.evaluations = self.left = 0
        self.compiled: Violations | None = None
        self.may_compile = True
        self.compiling, self.spent = COMPILE_LEAST + COMPILE_NODE * len(batch.graph.nodes), 0.0  # seconds, as far as can be guessed

    def simulate(self, count: int, random: np.random.Generator) -> States:
        """Draw `count` independent states."""
        return self.space.draw(count, random)

    def measure(self, random: np.random.Generator) -> float:
        """Find out what a typical violation of each requirement is, which then counts as 1; the part of the runs that are accepted.

        Raises `UsageError` where the graph leaves too many runs to the interpreter.
        """
        seen: dict[int, list[np.ndarray]] = {}
        accepted = self._evaluate(self.simulate(SCALED_BY, random), np.inf, seen).violation == 0
        if self.left > MOST_LEFT * SCALED_BY:
            raise UsageError(
                f"{self.left:,} of {SCALED_BY:,} runs are left to the interpreter, since the program branches on what is drawn: "
                "smc and mcmc, which look at very many runs, would take hours",
                hint="choose the backend batch or importance",
            )
        for number, found in seen.items():
            values = np.concatenate(found)
            values = values[np.isfinite(values) & (values > 0)]
            self.scales[number] = float(np.median(values)) if len(values) else 1.0
        return float(accepted.mean())

    def assess(
        self, states: States, level: float | np.ndarray = 0.0, stuck: Counter[Requirement] | None = None, known: Remembered | None = None
    ) -> Assessed:
        """The violation of each state, as far as it is at most `level`; `stuck` counts the requirements at which the others ended."""
        self.evaluations += len(states)
        return self._evaluate(states, level, None, stuck, known)

    def expect(self, calls: int, rows: int) -> None:
        """Compile now, if so many evaluations of so many states each will probably take longer than that."""
        if calls * self.cost(rows) > self.compiling:
            self.may_compile = not self.compile()

    def cost(self, rows: int) -> float:
        """A guess at the seconds that columns take for so many states: no measurement, so that the scenes do not depend on the clock."""
        return len(self.graph.nodes) * CALL_SECONDS + rows * ROW_SECONDS

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the user about the requirements: where one can be met in several ways, one of them may
        never have been met with.
        """
        requirements = (e for e in self.graph.events if e.requirement is not None and e.kind == "require")
        texts = ", ".join(dict.fromkeys(e.requirement.text for e in requirements if has_alternatives(e.node, e.expected)))  # type: ignore[union-attr]
        if not texts:
            return ()
        return (f"there are several ways to meet {texts}: scenes in a way that no state came near would be missing, and nothing would tell",)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the features: their places in a scene; of a choice, which of its values it is."""
        named: dict[int, str] = {}
        for name, value in features_by_name(self.batch.template):
            named.setdefault(value.node.number, name)  # type: ignore[attr-defined]
        return tuple(named.get(node.number, f"operation {node.number}") for node in self.wanted)

    @cached_property
    def wanted(self) -> list[GraphNode]:
        """The nodes of the features."""
        return [node for node in self.batch.outputs if node.kind != "object"]

    def compile(self) -> str:
        """Compute violations by compiled code from now on; else why not. Takes seconds. What is accepted stays the same."""
        try:
            from ..batch.numba_codegen import NotCompiled, compile_violations
        except ImportError as problem:
            return why_missing("numba", problem)
        if len(self.graph.nodes) > LARGEST_COMPILED:
            return f"{len(self.graph.nodes):,} operations take minutes to compile"
        try:
            self.compiled = compile_violations(self.steps, self.space.seed, self.space.number, self.space.word, ATTEMPT, self.scales)
        except NotCompiled as problem:
            return str(problem)
        return ""

    def violations(self, states: States, levels: np.ndarray, known: Remembered | None = None) -> np.ndarray:
        """The violation of each state, infinity above its level."""
        if self.compiled is None and self.may_compile:
            self.spent += self.cost(len(states))
            if self.spent > self.compiling:
                self.may_compile = not self.compile()
        if self.compiled is None:
            return self.assess(states, levels, known=known).violation
        self.evaluations += len(states)
        found, left = self.compiled(states.uniforms, states.words, levels)
        if left.any():
            found[left] = self._evaluate(states.at(left), levels[left], None).violation
        return found

    def remember(self) -> Remembered | None:
        """Return a memory of the states of some chains, from their first move on; None if nothing is computed
        row by row.
        """
        return Remembered(self.space, self.below) if self.below else None

    @cached_property
    def below(self) -> Below:
        """The numbers and words below the nodes that are computed row by row."""
        return below_rows(self.space, self.steps)

    def update(
        self, states: States, violations: np.ndarray, proposed: States, level: np.ndarray, known: Remembered | None = None
    ) -> tuple[States, np.ndarray, np.ndarray]:
        """The proposed states where they are at most at the level, else those that were; their violations; which were taken.

        What is `known` of the states saves work, and is then what is known of the new ones.
        """
        if known is not None:
            known.move(states, proposed)
        found = self.violations(proposed, level, known)
        taken = found <= level
        if known is not None:
            known.taken(taken)
        return states.where(taken, proposed), np.where(taken, found, violations), taken

    def _evaluate(
        self, states: States, level: float | np.ndarray, seen: dict[int, list[np.ndarray]] | None, stuck: Counter[Requirement] | None = None,
        known: Remembered | None = None,
    ) -> Assessed:  # fmt: skip
        going = Evaluation(self.space, states) if known is None else known.evaluation(states)
        total, level = np.zeros(len(states)), np.broadcast_to(level, len(states))
        left = np.zeros(len(states), dtype=bool)
        for step in self.steps:
            going.compute(step)
            event, rows = step.event, going.rows
            if event is None:
                break
            lost = self._look_at(event, going.columns, going.failed, total, left, rows, seen)
            lost |= (total[rows] > level[rows]) | (left[rows] & (total[rows] > 0))
            if lost.any() or left[rows].any():
                if stuck is not None:
                    note(stuck, event, lost, going.failed)
                total[rows[lost]] = np.inf
                going.keep(~(lost | left[rows]))
        self.left += int(np.count_nonzero(left & (total == 0)))
        for row in np.flatnonzero(left & (total == 0)).tolist():
            total[row] = 0.0 if self.interpreted(states, row) is not None else np.inf
        return Assessed(total, left & (total == 0), going.columns, going.rows)

    def _look_at(
        self, event: GraphEvent, columns: dict[int, np.ndarray], failed: dict[int, FailedRows], total: np.ndarray, left: np.ndarray,
        rows: np.ndarray, seen: dict[int, list[np.ndarray]] | None,
    ) -> np.ndarray:  # fmt: skip
        """Add the violation of an event; which rows it ends, and, in `left`, which the interpreter must do."""
        applies = np.ones(len(rows), dtype=bool) if event.condition is None else columns[event.condition.number].astype(bool)
        if event.kind == "call":
            found = failed.get(event.node.number)
            if found is None:
                return np.zeros(len(rows), dtype=bool)
            left[rows[found.left & applies]] = True
            return found.rejected & applies
        wrong = (columns[event.node.number] != event.expected) & applies
        if event.kind == "guard":
            left[rows[wrong]] = True
            return np.zeros(len(rows), dtype=bool)
        if wrong.any():
            by = [violation(node, columns, wrong) for node in decisive(event)]
            if seen is not None:
                for node, values in zip(decisive(event), by, strict=True):
                    seen.setdefault(node.number, []).append(values)
            total[rows[wrong]] += np.min([v / self.scales.get(n.number, 1.0) for n, v in zip(decisive(event), by, strict=True)], axis=0)
        return np.zeros(len(rows), dtype=bool)

    def interpreted(self, states: States, row: int) -> Accepted | None:
        """The interpreter's run of a state, if it is accepted. Raises the program's errors."""
        ended = generate_scene(self.batch.start(), self.space.chooser(states, row, self.batch.draws), fuel=self.batch.fuel)
        return ended if isinstance(ended, Accepted) else None

    def rejected_by(self, states: States, row: int) -> Requirement:
        """The requirement at which the interpreter's run of a state ends, which is rejected."""
        ended = generate_scene(self.batch.start(), self.space.chooser(states, row, self.batch.draws), fuel=self.batch.fuel)
        assert isinstance(ended, Rejected)
        return ended.requirement

    def scenes(self, states: States, seed: int, start: int = 0) -> Iterator[Scene]:
        """The scenes of accepted states, numbered from `start` on."""
        for part in states.parts():
            found = self.assess(part)
            indices = np.arange(len(part)) + start
            made = scenes_of(self.batch.template, found.columns, seed, indices[found.accepted], np.zeros(len(found.accepted), dtype=np.int64))
            for row in range(len(part)):
                if not found.interpreted[row]:
                    yield next(made)
                    continue
                ended = self.interpreted(part, row)
                assert ended is not None
                yield scene_of(ended.state, seed, int(indices[row]), 1, pruned=bool(self.batch.draws))
            start += len(part)

    def features(self, states: States) -> np.ndarray:
        """The features of accepted states, by which they are compared: (names, states); the median where only the interpreter knows one."""
        found = np.full((len(self.wanted), len(states)), np.nan)
        begin = 0
        for part in states.parts():
            assessed = self.assess(part)
            for number, node in enumerate(self.wanted):
                found[number, begin + assessed.accepted] = assessed.columns[node.number].astype(float)
            begin += len(part)
        unknown = np.isnan(found)
        if unknown.any():
            medians = [float(np.nanmedian(own)) if not np.isnan(own).all() else 0.0 for own in found]
            found = np.where(unknown, np.array(medians)[:, None], found)
        return found

    def blocks(self) -> list[tuple[frozenset[int], frozenset[int]]]:
        """The numbers and the words of each object: those that it alone is made of, or it first; then each number of the rest, and their words."""
        seen_numbers: set[int] = set()
        seen_words: set[int] = set()
        found: list[tuple[frozenset[int], frozenset[int]]] = []
        for made in self.batch.template.objects:
            numbers, words = self.space.of_nodes(cone(nodes_in(made.properties), set()))
            own = (numbers - seen_numbers, words - seen_words)
            seen_numbers |= numbers
            seen_words |= words
            if own[0] or own[1]:
                found.append(own)
        rest = frozenset(range(len(self.space.sites))) - seen_numbers
        may_be_left = not all(only_rejects(event) for event in self.graph.events)
        others = frozenset(range(len(self.space.drawn) + may_be_left)) - seen_words
        found += [(frozenset([number]), frozenset()) for number in sorted(rest)]
        return [*found, (frozenset(), others)] if others else found

