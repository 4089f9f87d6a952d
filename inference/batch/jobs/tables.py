"""Columns as tables: the rows of the objects of a block, without making the scenes one by one.

What comes out is what `formats.tables.columns_of` gives for these scenes, in the same types.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....formats.columns import EXACT, TypedColumn, column_of, constant, interleaved, nothing, numbers, repeated, taken, vector
from ....formats.scenes import json_value
from ....formats.tables import Columns as TableColumns
from ....formats.tables import column_name, columns_of, ordered, some, together
from ....semantics.kernel.values import Random
from ....semantics.space.vectors import Vector
from ..evaluate.rows import Columns
from ..evaluate.sampling import Block
from ..trace.structures import symbols_in
from ..trace.symbols import Choice, Opaque, Traced
from ..trace.templates import Template, listed
from .lines import OWN_FIELDS, Numbers, attempts_of, others, own_fields


def table_of(template: Template, block: Block, seed: int) -> TableColumns:
    """The columns of a table with the objects of the scenes of a block, one row for each, in order."""
    made = [_table(template, block, seed)] if len(block.rows) else []
    if not block.others:
        return made[0]
    whole = together([*made, *(columns_of([scene.to_json()]) for scene in block.others.values())])
    return some(whole, np.argsort(whole["scene"].values, kind="stable"))


def _table(template: Template, block: Block, seed: int) -> TableColumns:
    """The rows of the scenes in the columns of a block."""
    count, columns, objects = len(block.rows), block.columns, template.objects
    by_object: list[TableColumns] = []
    shared = {"seed": constant(str(seed), count), "scene": numbers(block.rows), "attempts": numbers(attempts_of(block))}
    shared["weight"] = constant(1.0, count)
    params = {column_name("params", name): typed(value, columns, count) for name, value in template.params.items()}
    for number, o in enumerate(objects):
        own = zip(("x", "y", "heading", "width", "length"), own_fields(o, columns, count), strict=True)
        fixed = {name for name in OWN_FIELDS if name != "position" and not symbols_in(o.properties[name])}
        by_object.append({
            **shared, "object": constant(number, count), "ego": constant(number == template.ego_id, count), "name": constant(o.name, count),
            "class": constant(o.class_name, count), **{name: own_column(values, name in fixed) for name, values in own},
            **{column_name("properties", name): typed(value, columns, count) for name, value in others(o).items()}, **params,
        })  # fmt: skip
    names = ordered({name for made in by_object for name in made})
    return {name: interleaved([made[name] if name in made else nothing(count) for made in by_object] or [nothing(0)]) for name in names}


def own_column(values: Numbers, is_fixed: bool) -> TypedColumn:
    """The column of a field of its own, which is the same in all scenes if it is fixed."""
    column = numbers(np.array(values, dtype=float))
    return repeated(column, column.rows) if is_fixed else column


def typed(value: object, columns: Columns, count: int) -> TypedColumn:
    """The column of a property or parameter, of its values in the scene format."""
    match value:
        case _ if not symbols_in(value):
            return constant(json_value(value), count)
        case Choice() if not symbols_in(value.values):
            used, rows = np.unique(columns[value.node.number], return_inverse=True)  # the type is that of what was drawn
            return taken(column_of([json_value(value.values[k]) for k in used.tolist()]), rows)
        case Traced() if not isinstance(value, (Choice, Opaque)):
            return numbers(columns[value.node.number])
        case Random():
            return typed(value.value, columns, count)
        case Vector() if (parts := floats([value.x, value.y], columns, count)) is not None:
            return parts
        case list() | tuple() if type(value) in (list, tuple) and (parts := floats(value, columns, count)) is not None:
            return parts
    return column_of([json_value(v) for v in listed(value, columns, count)])


def floats(values: Sequence[object], columns: Columns, count: int) -> TypedColumn | None:
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
    return TypedColumn(vector(len(found)), stacked) if np.isfinite(stacked).all() else None


__all__ = ["table_of"]
