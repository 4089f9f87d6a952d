"""What an inference backend gives besides scenes: how likely the requirements are, what the scenes are worth, and what is not to be trusted."""

from __future__ import annotations

import math
from typing import NamedTuple

from ..formats.scenes import Scene
from .diagnostics import Diagnosis

LARGEST_RHAT = 1.05
"""Chains or repetitions with a larger R-hat do not agree."""
FEWEST = 50.0
"""With fewer effective draws than this, means and quantiles are not to be trusted."""


class Probability(NamedTuple):
    """An estimate of the probability that a run is accepted, with an interval that holds it with probability `level`."""

    estimate: float
    low: float
    high: float
    level: float


class Inferred(NamedTuple):
    """Scenes of a program, drawn given its requirements, and the report on them. `attempts` are the runs that were looked at."""

    backend: str
    scenes: list[Scene]
    acceptance: Probability
    attempts: int
    diagnosis: Diagnosis
    feature: str
    """The feature about which chains or repetitions agree least."""
    seconds: float
    """Of a processor."""
    notes: tuple[str, ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether what the scenes say can be trusted, as far as the diagnostics tell."""
        return not self.doubts

    @property
    def doubts(self) -> list[str]:
        """Why the scenes cannot be trusted."""
        found: list[str] = []
        if not self.diagnosis.rhat <= LARGEST_RHAT:
            found.append(f"independent parts of the work disagree about {self.feature}: R-hat is {self.diagnosis.rhat:.3f}, more than {LARGEST_RHAT}")
        if not self.diagnosis.bulk >= FEWEST:
            found.append(f"the draws are worth {self.diagnosis.bulk:.0f} independent ones, fewer than {FEWEST:.0f}")
        return found

    def report(self) -> dict[str, object]:
        """The report, as `run --report` writes it."""
        p = self.acceptance
        return {
            "backend": self.backend, "scenes": len(self.scenes), "attempts": self.attempts,
            "acceptance": {"estimate": p.estimate, "low": p.low, "high": p.high, "level": p.level},
            "ess": {"bulk": self.diagnosis.bulk, "tail": self.diagnosis.tail},
            "rhat": self.diagnosis.rhat if math.isfinite(self.diagnosis.rhat) else None,
            "seconds_cpu": self.seconds, "warnings": [*self.doubts, *self.notes],
        }  # fmt: skip
