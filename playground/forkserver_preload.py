"""The modules that the fork server loads once, so that the processes forked from it need not; nothing else
imports this module.
"""

from __future__ import annotations

from ..api import loads
from . import worker  # noqa: F401 (with all that does the works)

READY = loads("ego = Object at (0, 0)").sample()
"""The tables of the parser are loaded, and the machine has run once."""
