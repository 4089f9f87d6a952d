"""Appendix "Detailed Semantics of Specifiers and Operators": the specifiers, one equation, one function.

A specifier is a function taking in values for its dependencies and returning values for the properties it specifies,
some of them optionally (paper, Section "Specifiers"). Its `Form` says which, chosen by the kinds of its arguments; the
functions below are the equations. `self` is the object being specified, as far as it is known.
"""

from __future__ import annotations

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
from ..space.regions import Region
from ..space.vectors import Vector
from ..syntax import specifiers as q
from ..syntax.nodes import Node
from ..syntax.python_expressions import Constant
from .operators import EGO, EGO_POSITION, Rewriting, back_of, follow, front_of, left_of, right_of, visible_region


class Form(NamedTuple):
    """One row of Table "Specifiers for position" or "Specifiers for heading", and its equation.

    `kinds` are those of the arguments, in the order of the node's `premises`; `function(*arguments)` gets `self` as a
    last argument if `needs_self` (ego if `needs_ego`), and gives a vector, a heading,
    an OrientedPoint or the region to draw a point x from, after which `function(*arguments, x)` is the value. With `passes_on` it gives
    its argument back, random or not; with `heading_of_region`, a heading as well if the region has an orientation.
    """

    rule: str
    kinds: tuple[str, ...]
    function: Callable[..., object]
    specifies: tuple[str, ...] = ("position",)
    optional: tuple[str, ...] = ()
    dependencies: tuple[str, ...] = ()
    needs_self: bool = False
    needs_ego: bool = False
    passes_on: bool = False
    heading_of_region: bool = False


ZERO = Constant(value=0)


# Figure "Semantics of expressions"


def with_property(p: str, v: object) -> Mapping[str, object]:
    """If ⟨E, σ, π, O⟩ → ⟨v, σ, π, O'⟩ then ⟨with P E, σ, π, O⟩ → {P ↦ v}."""
    return {p: v}


def default_value(p: str, v: object) -> Mapping[str, object]:
    """If ⟨E, σ, π, O⟩ → ⟨v, σ, π, O'⟩ then ⟨defaults(P), σ, π, O⟩ → {P ↦ v}, where E is the value expression of P in the most derived class."""
    return {p: v}


# Figure "Semantics of position specifiers"


def at(v: Vector) -> Vector:
    """⟦at V⟧ = ⟦V⟧."""
    return v


def offset_by_local(v: Vector, ego: View) -> Vector:
    """⟦offset by V⟧ = position of ⟦V relative to ego⟧: along ego's axes (reading `offset-by` = local)."""
    return geometry.offset_local(ego.position, ego.heading, v)


def offset_by_global(v: Vector, ego: View) -> Vector:
    """⟦offset by V⟧ = ⟦V relative to ego.position⟧: along the global axes (reading `offset-by` = global, as the figure has it)."""
    return v + ego.position


def offset_along_heading(h: float, v: Vector, ego: View) -> Vector:
    """⟦offset along H by V⟧ = ⟦ego.position offset along H by V⟧."""
    return ego.position + geometry.rotate(v, h)


def offset_along_field(f: VectorField, v: Vector, ego: View) -> Vector:
    """⟦offset along F by V⟧ = ⟦ego.position offset along F by V⟧."""
    return ego.position + geometry.rotate(v, f.at(ego.position))


def without_gap(node: q.BesideSpecifier) -> Node:
    """⟦left of X⟧ = ⟦left of X by 0⟧, and likewise for right of, ahead of, behind."""
    return replace(node, gap=ZERO)


def left_of_vector(v: Vector, s: float, self: View) -> Vector:
    """⟦left of V by S⟧ = ⟦V⟧ + rotate(⟨-⟦self.width⟧/2 - ⟦S⟧, 0⟩, ⟦self.heading⟧)."""
    return v + geometry.rotate(Vector(-self.width / 2 - s, 0.0), self.heading)


def right_of_vector(v: Vector, s: float, self: View) -> Vector:
    """⟦right of V by S⟧ = ⟦V⟧ + rotate(⟨⟦self.width⟧/2 + ⟦S⟧, 0⟩, ⟦self.heading⟧)."""
    return v + geometry.rotate(Vector(self.width / 2 + s, 0.0), self.heading)


