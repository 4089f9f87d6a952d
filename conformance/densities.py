"""The matcher `density`: how likely runs are, given what they draw."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from .fields import VectorFields
from .implementation import Implementation, Measuring, Refused, Task
from .verdict import PASSED, VectorVerdict, failed, skipped

SAME = 1e-9
"""How near a density must be, as a share of the expected one."""


@dataclass(frozen=True, slots=True)
class Densities:
    """Of runs, by what they draw in this order: the product of the probabilities, or densities, of what is drawn."""

    runs: tuple[tuple[tuple[object, ...], float], ...]

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Of each run in turn."""
        if not isinstance(implementation, Measuring):
            return skipped(f"{implementation.name} does not say how likely a run is")
        for draws, density in self.runs:
            try:
                found = implementation.density(task, draws)
            except Refused as refused:
                return failed(f"{refused.when}: {refused.message}")
            if not math.isclose(found, density, rel_tol=SAME):
                return failed(f"the density of {list(draws)!r} is {found!r}, not {density!r}")
        return PASSED


def read_densities(fields: VectorFields) -> Densities:
    """`{runs = [{draws = [...], density = ...}, ...]}`. Raises `UsageError`."""
    runs = tuple((tuple(run.items("draws")), positive(run)) for run in each(fields))
    return Densities(runs)


def each(fields: VectorFields) -> Sequence[VectorFields]:
    """The tables of the runs; nothing else may stand there."""
    found = fields.tables("runs")
    fields.done()
    return found


def positive(run: VectorFields) -> float:
    """The density of a run, 0 or more."""
    density = run.number("density")
    run.done()
    if density < 0:
        raise run.wrong(f"density must not be negative, not {density!r}")
    return density
