"""What the tests of this folder share: how many programs, and the profile of Hypothesis."""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

COUNT = int(os.environ.get("SCENIC_REF_PROGRAMS", "150"))
"""Finite programs whose sampled frequencies are compared with enumeration; 2000 is the full size."""


def quick(examples: int) -> settings:
    """A derandomised run: the same examples every time."""
    return settings(
        derandomize=True, deadline=None, max_examples=examples, database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
    )
