"""Shell completion: the words that options and commands take."""

from __future__ import annotations

from collections.abc import Callable, Iterable

Completion = Callable[[str], list[str]]


def words(found: Callable[[], Iterable[str]]) -> Completion:
    """Completes the words that there are when the shell asks, so that help stays quick."""

    def complete(incomplete: str) -> list[str]:
        return [word for word in found() if word.startswith(incomplete)]

    return complete


def one_of(*known: str) -> Completion:
    """Return a completion of a fixed list of words."""
    return words(lambda: known)


def dialects() -> Iterable[str]:
    """The dialects of programs."""
    from ..interpreter.language.dialects import DIALECTS

    return DIALECTS


def profiles() -> Iterable[str]:
    """The profiles of readings."""
    from ..semantics.readings import PROFILES

    return PROFILES


def readings() -> Iterable[str]:
    """Return the names of the readings."""
    from ..semantics.readings import READINGS

    return READINGS


def alternatives() -> Iterable[str]:
    """The readings, each with its alternatives."""
    from ..semantics.readings import READINGS

    return (f"{name}={one}" for name, reading in READINGS.items() for one in reading.alternatives)


def models() -> Iterable[str]:
    """Return the names of the world models."""
    from ..simulators.worlds import WORLDS

    return dict.fromkeys(["gtaLib", "mars", "site_map", "scenic.domains.driving.model", *(name for name in WORLDS if name.endswith(".model"))])


def simulators() -> Iterable[str]:
    """Return the names of the simulators."""
    from ..simulators import SIMULATORS

    return SIMULATORS


def map_kinds() -> Iterable[str]:
    """The kinds of maps that can be made."""
    from ..roads.map_generator import KINDS

    return KINDS


__all__ = ["alternatives", "dialects", "map_kinds", "models", "one_of", "profiles", "readings", "simulators", "words"]
