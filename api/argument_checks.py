"""Arguments of the interface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike

from ..semantics.store.errors import UsageError
from ..semantics.store.suggestions import did_you_mean


def check_whole(*named: tuple[str, object, int | None]) -> None:
    """Arguments by name, each with its least value. Raises `UsageError` for what is not a whole number, or too small."""
    for what, number, least in named:
        if type(number) is not int or (least is not None and number < least):
            raise UsageError(f"{what} is a whole number{'' if least is None else f' of at least {least}'}, not {number!r}")


def check_settings(readings: object, params: object, fuel: object, directory: object) -> None:
    """Check the arguments for loading a scenario. Raises `UsageError` for a value of the wrong type."""
    for what, given, example in (("readings", readings, '{"soft": "scene"}'), ("params", params, '{"time": 12}')):
        if given is not None and not (isinstance(given, Mapping) and all(isinstance(name, str) for name in given)):
            raise UsageError(f"{what} maps names to values, as in {example}, and is not {given!r:.60}")
    check_whole(("fuel", fuel, 1))
    if not isinstance(directory, str | PathLike | None):
        raise UsageError(f"a directory is a text or a `pathlib.Path`, not {directory!r:.60}")


def no_backend(backend: object, known: Sequence[str], *, elsewhere: Sequence[str], there: str) -> UsageError:
    """The error that there is no such backend here; others are `elsewhere`, of the method `there`."""
    listed = f"the backends are {', '.join(known[:-1])} and {known[-1]}"
    hint = f"{there} has it" if backend in elsewhere else did_you_mean(str(backend), known, listed)
    return UsageError(f"there is no backend {backend}", hint=hint)
