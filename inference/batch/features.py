"""Columns as features: those that comparisons of scenes look at, for the scenes of a block, without making the scenes one by one.

They are those of `statistics.columns.features_table` for these scenes, number for number; with what the graph says about their values.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ...data.scene import json_value
from ...semantics.machine.values import Random
from ...semantics.space.vectors import Vector
from ..comparison.known_features import Support
from ..comparison.scene_columns import (
    OTHERWISE,
    FeatureTable,
    arrays_of,
    below,
    columns_of,
    features_table,
    flatten_json_leaves,
    stack_tables,
)
from .block_rejection import Block
from .graph import GraphNode
from .jobs.scene_lines import attempts_of, others, own_fields
from .row_calls import Columns
from .scene_template import Template, row_values
from .symbolic import Choice, Opaque, Traced, symbols_in

Arrays = Iterator[tuple[str, np.ndarray]]


def features_in(template: Template, block: Block) -> FeatureTable:
    """The features of the scenes of a block, in order."""
    made = _features(template, block)
    if not block.others:
        return made
    whole = stack_tables([made, *(features_table([scene]) for scene in block.others.values())])
    order = np.argsort(np.concatenate([block.rows, np.fromiter(block.others, dtype=np.int64, count=len(block.others))]), kind="stable")
    return FeatureTable(whole.chosen(order).arrays, whole.n)


def _features(template: Template, block: Block) -> FeatureTable:
    """The features of the scenes in the columns of a block."""
    count, columns = len(block.rows), block.columns
    if not count:
        return FeatureTable({}, 0)
    made: dict[str, np.ndarray] = {"attempts": attempts_of(block).astype(float)}
    made |= constant_feature_columns("ego", str(template.ego_id), count)
    for name, value in template.params.items():
        made |= leaves_of(f"params.{name}", value, columns, count)
    made |= constant_feature_columns("objects", str(len(template.objects)), count)
    for i, o in enumerate(template.objects):
        place = f"objects[{i}]"
        x, y, heading, width, length = own_fields(o, columns, count)
        made |= constant_feature_columns(f"{place}.class", o.class_name, count)
        made |= {f"{place}.position[0]": as_floats(x), f"{place}.position[1]": as_floats(y)}
        made |= {f"{place}.heading": as_floats(heading), f"{place}.width": as_floats(width), f"{place}.length": as_floats(length)}
        for name, value in others(o).items():
            made |= leaves_of(f"{place}.properties.{name}", value, columns, count)
    return FeatureTable(made, count)


def as_floats(values: np.ndarray | list[object]) -> np.ndarray:
    """Numbers as a column of floats."""
    return np.array(values, dtype=np.float64)


def constant_feature_columns(name: str, value: object, count: int) -> Mapping[str, np.ndarray]:
    """The column of a value that is the same in all scenes."""
    return {leaf: np.repeat(values, count) for leaf, values in columns_of(name, [value])}


def leaves_of(name: str, value: object, columns: Columns, count: int) -> Mapping[str, np.ndarray]:
    """The columns of the leaves of `json_value(value)`."""
    return dict(_leaves_of(name, value, columns, count))


def _leaves_of(name: str, value: object, columns: Columns, count: int) -> Arrays:
    match value:
        case _ if not symbols_in(value):
            for leaf, found in below(name, json_value(value)):
                yield from constant_feature_columns(leaf, found, count).items()
        case Traced() if not isinstance(value, (Choice, Opaque)) and is_finite(columns[value.node.number]):
            column = columns[value.node.number]
            yield name, np.where(column, "true", "false").astype(object) if column.dtype == bool else column.astype(np.float64)
        case Random():
            yield from _leaves_of(name, value.value, columns, count)
        case Vector():
            yield from _leaves_of(name, [value.x, value.y], columns, count)
        case list() | tuple() if type(value) in (list, tuple):
            for i, item in enumerate(value):
                yield from _leaves_of(f"{name}[{i}]", item, columns, count)
        case dict() if type(value) is dict and all(type(key) is str for key in value) and set(value) != {"repr"}:
            for key, item in value.items():
                yield from _leaves_of(f"{name}.{key}", item, columns, count)
        case Choice() if not symbols_in(value.values):
            texts = [json_value(v) for v in value.values]
            yield from arrays_of(flatten_json_leaves(name, [texts[k] for k in columns[value.node.number].tolist()])).items()
        case _:
            yield from arrays_of(flatten_json_leaves(name, [json_value(v) for v in row_values(value, columns, count)])).items()


def is_finite(column: np.ndarray) -> bool:
    """Whether a column is numbers of which none is infinite, or truth values."""
    return column.dtype == bool or (column.dtype.kind in "fi" and bool(np.isfinite(column).all()))


# What is known of them


def features_by_name(template: Template) -> Iterator[tuple[str, object]]:
    """The features that are a number or a choice by themselves, as what the program left there."""
    for name, value in template.params.items():
        yield from _named_leaves(f"params.{name}", value)
    for i, o in enumerate(template.objects):
        for name, value in o.properties.items():
            place = f"objects[{i}].{name}" if name in ("position", "heading", "width", "length") else f"objects[{i}].properties.{name}"
            yield from _named_leaves(place, value)


def _named_leaves(name: str, value: object) -> Iterator[tuple[str, object]]:
    match value:
        case Random():
            yield from _named_leaves(name, value.value)
        case Vector():
            yield from _named_leaves(name, [value.x, value.y])
        case list() | tuple() if type(value) in (list, tuple):
            for i, item in enumerate(value):
                yield from _named_leaves(f"{name}[{i}]", item)
        case dict() if type(value) is dict and all(type(key) is str for key in value):
            for key, item in value.items():
                yield from _named_leaves(f"{name}.{key}", item)
        case Traced():
            yield name, value


def nodes_by_feature(template: Template) -> dict[str, GraphNode]:
    """The nodes of the features that are numbers; of a heading only up to whole turns."""
    return {name: v.node for name, v in features_by_name(template) if not isinstance(v, (Choice, Opaque)) and v.node.kind == "float"}  # type: ignore[attr-defined]


def supports_of(template: Template) -> dict[str, Support]:
    """Return bounds on the values of features: numbers by the bounds of their nodes, which hold in every run,
    and choices among values.
    """
    found: dict[str, Support] = {}
    for name, value in features_by_name(template):
        if isinstance(value, Choice):
            if not symbols_in(value.values):
                found |= support_of_choice(name, [json_value(v) for v in value.values])
        elif isinstance(value, Traced) and value.node.kind == "float" and value.node.bounds is not None:
            low, high = value.node.bounds
            if not name.endswith(".heading") or (-math.pi < low and high <= math.pi):
                found[name] = Support(low, high)
    return found


def support_of_choice(name: str, values: Sequence[object]) -> dict[str, Support]:
    """The supports of the leaves of a choice among values in JSON."""
    arrays = arrays_of(flatten_json_leaves(name, list(values)))
    return {leaf: Support(values=tuple(dict.fromkeys(column.tolist()))) for leaf, column in arrays.items() if leaf + OTHERWISE not in arrays}

