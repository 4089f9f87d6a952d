"""Relations between objects: `distance(0, 1)`, `bearing(0, 1)` (of object 1 as seen from object 0, relative to its heading),
`relativeHeading(0, 1)` and `smallestGap`, the least distance between any two boxes. Metres and radians.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np
import shapely

from ...interpreter.scenes import Scene
from .betting import Array
from .columns import Table, features_table

MOST_RELATED = 12  # relations are looked at between the first so many objects
BOX = np.array([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)])


def table_of(scenes: Iterable[Scene | Mapping[str, object]]) -> Table:
    """The table of scenes, with the relations between their objects."""
    return related(features_table(scenes))


def related(table: Table) -> Table:
    """The table with the relations between all pairs of (the first) objects whose poses are numbers throughout."""
    with np.errstate(invalid="ignore"):  # an infinite position is a finding, not an error
        return table.plus(relations(table.arrays))


def relations(columns: Mapping[str, Array]) -> dict[str, Array]:
    """The relations by name."""
    poses = [pose for i in range(MOST_RELATED) if (pose := pose_of(columns, i)) is not None]
    found: dict[str, Array] = {}
    for (i, one), (j, other) in combinations(enumerate(poses), 2):
        dx, dy = other[0] - one[0], other[1] - one[1]
        found[f"distance({i}, {j})"] = np.hypot(dx, dy)
        found[f"bearing({i}, {j})"] = wrapped(np.arctan2(-dx, dy) - one[2])
        found[f"relativeHeading({i}, {j})"] = wrapped(other[2] - one[2])
    known = [boxes(pose) for pose in poses if len(pose) == 5]
    gaps = [shapely.distance(one, other) for one, other in combinations(known, 2)]
    if gaps:
        found["smallestGap"] = np.min(gaps, axis=0)
    return found


def pose_of(columns: Mapping[str, Array], i: int) -> list[Array] | None:
    """x, y, heading and, where they are known, width and length of object `i`."""
    names = [f"objects[{i}].{name}" for name in ("position[0]", "position[1]", "heading", "width", "length")]
    found = [columns[name] for name in names if name in columns and columns[name].dtype == np.float64]
    return found if len(found) == 5 or (len(found) == 3 and all(name in columns for name in names[:3])) else None


def boxes(pose: Sequence[Array]) -> Array:
    """The bounding boxes, as shapes."""
    return np.asarray(shapely.polygons(corners(pose)))


def corners(pose: Sequence[Array]) -> Array:
    """The corners of the bounding boxes, (scenes, 4, 2)."""
    x, y, heading, width, length = pose
    u, v = BOX[:, 0] * width[:, None], BOX[:, 1] * length[:, None]
    s, c = np.sin(heading)[:, None], np.cos(heading)[:, None]
    return np.stack([x[:, None] + u * c - v * s, y[:, None] + u * s + v * c], axis=-1)


def wrapped(angle: Array) -> Array:
    """The angles in (-π, π]."""
    return -((math.pi - angle) % math.tau - math.pi)
