"""The matcher `values`: what holds, to a stated tolerance, in every accepted scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .fields import VectorFields
from .implementation import Implementation, SceneRecord, Task
from .matching import Disagreement, disagreed, draw
from .paths import NotThere, child, close, turned
from .verdict import PASSED, VectorVerdict

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
            return disagreed(disagreement)
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
                self.compare(f"objects[{index}].{name}", turned(found, expected) if name == "heading" else found, expected)

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
