"""Appendix "Detailed Semantics of Specifiers and Operators", Section "Operators": one equation, one function.

Each figure of that section is a table here, in its order. An `Equation` says which kinds of operands it is for; the
functions compute with floats or arrays alike. `Rewriting`s are the equations whose right-hand side is itself a Scenic
expression (⟦distance to V⟧ = ⟦distance from ego.position to V⟧).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NamedTuple

from ..machine.operand_kinds import (
    FIELD,
    HEADING,
    OBJECT,
    ORIENTED_POINT,
    POINT,
    REGION,
    SCALAR,
    VECTOR,
    OrientedPointAt,
    View,
)
from ..space import geometry
from ..space.fields import VectorField
from ..space.numeric_functions import to_floats
from ..space.regions import CircularRegion, Region, SectorRegion
from ..space.vectors import Vector
from ..syntax import expressions as e
from ..syntax.nodes import Node
from ..syntax.python_expressions import Attribute, Name


class Equation(NamedTuple):
    """An equation of the appendix: its id, the kinds of its operands, and its right-hand side.

    The function gets self.position as a further argument if `needs_self`.
    """

    rule: str
    kinds: tuple[str, ...]
    function: Callable[..., object]
    needs_self: bool = False


class Rewriting(NamedTuple):
    """An equation ⟦E⟧ = ⟦E'⟧ between expressions or specifiers: `applies(E)` and `rewrite(E)` = E'."""

    rule: str
    applies: Callable[..., bool]
    rewrite: Callable[..., Node]


DEGREE = math.pi / 180
EGO = Name(name="ego")
EGO_POSITION = Attribute(value=EGO, name="position")
EGO_HEADING = Attribute(value=EGO, name="heading")


# Figure "Scalar operators"


def relative_heading_from_ego(node: e.RelativeHeading) -> Node:
    """⟦relative heading of H⟧ = ⟦relative heading of H from ego.heading⟧."""
    return replace(node, origin=EGO_HEADING)


def relative_heading(h1: float, h2: float) -> float:
    """⟦relative heading of H1 from H2⟧ = ⟦H1⟧ - ⟦H2⟧, in radians, not normalised (reading `angle`)."""
    return h1 - h2


def apparent_heading_from_ego(node: e.ApparentHeading) -> Node:
    """⟦apparent heading of OP⟧ = ⟦apparent heading of OP from ego.position⟧."""
    return replace(node, origin=EGO_POSITION)


def apparent_heading(op: View, v: Vector) -> float:
    """⟦apparent heading of OP from V⟧ = ⟦OP.heading⟧ - arctan(⟦OP.position⟧ - ⟦V⟧), in radians."""
    return op.heading - geometry.angle_of(op.position - v)


def distance_from_ego(node: e.Distance) -> Node:
    """⟦distance to V⟧ = ⟦distance from ego.position to V⟧; `distance from V` alone is the distance to ego (silent)."""
    return replace(node, origin=EGO_POSITION) if node.origin is None else replace(node, target=EGO_POSITION)


def distance(v1: Vector, v2: Vector) -> float:
    """⟦distance from V1 to V2⟧ = |⟦V2⟧ - ⟦V1⟧|, in metres."""
    return geometry.distance(v1, v2)


def distance_to_region(v: Vector, r: Region) -> float:
    """⟦distance from V to R⟧ = min {|x - ⟦V⟧| : x ∈ ⟦R⟧}, 0 inside (Section "Dynamic Scenarios" writes `distance from self to intersection`)."""
    return r.distance_to(v)


def distance_past_from_ego(node: e.DistancePast) -> Node:
    """⟦distance past V⟧ = ⟦distance of ego past V⟧ (reading `distance-past`)."""
    return replace(node, oriented_point=EGO)


def distance_past(op: View, v: Vector) -> float:
    """⟦distance of OP past V⟧ = y coordinate of rotate(⟦OP.position⟧ - ⟦V⟧, -⟦OP.heading⟧) (reading `distance-past`)."""
    return geometry.rotate(op.position - v, -op.heading).y


def angle_from_ego(node: e.Angle) -> Node:
    """⟦angle to V⟧ = ⟦angle from ego.position to V⟧."""
    return replace(node, origin=EGO_POSITION) if node.origin is None else replace(node, target=EGO_POSITION)


def angle(v1: Vector, v2: Vector) -> float:
    """⟦angle from V1 to V2⟧ = arctan(⟦V2⟧ - ⟦V1⟧), in radians anticlockwise from North (reading `angle`)."""
    return geometry.angle_of(v2 - v1)


# Figure "Boolean operators"


def can_see_object(p: View, o: View) -> bool:
    """⟦P can see O⟧ = visibleRegion(⟦P⟧) ∩ boundingBox(⟦O⟧) ≠ ∅, both closed."""
    heading, view_angle = (p.heading, p.view_angle) if p.is_oriented else (0.0, geometry.TAU)
    return geometry.sector_meets_box(p.position, p.view_distance, heading, view_angle, o.position, o.heading, o.width, o.length)


def can_see_vector(p: View, v: Vector) -> bool:
    """⟦P can see V⟧ = ⟦V⟧ ∈ visibleRegion(⟦P⟧) (reading `can-see-vector`)."""
    heading, view_angle = (p.heading, p.view_angle) if p.is_oriented else (0.0, geometry.TAU)
    return geometry.sector_contains(p.position, p.view_distance, heading, view_angle, v)


def vector_is_in(v: Vector, r: Region) -> bool:
    """⟦V is in R⟧ = ⟦V⟧ ∈ ⟦R⟧."""
    return r.contains_point(v)


def object_is_in(o: View, r: Region) -> bool:
    """⟦O is in R⟧ = boundingBox(⟦O⟧) ⊆ ⟦R⟧."""
    return r.contains_box(o.position, o.heading, o.width, o.length)


# Figure "Heading operators" (and `scalar deg` of Figure "Operators by result type")


def degrees(s: float) -> float:
    """⟦S deg⟧ = ⟦S⟧ · π / 180, in radians."""
    return s * DEGREE


def field_at(f: VectorField, v: Vector) -> float:
    """⟦F at V⟧ = ⟦F⟧(⟦V⟧)."""
    return f.at(v)


def fields_relative(f1: VectorField, f2: VectorField, self_position: Vector) -> float:
    """⟦F1 relative to F2⟧ = ⟦F1⟧(⟦self.position⟧) + ⟦F2⟧(⟦self.position⟧)."""
    return f1.at(self_position) + f2.at(self_position)


def heading_relative_to_field(h: float, f: VectorField, self_position: Vector) -> float:
    """⟦H relative to F⟧ = ⟦H⟧ + ⟦F⟧(⟦self.position⟧)."""
    return h + f.at(self_position)


def field_relative_to_heading(f: VectorField, h: float, self_position: Vector) -> float:
    """⟦F relative to H⟧ = ⟦H⟧ + ⟦F⟧(⟦self.position⟧)."""
    return h + f.at(self_position)


def headings_relative(h1: float, h2: float) -> float:
    """⟦H1 relative to H2⟧ = ⟦H1⟧ + ⟦H2⟧."""
    return h1 + h2


# Figure "Vector operators"


def vector_of(x: float, y: float) -> Vector:
    """⟦X @ Y⟧ = ⟨⟦X⟧, ⟦Y⟧⟩ (footnote in Section "Data Types")."""
    return Vector(to_floats(x), to_floats(y))


def vectors_relative(v1: Vector, v2: Vector) -> Vector:
    """⟦V1 relative to V2⟧ = ⟦V1⟧ + ⟦V2⟧ (reading `vector-relative`)."""
    return v1 + v2


def vector_offset_by(v1: Vector, v2: Vector) -> Vector:
    """⟦V1 offset by V2⟧ = ⟦V1⟧ + ⟦V2⟧."""
    return v1 + v2


def vector_offset_along_heading(v1: Vector, h: float, v2: Vector) -> Vector:
    """⟦V1 offset along H by V2⟧ = ⟦V1⟧ + rotate(⟦V2⟧, ⟦H⟧)."""
    return v1 + geometry.rotate(v2, h)


def vector_offset_along_field(v1: Vector, f: VectorField, v2: Vector) -> Vector:
    """⟦V1 offset along F by V2⟧ = ⟦V1⟧ + rotate(⟦V2⟧, ⟦F⟧(⟦V1⟧))."""
    return v1 + geometry.rotate(v2, f.at(v1))


# Figure "Region operators"


def visible_from_ego(node: e.Visible) -> Node:
    """⟦visible R⟧ = ⟦R visible from ego⟧."""
    return e.VisibleFrom(region=node.region, viewer=EGO, span=node.span)


def visible_region(x: View) -> Region:
    """visibleRegion(X) = Sector(position, viewDistance, heading, viewAngle) of an OrientedPoint, a disc for a Point."""
    if x.is_oriented and x.view_angle < geometry.TAU:
        return SectorRegion(x.position, x.view_distance, x.heading, x.view_angle)
    return CircularRegion(x.position, x.view_distance)


def region_visible_from(r: Region, p: View) -> Region:
    """⟦R visible from P⟧ = ⟦R⟧ ∩ visibleRegion(⟦P⟧)."""
    return r.intersect(visible_region(p))


# Figure "OrientedPoint operators"


def oriented_point_offset_by(op: View, v: Vector) -> OrientedPointAt:
    """⟦OP offset by V⟧ = ⟦V relative to OP⟧."""
    return vector_relative_to_oriented_point(v, op)


def vector_relative_to_oriented_point(v: Vector, op: View) -> OrientedPointAt:
    """⟦V relative to OP⟧ = OrientedPoint(offsetLocal(OP, ⟦V⟧), ⟦OP.heading⟧)."""
    heading = op.heading
    return OrientedPointAt(geometry.offset_local(op.position, heading, v), heading)


def follow_from_ego(node: e.Follow) -> Node:
    """⟦follow F for S⟧ = ⟦follow F from ego.position for S⟧."""
    return replace(node, origin=EGO_POSITION)


def follow(f: VectorField, v: Vector, s: float) -> OrientedPointAt:
    """⟦follow F from V for S⟧ = OrientedPoint(y, ⟦F⟧(y)) where y = forwardEuler(⟦V⟧, ⟦S⟧, ⟦F⟧)."""
    y = geometry.forward_euler(f.at, v, s, f.steps(s))
    return OrientedPointAt(y, f.at(y))


def front_of(o: View) -> OrientedPointAt:
    """⟦front of O⟧ = ⟦⟨0, ⟦O.length⟧/2⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(0.0, o.length / 2), o)


