"""The devices on which torch evaluates graphs, if it is installed."""

from __future__ import annotations

from ...interpreter.runtime.optional_packages import missing_package_error


def check_device(name: str) -> None:
    """Raise `UsageError` unless torch can be used on a device, "cpu" or "cuda": it says what is missing."""
    try:
        from .torch_lowering import device_of
    except ImportError as problem:
        raise missing_package_error("a device", "torch", problem) from None
    device_of(name)
