"""Relations between objects: `distance(0, 1)`, `bearing(0, 1)` (of object 1 as seen from object 0, relative to its heading),
`relativeHeading(0, 1)` and `smallestGap`, the least distance between any two boxes. Metres and radians.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from ...data.scene import Scene
from ...semantics.space.geometry import boxes_intersect, corners, distance_to_box
from ...semantics.space.vectors import Vector
from .betting import Array
from .scene_columns import FeatureTable, features_table

MOST_RELATED = 12  # the number of objects, from the first on, whose relations are compared


def table_of(scenes: Iterable[Scene | Mapping[str, object]]) -> FeatureTable:
    """The table of scenes, with the relations between their objects."""
    return add_relations(features_table(scenes))


def add_relations(table: FeatureTable) -> FeatureTable:
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
        found[f"bearing({i}, {j})"] = wrap_angles(np.arctan2(-dx, dy) - one[2])
        found[f"relativeHeading({i}, {j})"] = wrap_angles(other[2] - one[2])
    gaps = [gap(one, other) for one, other in combinations([pose for pose in poses if len(pose) == 5], 2)]
    if gaps:
        found["smallestGap"] = np.min(gaps, axis=0)
    return found


def pose_of(columns: Mapping[str, Array], i: int) -> list[Array] | None:
    """x, y, heading and, where they are known, width and length of object `i`."""
    names = [f"objects[{i}].{name}" for name in ("position[0]", "position[1]", "heading", "width", "length")]
    found = [columns[name] for name in names if name in columns and columns[name].dtype == np.float64]
    return found if len(found) == 5 or (len(found) == 3 and all(name in columns for name in names[:3])) else None


def gap(one: Sequence[Array], other: Sequence[Array]) -> Array:
    """The distance between the bounding boxes of two objects: apart, that of a corner of either; 0 where they share a point."""
    first, second = box_of(one), box_of(other)
    apart = np.minimum(nearest_corner(first, second), nearest_corner(second, first))
    return np.where(boxes_intersect(*first, *second), 0.0, apart)


Box = tuple[Vector, float, float, float]


def box_of(pose: Sequence[Array]) -> Box:
    """A column of boxes as one whose numbers are columns."""
    x, y, heading, width, length = pose
    return Vector(x, y), heading, width, length  # type: ignore[arg-type, return-value]


def nearest_corner(box: Box, other: Box) -> Array:
    """The least distance of a corner of the other box from a box."""
    points = corners(*other)
    together = Vector(np.stack([p.x for p in points]), np.stack([p.y for p in points]))  # type: ignore[arg-type]
    return np.min(distance_to_box(*box, together), axis=0)


def wrap_angles(angle: Array) -> Array:
    """The angles in (-π, π]."""
    return -((math.pi - angle) % math.tau - math.pi)
