"""Rows of text, compiled: numbers as `json` writes them, digit for digit, between texts that are known.

The digits of a number are found by multiplications alone (Giulietti, "The Schubfach way to render doubles", 2021): of the decimals with the fewest
digits that lie nearer to it than to any other float, the nearest. To import this needs numba.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from .jobs.text_rows import Cells, Picked
from .numba_evaluator import later_interrupts
from .primitives.numba_kernels import compile_, copy_bytes, high_word

CONSTANT, FLOAT, WHOLE, PICKED = 0, 1, 2, 3
"""Kinds of pieces: a text, the numbers of a column, its whole numbers, the texts that it numbers."""
LONGEST_FLOAT, LONGEST_WHOLE = 25, 20
"""Bytes that a number takes at most."""
AT_ONCE = 1 << 18
"""Bytes of rows that are made at a time: they stay in the caches until they are written."""

MANTISSA_BITS, EXPONENT_BIAS = 52, 1075
LEAST_POWER, LARGEST_POWER = -324, 342
"""The powers of ten that finite floats are multiplied by."""
_HIDDEN, _MANTISSA, _EXPONENT = np.uint64(1 << MANTISSA_BITS), np.uint64((1 << MANTISSA_BITS) - 1), np.uint64(0x7FF)
_LOW = np.uint64((1 << 63) - 1)
_ONE, _TWO, _FOUR, _TEN, _HUNDRED = (np.uint64(n) for n in (1, 2, 4, 10, 100))
_MANY, _MOST = np.uint64(10**15), np.uint64(10**17)
_MYRIAD, _EIGHT = np.uint64(10**4), np.uint64(10**8)
_BITS, _WORD = np.uint64(MANTISSA_BITS), np.uint64(63)
LOG_2, LOG_4_3, LOG_10 = (math.floor(math.log10(2) * 2**41), math.floor(math.log10(4 / 3) * 2**41), math.floor(math.log2(10) * 2**38))
LEAST_POINT, LARGEST_POINT = -3, 16
"""Where the point is in numbers without an exponent: that many digits from the first."""
MINUS, POINT, NOUGHT, EXPONENT_SIGN, PLUS = (ord(c) for c in "-.0e+")


def powers() -> np.ndarray:
    """For each power of ten its first 126 bits and one more unit, in two words of 63 bits."""
    found = []
    for power in range(LEAST_POWER, LARGEST_POWER + 1):
        shift = ((power * LOG_10) >> 38) - 125
        top = 10 ** max(power, 0) << max(-shift, 0)
        whole = top // (10 ** max(-power, 0) << max(shift, 0)) + 1
        found.append((whole >> 63, whole & ((1 << 63) - 1)))
    return np.array(found, dtype=np.uint64)


def pairs() -> np.ndarray:
    """The digits of 0 to 99."""
    return np.frombuffer("".join(f"{n:02d}" for n in range(100)).encode(), dtype=np.uint8)


_POWERS, _PAIRS = powers(), pairs()


@compile_
def scale_by_power_of_ten(high: Any, low: Any, number: Any) -> Any:
    """A number times a power of ten, rounded so that comparisons are not changed."""
    carried = (high * number >> _ONE) + high_word(low, number)
    return (high_word(high, number) + (carried >> _WORD)) | (((carried & _LOW) + _LOW) >> _WORD)


@compile_
def shortest(bits: Any) -> tuple[Any, Any]:
    """The digits of a positive float, and the power of ten that they are multiplied by."""
    mantissa, biased = bits & _MANTISSA, np.int64((bits >> _BITS) & _EXPONENT)
    even_lower = mantissa != 0 or biased <= 1
    if biased > 0:
        mantissa |= _HIDDEN
    exponent = max(biased, 1) - EXPONENT_BIAS
    odd = mantissa & _ONE
    power = (exponent * LOG_2 >> 41) if even_lower else (exponent * LOG_2 - LOG_4_3 >> 41)
    shift = np.uint64(exponent + (-power * LOG_10 >> 38) + 2)
    high, low = _POWERS[-power - LEAST_POWER, 0], _POWERS[-power - LEAST_POWER, 1]
    here = mantissa * _FOUR
    value = scale_by_power_of_ten(high, low, here << shift)
    least = scale_by_power_of_ten(high, low, (here - (_TWO if even_lower else _ONE)) << shift) + odd
    most = scale_by_power_of_ten(high, low, (here + _TWO) << shift)
    digits = value >> _TWO
    tens = digits // _TEN * _TEN
    below, above = least <= tens * _FOUR, (tens + _TEN) * _FOUR + odd <= most
    if below == above:
        below, above = least <= digits * _FOUR, (digits + _ONE) * _FOUR + odd <= most
        middle = digits * _FOUR + _TWO
        if above if below != above else value > middle or (value == middle and digits & _ONE):
            digits += _ONE
    else:
        digits = tens if below else tens + _TEN
    while digits % _TEN == 0:
        digits //= _TEN
        power += 1
    return digits, power


@compile_
def digit_count(number: Any) -> Any:
    """How many digits a whole number has."""
    if _MANY <= number < _MOST:
        return 16 + (number >= _MANY * _TEN)
    length = 1
    while number >= _TEN:
        number //= _TEN
        length += 1
    return length


@compile_
def put_pair(out: np.ndarray, end: int, number: Any) -> None:
    """Write the two digits of a number below 100 before `end`."""
    place = np.int64(number) * 2
    out[end - 2], out[end - 1] = _PAIRS[place], _PAIRS[place + 1]


@compile_
def put_eight(out: np.ndarray, end: int, number: Any) -> None:
    """Write the eight digits of a number below 10⁸ before `end`."""
    high = number // _MYRIAD
    low = number - high * _MYRIAD
    upper, lower = high // _HUNDRED, low // _HUNDRED
    put_pair(out, end - 6, upper)
    put_pair(out, end - 4, high - upper * _HUNDRED)
    put_pair(out, end - 2, lower)
    put_pair(out, end, low - lower * _HUNDRED)


@compile_
def put_digits(out: np.ndarray, end: int, number: Any) -> None:
    """Write the digits of a whole number before `end`."""
    single = number < _TEN
    while number >= _EIGHT:
        rest = number // _EIGHT
        put_eight(out, end, number - rest * _EIGHT)
        end -= 8
        number = rest
    while number >= _TEN:
        rest = number // _HUNDRED
        put_pair(out, end, number - rest * _HUNDRED)
        end -= 2
        number = rest
    if number or single:
        out[end - 1] = NOUGHT + np.int64(number)


@compile_
def put_whole(out: np.ndarray, at: int, number: int) -> int:
    """Write a whole number; where it ends."""
    size = np.uint64(number)
    if number < 0:
        out[at] = MINUS
        at, size = at + 1, np.uint64(-number)
    end = at + digit_count(size)
    put_digits(out, end, size)
    return end


@compile_
def put_noughts(out: np.ndarray, at: int, count: int) -> int:
    """Write noughts; where they end."""
    for k in range(count):
        out[at + k] = NOUGHT
    return at + count


@compile_
def put_plain(out: np.ndarray, at: int, digits: Any, length: int, point: int) -> int:
    """Write digits with the point before digit `point`; where they end."""
    if point <= 0:
        out[at], out[at + 1] = NOUGHT, POINT
        end = put_noughts(out, at + 2, -point) + length
        put_digits(out, end, digits)
        return end
    if point >= length:
        put_digits(out, at + length, digits)
        end = put_noughts(out, at + length, point - length)
        out[end], out[end + 1] = POINT, NOUGHT
        return end + 2
    put_digits(out, at + length + 1, digits)
    for k in range(at, at + point):
        out[k] = out[k + 1]
    out[at + point] = POINT
    return at + length + 1


@compile_
def put_with_exponent(out: np.ndarray, at: int, digits: Any, length: int, exponent: int) -> int:
    """Write digits with the point behind the first and an exponent of at least two digits; where they end."""
    put_digits(out, at + length + (length > 1), digits)
    if length > 1:
        out[at] = out[at + 1]
        out[at + 1] = POINT
        at += length
    out[at + 1] = EXPONENT_SIGN
    out[at + 2] = PLUS if exponent > 0 else MINUS
    at = put_noughts(out, at + 3, int(abs(exponent) < 10))
    return put_whole(out, at, abs(exponent))


@compile_
def put_float(out: np.ndarray, at: Any, bits: Any) -> int:
    """Write a finite float, given by its bits; where it ends."""
    out[at] = MINUS
    at, bits = at + np.int64(bits >> _WORD), bits & _LOW
    if bits == 0:
        return put_plain(out, at, bits, 1, 1)
    digits, power = shortest(bits)
    length = digit_count(digits)
    point = length + power
    if LEAST_POINT <= point <= LARGEST_POINT:
        return put_plain(out, at, digits, length, point)
    return put_with_exponent(out, at, digits, length, point - 1)


@compile_
def put_rows(
    out: np.ndarray, first: int, ends: np.ndarray, pieces: np.ndarray, blob: np.ndarray, starts: np.ndarray, floats: np.ndarray, wholes: np.ndarray
) -> None:
    """Write rows from `first` on, one behind the other, and where each ends. A piece is its kind, its column, and the number of its text or of its
    first text.
    """
    at: Any = 0
    for row in range(first, first + len(ends)):
        for k in range(len(pieces)):
            kind, column, text = pieces[k, 0], pieces[k, 1], pieces[k, 2]
            if kind == FLOAT:
                at = put_float(out, at, floats[column, row])
            elif kind == WHOLE:
                at = put_whole(out, at, wholes[column, row])
            else:
                if kind == PICKED:
                    text += wholes[column, row]
                length = starts[text + 1] - starts[text]
                copy_bytes(out, at, blob, starts[text], length)
                at += length
        ends[row - first] = at


# Rows


class CompiledRows:
    """Joins pieces into rows, as `jobs.pieces.joined` does, by compiled code. Making it takes seconds."""

    def __init__(self) -> None:
        with later_interrupts():
            list(self.joined(["", np.zeros(1), np.zeros(1, dtype=np.int64)], 1))

    def joined(self, pieces: Sequence[Cells], count: int) -> Iterator[tuple[memoryview, np.ndarray]]:
        """The rows, `count` of them, in UTF-8, some at a time (good until the next are asked for), and where each of these ends."""
        kit = Pieces(count)
        for piece in pieces:
            kit.add(piece)
        arrays, step = kit.arrays(), max(1, AT_ONCE // max(kit.longest, 1))
        out = np.empty(min(step, count) * kit.longest, dtype=np.uint8)
        for first in range(0, count, step):
            ends = np.empty(min(step, count - first), dtype=np.int64)
            put_rows(out, first, ends, *arrays)
            yield memoryview(out)[: ends[-1]], ends  # type: ignore[arg-type]


class Pieces:
    """Pieces as compiled code takes them."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.longest = 0
        """So many bytes a row has at most."""
        self.pieces: list[tuple[int, int, int]] = []
        self.texts: list[bytes] = []
        self.floats: list[np.ndarray] = []
        self.wholes: list[np.ndarray] = []

    def add(self, piece: Cells) -> None:
        """Add a piece of each row."""
        match piece:
            case str():
                self.place(CONSTANT, 0, [piece.encode()])
            case Picked(texts=texts, numbers=numbers):
                self.place(PICKED, self.column(self.wholes, numbers), [text.encode() for text in texts])
            case np.ndarray() if piece.dtype.kind == "f":
                self.pieces.append((FLOAT, self.column(self.floats, piece), 0))
                self.longest += LONGEST_FLOAT
            case np.ndarray():
                self.pieces.append((WHOLE, self.column(self.wholes, piece), 0))
                self.longest += LONGEST_WHOLE
            case _:
                self.place(PICKED, self.column(self.wholes, np.arange(self.count)), [text.encode() for text in piece])

    def column(self, columns: list[np.ndarray], column: np.ndarray) -> int:
        """The place of a column among others."""
        columns.append(column)
        return len(columns) - 1

    def place(self, kind: int, column: int, texts: list[bytes]) -> None:
        """Add a piece that is one of some texts in each row."""
        self.pieces.append((kind, column, len(self.texts)))
        self.texts += texts
        self.longest += max(map(len, texts), default=0)

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return the arrays with which `put_rows` is called."""
        starts = np.cumsum([0, *map(len, self.texts)], dtype=np.int64)
        floats = np.array(self.floats, dtype=float).reshape(len(self.floats), self.count).view(np.uint64)
        wholes = np.array(self.wholes, dtype=np.int64).reshape(len(self.wholes), self.count)
        return np.array(self.pieces, dtype=np.int64).reshape(-1, 3), np.frombuffer(b"".join(self.texts), dtype=np.uint8), starts, floats, wholes
