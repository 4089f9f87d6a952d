"""The results of an analysis: the effect of pruning, and the reasons why it did no more."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple

from ...semantics.space.distributions import PointIn
from ...semantics.space.regions import PolygonalRegion, Region
from .traced_points import Address

Technique = Literal["containment", "orientation", "size", "reachability", "offset"]
TECHNIQUES: tuple[Technique, ...] = ("containment", "orientation", "size", "reachability", "offset")
PAPER: tuple[Technique, ...] = ("containment", "orientation", "size", "reachability")
"""The paper's own; `offset` is an addition (`algorithms.prune_by_offset`)."""


class Finding(NamedTuple):
    """The effect of one technique on the objects at one point: the areas in square metres, or (`after` is
    None) the assumption that fails.
    """

    objects: str
    technique: Technique
    before: float | None
    after: float | None
    reason: str

    def __str__(self) -> str:
        if self.after is None or not self.before:
            return f"{self.objects}: {self.technique} off: {self.reason}"
        return f"{self.objects}: {self.technique}: {self.before:,.0f} -> {self.after:,.0f} m2 ({self.after / self.before:.1%}), {self.reason}"


class Pruned(NamedTuple):
    """A draw site of a point: it may be drawn uniformly from `region`, which is part of `original` and holds its value in every scene."""

    address: Address
    original: Region
    region: PolygonalRegion
    area_before: float
    area_after: float
    techniques: tuple[Technique, ...]


class Pruning(NamedTuple):
    """The draw sites with smaller regions, and the report."""

    pruned: tuple[Pruned, ...]
    findings: tuple[Finding, ...]

    @property
    def share(self) -> float:
        """The probability that all points are drawn from the smaller regions."""
        return math.prod(p.area_after / p.area_before for p in self.pruned)

    @property
    def draws(self) -> Mapping[Address, PointIn]:
        """The distributions to draw from instead, by address: for the tracer and for `from_stream`."""
        return {p.address: PointIn(p.region) for p in self.pruned}

    def __str__(self) -> str:
        return "\n".join(map(str, self.findings)) or "no object's position is random"

