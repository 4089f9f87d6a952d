"""The parts that all matchers share: drawing scenes, and places in them such as `params.r`,
`objects[1].position[0]`, `ego.heading`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeGuard

from ..implementations.protocol import Implementation, NeverAccepted, Refused, SceneRecord, Task
from ..strict_tables import VectorFields
from ..verdict import VectorVerdict, failed_verdict

STEP = re.compile(r"\.?([A-Za-z_][\w-]*)|\[(\d+)\]")
NO_TABLE: Mapping[str, object] = {}


class NotThere(Exception):
    """The scene has nothing at the path."""


@dataclass(frozen=True, slots=True)
class Path:
    """A place in a scene. `ego` stands for the ego's entry among the objects; properties are found with or without `properties`."""

    text: str
    steps: tuple[str | int, ...]

    def __str__(self) -> str:
        return self.text

    def read(self, scene: SceneRecord) -> object:
        """Return the value at this place of a scene. Raises `NotThere`."""
        found: object = scene
        for number, step in enumerate(self.steps):
            found = ego_of(scene) if number == 0 and step == "ego" else child(found, step)
            if found is NotThere:
                raise NotThere(f"the scene has no {self.text}")
        return found


def ego_of(scene: SceneRecord) -> object:
    """The entry of the ego among the objects."""
    number = scene.get("ego")
    return child(child(scene, "objects"), number) if isinstance(number, int) else NotThere


def child(value: object, step: str | int) -> object:
    """The value of a key or the item of a list, `NotThere` if there is none."""
    if isinstance(step, int):
        return value[step] if isinstance(value, list) and 0 <= step < len(value) else NotThere
    if not isinstance(value, Mapping):
        return NotThere
    properties = value.get("properties")
    further = properties if isinstance(properties, Mapping) else NO_TABLE
    return value[step] if step in value else further.get(step, NotThere)


def read_path(fields: VectorFields, key: str = "of") -> Path:
    """The path under a key of a vector file. Raises `UsageError`."""
    text = fields.text(key)
    steps: list[str | int] = []
    place = 0
    while place < len(text):
        step = STEP.match(text, place)
        if step is None:
            break
        steps.append(step[1] if step[1] is not None else int(step[2]))
        place = step.end()
    if place < len(text) or not steps or steps[0] not in ("params", "objects", "ego"):
        raise fields.wrong(f"{key} must be a path such as params.r or objects[0].position[1], not {text!r}")
    return Path(text, tuple(steps))


def close(found: object, expected: object, tolerance: float) -> bool:
    """Equality: numbers within the tolerance, lists item by item, tables in the keys that are expected; `{none = true}` is null."""
    match expected:
        case {"none": True}:
            return found is None
        case bool() | str():
            return type(found) is type(expected) and found == expected
        case int() | float():
            return is_json_number(found) and abs(found - expected) <= tolerance
        case list():
            if not isinstance(found, list) or len(found) != len(expected):
                return False
            return all(close(f, e, tolerance) for f, e in zip(found, expected, strict=True))
        case Mapping():
            return isinstance(found, Mapping) and all(key in found and close(found[key], e, tolerance) for key, e in expected.items())
        case _:
            return False


def is_json_number(value: object) -> TypeGuard[int | float]:
    """Whether a decoded JSON value is a number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def unwrap_heading(found: object, expected: object) -> object:
    """A heading moved by whole turns to where it is nearest to the expected one; anything else as it is."""
    if not (is_json_number(found) and is_json_number(expected) and math.isfinite(found - expected)):
        return found
    return found - math.tau * round((found - expected) / math.tau)


ATTEMPTS = 100_000
"""The most attempts at one scene, where a vector does not say how many."""


class Disagreement(Exception):
    """The implementation does not agree with the vector, and why."""


def draw(implementation: Implementation, task: Task, count: int) -> list[SceneRecord]:
    """`count` scenes. Raises `Disagreement` if the implementation does not give them."""
    try:
        scenes = list(implementation.scenes(task, count, seed=task.seed, attempts=ATTEMPTS))
    except Refused as refused:
        raise Disagreement(f"{refused.when}: {refused.message}") from None
    except NeverAccepted as never:
        raise Disagreement(f"no run was accepted: {requirements(never)}") from None
    if len(scenes) != count:
        raise Disagreement(f"gave {len(scenes)} scenes, and {count} were asked for")
    return scenes


def requirements(never: NeverAccepted) -> str:
    """The requirements that failed, in words."""
    return "the requirements are not reported" if never.requirements is None else "these failed: " + ", ".join(sorted(never.requirements))


def read_at_path(scenes: Sequence[SceneRecord], path: Path) -> list[object]:
    """Return the value at a place of each scene. Raises `Disagreement` if there is none."""
    try:
        return [path.read(scene) for scene in scenes]
    except NotThere as missing:
        raise Disagreement(str(missing)) from None


def disagreement_verdict(disagreement: Disagreement) -> VectorVerdict:
    """The verdict of a disagreement."""
    return failed_verdict(str(disagreement))

