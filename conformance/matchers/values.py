"""The matchers `values` (what holds in every accepted scene) and `density` (how likely runs are, given what they draw)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..implementations.protocol import Implementation, Measuring, Refused, SceneRecord, Task
from ..strict_tables import VectorFields
from ..verdict import PASSED, VectorVerdict, failed_verdict, skipped_verdict
from .common import Disagreement, NotThere, child, close, disagreement_verdict, draw, unwrap_heading

SCENES = 3


@dataclass(frozen=True, slots=True)
class SceneValues:
    """Parameters, objects by index with some of their properties, and how many objects there are; headings modulo a turn."""

    params: Mapping[str, object]
    objects: tuple[tuple[int, Mapping[str, object]], ...]
    count: int | None
    tolerance: float
    scenes: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Every scene must have the values."""
        try:
            for scene in draw(implementation, task, self.scenes):
                self.check(scene)
        except Disagreement as disagreement:
            return disagreement_verdict(disagreement)
        return PASSED

    def check(self, scene: SceneRecord) -> None:
        """One scene. Raises `Disagreement`."""
        for name, expected in self.params.items():
            self.compare(f"params.{name}", child(scene.get("params"), name), expected)
        objects = scene.get("objects")
        if self.count is not None and (not isinstance(objects, list) or len(objects) != self.count):
            raise Disagreement(f"the scene has {len(objects) if isinstance(objects, list) else 'no'} objects, not {self.count}")
        for index, properties in self.objects:
            for name, expected in properties.items():
                found = child(child(objects, index), name)
                self.compare(f"objects[{index}].{name}", unwrap_heading(found, expected) if name == "heading" else found, expected)

    def compare(self, place: str, found: object, expected: object) -> None:
        """One value. Raises `Disagreement`."""
        if found is NotThere:
            raise Disagreement(f"the scene has no {place}")
        if not close(found, expected, self.tolerance):
            raise Disagreement(f"{place} is {found!r}, not {expected!r} (tolerance {self.tolerance:g})")


def read_values(fields: VectorFields) -> SceneValues:
    """The table `values` of a vector. Raises `UsageError`."""
    params = fields.table("params") if fields.has("params") else None
    objects = [read_object(table) for table in fields.tables("objects")] if fields.has("objects") else []
    count = fields.count("count") if fields.has("count") else None
    found = SceneValues(dict(params.rest) if params else {}, tuple(objects), count, fields.number("tolerance"), fields.count("scenes", SCENES))
    fields.done()
    if not found.params and not found.objects and found.count is None:
        raise fields.wrong("nothing is expected")
    if found.tolerance < 0:
        raise fields.wrong("tolerance must not be negative")
    return found


def read_object(fields: VectorFields) -> tuple[int, Mapping[str, object]]:
    """`{index = 0, position = [...], ...}`."""
    index = fields.any("index")
    if not isinstance(index, int) or isinstance(index, bool) or index < 0:
        raise fields.wrong(f"index must be a whole number from 0, not {index!r}")
    if not fields.rest:
        raise fields.wrong("nothing is expected of the object")
    return index, dict(fields.rest)


SAME = 1e-9
"""How near a density must be, as a share of the expected one."""


@dataclass(frozen=True, slots=True)
class Densities:
    """Of runs, by what they draw in this order: the product of the probabilities, or densities, of what is drawn."""

    runs: tuple[tuple[tuple[object, ...], float], ...]

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Of each run in turn."""
        if not isinstance(implementation, Measuring):
            return skipped_verdict(f"{implementation.name} does not say how likely a run is")
        for draws, density in self.runs:
            try:
                found = implementation.density(task, draws)
            except Refused as refused:
                return failed_verdict(f"{refused.when}: {refused.message}")
            if not math.isclose(found, density, rel_tol=SAME):
                return failed_verdict(f"the density of {list(draws)!r} is {found!r}, not {density!r}")
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

