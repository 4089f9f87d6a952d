"""Columns of random numbers: those of `interpreter.runtime.random_streams`, for many scenes and attempts at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ....interpreter.runtime.answerers import PER_SCENE
from ....interpreter.runtime.random_streams import (
    MULTIPLIER_0,
    MULTIPLIER_1,
    ROUNDS,
    UNIT,
    UNUSED_BITS,
    WEYL_0,
    WEYL_1,
    WORD,
    Stream,
    fold,
    site_code,
)
from ..graph import Site

DENSE = 0.05
"""Blocks of consecutive scenes are computed at once if at least this share of them is asked for."""
_M0, _M1 = np.uint64(MULTIPLIER_0), np.uint64(MULTIPLIER_1)
_LOW, _HALF = np.uint64(0xFFFFFFFF), np.uint64(32)


class Numbers:
    """The numbers of some rows; row k is attempt `attempts[k]` at scene `scenes[k]` (both uint64). Blocks of numbers are kept for later sites."""

    def __init__(self, seed: int, scenes: np.ndarray, attempts: np.ndarray) -> None:
        self.seed = fold(seed)
        self.scenes = scenes
        self.attempts = attempts
        self.blocks: dict[tuple[object, ...], np.ndarray] = {}
        self.first = int(scenes.min()) if len(scenes) else 0
        self.span = int(scenes.max()) - self.first + 1 if len(scenes) else 0
        self.attempt = int(attempts[0]) if len(attempts) and (attempts == attempts[0]).all() else None

    def copy(self) -> Numbers:
        """Return a copy from which rows can be left out independently."""
        return Numbers(self.seed, self.scenes, self.attempts)

    def stream(self, row: int, address: tuple[int, ...], per_scene: bool) -> Callable[[], float]:
        """The numbers of one row at a draw site, one after the other."""
        return Stream(self.seed, int(self.scenes[row]), PER_SCENE if per_scene else int(self.attempts[row])).at(address)

    def __len__(self) -> int:
        return len(self.scenes)

    def keep(self, kept: np.ndarray) -> None:
        """Leave out the rows where `kept` is False."""
        self.scenes, self.attempts = self.scenes[kept], self.attempts[kept]
        self.blocks = {name: block[kept] for name, block in self.blocks.items()}

    def column(self, site: Site) -> np.ndarray:
        """The numbers in [0, 1) of a site."""
        block, word = divmod(site.index, 4)
        name = (site.address, block, site.per_scene)
        words = self.blocks.get(name)
        if words is None:
            words = self.blocks[name] = self.words(site_code(site.address), block, site.per_scene)
        return (words[:, word] >> np.uint64(UNUSED_BITS)) * UNIT

    def words(self, code: int, block: int, per_scene: bool) -> np.ndarray:
        """The four words of a block, (rows, 4)."""
        attempt = PER_SCENE if per_scene else self.attempt
        if attempt is not None and len(self.scenes) >= DENSE * self.span:
            return self.consecutive(code, attempt, block)[(self.scenes - np.uint64(self.first)).astype(np.int64)]
        attempts = np.full_like(self.scenes, PER_SCENE) if per_scene else self.attempts
        return philox_rows((self.seed, code), self.scenes, attempts, block)

    def consecutive(self, code: int, attempt: int, block: int) -> np.ndarray:
        """The words of all scenes from the first to the last, from NumPy's generator, which adds 1 to its counter first."""
        counter = (self.first + (attempt << 64) + (block << 128) - 1) % (1 << 256)
        generator = np.random.Philox(key=self.seed | (code << 64), counter=counter)
        return generator.random_raw(4 * self.span).reshape(self.span, 4)


def philox_rows(key: tuple[int, int], scenes: np.ndarray, attempts: np.ndarray, block: int) -> np.ndarray:
    """Philox4x64-10 of the counters (scene, attempt, block, 0), (rows, 4)."""
    k0, k1 = key
    c0, c1 = scenes, attempts
    c2, c3 = np.full_like(scenes, block), np.zeros_like(scenes)
    for _ in range(ROUNDS):
        high0, low0 = _product(_M0, c0)
        high1, low1 = _product(_M1, c2)
        c0, c1, c2, c3 = high1 ^ c1 ^ np.uint64(k0), low1, high0 ^ c3 ^ np.uint64(k1), low0
        k0, k1 = (k0 + WEYL_0) & WORD, (k1 + WEYL_1) & WORD
    return np.stack([c0, c1, c2, c3], axis=1)


def _product(a: np.uint64, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The high and low words of the 128-bit product."""
    a_low, a_high = a & _LOW, a >> _HALF
    b_low, b_high = b & _LOW, b >> _HALF
    middle = a_high * b_low + (a_low * b_low >> _HALF)
    other = a_low * b_high + (middle & _LOW)
    return a_high * b_high + (middle >> _HALF) + (other >> _HALF), a * b
