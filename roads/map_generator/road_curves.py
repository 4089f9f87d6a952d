"""Reference lines of roads: lines, arcs, spirals and cubic curves, each of which begins where the one before ends.

Points are complex numbers, metres to the East + i · metres to the North; headings are those of OpenDRIVE, in radians anticlockwise from East.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

SHORTEST = 1e-6
"""Metres; what is shorter is left out of a reference line."""
GENTLE = math.radians(20)
"""A turn by less is made by a cubic curve, one by more by an arc."""
SAMPLES, WEIGHTS = np.polynomial.legendre.leggauss(24)
"""Of the integral from -1 to 1 (Gauss and Legendre), exact to rounding for what turns by less than a full circle."""


def turn(angle: float) -> float:
    """The angle in [-π, π] that differs from `angle` by a multiple of 2π."""
    return math.remainder(angle, math.tau)


@dataclass(frozen=True)
class Placement:
    """A point and a heading."""

    point: complex
    heading: float

    def moved(self, ahead: float, right: float = 0.0) -> Placement:
        """The pose this many metres ahead and to the right, with the same heading."""
        return Placement(self.point + complex(ahead, -right) * cmath.exp(1j * self.heading), self.heading)

    def reversed(self) -> Placement:
        """Return the placement at this point with the opposite heading."""
        return Placement(self.point, self.heading + math.pi)


@dataclass(frozen=True)
class Bend:
    """A line, an arc or a spiral: its curvature, in 1/m and positive to the left, changes linearly from `first` to `last`."""

    start: Placement
    length: float
    first: float = 0.0
    last: float = 0.0

    def at(self, share: float) -> Placement:
        """The pose after this share of the length."""
        length, change = share * self.length, (self.last - self.first) / self.length
        along = length * (1 + SAMPLES) / 2
        headings = self.start.heading + along * (self.first + along * change / 2)
        moved = complex(np.sum(WEIGHTS * np.exp(1j * headings))) * length / 2
        return Placement(self.start.point + moved, self.start.heading + length * (self.first + length * change / 2))


@dataclass(frozen=True)
class CubicCurve:
    """The cubic curve from a pose to another; p³ · a + p² · b + p · c, for p from 0 to 1, in the coordinates of `start`."""

    start: Placement
    end: Placement

    @cached_property
    def coefficients(self) -> tuple[complex, complex, complex]:
        """The coefficients of p, p² and p³ in u + i v."""
        there = (self.end.point - self.start.point) * cmath.exp(-1j * self.start.heading)
        ahead, at_end = abs(there), abs(there) * cmath.exp(1j * (self.end.heading - self.start.heading))
        return ahead + 0j, 3 * there - 2 * ahead - at_end, ahead + at_end - 2 * there

    @cached_property
    def length(self) -> float:
        """Rounded down to micrometres, so that readers who look for p by the length along the curve find it in [0, 1]."""
        c, b, a = self.coefficients
        p = (1 + SAMPLES) / 2
        return math.floor(float(np.sum(WEIGHTS * np.abs(c + p * (2 * b + p * 3 * a)))) / 2 * 1e6) / 1e6

    def at(self, share: float) -> Placement:
        """The pose at p = `share`."""
        c, b, a = self.coefficients
        local, ahead = share * (c + share * (b + share * a)), c + share * (2 * b + share * 3 * a)
        return Placement(self.start.point + local * cmath.exp(1j * self.start.heading), self.start.heading + cmath.phase(ahead))


Piece = Bend | CubicCurve
Line = tuple[Piece, ...]
"""A reference line."""
Shape = tuple[float, float, float]
"""Length and curvatures of a bend."""


def bends(start: Placement, shapes: Iterable[Shape]) -> Line:
    """The reference line from `start` with these lengths and curvatures."""
    line: list[Piece] = []
    for length, first, last in shapes:
        if length > SHORTEST:
            line.append(Bend(line[-1].at(1) if line else start, length, first, last))
    return tuple(line)


def bends_to(end: Placement, shapes: Iterable[Shape]) -> Line:
    """The reference line that ends at `end`."""
    shapes = tuple(shapes)
    back = bends(end.reversed(), [(length, -last, -first) for length, first, last in reversed(shapes)])
    return bends(back[-1].at(1).reversed(), shapes)


def junction_curve(start: Placement, end: Placement) -> Line:
    """The way through a junction: straight, or a gentle cubic curve, or an arc with a line before or after it."""
    there = (end.point - start.point) * cmath.exp(-1j * start.heading)
    angle = turn(end.heading - start.heading)
    if abs(angle) < 1e-9 and abs(there.imag) < 1e-9:
        return (Bend(start, there.real),)
    if abs(angle) < GENTLE:
        return (CubicCurve(start, end),)
    after = there.imag / math.sin(angle)
    before = there.real - after * math.cos(angle)
    tangent = min(before, after)
    assert tangent > 0, (start, end)
    radius = tangent / math.tan(abs(angle) / 2)
    curvature = math.copysign(1 / radius, angle)
    return bends(start, [(before - tangent, 0.0, 0.0), (abs(angle) * radius, curvature, curvature), (after - tangent, 0.0, 0.0)])


def street(start: Placement, end: Placement) -> Line:
    """The way of a street: straight, or with two bends, each of them a spiral, an arc and a spiral."""
    third = abs(end.point - start.point) / 3
    one, other = start.moved(third).point, end.moved(-third).point
    middle, heading = abs(other - one), cmath.phase(other - one)
    angles = turn(heading - start.heading), turn(end.heading - heading)
    if max(map(abs, angles)) < 1e-9:
        return (Bend(start, 3 * third),)
    tangent = 0.8 * min(third, middle / 2)
    straight = third - tangent, middle - 2 * tangent, third - tangent
    shapes = [(straight[0], 0.0, 0.0)]
    for angle, length in zip(angles, straight[1:], strict=True):
        shapes += [*bend(angle, tangent), (length, 0.0, 0.0)]
    return bends(start, shapes)


def bend(angle: float, tangent: float) -> list[Shape]:
    """A spiral, an arc and a spiral that turn by `angle`, and touch the lines before and after this many metres from where those meet."""
    if abs(angle) < 1e-9:
        return [(2 * tangent, 0.0, 0.0)]
    share, sign = abs(angle) / 2, math.copysign(1.0, angle)
    unit = [(share, 0.0, sign), (share, sign, sign), (share, sign, 0.0)]
    chord = abs(bends(Placement(0j, 0.0), unit)[-1].at(1).point)
    radius = tangent * 2 * math.cos(angle / 2) / chord
    return [(length * radius, first / radius, last / radius) for length, first, last in unit]


def sharpest(line: Line) -> float:
    """The largest curvature of the bends of a reference line, in 1/m."""
    return max((max(abs(piece.first), abs(piece.last)) for piece in line if isinstance(piece, Bend)), default=0.0)
