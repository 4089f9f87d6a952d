"""The memory and time that an untrusted program may take, as the command line gives them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ...semantics.store.errors import UsageError

UNITS = {"": 1, "K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}
LEAST_MEMORY = 16 << 20


class Limits(NamedTuple):
    """How much more memory the process may take, in bytes, and the processor time of one run, in seconds; None: no limit."""

    memory: int | None
    seconds: float | None


DEFAULT_LIMITS = Limits(4 << 30, 60.0)


def wrong(message: str) -> UsageError:
    """The error; its import takes longer than all of `--help`."""
    from ...semantics.store.errors import UsageError

    return UsageError(message)


def bytes_of(text: str) -> int | None:
    """`512M`, `4G`, or `none`. Raises `UsageError`."""
    if text.lower() == "none":
        return None
    number = text.upper().removesuffix("B").removesuffix("I")
    unit = number[-1:] if number[-1:] in UNITS and not number[-1:].isdigit() else ""
    digits = number.removesuffix(unit)
    found = int(digits) * UNITS[unit] if digits.isascii() and digits.isdigit() and len(digits) < 16 else 0
    if found < LEAST_MEMORY:
        raise wrong(f"--limit-memory expects a size of at least 16M, such as 512M or 4G, or none, not {text!r}")
    return found


def seconds_of(text: str) -> float | None:
    """A number of seconds, or `none`. Raises `UsageError`."""
    if text.lower() == "none":
        return None
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not 0.01 <= found <= 1e6:
        raise wrong(f"--limit-seconds expects a number of seconds from 0.01 to 1000000, or none, not {text!r}")
    return found
