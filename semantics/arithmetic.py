"""Python's operators, with a limit on what one of them may make."""

from __future__ import annotations

import operator as python
from collections.abc import Callable, Mapping
from typing import Any

from .budget import LARGEST_INTEGER_BITS, refuse_too_long
from .sets import VIEWS, Set
from .texts import check_percent

SEQUENCES = (str, bytes, list, tuple)


def _plus(left: object, right: object) -> object:
    if isinstance(left, SEQUENCES) and isinstance(right, SEQUENCES):
        refuse_too_long(len(left) + len(right))
    return left + right  # type: ignore[operator]


def _power(left: object, right: object) -> object:
    if isinstance(left, int) and isinstance(right, int) and right > 0 and left.bit_length() * right > LARGEST_INTEGER_BITS:
        raise OverflowError(f"{left} ** {right} is too large" if left.bit_length() < 1000 and right < 10**100 else "a power is too large")
    return left**right  # type: ignore[operator]


def _times(left: object, right: object) -> object:
    for sequence, count in ((left, right), (right, left)):
        if isinstance(sequence, SEQUENCES) and isinstance(count, int):
            refuse_too_long(len(sequence) * count)
    if isinstance(left, int) and isinstance(right, int) and left.bit_length() + right.bit_length() > LARGEST_INTEGER_BITS:
        raise OverflowError("an integer is too large")
    return left * right  # type: ignore[operator]


def _shift(left: object, right: object) -> object:
    if isinstance(left, int) and isinstance(right, int) and left.bit_length() + right > LARGEST_INTEGER_BITS:
        raise OverflowError("an integer is too large")
    return left << right  # type: ignore[operator]


def _modulo(left: object, right: object) -> object:
    if isinstance(left, bytes):
        raise TypeError("bytes are no format")
    if isinstance(left, str):
        check_percent(left, right)
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
