"""Boundaries in arithmetic that is not exact: the one tolerance by which sets of points are closed (reading
`boundaries`).

Regions, visible regions, bounding boxes and the cells of vector fields are closed sets of the plane. A point
that lies on the boundary of one, as written, is computed to lie beside it as often as not, some 1e-16 of its
coordinates away. So what comes within `METRES` of a closed set is in it, or meets it: far more than rounding,
for coordinates up to 1e7 m, and far less than anything that a scene is about. Open sets (reading
`touching=allow`) lose as much. Comparisons of numbers in a program are not about sets of points, and remain
exact.

Every backend computes with these predicates, or with polygons that are widened here.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

METRES = 1e-8
"""How near a point is to a closed set that it counts as in it; measured across each straight side, so that at a corner it may be a little further."""
GRID = METRES / 10
"""Metres to whose multiples overlays of shapes round: without, edges that coincide but for rounding make GEOS lose whole polygons now and then."""
MOST_CORNERS = 100_000
"""With more corners there is no grid: to round edges that run along each other everywhere, as those of two equal discs do, takes minutes."""
RADIANS = 1e-8
"""A sector whose angle lacks no more than this of a full turn is a disc."""


def widen_shape(shape: BaseGeometry) -> BaseGeometry:
    """The polygons of `shape`, or its lines and points, and all within `METRES` of them, as an area."""
    return shape.buffer(METRES, quad_segs=1, join_style="mitre")


def grid_for(*shapes: BaseGeometry) -> float | None:
    """The grid for an overlay of shapes: `GRID`, or as fine as the coordinates allow where these are beyond some 1e6 m; None for many corners."""
    if int(np.sum(shapely.get_num_coordinates(shapes))) > MOST_CORNERS:
        return None
    bounds = np.abs(shapely.bounds(np.array(shapes, dtype=object)))
    return max(GRID, float(np.nanmax(bounds, initial=0.0)) * 2.0**-50)


def unite_shapes(shapes: Sequence[BaseGeometry]) -> BaseGeometry:
    """Return the union of shapes."""
    return shapely.union_all(shapes, grid_size=grid_for(*shapes))  # type: ignore[arg-type]


def common(first: BaseGeometry, second: BaseGeometry) -> BaseGeometry:
    """Return the intersection of shapes."""
    return shapely.intersection(first, second, grid_size=grid_for(first, second))


def without(first: BaseGeometry, second: BaseGeometry) -> BaseGeometry:
    """Return the difference of shapes."""
    return shapely.difference(first, second, grid_size=grid_for(first, second))


def all_widened(shapes: Sequence[BaseGeometry]) -> Sequence[BaseGeometry]:
    """Each of the polygons, widened."""
    return shapely.buffer(np.array(shapes, dtype=object), METRES, quad_segs=1, join_style="mitre")  # type: ignore[return-value]
