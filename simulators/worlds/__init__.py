"""Worlds: the modules that Scenic programs import for their simulator's regions, fields and classes."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files

WORLDS: Mapping = {}
