"""What the process loads from which those that work are forked, so that these need not: it is imported there, and by nobody else."""

from __future__ import annotations

from ..api import loads
from . import worker  # noqa: F401 (with all that does the works)

READY = loads("ego = Object at (0, 0)").sample()
"""The tables of the parser are loaded, and the machine has run once."""
