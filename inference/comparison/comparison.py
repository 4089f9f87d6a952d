"""`compare`: whether two sources of scenes have the same distribution, with a stated risk of a false alarm and a stated power.

The features come from the scenes themselves: every property, every parameter, relations between objects, the number of attempts, and the cells of
pairs of features; and from the program: see `facts`. Each feature has a betting e-process (`betting`); the average of all is one more, and one may
look at it at any time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from ...data.scene import Scene
from ...semantics.store.errors import UsageError
from ..enumeration import Enumeration
from .betting import Array, average_e_values, one_sample_wealth, two_sample_wealth
from .cells import MOST_EXACT, Codes, all_values
from .exact_laws import DEFAULT_ALPHA, Categorical, Continuous
from .feature_names import SampleNames
from .features import Cut, FeatureTest, assign_cells, attempts_test, cut_of, learn, one_sided, pairs_of, tests_between, tests_of_laws
from .impossible_values import MOST_LISTED, Findings, constants_of
from .known_features import Facts, WithFacts
from .relations import add_relations, table_of
from .rounding import DEFAULT_TOLERANCE, Rounding, round_table, roundings_of
from .sample_files import AnyScene, Samples
from .scene_columns import FeatureTable, features_table, is_relation, stack_tables
from .verdict import BURNED_SHARE, FIRST_BLOCK, MOST, Kind, Verdict

QUANTILE = 2.3263478740408408  # of the standard normal, at 0.99


class Hardest:
    """For each of some features, the laws that are hardest to tell apart: `p` is (features, cells), padded with zeros."""

    def __init__(self, laws: Sequence[Array], *, exact: bool) -> None:
        self.exact = exact
        known = [p[p > 0] for p in laws]
        known = [np.sort(p / p.sum())[::-1] for p in known if len(p) > 1] or [np.array([0.5, 0.5])]
        self.p = np.zeros((len(known), max(len(p) for p in known)))
        self.half = np.zeros(self.p.shape, dtype=bool)
        for row, p in enumerate(known):
            self.p[row, : len(p)] = p
            self.half[row, : len(p)] = lighter_half(p)

    def tilted(self, by: float) -> Array:
        """The laws with `by` more probability in the lighter halves, as much as there is room for."""
        light = np.where(self.half, self.p, 0.0).sum(-1, keepdims=True)
        moved = np.clip(light + by, 0.0, 1.0)
        return np.where(self.half, self.p * moved / light, self.p * (1.0 - moved) / (1.0 - light))

    def wealth(self, n: int, tv: float) -> Array:
        """For each feature, the log wealth that is exceeded with probability 0.99 after `n` draws of each side that differ by `tv`."""
        if self.exact:
            q = self.tilted(tv)
            gain = logarithm(q, self.p)
            return one_sample_wealth(n * q, self.p) - QUANTILE * np.sqrt(n * variance(q, gain))
        a, b = self.tilted(tv / 2), self.tilted(-tv / 2)
        spread = variance(a, logarithm(a, (a + b) / 2)) + variance(b, logarithm(b, (a + b) / 2))
        return two_sample_wealth(n * a, n * b) - QUANTILE * np.sqrt(n * spread)

    def found(self, n: int, tv: float, threshold: float) -> bool:
        """Whether `n` draws of each side show a difference of `tv` in any one feature with probability 0.99."""
        return bool(np.min(self.wealth(n, tv)) >= threshold)


def lighter_half(p: Array) -> Array:
    """Which cells of a law, the most probable first, make up the lighter of two halves that are as equal as can be had greedily."""
    sides, weights = np.zeros(len(p), dtype=bool), [0.0, 0.0]
    for cell, share in enumerate(p):
        side = int(weights[1] < weights[0])
        sides[cell] = side
        weights[side] += share
    return sides if weights[1] <= weights[0] else ~sides


def logarithm(q: Array, p: Array) -> Array:
    """log(q / p), and 0 where there is nothing."""
    return np.log(np.where((q > 0) & (p > 0), q, 1.0) / np.where((q > 0) & (p > 0), p, 1.0))


def variance(q: Array, gain: Array) -> Array:
    """The variance of the gain of one draw from `q`."""
    return np.maximum((q * gain**2).sum(-1) - (q * gain).sum(-1) ** 2, 0.0)


def threshold_of(alpha: float, features: int) -> float:
    """The log wealth of one feature that makes the average of all reach 1/α."""
    return math.log(max(1, features)) - math.log(alpha)


def required_draws(tv: float, alpha: float, features: int, hardest: Hardest) -> int:
    """The number of draws of each side after which a difference of `tv` in any one of `features` is found with probability 0.99."""
    threshold = threshold_of(alpha, features)
    low, high = 1, 2
    while high < MOST and not hardest.found(high, tv, threshold):
        low, high = high, 2 * high
    while high - low > max(1, low // 100):
        middle = (low + high) // 2
        low, high = (low, middle) if hardest.found(middle, tv, threshold) else (middle, high)
    return high


def detectable(n: int, alpha: float, features: int, hardest: Hardest) -> float:
    """The least total variation that `n` draws of each side would have shown; 1 if they would not have shown any."""
    threshold = threshold_of(alpha, features)
    low, high = 0.0, 1.0
    if n < 1 or not hardest.found(n, high, threshold):
        return 1.0
    while high - low > 1e-3 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if hardest.found(n, middle, threshold) else (middle, high)
    return high


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
        there = add_relations(FeatureTable({name: v[:0] for name, v in table.arrays.items()}, 0))
        relations = {name: self.table.arrays[name] for name in there.arrays if is_relation(name) and name in self.table.arrays}
        found = {name: np.where(classes < 0, np.nan, values[self.first_of[classes]]) for name, values in relations.items()}
        return table.plus({**found, TOGETHER: classes.astype(float)})

    def tests(self, first: FeatureTable) -> list[FeatureTest]:
        """The tests of samples, of which `first` are some."""
        there = self.complete(first.rows(0, 0))
        shown = [name for name in self.table.arrays if name in self.known or (is_relation(name) and name in there.arrays)]
        cuts = [cut_of(self.table.columns[name], self.weights, tolerance=self.tolerance) for name in shown]
        tests = [FeatureTest((cut,)) for cut in cuts] + [FeatureTest(pair) for pair in pairs_of(cuts)]
        found = assign_cells(cuts, self.table)
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


DEFAULT_TV = 0.01
GROWTH = 1.25
"""The factor by which the number of scenes grows from one look to the next."""
LEAST_TOLERANCE = 1e-12
MOST_AT_ONCE = 1 << 13
"""Scenes of each side that are counted at a time."""


class Sampler(Protocol):
    """Something that draws scenes, such as a scenario: scene `index` of `seed` is always the same."""

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterable[AnyScene]:
        """Scenes `start` to `start + n - 1` of `seed`."""
        ...


@runtime_checkable
class WithTables(Protocol):
    """A sampler that gives the features of many scenes at a time."""

    def feature_tables(self, n: int, seed: int = 0, *, start: int = 0) -> Iterable[FeatureTable]:
        """The features of scenes `start` to `start + n - 1` of `seed`, some scenes after the other."""
        ...


Laws = Mapping[str, Continuous | Categorical]
"""Exact laws of features in closed form, by the features' names."""

