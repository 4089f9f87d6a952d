"""Values that stand for many at once (DESIGN, section 1: a draw answered by a symbol), and functions over floats, arrays and symbols alike.

The equations of the language are written once, with Python's operators and the functions below. Given floats they give the
value of one scene; given NumPy arrays those of many; given symbols (the batch backend makes them) the graph of what is
computed. All three give the same bits: sines, square roots and so on are NumPy's in each case.

What cannot be done with a symbol raises `NotLifted`. It is no `Exception`, so that neither a program nor the machine can take it
for an error of the program.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any, NoReturn, TypeVar

import numpy as np

from .vectors import Vector


class NotLifted(BaseException):
    """Something was done with a symbol that needs the value in one scene; the text says what."""


class Symbol(ABC):
    """What a value is in many scenes, or in all."""

    __slots__ = ()

    @abstractmethod
    def apply(self, function: Callable[..., object], arguments: tuple[object, ...], result: type | None = None) -> Any:
        """`function(*arguments)` in every scene, symbols among or inside the arguments; a float or a bool, if `result` says so."""

    @abstractmethod
    def always(self, predicate: Callable[[object], bool]) -> bool:
        """Whether the predicate, about its type and the like, holds of every value that this may be. Raises `NotLifted` if that differs."""

    @abstractmethod
    def each(self, function: Callable[[Any], object]) -> Any:
        """`function` of every value that this may be, as a symbol again."""

    @abstractmethod
    def number(self) -> Any:
        """This as a symbol for floats."""

    @abstractmethod
    def pick(self, values: Sequence[object]) -> Any:
        """`values[int(this)]`."""

    @abstractmethod
    def truth(self) -> Any:
        """`bool(this)`, as a symbol unless it is the same in all scenes."""

    @abstractmethod
    def met(self, requirement: Any) -> bool:
        """Note that the truth of this decides a requirement, and give its truth in the scene that is looked at."""

    @abstractmethod
    def __bool__(self) -> bool: ...

    def _refuse(self, *ignored: object) -> NoReturn:
        raise NotLifted("a random value is needed as a number of one scene")

    def __hash__(self) -> NoReturn:
        raise NotLifted("a random value is a key, or a member of a set")

    __float__ = __int__ = __index__ = __iter__ = __len__ = __round__ = __trunc__ = __floor__ = __ceil__ = _refuse


def symbol_in(values: tuple[object, ...]) -> Symbol | None:
    """The first symbol among the values and in the vectors among them."""
    for value in values:
        if isinstance(value, Symbol):
            return value
        if type(value) is Vector:
            if isinstance(value.x, Symbol):
                return value.x
            if isinstance(value.y, Symbol):
                return value.y
    return None


Method = TypeVar("Method", bound=Callable[..., object])


def lifted(result: type) -> Callable[[Method], Method]:
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


def number(value: Any) -> Any:
    """`float(value)`; an array or a symbol as floats."""
    return value.number() if isinstance(value, Symbol) else value if isinstance(value, np.ndarray) else float(value)


def is_truth(value: object) -> bool:
    """Whether the value is True or False, or a symbol for these."""
    if not isinstance(value, Symbol):
        return isinstance(value, bool)
    try:
        return value.always(is_truth)
    except NotLifted:
        return False


def met(condition: Any, requirement: object) -> bool:
    """Whether the condition of a requirement holds; on symbols, this very truth value decides about the requirement."""
    return condition.met(requirement) if isinstance(condition, Symbol) else bool(condition)


def negation(condition: Any) -> Any:
    """`not condition`, for a truth value."""
    return ~condition if isinstance(condition, Symbol) else not condition  # type: ignore[operator]


def is_finite_number(value: Any) -> Any:
    """Whether a number is neither infinite nor NaN."""
    return bool(abs(value.number()) < math.inf) if isinstance(value, Symbol) else math.isfinite(value)


def sine(angle: float) -> float:
    """The sine of `angle`."""
    return plain_float(np.sin(angle))


def cosine(angle: float) -> float:
    """The cosine of `angle`."""
    return plain_float(np.cos(angle))


def square_root(value: float) -> float:
    """The square root of `value`, correctly rounded."""
    return math.sqrt(value) if type(value) is float else plain_float(np.sqrt(value))


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
