"""The names that every program starts with: Table "Distributions", the built-in classes, regions, and Python's builtins."""

from __future__ import annotations

import builtins as python
import math
from collections.abc import Mapping
from operator import index

from ..machine.operand_kinds import is_scalar
from ..machine.values import Constructor, Entries, Pairs, unwrap, value_in_run
from ..machine.world_queries import Clock, Parameters
from ..space import regions
from ..space.distributions import BadParameters, Discrete, Normal, Range, TruncatedNormal, Uniform
from ..space.fields import PolygonalVectorField, VectorField
from ..space.numeric_functions import larger, smaller
from ..space.vectors import Vector
from ..store.budget import Budget
from ..store.built_in_classes import BUILT_IN_CLASSES
from ..store.errors import GUARD_VIOLATIONS
from ..store.scopes import Scope
from .builtin_rules import SPECIAL_VALUES
from .library import BUILTIN, bound
from .released_members import OPERATOR_FUNCTIONS, OperatorFunction


def _uniform(*values: object) -> Uniform:
    """One of the values, each as likely; one that stands twice is twice as likely.

    Example: `ego = Object with color Uniform('red', 'green')`
    """
    return Uniform(values)


def _discrete(opts: object) -> Discrete:
    """One of the values, each as likely as its weight says, which need not add up to 1.

    Example: `ego = Object with color Discrete({'red': 3, 'green': 1})`
    """
    weights = value_in_run(opts)
    if not isinstance(weights, (Mapping, Pairs)):
        raise BadParameters("Discrete", "weights", "must be given as {value: weight, ...}")
    pairs = weights.pairs if isinstance(weights, (Entries, Pairs)) else weights.items()
    return Discrete(tuple((value, unwrap(weight)[0]) for value, weight in pairs))  # pyright: ignore[reportArgumentType]: Discrete checks


def _options(opts: object) -> Uniform | Discrete:
    """The released implementations' `Options`: one of a list, or of a dictionary with weights.

    Example: `ego = Object with color Options(['red', 'green'])`
    """
    found = value_in_run(opts)
    if isinstance(found, (Mapping, Pairs)):
        return _discrete(found)
    if not isinstance(found, (list, tuple)):
        raise BadParameters("Options", "options", "must be given as [value, ...] or {value: weight, ...}")
    return Uniform(tuple(found))


def _between(low: object, high: object) -> Range:
    """The released implementations' `Range`: its bounds may stand in either order (reading `reversed-range`)."""
    if is_scalar(low) and is_scalar(high):
        low, high = smaller(low, high), larger(low, high)  # type: ignore[arg-type]
    return Range(low, high)  # type: ignore[arg-type]


def _discrete_range(low: object, high: object, weights: object = None) -> Uniform | Discrete:
    """The released implementations' `DiscreteRange`: a whole number from low to high, both included.

    Example: `ego = Object at DiscreteRange(1, 6) @ 0`
    """
    try:
        numbers = range(index(low), index(high) + 1)  # type: ignore[arg-type]
    except TypeError:
        raise BadParameters("DiscreteRange", "low, high", f"must be whole numbers, not {low!r}, {high!r}") from None
    if not 0 < len(numbers) <= MOST_NUMBERS:
        raise BadParameters("DiscreteRange", "low, high", f"must hold between 1 and {MOST_NUMBERS:,} numbers, not {low!r} to {high!r}")
    if weights is None:
        return Uniform(tuple(numbers))
    given = value_in_run(weights)
    if not isinstance(given, (list, tuple)) or len(given) != len(numbers):
        raise BadParameters("DiscreteRange", "weights", f"must be a list of {len(numbers)} numbers")
    return Discrete(tuple(zip(numbers, (unwrap(w)[0] for w in given), strict=True)))  # pyright: ignore[reportArgumentType]: Discrete checks


MOST_NUMBERS = 100_000
DEVIATION = {"stddev": "stdDev"}

