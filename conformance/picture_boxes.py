"""Scenes of differences that can be seen: the boxes of objects here and in each implementation, for the vectors that show a cause best."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files

from ..pictures.side_by_side import Boxes, boxes_of
from .fuzz.examination import PLACED
from .implementations.harness_client import External
from .implementations.line_process import ImplementationFault
from .implementations.protocol import Implementation, NeverAccepted, Refused, Task
from .implementations.reference import Ourselves
from .known_differences import KnownCause
from .vector import ConformanceVector

FILE = "pictured_scenes.json"
OURS = "scenic-ref"
SCENES, ATTEMPTS = 30, 1_000
ACCEPTANCE = ("no run may be accepted", "instead of never accepted", "no run was accepted")
"""Words of results that are about whether there is a scene at all."""
CLEARLY = 0.25
"""A part of the extent of our scenes that can be seen."""
TRIED = 6
"""Vectors of a cause of which pictures are tried."""


def pictured_scenes() -> dict[str, dict[str, Boxes]]:
    """The boxes that ship: for each vector, by the name of the implementation."""
    return json.loads(files("scenic_ref.conformance").joinpath(FILE).read_text("utf-8"))


def is_seen(line: str) -> bool:
    """Whether a line of results is about places, or about whether there is a scene."""
    return line.startswith("failed") and (PLACED.search(line) is not None or any(words in line for words in ACCEPTANCE))


def scenes_of(implementation: Implementation, task: Task) -> Boxes | None:
    """The boxes of some scenes, each different one once; none if no run is accepted, None if there is an error."""
    try:
        found = boxes_of(list(implementation.scenes(task, SCENES, seed=0, attempts=ATTEMPTS)))
    except NeverAccepted:
        return []
    except (Refused, ImplementationFault):
        return None
    return [scene for number, scene in enumerate(found) if scene not in found[:number]]


def visibly_different_scenes(
    causes: Sequence[KnownCause], vectors: Mapping[str, ConformanceVector], others: Mapping[str, External], kept: Mapping[str, Mapping[str, str]]
) -> Iterator[tuple[str, dict[str, Boxes]]]:
    """For each cause, the first of its vectors whose scenes differ to the eye, with the scenes of each side."""
    for cause in causes:
        seen = [name for name in cause.smallest_first(vectors) if vectors[name].steps is None]
        seen = [name for name in seen if any(is_seen(kept[other].get(name, "")) for other in cause.implementations)]
        for name in seen[:TRIED]:
            sides = sides_of(vectors[name], {other: others[other] for other in cause.implementations})
            if OURS in sides and any(look_different(sides[OURS], scenes) for scenes in sides.values()):
                yield name, sides
                break


def look_different(one: Boxes, other: Boxes) -> bool:
    """Whether scenes differ to the eye: only one side has some, each side has one, or they fill clearly different stretches of land."""
    if (len(one) < 2 and len(other) < 2) or not one or not other:
        return one != other
    ours, theirs = extent(one), extent(other)
    return max(abs(a - b) for a, b in zip(ours, theirs, strict=True)) > CLEARLY * max(ours[1] - ours[0], ours[3] - ours[2])


def extent(scenes: Boxes) -> tuple[float, float, float, float]:
    """The least and the greatest x, then y, of the centres of boxes (metres)."""
    xs, ys = ([box[axis] for scene in scenes for box in scene] for axis in (0, 1))
    return min(xs), max(xs), min(ys), max(ys)


def sides_of(vector: ConformanceVector, others: Mapping[str, External]) -> dict[str, Boxes]:
    """The scenes of a vector here and in each implementation that can be asked for some."""
    found = {OURS: scenes_of(Ourselves(), vector.task(next(iter(vector.texts))))}
    for name, other in others.items():
        dialect = next((d for d in other.dialects if d in vector.texts), None)
        if dialect is not None:
            found[name] = scenes_of(other, vector.task(dialect))
    return {name: scenes for name, scenes in found.items() if scenes is not None}
