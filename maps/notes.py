"""What is strange in a map and does not keep it from being read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass
class Notes:
    """What is strange in a map and does not keep it from being read: how often, and where first."""

    found: dict[str, list[str]] = field(default_factory=dict[str, list[str]])

    def add(self, what: str, where: str) -> None:
        """One more."""
        self.found.setdefault(what, []).append(where)

    def lines(self) -> list[str]:
        """A line each."""
        return [f"{what}: {_listed(where)}" for what, where in self.found.items()]


def _listed(where: Sequence[str]) -> str:
    return ", ".join(where[:3]) + (f" and {len(where) - 3} more" if len(where) > 3 else "")
