"""Pruned draws for the interpreter: the same numbers of the same streams, mapped to points of the smaller regions.

A run that is accepted has its points in the smaller regions, and there their densities are those of the larger ones up to a constant factor.
So the accepted runs have the same distribution as without pruning, though a seed gives other scenes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping

from ...interpreter.choosers import PER_SCENE
from ...interpreter.running import DEFAULT_FUEL, Accepted, Chooser, run
from ...interpreter.scenes import scene_of
from ...interpreter.streams import Stream
from ...semantics.config import Config
from ...semantics.distributions import Distribution, PointIn
from ...semantics.outcome import Draw, Requirement
from ..rejection import DEFAULT_ATTEMPTS, Sampled, counting, exhausted
from .recording import Address


def from_pruned_stream(seed: int, scene: int, attempt: int, draws: Mapping[Address, Distribution]) -> Chooser:
    """Answers as `from_stream`, but draws the points at the addresses in `draws` from the distributions given there."""
    stream, once = Stream(seed, scene, attempt), Stream(seed, scene, PER_SCENE)

    def choose(draw: Draw) -> object:
        source = once if draw.per_scene else stream
        return replaced(draw, draws).sample(source.at(draw.address))

    return choose


def replaced(draw: Draw, draws: Mapping[Address, Distribution]) -> Distribution:
    """The distribution to draw from: that of the mapping for a point whose address is there, else the draw's own."""
    return draws.get(draw.address, draw.distribution) if isinstance(draw.distribution, PointIn) else draw.distribution


def sample_pruned(
    start: Callable[[], Config], seed: int, index: int, draws: Mapping[Address, Distribution], *, max_attempts: int = DEFAULT_ATTEMPTS,
    fuel: int = DEFAULT_FUEL,
) -> Sampled:  # fmt: skip
    """`rejection.sample` with pruned draws: a scene from the same distribution, in fewer attempts. Raises what `sample` raises."""
    stuck: Counter[Requirement] = Counter()
    steps = 0
    for attempt in range(max_attempts):
        choose, drawn = counting(from_pruned_stream(seed, index, attempt, draws))
        result = run(start(), choose, fuel=fuel)
        steps += result.steps
        if isinstance(result, Accepted):
            return Sampled(scene_of(result.state, seed, index, attempt + 1), stuck, steps)
        stuck[result.requirement] += 1
        if not drawn:
            raise exhausted(f"no scene is possible, since nothing is drawn before this fails: {result.requirement.text}", attempt + 1, stuck)
    worst, count = stuck.most_common(1)[0]
    raise exhausted(f"no scene in {max_attempts:,} attempts: most often ({count:,} times) this failed: {worst.text}", max_attempts, stuck)
