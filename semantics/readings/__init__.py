"""Readings: where the paper leaves a choice, as data, bundled in profiles.

`paper`, the default, sets an equation aside only where a definition, a table or a drawn figure of the same paper contradicts it. `formal` takes
the formal rules to the letter in each place that has an alternative that does, and is `paper` elsewhere: the conflicts of one alternative
(`always_decided`) are decided alike under every profile. `prose` lets the prose win; `scenic-2.1`
and `scenic-3` do what the released implementations do. A reading of one alternative is a note.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..store.errors import UsageError
from ..store.suggestions import did_you_mean
from .reading import PROFILES, Probe, Reading, load_readings

READINGS: Mapping[str, Reading] = load_readings()


def always_decided() -> tuple[str, ...]:
    """The conflicts of the paper that are decided alike under every profile, `formal` included."""
    return tuple(r.id for r in READINGS.values() if r.kind == "conflict" and r.is_note)


def select(profile: str = "paper", chosen: Mapping[str, str] | None = None) -> dict[str, str]:
    """The alternative of every reading: that of the profile, unless `chosen` names another. Raises `UsageError`."""
    if profile not in PROFILES:
        raise UsageError(f"there is no profile {profile}", hint=did_you_mean(profile, PROFILES, f"there are {', '.join(PROFILES)}"))
    selected = {name: reading.under(profile) for name, reading in READINGS.items()}
    for name, alternative in (chosen or {}).items():
        if name not in READINGS:
            raise UsageError(f"there is no reading {name}", hint=did_you_mean(name, READINGS, f"there are {', '.join(READINGS)}"))
        if alternative not in READINGS[name].alternatives:
            known = ", ".join(READINGS[name].alternatives)
            raise UsageError(f"the reading {name} has no alternative {alternative}", hint=f"it has {known}")
        selected[name] = alternative
    return selected


__all__ = ["PROFILES", "READINGS", "Probe", "Reading", "always_decided", "select"]
