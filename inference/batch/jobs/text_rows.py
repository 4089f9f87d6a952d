"""Rows of text in pieces: texts that all rows share, and what is different in each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import groupby, repeat
from typing import NamedTuple

import numpy as np

ALIKE = (1e-3, 1e15)
"""Zero, and numbers of these sizes, are written alike by Python and orjson: the shortest decimal without an exponent that is the number."""


def number_texts(values: np.ndarray) -> list[str]:
    """The text of each of (n,) finite floats."""
    dumps = quick_dumps()
    if dumps is None or not values.size:
        return list(map(float.__repr__, values.tolist()))
    size = np.abs(values)
    texts = dumps(np.ascontiguousarray(values, dtype=float)).decode()[1:-1].split(",")
    for k in np.flatnonzero((size < ALIKE[0]) & (size > 0) | (size >= ALIKE[1])).tolist():
        texts[k] = repr(float(values[k]))
    return texts


@cache
def quick_dumps() -> Callable[[np.ndarray], bytes] | None:
    """Return the function that writes an array of numbers quickly; None without orjson."""
    try:
        import orjson
    except ImportError:
        return None
    return lambda values: orjson.dumps(values, option=orjson.OPT_SERIALIZE_NUMPY)


class Picked(NamedTuple):
    """In each row one of some texts, by its number."""

    texts: Sequence[str]
    numbers: np.ndarray


Cells = str | list[str] | Picked | np.ndarray
"""A piece: the same in all rows, or one for each, or the texts of a column of finite floats or of whole numbers."""


def merged(pieces: Sequence[Cells]) -> list[Cells]:
    """The pieces, those that all rows share in one where they follow each other."""
    found: list[Cells] = []
    for shared, group in groupby(pieces, lambda piece: isinstance(piece, str)):
        several = list(group)
        found += ["".join(several)] if shared else several  # type: ignore[arg-type]
    return found


def texts_of(piece: Cells) -> str | list[str]:
    """A piece as texts."""
    match piece:
        case Picked(texts=texts, numbers=numbers):
            return list(map(texts.__getitem__, numbers.tolist()))
        case np.ndarray():
            return number_texts(piece) if piece.dtype.kind == "f" else list(map(str, piece.tolist()))
        case str() | list():
            return piece


def joined(pieces: Sequence[Cells], count: int) -> list[str]:
    """The rows, `count` of them."""
    parts = [texts_of(piece) for piece in pieces]
    if all(isinstance(part, str) for part in parts):
        return ["".join(parts)] * count  # type: ignore[arg-type]
    return list(map("".join, zip(*(repeat(part, count) if isinstance(part, str) else part for part in parts), strict=True)))

