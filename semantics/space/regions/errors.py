"""Errors of regions: no point to choose, too many points, or no region at all."""

from __future__ import annotations


class EmptyRegion(Exception):
    """uniformPointIn of a region without points, or without any length or area (reading `region-sampling`): a stuck run."""

    def __init__(self, region: object, reason: str) -> None:
        super().__init__(f"there is no uniformly random point in this {type(region).__name__}: {reason}")
        self.region = region
        self.reason = reason


class UnboundedRegion(Exception):
    """uniformPointIn of a region that is not bounded: no uniform distribution exists, whatever is drawn."""

    def __init__(self, region: object) -> None:
        super().__init__(f"there is no uniformly random point in this {type(region).__name__}: it is unbounded")
        self.region = region


class BadRegion(ValueError):
    """The arguments do not describe a region: a self-crossing polygon, a negative radius, a coordinate that is no number."""
