"""erode(C, r) and dilate(Q, M) (paper, Section "Domain-Specific Sampling Techniques"), rounded so that neither loses a point.

Buffers of polygons have arcs made of chords and corners that are simplified a little. A set of positions that is kept may be too
large, which costs attempts; it must never be too small, which would change the distribution. So erosion is by a little
less than asked for, and dilation by a little more.
"""

from __future__ import annotations

import math

from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from ...semantics.space.boundaries import common, united

Shape = Polygon | MultiPolygon
CHORDS = 8
"""Chords for a quarter of a circle."""
SIMPLIFIED = 0.01
"""The share of its distance by which a buffer may be off, since corners are simplified first (JTS, `BufferInputLineSimplifier`)."""
ROUNDING = 1e-6
"""Metres by which coordinates computed from others may be off, generously."""
OUTWARD = (1 + SIMPLIFIED) / math.cos(math.pi / (4 * CHORDS))
NOTHING = Polygon()


def erode(shape: BaseGeometry, distance: float) -> Shape:
    """At least the points whose distance from everything outside `shape` is `distance` metres or more. Holes count as outside."""
    if distance < 0:
        raise ValueError(f"a region is eroded by a distance, not by {distance}")
    return polygons_of(shape.buffer(ROUNDING - (1 - SIMPLIFIED) * distance, quad_segs=CHORDS))


def dilate(shape: BaseGeometry, distance: float) -> Shape:
    """At least the points within `distance` metres of `shape`."""
    if distance < 0:
        raise ValueError(f"a region is dilated by a distance, not by {distance}")
    return polygons_of(shape.buffer(ROUNDING + OUTWARD * distance, quad_segs=CHORDS))


def polygons_of(shape: BaseGeometry) -> Shape:
    """The areas in a geometry: lines and points, which no uniform point ever meets, are left out."""
    found = [part for part in _parts(shape) if isinstance(part, Polygon) and part.area > 0]
    return found[0] if len(found) == 1 else MultiPolygon(found) if found else NOTHING


def _parts(shape: BaseGeometry) -> list[BaseGeometry]:
    members = getattr(shape, "geoms", None)
    return [shape] if members is None else [part for member in members for part in _parts(member)]


def union_of(shapes: list[Shape]) -> Shape:
    """The union of some shapes."""
    return polygons_of(united(shapes)) if shapes else NOTHING


def common_part(first: BaseGeometry, second: BaseGeometry) -> Shape:
    """The points in both shapes, and those within rounding of them."""
    return polygons_of(common(first, second))
