"""One sample against an exact distribution of scenes: each feature, and all of them together."""

from __future__ import annotations

import numpy as np

from ...semantics.kernel.errors import UsageError
from ..enumeration import Enumeration
from .betting import Array
from .cells import MOST_EXACT, Codes, all_values
from .columns import FeatureTable, is_relation
from .facts import Facts
from .features import Cut, FeatureTest, assigned, attempts_test, cut_of, pairs_of
from .names import SampleNames
from .relations import related, table_of

TOGETHER = "all features together"
IMPOSSIBLE = -1


class Outcomes:
    """The outcomes of a finite program in those features that samples have, each as a class of its own; those that these do not tell apart are one.

    `features` are the names of the samples' features. Numbers are the same up to the tolerance (relative, from 1 on). Raises `UsageError` for an
    enumeration that is an approximation.
    """

    def __init__(self, law: Enumeration, features: FeatureTable, facts: Facts, names: SampleNames, tolerance: float) -> None:
        if law.discretized is not None:
            raise UsageError("a discretized enumeration is an approximation, so nothing can be tested against it")
        self.law = law
        self.tolerance = tolerance
        self.table = names.kept(table_of(law.scenes))
        self.weights = np.array([float(outcome.probability) for outcome in law.outcomes])
        self.known = [
            name for name in self.table.arrays
            if name in features.arrays and not is_relation(name) and name not in ("attempts", *facts.constants)
        ]  # fmt: skip
        self.cells = [all_values(self.table.columns[name], tolerance) for name in self.known]
        self.steps: list[Array] = []
        self.first_of, self.classes = self.numbered()

    def numbered(self) -> tuple[Array, Array]:
        """The first outcome of each class, and the class of each outcome."""
        code = np.zeros(self.table.n, dtype=np.int64)
        for name, cells in zip(self.known, self.cells, strict=True):
            different, code = np.unique(code * cells.count + cells.assign(self.table.columns[name]), return_inverse=True)
            self.steps.append(different)
        _, first, classes = np.unique(code, return_index=True, return_inverse=True)
        return first, classes

    def class_of(self, table: FeatureTable) -> Array:
        """The class of each scene, `IMPOSSIBLE` where there is none with its values."""
        code, alive = np.zeros(table.n, dtype=np.int64), np.ones(table.n, dtype=bool)
        for name, cells, different in zip(self.known, self.cells, self.steps, strict=True):
            key = code * cells.count + cells.assign(table.columns[name])
            code = np.minimum(np.searchsorted(different, key), len(different) - 1)
            alive &= different[code] == key
        return np.where(alive, code, IMPOSSIBLE)

    def complete(self, table: FeatureTable) -> FeatureTable:
        """The scenes with their class, and the relations between objects in the outcome that they are."""
        classes = self.class_of(table)
        there = related(FeatureTable({name: v[:0] for name, v in table.arrays.items()}, 0))
        relations = {name: self.table.arrays[name] for name in there.arrays if is_relation(name) and name in self.table.arrays}
        found = {name: np.where(classes < 0, np.nan, values[self.first_of[classes]]) for name, values in relations.items()}
        return table.plus({**found, TOGETHER: classes.astype(float)})

    def tests(self, first: FeatureTable) -> list[FeatureTest]:
        """The tests of samples, of which `first` are some."""
        there = self.complete(first.rows(0, 0))
        shown = [name for name in self.table.arrays if name in self.known or (is_relation(name) and name in there.arrays)]
        cuts = [cut_of(self.table.columns[name], self.weights, tolerance=self.tolerance) for name in shown]
        tests = [FeatureTest((cut,)) for cut in cuts] + [FeatureTest(pair) for pair in pairs_of(cuts)]
        found = assigned(cuts, self.table)
        for test in tests:
            test.law = self.shares(test.cells(found), test.size)
        if len(self.known) > 1 or len(self.first_of) > MOST_EXACT:
            together = Codes(tuple(self.label(k) for k in self.first_of.tolist()))
            cut = Cut(TOGETHER, together, together, whole=True)
            tests.append(FeatureTest((cut,), self.shares(self.classes, together.count), stated=together.count <= MOST_EXACT))
        return tests + ([attempts_test(self.law)] if "attempts" in first.arrays else [])

    def shares(self, cells: Array, size: int) -> Array:
        """The probabilities of cells of the outcomes."""
        found = np.bincount(cells, weights=self.weights, minlength=size)
        return found / found.sum()

    def label(self, outcome: int) -> str:
        """An outcome, in the features that vary."""
        shown = [str(self.table.arrays[name][outcome]) for name in self.known]
        return ", ".join(shown[:12])
