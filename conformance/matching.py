"""What all matchers share: drawing scenes, and reading a place in each."""

from __future__ import annotations

from collections.abc import Sequence

from .implementation import Implementation, NeverAccepted, Refused, SceneRecord, Task
from .paths import NotThere, Path
from .verdict import VectorVerdict, failed

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


def read(scenes: Sequence[SceneRecord], path: Path) -> list[object]:
    """What stands at a place of each scene. Raises `Disagreement` where nothing does."""
    try:
        return [path.read(scene) for scene in scenes]
    except NotThere as missing:
        raise Disagreement(str(missing)) from None


def disagreed(disagreement: Disagreement) -> VectorVerdict:
    """The verdict of a disagreement."""
    return failed(str(disagreement))
