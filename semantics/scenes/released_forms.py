"""Operators and specifiers of the released implementations (dialects `scenic-2.1` and `scenic-3`) that are not in the paper.

Equations as in `operators` and `specifiers`, whose tables they join; the meaning is that of the releases' documentation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

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
from ..syntax import expressions as e
from ..syntax import specifiers as q
from ..syntax.nodes import Node
from ..syntax.python_expressions import Name
from . import operators, specifiers
from .operators import EGO, EGO_POSITION, Equation, Rewriting, visible_region
from .specifiers import HEADING_ONLY, Form, in_region

WORKSPACE = Name(name="workspace")


def relative_position_from_ego(node: e.RelativePosition) -> Node:
    """⟦relative position of V⟧ = ⟦relative position of V from ego.position⟧."""
    return replace(node, origin=EGO_POSITION)


def relative_position(v1: Vector, v2: Vector) -> Vector:
    """⟦relative position of V1 from V2⟧ = ⟦V1⟧ - ⟦V2⟧, along the global axes."""
    return v1 - v2


def relative_heading_wrapped(h1: float, h2: float) -> float:
    """⟦relative heading of H1 from H2⟧ = ⟦H1⟧ - ⟦H2⟧, as the angle in (-π, π] that is the same up to full turns (reading `angle`)."""
    return geometry.normalise_heading(operators.relative_heading(h1, h2))


def apparent_heading_wrapped(op: View, v: Vector) -> float:
    """⟦apparent heading of OP from V⟧ = ⟦OP.heading⟧ - arctan(⟦OP.position⟧ - ⟦V⟧), as the angle in (-π, π] (reading `angle`)."""
    return geometry.normalise_heading(operators.apparent_heading(op, v))


def region_not_visible_from_ego(node: e.NotVisible) -> Node:
    """⟦not visible R⟧ = ⟦R \\ visibleRegion(ego)⟧."""
    return replace(node, viewer=EGO)


def not_visible_region(r: Region, p: View) -> Region:
    """⟦R \\ visibleRegion(P)⟧ = ⟦R⟧ \\ visibleRegion(⟦P⟧)."""
    return r.difference(visible_region(p))


def not_visible_in_workspace(node: q.NotVisibleSpecifier) -> Node:
    """⟦not visible [from P]⟧ = ⟦not visible from P, in the workspace⟧, where P is ego if it is left out."""
    return replace(node, viewer=node.viewer or EGO, within=WORKSPACE)


def not_visible_from(p: View, r: Region, x: Vector | None = None) -> Region | Vector:
    """⟦not visible from P⟧ = uniformPointIn(workspace \\ visibleRegion(⟦P⟧)); the region, until x is drawn."""
    return r.difference(visible_region(p)) if x is None else x


def contained_in_region(r: Region, x: Vector | None = None) -> Region | OrientedPointAt:
    """⟦contained in R⟧ = ⟦in R⟧, and regionContainedIn is ⟦R⟧; the region, until x is drawn."""
    return in_region(r, x)


def on_vector(v: Vector) -> Vector:
    """⟦on V⟧ = ⟦at V⟧."""
    return v


def beyond_by_scalar(v1: Vector, s: float, v3: Vector) -> Vector:
    """⟦beyond V1 by S from V3⟧ = ⟦beyond V1 by (0, S) from V3⟧."""
    return specifiers.beyond(v1, Vector(0.0, s), v3)


def offset_by_oriented(v: Vector, ego: View) -> OrientedPointAt:
    """⟦offset by V⟧ = ⟦V relative to ego⟧: its position, and optionally ego's heading (reading `offset-heading`)."""
    return OrientedPointAt(specifiers.offset_by_local(v, ego), ego.heading)


def offset_along_heading_oriented(h: float, v: Vector, ego: View) -> OrientedPointAt:
    """⟦offset along H by V⟧ = OrientedPoint(⟦ego.position offset along H by V⟧, ego.heading), the heading being optional."""
    return OrientedPointAt(specifiers.offset_along_heading(h, v, ego), ego.heading)


def offset_along_field_oriented(f: VectorField, v: Vector, ego: View) -> OrientedPointAt:
    """⟦offset along F by V⟧ = OrientedPoint(⟦ego.position offset along F by V⟧, ego.heading), the heading being optional."""
    return OrientedPointAt(specifiers.offset_along_field(f, v, ego), ego.heading)


def by_vector(form: Form, side: str) -> Form:
    """`left of X by V` and its kin: as by the component of V across (along) the object, then moved by the other one."""
    across = side in ("left", "right")

    def moved(x: Vector | View, d: Vector, self: View) -> Vector | OrientedPointAt:
        at = form.function(x, d.x if across else d.y, self)
        rest = Vector(0.0, d.y) if across else Vector(d.x, 0.0)
        if isinstance(at, OrientedPointAt):
            assert at.heading is not None
            return OrientedPointAt(at.position + geometry.rotate(rest, at.heading), at.heading)
        return at + geometry.rotate(rest, self.heading)  # type: ignore[operator]

    words = f"{side} of" if side != "behind" else side
    amount, moving = ("x", "(0, V.y)") if across else ("y", "(V.x, 0)")
    moved.__doc__ = f"⟦{words} X by V⟧ = ⟦{words} X by V.{amount}⟧, moved by rotate({moving}, the heading), for X as in {form.rule}."
    return form._replace(rule=f"{form.rule}-By-Vector", kinds=(form.kinds[0], VECTOR), function=moved)


