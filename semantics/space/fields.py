"""Vector fields: a heading at each point of the plane (paper, Section "Data Types"; operator `F at V`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property
from typing import TypeAlias

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from .boundaries import all_widened
from .numeric_functions import is_real, lift_method
from .vectors import Vector

Cell: TypeAlias = "tuple[Polygon | MultiPolygon, float | Callable[[Vector], float] | None]"

STEPS = 4
"""N of forwardEuler (Figure "Notation"), "an implementation-defined parameter (...) (we used N = 4)"."""
MOST_STEPS = 100_000
_CANDIDATE_MARGIN = 1e-6  # metres by which a square of the lookup grid is widened, so that rounding loses no cell


class OutsideField(Exception):
    """The field has no value at `point` (reading `field-outside`): the machine turns this into a stuck run."""

    def __init__(self, field: VectorField, point: Vector) -> None:
        super().__init__(f"the vector field {field.name} has no value at {point}")
        self.field = field
        self.point = point
        self.premise = f"the vector field {field.name} has a value there"  # names no point, so that a report can count it


class BadField(ValueError):
    """The arguments do not describe a vector field."""


class VectorField:
    """A heading (radians, anticlockwise from North) at each point, given by the function `value`.

    forwardEuler along the field takes at least `minSteps` steps, and forwards each of at most `defaultStepSize` metres (of the released
    implementations); where they are not given, the paper's N steps, however long.

    Example: `field = VectorField('swirl', lambda place: angle from (0, 0) to place)`
    """

    def __init__(
        self, name: str, value: Callable[[Vector], float], minSteps: int | None = None, defaultStepSize: float | None = None
    ) -> None:  # fmt: skip
        if not callable(value) or isinstance(value, type):
            raise BadField(f"the value of a vector field must be a function of a point, not {value!r}")
        if minSteps is not None and not (isinstance(minSteps, int) and minSteps > 0):
            raise BadField(f"the number of steps along a vector field must be a positive whole number, not {minSteps!r}")
        if defaultStepSize is not None and not (is_real(defaultStepSize) and defaultStepSize > 0):
            raise BadField(f"the size of a step along a vector field must be a positive number, not {defaultStepSize!r}")
        self.name = name
        self.value = value
        self.minSteps = minSteps
        self.defaultStepSize = defaultStepSize

    def steps(self, distance: float) -> int:
        """N, how many steps forwardEuler takes for a distance in metres. Raises `BadField` for more than `MOST_STEPS`."""
        least = self.minSteps or STEPS
        number = least if self.defaultStepSize is None else max(least, math.ceil(distance / self.defaultStepSize))
        if number > MOST_STEPS:
            raise BadField(f"{number} steps along a vector field are too many")
        return number

    def stepping(self, steps: int | None, size: float | None) -> VectorField:
        """Return the field with which forwardEuler takes so many steps, or steps of at most this size."""
        changed = copy(self)
        VectorField.__init__(changed, self.name, self.value, self.minSteps if steps is None else steps, None if steps is not None else size)
        return changed

    def at(self, v: Vector) -> float:
        """The heading at `v`: ⟦F at V⟧ = ⟦F⟧(⟦V⟧). Raises `OutsideField` where there is none."""
        return self.value(v)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"


class PolygonalVectorField(VectorField):
    """A field that is constant, or given by a function, on each of some closed polygons. Raises `BadField`.

    `cells` is a sequence of (polygon, heading); a polygon may be given as a region with straight edges or by its points, a heading may be a number, a
    function of the point, or None, which stands for `headingFunction`. Where cells overlap, the first that contains the point wins. Outside all
    cells the value is `defaultHeading` if given; else there is none, and `at` raises `OutsideField`.

    Example: `field = PolygonalVectorField('lanes', [([(0, 0), (3, 0), (3, 9), (0, 9)], 0), ([(3, 0), (6, 0), (6, 9), (3, 9)], 180 deg)])`
    """

    def __init__(
        self,
        name: str,
        cells: Sequence[Cell],
        headingFunction: Callable[[Vector], float] | None = None,
        defaultHeading: float | None = None,
    ) -> None:
        super().__init__(name, self._value_at)
        self.cells: tuple[Cell, ...] = tuple(map(cell_of, cells_in(cells)))
        self.headingFunction = headingFunction
        self.defaultHeading = defaultHeading
        self._squares: dict[tuple[int, int], tuple[int, ...]] = {}  # grid square -> cells near it, filled on demand
        for number, (_, heading) in enumerate(self.cells):
            if heading is None and headingFunction is None and defaultHeading is None:
                raise BadField(f"cell {number} of the vector field {name} has no heading, and there is no headingFunction")

    def cell_at(self, v: Vector) -> int | None:
        """The number of the first cell that contains `v` (edges included), or None."""
        x, y, side = v.x, v.y, self._side
        if not (math.isfinite(x) and math.isfinite(y)):
            return None
        square = (math.floor(x / side), math.floor(y / side))
        candidates = self._squares.get(square)
        if candidates is None:
            candidates = self._candidates(square)
        bounds, polygons = self._bounds, self.closed
        for number in candidates:
            west, south, east, north = bounds[number]
            if west <= x <= east and south <= y <= north and shapely.intersects_xy(polygons[number], x, y):
                return number
        return None

    @lift_method(float)
    def _value_at(self, v: Vector) -> float:
        number = self.cell_at(v)
        if number is None:
            if self.defaultHeading is None:
                raise OutsideField(self, v)
            return self.defaultHeading
        heading = self.cells[number][1]
        if heading is None:
            heading = self.headingFunction if self.headingFunction is not None else self.defaultHeading
        assert heading is not None  # checked by the constructor
        return heading(v) if callable(heading) else heading

    @cached_property
    def closed(self) -> Sequence[BaseGeometry]:
        """The polygons with their boundaries, as wide as `boundaries` says."""
        polygons = all_widened([polygon for polygon, _ in self.cells])
        shapely.prepare(polygons)
        return polygons

    @cached_property
    def _bounds(self) -> tuple[tuple[float, float, float, float], ...]:
        return tuple(polygon.bounds for polygon in self.closed)

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree(self.closed)

    @cached_property
    def _side(self) -> float:
        """The side of a square of the lookup grid, in metres: the median extent of a cell."""
        extents = [max(east - west, north - south) for west, south, east, north in self._bounds]
        return max(float(np.median(extents)), 1e-3) if extents else 1.0

    def _candidates(self, square: tuple[int, int]) -> tuple[int, ...]:
        """The cells that may contain a point of the grid square, in the order of the cells; remembered unless there are none."""
        west, south = square[0] * self._side, square[1] * self._side
        margin = _CANDIDATE_MARGIN + 1e-12 * (abs(west) + abs(south))
        area = shapely.box(west - margin, south - margin, west + self._side + margin, south + self._side + margin)
        near = tuple(sorted(int(i) for i in self._tree.query(area, predicate="intersects")))
        if near:
            self._squares[square] = near
        return near


def cells_in(cells: object) -> tuple[Sequence[object], ...]:
    """The cells, not yet looked at. Raises `BadField`."""
    try:
        return tuple(cells)  # type: ignore[arg-type]
    except TypeError:
        raise BadField(f"the cells of a vector field must be a list of pairs, not {cells!r:.80}") from None


def cell_of(pair: Sequence[object]) -> Cell:
    """A cell as it was given: a polygon, polygonal region or points, and a heading, a function of the point, or None. Raises `BadField`."""
    polygon, heading = pair if isinstance(pair, (tuple, list)) and len(pair) == 2 else (None, None)
    inside = getattr(polygon, "polygon", None) or getattr(polygon, "geometry", polygon)
    shape = polygon_through(polygon) if isinstance(polygon, (tuple, list)) else inside
    if not isinstance(shape, (Polygon, MultiPolygon)):
        raise BadField(f"a cell of a vector field must be a pair of a polygonal region, or its corners, and a heading, not {pair!r}")
    if not (heading is None or callable(heading) or is_real(heading)):
        raise BadField(f"the heading of a cell must be a number, a function of the point or None, not {heading!r}")
    return shape, heading  # type: ignore[return-value]


def polygon_through(points: Sequence[object]) -> Polygon:
    """The polygon with these corners, vectors or pairs of numbers. Raises `BadField`."""
    try:
        corners = [(float(x), float(y)) for x, y in points]  # type: ignore[misc]
    except (TypeError, ValueError):
        raise BadField(f"the points of a cell of a vector field must be vectors, not {points!r:.80}") from None
    if len(set(corners)) < 3 or not np.isfinite(corners).all():
        raise BadField("a cell of a vector field needs at least 3 different points, of finite numbers")
    found = Polygon(corners)
    if not found.is_valid:
        raise BadField(f"a cell of a vector field is not a polygon: {shapely.is_valid_reason(found)}")
    return found
