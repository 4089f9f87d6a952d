"""Specifiers: Tables "Specifiers for position" and "Specifiers for heading" of the paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .nodes import Expression, Specifier


@dataclass(frozen=True, slots=True, kw_only=True)
class WithSpecifier(Specifier):
    """`with property E`."""

    property: str
    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class AtSpecifier(Specifier):
    """`at V`."""

    vector: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class OffsetBySpecifier(Specifier):
    """`offset by V`."""

    offset: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class OffsetAlongSpecifier(Specifier):
    """`offset along D by V`."""

    direction: Expression
    offset: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class BesideSpecifier(Specifier):
    """`left of X [by S]`, `right of X [by S]`, `ahead of X [by S]`, `behind X [by S]`."""

    side: Literal["left", "right", "ahead", "behind"]
    reference: Expression
    gap: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class BeyondSpecifier(Specifier):
    """`beyond V by V [from V]`."""

    vector: Expression
    offset: Expression
    origin: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class VisibleSpecifier(Specifier):
    """`visible [from P]`."""

    viewer: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NotVisibleSpecifier(Specifier):
    """`not visible [from P]`; `within` is the region in which the point lies, the workspace."""

    viewer: Expression | None = None
    within: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ContainedInSpecifier(Specifier):
    """`contained in R`."""

    region: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class InSpecifier(Specifier):
    """`in R` or `on R`: one specifier with two spellings."""

    keyword: Literal["in", "on"]
    region: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingSpecifier(Specifier):
    """`following F [from V] for S`."""

    field: Expression
    distance: Expression
    origin: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FacingSpecifier(Specifier):
    """`facing H` or `facing F`."""

    direction: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class FacingTowardSpecifier(Specifier):
    """`facing toward V`."""

    vector: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class FacingAwayFromSpecifier(Specifier):
    """`facing away from V`."""

    vector: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class ApparentlyFacingSpecifier(Specifier):
    """`apparently facing H [from V]`."""

    heading: Expression
    origin: Expression | None = None
