"""The parts that all distributions share: their interface, and the error for wrong parameters."""

from __future__ import annotations

from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Protocol

from ..numeric_functions import is_finite_number, to_floats
from ..regions.point_sampling import Numbers

Support = tuple[tuple[object, Fraction], ...]

LEAST = 2.0**-54  # stands for the number 0 where the inverse of a distribution function is infinite


class BadParameters(ValueError):
    """A distribution cannot have these parameters; `parameter` names the wrong one, `number` the wrong one of its values."""

    def __init__(self, distribution: str, parameter: str, reason: str, number: int | None = None) -> None:
        super().__init__(f"{distribution}: {parameter} {reason}")
        self.distribution = distribution
        self.parameter = parameter
        self.reason = reason
        self.number = number


class NoValues(BadParameters):
    """A distribution over values has none."""


def exact(number: float | Fraction) -> Fraction:
    """The number as a fraction; a float counts as the shortest decimal that is written for it, so that 0.1 is 1/10."""
    return Fraction(repr(float(number))) if isinstance(number, float) else Fraction(number)


class Distribution(Protocol):
    """A probability distribution over values."""

    def sample(self, uniform: Numbers) -> object:
        """The value at the next numbers of `uniform`."""
        ...

    def log_density(self, value: object) -> float:
        """The logarithm of the probability (or density) of `value`; -inf outside the support."""
        ...

    def support(self) -> Support | None:
        """The values of positive probability with their exact probabilities, if there are finitely many; else None."""
        ...

    @property
    def name(self) -> str:
        """The distribution's name in Scenic."""
        ...

    @property
    def parameters(self) -> dict[str, object]:
        """The parameters by name."""
        ...


@dataclass(frozen=True)
class Named:
    """A distribution whose name is its class's and whose parameters are its fields."""

    @property
    def name(self) -> str:
        return type(self).__name__

    @property
    def parameters(self) -> dict[str, object]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def _number(self, parameter: str, *, infinite: bool = False) -> float:
        """The field `parameter` as a float, which replaces it; `BadParameters` unless it is a finite number."""
        given = getattr(self, parameter)
        try:
            value = to_floats(given)
        except (TypeError, ValueError):
            raise BadParameters(self.name, parameter, f"must be a number, not {given!r}") from None
        if not is_finite_number(value) and (not infinite or value != value):
            raise BadParameters(self.name, parameter, f"must be a finite number, not {value}")
        object.__setattr__(self, parameter, value)
        return value
