"""Scenes as columns: one array per property of each object and per parameter, in the order of the scenes.

A column is named by its place in the scene format: `objects[1].position[0]`, `objects[0].properties.color[2]`, `params.time`, `attempts`.
Metres and radians. Relations between objects are in `relations`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter

import numpy as np

from ...data.scene import OWN_FIELDS, Scene, is_int_or_float
from .betting import Array

ABSENT = "(absent)"
OTHERWISE, A_NUMBER = " where it is not a number", "(a number)"
ANGLES = ("heading", "Heading", "bearing")
UNITS = {
    "m": ("position", "width", "length", "viewDistance", "visibleDistance", "positionStdDev", "distance", "smallestGap"),
    "rad": ("viewAngle", "roadDeviation", "headingStdDev"), "m/s": ("speed", "velocity"), "rad/s": ("angularSpeed",),
}  # fmt: skip
"""What features of objects are measured in, besides angles."""
SCALARS = {int, float}


@dataclass(frozen=True)
class Column:
    """The values of one feature, in the order of the scenes: floats (NaN for what is not a number), or (as an object array) strings in JSON."""

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
        return is_relation(self.name)


def is_angle(name: str) -> bool:
    """Whether a feature of that name is an angle."""
    return last_part(name).endswith(ANGLES)


def unit_of(name: str) -> str:
    """Return the unit of a feature of objects, or "" if it is not known."""
    if not (name.startswith("objects[") or is_relation(name)):
        return ""
    return next((unit for unit, names in UNITS.items() if last_part(name) in names), "rad" if is_angle(name) else "")


def is_relation(name: str) -> bool:
    """Whether a feature of that name follows from others."""
    return "(" in name or name == "smallestGap"


def last_part(name: str) -> str:
    """The last part of a feature's name, without indices."""
    return name.partition("(")[0].rpartition(".")[2].partition("[")[0]


class FeatureTable:
    """The features of `n` scenes by name; all columns have that length. `numbers` are those of the scenes, counted from 1."""

    def __init__(self, columns: Mapping[str, Array], n: int, numbers: Array | None = None) -> None:
        self.n = n
        self.arrays = columns
        self.numbers = np.arange(1, n + 1) if numbers is None else numbers

    @cached_property
    def columns(self) -> dict[str, Column]:
        """The columns by name."""
        return {name: Column(name, values) for name, values in self.arrays.items()}

    def rows(self, start: int, stop: int) -> FeatureTable:
        """Some of the scenes, one after the other."""
        return self.chosen(slice(start, max(start, min(stop, self.n))))

    def chosen(self, which: Array | slice) -> FeatureTable:
        """Some of the scenes."""
        numbers = self.numbers[which]
        return FeatureTable({name: values[which] for name, values in self.arrays.items()}, len(numbers), numbers)

    def plus(self, columns: Mapping[str, Array]) -> FeatureTable:
        """The scenes with further features."""
        return FeatureTable({**self.arrays, **columns}, self.n, self.numbers)


# From scenes


def features_table(scenes: Iterable[Scene | Mapping[str, object]]) -> FeatureTable:
    """The table of the features that stand in scenes as they are; the scenes are given as such or as JSON objects in the scene format."""
    written = [scene.to_json() if isinstance(scene, Scene) else scene for scene in scenes]
    return FeatureTable(arrays_of(features_of(written)), len(written))


def arrays_of(features: Iterable[tuple[str, list[object]]]) -> dict[str, Array]:
    """The columns of features that are given as lists of values in JSON."""
    return dict(column for name, values in features for column in columns_of(name, values))


