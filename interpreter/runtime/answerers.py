"""Who answers the machine's draws: a random stream, or a recorded trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from ...semantics.machine.outcome import Draw
from ...semantics.space.distributions import Distribution, PointIn
from .program_run import Chooser
from .random_streams import Stream

PER_SCENE = (1 << 64) - 1
"""The attempt number under which draws made once per scene are numbered (reading `soft=scene`)."""


Draws = Mapping[tuple[int, ...], Distribution]
"""Distributions of points that take the place of the program's own, by address: see `inference.pruning`."""

AS_THEY_ARE: Draws = MappingProxyType({})


def replace_distribution(draw: Draw, draws: Draws) -> Draw:
    """The draw, from the distribution that `draws` gives for its address if it is a point's."""
    if isinstance(draw.distribution, PointIn) and draw.address in draws:
        return draw._replace(distribution=draws[draw.address])
    return draw


def from_stream(seed: int, scene: int, attempt: int | Callable[[tuple[int, ...]], int], draws: Draws = AS_THEY_ARE) -> Chooser:
    """Answers with the numbers of (seed, scene, attempt, address): the scene depends on nothing else but `draws`.

    Where rejection is factorised (see `inference.batch.factorised_rejection`), `attempt` says which it is for each address.
    """
    once = Stream(seed, scene, PER_SCENE)
    stream = Stream(seed, scene, attempt) if isinstance(attempt, int) else None

    def choose(draw: Draw) -> object:
        source = once if draw.per_scene else stream or Stream(seed, scene, attempt(draw.address))  # type: ignore[operator]
        return replace_distribution(draw, draws).distribution.sample(source.at(draw.address))

    return choose


def from_trace(values: Mapping[tuple[int, ...], object], otherwise: Chooser) -> Chooser:
    """Answers with recorded values by address, and asks `otherwise` for addresses that were not recorded."""

    def choose(draw: Draw) -> object:
        return values[draw.address] if draw.address in values else otherwise(draw)

    return choose
