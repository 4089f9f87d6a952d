"""Rejection sampling: the paper's own method, with the machine as it is (Section "Domain-Specific Sampling Techniques").

Runs that get stuck are discarded; the first that does not gives the scene. Scene `index` of `seed` depends on the
program, the seed and the index only (DESIGN, section 5).
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

from scipy.special import betaincinv

from ..data.scene import Scene, scene_of
from ..interpreter.runtime.answerers import AS_THEY_ARE, Draws, from_stream
from ..interpreter.runtime.program_run import DEFAULT_FUEL, Accepted, Beginnings, Chooser, Witness, generate_scene
from ..semantics.machine.config import Config
from ..semantics.machine.outcome import Draw, Requirement
from ..semantics.store.errors import AttemptsExhausted
from .result import LEVEL, Probability

DEFAULT_ATTEMPTS = 100_000
SELDOM = 1_000
"""After so many attempts without a scene, another backend may do better."""
PATIENCE = 300
"""So many attempts at a scene are made one by one before the batch backend is asked for the rest."""
FEWEST, SECONDS = 10, 0.05
"""Or so many, if they take more seconds of the processor than these: about what the batch backend takes to begin."""


class Sampled(NamedTuple):
    """A scene, and how often which requirement failed on the way to it."""

    scene: Scene
    stuck: Counter[Requirement]
    steps: int


class OutOfPatience(Exception):
    """So many attempts at a scene failed that the batch backend may do better."""


def patiently(max_attempts: int, on_attempt: Callable[[int], None] | None = None) -> Callable[[int], None]:
    """Is told how many attempts at a scene, which begins now, have failed; tells `on_attempt`, and raises `OutOfPatience` when that is enough.

    It is not where there may be few: who says that there is no scene in so many attempts then does not depend on how long they take.
    """
    begun = time.process_time()

    def told(attempts: int) -> None:
        if on_attempt is not None:
            on_attempt(attempts)
        if max_attempts > PATIENCE and (attempts >= PATIENCE or (attempts >= FEWEST and time.process_time() - begun > SECONDS)):
            raise OutOfPatience

    return told


class InterruptedDraw(KeyboardInterrupt):
    """Ctrl-C while a scene was looked for; `stuck` is what failed in the attempts at it so far."""

    def __init__(self, stuck: Counter[Requirement]) -> None:
        super().__init__()
        self.stuck = stuck


def sample(
    start: Callable[[], Config], seed: int, index: int, *, max_attempts: int = DEFAULT_ATTEMPTS, fuel: int = DEFAULT_FUEL,
    on_attempt: Callable[[int], None] | None = None, witnessed: Callable[[int], Witness] | None = None, draws: Draws = AS_THEY_ARE,
) -> Sampled:
    """Scene number `index` of `seed`. Raises `AttemptsExhausted` with the requirements that failed, and the program's errors.

    `draws` are distributions that points are drawn from instead (see `inference.pruning`); `on_attempt` is told how many attempts got stuck
    so far; `witnessed` gives the witness of each attempt, which makes it slower.
    """
    stuck: Counter[Requirement] = Counter()
    steps = 0
    begin = start if witnessed is not None else Beginnings(start, fuel)
    for attempt in range(max_attempts):
        witness = None if witnessed is None else witnessed(attempt)
        choose, drawn = watch_first_draw(from_stream(seed, index, attempt, draws))
        try:
            result = generate_scene(begin(), choose, fuel=fuel, witness=witness)
        except KeyboardInterrupt:
            raise InterruptedDraw(stuck) from None
        steps += result.steps
        if isinstance(result, Accepted):
            return Sampled(scene_of(result.state, seed, index, attempt + 1, pruned=bool(draws)), stuck, steps)
        stuck[result.requirement] += 1
        if on_attempt is not None:
            on_attempt(attempt + 1)
        if not drawn:
            raise no_scene_error(f"no scene is possible: {result.requirement.failure}, whatever is drawn", attempt + 1, stuck)
    worst, count = stuck.most_common(1)[0]
    text = f"no scene in {max_attempts:,} attempts: {how_often(count, max_attempts)} this failed: {worst.text}"
    raise no_scene_error(text, max_attempts, stuck, seldom=True)


def how_often(count: int, attempts: int) -> str:
    """How often, of so many attempts that all failed, the most frequent reason was it."""
    return f"most often ({count:,} times)" if count < attempts else "each time"


def acceptance(scenes: int, attempts: int, level: float = LEVEL) -> Probability:
    """The probability that a run is accepted, from the attempts that some scenes took together: exact bounds of inverse sampling.

    The attempts of all scenes have the negative binomial distribution, whose bounds are those of Clopper and Pearson but for the last run,
    which is always accepted.
    """
    rest = (1 - level) / 2
    if not scenes:
        return Probability(math.nan, 0.0, 1.0, level)
    low = float(betaincinv(scenes, attempts - scenes + 1, rest))
    high = float(betaincinv(scenes, attempts - scenes, 1 - rest)) if attempts > scenes else 1.0
    return Probability(scenes / attempts, low, high, level)


def watch_first_draw(choose: Chooser) -> tuple[Chooser, list[tuple[int, ...]]]:
    """The chooser, and a list that holds the first draw that it answered, if any."""
    seen: list[tuple[int, ...]] = []

    def answer(draw: Draw) -> object:
        drawn = choose(draw)  # an empty region raises here: nothing was drawn
        if not seen:
            seen.append(draw.address)
        return drawn

    return answer, seen


def no_scene_error(message: str, attempts: int, stuck: Counter[Requirement], *, seldom: bool = False) -> AttemptsExhausted:
    """The error when no scene was found, with hints where some are known; `seldom`: many runs were made at random."""
    worst, _ = stuck.most_common(1)[0]
    error = AttemptsExhausted(message, worst.span, attempts=attempts, stuck=tuple(stuck.most_common()))
    hints: list[str] = []
    if worst.kind == "collision":
        hints.append("boxes that only touch also intersect (reading touching); leave a gap, or give one of them allowCollisions True")
    if worst.kind == "visibility" or "can see" in worst.text:
        hints.append("what an object can see is at most 50 metres away, unless it is given another distance")
    if worst.kind == "field":
        hints.append("an object outside the field needs a place within it, or a heading of its own (`facing ...`)")
    if seldom and attempts >= SELDOM:
        hints.append("if all requirements hold together, but seldom, try --backend smc, or more --max-attempts")
    error.hint = "; ".join(hints)
    return error