Scenes = Sequence[Scene] | Sequence[Mapping[str, object]]
Source = Scenes | FeatureTable | Sampler | Samples


def compare(
    a: Source, b: Source | Enumeration | Laws, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, budget: int | None = None,
    seeds: tuple[int, int] = (0, 1), facts: Facts | None = None, names: SampleNames | None = None, tolerance: float = DEFAULT_TOLERANCE,
    replay: str = "",
) -> Verdict:  # fmt: skip
    """Whether the draws `a` have the distribution of the draws `b`, or an exact one: an enumeration, or laws of features in closed form.

    `a` and `b` are scenes (as such, as JSON objects in the scene format, or as a table), or draw them with `seeds`. P("different") <= `alpha`
    if there is no difference. `budget` is the largest number of scenes of each side; without one all that are there are
    used, or as many as a difference of `detect_tv` needs. `facts` are what is known of the scenes of `b`, whatever is drawn; a
    scenario given as `b` knows its own. `names` says what is not compared, and what `a` calls the features; numbers that differ by no more than
    `tolerance` (relative to the larger of them and 1) are the same.
    Raises `UsageError` for settings or scenes that cannot be compared.
    """
    check_settings(alpha, detect_tv, budget, tolerance)
    names = names or SampleNames()
    known = facts if facts is not None else b.facts if isinstance(b, WithFacts) else Facts()
    again = replay or f"compare(a, b, alpha={alpha:g}, detect_tv={detect_tv:g}, budget={budget}, seeds={seeds})"
    terms = Terms(alpha, detect_tv, known.without(names.ignored), names, tolerance, seeds, again)
    if isinstance(b, (Enumeration, Mapping)):
        return _with_law(a, b, budget, terms)
    return _two_samples(SceneStream(a, seeds[0], terms), SceneStream(b, seeds[1], terms, theirs=False), budget, terms)


