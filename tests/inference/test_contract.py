"""What every backend must do: scenes of the program's law, an interval that holds the probability of acceptance, the machine's verdict on each.

The law is that of the enumeration, for random finite programs in which some runs are rejected; on the gallery it is that of rejection.
`SCENIC_REF_PROGRAMS=200` examines 200 programs; the suite 10.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.api import Scenario, loads
from scenic_ref.conformance.generator import ProgramSettings
from scenic_ref.conformance.generator.programs import random_program
from scenic_ref.data.scene import Scene
from scenic_ref.inference.batch import Batch
from scenic_ref.inference.comparison import compare
from scenic_ref.inference.comparison.exact_laws import Categorical, contradicts
from scenic_ref.inference.enumeration import Enumeration, content_of_scene
from scenic_ref.inference.moves.proposals import NAMES, Moves
from scenic_ref.inference.moves.states import States
from scenic_ref.inference.moves.target import Target
from scenic_ref.inference.rejection import acceptance
from scenic_ref.inference.result import LEVEL, Probability
from scenic_ref.semantics.store.errors import ScenicError, UsageError
from scipy import stats

GALLERY = [p for p in sorted((Path(__file__).parents[2] / "examples" / "gallery").glob("*.scenic")) if p.stem != "mars_bottleneck"]
"""Without the one in which too few runs are accepted for exact states by rejection."""
COUNT = int(os.environ.get("SCENIC_REF_PROGRAMS", "10"))
PARTS = 10
REQUIRING = replace(ProgramSettings().as_finite(), requirements=1.0, soft=1.0, workspace=0.5, visibility=0.8)
SCENES = 400
Drawn = tuple[list[Scene], Probability]


def rejected(backend: str) -> Callable[[Scenario, int], Drawn]:
    def draw(scenario: Scenario, seed: int) -> Drawn:
        scenes = list(scenario.sample_many(SCENES, seed, backend=backend))  # type: ignore[arg-type]
        return scenes, acceptance(SCENES, sum(scene.attempts for scene in scenes))

    return draw


def inferred(backend: str) -> Callable[[Scenario, int], Drawn]:
    def draw(scenario: Scenario, seed: int) -> Drawn:
        found = scenario.infer(backend, SCENES, seed, resample=backend == "importance")
        return found.scenes, found.acceptance

    return draw


BACKENDS = {b: rejected(b) for b in ("interpreter", "batch")} | {b: inferred(b) for b in ("importance", "smc", "mcmc")}


def finite_programs(part: int) -> Iterator[tuple[Scenario, Enumeration]]:
    """So many finite programs that no backend refuses, in which some runs are accepted and others are not."""
    found, index = 0, part * 100_000
    while found < COUNT // PARTS:
        scenario = loads(random_program(11, index, REQUIRING).text)
        index += 1
        try:
            exact = scenario.enumerate(max_runs=400)
        except ScenicError:
            continue
        if 0 < exact.acceptance < 1 and scenario.batch is not None and not refused(scenario.batch):
            found += 1
            yield scenario, exact


def refused(batch: Batch) -> bool:
    """Whether the graph leaves too many runs to the interpreter, or coins are thrown for a scene."""
    try:
        Target(batch, 3).measure(np.random.default_rng(3))
    except UsageError:
        return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_all_backends_have_the_enumerated_law(part: int) -> None:
    """Level: 1e-9 for the laws of all programs and backends together; so many intervals of 99.9 % may miss as do in 99 of 100 parts."""
    missed, intervals = list[str](), 0
    for scenario, exact in finite_programs(part):
        law = Categorical(exact.law(content_of_scene))
        for name, draw in BACKENDS.items():
            scenes, found = draw(scenario, 3)
            assert not contradicts([content_of_scene(scene) for scene in scenes], law, 1e-9 / COUNT / len(BACKENDS)), name
            intervals += 1
            if not found.low <= exact.acceptance <= found.high:
                missed.append(name)
    assert len(missed) <= stats.binom.ppf(0.99, intervals, 1 - LEVEL), missed


def test_the_bounds_of_inverse_sampling_hold_the_probability() -> None:
    """Exactly, by the negative binomial law; the bounds for a fixed number of runs would be too low where few scenes are drawn."""
    for scenes, p in ((1, 0.3), (5, 0.02), (40, 0.9)):
        attempts = np.arange(scenes, int(stats.nbinom.ppf(1 - 1e-9, scenes, p)) + scenes + 1)
        shares = stats.nbinom.pmf(attempts - scenes, scenes, p)
        bounds = [acceptance(scenes, int(a)) for a in attempts]
        assert shares[[b.low > p for b in bounds]].sum() <= (1 - LEVEL) / 2
        assert shares[[b.high < p for b in bounds]].sum() <= (1 - LEVEL) / 2
    assert acceptance(0, 0)[1:3] == (0.0, 1.0)


class Rejection:
    """Scenes by rejection, whose attempts do not count."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[Scene]:
        yield from (replace(scene, attempts=1) for scene in self.scenario.sample_many(n, seed, start=start))


class MovedStates:
    """Accepted states, drawn by rejection, after moves of one kind."""

    def __init__(self, scenario: Scenario, kind: int, steps: int) -> None:
        assert scenario.batch is not None
        self.target = Target(scenario.batch, 5)
        self.moves = Moves(self.target.blocks(), tuple(float(kind == k) for k in range(len(NAMES))))  # type: ignore[arg-type]
        self.steps = steps

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[Scene]:
        random = np.random.Generator(np.random.Philox(np.random.SeedSequence([seed, start])))
        parts: list[States] = []
        while sum(map(len, parts)) < n:
            states = self.target.simulate(4_000, random)
            parts.append(states.at(self.target.assess(states).violation == 0))
        states, zeros = States.joined(parts).at(np.arange(n)), np.zeros(n)
        for _ in range(self.steps):
            states, _, _ = self.target.update(states, zeros, self.moves.propose(states, random)[0], zeros)
        yield from self.target.scenes(states, seed, start)


@pytest.mark.parametrize("kind", range(len(NAMES)), ids=NAMES)
@pytest.mark.parametrize("path", [GALLERY[0], *(pytest.param(p, marks=pytest.mark.slow) for p in GALLERY[1:])], ids=lambda p: p.stem)
def test_each_kind_of_move_leaves_the_laws_of_the_gallery_as_they_are(path: Path, kind: int) -> None:
    scenario = scenic_ref.load(path)
    verdict = compare(MovedStates(scenario, kind, 8), Rejection(scenario), budget=500)
    assert verdict.kind != "different", verdict


class Thinned:
    """Some of the scenes of a backend that are worth more independent ones than there are."""

    def __init__(self, scenario: Scenario, backend: str, count: int) -> None:
        found = scenario.infer(backend, 6 * count, 1)
        assert not found.doubts and found.diagnosis.bulk >= 4 * count
        self.scenes = found.scenes[:count]

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[Scene]:
        yield from (replace(scene, attempts=1) for scene in self.scenes[start : start + n])


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(GALLERY)), ids=[p.stem for p in GALLERY])
def test_scenes_of_the_gallery_have_the_law_of_rejection(number: int) -> None:
    """By splitting and by chains in turn."""
    scenario = scenic_ref.load(GALLERY[number])
    verdict = compare(Thinned(scenario, ("smc", "mcmc")[number % 2], 200), Rejection(scenario), budget=200)
    assert verdict.kind != "different", verdict
