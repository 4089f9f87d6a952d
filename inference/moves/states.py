"""The randomness of a run as a point: a number in [0, 1) for each of the numbers that its draws take.

A run is a function of these numbers (DESIGN, section 5), which are independent and uniform. So the
distribution of the scenes is that of the uniform distribution on the points whose runs are accepted: there
are no densities, and discrete draws, regions, truncated normal distributions and mixtures are all alike. A
draw that takes no fixed number of numbers has a word instead, which names a stream of them; so have, all
together, the draws of a run that the graph does not know of.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ...interpreter.runtime.answerers import AS_THEY_ARE, Draws, replace_distribution
from ...interpreter.runtime.program_run import Chooser
from ...interpreter.runtime.random_streams import UNIT, UNUSED_BITS, Stream, fold, site_code
from ...semantics.machine.outcome import Draw
from ..batch.evaluation_plan import PlanStep
from ..batch.graph import Graph, GraphNode, RowDraw, Site
from ..batch.numpy_evaluator import column
from ..batch.primitives.random_numbers import Numbers, philox_rows
from ..batch.row_calls import FailedRows

Address = tuple[int, ...]
CHUNK = 1 << 15
"""States that are looked at, or moved, at a time: for more, columns would take much memory."""
WORD_BITS = 53
"""Of a word, so that a float holds it."""
ATTEMPT = (1 << 64) - 2
"""The attempt under which the streams of states are numbered, which no run has."""


@dataclass(frozen=True, slots=True, eq=False)
class States:
    """Many states: numbers in [0, 1), (sites, rows), and words, (draws, rows)."""

    uniforms: np.ndarray
    words: np.ndarray

    def __len__(self) -> int:
        return self.uniforms.shape[1]

    def at(self, rows: np.ndarray) -> States:
        """Some of them, by their rows or by a mask."""
        return States(self.uniforms[:, rows], self.words[:, rows])

    def parts(self) -> Iterator[States]:
        """So many at a time that columns of them fit into memory."""
        for first in range(0, len(self), CHUNK):
            yield States(self.uniforms[:, first : first + CHUNK], self.words[:, first : first + CHUNK])

    def where(self, chosen: np.ndarray, others: States) -> States:
        """Return these states, with the states of `others` in the chosen rows."""
        return States(np.where(chosen, others.uniforms, self.uniforms), np.where(chosen, others.words, self.words))

    def put(self, rows: np.ndarray, others: States) -> States:
        """With `others` in the rows of a mask."""
        uniforms, words = self.uniforms.copy(), self.words.copy()
        uniforms[:, rows], words[:, rows] = others.uniforms, others.words
        return States(uniforms, words)

    @staticmethod
    def joined(parts: list[States]) -> States:
        """All of these, one after the other."""
        return States(np.concatenate([p.uniforms for p in parts], axis=1), np.concatenate([p.words for p in parts], axis=1))


class Space:
    """The states of the runs of a graph.

    `sites` are the places of its numbers, and `drawn` the addresses of the draws that have words. The last word is for all other draws.
    """

    def __init__(self, graph: Graph, seed: int) -> None:
        self.seed = fold(seed)
        self.sites = tuple(node.function for node in graph.nodes if isinstance(node.function, Site))
        self.drawn = tuple(dict.fromkeys(node.function.address for node in graph.nodes if isinstance(node.function, RowDraw)))
        self.number = {(site.address, site.index): k for k, site in enumerate(self.sites)}
        self.word = {address: k for k, address in enumerate(self.drawn)}

    def draw(self, count: int, random: np.random.Generator) -> States:
        """Independent states: those of runs as rejection makes them."""
        words = random.integers(0, 1 << WORD_BITS, (len(self.drawn) + 1, count), dtype=np.uint64)
        return States(random.random((len(self.sites), count)), words)

    def stream(self, address: Address, word: int) -> Callable[[], float]:
        """The numbers of a draw that has a word."""
        return Stream(self.seed, word, ATTEMPT).at(address)

    def chooser(self, states: States, row: int, draws: Draws = AS_THEY_ARE) -> Chooser:
        """Answers the machine's draws with the numbers of one state, so that the interpreter's run is that of the graph."""

        def choose(draw: Draw) -> object:
            rest = self.stream(draw.address, int(states.words[self.word.get(draw.address, -1), row]))
            own = (float(states.uniforms[k, row]) for k in self.places(draw.address))
            return replace_distribution(draw, draws).distribution.sample(chain(own, iter(rest, None)).__next__)

        return choose

    def places(self, address: Address) -> list[int]:
        """Return the places of the numbers of a draw, in order."""
        found: list[int] = []
        while (address, len(found)) in self.number:
            found.append(self.number[address, len(found)])
        return found

    def of_nodes(self, nodes: list[GraphNode]) -> tuple[frozenset[int], frozenset[int]]:
        """The numbers and the words that are among some nodes, by their places."""
        numbers = {self.number[n.function.address, n.function.index] for n in nodes if isinstance(n.function, Site)}
        return frozenset(numbers), frozenset(self.word[n.function.address] for n in nodes if isinstance(n.function, RowDraw))


class Evaluation:
    """The runs of some states on columns, event after event, until they are left out."""

    def __init__(self, space: Space, states: States) -> None:
        self.numbers = StateNumbers(space, states)
        self.columns: dict[int, np.ndarray] = {}
        self.failed: dict[int, FailedRows] = {}

    @property
    def rows(self) -> np.ndarray:
        """The runs that are there."""
        return self.numbers.rows

    def compute(self, step: PlanStep) -> None:
        """The columns of a step."""
        for node in step.nodes:
            self.columns[node.number] = self.column(node)

    def column(self, node: GraphNode) -> np.ndarray:
        """The column of a node."""
        return column(node, self.columns, self.numbers, self.failed)

    def keep(self, kept: np.ndarray) -> None:
        """Leave out the runs where `kept` is False."""
        self.numbers.keep(kept)
        self.columns = {name: values[kept] for name, values in self.columns.items()}
        self.failed = {name: f.at(kept) for name, f in self.failed.items()}


class StateNumbers(Numbers):
    """The numbers of some states, as an evaluation asks for them."""

    def __init__(self, space: Space, states: States, rows: np.ndarray | None = None) -> None:
        self.space, self.states = space, states
        self.rows = np.arange(len(states)) if rows is None else rows
        self.blocks: dict[tuple[object, ...], np.ndarray] = {}

    def __len__(self) -> int:
        return len(self.rows)

    def copy(self) -> StateNumbers:
        """Return a copy from which rows can be left out independently."""
        return StateNumbers(self.space, self.states, self.rows)

    def at(self, rows: np.ndarray) -> StateNumbers:
        """The numbers of some of the rows."""
        return StateNumbers(self.space, self.states, self.rows[rows])

    def keep(self, kept: np.ndarray) -> None:
        """Leave out the rows where `kept` is False."""
        self.rows = self.rows[kept]
        self.blocks = {name: block[kept] for name, block in self.blocks.items()}

    def stream(self, row: int, address: Address, per_scene: bool) -> Callable[[], float]:
        """The numbers of one row at a draw that has a word."""
        return self.space.stream(address, int(self.states.words[self.space.word[address], self.rows[row]]))

    def column(self, site: Site) -> np.ndarray:
        """The numbers in [0, 1) of a site, or from the stream of a draw that has a word."""
        own = self.space.number.get((site.address, site.index))
        if own is not None:
            return self.states.uniforms[own, self.rows]
        block, place = divmod(site.index, 4)
        words = self.blocks.get((site.address, block))
        if words is None:
            names = self.states.words[self.space.word[site.address], self.rows]
            words = philox_rows((self.space.seed, site_code(site.address)), names, np.full_like(names, ATTEMPT), block)
            self.blocks[site.address, block] = words
        return (words[:, place] >> np.uint64(UNUSED_BITS)) * UNIT