def check_settings(alpha: float, detect_tv: float, budget: int | None, tolerance: float = DEFAULT_TOLERANCE) -> None:
    """Raise `UsageError` for levels, sizes and tolerances that are out of range."""
    if not 0 < alpha < 1:
        raise UsageError(f"alpha is a probability between 0 and 1, not {alpha:g}")
    if not 0 < detect_tv < 1:
        raise UsageError(f"the total variation to detect is between 0 and 1, not {detect_tv:g}")
    if budget is not None and budget < 1:
        raise UsageError(f"the budget is a number of scenes, not {budget}")
    if not LEAST_TOLERANCE <= tolerance < 1:
        raise UsageError(f"the tolerance is between {LEAST_TOLERANCE:g} (the rounding of one's own arithmetic) and 1, not {tolerance:g}")


class Terms(NamedTuple):
    """The settings of a comparison."""

    alpha: float
    detect_tv: float
    facts: Facts
    names: SampleNames
    tolerance: float
    seeds: tuple[int, int]
    replay: str


class SceneStream:
    """The scenes of a source, block by block; `length` is None if there is no end to them. `theirs`: these are the samples.

    `found` is what cannot be among the scenes that were taken, or among all if they are given; what is given is looked at as a whole.
    """

    def __init__(self, source: Source, seed: int, terms: Terms, *, theirs: bool = True) -> None:
        self.seed = seed
        self.terms = terms
        self.theirs = theirs
        self.at = 0
        self.sampler: Sampler | None = None
        self.length: int | None = None
        self.found = Findings(terms.facts, terms.tolerance)
        self.tables: Iterator[FeatureTable] = iter(())
        self.left: list[FeatureTable] = []
        if isinstance(source, (Samples, FeatureTable, Sequence)):
            facts = terms.facts if theirs else Facts()
            given = source if isinstance(source, Samples) else Samples(
                source, seed, facts=facts, names=terms.names, tolerance=terms.tolerance, theirs=theirs
            )
            self.length, self.tables, self.found = given.n, given.tables(), given.found
        else:
            self.sampler = source

    def take(self, n: int) -> FeatureTable:
        """The next `n` scenes, or as many as are left."""
        if self.sampler is not None:
            start, self.at = self.at, self.at + n
            return self.drawn(n, start)
        while sum(table.n for table in self.left) < n and (more := next(self.tables, None)) is not None:
            self.left.append(more)
        whole = stack_tables(self.left) if self.left else FeatureTable({}, 0)
        self.left = [whole.rows(n, whole.n)]
        return whole.rows(0, n)

    def drawn(self, n: int, start: int) -> FeatureTable:
        """Scenes from `start` on, drawn now."""
        sampler = self.sampler
        if isinstance(sampler, WithTables):
            table = stack_tables(list(sampler.feature_tables(n, self.seed, start=start)))
        else:
            assert sampler is not None
            table = features_table(sampler.sample_many(n, self.seed, start=start))
        table = FeatureTable(table.arrays, table.n, np.arange(start + 1, start + 1 + table.n))
        if not self.theirs:
            return self.terms.names.kept(table)
        table = self.terms.names.translated(table)
        self.found.look(table)
        return table


