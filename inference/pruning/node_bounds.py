"""Statements about the numbers of a graph in all runs: bounds, sums, headings along a field, offsets in an
object's frame.

Everything here is a statement about nodes. A node that is not understood has no bounds, and then nothing is
pruned by it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ...semantics.space.fields import PolygonalVectorField
from ...semantics.space.vectors import Vector
from ..batch.graph import GraphNode, RowCall
from ..batch.symbolic import Choice, Traced

TAU = 2 * math.pi
SLACK = 1e-9
"""Radians by which an angle may be off by rounding."""


class Interval(NamedTuple):
    """The numbers from `low` to `high`; either may be infinite."""

    low: float
    high: float

    def __add__(self, other: object) -> Interval:
        assert isinstance(other, Interval)
        return Interval(self.low + other.low, self.high + other.high)

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def times(self, other: Interval) -> Interval:
        """Return the interval that holds all products; the whole line if a product is not finite."""
        products = [x * y for x in self for y in other]
        return Interval(min(products), max(products)) if all(map(math.isfinite, products)) else ALL

    def meets(self, other: Interval) -> bool:
        """Whether the two share a number."""
        return self.low <= other.high and other.low <= self.high

    def common(self, other: Interval) -> Interval:
        """The numbers in both; empty if `low` > `high`."""
        return Interval(max(self.low, other.low), min(self.high, other.high))

    @property
    def largest(self) -> float:
        """The largest absolute value."""
        return max(abs(self.low), abs(self.high))

    @property
    def smallest(self) -> float:
        """The smallest absolute value."""
        return 0.0 if self.low <= 0 <= self.high else min(abs(self.low), abs(self.high))

    @property
    def bounded(self) -> bool:
        """Whether both ends are finite."""
        return math.isfinite(self.low) and math.isfinite(self.high)


ALL = Interval(-math.inf, math.inf)
ZERO = Interval(0.0, 0.0)


def angles_meet(angle: float, spread: float, allowed: Interval, turn: float = TAU) -> bool:
    """Whether [angle - spread, angle + spread] meets `allowed`, for angles that are equal if they differ by a multiple of `turn`.

    An infinite `turn` compares numbers as they are. `allowed` may begin and end anywhere, say at 170 and 190 degrees.
    """
    spread += SLACK
    if not math.isfinite(turn):
        return Interval(angle - spread, angle + spread).meets(allowed)
    if allowed.high < allowed.low:
        return False
    if not allowed.bounded or allowed.high - allowed.low + 2 * spread >= turn:
        return True
    return (angle + spread - allowed.low) % turn <= allowed.high - allowed.low + 2 * spread


UNIT = Interval(-1.0, 1.0)
Operand = GraphNode | float
Terms = Mapping[Operand, float]
"""A sum: the factor of each node; of the number 1.0, the constant."""


def operand_of(value: object) -> Operand | None:
    """A number of the program as a node or a constant; None for anything else."""
    if isinstance(value, Choice):
        return None
    if isinstance(value, Traced):
        return value.node
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def bounds_of_value(value: object) -> Interval:
    """Bounds of a number of the program, which may be a choice among some."""
    if isinstance(value, Choice):
        each = [bounds_of_value(v) for v in value.values]
        return Interval(min(b.low for b in each), max(b.high for b in each))
    operand = operand_of(value)
    return ALL if operand is None else bounds(operand)


def bounds(operand: Operand) -> Interval:
    """Bounds that hold in every run, infinite where none are known."""
    if not isinstance(operand, GraphNode):
        return Interval(operand, operand)
    if operand.bounds is not None:
        return Interval(*operand.bounds)
    if operand.function in (np.sin, np.cos):
        return UNIT
    field = field_looked_up(operand)
    if field is not None:
        return bounds_of_field(field)
    return _bounds_of_operation(operand)


def _bounds_of_operation(node: GraphNode) -> Interval:
    if node.function not in (np.add, np.subtract, np.multiply, np.negative):
        return ALL
    first, *rest = (bounds(a) if isinstance(a, (GraphNode, float)) else ALL for a in node.arguments)
    if node.function is np.negative:
        return -first
    return first.times(rest[0]) if node.function is np.multiply else first + (rest[0] if node.function is np.add else -rest[0])


def field_looked_up(node: GraphNode) -> PolygonalVectorField | None:
    """The field whose value at some point the node is, if it has a constant heading in each polygon and none outside."""
    call = node.function
    if isinstance(call, RowCall) and call.function is PolygonalVectorField._value_at and is_constant(call.structure[0]):  # pyright: ignore[reportPrivateUsage]
        return call.structure[0]  # type: ignore[return-value]
    return None


def is_constant(field: object) -> bool:
    """Whether a field is polygonal, constant in each polygon, and without a value outside all of them."""
    return (
        isinstance(field, PolygonalVectorField) and field.defaultHeading is None and bool(field.cells)
        and all(isinstance(heading, (int, float)) for _, heading in field.cells)
    )  # fmt: skip


def bounds_of_field(field: PolygonalVectorField) -> Interval:
    """The smallest and largest heading."""
    headings = [float(h) for _, h in field.cells]  # type: ignore[arg-type]
    return Interval(min(headings), max(headings))


# Sums


def terms(operand: Operand, factor: float = 1.0) -> dict[Operand, float]:
    """`factor` times the operand as a sum of nodes that are not sums; a product of a number and a node counts as a factor."""
    found: dict[Operand, float] = {}
    waiting: list[tuple[object, float]] = [(operand, factor)]
    while waiting:
        part, share = waiting.pop()
        match part:
            case GraphNode(function=np.add, arguments=(a, b)):
                waiting += [(a, share), (b, share)]
            case GraphNode(function=np.subtract, arguments=(a, b)):
                waiting += [(a, share), (b, -share)]
            case GraphNode(function=np.negative, arguments=(a,)):
                waiting.append((a, -share))
            case GraphNode(function=np.multiply, arguments=(float() as number, a) | (a, float() as number)):
                waiting.append((a, share * number))
            case GraphNode():
                found[part] = found.get(part, 0.0) + share
            case _:
                found[1.0] = found.get(1.0, 0.0) + share * float(part)  # type: ignore[arg-type]
    return {part: share for part, share in found.items() if share != 0}


def difference(second: Operand, first: Operand) -> dict[Operand, float]:
    """`second` minus `first`; what both contain cancels."""
    total = terms(second)
    for part, share in terms(first, -1.0).items():
        total[part] = total.get(part, 0.0) + share
    return {part: share for part, share in total.items() if share != 0}


def bounds_of_terms(sum_: Terms) -> Interval:
    """Bounds of a sum."""
    total = ZERO
    for part, share in sum_.items():
        total += bounds(part).times(Interval(share, share))
    return total


# Points, and headings along a field

Point = tuple[Operand, Operand]
"""The coordinates of a point."""


def point_of(value: object) -> Point | None:
    """A vector of the program as its two coordinates."""
    if not isinstance(value, Vector):
        return None
    x, y = operand_of(value.x), operand_of(value.y)
    return None if x is None or y is None else (x, y)


class Aligned(NamedTuple):
    """A heading that is that of `field` at `point`, plus a number within `deviation`."""

    field: PolygonalVectorField
    point: Point
    deviation: Interval


def field_alignment(heading: Operand) -> Aligned | None:
    """A heading as that of a field and a bounded deviation, if it is one."""
    sum_ = terms(heading)
    lookups = [part for part, share in sum_.items() if isinstance(part, GraphNode) and share == 1.0 and field_looked_up(part) is not None]
    if len(lookups) != 1:
        return None
    call = lookups[0].function
    assert isinstance(call, RowCall)
    point = point_of(call.structure[1])
    deviation = bounds_of_terms({part: share for part, share in sum_.items() if part is not lookups[0]})
    return Aligned(call.structure[0], point, deviation) if point is not None and deviation.bounded else None  # type: ignore[arg-type]


# Offsets


class Offset(NamedTuple):
    """The position of a point as seen from another that has a heading: metres `across` to the right, `along`
    ahead, up to `slack` metres.
    """

    across: Interval
    along: Interval
    slack: float

    @property
    def distance(self) -> float:
        """At most this many metres."""
        return float(np.hypot(self.across.largest, self.along.largest)) + self.slack


def offset(origin: Point, heading: Operand | None, point: Point) -> Offset | None:
    """`point` seen from `origin`, where its offset is rotate(v, heading) plus something, both bounded; None if not known.

    With v = ⟨a, b⟩ it is ⟨a cos h - b sin h, a sin h + b cos h⟩ (Figure "Notation"): a and b must be the same sums in both coordinates.
    """
    x, y = (difference(p, o) for p, o in zip(point, origin, strict=True))
    across, along, x_rest = _rotation_terms(x, heading, np.cos, np.sin, -1.0)
    across_again, along_again, y_rest = _rotation_terms(y, heading, np.sin, np.cos, 1.0)
    if across != across_again or along != along_again:
        across, along, x_rest, y_rest = {}, {}, x, y
    rest = bounds_of_terms(x_rest), bounds_of_terms(y_rest)
    found = bounds_of_terms(across), bounds_of_terms(along)
    if not all(b.bounded for b in (*rest, *found)):
        return None
    return Offset(*found, float(np.hypot(rest[0].largest, rest[1].largest)))


def _rotation_terms(sum_: Terms, heading: Operand | None, first: np.ufunc, second: np.ufunc, sign: float) -> tuple[Terms, Terms, Terms]:
    """The sum as a times first(heading) plus `sign` times b times second(heading), plus a rest: a, b and the rest."""
    a: dict[Operand, float] = {}
    b: dict[Operand, float] = {}
    rest: dict[Operand, float] = {}
    for part, share in sum_.items():
        factor, function, angle = _factor_of(part)
        if angle is None or angle is not heading:
            rest[part] = rest.get(part, 0.0) + share
            continue
        into, times = (a, share) if function is first else (b, sign * share)
        for inner, inner_share in terms(factor, times).items():
            into[inner] = into.get(inner, 0.0) + inner_share
    return _nonzero_terms(a), _nonzero_terms(b), rest


def _nonzero_terms(sum_: Terms) -> Terms:
    return {part: share for part, share in sum_.items() if share != 0}


def _factor_of(part: Operand) -> tuple[Operand, object, object]:
    """u, the function and the angle, for u sin(angle) and u cos(angle)."""
    match part:
        case GraphNode(function=np.sin | np.cos as function, arguments=(angle,)):
            return 1.0, function, angle
        case GraphNode(function=np.multiply, arguments=(u, GraphNode(function=np.sin | np.cos as function, arguments=(angle,)))):
            return u, function, angle  # type: ignore[return-value]
        case GraphNode(function=np.multiply, arguments=(GraphNode(function=np.sin | np.cos as function, arguments=(angle,)), u)):
            return u, function, angle  # type: ignore[return-value]
        case _:
            return part, None, None


__all__ = [
    "Aligned", "Offset", "Point", "bounds", "bounds_of_value", "difference", "field_alignment", "field_looked_up", "offset", "point_of", "terms"
]