def back_of(o: View) -> OrientedPointAt:
    """⟦back of O⟧ = ⟦⟨0, -⟦O.length⟧/2⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(0.0, -o.length / 2), o)


def left_of(o: View) -> OrientedPointAt:
    """⟦left of O⟧ = ⟦⟨-⟦O.width⟧/2, 0⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(-o.width / 2, 0.0), o)


def right_of(o: View) -> OrientedPointAt:
    """⟦right of O⟧ = ⟦⟨⟦O.width⟧/2, 0⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(o.width / 2, 0.0), o)


def front_left_of(o: View) -> OrientedPointAt:
    """⟦front left of O⟧ = ⟦⟨-⟦O.width⟧/2, ⟦O.length⟧/2⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(-o.width / 2, o.length / 2), o)


def back_left_of(o: View) -> OrientedPointAt:
    """⟦back left of O⟧ = ⟦⟨-⟦O.width⟧/2, -⟦O.length⟧/2⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(-o.width / 2, -o.length / 2), o)


def front_right_of(o: View) -> OrientedPointAt:
    """⟦front right of O⟧ = ⟦⟨⟦O.width⟧/2, ⟦O.length⟧/2⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(o.width / 2, o.length / 2), o)


def back_right_of(o: View) -> OrientedPointAt:
    """⟦back right of O⟧ = ⟦⟨⟦O.width⟧/2, -⟦O.length⟧/2⟩ relative to O⟧."""
    return vector_relative_to_oriented_point(Vector(o.width / 2, -o.length / 2), o)


