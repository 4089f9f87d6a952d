"""Functions of numbers and truth values: of those of one scene, or of many at once.

The equations of the language are written once, with Python's operators and the functions below. Given floats they give the
value of one scene; given NumPy arrays those of many; given symbols (the batch backend makes them) the graph of what is
computed. All three give the same bits: sines, square roots and so on are NumPy's in each case.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from numbers import Real
from typing import Any, TypeVar

import numpy as np

from .symbol_seam import NotLifted, Symbol, symbol_in

Method = TypeVar("Method", bound=Callable[..., object])


def lift_method(result: type) -> Callable[[Method], Method]:
    """A method that is not made of liftable operations, such as a test on a polygon: given symbols, it becomes a single operation."""

    def decorate(method: Method) -> Method:
        @wraps(method)
        def wrapper(self: object, *arguments: object) -> object:
            symbol = symbol_in(arguments)
            return method(self, *arguments) if symbol is None else symbol.apply(wrapper, (self, *arguments), result)

        return wrapper  # type: ignore[return-value]

    return decorate


def macro(function: Method) -> Method:
    """A function of numbers and vectors that stands as one operation in a graph, though it is made of others: it is used often."""

    @wraps(function)
    def wrapper(*arguments: object) -> object:
        symbol = symbol_in(arguments)
        return function(*arguments) if symbol is None else symbol.apply(wrapper, arguments, bool)

    wrapper.is_macro = True  # type: ignore[attr-defined]
    return wrapper  # type: ignore[return-value]


def is_macro(function: Callable[..., object]) -> bool:
    """Whether the function was made by `macro`."""
    return getattr(function, "is_macro", False)


class Elementary:
    """A function of the C library on floats, arrays and symbols: NumPy's own differ from it in the last bit on some processors."""

    def __init__(self, function: Callable[..., float]) -> None:
        self.function = function
        self.__name__ = function.__name__

    def __call__(self, *values: Any) -> Any:
        symbol = symbol_in(values)
        if symbol is not None:
            return symbol.apply(self, values, float)
        if any(isinstance(v, np.ndarray) for v in values):
            columns = [column.tolist() for column in np.broadcast_arrays(*values)]
            return np.fromiter(map(self.safely, *columns), dtype=float, count=len(columns[0]))
        return self.function(*values)

    def safely(self, *values: float) -> float:
        """The function where it is defined; NaN elsewhere, which rows that are not used may be."""
        try:
            return self.function(*values)
        except (ValueError, OverflowError):
            return math.nan


arc_tangent = Elementary(math.atan2)
exponential = Elementary(math.exp)
exponential_less_one = Elementary(math.expm1)
logarithm = Elementary(math.log)
logarithm_of_one_more = Elementary(math.log1p)


def plain_float(value: Any) -> Any:
    """A NumPy scalar as a Python float; arrays and symbols as they are."""
    return value if isinstance(value, (np.ndarray, Symbol)) else float(value)


def to_floats(value: Any) -> Any:
    """`float(value)`; an array or a symbol as floats."""
    return value.number() if isinstance(value, Symbol) else value if isinstance(value, np.ndarray) else float(value)


def is_real(value: object) -> bool:
    """Whether the value is a number, or a symbol for numbers."""
    return isinstance(value, (Real, Symbol))


def is_truth(value: object) -> bool:
    """Whether the value is True or False, or a symbol for these."""
    if not isinstance(value, Symbol):
        return isinstance(value, bool)
    try:
        return value.always(is_truth)
    except NotLifted:
        return False


def is_one(value: object, kind: type) -> bool:
    """Whether the value is of the class, or a symbol, for values that are known when they are computed."""
    return isinstance(value, (kind, Symbol))


def may_be(expected: bool, truth: object) -> bool:
    """Whether a truth value is the expected one; a symbol may be, in some scenes."""
    return isinstance(truth, Symbol) or bool(truth) is expected


def is_met(condition: Any, requirement: object) -> bool:
    """Whether the condition of a requirement holds; on symbols, this very truth value decides about the requirement."""
    return condition.met(requirement) if isinstance(condition, Symbol) else bool(condition)


def is_needed(truth: Any, expected: bool, end: object) -> bool:
    """Whether `truth` is `expected`, so that what comes next is to be reduced, until the stack is `end`; on symbols, in the runs in which it is."""
    if isinstance(truth, Symbol):
        truth.where(expected, end)
        return True
    return truth is expected


def negation(condition: Any) -> Any:
    """`not condition`, for a truth value."""
    return ~condition if isinstance(condition, Symbol) else not condition  # type: ignore[operator]


def is_finite_number(value: Any) -> Any:
    """Whether a number is neither infinite nor NaN."""
    return bool(abs(value.number()) < math.inf) if isinstance(value, Symbol) else math.isfinite(value)


def real(value: Any) -> Any:
    """Return a whole number as a float, anything else as it is: NumPy's functions know whole numbers of at most 64 bits. Raises OverflowError."""
    return float(value) if type(value) is int else value


def sine(angle: float) -> float:
    """The sine of `angle`."""
    return plain_float(np.sin(real(angle)))


def cosine(angle: float) -> float:
    """The cosine of `angle`."""
    return plain_float(np.cos(real(angle)))


def square_root(value: float) -> float:
    """The square root of `value`, correctly rounded."""
    return math.sqrt(value) if type(value) is float else plain_float(np.sqrt(real(value)))


def larger(a: float, b: float) -> float:
    """The larger of two numbers."""
    return max(a, b) if type(a) is float and type(b) is float else plain_float(np.maximum(a, b))


def smaller(a: float, b: float) -> float:
    """The smaller of two numbers."""
    return min(a, b) if type(a) is float and type(b) is float else plain_float(np.minimum(a, b))


def either(condition: bool, then: Callable[[], float], otherwise: Callable[[], float]) -> float:
    """`then()` where the condition holds, else `otherwise()`."""
    if isinstance(condition, (np.ndarray, Symbol)):
        with np.errstate(all="ignore"):
            parts = (condition, then(), otherwise())
        return condition.apply(np.where, parts, float) if isinstance(condition, Symbol) else np.where(*parts)  # type: ignore[return-value]
    return then() if condition else otherwise()


def every(conditions: Iterable[bool]) -> bool:
    """Whether all conditions hold; those after one that is plainly False are not looked at."""
    result: Any = True
    for condition in conditions:
        result = condition if result is True else result & condition
        if result is False:
            return False
    return result


def search(cumulative: Sequence[float], value: float) -> Any:
    """How many of the increasing numbers `cumulative` are at most `value`."""
    return value.apply(position_in, (cumulative, value), int) if isinstance(value, Symbol) else bisect_right(cumulative, value)


def position_in(cumulative: Sequence[float], value: float) -> int:
    """`search`, as the operation that stands in a graph."""
    return bisect_right(cumulative, value)


def pick(values: Sequence[Any], position: Any) -> Any:
    """`values[int(position)]`, for a position that is not negative."""
    return position.pick(values) if isinstance(position, Symbol) else values[int(position)]
