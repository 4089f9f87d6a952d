"""The workspace: the region that objects must lie in (paper, Section "Scenic Programs": the default requirements)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from shapely.geometry import Polygon

from ..fields import VectorField
from ..vectors import Vector
from .approximation import Approximation, Bounds
from .errors import BadRegion
from .parameter_intervals import Intervals
from .point_sampling import Numbers, Segment
from .polygons import PolygonalRegion
from .region import Region, everywhere


class Workspace(Region):
    """A region in the role of the workspace; as a set of points it is that region. It may be given by the points of a polygon.

    Example: `workspace = Workspace(RectangularRegion((0, 0), 0, 20, 20))`
    """

    def __init__(self, region: Region | Sequence[Vector | Sequence[float]] = everywhere) -> None:
        found = PolygonalRegion(region) if isinstance(region, (list, tuple)) else region
        if not isinstance(found, Region):
            raise BadRegion(f"a workspace must be a region, or points, not {region!r}")
        self.region = found

    def __repr__(self) -> str:
        return f"Workspace({self.region!r})"

    @property
    def dimension(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.region.dimension

    @property
    def orientation(self) -> VectorField | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.region.orientation

    def contains_point(self, v: Vector) -> bool:
        return self.region.contains_point(v)

    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return self.region.contains_box(position, heading, width, length)

    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return self.region.meets_box(position, heading, width, length)

    def distance_to(self, v: Vector) -> float:
        return self.region.distance_to(v)

    def bounds(self) -> Bounds | None:
        return self.region.bounds()

    def extent(self) -> Bounds:
        return self.region.extent()

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return self.region.approximate(sides, window)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return self.region.intervals(start, end)

    def segments(self, within: Bounds | None = None) -> Iterable[Segment]:
        return self.region.segments(within)

    def points(self) -> Iterable[Vector]:
        return self.region.points()

    def measure(self) -> float | None:
        return self.region.measure()

    def sample(self, uniform: Numbers) -> Vector:
        return self.region.sample(uniform)
