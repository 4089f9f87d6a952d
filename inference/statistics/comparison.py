"""`compare`: whether two sources of scenes have the same distribution, with a stated risk of a false alarm and a stated power.

The features come from the scenes themselves: every property, every parameter, relations between objects, the number of attempts, and the cells of
pairs of features. Each feature has a betting e-process (`betting`); the average of all is one more, and one may look
at it at any time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from ...interpreter.scenes import Scene
from ...semantics.errors import UsageError
from ..enumeration import Enumeration
from .betting import combined
from .columns import Table, table_of
from .features import Cut, FeatureTest, assigned, tests_against, tests_between, tests_of_laws
from .impossible import MOST_LISTED, constants_of_law, off_the_law, wrong_constants
from .laws import DEFAULT_ALPHA, Categorical, Continuous
from .power import Hardest, detectable, needed
from .verdict import BURNED_SHARE, FIRST_BLOCK, Kind, Verdict

DEFAULT_TV = 0.01
GROWTH = 1.5


AnyScene = Scene | Mapping[str, object]
"""A scene, or the JSON object of one."""


class Sampler(Protocol):
    """Something that draws scenes, such as a scenario: scene `index` of `seed` is always the same."""

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterable[AnyScene]:
        """Scenes `start` to `start + n - 1` of `seed`."""
        ...


@runtime_checkable
class WithConstants(Protocol):
    """Something that knows which features no draw changes, such as a scenario."""

    @property
    def constants(self) -> Mapping[str, object]:
        """The values of these features."""
        ...


Laws = Mapping[str, Continuous | Categorical]
"""Exact laws of features in closed form, by the features' names."""

Scenes = Sequence[Scene] | Sequence[Mapping[str, object]]
Source = Scenes | Table | Sampler


def compare(
    a: Source, b: Source | Enumeration | Laws, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, budget: int | None = None,
    seeds: tuple[int, int] = (0, 1), constants: Mapping[str, object] | None = None, replay: str = "",
) -> Verdict:
    """Whether the draws `a` have the distribution of the draws `b`, or an exact one: an enumeration, or laws of features in closed form.

    `a` and `b` are scenes (as such, as JSON objects in the scene format, or as a table), or draw them with `seeds`. P("different") <= `alpha`
    if there is no difference. `budget` is the largest number of scenes of each side; without one all that are there are
    used, or as many as a difference of `detect_tv` needs. `constants` are values that features must have, whatever is drawn; a
    scenario given as `b` knows its own.
    Raises `UsageError` for settings or scenes that cannot be compared.
    """
    check_settings(alpha, detect_tv, budget)
    if constants is None and isinstance(b, WithConstants):
        constants = b.constants
    again = replay or f"compare(a, b, alpha={alpha:g}, detect_tv={detect_tv:g}, budget={budget}, seeds={seeds})"
    terms = Terms(alpha, detect_tv, constants or {}, seeds, again)
    if isinstance(b, (Enumeration, Mapping)):
        return _with_law(Stream(a, seeds[0]), b, budget, terms)
    return _two_samples(Stream(a, seeds[0]), Stream(b, seeds[1]), budget, terms)


def check_settings(alpha: float, detect_tv: float, budget: int | None) -> None:
    """Raise `UsageError` for levels that are none."""
    if not 0 < alpha < 1:
        raise UsageError(f"alpha is a probability between 0 and 1, not {alpha:g}")
    if not 0 < detect_tv < 1:
        raise UsageError(f"the total variation to detect is between 0 and 1, not {detect_tv:g}")
    if budget is not None and budget < 1:
        raise UsageError(f"the budget is a number of scenes, not {budget}")


class Stream:
    """The scenes of a source, block by block; `length` is None if there is no end to them, and `whole` is then empty.

    Scenes that are given are taken in a random order (a function of the seed), so that it does not matter how they were sorted.
    """

    def __init__(self, source: Source, seed: int) -> None:
        self.seed = seed
        self.at = 0
        self.sampler: Sampler | None = None
        self.whole = self.table = Table({}, 0)
        self.length: int | None = None
        if isinstance(source, (Table, Sequence)):
            self.whole = source if isinstance(source, Table) else table_of(source)
            self.length = self.whole.n
            order = np.random.Generator(np.random.Philox(seed % (1 << 64))).permutation(self.length)
            self.table = Table({name: column.values[order] for name, column in self.whole.columns.items()}, self.length)
        else:
            self.sampler = source

    def take(self, n: int) -> Table:
        """The next `n` scenes, or as many as are left."""
        start, self.at = self.at, self.at + n
        if self.sampler is not None:
            return table_of(self.sampler.sample_many(n, self.seed, start=start))
        return self.table.rows(start, start + n)


class Terms(NamedTuple):
    """What a comparison is asked for."""

    alpha: float
    detect_tv: float
    constants: Mapping[str, object]
    seeds: tuple[int, int]
    replay: str