CONSTRUCTORS: Mapping[str, Constructor] = {
    "Range": Constructor("Range", Range, keeps_values=False, takes="low, high", unordered=_between),
    "Uniform": Constructor("Uniform", _uniform, keeps_values=True, takes="value, ..., value"),
    "Discrete": Constructor("Discrete", _discrete, keeps_values=True, takes="{value: weight, ...}"),
    "Normal": Constructor("Normal", Normal, keeps_values=False, takes="mean, stdDev", renamed=DEVIATION),
    "TruncatedNormal": Constructor("TruncatedNormal", TruncatedNormal, keeps_values=False, takes="mean, stdDev, low, high", renamed=DEVIATION),
    # of the released implementations
    "DiscreteRange": Constructor("DiscreteRange", _discrete_range, keeps_values=False, takes="low, high, weights=None"),
    "Options": Constructor("Options", _options, keeps_values=True, takes="[value, ..., value]"),
    # its external parameters, which a sampler may steer: here as drawn from their priors
    "VerifaiRange": Constructor("VerifaiRange", Range, keeps_values=False, takes="low, high", unordered=_between),
    "VerifaiDiscreteRange": Constructor("VerifaiDiscreteRange", _discrete_range, keeps_values=False, takes="low, high, weights=None"),
    "VerifaiOptions": Constructor("VerifaiOptions", _options, keeps_values=True, takes="[value, ..., value]"),
}

GEOMETRY: Mapping[str, object] = {
    "everywhere": regions.everywhere,
    "nowhere": regions.nowhere,
    **{
        c.__name__: c
        for c in (
            regions.CircularRegion, regions.SectorRegion, regions.RectangularRegion, regions.PolygonalRegion, regions.PolylineRegion,
            regions.PointSetRegion, regions.Region, regions.Workspace, VectorField, PolygonalVectorField, Vector,
        )
    },
}

HOST: Mapping[str, object] = {**BUILTIN, "sin": math.sin, "cos": math.cos, "hypot": math.hypot, "NotImplemented": NotImplemented}

EXCEPTION_NAMES = (
    "Exception", "ArithmeticError", "AssertionError", "AttributeError", "BufferError", "EOFError", "ImportError", "LookupError",
    "MemoryError", "NameError", "OSError", "ReferenceError", "RuntimeError", "StopAsyncIteration", "StopIteration", "SyntaxError",
    "SystemError", "TypeError", "ValueError", "FloatingPointError", "OverflowError", "ZeroDivisionError", "BlockingIOError",
    "ChildProcessError", "ConnectionError", "FileExistsError", "FileNotFoundError", "InterruptedError", "IsADirectoryError",
    "NotADirectoryError", "PermissionError", "ProcessLookupError", "TimeoutError", "IndentationError", "IndexError", "KeyError",
    "ModuleNotFoundError", "NotImplementedError", "RecursionError", "UnboundLocalError", "UnicodeError", "BrokenPipeError",
    "ConnectionAbortedError", "ConnectionRefusedError", "ConnectionResetError", "TabError", "UnicodeDecodeError", "UnicodeEncodeError",
    "UnicodeTranslateError", "ExceptionGroup", "EnvironmentError", "IOError",
)  # fmt: skip
"""The exceptions of Python 3.11, so that the same names are known whatever Python runs the program: later ones have more."""

EXCEPTIONS: Mapping[str, object] = {name: vars(python)[name] for name in EXCEPTION_NAMES} | GUARD_VIOLATIONS

BUILTINS: Mapping[str, object] = {
    **HOST, **EXCEPTIONS, **GEOMETRY, **BUILT_IN_CLASSES, **CONSTRUCTORS, **SPECIAL_VALUES,
    "simulation": Clock(), "globalParameters": Parameters(),
}  # fmt: skip


OF_RELEASES: Mapping[str, object] = {name: OperatorFunction(name, rewrite) for name, rewrite in OPERATOR_FUNCTIONS.items()}
"""What the programs of the releases have besides, in their dialects alone."""


def builtin_scope(budget: Budget, *, released: bool = False) -> Scope:
    """The outermost scope of a run: of a program in the dialect of a release, if `released`."""
    known = {**BUILTINS, **OF_RELEASES} if released else BUILTINS
    return Scope("builtins", budget.versions, bindings={name: bound(value, budget) for name, value in known.items()})
