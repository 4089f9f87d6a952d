"""Sets of numbers and points that a `support` vector may name, written without the regions of the machine that they judge."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from .fields import VectorFields
from .paths import is_number

Place = tuple[float, float]
Shape = Callable[[object, float], bool]
"""Whether a decoded JSON value lies in the set, give or take a tolerance."""


def read_shape(fields: VectorFields) -> Shape:
    """`{interval = {low, high}}`, `{disc = {center, radius}}` and so on; `{any = [...]}` is a union. Raises `UsageError`."""
    name = next(iter(fields.rest), "")
    if name == "any":
        shape = union([read_shape(part) for part in fields.tables("any")])
    elif name in SHAPES:
        inner = fields.table(name)
        shape = SHAPES[name](inner)
        inner.done()
    else:
        raise fields.wrong(f"there is no shape {name!r}: there are any, {', '.join(SHAPES)}")
    fields.done()
    return shape


def union(parts: Sequence[Shape]) -> Shape:
    """What lies in at least one of the parts."""
    return lambda value, tolerance: any(part(value, tolerance) for part in parts)


def place_of(value: object) -> Place | None:
    """A pair of finite numbers as a point."""
    if isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 2 and all(is_number(v) and math.isfinite(v) for v in value):
        return float(value[0]), float(value[1])
    return None


def of_points(inside: Callable[[Place, float], bool]) -> Shape:
    """A set of points from its predicate."""

    def shape(value: object, tolerance: float) -> bool:
        place = place_of(value)
        return place is not None and inside(place, tolerance)

    return shape


def interval_set(fields: VectorFields) -> Shape:
    """The numbers from low to high."""
    low, high = fields.number("low"), fields.number("high")
    return lambda value, tolerance: is_number(value) and low - tolerance <= value <= high + tolerance


def disc(fields: VectorFields) -> Shape:
    """The points at most radius from center; at least `inner` from it, if that is given."""
    center, radius, inner = fields.point("center"), fields.number("radius"), fields.number("inner", 0.0)
    return of_points(lambda p, tolerance: inner - tolerance <= math.dist(p, center) <= radius + tolerance)


def sector(fields: VectorFields) -> Shape:
    """The points of a disc that lie within angle / 2 of the heading (radians, anticlockwise from North)."""
    center, radius, heading, angle = fields.point("center"), fields.number("radius"), fields.number("heading"), fields.number("angle")

    def inside(p: Place, tolerance: float) -> bool:
        x, y = p[0] - center[0], p[1] - center[1]
        distance = math.hypot(x, y)
        turn = math.remainder(math.atan2(-x, y) - heading, math.tau)
        return distance <= radius + tolerance and (distance <= tolerance or abs(turn) <= angle / 2 + tolerance)

    return of_points(inside)


def rectangle(fields: VectorFields) -> Shape:
    """The points at most width / 2 across the heading and length / 2 along it from center."""
    center, heading, width, length = fields.point("center"), fields.number("heading", 0.0), fields.number("width"), fields.number("length")

    def inside(p: Place, tolerance: float) -> bool:
        x, y = p[0] - center[0], p[1] - center[1]
        across, along = x * math.cos(heading) + y * math.sin(heading), y * math.cos(heading) - x * math.sin(heading)
        return abs(across) <= width / 2 + tolerance and abs(along) <= length / 2 + tolerance

    return of_points(inside)


def polygon(fields: VectorFields) -> Shape:
    """The points inside or on the boundary of a simple polygon."""
    corners = fields.points("points")
    edges = list(pairwise((*corners, corners[0])))

    def inside(p: Place, tolerance: float) -> bool:
        if any(distance_to_segment(p, a, b) <= tolerance for a, b in edges):
            return True
        crossings = sum((a[1] > p[1]) != (b[1] > p[1]) and p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in edges)
        return crossings % 2 == 1

    return of_points(inside)


def polyline(fields: VectorFields) -> Shape:
    """The points on a chain of segments."""
    segments = list(pairwise(fields.points("points")))
    return of_points(lambda p, tolerance: any(distance_to_segment(p, a, b) <= tolerance for a, b in segments))


def points(fields: VectorFields) -> Shape:
    """Some single points."""
    listed = fields.points("points")
    return of_points(lambda p, tolerance: any(math.dist(p, q) <= tolerance for q in listed))


def distance_to_segment(p: Place, a: Place, b: Place) -> float:
    """The distance of a point from a segment."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    share = 0.0 if square == 0 else min(max(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0.0), 1.0)
    return math.dist(p, (a[0] + share * dx, a[1] + share * dy))


SHAPES: Mapping[str, Callable[[VectorFields], Shape]] = {
    "interval": interval_set,
    "disc": disc,
    "sector": sector,
    "rectangle": rectangle,
    "polygon": polygon,
    "polyline": polyline,
    "points": points,
}
"""The closed table of shapes."""
