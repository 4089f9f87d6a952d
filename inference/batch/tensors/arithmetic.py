"""Arithmetic on tensors that knows how far its results may be from those of the columns.

Sums, products and quotients are rounded alike by torch and NumPy (IEEE 754), so that they are the same bits as long as their operands are.
Sines, square roots, logarithms and so on differ in the last bits, and what is computed from them differs by a bound that is computed with
it: a running error analysis, one bound for all rows. Where that bound could decide something (a comparison, a cell, a position), or where
an operation blows it up, the row is doubtful: the columns do it.

In rows that are not doubtful there is a NaN exactly where the columns have one.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import torch
from scipy import special
from torch import Tensor

from ....semantics.space.numeric import arc_tangent, exponential, exponential_less_one, logarithm, logarithm_of_one_more

ROUNDING = 1e-9
"""No number of a scene is further than this from that of the columns (or than this share of it, if it is larger than 1)."""
LIMIT, UNUSUAL, LITTLE = ROUNDING / 8, 1000.0, 1e-13
"""What an operation may blow rounding up to, at most; and, since the bound is that of all rows, how many times what it does in a typical one,
unless that is less than little.
"""
STEP = 2.0**-51
"""More than what two roundings of one result can differ by, as a share of it."""
LIBRARY = 2.0**-48
"""More than what two libraries differ by in a function, as a share of the largest result, or of 1."""
UNDERFLOW = -700.0
"""The exponential of less than this is no normal number."""


class Rounded(NamedTuple):
    """A column as a tensor, (rows,) or () for a constant: in rows that are not doubtful, `error` is the most by which it differs from NumPy's
    column (0: the same bits), and `largest` the largest finite absolute value.
    """

    values: Tensor
    error: float
    largest: float


class Doubts:
    """Which rows rounding might decide, (rows,)."""

    def __init__(self, rows: int, device: torch.device) -> None:
        self.rows = torch.zeros(rows, dtype=torch.bool, device=device)

    def add(self, rows: Tensor) -> None:
        """These as well, of which a mask is given."""
        self.rows |= rows

    def keep(self, kept: Tensor) -> None:
        """Leave out all rows but these, of which the numbers are given."""
        self.rows = self.rows.index_select(0, kept)


Rule = Callable[..., Rounded]


def times(a: float, b: float) -> float:
    """A product of bounds, in which 0 wins over infinity."""
    return a * b if a and b else 0.0


def most(values: Tensor, rows: Tensor) -> float:
    """The largest of some values that are not negative, by a mask of rows; 0 if there are none."""
    return float(torch.where(rows, values, 0.0).max()) if values.numel() else 0.0


def largest_of(values: Tensor) -> float:
    """The largest finite absolute value."""
    plain = values.detach().abs()
    return most(plain, plain < math.inf)


def settled(doubts: Doubts, values: Tensor, error: Tensor) -> Rounded:
    """A result with an error for each row: rows in which it is large are doubtful."""
    plain = values.detach().abs()
    typical = error.nanmedian() if error.numel() else error.new_zeros(())
    limit = torch.minimum(LIMIT * plain.clamp(min=1.0), (UNUSUAL * typical).clamp(min=LITTLE))
    doubts.add(error > limit)
    fine = error <= limit
    return Rounded(values, most(error, fine), most(plain, fine & (plain < math.inf)))


# Rules: those of an operation take doubts and the operands


def added(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """A sum or a difference."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        error, largest = a.error + b.error, a.largest + b.largest
        return Rounded(operation(a.values, b.values), error and error + STEP * largest, largest)

    return rule


