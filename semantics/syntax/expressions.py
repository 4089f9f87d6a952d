"""Scenic's own expressions: Figures "Simplified Scenic grammar" and "Operators by result type" of the paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .nodes import Expression, Specifier

Side = Literal["front", "back", "left", "right", "front left", "front right", "back left", "back right"]


@dataclass(frozen=True, slots=True, kw_only=True)
class VectorOf(Expression):
    """`X @ Y`, the Smalltalk-like form of the vector `(X, Y)`."""

    x: Expression
    y: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class IntervalOrPair(Expression):
    """`(low, high)` in dialect `pldi19`: uniform on an interval if both are scalars (reading `intervals`), else a pair."""

    low: Expression
    high: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Degrees(Expression):
    """`E deg`."""

    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Seconds(Expression):
    """`E seconds` (reading `time-unit`)."""

    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativeHeading(Expression):
    """`relative heading of H [from H]`."""

    heading: Expression
    origin: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ApparentHeading(Expression):
    """`apparent heading of OP [from V]`."""

    oriented_point: Expression
    origin: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Distance(Expression):
    """`distance [from V] to V` (`from` and `to` in either order; `distance from V` alone goes to ego)."""

    origin: Expression | None = None
    target: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DistancePast(Expression):
    """`distance [of OP] past V`."""

    vector: Expression
    oriented_point: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Angle(Expression):
    """`angle [from V] to V` (either order; `angle from V` alone goes to ego)."""

    origin: Expression | None = None
    target: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CanSee(Expression):
    """`P can see V` or `P can see O`."""

    viewer: Expression
    target: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldAt(Expression):
    """`F at V`."""

    field: Expression
    vector: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativeTo(Expression):
    """`X relative to Y` for headings, fields, vectors and oriented points."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class OffsetBy(Expression):
    """`V offset by V` or `OP offset by V`."""

    base: Expression
    offset: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class OffsetAlong(Expression):
    """`V offset along D by V`."""

    base: Expression
    direction: Expression
    offset: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativePosition(Expression):
    """`relative position of V [from V]`."""

    target: Expression
    origin: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NotVisible(Expression):
    """`not visible R`, whose `viewer` is ego, once the rules have said so, and `R not visible from P`."""

    region: Expression
    viewer: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Intersects(Expression):
    """`X intersects Y`, of objects and regions."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Visible(Expression):
    """`visible R`."""

    region: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class VisibleFrom(Expression):
    """`R visible from P`."""

    region: Expression
    viewer: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Follow(Expression):
    """`follow F [from V] for S`."""

    field: Expression
    distance: Expression
    origin: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SideOf(Expression):
    """`front of O`, `back left of O`, ..."""

    side: Side
    object: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectDefinition(Expression):
    """`class specifier, ..., specifier`; with no specifier it is a class name alone in the place of an object."""

    class_: Expression
    specifiers: tuple[Specifier, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectOrValue(Expression):
    """A (dotted) name where an object may stand: an object definition if it names a Scenic class, else its value.

    The parser puts it around a name that is a whole statement, the right-hand side of an assignment, a class
    property's default or the value of `return` (reading `bare-class`).
    """

    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectOrOperator(Expression):
    """`E at X ...`, `E offset by X ...`, `E in X`, `E visible from X`: what `E` is decides.

    `head` is the (dotted) name at the left end. If its value is a Scenic class the whole is `as_object`, otherwise
    `as_operator`; both trees cover the same tokens.
    """

    head: Expression
    as_object: ObjectDefinition
    as_operator: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class InInitialScenario(Expression):
    """`in initial scenario`."""