@dataclass(frozen=True)
class SceneView:
    """The features by which scenes are compared, rounded alike on both sides, with the features derived from
    them.
    """

    facts: Facts = field(default_factory=Facts)
    roundings: Mapping[str, Rounding] = field(default_factory=dict)

    def __call__(self, table: FeatureTable) -> FeatureTable:
        """The table with all features."""
        found = add_relations(round_table(table, self.roundings))
        return found.plus(self.facts.derived(found))


def _two_samples(a: SceneStream, b: SceneStream, budget: int | None, terms: Terms) -> Verdict:
    known = [n for n in (a.length, b.length, budget) if n is not None]
    available = min(known, default=None)
    if available == 0:
        raise UsageError("there are no scenes to compare")
    burned = FIRST_BLOCK[1] if available is None else min(max(available // BURNED_SHARE, min(FIRST_BLOCK[0], (available + 1) // 2)), FIRST_BLOCK[1])
    first = a.take(burned), b.take(burned)
    view = SceneView(terms.facts, roundings_of(*first, terms.tolerance))
    one, other = map(view, first)
    own = view.facts.derived(one)
    skipped = one_sided(*first, terms.facts.constants)
    tests = tests_between(one, other, terms.facts.constants, lambda name: name not in own, terms.tolerance)
    collected = Collected(tests, terms, a.found, exact=False)
    a.found.look_derived(one)
    limit = collected.needed if available is None else available - burned
    while collected.n < limit and not collected.decided:
        stop = min(collected.n + max(burned, int(collected.n * (GROWTH - 1))), limit)
        while collected.n < stop:
            size = min(MOST_AT_ONCE, stop - collected.n)
            table = view(a.take(size))
            a.found.look_derived(table)
            collected.count(table, view(b.take(size)))
        collected.look()
    return collected.verdict(burned, skipped)


def _with_law(a: Source, law: Enumeration | Laws, budget: int | None, terms: Terms) -> Verdict:
    if isinstance(law, Enumeration):
        terms = terms._replace(facts=with_law(terms.facts, law, terms.names))
    stream = SceneStream(a, terms.seeds[0], terms)
    if stream.length == 0:
        raise UsageError("there are no scenes to compare")
    block = stream.take(FIRST_BLOCK[0])
    view: Callable[[FeatureTable], FeatureTable] = add_relations
    skipped: list[str] = []
    if isinstance(law, Enumeration):
        outcomes = Outcomes(law, block, terms.facts, terms.names, terms.tolerance)
        view, tests = outcomes.complete, outcomes.tests(block)
        hidden = ("attempts", TOGETHER)
        skipped = [name for name in one_sided(block, outcomes.table, terms.facts.constants) if name not in hidden and not is_relation(name)]
    else:
        tests = tests_of_laws(add_relations(block), law)
    collected = Collected(tests, terms, stream.found, exact=True)
    limit = min((n for n in (stream.length, budget) if n is not None), default=collected.needed)
    block = block.rows(0, limit)
    while True:
        for start in range(0, block.n, MOST_AT_ONCE):
            table = view(block.rows(start, start + MOST_AT_ONCE))
            stream.found.look_at_law(table, tests)
            collected.count(table, None)
        collected.look()
        if collected.decided or collected.n >= limit:
            return collected.verdict(0, skipped)
        block = stream.take(min(max(FIRST_BLOCK[0], int(collected.n * (GROWTH - 1))), limit - collected.n))


def with_law(facts: Facts, law: Enumeration, names: SampleNames) -> Facts:
    """Add the features that are equal in all outcomes of a program's exact law to the known facts."""
    always = constants_of(names.kept(features_table(law.scenes)))
    return replace(facts, constants={**always, **facts.constants})


class Collected:
    """The counts so far, and the largest evidence that they ever gave."""

    def __init__(self, tests: list[FeatureTest], terms: Terms, found: Findings, *, exact: bool) -> None:
        self.tests = tests
        self.terms = terms
        self.exact = exact
        self.cuts: list[Cut] = [test.cuts[0] for test in tests if len(test.cuts) == 1]
        self.evidence = 0.0
        self.found = found
        self.n = 0

    @cached_property
    def hardest(self) -> Hardest:
        """The differences that are hardest to see, by the law or by the first blocks."""
        return Hardest([test.expected for test in self.tests if test.stated], exact=self.exact)

    @cached_property
    def needed(self) -> int:
        """How many scenes of each side a difference of the stated size needs."""
        return required_draws(self.terms.detect_tv, self.terms.alpha, len(self.tests), self.hardest)

    @property
    def decided(self) -> bool:
        """Whether a difference was found."""
        return bool(self.found.lines) or self.evidence >= -math.log10(self.terms.alpha)

    def count(self, a: FeatureTable, b: FeatureTable | None) -> None:
        """Count some scenes of both sides (or of one, against a law)."""
        one, other = assign_cells(self.cuts, a), None if b is None else assign_cells(self.cuts, b)
        self.n += a.n
        for test in self.tests:
            test.count(one, other)
        learn(self.cuts, a)

    def look(self) -> None:
        if self.tests:
            wealth = average_e_values(np.array([test.look() for test in self.tests]))
            self.evidence = max(self.evidence, wealth / math.log(10.0))

    def verdict(self, burned: int, skipped: Sequence[str]) -> Verdict:
        """Return the verdict on the scenes so far."""
        features = sorted((test.feature() for test in self.tests), key=lambda f: -f.evidence)
        kind: Kind = "different" if self.decided else "equivalent" if self.n >= self.needed else "inconclusive"
        return Verdict(
            kind=kind, evidence=math.inf if self.found.lines else self.evidence, alpha=self.terms.alpha, detect_tv=self.terms.detect_tv,
            detectable=detectable(self.n, self.terms.alpha, len(self.tests), self.hardest), n=self.n, needed=self.needed,
            burned=burned, features=tuple(features), stated=sum(test.stated for test in self.tests),
            impossible=tuple(self.found.lines[:MOST_LISTED]), skipped=tuple(skipped),
            constants=len(self.terms.facts.constants), exact=self.exact, seeds=self.terms.seeds, replay=self.terms.replay,
        )


Kernel = Callable[[AnyScene, int], AnyScene]
"""One or more steps of a Markov kernel from a scene; the number is a seed, different for every call."""


class Moved:
    """Exact draws after some steps of a kernel."""

    def __init__(self, exact: Sampler, kernel: Kernel, steps: int) -> None:
        self.exact = exact
        self.kernel = kernel
        self.steps = steps

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[AnyScene]:
        """Scenes `start` to `start + n - 1` of `seed`, each moved on its own."""
        for index, scene in enumerate(self.exact.sample_many(n, seed, start=start), start):
            for step in range(self.steps):
                scene = self.kernel(scene, index * self.steps + step)
            yield scene


def compare_invariance(
    exact: Sampler, kernel: Kernel, steps: int, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, budget: int | None = None,
    seeds: tuple[int, int] = (0, 1),
) -> Verdict:
    """Whether a kernel leaves the distribution of `exact` as it is: exact draws, `steps` steps on each, against fresh exact draws.

    The draws are independent, so that neither burn-in nor an effective sample size matters. It does not show that a chain mixes.
    """
    return compare(Moved(exact, kernel, steps), exact, alpha=alpha, detect_tv=detect_tv, budget=budget, seeds=seeds)

