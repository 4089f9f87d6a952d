"""Columns as tables: the rows of the objects of a block, without making the scenes one by one.

What comes out is what `data.scene_tables.columns_of` gives for these scenes, in the same types.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ....data.scene import OWN_FIELDS, json_value
from ....data.scene_tables import Columns as TableColumns
from ....data.scene_tables import column_name, columns_of, order_columns, some, together
from ....data.typed_columns import (
    EXACT,
    TypedColumn,
    again,
    column_of,
    constant_column,
    empty_column,
    interleave_columns,
    numbers,
    repeat_first_row,
    take_rows,
    vector_type,
)
from ....semantics.machine.values import Random
from ....semantics.space.vectors import Vector
from ..block_rejection import Block
from ..row_calls import Columns
from ..scene_template import ObjectTemplate, Template, row_values
from ..symbolic import Choice, Opaque, Traced, symbols_in
from .scene_lines import Numbers, attempts_of, coordinates, floats, normalise_heading_column, others


class Tables:
    """The maker of tables of a program's scenes, block by block; values that are equal in all scenes are
    examined once.
    """

    def __init__(self, template: Template) -> None:
        self.template = template
        self.params = varying_columns("params", template.params)
        self.properties = [varying_columns("properties", others(o)) for o in template.objects]
        self.own = [[field for field in OWN_FIELDS if symbols_in(o.properties[field])] for o in template.objects]
        self.fixed = [fixed_of(template, number) for number in range(len(template.objects))]
        """For each object what is the same in all scenes: columns of one row."""
        self.patterns = {
            n: interleave_columns([f[n] for f in self.fixed]) for n in self.fixed[0] if all(n in f for f in self.fixed)
        } if self.fixed else {}
        """Columns that are the same in all scenes: the rows of one scene."""

    def of(self, block: Block, seed: int) -> TableColumns:
        """The columns of a table with the objects of the scenes of a block, one row for each, in order."""
        made = [self.drawn(block, seed)] if len(block.rows) else []
        if not block.others:
            return made[0]
        whole = together([*made, *(columns_of([scene.to_json()]) for scene in block.others.values())])
        return some(whole, np.argsort(whole["scene"].values, kind="stable"))

    def drawn(self, block: Block, seed: int) -> TableColumns:
        """The rows of the scenes in the columns of a block."""
        count, columns, objects = len(block.rows), block.columns, self.template.objects
        if not objects:
            return {name: empty_column(0) for name in order_columns(())}
        rows = count * len(objects)
        found = {"seed": constant_column(str(seed), rows), "weight": constant_column(1.0, rows)}
        found |= {name: again(pattern, count) for name, pattern in self.patterns.items()}
        shared = {"scene": numbers(block.rows), "attempts": numbers(attempts_of(block))}
        shared |= {name: typed_column_of(value, columns, count) for name, value in self.params.items()}
        by_object: list[TableColumns] = []
        for o, own, properties, fixed in zip(objects, self.own, self.properties, self.fixed, strict=True):
            made = shared | own_columns(o, own, columns, count) | {name: typed_column_of(value, columns, count) for name, value in properties.items()}
            by_object.append(made | {name: repeat_first_row(column, count) for name, column in fixed.items() if name not in found})
        for name in {name for made in by_object for name in made}:
            found[name] = interleave_columns([made[name] if name in made else empty_column(count) for made in by_object])
        return {name: found[name] for name in order_columns(found)}


def varying_columns(part: str, values: Mapping[str, object]) -> dict[str, object]:
    """Return the properties or parameters that differ between scenes, by their columns."""
    return {column_name(part, name): value for name, value in values.items() if symbols_in(value)}


def fixed_of(template: Template, number: int) -> TableColumns:
    """Return the values of an object and the parameters that are equal in all scenes: columns of one row."""
    o = template.objects[number]
    found = {"object": number, "ego": number == template.ego_id, "name": o.name, "class": o.class_name}
    for part, values in (("properties", others(o)), ("params", template.params)):
        found |= {column_name(part, name): json_value(value) for name, value in values.items() if not symbols_in(value)}
    own = [field for field in OWN_FIELDS if not symbols_in(o.properties[field])]
    return {name: column_of([value]) for name, value in found.items()} | own_columns(o, own, {}, 1)


def own_columns(o: ObjectTemplate, fields: Sequence[str], columns: Columns, count: int) -> TableColumns:
    """The columns of some of the fields that all objects have: x and y for the position, the heading in (-π, π]."""
    found: dict[str, Numbers] = {}
    for field in fields:
        value = o.properties[field]
        if field == "position":
            found["x"], found["y"] = coordinates(value, columns, count)
        else:
            found[field] = normalise_heading_column(floats(value, columns, count)) if field == "heading" else floats(value, columns, count)
    return {name: numbers(np.array(values, dtype=float)) for name, values in found.items()}


def typed_column_of(value: object, columns: Columns, count: int) -> TypedColumn:
    """The column of a property or parameter, of its values in the scene format."""
    match value:
        case Choice() if not symbols_in(value.values):
            drawn = columns[value.node.number].astype(np.int64, copy=False)
            is_drawn = np.bincount(drawn, minlength=len(value.values)) > 0  # the type is that of what was drawn
            few = column_of([json_value(value.values[k]) for k in np.flatnonzero(is_drawn).tolist()])
            return take_rows(few, (np.cumsum(is_drawn) - 1)[drawn])
        case Traced() if not isinstance(value, (Choice, Opaque)):
            return numbers(columns[value.node.number])
        case Random():
            return typed_column_of(value.value, columns, count)
        case Vector() if (parts := lists_of([value.x, value.y], columns, count)) is not None:
            return parts
        case list() | tuple() if type(value) in (list, tuple) and (parts := lists_of(value, columns, count)) is not None:
            return parts
    return column_of([json_value(v) for v in row_values(value, columns, count)])


def lists_of(values: Sequence[object], columns: Columns, count: int) -> TypedColumn | None:
    """Lists of numbers, where all are floats or constant numbers, and finite; else None."""
    found = []
    for value in values:
        if isinstance(value, Traced) and not isinstance(value, (Choice, Opaque)) and columns[value.node.number].dtype == float:
            found.append(columns[value.node.number])
        elif isinstance(value, float | int) and not isinstance(value, bool) and abs(value) <= EXACT:
            found.append(np.full(count, float(value)))
        else:
            return None
    stacked = np.stack(found, axis=1)
    return TypedColumn(vector_type(len(found)), stacked) if np.isfinite(stacked).all() else None


__all__ = ["Tables"]
