"""Scenes as columns: one array per property of each object, per parameter and per relation between objects.

A column is named by its place in the scene format: `objects[1].position[0]`, `objects[0].properties.color[2]`, `params.time`, `attempts`.
Relations are `distance(0, 1)`, `bearing(0, 1)` (of object 1 as seen from object 0, relative to its heading),
`relativeHeading(0, 1)` and `smallestGap`, the least distance between any two boxes. Metres and radians.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely

from ...interpreter.scenes import OWN_FIELDS, Scene
from .betting import Array

ABSENT = "(absent)"
OTHERWISE, A_NUMBER = " where it is no number", "(a number)"
ANGLES = ("heading", "Heading", "bearing")
MOST_RELATED = 12  # relations are looked at between the first so many objects
BOX = np.array([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)])


@dataclass(frozen=True)
class Column:
    """The values of one feature, in the order of the scenes: floats (NaN for what is no number), or (as an object array) strings in JSON."""

    name: str
    values: Array

    @property
    def is_number(self) -> bool:
        """Whether the values are floats."""
        return self.values.dtype == np.float64

    @property
    def is_angle(self) -> bool:
        """Whether the values are angles, which are equal modulo 2π."""
        return is_angle(self.name)

    @property
    def is_relation(self) -> bool:
        """Whether the feature follows from others."""
        return "(" in self.name or self.name == "smallestGap"


def is_angle(name: str) -> bool:
    """Whether a feature of that name is an angle."""
    return last_part(name).endswith(ANGLES)


def last_part(name: str) -> str:
    """The last part of a feature's name, without indices."""
    return name.partition("(")[0].rpartition(".")[2].partition("[")[0]


class Table:
    """The features of `n` scenes by name; all columns have that length."""

    def __init__(self, columns: Mapping[str, Array], n: int) -> None:
        self.n = n
        self.columns = {name: Column(name, values) for name, values in columns.items()}

    def rows(self, start: int, stop: int) -> Table:
        """Some of the scenes."""
        return Table({name: c.values[start:stop] for name, c in self.columns.items()}, max(0, min(stop, self.n) - start))


def table_of(scenes: Iterable[Scene | Mapping[str, object]]) -> Table:
    """The table of scenes, given as such or as JSON objects in the scene format."""
    rows = [dict(leaves(scene.to_json() if isinstance(scene, Scene) else scene)) for scene in scenes]
    names = dict.fromkeys(name for row in rows for name in row)
    columns = dict(column for name in names for column in columns_of(name, [row.get(name, ABSENT) for row in rows]))
    return Table({**columns, **relations(columns, len(rows))}, len(rows))


def columns_of(name: str, values: list[object]) -> Iterator[tuple[str, Array]]:
    """The column of a feature; where only some values are numbers, one with NaN for the others, and one for what these are."""
    numbers = [is_number(v) for v in values]
    if all(numbers) or not any(numbers):
        yield name, array_of(values)
        return
    yield name, array_of([v if known else math.nan for v, known in zip(values, numbers, strict=True)])
    yield name + OTHERWISE, np.array([A_NUMBER if known else text_of(v) for v, known in zip(values, numbers, strict=True)], dtype=object)


def is_number(value: object) -> bool:
    """Whether a value in JSON is a number."""
    return type(value) is float or type(value) is int


def leaves(scene: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """The features that stand in a scene as they are, by name."""
    if "columns" in scene:  # a row of a CSV file
        found = scene["columns"]
        assert isinstance(found, Mapping)
        yield from found.items()
        return
    if "attempts" in scene:
        yield "attempts", scene["attempts"]
    if "ego" in scene:
        yield "ego", str(scene["ego"])
    params, objects = scene.get("params", {}), scene.get("objects", [])
    assert isinstance(params, Mapping) and isinstance(objects, Sequence)
    for name, value in params.items():
        yield from below(f"params.{name}", value)
    yield "objects", str(len(objects))
    for i, o in enumerate(objects):
        for name in ("class", *OWN_FIELDS):
            if name in o:
                yield from below(f"objects[{i}].{name}", o[name])
        for name, value in o.get("properties", {}).items():
            yield from below(f"objects[{i}].properties.{name}", value)


def below(name: str, value: object) -> Iterator[tuple[str, object]]:
    """The leaves of a value in JSON."""
    if isinstance(value, list) and value:
        for i, item in enumerate(value):
            yield from below(f"{name}[{i}]", item)
    elif isinstance(value, dict) and value and set(value) != {"repr"}:
        for key, item in value.items():
            yield from below(f"{name}.{key}", item)
    else:
        yield name, value


def array_of(values: list[object]) -> Array:
    """Floats if all are numbers, otherwise each value's JSON text, numbers rounded to nine digits."""
    if all(map(is_number, values)):
        try:
            return np.array(values, dtype=np.float64)
        except OverflowError:
            pass
    return np.array([text_of(v) for v in values], dtype=object)


def text_of(value: object) -> str:
    """A value that is compared as a whole."""
    if isinstance(value, str):
        return value
    return f"{value:.9g}" if type(value) is float else json.dumps(value)


def relations(columns: Mapping[str, Array], n: int) -> dict[str, Array]:
    """The relations between all pairs of (the first) objects whose poses are numbers throughout."""
    poses = [pose for i in range(MOST_RELATED) if (pose := pose_of(columns, i)) is not None]
    found: dict[str, Array] = {}
    for (i, one), (j, other) in combinations(enumerate(poses), 2):
        dx, dy = other[0] - one[0], other[1] - one[1]
        found[f"distance({i}, {j})"] = np.hypot(dx, dy)
        found[f"bearing({i}, {j})"] = wrapped(np.arctan2(-dx, dy) - one[2])
        found[f"relativeHeading({i}, {j})"] = wrapped(other[2] - one[2])
    gaps = [shapely.distance(boxes(one), boxes(other)) for one, other in combinations(poses, 2) if len(one) == len(other) == 5]
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
    x, y, heading, width, length = pose
    u, v = BOX[:, 0] * width[:, None], BOX[:, 1] * length[:, None]
    s, c = np.sin(heading)[:, None], np.cos(heading)[:, None]
    corners = np.stack([x[:, None] + u * c - v * s, y[:, None] + u * s + v * c], axis=-1)
    return np.asarray(shapely.polygons(corners))


def wrapped(angle: Array) -> Array:
    """The angles in (-π, π]."""
    return -((math.pi - angle) % math.tau - math.pi)
