"""The graph of a program: what is computed from the numbers of its draw sites, and which conditions a run must meet, in order.

A node is a function of other nodes and of constants; `kind` says what its column holds: floats, truth values, whole numbers that
choose among values, or anything at all ("object"). An event is a node that decides what becomes of a run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np

from ...semantics.machine.outcome import Requirement
from ...semantics.space.numeric_functions import arc_tangent
from ...semantics.space.regions import Region
from ...semantics.space.vectors import Vector
from ...semantics.store.budget import Budget

Kind = Literal["float", "bool", "int", "object"]
Bounds = tuple[float, float]


@dataclass(eq=False, slots=True)
class GraphNode:
    """`function(*arguments)`; `example` is its value in the run that was traced, `bounds` hold in all (None if not known, or if NaN may be)."""

    number: int
    function: object
    arguments: tuple[object, ...]
    kind: Kind
    example: object
    bounds: Bounds | None = None


@dataclass(frozen=True, slots=True)
class Site:
    """The `index`-th number of a draw site in [0, 1); `per_scene` if it is the same in all attempts at a scene."""

    address: tuple[int, ...]
    index: int
    per_scene: bool


@dataclass(frozen=True, eq=False, slots=True)
class Lookup:
    """The element of a constant array at the position that is the argument."""

    values: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class Search:
    """How many of some increasing numbers are at most the argument."""

    cumulative: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class SearchPart:
    """Search(k, x): the position in `values` of the first number of part k that is greater than x.

    Part k is values[starts[k] : starts[k + 1]]; its numbers increase, and the last one is infinite.
    """

    values: np.ndarray
    starts: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class ItemOf:
    """ItemOf(k, x): the number items[starts[k] + int(x)] of an item of container k."""

    items: np.ndarray
    starts: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class HasValue:
    """HasValue(k) = k, an event of kind "call" that decides runs by tables over k.

    Runs with rejected[k] are rejected, by the requirement reasons[k]; runs with left[k] are left to the interpreter.
    """

    rejected: np.ndarray
    left: np.ndarray
    reasons: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class PositionOf:
    """PositionOf(object): its position among `values`, found by identity; `positions` maps `id` to position."""

    values: tuple[object, ...]
    positions: dict[int, int]


class AsFloat:
    """Truth values or whole numbers as floats."""


@dataclass(frozen=True, slots=True)
class Macro:
    """A function of numbers and vectors that works on columns; `shape` says how many of the arguments each of its own takes."""

    function: Callable[..., object]
    shape: tuple[int, ...]

    def call(self, values: Sequence[object]) -> object:
        """The function of these numbers, the ones of a vector following each other."""
        rest = iter(values)
        return self.function(*(next(rest) if n == 1 else Vector(next(rest), next(rest)) for n in self.shape))  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class Crowd:
    """Whether any two of many boxes meet, as closed or as open sets; the arguments are the numbers of each box (`crowds.crowd_meets`)."""

    closed: bool


@dataclass(frozen=True, eq=False, slots=True)
class RowCall:
    """A Python function, called for one row after the other; `structure` holds its arguments, with symbols inside.

    `result` is the type that every row must give, or None where that is `optional`; else, or if an exception is raised, the row is left
    to the interpreter. With `converts`, numbers are made floats first. Functions of the program that it calls pay from `budget`, which is
    that of one row. If there are values `among` which every row's must be, these are their identities. `kept` are results with
    the values that they are of, by the identities of these.
    """

    function: Callable[..., object]
    structure: tuple[object, ...]
    keywords: dict[str, object]
    result: type
    converts: bool
    text: str
    budget: Budget
    optional: bool = False
    among: frozenset[int] = frozenset()
    kept: dict[object, tuple[list[object], object]] = field(default_factory=dict)

    def gives(self, value: object) -> bool:
        """Whether a row may have this value. Where the run that was traced has None, nothing was done that depends on what others have."""
        if self.among:
            return id(value) in self.among
        return type(value) is self.result or (self.optional and (value is None or self.result is type(None)))


@dataclass(frozen=True, eq=False, slots=True)
class RowDraw:
    """A draw whose map takes no fixed number of uniform numbers: done row by row from the stream of its site."""

    distribution: object
    address: tuple[int, ...]
    per_scene: bool


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """An attribute of the object that is the argument."""

    name: str


class PartialRun(NamedTuple):
    """A part of the run, until the stack is `end`, that happens only in the runs in which the truth of
    `condition` is `expected`.
    """

    condition: GraphNode
    expected: bool
    end: object


class GraphEvent(NamedTuple):
    """An event that decides a run, in the order of the program.

    "require": the run is rejected unless `node` is `expected`. "guard": the trace speaks for the run only if
    `node` is `expected`. "call": a row-by-row node, whose failures are the run's. None of them counts where
    `condition`, a coin's node, is False. `guarded` says where a guard stands.
    """

    kind: Literal["require", "guard", "call"]
    node: GraphNode
    expected: bool = True
    requirement: Requirement | None = None
    condition: GraphNode | None = None
    guarded: Requirement | None = None


@dataclass
class Graph:
    """Nodes in the order in which they were made, events, what is drawn: points by address (region, point), probabilities of coins by node."""

    nodes: list[GraphNode] = field(default_factory=list)
    events: list[GraphEvent] = field(default_factory=list)
    points: dict[tuple[int, ...], tuple[Region, object]] = field(default_factory=dict)
    coins: dict[int, float] = field(default_factory=dict)


def bounds_of(function: object, arguments: tuple[object, ...]) -> Bounds | None:
    """Bounds of a result, from those of the arguments; sound in floating point, since the operations are monotone there too."""
    known = [a.bounds if isinstance(a, GraphNode) else _constant_bounds(a) for a in arguments]
    if any(b is None for b in known):
        return None
    rule = _RULES.get(function)  # type: ignore[call-overload]
    if rule is None:
        return None
    with np.errstate(all="ignore"):
        low, high = rule(*known)
    return (float(low), float(high)) if math.isfinite(low) and math.isfinite(high) else None


def _constant_bounds(value: object) -> Bounds | None:
    if isinstance(value, (bool, int, float, np.floating)) and math.isfinite(value):
        return float(value), float(value)
    return None


def _times(a: Bounds, b: Bounds) -> Bounds:
    products = [x * y for x in a for y in b]
    return min(products), max(products)


def _quotient_bounds(a: Bounds, b: Bounds) -> Bounds:
    if b[0] <= 0 <= b[1]:
        return -math.inf, math.inf
    quotients = [x / y for x in a for y in b]
    return min(quotients), max(quotients)


def _absolute(a: Bounds) -> Bounds:
    return (0.0 if a[0] <= 0 <= a[1] else min(abs(a[0]), abs(a[1])), max(abs(a[0]), abs(a[1])))


def _length(a: Bounds, b: Bounds) -> Bounds:
    """The nearest and the farthest point of a box, with room for the last digits, which hypotenuses may have wrong."""
    near, far = zip(_absolute(a), _absolute(b), strict=True)
    return math.hypot(*near) * (1 - 2.0**-50), math.hypot(*far) * (1 + 2.0**-50)


_RULES: dict[object, Callable[..., Bounds]] = {
    np.add: lambda a, b: (a[0] + b[0], a[1] + b[1]),
    np.subtract: lambda a, b: (a[0] - b[1], a[1] - b[0]),
    np.multiply: _times,
    np.true_divide: _quotient_bounds,
    np.negative: lambda a: (-a[1], -a[0]),
    np.positive: lambda a: a,
    np.absolute: _absolute,
    np.sqrt: lambda a: (math.sqrt(a[0]), math.sqrt(a[1])) if a[0] >= 0 else (-math.inf, math.inf),
    np.sin: lambda a: (-1.0, 1.0),
    np.cos: lambda a: (-1.0, 1.0),
    arc_tangent: lambda a, b: (-math.pi, math.pi),
    np.hypot: _length,
    np.maximum: lambda a, b: (max(a[0], b[0]), max(a[1], b[1])),
    np.minimum: lambda a, b: (min(a[0], b[0]), min(a[1], b[1])),
    np.where: lambda condition, a, b: (min(a[0], b[0]), max(a[1], b[1])),
}


OPERATORS: Mapping[object, str] = {
    np.less: "<", np.less_equal: "<=", np.greater: ">", np.greater_equal: ">=", np.equal: "==", np.not_equal: "!=",
}


def explain_decided_comparison(function: object, arguments: tuple[object, ...]) -> str:
    """The operator of a comparison that `decide_comparison` has decided, and what keeps its two sides apart, in words: bounds need not be reached."""
    known = [a.bounds if isinstance(a, GraphNode) else _constant_bounds(a) for a in arguments]
    left, right = ((math.inf, math.inf) if found is None else found for found in known)
    left_is_less = left[1] <= right[0]

    def side(found: Bounds, less: bool) -> str:
        if found[0] == math.inf:
            return "is infinite"
        if found[0] == found[1]:
            return f"is {found[0]:.6g}"
        return f"is never more than {found[1]:.6g}" if less else f"is never less than {found[0]:.6g}"

    return f"{OPERATORS[function]}: its left side {side(left, left_is_less)}, and its right side {side(right, not left_is_less)}"


def decide_comparison(function: object, arguments: tuple[object, ...]) -> bool | None:
    """The result of a comparison that is the same for all values within the bounds of the arguments, or None."""
    if function not in (np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal):
        return None
    left, right = (a.bounds if isinstance(a, GraphNode) else _constant_bounds(a) for a in arguments)
    infinite = arguments[1] == math.inf if not isinstance(arguments[1], GraphNode) else False
    if left is None or (right is None and not infinite):
        return None
    low, high = (math.inf, math.inf) if right is None else right
    below, above = left[1] < low, left[0] > high
    not_above, not_below = left[1] <= low, left[0] >= high
    true, false = {
        np.less: (below, not_below), np.less_equal: (not_above, above), np.greater: (above, not_above), np.greater_equal: (not_below, below),
        np.equal: (False, below or above), np.not_equal: (below or above, False),
    }[function]  # type: ignore[index]
    return True if true else False if false else None