def ahead_of_vector(v: Vector, s: float, self: View) -> Vector:
    """⟦ahead of V by S⟧ = ⟦V⟧ + rotate(⟨0, ⟦self.length⟧/2 + ⟦S⟧⟩, ⟦self.heading⟧)."""
    return v + geometry.rotate(Vector(0.0, self.length / 2 + s), self.heading)


def behind_vector(v: Vector, s: float, self: View) -> Vector:
    """⟦behind V by S⟧ = ⟦V⟧ + rotate(⟨0, -⟦self.length⟧/2 - ⟦S⟧⟩, ⟦self.heading⟧)."""
    return v + geometry.rotate(Vector(0.0, -self.length / 2 - s), self.heading)


def beyond_from_ego(node: q.BeyondSpecifier) -> Node:
    """⟦beyond V1 by V2⟧ = ⟦beyond V1 by V2 from ego.position⟧."""
    return replace(node, origin=EGO_POSITION)


def beyond(v1: Vector, v2: Vector, v3: Vector) -> Vector:
    """⟦beyond V1 by V2 from V3⟧ = ⟦V1⟧ + rotate(⟦V2⟧, arctan(⟦V1⟧ - ⟦V3⟧))."""
    return v1 + geometry.rotate(v2, geometry.angle_of(v1 - v3))


def visible_from_ego(node: q.VisibleSpecifier) -> Node:
    """⟦visible⟧ = ⟦visible from ego⟧."""
    return replace(node, viewer=EGO)


def visible_from(p: View, x: Vector | None = None) -> Region | Vector:
    """⟦visible from P⟧ = uniformPointIn(visibleRegion(⟦P⟧)), not clipped to the workspace (reading `visible-clip`); the region, until x is drawn."""
    return visible_region(p) if x is None else x


# Figure "Semantics of position specifiers that optionally specify heading"


def in_region(r: Region, x: Vector | None = None) -> Region | OrientedPointAt:
    """⟦in R⟧ = ⟦on R⟧ = OrientedPoint(x, ⟦orientation(R)⟧(x)), or heading ⊥ without orientation, with x = uniformPointIn(⟦R⟧).

    The region, until x is drawn.
    """
    return r if x is None else OrientedPointAt(x, None if r.orientation is None else r.orientation.at(x))


def ahead_of_object(o: View, s: float, self: View) -> OrientedPointAt:
    """⟦ahead of O by S⟧ = ⟦ahead of (front of O) by S⟧ (reading `beside-object-by`)."""
    return _ahead(front_of(o), s, self)


def behind_object(o: View, s: float, self: View) -> OrientedPointAt:
    """⟦behind O by S⟧ = ⟦behind (back of O) by S⟧."""
    return _behind(back_of(o), s, self)


def left_of_object(o: View, s: float, self: View) -> OrientedPointAt:
    """⟦left of O by S⟧ = ⟦left of (left of O) by S⟧."""
    return _left(left_of(o), s, self)


def right_of_object(o: View, s: float, self: View) -> OrientedPointAt:
    """⟦right of O by S⟧ = ⟦right of (right of O) by S⟧."""
    return _right(right_of(o), s, self)


def ahead_of_oriented_point(op: View, s: float, self: View) -> OrientedPointAt:
    """⟦ahead of OP by S⟧ = OrientedPoint(offsetLocal(OP, ⟨0, ⟦self.length⟧/2 + ⟦S⟧⟩), ⟦OP.heading⟧)."""
    return _ahead(OrientedPointAt(op.position, op.heading), s, self)


def behind_oriented_point(op: View, s: float, self: View) -> OrientedPointAt:
    """⟦behind OP by S⟧ = OrientedPoint(offsetLocal(OP, ⟨0, -⟦self.length⟧/2 - ⟦S⟧⟩), ⟦OP.heading⟧)."""
    return _behind(OrientedPointAt(op.position, op.heading), s, self)


def left_of_oriented_point(op: View, s: float, self: View) -> OrientedPointAt:
    """⟦left of OP by S⟧ = OrientedPoint(offsetLocal(OP, ⟨-⟦self.width⟧/2 - ⟦S⟧, 0⟩), ⟦OP.heading⟧)."""
    return _left(OrientedPointAt(op.position, op.heading), s, self)


