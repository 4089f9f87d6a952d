"""The result of an inference backend besides scenes: the probability of the requirements, the worth of the
scenes, and reasons for doubt.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from ..data.scene import Scene
from ..pictures.notebook_views import count_phrase
from .chain_diagnostics import Diagnosis

LEVEL = 0.999
"""Of the intervals for probabilities."""
LARGEST_RHAT = 1.05
"""Chains or repetitions with a larger R-hat do not agree."""
FEWEST = 50.0
"""With fewer effective draws than this, means and quantiles are not to be trusted."""


WIDEST = 100.0
"""The probability that a run is accepted is not to be trusted where the ends of its interval differ by a larger factor."""
MOST_UNSEEN = 0.5
"""Scenes with weights that may lack more of the probability than this are not to be trusted."""


class Probability(NamedTuple):
    """An estimate of the probability that a run is accepted, with an interval that holds it with probability `level`; for splitting and chains, as
    far as the accepted runs were found at all: of a part that no population met, nothing can tell.
    """

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
    names: tuple[str, ...] = ()
    draws: np.ndarray | None = None
    """What chains or populations drew of each quantity of that name, (names, chains, draws); the scenes are some of these draws."""
    unseen: float = 0.0
    """The part of the probability that the scenes may lack, at most, as far as the interval of the acceptance tells."""
    levels: tuple[dict[str, object], ...] = ()
    """Of splitting: each level of violation, the part of the states that met it, and by kind of move the part that was taken there."""
    moves: Mapping[str, float] = MappingProxyType({})
    """Of chains: by kind of move the part that was taken."""

    def __repr__(self) -> str:
        trusted = "" if self.agrees else ", not to be trusted"
        return f"<{count_phrase(len(self.scenes), 'scene')} by {self.backend} in {count_phrase(self.attempts, 'run')}{trusted}>"

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
        for worth, what in ((self.diagnosis.bulk, "means"), (self.diagnosis.tail, "quantiles")):
            if not worth >= FEWEST:
                found.append(f"the draws are worth {worth:.0f} independent ones for {what}, fewer than {FEWEST:.0f}")
        if not self.acceptance.high <= WIDEST * self.acceptance.low:
            found.append(f"the probability that a run is accepted is anything from {self.acceptance.low:.3g} to {self.acceptance.high:.3g}")
        if self.unseen > MOST_UNSEEN:
            found.append(f"runs that were not seen may hold {self.unseen:.0%} of the probability")
        return found

    def report(self) -> dict[str, object]:
        """The report, as `run --report` writes it."""
        return backend_report(
            self.backend, len(self.scenes), self.attempts, self.acceptance, self.diagnosis.bulk, self.diagnosis.tail, self.diagnosis.rhat,
            self.seconds, self.doubts,
        ) | {
            name: value
            for name, value in (("notes", list(self.notes)), ("levels", list(self.levels)), ("moves", dict(self.moves)))
            if value
        }  # fmt: skip


def backend_report(
    backend: str, scenes: int, attempts: int, acceptance: Probability, bulk: float | None, tail: float | None, rhat: float | None,
    seconds: float | None, warnings: Sequence[str],
) -> dict[str, object]:  # fmt: skip
    """The report of any backend; what is not known, or not a number, is None."""

    def known(value: float | None) -> float | None:
        return float(value) if value is not None and math.isfinite(value) else None

    return {
        "backend": backend, "scenes": scenes, "attempts": attempts,
        "acceptance": {"estimate": known(acceptance.estimate), "low": acceptance.low, "high": acceptance.high, "level": acceptance.level},
        "ess": {"bulk": known(bulk), "tail": known(tail)}, "rhat": known(rhat), "seconds_cpu": known(seconds), "warnings": list(warnings),
    }  # fmt: skip
