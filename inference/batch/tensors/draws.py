"""The random numbers of runs as tensors: those of the columns, moved to the device, or the same bits computed on it."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from ....interpreter.choosers import PER_SCENE
from ....interpreter.streams import MULTIPLIER_0, MULTIPLIER_1, ROUNDS, UNIT, UNUSED_BITS, WEYL_0, WEYL_1, WORD, fold, site_code
from ..evaluate.numbers import Numbers
from ..trace.graph import Site

LOW, HALF = 0xFFFFFFFF, 32


class TensorNumbers(Protocol):
    """The random numbers of some rows."""

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (rows,)."""
        ...

    def keep(self, kept: Tensor) -> None:
        """Leave out all rows but these, of which the numbers are given."""
        ...


class MovedNumbers:
    """Those of the columns, which leave out rows themselves."""

    def __init__(self, numbers: Numbers, device: torch.device) -> None:
        self.numbers, self.device = numbers, device

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (rows,)."""
        return torch.from_numpy(self.numbers.column(site)).to(self.device)

    def keep(self, kept: Tensor) -> None:
        """Nothing: the columns have done it."""


class DeviceNumbers:
    """The same numbers computed on the device, so that nothing need be moved there; `scenes` and `attempts` are uint64."""

    def __init__(self, seed: int, scenes: np.ndarray, attempts: np.ndarray, device: torch.device) -> None:
        self.seed = fold(seed)
        self.scenes, self.attempts = (torch.from_numpy(a.view(np.int64)).to(device) for a in (scenes, attempts))
        self.blocks: dict[tuple[object, ...], list[Tensor]] = {}

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (rows,)."""
        block, word = divmod(site.index, 4)
        name = (site.address, block, site.per_scene)
        if name not in self.blocks:
            attempts = torch.full_like(self.scenes, signed(PER_SCENE)) if site.per_scene else self.attempts
            self.blocks[name] = philox((self.seed, site_code(site.address)), self.scenes, attempts, block)
        return shifted(self.blocks[name][word], UNUSED_BITS).to(torch.float64) * UNIT

    def keep(self, kept: Tensor) -> None:
        """Leave out all rows but these, of which the numbers are given."""
        self.scenes, self.attempts = self.scenes.index_select(0, kept), self.attempts.index_select(0, kept)
        self.blocks = {name: [words.index_select(0, kept) for words in block] for name, block in self.blocks.items()}


def philox(key: tuple[int, int], scenes: Tensor, attempts: Tensor, block: int) -> list[Tensor]:
    """Philox4x64-10 of the counters (scene, attempt, block, 0): its four words, each (rows,), in int64 with the bits of uint64."""
    k0, k1 = key
    c0, c1, c2, c3 = scenes, attempts, torch.full_like(scenes, block), torch.zeros_like(scenes)
    for _ in range(ROUNDS):
        high0, low0 = product(MULTIPLIER_0, c0)
        high1, low1 = product(MULTIPLIER_1, c2)
        c0, c1, c2, c3 = high1 ^ c1 ^ signed(k0), low1, high0 ^ c3 ^ signed(k1), low0
        k0, k1 = (k0 + WEYL_0) & WORD, (k1 + WEYL_1) & WORD
    return [c0, c1, c2, c3]


def product(a: int, b: Tensor) -> tuple[Tensor, Tensor]:
    """The high and low words of the 128-bit product of words."""
    a_low, a_high, b_low, b_high = a & LOW, a >> HALF, b & LOW, shifted(b, HALF)
    middle = a_high * b_low + shifted(a_low * b_low, HALF)
    other = a_low * b_high + (middle & LOW)
    return a_high * b_high + shifted(middle, HALF) + shifted(other, HALF), signed(a) * b


def shifted(words: Tensor, bits: int) -> Tensor:
    """Words shifted right, zeros coming in."""
    return (words >> bits) & ((1 << 64 - bits) - 1)


def signed(word: int) -> int:
    """The number in int64 that has the bits of a word."""
    return word - (1 << 64) if word >> 63 else word