def right_of_oriented_point(op: View, s: float, self: View) -> OrientedPointAt:
    """⟦right of OP by S⟧ = OrientedPoint(offsetLocal(OP, ⟨⟦self.width⟧/2 + ⟦S⟧, 0⟩), ⟦OP.heading⟧)."""
    return _right(OrientedPointAt(op.position, op.heading), s, self)


def _ahead(op: OrientedPointAt, s: float, self: View) -> OrientedPointAt:
    return _offset_local(op, Vector(0.0, self.length / 2 + s))


def _behind(op: OrientedPointAt, s: float, self: View) -> OrientedPointAt:
    return _offset_local(op, Vector(0.0, -self.length / 2 - s))


def _left(op: OrientedPointAt, s: float, self: View) -> OrientedPointAt:
    return _offset_local(op, Vector(-self.width / 2 - s, 0.0))


def _right(op: OrientedPointAt, s: float, self: View) -> OrientedPointAt:
    return _offset_local(op, Vector(self.width / 2 + s, 0.0))


def _offset_local(op: OrientedPointAt, v: Vector) -> OrientedPointAt:
    assert op.heading is not None
    return OrientedPointAt(geometry.offset_local(op.position, op.heading, v), op.heading)


def following_from_ego(node: q.FollowingSpecifier) -> Node:
    """⟦following F for S⟧ = ⟦following F from ego.position for S⟧."""
    return replace(node, origin=EGO_POSITION)


def following(f: VectorField, v: Vector, s: float) -> OrientedPointAt:
    """⟦following F from V for S⟧ = ⟦follow F from V for S⟧."""
    return follow(f, v, s)


# Figure "Semantics of heading specifiers"


def facing_heading(h: float) -> float:
    """⟦facing H⟧ = ⟦H⟧."""
    return h


def facing_field(f: VectorField, self: View) -> float:
    """⟦facing F⟧ = ⟦F⟧(⟦self.position⟧)."""
    return f.at(self.position)


def facing_toward(v: Vector, self: View) -> float:
    """⟦facing toward V⟧ = arctan(⟦V⟧ - ⟦self.position⟧)."""
    return geometry.angle_of(v - self.position)


def facing_away_from(v: Vector, self: View) -> float:
    """⟦facing away from V⟧ = arctan(⟦self.position⟧ - ⟦V⟧)."""
    return geometry.angle_of(self.position - v)


def apparently_facing_from_ego(node: q.ApparentlyFacingSpecifier) -> Node:
    """⟦apparently facing H⟧ = ⟦apparently facing H from ego.position⟧."""
    return replace(node, origin=EGO_POSITION)


def apparently_facing(h: float, v: Vector, self: View) -> float:
    """⟦apparently facing H from V⟧ = ⟦H⟧ + arctan(⟦self.position⟧ - ⟦V⟧)."""
    return h + geometry.angle_of(self.position - v)


REWRITINGS: Mapping[type[Node], Rewriting] = {
    q.BesideSpecifier: Rewriting("P-Beside-Zero", lambda n: n.gap is None, without_gap),
    q.BeyondSpecifier: Rewriting("P-Beyond-Ego", lambda n: n.origin is None, beyond_from_ego),
    q.VisibleSpecifier: Rewriting("P-Visible-Ego", lambda n: n.viewer is None, visible_from_ego),
    q.FollowingSpecifier: Rewriting("P-Following-Ego", lambda n: n.origin is None, following_from_ego),
    q.ApparentlyFacingSpecifier: Rewriting("P-ApparentlyFacing-Ego", lambda n: n.origin is None, apparently_facing_from_ego),
}

HEADING_ONLY = ("heading",)
WIDE, LONG = ("width",), ("length",)


def _beside(
    name: str, vector: Callable[..., object], point: Callable[..., object], object_: Callable[..., object], size: tuple[str, ...]
) -> tuple[Form, ...]:
    return (
        Form(f"P-{name}-Object", (OBJECT, SCALAR), object_, optional=HEADING_ONLY, dependencies=size, needs_self=True),
        Form(f"P-{name}-OrientedPoint", (ORIENTED_POINT, SCALAR), point, optional=HEADING_ONLY, dependencies=size, needs_self=True),
        Form(f"P-{name}-Vector", (VECTOR, SCALAR), vector, dependencies=("heading", *size), needs_self=True),
    )


