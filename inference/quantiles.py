"""Continuous distributions replaced by finitely many values: the points of a Hammersley set through the map that samples them.

A distribution on numbers gets its (i + 1/2)/N-quantiles. A point of a region takes several uniform numbers: the first is again
(i + 1/2)/N, the k-th after it the radical inverse of i in the k-th prime, which fills the unit cube evenly.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from ..semantics.space.distributions import Distribution, Numbers


def quantiles(distribution: Distribution, n: int) -> tuple[object, ...]:
    """`n` values that stand for the distribution, each with probability 1/n."""
    return tuple(distribution.sample(hammersley(i, n)) for i in range(n))


def hammersley(i: int, n: int) -> Numbers:
    """The coordinates of point `i` of `n` of a Hammersley set, one per call, in as many dimensions as are asked for."""
    coordinates = _coordinates(i, n)
    return lambda: next(coordinates)


def _coordinates(i: int, n: int) -> Iterator[float]:
    yield (i + 0.5) / n
    for prime in primes():
        yield radical_inverse(i, prime)


def primes() -> Iterator[int]:
    """2, 3, 5, ..."""
    found: list[int] = []
    for candidate in count(2):
        if all(candidate % prime for prime in found):
            found.append(candidate)
            yield candidate


def radical_inverse(i: int, base: int) -> float:
    """The digits of `i` in `base`, mirrored behind the point: in [0, 1)."""
    result, scale = 0.0, 1.0 / base
    while i:
        i, digit = divmod(i, base)
        result += digit * scale
        scale /= base
    return result
