"""Python's operators, with a limit on what one of them may make."""

from __future__ import annotations

import math
import operator as python
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from ..store.budget import LARGEST_INTEGER_BITS, as_whole_number, container_length, refuse_too_long
from ..store.sets import VIEWS, Set
from .string_methods import percent

SEQUENCES = (str, bytes, list, tuple)
REPEATED = (*SEQUENCES, deque)


def _plus(left: object, right: object) -> object:
    if isinstance(left, SEQUENCES) and isinstance(right, SEQUENCES):
        refuse_too_long(container_length(left) + container_length(right))
    return left + right  # type: ignore[operator]


def _power(left: object, right: object) -> object:
    if isinstance(left, int) and isinstance(right, int):
        base, exponent = as_whole_number(left), as_whole_number(right)
        if abs(base) > 1 and exponent > 0 and (exponent > LARGEST_INTEGER_BITS or bits_of(base) * exponent > LARGEST_INTEGER_BITS):
            raise OverflowError(f"{base} ** {exponent} is too large" if base.bit_length() < 1000 and exponent < 10**100 else "a power is too large")
    return left**right  # type: ignore[operator]


def bits_of(number: int) -> float:
    """The binary digits of a whole number, with fractions where it is not large."""
    return math.log2(abs(number)) if 0 < abs(number) < 1 << 1000 else number.bit_length()


def _times(left: object, right: object) -> object:
    for sequence, count in ((left, right), (right, left)):
        if isinstance(sequence, REPEATED) and hasattr(type(count), "__index__"):
            times = as_whole_number(count)  # asked once, since the program may give another number the next time
            refuse_too_long(container_length(sequence) * times)
            if not isinstance(count, int) and not hasattr(type(count), "__rmul__" if count is right else "__mul__"):
                return times * sequence  # type: ignore[operator]
    if isinstance(left, int) and isinstance(right, int) and int.bit_length(left) + int.bit_length(right) > LARGEST_INTEGER_BITS:
        raise OverflowError("an integer is too large")
    return left * right  # type: ignore[operator]


def _shift(left: object, right: object) -> object:
    if isinstance(left, int) and isinstance(right, int) and int.bit_length(left) + as_whole_number(right) > LARGEST_INTEGER_BITS:
        raise OverflowError("an integer is too large")
    return left << right  # type: ignore[operator]


def _modulo(left: object, right: object) -> object:
    if isinstance(left, bytes):
        raise TypeError("bytes cannot be a format: use a text")
    if isinstance(left, str):
        return percent(left, right)
    return left % right  # type: ignore[operator]


def _of_sets(operation: Callable[[Any, Any], object]) -> Callable[[Any, Any], object]:
    """An operator of sets: what it makes of views of dictionaries keeps an order as well."""

    def apply(left: Any, right: Any) -> object:
        return operation(Set(left) if isinstance(left, VIEWS) else left, right)

    return apply


_minus, _and, _or, _xor = (_of_sets(operation) for operation in (python.sub, python.and_, python.or_, python.xor))

BINARY: Mapping[str, Callable[..., object]] = {
    "+": _plus, "-": _minus, "*": _times, "/": python.truediv, "//": python.floordiv, "%": _modulo, "**": _power,
    "<<": _shift, ">>": python.rshift, "&": _and, "|": _or, "^": _xor,
}
UNARY: Mapping[str, Callable[..., object]] = {"-": python.neg, "+": python.pos, "~": python.invert, "not": python.not_}


def puts_together(operator: str, operands: list[object]) -> bool:
    """Whether the operator makes a container of the elements of two, or of one several times: these keep their randomness, as in a display."""
    left, right = map(type, operands)
    if operator == "*":
        return {left, right} in ({list, int}, {tuple, int})
    return left is right and left in {"+": (list, tuple), "|": (dict,)}.get(operator, ())