REWRITINGS: Mapping[type[Node], Rewriting] = {
    e.RelativeHeading: Rewriting("O-RelativeHeading-Ego", lambda n: n.origin is None, relative_heading_from_ego),
    e.ApparentHeading: Rewriting("O-ApparentHeading-Ego", lambda n: n.origin is None, apparent_heading_from_ego),
    e.Distance: Rewriting("O-Distance-Ego", lambda n: n.origin is None or n.target is None, distance_from_ego),
    e.DistancePast: Rewriting("O-DistancePast-Ego", lambda n: n.oriented_point is None, distance_past_from_ego),
    e.Angle: Rewriting("O-Angle-Ego", lambda n: n.origin is None or n.target is None, angle_from_ego),
    e.Visible: Rewriting("O-Visible-Ego", lambda n: True, visible_from_ego),
    e.Follow: Rewriting("O-Follow-Ego", lambda n: n.origin is None, follow_from_ego),
}

SIDES: Mapping[str, Equation] = {
    "front": Equation("O-FrontOf", (OBJECT,), front_of),
    "back": Equation("O-BackOf", (OBJECT,), back_of),
    "left": Equation("O-LeftOf", (OBJECT,), left_of),
    "right": Equation("O-RightOf", (OBJECT,), right_of),
    "front left": Equation("O-FrontLeftOf", (OBJECT,), front_left_of),
    "back left": Equation("O-BackLeftOf", (OBJECT,), back_left_of),
    "front right": Equation("O-FrontRightOf", (OBJECT,), front_right_of),
    "back right": Equation("O-BackRightOf", (OBJECT,), back_right_of),
}

