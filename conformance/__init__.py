"""Judging implementations of Scenic: vectors (data), matchers, and the protocol that an implementation answers.

A vector is a program with what the paper says about its scenes or simulations; `docs/vectors.md` documents the format.
"""

from __future__ import annotations

from .implementation import (
    Enumerated,
    Enumerating,
    EnumeratingSimulations,
    Implementation,
    NeverAccepted,
    Refused,
    Simulating,
    Task,
    Tracing,
    TracingSimulations,
)
from .loading import load_vectors
from .ourselves import Ourselves
from .running import Result, judge
from .vector import Vector
from .verdict import Verdict

__all__ = [
    "Enumerated", "Enumerating", "EnumeratingSimulations", "Implementation", "NeverAccepted", "Ourselves", "Refused", "Result", "Simulating",
    "Task", "Tracing", "TracingSimulations", "Vector", "Verdict", "judge", "load_vectors",
]
