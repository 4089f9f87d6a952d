"""The JSON texts of many numbers: those of `json`, digit for digit, by orjson where it is installed (extra `fast`)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

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
    """What writes an array of numbers quickly; None without orjson."""
    try:
        import orjson
    except ImportError:
        return None
    return lambda values: orjson.dumps(values, option=orjson.OPT_SERIALIZE_NUMPY)
