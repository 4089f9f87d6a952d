"""Do sampled frequencies agree with the enumerated law? One null hypothesis over many finite programs.

Each program is enumerated and sampled. Its scenes are set against its law, and its attempts against its acceptance; besides,
the place of every scene within its law (its randomised distribution function in the order of the outcomes, uniform if all
is right) joins those of all programs in one sample, which finds small faults that all programs share. The level is divided by the number of
these tests.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import accumulate
from multiprocessing import get_context
from typing import Literal

from scenic_ref.api import Scenario
from scenic_ref.conformance.generator.programs import DEFAULT, random_program
from scenic_ref.conformance.generator.settings import ProgramSettings
from scenic_ref.data.scene import Scene, scene_of
from scenic_ref.inference.comparison.exact_laws import DEFAULT_ALPHA, Categorical, Continuous, evidence
from scenic_ref.inference.enumeration import Enumeration, content_of_scene
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import Accepted, Chooser, generate_scene
from scenic_ref.interpreter.runtime.random_streams import Stream, fold, mix
from scenic_ref.semantics.machine.outcome import Draw
from scenic_ref.semantics.space.distributions import Uniform
from scenic_ref.semantics.store.errors import AttemptsExhausted

Rival = Literal["", "first value twice as likely", "coins once per scene"]
"""Wrong samplers that the test must reject; "" is the real one."""

ATTEMPTS = 50
"""Attempts per program, by and large."""
PATIENCE = 20 * ATTEMPTS
"""Attempts at one scene, after which it is given up; they count as attempts that failed."""


@dataclass(frozen=True)
class Examined:
    """What one program showed: evidence (log10 of e-values) of its scenes and of its attempts, the places of its scenes, and numbers for reports."""

    index: int
    scenes: float
    attempts: float
    places: tuple[float, ...]
    runs: int
    acceptance: Fraction
    outcomes: int


@dataclass(frozen=True)
class Agreement:
    """The programs that were examined, and the pooled evidence of the places of all their scenes."""

    examined: tuple[Examined, ...]
    pooled: float
    level: float

    @property
    def threshold(self) -> float:
        """The evidence that contradicts: every program is tested twice, and all together once."""
        return -math.log10(self.level / (2 * len(self.examined) + 1))

    @property
    def contradictions(self) -> tuple[str, ...]:
        """What contradicts the enumeration, if anything; program numbers are those of the generator."""
        found = [f"program {x.index}: scenes ({x.scenes:.1f})" for x in self.examined if x.scenes >= self.threshold]
        found += [f"program {x.index}: attempts ({x.attempts:.1f})" for x in self.examined if x.attempts >= self.threshold]
        return (*found, *([f"all programs together ({self.pooled:.1f})"] if self.pooled >= self.threshold else []))


def examine(index: int, *, seed: int, settings: ProgramSettings, rival: Rival = "") -> Examined:
    """Enumerate and sample program `index` of `seed`. Raises `AssertionError` if only one of the two finds it infeasible."""
    program = parse(random_program(seed, index, settings.as_finite()).text)
    scenario = Scenario(program)
    sampled = Scenario(program, readings={"soft": "scene"}) if rival == "coins once per scene" else scenario
    own = mix(fold(seed)) ^ index  # programs that shared a seed would share their random numbers, and their scenes could not be pooled
    try:
        exact = scenario.enumerate(max_runs=settings.max_outcomes)
    except AttemptsExhausted:
        if not never_accepted(scenario, own):
            raise AssertionError(f"program {index} is infeasible, and has a scene") from None
        return Examined(index, 0.0, 0.0, (), 0, Fraction(0), 0)
    count = max(1, int(ATTEMPTS * exact.acceptance))
    scenes = list(sample(sampled, own, count, rival))
    found = [scene for scene, _ in scenes if scene is not None]
    flags = [flag for scene, attempts in scenes for flag in (*[False] * (attempts - 1), scene is not None)]
    contents = [content_of_scene(scene) for scene in found]
    acceptance = Categorical({True: exact.acceptance, False: 1 - exact.acceptance})
    by_scenes = evidence(contents, Categorical(exact.law(content_of_scene)))
    by_attempts = evidence(flags, acceptance)
    return Examined(index, by_scenes, by_attempts, places(exact, contents, own), exact.runs, exact.acceptance, len(exact.outcomes))


def never_accepted(scenario: Scenario, seed: int) -> bool:
    """Whether no scene is found in the usual number of attempts."""
    try:
        scenario.sample(seed, max_attempts=ATTEMPTS)
    except AttemptsExhausted:
        return True
    return False


def sample(scenario: Scenario, seed: int, count: int, rival: Rival) -> Iterable[tuple[Scene | None, int]]:
    """Scenes with the number of attempts that each took; the last is None where `PATIENCE` was not enough."""
    for index in range(count):
        if rival == "first value twice as likely":
            yield wrongly_sampled(scenario, seed, index)
            continue
        try:
            scene = scenario.sample(seed, index, max_attempts=PATIENCE)
            yield scene, scene.attempts
        except AttemptsExhausted as exhausted:
            yield None, exhausted.attempts
            return


def wrongly_sampled(scenario: Scenario, seed: int, index: int) -> tuple[Scene | None, int]:
    """Rejection sampling in which the first value of each `Uniform` is twice as likely."""
    for attempt in range(PATIENCE):
        result = generate_scene(scenario.start(), favouring_the_first(seed, index, attempt))
        if isinstance(result, Accepted):
            return scene_of(result.state, seed, index, attempt + 1), attempt + 1
    return None, PATIENCE


def favouring_the_first(seed: int, index: int, attempt: int) -> Chooser:
    """The wrong sampler's answers."""
    stream, right = Stream(seed, index, attempt), from_stream(seed, index, attempt)

    def choose(draw: Draw) -> object:
        if not isinstance(draw.distribution, Uniform):
            return right(draw)
        values = draw.distribution.values
        place = int(stream.at(draw.address)() * (len(values) + 1))
        return values[max(0, place - 1)]

    return choose


def places(exact: Enumeration, contents: Sequence[str], seed: int) -> tuple[float, ...]:
    """Where each scene lies within the law, from 0 to 1; within its own outcome, anywhere."""
    masses = [outcome.probability for outcome in exact.outcomes]
    starts = dict(zip(map(content_of_scene, exact.scenes), zip(accumulate(masses, initial=Fraction(0)), masses), strict=True))
    uniform = Stream(seed, 0, 0).at(())
    never = (Fraction(0), Fraction(0))
    return tuple(float(start) + float(mass) * uniform() for start, mass in (starts.get(content, never) for content in contents))


def agreement(
    count: int, *, seed: int, settings: ProgramSettings = DEFAULT, rival: Rival = "", processes: int = 1, level: float = DEFAULT_ALPHA
) -> Agreement:
    """Examine programs 0 to `count` - 1 of `seed`, in `processes` processes."""
    work = partial(examine, seed=seed, settings=settings, rival=rival)
    if processes == 1:
        examined = tuple(map(work, range(count)))
    else:
        with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
            examined = tuple(pool.map(work, range(count), chunksize=8))
    pool_of_places = [place for x in examined for place in x.places]
    return Agreement(examined, evidence(pool_of_places, Continuous("places", lambda place: place)), level)
