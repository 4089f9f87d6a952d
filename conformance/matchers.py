"""The closed table of matchers: a vector has exactly one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .densities import read_densities
from .fields import VectorFields
from .refusals import read_error, read_rejection
from .simulations import read_simulations
from .statistical import read_distribution, read_probabilities, read_support
from .values import read_values
from .vector import Matcher

MATCHERS: Mapping[str, Callable[[VectorFields], Matcher]] = {
    "values": read_values,
    "probabilities": read_probabilities,
    "distribution": read_distribution,
    "support": read_support,
    "density": read_densities,
    "rejection": read_rejection,
    "error": read_error,
    "simulations": read_simulations,
}
"""How each matcher is read from its table; the reader raises `UsageError`."""