def _two_samples(a: Stream, b: Stream, budget: int | None, terms: Terms) -> Verdict:
    known = [n for n in (a.length, b.length, budget) if n is not None]
    available = min(known, default=None)
    if available == 0:
        raise UsageError("there are no scenes to compare")
    burned = FIRST_BLOCK[1] if available is None else min(max(available // BURNED_SHARE, min(FIRST_BLOCK[0], (available + 1) // 2)), FIRST_BLOCK[1])
    impossible = wrong_constants(a.whole, terms.constants)
    first = a.take(burned), b.take(burned)
    tests, skipped = tests_between(*first, terms.constants)
    collected = Collected(tests, terms, impossible or wrong_constants(first[0], terms.constants), exact=False)
    limit = collected.needed if available is None else available - burned
    while collected.n < limit and not collected.decided:
        size = min(max(burned, int(collected.n * (GROWTH - 1))), limit - collected.n)
        one = a.take(size)
        collected.impossible += wrong_constants(one, terms.constants, a.at - size) if a.length is None else []
        collected.add(one, b.take(size))
    return collected.verdict(burned, skipped)


def _with_law(a: Stream, law: Enumeration | Laws, budget: int | None, terms: Terms) -> Verdict:
    first = a.take(FIRST_BLOCK[0])
    looked_at = first if a.length is None else a.whole
    if isinstance(law, Enumeration):
        terms = terms._replace(constants={**constants_of_law(law), **terms.constants})
        tests, skipped = tests_against(looked_at, law, terms.constants)
    else:
        tests, skipped = tests_of_laws(looked_at, law), []
    impossible = wrong_constants(looked_at, terms.constants) or off_the_law(looked_at, tests)
    collected = Collected(tests, terms, impossible, exact=True)
    limit = min((n for n in (a.length, budget) if n is not None), default=collected.needed)
    if limit < 1:
        raise UsageError("there are no scenes to compare")
    block = first
    while not collected.decided:
        block = block.rows(0, limit - collected.n)
        if a.length is None:
            collected.impossible += wrong_constants(block, terms.constants, collected.n) or off_the_law(block, tests, collected.n)
        collected.add(block, None)
        if collected.n >= limit:
            break
        block = a.take(max(FIRST_BLOCK[0], int(collected.n * (GROWTH - 1))))
    return collected.verdict(0, skipped)


class Collected:
    """The counts so far, and the largest evidence that they ever gave."""

    def __init__(self, tests: list[FeatureTest], terms: Terms, impossible: list[str], *, exact: bool) -> None:
        self.tests = tests
        self.terms = terms
        self.exact = exact
        self.cuts: list[Cut] = [test.cuts[0] for test in tests if len(test.cuts) == 1]
        self.evidence = 0.0
        self.impossible = impossible
        self.n = 0

    @cached_property
    def hardest(self) -> Hardest:
        """The differences that are hardest to see, by the law or by the first blocks."""
        return Hardest([test.expected for test in self.tests], exact=self.exact)

    @cached_property
    def needed(self) -> int:
        """How many scenes of each side a difference of the stated size needs."""
        return needed(self.terms.detect_tv, self.terms.alpha, len(self.tests), self.hardest)

    @property
    def decided(self) -> bool:
        """Whether a difference was found."""
        return bool(self.impossible) or self.evidence >= -math.log10(self.terms.alpha)

    def add(self, a: Table, b: Table | None) -> None:
        """Count another block of both sides (or of one, against a law), and look at the evidence."""
        one, other = assigned(self.cuts, a), None if b is None else assigned(self.cuts, b)
        self.n += a.n
        if self.tests:
            wealth = combined(np.array([test.add(one, other) for test in self.tests]))
            self.evidence = max(self.evidence, wealth / math.log(10.0))

    def verdict(self, burned: int, skipped: Sequence[str]) -> Verdict:
        """What was found."""
        features = sorted((test.feature() for test in self.tests), key=lambda f: -f.evidence)
        kind: Kind = "different" if self.decided else "equivalent" if self.n >= self.needed else "inconclusive"
        return Verdict(
            kind=kind, evidence=math.inf if self.impossible else self.evidence, alpha=self.terms.alpha, detect_tv=self.terms.detect_tv,
            detectable=detectable(self.n, self.terms.alpha, len(self.tests), self.hardest), n=self.n, needed=self.needed,
            burned=burned, features=tuple(features), impossible=tuple(self.impossible[:MOST_LISTED]), skipped=tuple(skipped),
            constants=len(self.terms.constants), exact=self.exact, seeds=self.terms.seeds, replay=self.terms.replay,
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

    The draws are independent, so that neither burn-in nor an effective sample size has a say. It does not show that a chain mixes.
    """
    return compare(Moved(exact, kernel, steps), exact, alpha=alpha, detect_tv=detect_tv, budget=budget, seeds=seeds)
