"""uniformPointIn(R), the distribution of points of a region."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from ..regions import Region, UnboundedRegion
from ..regions.sampling import Numbers
from ..vectors import Vector
from .distribution import Named, Support


@dataclass(frozen=True)
class PointIn(Named):
    """uniformPointIn(R): uniform by area, length or number of points, as the region's dimension says."""

    region: Region

    @property
    def name(self) -> str:
        return "uniformPointIn"

    def sample(self, uniform: Numbers) -> Vector:
        """A point of the region; raises `EmptyRegion` or `UnboundedRegion` if there is none."""
        return self.region.sample(uniform)

    def log_density(self, value: object) -> float:
        measure = self.region.measure()
        if measure is None:
            raise UnboundedRegion(self.region)
        return -math.log(measure) if measure and isinstance(value, Vector) and self.region.contains_point(value) else -math.inf

    def support(self) -> Support | None:
        if self.region.dimension:
            return None
        points = tuple(self.region.points())
        return tuple((point, Fraction(1, len(points))) for point in points) or None
