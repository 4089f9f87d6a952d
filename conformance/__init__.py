"""Judging implementations of Scenic: vectors (data), matchers, and the protocol that an implementation answers.

A vector is a program with what the paper says about its scenes; `docs/vectors.md` documents the format.
"""

from __future__ import annotations

from .implementation import Enumerated, Enumerating, Implementation, NeverAccepted, Refused, Task, Tracing
from .loading import load_vectors
from .ourselves import Ourselves
from .running import Result, judge
from .vector import Vector
from .verdict import Verdict

__all__ = [
    "Enumerated", "Enumerating", "Implementation", "NeverAccepted", "Ourselves", "Refused", "Result", "Task", "Tracing", "Vector", "Verdict",
    "judge", "load_vectors",
]
