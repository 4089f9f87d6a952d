"""Where torch evaluates graphs, if it is installed."""

from __future__ import annotations

from ...interpreter.runtime.optional_packages import needed


def check_device(name: str) -> None:
    """Raise `UsageError` unless torch can be used on a device, "cpu" or "cuda": it says what is missing."""
    try:
        from .torch_lowering import device_of
    except ImportError as problem:
        raise needed("a device", "torch", problem) from None
    device_of(name)
