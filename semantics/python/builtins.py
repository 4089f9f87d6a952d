"""The names that every program starts with: Table "Distributions", the built-in classes, regions, and Python's builtins."""

from __future__ import annotations

import builtins as python
import math
from collections.abc import Mapping

from ..kernel.budget import Budget
from ..kernel.classes import BUILT_IN_CLASSES
from ..kernel.errors import GUARD_VIOLATIONS
from ..kernel.queries import Clock
from ..kernel.scopes import Scope
from ..kernel.values import Constructor, Entries, Pairs, plain, unwrap
from ..space import regions
from ..space.distributions import BadParameters, Discrete, Normal, Range, TruncatedNormal, Uniform
from ..space.fields import PolygonalVectorField, VectorField
from ..space.vectors import Vector
from .library import BUILTIN, bound
from .specials import SPECIAL_VALUES


def _uniform(*values: object) -> Uniform:
    return Uniform(values)


def _discrete(weights: object) -> Discrete:
    weights = plain(weights)
    if not isinstance(weights, (Mapping, Pairs)):
        raise BadParameters("Discrete", "weights", "must be given as {value: weight, ...}")
    pairs = weights.pairs if isinstance(weights, (Entries, Pairs)) else weights.items()
    return Discrete(tuple((value, unwrap(weight)[0]) for value, weight in pairs))  # pyright: ignore[reportArgumentType]: Discrete checks


CONSTRUCTORS: Mapping[str, Constructor] = {
    "Range": Constructor("Range", Range, keeps_values=False, takes="low, high"),
    "Uniform": Constructor("Uniform", _uniform, keeps_values=True, takes="value, ..., value"),
    "Discrete": Constructor("Discrete", _discrete, keeps_values=True, takes="{value: weight, ...}"),
    "Normal": Constructor("Normal", Normal, keeps_values=False, takes="mean, stdDev"),
    "TruncatedNormal": Constructor("TruncatedNormal", TruncatedNormal, keeps_values=False, takes="mean, stdDev, low, high"),
}

GEOMETRY: Mapping[str, object] = {
    "everywhere": regions.everywhere,
    "nowhere": regions.nowhere,
    **{
        c.__name__: c
        for c in (
            regions.CircularRegion, regions.SectorRegion, regions.RectangularRegion, regions.PolygonalRegion, regions.PolylineRegion,
            regions.PointSetRegion, regions.Workspace, VectorField, PolygonalVectorField, Vector,
        )
    },
}

HOST: Mapping[str, object] = {**BUILTIN, "sin": math.sin, "cos": math.cos, "hypot": math.hypot, "NotImplemented": NotImplemented}

EXCEPTIONS: Mapping[str, object] = {
    name: value
    for name, value in vars(python).items()
    if isinstance(value, type) and issubclass(value, Exception) and not issubclass(value, Warning)
} | GUARD_VIOLATIONS

BUILTINS: Mapping[str, object] = {**HOST, **EXCEPTIONS, **GEOMETRY, **BUILT_IN_CLASSES, **CONSTRUCTORS, **SPECIAL_VALUES, "simulation": Clock()}


def builtin_scope(budget: Budget) -> Scope:
    """The outermost scope of a run."""
    return Scope("builtins", budget.versions, bindings={name: bound(value, budget) for name, value in BUILTINS.items()})
