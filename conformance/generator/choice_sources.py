"""The sources of the generator's choices: an engine that shrinks, or the numbers of a seed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TypeVar

from ...interpreter.runtime.random_streams import Stream

T = TypeVar("T")


class Choices(ABC):
    """A source of choices; the simplest is the first option, or the integer nearest to 0, which an engine that shrinks tends to."""

    @abstractmethod
    def integer(self, low: int, high: int) -> int:
        """An integer from `low` to `high`, both included."""

    def pick(self, options: Sequence[T]) -> T:
        """One of the options, equally likely."""
        return options[self.integer(0, len(options) - 1)]

    def weighted(self, options: Sequence[tuple[int, T]]) -> T:
        """One of the options, in proportion to the weights before them."""
        place = self.integer(0, sum(weight for weight, _ in options) - 1)
        for weight, option in options:
            place -= weight
            if place < 0:
                return option
        raise AssertionError("the weights are not negative")

    def chance(self, probability: float) -> bool:
        """True with that probability (in hundredths); False is the simpler answer."""
        hundredths = round(probability * 100)
        return hundredths > 0 and (hundredths >= 100 or self.integer(0, 99) >= 100 - hundredths)

    def some(self, options: Sequence[T], low: int, high: int) -> list[T]:
        """From `low` to `high` different options, in random order."""
        rest = list(options)
        count = min(self.integer(low, high), len(rest))
        return [rest.pop(self.integer(0, len(rest) - 1)) for _ in range(count)]


class SeededChoices(Choices):
    """The choices of program number `index` of `seed`: the same ones on every machine and in every process."""

    def __init__(self, seed: int, index: int) -> None:
        self._uniform: Callable[[], float] = Stream(seed, index, 0).at(())

    def integer(self, low: int, high: int) -> int:
        return low + int(self._uniform() * (high - low + 1))
