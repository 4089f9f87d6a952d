"""Who answers the machine's draws: a random stream, or a recorded trace."""

from __future__ import annotations

from collections.abc import Mapping

from ..semantics.outcome import Draw
from .running import Chooser
from .streams import Stream

PER_SCENE = (1 << 64) - 1
"""The attempt number under which draws made once per scene are numbered (reading `soft=scene`)."""


def from_stream(seed: int, scene: int, attempt: int) -> Chooser:
    """Answers with the numbers of (seed, scene, attempt, address): the scene does not depend on anything else."""
    stream, once = Stream(seed, scene, attempt), Stream(seed, scene, PER_SCENE)

    def choose(draw: Draw) -> object:
        source = once if draw.per_scene else stream
        return draw.distribution.sample(source.at(draw.address))

    return choose


def from_trace(values: Mapping[tuple[int, ...], object], otherwise: Chooser) -> Chooser:
    """Answers with recorded values by address, and asks `otherwise` for addresses that were not recorded."""

    def choose(draw: Draw) -> object:
        return values[draw.address] if draw.address in values else otherwise(draw)

    return choose
