"""Which features two sources of scenes are compared by, and the e-process of each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from ...semantics.store.errors import UsageError
from ..enumeration import Enumeration
from .betting import Array, one_sample_wealth, two_sample_wealth
from .cells import QUARTERS, Cells, Intervals, OfLaw, Repeated, Values, cells_of
from .exact_laws import Categorical, Continuous
from .scene_columns import ABSENT, Column, FeatureTable, is_relation
from .verdict import Feature

MOST_PAIRS = 300
MOST_COARSE = 4
LEAST_TAIL = 1e-3  # numbers of attempts that are rarer than this share a cell


@dataclass(frozen=True)
class Cut:
    """The cells of one feature: fine ones for itself, coarse ones for its pairs with others.

    `column` is the feature's name, unless the cells have another one; `whole` says that it stands for all features together.
    """

    name: str
    fine: Cells
    coarse: Cells
    column: str = ""
    whole: bool = False

    def column_of(self, table: FeatureTable) -> Column:
        """The column that is cut."""
        name = self.column or self.name
        return table.columns.get(name) or Column(name, np.full(table.n, ABSENT, dtype=object))

    def assign(self, table: FeatureTable) -> tuple[Array, Array]:
        """The fine and the coarse cell of each scene."""
        column = self.column_of(table)
        fine = self.fine.assign(column)
        return fine, fine if self.coarse is self.fine else self.coarse.assign(column)


Assigned = Mapping[str, tuple[Array, Array]]


def assign_cells(cuts: Sequence[Cut], table: FeatureTable) -> Assigned:
    """The cells of all features in the scenes of a table."""
    return {cut.name: cut.assign(table) for cut in cuts}


@dataclass
class FeatureTest:
    """The e-process of one feature, or of a pair: counts in its cells so far, and the law's probabilities if there is one.

    `first` are the counts of the first blocks, which only tell how the cells are filled. `stated`: the stated power covers this feature.
    """

    cuts: tuple[Cut, ...]
    law: Array | None = None
    first: Array | None = None
    stated: bool = True
    counts: Array = field(init=False)
    others: Array = field(init=False)
    best: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self.counts, self.others = np.zeros(self.size), np.zeros(self.size)

    @property
    def expected(self) -> Array:
        """How the cells are filled, by the law or by the first blocks."""
        found = self.law if self.law is not None else self.first
        assert found is not None
        return found

    @property
    def name(self) -> str:
        """The feature's name; a pair is written `one & other`."""
        return " & ".join(cut.name for cut in self.cuts)

    @property
    def size(self) -> int:
        """How many cells there are."""
        return self.cuts[0].fine.count if len(self.cuts) == 1 else self.cuts[0].coarse.count * self.cuts[1].coarse.count

    def cells(self, found: Assigned) -> Array:
        """The cell of each scene."""
        if len(self.cuts) == 1:
            return found[self.cuts[0].name][0]
        one, other = self.cuts
        return found[one.name][1] * other.coarse.count + found[other.name][1]

    def count(self, a: Assigned, b: Assigned | None) -> None:
        """Count some scenes of both sides, or of one."""
        self.counts += np.bincount(self.cells(a), minlength=self.size)
        if b is not None:
            self.others += np.bincount(self.cells(b), minlength=self.size)

    def look(self) -> float:
        """The log wealth now."""
        wealth = float(two_sample_wealth(self.counts, self.others) if self.law is None else one_sample_wealth(self.counts, self.law))
        self.best = max(self.best, wealth)
        return wealth

    def feature(self) -> Feature:
        """Return the result of the comparison of the feature."""
        labels = self.cuts[0].fine.labels()
        if len(self.cuts) == 2:
            labels = tuple(f"{one} & {other}" for one in self.cuts[0].coarse.labels() for other in self.cuts[1].coarse.labels())
        expected = self.others if self.law is None else self.law * self.counts.sum()
        return Feature(self.name, self.best / math.log(10.0), labels, tuple(self.counts.tolist()), tuple(expected.tolist()))


