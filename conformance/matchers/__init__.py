"""The closed table of matchers: a vector has exactly one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..strict_tables import VectorFields
from ..vector import Matcher
from .distributions import read_distribution, read_probabilities, read_support
from .errors import read_error, read_rejection
from .simulations import read_simulations
from .values import read_densities, read_values

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
