"""Columns as text and as tables: the lines and rows of the scenes of a block, without making the scenes one by one.

What comes out is what `Scene.to_line` and `formats.tables.columns_of` give for these scenes, byte for byte.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np

from ....formats.scenes import FINITE_IN_JSON, OWN_FIELDS, in_json, json_value, object_entry, scene_entry
from ....formats.tables import COLUMNS, Texts, chosen, columns_of, joined
from ....formats.tables import Columns as TableColumns
from ....semantics.kernel.values import Random
from ....semantics.space.geometry import normalise_heading
from ....semantics.space.vectors import Vector
from ..evaluate.rows import Columns
from ..evaluate.sampling import Block
from ..trace.structures import symbols_in
from ..trace.symbols import Choice, Opaque, Traced
from ..trace.templates import ObjectTemplate, Template, listed

Cells = str | list[str]
"""A piece of text: the same in all rows, or one for each."""
Numbers = np.ndarray | list[object]
"""A number for each row: floats, or what the program made of them."""
TRUTHS = ("false", "true")


class Written(NamedTuple):
    """A value in JSON, in pieces of text."""

    pieces: Sequence[Cells]


# Lines


def lines_of(template: Template, block: Block, seed: int) -> list[str]:
    """The line of each scene of a block, in order, without line ends."""
    made = iter(_lines(template, block, seed))
    indices = range(block.start, block.start + len(block.attempts))
    return [block.others[k].to_line() if k in block.others else next(made) for k in indices] if block.others else list(made)


def _lines(template: Template, block: Block, seed: int) -> list[str]:
    """The lines of the scenes in the columns of a block."""
    count = len(block.rows)
    indices, attempts = (Written([list(map(str, whole.tolist()))]) for whole in (block.rows, attempts_of(block)))
    params = Written(mapping(template.params, block.columns, count))
    objects = [_object(number, o, block.columns, count) for number, o in enumerate(template.objects)]
    found = assembled(written(scene_entry(seed, indices, attempts, 1.0, params, template.ego_id, objects, pruned=template.pruned)))
    return [found] * count if isinstance(found, str) else found


def _object(number: int, o: ObjectTemplate, columns: Columns, count: int) -> dict[str, object]:
    """The entry of an object."""
    x, y, heading, width, length = (Written([finite(values)]) for values in own_fields(o, columns, count))
    return object_entry(number, o.name, o.class_name, x, y, heading, width, length, Written(mapping(others(o), columns, count)))


def own_fields(o: ObjectTemplate, columns: Columns, count: int) -> tuple[Numbers, Numbers, Numbers, Numbers, Numbers]:
    """Position (of the type that the program gave it), heading in (-π, π], width and length, in metres and radians, each (count,)."""
    position, heading, width, length = (o.properties[name] for name in OWN_FIELDS)
    if isinstance(position, Vector):
        x, y = exact(position.x, columns, count), exact(position.y, columns, count)
    else:
        pairs = listed(position, columns, count)
        x, y = [p.x for p in pairs], [p.y for p in pairs]  # type: ignore[attr-defined]
    turned: np.ndarray = normalise_heading(floats(heading, columns, count))  # type: ignore[arg-type, assignment]
    return x, y, turned, floats(width, columns, count), floats(length, columns, count)


def exact(value: object, columns: Columns, count: int) -> Numbers:
    """A number as a column of floats where it is one, else as a list of what it is."""
    column = columns[value.node.number] if isinstance(value, Traced) and not isinstance(value, (Choice, Opaque)) else None
    return column if column is not None and column.dtype == float else listed(value, columns, count)


def others(o: ObjectTemplate) -> dict[str, object]:
    """The properties that have no field of their own."""
    return {name: value for name, value in o.properties.items() if name not in OWN_FIELDS}


def floats(value: object, columns: Columns, count: int) -> np.ndarray:
    """A number as a column of floats."""
    return np.array(exact(value, columns, count), dtype=float)


def attempts_of(block: Block) -> np.ndarray:
    """How many attempts the scenes in the columns needed."""
    return block.attempts[block.rows - block.start] + 1


# JSON


def text(value: object) -> str:
    """The JSON text of a value in the scene format. Raises `ValueError` for numbers that JSON does not have."""
    return in_json(value)


def finite(values: Numbers) -> Cells:
    """The JSON text of numbers. Raises `ValueError` for those that JSON does not have."""
    if isinstance(values, np.ndarray) and np.isfinite(values).all():
        return list(map(FINITE_IN_JSON, values.tolist()))
    return list(map(text, values.tolist() if isinstance(values, np.ndarray) else values))


def assembled(pieces: Sequence[Cells]) -> Cells:
    """Pieces of text one after the other."""
    varying = [piece for piece in pieces if not isinstance(piece, str)]
    if not varying:
        return "".join(pieces)  # type: ignore[arg-type]
    form = "".join(piece.replace("%", "%%") if isinstance(piece, str) else "%s" for piece in pieces)
    return [form % row for row in zip(*varying, strict=True)]


def written(value: object) -> Sequence[Cells]:
    """A value in JSON, parts of which are written already, in pieces."""
    match value:
        case Written(pieces=pieces):
            return pieces
        case dict():
            inner = [(f"{', ' if number else ''}{text(name)}: ", *written(part)) for number, (name, part) in enumerate(value.items())]
            return ["{", *chain.from_iterable(inner), "}"]
        case list():
            return ["[", *chain.from_iterable((", " if number else "", *written(part)) for number, part in enumerate(value)), "]"]
        case _:
            return [text(value)]


def mapping(values: dict[str, object], columns: Columns, count: int) -> Sequence[Cells]:
    """An object of JSON, in pieces."""
    return written({name: Written(cells(value, columns, count)) for name, value in values.items()})


def sequence(values: Sequence[object], columns: Columns, count: int) -> Sequence[Cells]:
    """An array of JSON, in pieces."""
    return written([Written(cells(value, columns, count)) for value in values])


def cells(value: object, columns: Columns, count: int) -> Sequence[Cells]:
    """The JSON text of `json_value(value)` in each row, in pieces."""
    match value:
        case _ if not symbols_in(value):
            return [text(json_value(value))]
        case Choice() if not symbols_in(value.values):
            texts = [text(json_value(v)) for v in value.values]
            return [[texts[k] for k in columns[value.node.number].tolist()]]
        case Traced() if not isinstance(value, (Choice, Opaque)):
            return [numbers(columns[value.node.number])]
        case Random():
            return cells(value.value, columns, count)
        case Vector():
            return sequence([value.x, value.y], columns, count)
        case list() | tuple() if type(value) in (list, tuple):
            return sequence(value, columns, count)
        case dict() if type(value) is dict and all(type(key) is str for key in value):
            return mapping(value, columns, count)
    return [[text(json_value(v)) for v in listed(value, columns, count)]]


def numbers(column: np.ndarray) -> list[str]:
    """Numbers and truth values as JSON."""
    if column.dtype == bool:
        return [TRUTHS[v] for v in column.tolist()]
    if column.dtype.kind == "f" and np.isfinite(column).all():
        return list(map(FINITE_IN_JSON, column.tolist()))
    return [text(json_value(v)) for v in column.tolist()]


# Tables


def table_of(template: Template, block: Block, seed: int) -> TableColumns:
    """The columns of a table with the objects of the scenes of a block, one row for each, in order."""
    made = _table(template, block, seed)
    if not block.others:
        return made
    whole = joined([made, *(columns_of([scene.to_json()]) for scene in block.others.values())])
    return chosen(whole, np.argsort(whole["scene"], kind="stable"))  # type: ignore[arg-type]


def _table(template: Template, block: Block, seed: int) -> TableColumns:
    """The rows of the scenes in the columns of a block."""
    count, columns, objects = len(block.rows), block.columns, template.objects
    own = [own_fields(o, columns, count) for o in objects]
    by_scene = {"scene": block.rows, "attempts": attempts_of(block), "weight": np.ones(count)}
    by_object = {"object": np.arange(len(objects)), "ego": np.arange(len(objects)) == template.ego_id}
    made: TableColumns = {name: np.repeat(values, len(objects)) for name, values in by_scene.items()}
    made |= {name: np.tile(values, count) for name, values in by_object.items()}
    made |= {name: interleaved([np.array(o[i], dtype=float) for o in own]) for i, name in enumerate(("x", "y", "heading", "width", "length"))}
    made |= {"seed": texts([str(seed)] * len(objects), count), "name": texts([o.name for o in objects], count)}
    made |= {"class": texts([o.class_name for o in objects], count)}
    made |= {"properties": texts([assembled(mapping(others(o), columns, count)) for o in objects], count)}
    made |= {"params": texts([assembled(mapping(template.params, columns, count))] * len(objects), count)}
    return {name: made[name] for name in COLUMNS}


def interleaved(columns: Sequence[np.ndarray]) -> np.ndarray:
    """One value of each column, then the next of each."""
    return np.stack(columns, axis=1).ravel()


def texts(columns: Sequence[Cells | None], count: int) -> Texts:
    """One text of each column, then the next of each."""
    values: list[str | None] = []
    codes: list[np.ndarray] = []
    known: dict[int, np.ndarray] = {}
    for column in columns:
        if id(column) not in known:
            several = isinstance(column, list)
            known[id(column)] = len(values) + (np.arange(count) if several else np.zeros(count, dtype=np.int64))
            values += column if several else [column]  # type: ignore[list-item, arg-type]
        codes.append(known[id(column)])
    return Texts(values, interleaved(codes))


__all__ = ["lines_of", "table_of"]