def tests_between(
    a: FeatureTable, b: FeatureTable, constants: Mapping[str, object], stated: Callable[[str], bool], tolerance: float
) -> list[FeatureTest]:
    """The tests for two samples, cut by their first blocks; the stated power is that for the features that `stated` says."""
    shared = [name for name in a.columns if name in b.columns and name not in constants]
    cuts: list[Cut] = []
    seen: set[object] = set()
    for name in shared:
        column = pool_columns(a.columns[name], b.columns[name])
        key = (column.is_number, column.values.tobytes() if column.is_number else tuple(column.values))
        if key not in seen:
            seen.add(key)
            cuts.append(cut_of(column, tolerance=tolerance))
    tests = [FeatureTest((cut,), stated=stated(cut.name)) for cut in cuts] + [FeatureTest(pair) for pair in pairs_of(cuts)]
    tests += [FeatureTest((again,), stated=False) for again in map(repeated_values_cut, cuts) if again is not None]
    every = [test.cuts[0] for test in tests if len(test.cuts) == 1]
    blocks = [assign_cells(every, table) for table in (a, b)]
    for test in tests:
        test.first = np.sum([np.bincount(test.cells(block), minlength=test.size) for block in blocks], axis=0)
    learn(every, a)
    return tests


def repeated_values_cut(cut: Cut) -> Cut | None:
    """The repeated values of a feature, if it is a number with many values."""
    if not isinstance(cut.fine, Intervals) or is_relation(cut.name) or cut.name == "attempts":
        return None
    cells = Repeated()
    return Cut(f"repeated values of {cut.name}", cells, cells, cut.name)


def learn(cuts: Sequence[Cut], table: FeatureTable) -> None:
    """Remember the repeated values in a block of the samples, for the bets on later blocks."""
    for cut in cuts:
        if isinstance(cut.fine, Repeated):
            cut.fine.learn(cut.column_of(table))


def one_sided(a: FeatureTable, b: FeatureTable, constants: Mapping[str, object]) -> list[str]:
    """The features that only one of the sides has, those that the samples `a` lack first; constants count as features of the other."""
    missing = [name for name in (*b.columns, *constants) if name not in a.columns]
    return list(dict.fromkeys([*missing, *(name for name in a.columns if name not in b.columns and name not in constants)]))


def pool_columns(one: Column, other: Column) -> Column:
    """The values of both; the numbers alone, if only one of them has numbers: what is not a number then has a cell of its own."""
    if one.is_number != other.is_number:
        return one if one.is_number else other
    return Column(one.name, np.concatenate([one.values, other.values]))


def cut_of(column: Column, weights: Array | None = None, *, tolerance: float) -> Cut:
    """The cells of a feature by values of it; against a law, `weights` are their probabilities."""
    fine = cells_of(column, weights, exact=weights is not None, tolerance=tolerance)
    if column.is_number:
        return Cut(column.name, fine, cells_of(column, weights, QUARTERS, tolerance=tolerance))
    shares = np.ones(len(column.values)) if weights is None else weights
    totals = {name: float(np.sum(shares[column.values == name])) for name in dict.fromkeys(column.values)}
    most = sorted(totals, key=lambda name: -totals[name])[:MOST_COARSE]
    return Cut(column.name, fine, Values(tuple(most), None))


def pairs_of(cuts: Sequence[Cut]) -> Iterator[tuple[Cut, Cut]]:
    """Pairs of features that vary and stand in the scene as they are, nearest to each other first."""
    varying = [cut for cut in cuts if cut.coarse.count > 2 and not is_relation(cut.name) and cut.name != "attempts"]
    found = sorted(combinations(range(len(varying)), 2), key=lambda pair: (pair[1] - pair[0], pair))
    yield from ((varying[i], varying[j]) for i, j in found[:MOST_PAIRS])


def tests_of_laws(a: FeatureTable, laws: Mapping[str, Continuous | Categorical]) -> list[FeatureTest]:
    """The tests of a sample against laws of its features in closed form. Raises `UsageError` for a feature that it does not have."""
    missing = [name for name in laws if name not in a.columns]
    if missing:
        raise UsageError(f"the samples have no feature {missing[0]}", hint=f"they have {', '.join(list(a.columns)[:6])}, ...")
    cells = {name: OfLaw(law) for name, law in laws.items()}
    return [FeatureTest((Cut(name, found, found),), found.probabilities) for name, found in cells.items()]


def attempts_test(law: Enumeration) -> FeatureTest:
    """The number of attempts against its exact law: geometric, or a mixture of such."""
    shares: list[float] = []
    while 1.0 - sum(shares) > LEAST_TAIL and len(shares) < 200:
        shares.append(float(law.attempts_probability(len(shares) + 1)))
    edges = Intervals(np.arange(len(shares) + 1) + 0.5)
    cells = np.array([0.0, *shares, max(0.0, 1.0 - sum(shares)), 0.0])
    return FeatureTest((Cut("attempts", edges, edges),), cells / cells.sum())
