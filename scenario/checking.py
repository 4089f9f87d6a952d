"""Arguments of the interface."""

from __future__ import annotations

from ..semantics.kernel.errors import UsageError


def check_whole(*named: tuple[str, object, int | None]) -> None:
    """Arguments by name, each with its least value. Raises `UsageError` for what is not a whole number, or too small."""
    for what, number, least in named:
        if type(number) is not int or (least is not None and number < least):
            raise UsageError(f"{what} is a whole number{'' if least is None else f' of at least {least}'}, not {number!r}")
