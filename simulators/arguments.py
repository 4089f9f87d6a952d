"""What actions, behaviors and controllers ask of their arguments, and how they say that one is something else."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from ..semantics.kernel.kinds import kind_name
from ..semantics.space.vectors import Vector

LONGEST = 40
"""So many characters of a value are told."""


class Wanted(NamedTuple):
    """What an argument must be, in words that follow "must be", and whether a value is that."""

    words: str
    admits: Callable[[object], bool]

    def or_none(self) -> Wanted:
        """The same where None may be given as well."""
        return Wanted(f"{self.words}, or None", lambda value: value is None or self.admits(value))


def is_number(value: object) -> bool:
    """Whether a value is a finite number."""
    return math.isfinite(value) if type(value) is float else isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def between(low: float, high: float, words: str) -> Wanted:
    """A number of a range."""
    return Wanted(words, lambda value: is_number(value) and low <= value <= high)  # type: ignore[operator]


def is_distance(value: object) -> bool:
    """Whether a value is a number that is not negative; infinity is one, for what is however far away."""
    return (is_number(value) or value == math.inf) and value >= 0  # type: ignore[operator]


def is_vector(value: object) -> bool:
    """Whether a value is a vector, or two numbers in a list or tuple."""
    parts = (value.x, value.y) if isinstance(value, Vector) else value
    return isinstance(parts, (tuple, list)) and len(parts) == 2 and all(map(is_number, parts))


NUMBER = Wanted("a number", is_number)
HEADING = NUMBER._replace(words="an angle in radians")
SHARE = between(0, 1, "a number from 0 to 1")
STEERING = between(-1, 1, "a number from -1 (left) to 1 (right)")
SPEED = between(0, math.inf, "a speed in m/s, 0 or more")
DISTANCE = Wanted("a number of metres, 0 or more", is_distance)
TRUTH = Wanted("True or False", lambda value: isinstance(value, bool))
VECTOR = Wanted("a vector", is_vector)


def shown(value: object) -> str:
    """A value in a message: short ones as they are written, others by their kind."""
    flat = value if isinstance(value, (list, tuple)) and len(value) < LONGEST else [value]
    if not all(v is None or isinstance(v, (bool, int, float, str)) for v in flat):
        return kind_name(value)
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def check(of: str, wanted: Mapping[str, Wanted], values: Mapping[str, object]) -> None:
    """Raise `ValueError` for the first argument that is not what is wanted."""
    for name, kind in wanted.items():
        if not kind.admits(values[name]):
            raise unwanted(of, name, kind, values[name])


def unwanted(of: str, name: str, kind: Wanted, value: object) -> ValueError:
    """The error for an argument that is not what is wanted."""
    return ValueError(f"{of}: {name} must be {kind.words}, not {shown(value)}")