def leaves(scene: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """The features that stand in a scene as they are, by name."""
    return ((name, values[0]) for name, values in features_of([scene]))


def features_of(scenes: Sequence[Mapping[str, object]]) -> Iterator[tuple[str, list[object]]]:
    """The features that stand in scenes as they are, by name, with their value in each scene (`ABSENT` where there is none)."""
    rows = [scene["columns"] for scene in scenes if "columns" in scene]  # rows of a CSV file
    if rows:
        yield from fields(rows)  # type: ignore[arg-type]
        return
    if any("attempts" in scene for scene in scenes):
        yield "attempts", values_at(scenes, "attempts")
    if any("ego" in scene for scene in scenes):
        yield "ego", [ABSENT if v is ABSENT else str(v) for v in values_at(scenes, "ego")]
    params: list[Mapping[str, object]] = [scene.get("params", {}) for scene in scenes]  # type: ignore[misc]
    for name, values in fields(params):
        yield from flatten_json_leaves(f"params.{name}", values)
    lists: list[Sequence[Mapping[str, object]]] = [scene.get("objects", []) for scene in scenes]  # type: ignore[misc]
    yield "objects", [str(len(objects)) for objects in lists]
    for i in range(max(map(len, lists), default=0)):
        objects = [found[i] if i < len(found) else {} for found in lists]
        for name in ("class", *OWN_FIELDS):
            if any(name in o for o in objects):
                yield from flatten_json_leaves(f"objects[{i}].{name}", values_at(objects, name))
        properties: list[Mapping[str, object]] = [o.get("properties", {}) for o in objects]  # type: ignore[misc]
        for name, values in fields(properties):
            yield from flatten_json_leaves(f"objects[{i}].properties.{name}", values)


def fields(rows: Sequence[Mapping[str, object]]) -> Iterator[tuple[str, list[object]]]:
    """All keys, in the order in which they come first, with their value in each row."""
    first = rows[0].keys() if rows else {}.keys()
    if all(row.keys() == first for row in rows):
        yield from ((name, list(map(itemgetter(name), rows))) for name in first)
    else:
        yield from ((name, values_at(rows, name)) for name in dict.fromkeys(name for row in rows for name in row))


def values_at(rows: Sequence[Mapping[str, object]], name: str) -> list[object]:
    """The value of a key in each row."""
    return [row.get(name, ABSENT) for row in rows]


def flatten_json_leaves(name: str, values: list[object]) -> Iterator[tuple[str, list[object]]]:
    """The leaves of values in JSON, one for each scene."""
    kinds = set(map(type, values))
    if not kinds & {list, dict} or (kinds == {dict} and all(v.keys() == {"repr"} for v in values)):  # type: ignore[attr-defined]
        yield name, values
    elif kinds == {list} and len(set(map(len, values))) == 1 and values[0]:  # type: ignore[arg-type]
        for i in range(len(values[0])):  # type: ignore[arg-type]
            yield from flatten_json_leaves(f"{name}[{i}]", [v[i] for v in values])  # type: ignore[index]
    elif kinds == {dict} and values[0] and set(values[0]) != {"repr"} and all(v.keys() == values[0].keys() for v in values):  # type: ignore[attr-defined, call-overload]
        for key in values[0]:  # type: ignore[attr-defined]
            yield from flatten_json_leaves(f"{name}.{key}", [v[key] for v in values])  # type: ignore[index]
    else:
        yield from fields([dict(below(name, v)) for v in values])


def below(name: str, value: object) -> Iterator[tuple[str, object]]:
    """The leaves of a value in JSON."""
    if isinstance(value, list) and value:
        for i, item in enumerate(value):
            yield from below(f"{name}[{i}]", item)
    elif isinstance(value, dict) and value and set(value) != {"repr"}:
        for key, item in value.items():
            yield from below(f"{name}.{key}", item)
    elif value is not ABSENT:
        yield name, value


# Values


def columns_of(name: str, values: list[object]) -> Iterator[tuple[str, Array]]:
    """The column of a feature; where only some values are numbers, one with NaN for the others, and one for what these are."""
    kinds = set(map(type, values))
    if len(kinds) == 1 and values.count(values[0]) == len(values):  # most features of most programs
        yield name, np.broadcast_to(array_of(values[:1]), len(values))
        return
    if kinds <= SCALARS or not kinds & SCALARS:
        yield name, array_of(values, kinds)
        return
    numbers = [is_int_or_float(v) for v in values]
    yield name, array_of([v if known else math.nan for v, known in zip(values, numbers, strict=True)])
    yield name + OTHERWISE, np.array([A_NUMBER if known else comparable_text(v) for v, known in zip(values, numbers, strict=True)], dtype=object)


def array_of(values: list[object], kinds: set[type] | None = None) -> Array:
    """Floats if all are numbers, otherwise each value's JSON text, numbers rounded to nine digits; `kinds` are the types of the values."""
    kinds = set(map(type, values)) if kinds is None else kinds
    if kinds <= SCALARS:
        try:
            return np.array(values, dtype=np.float64)
        except OverflowError:
            pass
    known: dict[object, str] = {}  # equal texts are kept once
    if kinds == {str}:
        return np.array([known.setdefault(v, v) for v in values], dtype=object)  # type: ignore[arg-type]
    if kinds == {dict} and all(v.keys() == {"repr"} for v in values):  # type: ignore[attr-defined]
        known = {name: comparable_text({"repr": name}) for name in {str(v["repr"]) for v in values}}  # type: ignore[index]
        return np.array([known[str(v["repr"])] for v in values], dtype=object)  # type: ignore[index]
    return np.array([known.setdefault(text, text) for text in map(comparable_text, values)], dtype=object)


def comparable_text(value: object) -> str:
    """A value that is compared as a whole."""
    if isinstance(value, str):
        return value
    return f"{value:.9g}" if type(value) is float else json.dumps(value)


# Tables one after the other


def stack_tables(tables: Sequence[FeatureTable]) -> FeatureTable:
    """The scenes of some tables, one after the other; a feature that some lack is absent there."""
    if len(tables) == 1:
        return tables[0]
    known = [table for table in tables if table.n]
    names = dict.fromkeys(name for table in tables for name in table.arrays if not name.endswith(OTHERWISE))
    columns: dict[str, Array] = {}
    for name in names:
        found = [table.arrays.get(name, full(table.n, ABSENT)) for table in known]
        kinds = {values.dtype for values in found}
        if len(kinds) == 1 and not any(name + OTHERWISE in table.arrays for table in tables):
            columns[name] = np.concatenate(found)
        else:
            columns[name] = np.concatenate([v if v.dtype == np.float64 else np.full(len(v), math.nan) for v in found])
            columns[name + OTHERWISE] = np.concatenate([otherwise(table, name) for table in known])
    return FeatureTable(columns, sum(table.n for table in known), np.concatenate([np.zeros(0, dtype=int), *(table.numbers for table in known)]))


def otherwise(table: FeatureTable, name: str) -> Array:
    """Return a feature's values where it is not a number."""
    values = table.arrays.get(name)
    if values is None or values.dtype != np.float64:
        return full(table.n, ABSENT) if values is None else values
    return table.arrays.get(name + OTHERWISE, full(table.n, A_NUMBER))


def full(n: int, text: str) -> Array:
    """A column of one text."""
    return np.broadcast_to(np.array([text], dtype=object), n)