OFFSET_OF_VECTOR = Equation("O-OffsetBy-Vector", (VECTOR, VECTOR), vector_offset_by)
OFFSET_BY: Mapping[str, tuple[Equation, ...]] = {
    "local": (Equation("O-OffsetBy-OrientedPoint", (ORIENTED_POINT, VECTOR), oriented_point_offset_by), OFFSET_OF_VECTOR),
    "global": (OFFSET_OF_VECTOR,),
}
"""The equations of `offset by` under the alternatives of reading `oriented-offset`."""

EQUATIONS: Mapping[type[Node], tuple[tuple[str, ...], tuple[Equation, ...]]] = {
    e.RelativeHeading: (("heading", "origin"), (Equation("O-RelativeHeading", (HEADING, HEADING), relative_heading),)),
    e.ApparentHeading: (("oriented_point", "origin"), (Equation("O-ApparentHeading", (ORIENTED_POINT, VECTOR), apparent_heading),)),
    e.Distance: (
        ("origin", "target"),
        (
            Equation("O-Distance", (VECTOR, VECTOR), distance),
            Equation("O-Distance-Region", (VECTOR, REGION), distance_to_region),
        ),
    ),
    e.DistancePast: (("oriented_point", "vector"), (Equation("O-DistancePast", (ORIENTED_POINT, VECTOR), distance_past),)),
    e.Angle: (("origin", "target"), (Equation("O-Angle", (VECTOR, VECTOR), angle),)),
    e.CanSee: (
        ("viewer", "target"),
        (
            Equation("O-CanSee-Object", (POINT, OBJECT), can_see_object),
            Equation("O-CanSee-Vector", (POINT, VECTOR), can_see_vector),
        ),
    ),
    e.Degrees: (("value",), (Equation("O-Deg", (SCALAR,), degrees),)),
    e.FieldAt: (("field", "vector"), (Equation("O-At", (FIELD, VECTOR), field_at),)),
    e.RelativeTo: (
        ("left", "right"),
        (
            Equation("O-RelativeTo-Fields", (FIELD, FIELD), fields_relative, needs_self=True),
            Equation("O-RelativeTo-HeadingField", (HEADING, FIELD), heading_relative_to_field, needs_self=True),
            Equation("O-RelativeTo-FieldHeading", (FIELD, HEADING), field_relative_to_heading, needs_self=True),
            Equation("O-RelativeTo-VectorOrientedPoint", (VECTOR, ORIENTED_POINT), vector_relative_to_oriented_point),
            Equation("O-RelativeTo-Headings", (HEADING, HEADING), headings_relative),
            Equation("O-RelativeTo-Vectors", (VECTOR, VECTOR), vectors_relative),
        ),
    ),
    e.VectorOf: (("x", "y"), (Equation("O-VectorOf", (SCALAR, SCALAR), vector_of),)),
    e.OffsetBy: (("base", "offset"), OFFSET_BY["local"]),
    e.OffsetAlong: (
        ("base", "direction", "offset"),
        (
            Equation("O-OffsetAlong-Heading", (VECTOR, HEADING, VECTOR), vector_offset_along_heading),
            Equation("O-OffsetAlong-Field", (VECTOR, FIELD, VECTOR), vector_offset_along_field),
        ),
    ),
    e.VisibleFrom: (("region", "viewer"), (Equation("O-VisibleFrom", (REGION, POINT), region_visible_from),)),
    e.Follow: (("field", "origin", "distance"), (Equation("O-Follow", (FIELD, VECTOR, SCALAR), follow),)),
}

IN_EQUATIONS = (
    Equation("O-In-Object", (OBJECT, REGION), object_is_in),
    Equation("O-In-Vector", (VECTOR, REGION), vector_is_in),
)