OPERATORS: Mapping[type[Node], tuple[tuple[str, ...], tuple[Equation, ...]]] = {
    e.RelativePosition: (("target", "origin"), (Equation("O-RelativePosition", (VECTOR, VECTOR), relative_position),)),
    e.NotVisible: (("region", "viewer"), (Equation("O-NotVisible", (REGION, POINT), not_visible_region),)),
}
OPERATOR_REWRITINGS: Mapping[type[Node], Rewriting] = {
    e.RelativePosition: Rewriting("O-RelativePosition-Ego", lambda n: n.origin is None, relative_position_from_ego),
    e.NotVisible: Rewriting("O-NotVisible-Ego", lambda n: n.viewer is None, region_not_visible_from_ego),
}
SPECIFIERS: Mapping[type[Node], tuple[tuple[str, ...], tuple[Form, ...]]] = {
    q.NotVisibleSpecifier: (("viewer", "within"), (Form("P-NotVisible", (POINT, REGION), not_visible_from),)),
    q.ContainedInSpecifier: (
        ("region",),
        (Form("P-ContainedIn", (REGION,), contained_in_region, specifies=("position", "regionContainedIn"), heading_of_region=True),),
    ),
}
SPECIFIER_REWRITINGS: Mapping[type[Node], Rewriting] = {
    q.NotVisibleSpecifier: Rewriting("P-NotVisible-Workspace", lambda n: n.within is None, not_visible_in_workspace),
}
BESIDE: Mapping[str, tuple[Form, ...]] = {side: tuple(by_vector(f, side) for f in forms) for side, forms in specifiers.BESIDE.items()}
BEYOND = Form("P-Beyond-Scalar", (VECTOR, SCALAR, VECTOR), beyond_by_scalar)
ON_VECTOR = Form("P-On-Vector", (VECTOR,), on_vector, passes_on=True)
ORIENTED_OFFSETS: Mapping[type[Node], tuple[Form, ...]] = {
    q.OffsetBySpecifier: (Form("P-OffsetBy-Oriented", (VECTOR, OBJECT), offset_by_oriented, optional=HEADING_ONLY, needs_ego=True),),
    q.OffsetAlongSpecifier: (
        Form("P-OffsetAlong-Heading-Oriented", (HEADING, VECTOR, OBJECT), offset_along_heading_oriented, optional=HEADING_ONLY, needs_ego=True),
        Form("P-OffsetAlong-Field-Oriented", (FIELD, VECTOR, OBJECT), offset_along_field_oriented, optional=HEADING_ONLY, needs_ego=True),
    ),
}
"""The forms of offsets that have a heading under `offset-heading=ego`."""

WRAPPED: Mapping[type[Node], tuple[Equation, ...]] = {
    e.RelativeHeading: (Equation("O-RelativeHeading-Wrapped", (HEADING, HEADING), relative_heading_wrapped),),
    e.ApparentHeading: (Equation("O-ApparentHeading-Wrapped", (ORIENTED_POINT, VECTOR), apparent_heading_wrapped),),
}
"""The equations of differences of headings under `angle=wrapped`."""

EQUATIONS = {**operators.EQUATIONS, **OPERATORS}
REWRITINGS = {**operators.REWRITINGS, **OPERATOR_REWRITINGS, **specifiers.REWRITINGS, **SPECIFIER_REWRITINGS}
FORMS = {**specifiers.FORMS, **SPECIFIERS}


def equations_of(node: Node, oriented_offset: str, angle: str) -> tuple[Equation, ...]:
    """The equations among which the kinds of the operands choose; `oriented_offset` and `angle` are the alternatives of these readings."""
    if angle == "wrapped" and type(node) in WRAPPED:
        return WRAPPED[type(node)]
    return operators.OFFSET_BY[oriented_offset] if isinstance(node, e.OffsetBy) else EQUATIONS[type(node)][1]


def forms_of(node: Node, offset_by: str, amounts: str, heading: str, dialect: str) -> tuple[Form, ...]:
    """The forms among which the kinds of the arguments choose, under readings `offset-by`, `offset-amounts` and `offset-heading`.

    In dialect `scenic-3` a vector can be what an object is on.
    """
    either = amounts == "either"
    if heading == "ego" and type(node) in ORIENTED_OFFSETS:
        return ORIENTED_OFFSETS[type(node)]
    if isinstance(node, q.BesideSpecifier):
        return specifiers.BESIDE[node.side] + (BESIDE[node.side] if either else ())
    if isinstance(node, q.OffsetBySpecifier):
        return specifiers.OFFSET_BY[offset_by]
    if isinstance(node, q.InSpecifier) and node.keyword == "on" and dialect == "scenic-3":
        return (*FORMS[type(node)][1], ON_VECTOR)
    return FORMS[type(node)][1] + ((BEYOND,) if either and isinstance(node, q.BeyondSpecifier) else ())
