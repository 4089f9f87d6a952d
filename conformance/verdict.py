"""Verdicts: passed, failed, skipped and errored are never mixed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["passed", "failed", "skipped", "errored"]
STATUSES: tuple[Status, ...] = ("passed", "failed", "skipped", "errored")


@dataclass(frozen=True, slots=True)
class VectorVerdict:
    """The result of a vector; `reason` says why it did not pass.

    failed: the implementation disagrees with the vector. skipped: the vector does not apply to it. errored: the implementation or
    the harness crashed, so that nothing is known.
    """

    status: Status
    reason: str = ""


PASSED = VectorVerdict("passed")


def failed_verdict(reason: str) -> VectorVerdict:
    """The implementation disagrees with the vector."""
    return VectorVerdict("failed", reason)


def skipped_verdict(reason: str) -> VectorVerdict:
    """The vector does not apply to the implementation."""
    return VectorVerdict("skipped", reason)


def errored_verdict(reason: str) -> VectorVerdict:
    """The implementation or the harness crashed."""
    return VectorVerdict("errored", reason)
