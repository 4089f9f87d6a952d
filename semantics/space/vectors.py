"""Vectors: positions and offsets in the plane, in metres (paper, Section "Data Types")."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Vector:
    """The vector ⟨x, y⟩; `x` points East, `y` North; floats, or arrays of one shape for many vectors at once.

    It equals the pair of its coordinates, which is the paper's syntax for it, and has the hash of that.

    Example: `ego = Object at Vector(3, 4)`
    """

    x: float
    y: float

    def __eq__(self, other: object) -> bool:
        if type(other) is Vector:
            return (self.x, self.y) == (other.x, other.y)
        return (self.x, self.y) == other if type(other) is tuple else NotImplemented

    def __iter__(self) -> Iterator[float]:
        yield self.x
        yield self.y

    def __len__(self) -> int:
        return 2

    def __getitem__(self, index: int) -> float:
        return (self.x, self.y)[index]

    def __add__(self, other: Vector | tuple[float, float]) -> Vector:
        if not _is_pair(other):
            return NotImplemented
        x, y = other
        return Vector(self.x + x, self.y + y)

    __radd__ = __add__

    def __sub__(self, other: Vector | tuple[float, float]) -> Vector:
        if not _is_pair(other):
            return NotImplemented
        x, y = other
        return Vector(self.x - x, self.y - y)

    def __rsub__(self, other: tuple[float, float]) -> Vector:
        if not _is_pair(other):
            return NotImplemented
        x, y = other
        return Vector(x - self.x, y - self.y)

    def __mul__(self, factor: float) -> Vector:
        return Vector(self.x * factor, self.y * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: float) -> Vector:
        return Vector(self.x / divisor, self.y / divisor)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y)

    def __repr__(self) -> str:
        return f"({self.x}, {self.y})"


def _is_pair(other: object) -> bool:
    return isinstance(other, (Vector, tuple, list)) and len(other) == 2


class TakesPoints:
    """A value of a library whose methods take vectors, so that points and objects are given to them as their positions."""

    __slots__ = ()


class Unchanging(TakesPoints):
    """A value of a library that stays what it is, and whose methods change nothing: compiled code asks and calls it by itself."""

    __slots__ = ()


class TakesObjects:
    """A value of a library whose methods are given objects with their properties."""

    __slots__ = ()
