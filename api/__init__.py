"""Scenarios: programs that can be sampled (DESIGN, section 7)."""

from __future__ import annotations

from .loading import load, loads
from .scenario import Scenario
from .scene_iterator import FEW, Backend

__all__ = ["FEW", "Backend", "Scenario", "load", "loads"]