BESIDE: Mapping[str, tuple[Form, ...]] = {
    "left": _beside("LeftOf", left_of_vector, left_of_oriented_point, left_of_object, WIDE),
    "right": _beside("RightOf", right_of_vector, right_of_oriented_point, right_of_object, WIDE),
    "ahead": _beside("AheadOf", ahead_of_vector, ahead_of_oriented_point, ahead_of_object, LONG),
    "behind": _beside("Behind", behind_vector, behind_oriented_point, behind_object, LONG),
}

OFFSET_BY: Mapping[str, tuple[Form, ...]] = {
    "local": (Form("P-OffsetBy-Local", (VECTOR, OBJECT), offset_by_local, needs_ego=True),),
    "global": (Form("P-OffsetBy-Global", (VECTOR, OBJECT), offset_by_global, needs_ego=True),),
}

FORMS: Mapping[type[Node], tuple[tuple[str, ...], tuple[Form, ...]]] = {
    q.AtSpecifier: (("vector",), (Form("P-At", (VECTOR,), at, passes_on=True),)),
    q.OffsetBySpecifier: (("offset",), ()),
    q.OffsetAlongSpecifier: (
        ("direction", "offset"),
        (
            Form("P-OffsetAlong-Heading", (HEADING, VECTOR, OBJECT), offset_along_heading, needs_ego=True),
            Form("P-OffsetAlong-Field", (FIELD, VECTOR, OBJECT), offset_along_field, needs_ego=True),
        ),
    ),
    q.BesideSpecifier: (("reference", "gap"), ()),
    q.BeyondSpecifier: (("vector", "offset", "origin"), (Form("P-Beyond", (VECTOR, VECTOR, VECTOR), beyond),)),
    q.VisibleSpecifier: (("viewer",), (Form("P-Visible", (POINT,), visible_from),)),
    q.InSpecifier: (("region",), (Form("P-In", (REGION,), in_region, heading_of_region=True),)),
    q.FollowingSpecifier: (
        ("field", "origin", "distance"),
        (Form("P-Following", (FIELD, VECTOR, SCALAR), following, optional=HEADING_ONLY),),
    ),
    q.FacingSpecifier: (
        ("direction",),
        (
            Form("P-Facing-Heading", (HEADING,), facing_heading, specifies=HEADING_ONLY, passes_on=True),
            Form("P-Facing-Field", (FIELD,), facing_field, specifies=HEADING_ONLY, dependencies=("position",), needs_self=True),
        ),
    ),
    q.FacingTowardSpecifier: (
        ("vector",),
        (Form("P-FacingToward", (VECTOR,), facing_toward, specifies=HEADING_ONLY, dependencies=("position",), needs_self=True),),
    ),
    q.FacingAwayFromSpecifier: (
        ("vector",),
        (Form("P-FacingAwayFrom", (VECTOR,), facing_away_from, specifies=HEADING_ONLY, dependencies=("position",), needs_self=True),),
    ),
    q.ApparentlyFacingSpecifier: (
        ("heading", "origin"),
        (
            Form(
                "P-ApparentlyFacing", (HEADING, VECTOR), apparently_facing, specifies=HEADING_ONLY, dependencies=("position",), needs_self=True
            ),
        ),
    ),
}


def specifier_name(node: Node) -> str:
    """The specifier as the user wrote it, for messages."""
    names = {
        q.AtSpecifier: "at", q.OffsetBySpecifier: "offset by", q.OffsetAlongSpecifier: "offset along", q.BeyondSpecifier: "beyond",
        q.VisibleSpecifier: "visible", q.NotVisibleSpecifier: "not visible", q.ContainedInSpecifier: "contained in",
        q.FollowingSpecifier: "following", q.FacingSpecifier: "facing",
        q.FacingTowardSpecifier: "facing toward", q.FacingAwayFromSpecifier: "facing away from", q.ApparentlyFacingSpecifier: "apparently facing",
    }
    match node:
        case q.WithSpecifier(property=name):
            return f"with {name}"
        case q.BesideSpecifier(side=side):
            return {"left": "left of", "right": "right of", "ahead": "ahead of", "behind": "behind"}[side]
        case q.InSpecifier(keyword=keyword):
            return keyword
        case _:
            return names.get(type(node), type(node).__name__)