def multiplied(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
    """A product."""
    error = times(a.largest, b.error) + times(b.largest, a.error) + times(a.error, b.error)
    largest = times(a.largest, b.largest)
    return Rounded(a.values * b.values, error and error + STEP * largest, largest)


def divided(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
    """A quotient: doubtful where the divisor might be 0."""
    values = a.values / b.values
    if not (a.error or b.error):
        return Rounded(values, 0.0, largest_of(values))
    if not (b.values.ndim or b.error) and b.largest:
        return Rounded(values, (a.error + STEP * a.largest) / b.largest, a.largest / b.largest)
    plain, divisor = values.detach().abs(), b.values.detach().abs()
    doubts.add(divisor <= b.error)
    return settled(doubts, values, (a.error + plain * b.error) / (divisor - b.error) + STEP * plain)


def remainder(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """What is left of a division: doubtful near the multiples of the divisor."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        values = operation(a.values, b.values)
        if not (a.error or b.error):
            return Rounded(values, 0.0, b.largest)
        left, divisor = values.detach().abs(), b.values.detach().abs()
        error = a.error + b.error * (a.values.detach().abs() / divisor + 1) + STEP * divisor
        doubts.add((left <= error) | (divisor - left <= error))
        return settled(doubts, values, error)

    return rule


def unchanged(operation: Callable[[Tensor], Tensor]) -> Rule:
    """What moves a number by as much as its operand moves."""
    return lambda doubts, a: Rounded(operation(a.values), a.error, a.largest)


def extreme(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """The smaller or the larger of two numbers."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        finite = [v for v in (a.largest, b.largest) if v < math.inf]
        return Rounded(operation(a.values, b.values), max(a.error, b.error), max(finite, default=math.inf))

    return rule


def circular(operation: Callable[[Tensor], Tensor]) -> Rule:
    """A sine or a cosine."""
    return lambda doubts, a: Rounded(operation(a.values), min(a.error, 2.0) + LIBRARY, 1.0)


def monotone(operation: Callable[[Tensor], Tensor]) -> Rule:
    """A monotone function: its result lies between those of the ends of what its operand might be."""

    def rule(doubts: Doubts, a: Rounded) -> Rounded:
        values = operation(a.values)
        if not a.error:
            largest = largest_of(values)
            return Rounded(values, LIBRARY * max(largest, 1.0), largest)
        plain, operand = values.detach(), a.values.detach()
        low, high = operation(operand - a.error), operation(operand + a.error)
        doubts.add(low.isnan() != high.isnan())
        spread = torch.maximum((high - plain).abs(), (low - plain).abs())
        found = settled(doubts, values, spread)
        return found._replace(error=found.error + 4 * LIBRARY * max(found.largest, 1.0))

    return rule


def of_c(operation: Callable[[Tensor], Tensor]) -> Callable[[Tensor], Tensor]:
    """A function as `numeric.Elementary` has it: NaN where Python's own raises an error, at poles and where the result is too large."""

    def function(a: Tensor) -> Tensor:
        values = operation(a)
        return torch.where(values.isinf() & a.isfinite(), torch.nan, values)

    return function


def ndtri_exp(y: Tensor) -> Tensor:
    """The number below which a standard normal one is with probability exp(y)."""
    upper = -torch.special.ndtri(-torch.expm1(torch.where(y > -0.5, y, -1.0)))
    return torch.where(y > -0.5, upper, torch.special.ndtri(torch.exp(y)))


def normal_quantile(doubts: Doubts, a: Rounded) -> Rounded:
    """`ndtri_exp`: doubtful where the probability is no normal number."""
    doubts.add(a.values.detach() < UNDERFLOW)
    return monotone(ndtri_exp)(doubts, a)


def hypotenuse(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
    """The length of a vector."""
    largest = a.largest + b.largest
    return Rounded(torch.hypot(a.values, b.values), a.error + b.error + LIBRARY * largest, largest)


def angle(doubts: Doubts, y: Rounded, x: Rounded) -> Rounded:
    """The arctangent of a vector: doubtful where it might be 0 or change its sign at π."""
    values = torch.atan2(y.values, x.values)
    error = y.error + x.error
    if not error:
        return Rounded(values, LIBRARY * math.pi, math.pi)
    across, along = y.values.detach(), x.values.detach()
    away = torch.hypot(across, along)
    doubts.add(away <= 2 * error)
    if y.error:
        doubts.add((across.abs() <= y.error) & (along < x.error))
    found = settled(doubts, values, 2 * error / (away - error))
    return found._replace(error=found.error + LIBRARY * math.pi)


def compared(operation: Callable[[Tensor, Tensor], Tensor]) -> Rule:
    """A comparison: doubtful where the sides are as near as rounding."""

    def rule(doubts: Doubts, a: Rounded, b: Rounded) -> Rounded:
        error = a.error + b.error
        if error:
            doubts.add((a.values.detach() - b.values.detach()).abs() <= error)
        return truth(operation(a.values, b.values))

    return rule


def logical(operation: Callable[..., Tensor]) -> Rule:
    """An operation on truth values."""
    return lambda doubts, *operands: truth(operation(*(o.values for o in operands)))


def truth(values: Tensor) -> Rounded:
    """Truth values, which are those of the columns."""
    return Rounded(values, 0.0, 1.0)


def chosen(doubts: Doubts, condition: Rounded, then: Rounded, otherwise: Rounded) -> Rounded:
    """`then` where the condition holds, else `otherwise`."""
    values = torch.where(condition.values, then.values, otherwise.values)
    return Rounded(values, max(then.error, otherwise.error), max(then.largest, otherwise.largest))


def position(doubts: Doubts, a: Rounded) -> Rounded:
    """A float that is a whole number, or is cut off to one."""
    if a.error:
        doubts.add((a.values - a.values.round()).abs() <= a.error)
    return Rounded(a.values.detach().to(torch.int64), 0.0, a.largest)


def as_float(doubts: Doubts, a: Rounded) -> Rounded:
    """Truth values or whole numbers as floats."""
    return Rounded(a.values.to(torch.float64), 0.0, a.largest)


def on_floats(rule: Rule) -> Rule:
    """A rule for numbers, with truth values taken for 0 and 1."""
    return lambda doubts, *operands: rule(doubts, *(as_float(doubts, o) for o in operands))


def searched(cumulative: Tensor, doubts: Doubts, a: Rounded) -> Rounded:
    """How many of the increasing numbers are at most the operand."""
    values = a.values.detach().contiguous()
    found = torch.searchsorted(cumulative, values, right=True)
    if a.error:
        ends = (torch.searchsorted(cumulative, values + by, right=True) for by in (-a.error, a.error))
        doubts.add(operator.ne(*ends))
    return Rounded(found, 0.0, float(len(cumulative)))


COMPARISONS: dict[object, Rule] = {
    np.less: compared(torch.lt), np.less_equal: compared(torch.le), np.greater: compared(torch.gt), np.greater_equal: compared(torch.ge),
    np.equal: compared(torch.eq), np.not_equal: compared(torch.ne),
}  # fmt: skip
LOGICAL: dict[object, Rule] = {
    np.logical_and: logical(torch.logical_and), np.logical_or: logical(torch.logical_or), np.logical_xor: logical(torch.logical_xor),
    np.logical_not: logical(torch.logical_not),
}  # fmt: skip
NUMERIC: dict[object, Rule] = {
    np.add: added(torch.add), np.subtract: added(torch.sub), np.multiply: multiplied, np.true_divide: divided,
    np.mod: remainder(torch.remainder), np.fmod: remainder(torch.fmod),
    np.negative: unchanged(torch.neg), np.positive: unchanged(torch.clone), np.absolute: unchanged(torch.abs),
    np.minimum: extreme(torch.minimum), np.maximum: extreme(torch.maximum),
    np.sqrt: monotone(torch.sqrt), np.sin: circular(torch.sin), np.cos: circular(torch.cos), np.hypot: hypotenuse, arc_tangent: angle,
    exponential: monotone(of_c(torch.exp)), exponential_less_one: monotone(of_c(torch.expm1)),
    logarithm: monotone(of_c(torch.log)), logarithm_of_one_more: monotone(of_c(torch.log1p)),
    special.ndtri: monotone(torch.special.ndtri), special.log_ndtr: monotone(torch.special.log_ndtr),
    special.ndtri_exp: normal_quantile,
}  # fmt: skip
"""The operations on numbers, by what stands for them in a graph."""
RULES: dict[object, Rule] = {**NUMERIC, **COMPARISONS, **LOGICAL}

__all__ = ["NUMERIC", "ROUNDING", "RULES", "Doubts", "Rounded", "Rule", "as_float", "chosen", "largest_of", "on_floats", "position", "searched"]
