"""Judging implementations of Scenic: vectors (data), matchers, and the protocol that an implementation answers.

A vector is a program with what the paper says about its scenes or simulations; `docs/vectors.md` documents the format.
"""

from __future__ import annotations

from .implementations.protocol import (
    Enumerated,
    Enumerating,
    EnumeratingSimulations,
    Implementation,
    Measuring,
    NeverAccepted,
    Refused,
    Simulating,
    Task,
    Tracing,
    TracingSimulations,
)
from .implementations.reference import Ourselves
from .judge import Result, judge
from .vector import ConformanceVector
from .vector_files import load_vectors
from .verdict import VectorVerdict

__all__ = [
    "ConformanceVector",
    "Enumerated",
    "Enumerating",
    "EnumeratingSimulations",
    "Implementation",
    "Measuring",
    "NeverAccepted",
    "Ourselves",
    "Refused",
    "Result",
    "Simulating",
    "Task",
    "Tracing",
    "TracingSimulations",
    "VectorVerdict",
    "judge",
    "load_vectors",
]
