"""Random numbers as a pure function of (seed, scene, attempt, address): a counter-based generator, Philox4x64-10.

The four words of block b at the draw site with code k, in attempt a of scene i, are Philox(key=(seed, k), counter=(i, a, b, 0)).
In NumPy's terms, whose `Philox` adds 1 to its 256-bit counter (lowest word first) *before* it computes a block, they are

    numpy.random.Philox(key=[seed, k], counter=c - 1).random_raw(4),    c = i + a 2^64 + b 2^128,

and `random_raw(4 * n).reshape(n, 4)` gives the blocks of n consecutive scenes. A word w becomes the number (w >> 11) 2^-53 in
[0, 1), as in NumPy's `Generator.random`. It can be 0 (once in 9e15): inverse distribution functions that are infinite there
take 2^-54 instead (see `semantics.space.distributions`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

WORD = (1 << 64) - 1
MULTIPLIER_0, MULTIPLIER_1 = 0xD2E7470EE14C6C93, 0xCA5A826395121157
WEYL_0, WEYL_1 = 0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B
ROUNDS = 10
UNUSED_BITS, UNIT = 11, 2.0**-53


def philox_words(key: tuple[int, int], counter: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """The four 64-bit words of Philox4x64-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", 2011).

    `inference.batch` has the same for columns, once in NumPy and once compiled.
    """
    k0, k1 = key
    c0, c1, c2, c3 = counter
    for _ in range(ROUNDS):
        p0, p1 = MULTIPLIER_0 * c0, MULTIPLIER_1 * c2
        c0, c1, c2, c3 = (p1 >> 64) ^ c1 ^ k0, p1 & WORD, (p0 >> 64) ^ c3 ^ k1, p0 & WORD
        k0, k1 = (k0 + WEYL_0) & WORD, (k1 + WEYL_1) & WORD
    return c0, c1, c2, c3


def mix(word: int) -> int:
    """The output function of SplitMix64: a bijection of 64-bit words in which each input bit moves half of the output bits."""
    word = ((word ^ (word >> 30)) * 0xBF58476D1CE4E5B9) & WORD
    word = ((word ^ (word >> 27)) * 0x94D049BB133111EB) & WORD
    return word ^ (word >> 31)


def fold(number: int) -> int:
    """A 64-bit word for any integer: the integer itself in [0, 2^64); else a hash of its sign and of its words."""
    if 0 <= number <= WORD:
        return number
    word, rest = mix(WEYL_1 if number < 0 else WEYL_0), abs(number)
    while rest:
        word = mix((word + WEYL_0 & WORD) ^ (rest & WORD))
        rest >>= 64
    return word


@lru_cache(maxsize=1 << 16)
def site_code(address: tuple[int, ...]) -> int:
    """The 64-bit code of a draw site: SplitMix64 folded over the address, its length first."""
    word = mix(len(address) + WEYL_0)
    for number in address:
        word = mix((word + WEYL_0 & WORD) ^ fold(number))
    return word


@dataclass(frozen=True, slots=True)
class Stream:
    """All random numbers of one attempt at one scene. The seed may be any integer (see `fold`); the others count from 0."""

    seed: int
    scene: int
    attempt: int

    def at(self, address: tuple[int, ...]) -> Callable[[], float]:
        """The numbers of the draw site `address`, in [0, 1), one at each call; the same ones whenever it is asked for."""
        return _uniforms((fold(self.seed), site_code(address)), self.scene, self.attempt).__next__


OF_SIMULATOR = (-2,)
"""The address from which simulators have their seeds; those of draws in time steps begin with -1."""


def simulator_seed(seed: int, number: int, attempt: int) -> int:
    """The seed of a simulator in an attempt at simulation `number` of `seed`, from 0 to 2^31 - 1."""
    return int(Stream(seed, number, attempt).at(OF_SIMULATOR)() * (1 << 31))


def _uniforms(key: tuple[int, int], scene: int, attempt: int) -> Iterator[float]:
    block = 0
    while True:
        for word in philox_words(key, (scene, attempt, block, 0)):
            yield (word >> UNUSED_BITS) * UNIT
        block += 1
