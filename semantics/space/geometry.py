"""Geometry of the plane: the notation of the appendix "Detailed Semantics of Specifiers and Operators", as code.

Units are metres and radians; headings run anticlockwise from North (the y axis), so that the unit vector along
heading h is ⟨-sin h, cos h⟩. Every equation stands here once and takes floats or NumPy arrays alike (also as the
coordinates of a `Vector`): Python floats give Python floats and bools, arrays give arrays. Sines, square roots and so
on are NumPy's in both cases, so that one scene computed alone and the same scene in an array agree bit for bit.

A *box* is given by its position (centre), heading, width (along its local x axis) and length (along its local y axis).
Sets are closed: what merely touches, intersects; what comes within `boundaries.METRES` of it, touches. Predicates compare dot and cross
products, which are distances, and use no arctangent.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable

import numpy as np

from .boundaries import METRES, RADIANS
from .numeric_functions import arc_tangent, cosine, larger, macro, plain_float, real, sine, smaller
from .vectors import Vector

TAU = 2.0 * math.pi


def rotate(v: Vector, angle: float) -> Vector:
    """⟨x cos θ - y sin θ, x sin θ + y cos θ⟩: `v` turned anticlockwise by `angle` (Figure "Notation")."""
    c, s = cosine(angle), sine(angle)
    return Vector(v.x * c - v.y * s, v.x * s + v.y * c)


def offset_local(position: Vector, heading: float, v: Vector) -> Vector:
    """offsetLocal(OP, v) = OP.position + rotate(v, OP.heading) (Figure "Notation")."""
    return position + rotate(v, heading)


def direction(heading: float) -> Vector:
    """The unit vector along `heading`: ⟨-sin h, cos h⟩."""
    return Vector(-sine(heading), cosine(heading))


def angle_of(v: Vector) -> float:
    """The heading of `v`, from -π to π (arctan in the paper; reading `angle`): rotate(⟨0, |v|⟩, angle_of(v)) = v.

    The zero vector has angle 0. Signed zeros do not matter.
    """
    return arc_tangent(0.0 - v.x, v.y + 0.0)


def vector_norm(v: Vector) -> float:
    """The norm |v|, in metres."""
    return plain_float(np.hypot(real(v.x), real(v.y)))


def distance(a: Vector, b: Vector) -> float:
    """|b - a|, in metres (operator `distance from V1 to V2`)."""
    return vector_norm(Vector(b.x - a.x, b.y - a.y))


def normalise_heading(heading: float) -> float:
    """The heading in (-π, π] that differs from `heading` by a multiple of 2π; headings in that range are kept bit for bit."""
    rest = plain_float(np.fmod(real(heading), TAU))
    return rest - TAU * (rest > math.pi) + TAU * (rest <= -math.pi)


def forward_euler(field: Callable[[Vector], float], start: Vector, distance: float, steps: int) -> Vector:
    """forwardEuler(x, d, F): the map x ↦ x + rotate(⟨0, d/N⟩, F(x)) iterated N = `steps` times on `start`."""
    stride = Vector(0.0, distance / steps)
    here = start
    for _ in range(steps):
        here = here + rotate(stride, field(here))
    return here


def corners(position: Vector, heading: float, width: float, length: float) -> tuple[Vector, Vector, Vector, Vector]:
    """The corners of a box: front right, front left, back left, back right (anticlockwise)."""
    across, along = rotate(Vector(width / 2, 0.0), heading), rotate(Vector(0.0, length / 2), heading)
    front, back = position + along, position - along
    return front + across, front - across, back - across, back + across


def to_local(position: Vector, heading: float, point: Vector) -> Vector:
    """`point` in the coordinate system with origin `position` and y axis along `heading` (inverse of `offset_local`)."""
    c, s = cosine(heading), sine(heading)
    x, y = point.x - position.x, point.y - position.y
    return Vector(x * c + y * s, y * c - x * s)


def box_contains(position: Vector, heading: float, width: float, length: float, point: Vector) -> bool:
    """Whether `point` lies in the box, its edges included."""
    local = to_local(position, heading, point)
    return (abs(local.x) <= width / 2 + METRES) & (abs(local.y) <= length / 2 + METRES)


def distance_to_box(position: Vector, heading: float, width: float, length: float, point: Vector) -> float:
    """The distance from `point` to the nearest point of the box; 0 inside."""
    local = to_local(position, heading, point)
    return vector_norm(Vector(larger(abs(local.x) - width / 2, 0.0), larger(abs(local.y) - length / 2, 0.0)))


def boxes_intersect(
    position1: Vector, heading1: float, width1: float, length1: float,
    position2: Vector, heading2: float, width2: float, length2: float, *, closed: bool = True,
) -> bool:  # fmt: skip
    """Whether two boxes share a point, by the four separating axes: as closed sets, so that touching is sharing, or as open ones."""
    test = turned_boxes_intersect if closed else turned_boxes_overlap
    return test(
        position2 - position1, Vector(cosine(heading1), sine(heading1)), Vector(width1 / 2, length1 / 2),
        Vector(cosine(heading2), sine(heading2)), Vector(width2 / 2, length2 / 2),
    )  # fmt: skip


@macro
def turned_boxes_intersect(offset: Vector, turn1: Vector, half1: Vector, turn2: Vector, half2: Vector) -> bool:
    """`boxes_intersect` for closed boxes with their centres `offset` apart; of each the cosine and sine of the heading, and half its size."""
    return _not_separated(operator.le, METRES, offset, turn1, half1, turn2, half2)


@macro
def turned_boxes_overlap(offset: Vector, turn1: Vector, half1: Vector, turn2: Vector, half2: Vector) -> bool:
    """`boxes_intersect` for open boxes with their centres `offset` apart; of each the cosine and sine of the
    heading, and half its size.
    """
    return _not_separated(operator.lt, -METRES, offset, turn1, half1, turn2, half2)


def _not_separated(
    meets: Callable[..., bool], margin: float, offset: Vector, turn1: Vector, half1: Vector, turn2: Vector, half2: Vector
) -> bool:  # fmt: skip
    """Whether none of the four axes separates the boxes, by more than `margin` metres."""
    (x, y), (c1, s1), (hw1, hl1), (c2, s2), (hw2, hl2) = offset, turn1, half1, turn2, half2
    c, s = abs(c1 * c2 + s1 * s2), abs(s2 * c1 - c2 * s1)  # of the difference of headings
    return (
        meets(abs(x * c1 + y * s1), hw1 + (hw2 * c + hl2 * s) + margin)
        & meets(abs(y * c1 - x * s1), hl1 + (hw2 * s + hl2 * c) + margin)
        & meets(abs(x * c2 + y * s2), hw2 + (hw1 * c + hl1 * s) + margin)
        & meets(abs(y * c2 - x * s2), hl2 + (hw1 * s + hl1 * c) + margin)
    )


def wedge_contains(heading: float, angle: float, v: Vector) -> bool:
    """Whether the offset `v` points into the closed wedge of opening `angle` centred along `heading`.

    An angle of 0 is a ray, at least 2π the plane, a negative one nothing. The zero vector lies in every non-empty wedge.
    """
    left, right, middle = direction(heading + angle / 2), direction(heading - angle / 2), direction(heading)
    beyond_right = right.x * v.y - right.y * v.x >= -METRES
    before_left = v.x * left.y - v.y * left.x >= -METRES
    ahead = middle.x * v.x + middle.y * v.y >= -METRES
    narrow = (angle >= 0) & (angle <= math.pi) & beyond_right & before_left & ahead
    wide = (angle > math.pi) & (beyond_right | before_left)
    return narrow | wide | (angle >= TAU - RADIANS)


def sector_contains(center: Vector, radius: float, heading: float, angle: float, point: Vector) -> bool:
    """Whether `point` ∈ Sector(center, radius, heading, angle), a closed set (Figure "Notation").

    An angle of at least 2π makes it Disc(center, radius), 0 a line segment; a negative angle or radius the empty set; a
    radius of 0 the apex alone. The radius may be infinite.
    """
    v = Vector(point.x - center.x, point.y - center.y)
    reach = radius + METRES
    return (radius >= 0) & (v.x * v.x + v.y * v.y <= reach * reach) & wedge_contains(heading, angle, v)


@macro
def sector_meets_box(
    center: Vector, radius: float, heading: float, angle: float,
    position: Vector, box_heading: float, width: float, length: float,
) -> bool:  # fmt: skip
    """Sector(...) ∩ box ≠ ∅, with the true arc (operator `P can see O`); edge cases as in `sector_contains`.

    Let q be the point of the sector's wedge and the box that is nearest to the apex. If q is inside the wedge, it is the
    nearest point of the box altogether (which is convex); else it lies on one of the two sides. So the sector meets the
    box exactly if it contains the box's nearest point, or one of its straight sides meets the box.
    """
    half_width, half_length = width / 2, length / 2
    apex = to_local(position, box_heading, center)
    ahead = heading - box_heading
    origin = Vector(0.0, 0.0)
    nearest = Vector(
        larger(-half_width, smaller(apex.x, half_width)),
        larger(-half_length, smaller(apex.y, half_length)),
    )
    reach = smaller(radius, abs(apex.x) + abs(apex.y) + half_width + half_length)  # the box lies within this of the apex
    side = (radius >= 0) & (angle >= 0) & (
        _segment_meets_box(apex, direction(ahead + angle / 2), reach, half_width + METRES, half_length + METRES)
        | _segment_meets_box(apex, direction(ahead - angle / 2), reach, half_width + METRES, half_length + METRES)
    )  # fmt: skip
    offset = Vector(nearest.x - apex.x, nearest.y - apex.y)
    return side | sector_contains(origin, radius, ahead, angle, offset)


def _segment_meets_box(start: Vector, along: Vector, reach: float, half_width: float, half_length: float) -> bool:
    """Whether the segment from `start` by `reach` metres `along` meets the box centred at the origin, facing North."""
    hx, hy = along.x * reach / 2, along.y * reach / 2
    mx, my = start.x + hx, start.y + hy
    return (
        (abs(mx) <= half_width + abs(hx))
        & (abs(my) <= half_length + abs(hy))
        & (abs(mx * hy - my * hx) <= half_width * abs(hy) + half_length * abs(hx))
    )
