"""What a reading is: one way to resolve a place where the paper contradicts itself or is silent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

PROFILES = ("paper", "formal", "prose", "scenic-2.1", "scenic-3")


@dataclass(frozen=True, slots=True)
class Probe:
    """A program that tells the alternatives of a reading apart; `shows` says, per alternative, exactly what it must show."""

    program: str
    shows: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A question that the paper leaves open, or answers twice.

    `alternatives` maps each alternative to what it means, the `paper` profile's first; `places` are those of the paper;
    `code` names the functions in which the choice is made; `profiles` lists the profiles that deviate from `paper`.
    `about` says what the reading decides: the scene, the policy (behaviors, monitors, scenarios while they run) or the
    pruning of the sample space. `code` is empty where the part that decides is not built yet.
    """

    id: str
    kind: Literal["conflict", "silence"]
    question: str
    places: tuple[str, ...]
    alternatives: Mapping[str, str]
    code: tuple[str, ...]
    consequence: str = ""
    about: Literal["scene", "policy", "pruning"] = "scene"
    profiles: Mapping[str, str] = field(default_factory=dict)
    probe: Probe | None = None

    @property
    def default(self) -> str:
        """The alternative of the `paper` profile."""
        return next(iter(self.alternatives))

    @property
    def is_note(self) -> bool:
        """Whether there is one answer only: a decision that is written down, not one that can be switched."""
        return len(self.alternatives) == 1

    def under(self, profile: str) -> str:
        """The alternative of a profile."""
        return self.profiles.get(profile, self.default)
