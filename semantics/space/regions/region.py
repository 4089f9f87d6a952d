"""Regions: sets of points of the plane (paper, Section "Data Types")."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable

from shapely.geometry import Polygon

from ..fields import VectorField
from ..numeric_functions import is_one, lift_method
from ..vectors import Vector
from . import parameter_intervals
from .approximation import NO_BOUNDS, Approximation, Bounds, box_shape, contains, hull, meets, region_distance, window_around
from .errors import BadRegion, EmptyRegion, UnboundedRegion
from .parameter_intervals import Intervals
from .point_sampling import Numbers, Segment


class Region(ABC):
    """A set of points. Immutable; points are in metres.

    `dimension` is 2 for areas, 1 for curves, 0 for points; `orientation` is the preferred orientation of its points (a vector
    field, or None for ⊥ in the paper's orientation(R)).
    """

    dimension: int = 2
    name: str | None = None
    orientation: VectorField | None = None
    is_simple = False
    """Whether `measure` is known, and `sample` a map of a fixed number of numbers."""

    @abstractmethod
    def contains_point(self, v: Vector) -> bool:
        """Whether v ∈ R (operator `V is in R`). Regions are closed, and widened by `boundaries.METRES`."""

    @abstractmethod
    def bounds(self) -> Bounds | None:
        """West, south, east and north ends; None if unbounded; `NO_BOUNDS` (inf, inf, -inf, -inf) if empty."""

    @abstractmethod
    def approximate(self, sides: int, window: Polygon) -> Approximation:
        """Shapes inside and around the region, valid inside `window`, in which full circles have `sides` sides."""

    @abstractmethod
    def intervals(self, start: Vector, end: Vector) -> Intervals:
        """The parameters t in [0, 1] for which start + t (end - start) lies in the region."""

    @abstractmethod
    def measure(self) -> float | None:
        """The area, length or number of points, by `dimension`; None if it is infinite or has no closed form."""

    @abstractmethod
    def sample(self, uniform: Numbers) -> Vector:
        """uniformPointIn(R), a deterministic map of the numbers that `uniform` gives. Raises `EmptyRegion`, `UnboundedRegion`."""

    @lift_method(bool)
    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        """Whether the whole box lies in the region (operator `O is in R`)."""
        return contains(self, box_shape(position, heading, width, length))

    @lift_method(bool)
    def meets_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        """Whether the box and the region share a point."""
        return meets(self, box_shape(position, heading, width, length))

    @lift_method(float)
    def distance_to(self, v: Vector) -> float:
        """The distance from `v` to the nearest point of the region as it is written: 0 inside, infinite if the region is empty.

        So it may be up to `boundaries.METRES` for a point that is in the region by its boundary alone.
        Combinations with arcs are known to within 1e-6 m, and remains thinner than that cannot be told from nothing.
        """
        return 0.0 if self.contains_point(v) else region_distance(self, v, window_around(hull(self.extent(), (v.x, v.y, v.x, v.y))))

    def extent(self) -> Bounds:
        """Bounds outside which the region holds all points or none."""
        return self.bounds() or NO_BOUNDS

    def segments(self, within: Bounds | None = None) -> Iterable[Segment]:
        """The segments of a region of dimension 1, overlapping nowhere; those away from the bounds `within` may be left out."""
        return ()

    def points(self) -> Iterable[Vector]:
        """The points of a region of dimension 0."""
        return ()

    def intersect(self, other: Region, triedReversed: bool = False) -> Region:
        """The points in both regions, oriented as this one if it is oriented, else as `other`; `triedReversed`, of the releases, changes nothing."""
        from .combinations import intersection  # a region and its combinations know each other

        return intersection(self, _other("intersect", other))

    def union(self, other: Region, triedReversed: bool = False, buf: float = 0) -> Region:
        """The points in either region, oriented if both are; `triedReversed`, of the releases, changes nothing.

        Raises TypeError for another `buf` than 0.
        """
        if buf != 0:
            raise TypeError("buf= is outside this reference: regions are put together as they are; leave it out")
        from .combinations import union

        return union(self, _other("union", other))

    def difference(self, other: Region) -> Region:
        """The points of this region that are not in `other`, oriented as this region."""
        from .combinations import difference

        return difference(self, _other("difference", other))

    def intersects(self, other: Region, triedReversed: bool = False) -> bool:
        """Whether the regions share a point, boundaries included; arcs that miss by less than 1.2e-9 of their radius count as sharing.

        `triedReversed`, of the releases, changes nothing.
        """
        from .combinations import share_a_point

        return share_a_point(self, _other("intersects", other))

    def containsPoint(self, point: Vector | tuple[float, float]) -> bool:
        """`contains_point` under the released library's name."""
        if not (isinstance(point, (Vector, tuple, list)) and len(point) == 2):
            raise BadRegion(f"containsPoint() takes a vector, not {point!r:.80}")
        x, y = point
        return self.contains_point(Vector(x, y))


def _other(method: str, value: object) -> Region:
    """The argument of a method that takes a region. Raises `BadRegion` for anything else."""
    if not is_one(value, Region):
        raise BadRegion(f"{method}() takes a region, not {value!r:.80}")
    return value  # type: ignore[return-value]


class Everywhere(Region):
    """The region of the whole plane."""

    scenic_made = True

    def __reduce__(self) -> str:
        """Pickle the region as its name, since there is only one."""
        return "everywhere"

    def contains_point(self, v: Vector) -> bool:
        return True

    def contains_box(self, position: Vector, heading: float, width: float, length: float) -> bool:
        return True

    def bounds(self) -> None:
        return None

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        return Approximation(window, window)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return parameter_intervals.ALL

    def measure(self) -> None:
        return None

    def sample(self, uniform: Numbers) -> Vector:
        raise UnboundedRegion(self)

    def __repr__(self) -> str:
        return "everywhere"


class Nowhere(Region):
    """The region without any point."""

    scenic_made = True
    dimension = 0

    def contains_point(self, v: Vector) -> bool:
        return False

    def bounds(self) -> Bounds:
        return NO_BOUNDS

    def approximate(self, sides: int, window: Polygon) -> Approximation:
        nothing = Polygon()
        return Approximation(nothing, nothing)

    def intervals(self, start: Vector, end: Vector) -> Intervals:
        return parameter_intervals.NONE

    def measure(self) -> float:
        return 0.0

    def sample(self, uniform: Numbers) -> Vector:
        raise EmptyRegion(self, "it is empty")

    def __repr__(self) -> str:
        return "nowhere"


everywhere: Region = Everywhere()
nowhere: Region = Nowhere()
