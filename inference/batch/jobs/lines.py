"""Columns as text: the lines of the scenes of a block, without making the scenes one by one.

What comes out is what `Scene.to_line` gives for these scenes, byte for byte.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, groupby, repeat
from typing import NamedTuple

import numpy as np

from ....formats.numbers import number_texts
from ....formats.scenes import OWN_FIELDS, in_json, json_value, object_entry, scene_entry
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
        return number_texts(values)
    return list(map(text, values.tolist() if isinstance(values, np.ndarray) else values))


def assembled(pieces: Sequence[Cells]) -> Cells:
    """Pieces of text one after the other."""
    merged: list[Cells] = []
    for is_text, group in groupby(pieces, lambda piece: isinstance(piece, str)):
        several = list(group)
        merged += ["".join(several)] if is_text else several  # type: ignore[arg-type]
    if len(merged) < 2:
        return merged[0] if merged else ""
    count = next(len(piece) for piece in merged if not isinstance(piece, str))
    return list(map("".join, zip(*(repeat(piece, count) if isinstance(piece, str) else piece for piece in merged), strict=True)))


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
        return number_texts(column)
    return [text(json_value(v)) for v in column.tolist()]


__all__ = ["lines_of"]
