"""Scenarios: programs that can be sampled (DESIGN, section 7)."""

from __future__ import annotations

from .engine_choice import FEW, Backend
from .program_loader import load, loads
from .scenario import Scenario

__all__ = ["FEW", "Backend", "Scenario", "load", "loads"]
