"""Scenarios: programs that can be sampled (DESIGN, section 7)."""

from __future__ import annotations

from .loading import load, loads
from .scenario import FEW, Backend, Scenario

__all__ = ["FEW", "Backend", "Scenario", "load", "loads"]
