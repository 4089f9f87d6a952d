"""Distributions with values in an interval, and distributions of distributions."""

from __future__ import annotations

from math import ceil, floor

from ...semantics.syntax import Expression
from ...semantics.syntax import python_expressions as p
from . import scalars
from .draft import Draft, Option, first_that_works
from .tree import call, constant, name, number, operation


def distribution(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """A draw with values in [low, high]; None if it cannot be afforded."""
    options: list[Option] = [(3, lambda: uniform(draft, low, high, depth)), (2, lambda: discrete(draft, low, high, depth))]
    if draft.allows("released") and high - low >= 1:
        options.append((2, lambda: whole(draft, low, high)))
    if not draft.settings.finite:
        options += [(5, lambda: interval(draft, low, high, depth)), (2, lambda: truncated(draft, low, high)), (1, lambda: normal(draft, low, high))]
    elif draft.choices.chance(0.05):
        return point_mass(draft, low, high)
    return draft.choices.weighted(options)()


def inner(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """A value or parameter of a distribution, which may itself be drawn."""
    if depth > 0 and draft.allows("nested") and draft.choices.chance(0.4):
        return scalars.scalar(draft, low, high, depth - 1)
    return scalars.scalar_literal(draft, low, high)


def uniform(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """`Uniform(a, b)`, or `Uniform(*list)`."""
    lists = [v for v in draft.known("list") if low <= v.low and v.high <= high]
    if lists and draft.choices.chance(0.3):
        chosen = draft.choices.pick(lists)
        return call("Uniform", p.Starred(value=name(chosen.name))) if draft.afford(chosen.most) else None
    count = draft.choices.integer(2, 3)
    if not draft.afford(count):
        return None
    return call("Uniform", *(inner(draft, low, high, depth) for _ in range(count)))


def whole(draft: Draft, low: float, high: float) -> Expression | None:
    """`DiscreteRange(a, b)`."""
    first = ceil(low)
    last = min(floor(high), first + draft.choices.integer(0, 2))
    return call("DiscreteRange", number(first), number(last)) if draft.afford(last - first + 1) else None


def discrete(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """`Discrete({a: 1, b: 2})`; the weights need not add up to 1."""
    count = draft.choices.integer(2, 3)
    if not draft.afford(count):
        return None
    values = [inner(draft, low, high, depth) for _ in range(count)]
    return call("Discrete", p.DictDisplay(items=tuple((value, weight(draft)) for value in values)))


def weight(draft: Draft) -> Expression:
    """A weight: a number, or one that is computed."""
    if draft.allows("nested") and draft.choices.chance(0.2):
        with draft.without_randomness():
            return operation(scalars.scalar(draft, 0, 2, 0), "+", number(1))
    return number(draft.choices.pick([1, 2, 3, 0.5, 0.25]))


def halves(draft: Draft, low: float, high: float, depth: int) -> tuple[Expression, Expression]:
    """Two parameters in order; random ones only if the program may chain draws."""
    middle = scalars.literal_value(draft, low, high)
    if depth > 0 and draft.allows("chained_draws"):
        return scalars.scalar(draft, low, middle, depth - 1), scalars.scalar(draft, middle, high, depth - 1)
    return scalars.scalar_literal(draft, low, middle), scalars.scalar_literal(draft, middle, high)


def interval(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`Range(a, b)`."""
    return call("Range", *halves(draft, low, high, depth))


def truncated(draft: Draft, low: float, high: float) -> Expression:
    """`TruncatedNormal(mean, stdDev, low, high)`; the mean may lie outside of the window."""
    first = scalars.literal_value(draft, low, (low + high) / 2)
    last = scalars.literal_value(draft, (low + high) / 2, high)
    if first >= last:
        return call("Range", number(first), number(first))
    mean = draft.choices.pick([(first + last) / 2, first, last + 1])
    return call("TruncatedNormal", number(mean), number(draft.choices.pick([0.5, 1, 2])), number(first), number(last))


def normal(draft: Draft, low: float, high: float) -> Expression:
    """`min(max(Normal(mean, stdDev), low), high)`: an atom at each end."""
    mean, deviation = scalars.scalar_literal(draft, low, high), number(draft.choices.pick([1, 0.5, 0]))
    return call("min", call("max", call("Normal", mean, deviation), number(low)), number(high))


def point_mass(draft: Draft, low: float, high: float) -> Expression:
    """A continuous distribution of zero width: finite as well."""
    value = scalars.scalar_literal(draft, low, high)
    return call("Range", value, value) if draft.choices.chance(0.5) else call("Normal", value, constant(0))


def resampled(draft: Draft, low: float, high: float) -> Expression | None:
    """`resample(x)`."""
    fitting = [v for v in draft.known("scalar") if v.ways and low <= v.low and v.high <= high]
    if not fitting:
        return None
    chosen = draft.choices.pick(fitting)
    return call("resample", name(chosen.name)) if draft.afford(chosen.ways) else None


def ways_of(node: Expression) -> int:
    """The number of values of a draw, if the expression is one; 0 for any other expression."""
    match node:
        case p.Call(function=p.Name(name="Uniform"), arguments=arguments) if not any(isinstance(a, p.Starred) for a in arguments):
            return len(arguments)
        case p.Call(function=p.Name(name="Discrete"), arguments=(p.DictDisplay(items=items),)):
            return len(items)
        case p.Call(function=p.Name(name="DiscreteRange")):
            return 3
        case p.Call(function=p.Name(name="Range" | "TruncatedNormal" | "Normal")):
            return 1
        case _:
            return 0


def choice(draft: Draft, options: list[Option], count: int = 2) -> Expression | None:
    """`Uniform` over values of any kind, of which `options` can write one."""
    if not (draft.may_draw() and draft.afford(count)):
        return None
    return call("Uniform", *(first_that_works(draft, options) for _ in range(count)))
