"""Columns as text: the lines of the scenes of a block, without making the scenes one by one.

What comes out is what `Scene.to_line` gives for these scenes, byte for byte.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....data.scene import OWN_FIELDS, Scene, in_json, json_value, object_entry, scene_entry
from ....semantics.machine.values import Random
from ....semantics.space.geometry import normalise_heading
from ....semantics.space.vectors import Vector
from ..block_rejection import Block
from ..row_calls import Columns
from ..scene_template import ObjectTemplate, Template, row_values
from ..symbolic import Choice, Opaque, Traced, symbols_in
from .text_rows import Cells, Picked, joined, merged

if TYPE_CHECKING:
    from ..numba_json import CompiledRows


Numbers = np.ndarray | list[object]
"""A number for each row: floats, or what the program made of them."""
TRUTHS = ("false", "true")
COMPILE, PACE_KNOWN = 2.0, 0.1
"""Seconds of a processor that compiling takes, by and large, and after which the pace is known."""


class Written(NamedTuple):
    """A value in JSON, in pieces of text."""

    pieces: Sequence[Cells]


# Lines


class Lines:
    """The maker of lines of a program's scenes, block by block.

    Once that has taken as long as compiling is expected to take, or will by what is known of its pace,
    compiled code does the rest.
    """

    def __init__(self, template: Template) -> None:
        self.template = template
        self.rows: CompiledRows | None = None
        self.may_compile = True
        self.spent, self.pace = 0.0, 0.0  # seconds of a processor, and for a scene of the last block

    def of(self, block: Block, seed: int, ahead: int = 0) -> Iterator[bytes | memoryview]:
        """The lines of a block, in order, with their ends, some at a time (good until the next are asked for).

        About `ahead` more scenes will be asked for.
        """
        if self.may_compile and self.spent > PACE_KNOWN and self.spent + self.pace * ahead > COMPILE:
            self.compile()
        begun = time.thread_time()
        if self.rows is not None:
            yield from lines_by(self.rows, self.template, block, seed)
            return
        found = lines_of(self.template, block, seed)
        took = time.thread_time() - begun
        self.spent, self.pace = self.spent + took, took / max(len(block.attempts), 1)
        yield found

    def compile(self) -> bool:
        """Use compiled code from now on, if there is a compiler. Takes seconds."""
        self.may_compile = False
        try:
            from ..numba_json import CompiledRows
        except ImportError:
            return False
        self.rows = CompiledRows()
        return True


def lines_of(template: Template, block: Block, seed: int) -> bytes:
    """The line of each scene of a block, in order, with their ends."""
    made, others = iter(joined(merged(pieces_of(template, block, seed)), len(block.rows))), block.others
    indices = range(block.start, block.start + len(block.attempts))
    return "".join([scene_line(others[k]) if k in others else next(made) for k in indices] if others else made).encode()


def lines_by(rows: CompiledRows, template: Template, block: Block, seed: int) -> Iterator[bytes | memoryview]:
    """Yield the lines by compiled code, some at a time; each piece is valid until the next is asked for."""
    others, done = sorted(block.others), 0
    for text, ends in rows.joined(merged(pieces_of(template, block, seed)), len(block.rows)):
        start, indices = 0, block.rows[done : done + len(ends)]
        while others and others[0] < indices[-1]:
            before = int(np.searchsorted(indices, others[0]))
            end = int(ends[before - 1]) if before else 0
            yield text[start:end]
            yield scene_line(block.others[others.pop(0)]).encode()
            start = end
        yield text[start:]
        done += len(ends)
    yield from (scene_line(block.others[index]).encode() for index in others)


def scene_line(scene: Scene) -> str:
    """The line of a scene, with its end."""
    return f"{scene.to_line()}\n"


def pieces_of(template: Template, block: Block, seed: int) -> Sequence[Cells]:
    """The lines of the scenes in the columns of a block, with their ends, in pieces."""
    columns, count = block.columns, len(block.rows)
    params = Written(json_object_pieces(template.params, columns, count))
    objects = [_object(number, o, columns, count) for number, o in enumerate(template.objects)]
    index, attempts = Written([block.rows]), Written([attempts_of(block)])
    return [*json_pieces(scene_entry(seed, index, attempts, 1.0, params, template.ego_id, objects, pruned=template.pruned)), "\n"]


def _object(number: int, o: ObjectTemplate, columns: Columns, count: int) -> dict[str, object]:
    """The entry of an object."""
    position, heading, width, length = (o.properties[name] for name in OWN_FIELDS)
    if isinstance(position, Vector):
        place = [number_cells(part, columns, count, as_given) for part in (position.x, position.y)]
    else:
        place = [finite_number_cells(values) for values in coordinates(position, columns, count)]
    sizes = [
        number_cells(value, columns, count, made) for value, made in ((heading, normalise_heading_column), (width, floats_of), (length, floats_of))
    ]
    x, y, heading, width, length = (Written([cells]) for cells in (*place, *sizes))
    return object_entry(number, o.name, o.class_name, x, y, heading, width, length, Written(json_object_pieces(others(o), columns, count)))


def number_cells(value: object, columns: Columns, count: int, made: Callable[[Numbers], Numbers]) -> Cells:
    """The JSON text of a number of an object's own, as it is `made` from what the program gave."""
    if not symbols_in(value):
        return scene_json_text(listed_numbers(made([value]))[0])
    if isinstance(value, Choice) and not symbols_in(value.values):
        few, numbers = listed_numbers(made(list(value.values))), columns[value.node.number]
        if np.isfinite(floats_of(few)).all():
            return Picked([scene_json_text(number) for number in few], numbers)
        return finite_number_cells([few[k] for k in numbers.tolist()])
    return finite_number_cells(made(exact(value, columns, count)))


def listed_numbers(values: Numbers) -> list[object]:
    """Numbers as Python has them."""
    return values.tolist() if isinstance(values, np.ndarray) else values


def as_given(values: Numbers) -> Numbers:
    """Numbers as the program gave them."""
    return values


def floats_of(values: Numbers) -> np.ndarray:
    """Return numbers as an array of floats."""
    return np.array(values, dtype=float)


def normalise_heading_column(values: Numbers) -> np.ndarray:
    """Headings in (-π, π]."""
    return normalise_heading(floats_of(values))  # type: ignore[arg-type, return-value]


def own_fields(o: ObjectTemplate, columns: Columns, count: int) -> tuple[Numbers, Numbers, Numbers, Numbers, Numbers]:
    """Position (of the type that the program gave it), heading in (-π, π], width and length, in metres and radians, each (count,)."""
    position, heading, width, length = (o.properties[name] for name in OWN_FIELDS)
    x, y = coordinates(position, columns, count)
    return x, y, normalise_heading_column(floats(heading, columns, count)), floats(width, columns, count), floats(length, columns, count)


def coordinates(position: object, columns: Columns, count: int) -> tuple[Numbers, Numbers]:
    """The two parts of a position, of the type that the program gave them."""
    if isinstance(position, Vector):
        return exact(position.x, columns, count), exact(position.y, columns, count)
    pairs = row_values(position, columns, count)
    return [p.x for p in pairs], [p.y for p in pairs]  # type: ignore[attr-defined]


def exact(value: object, columns: Columns, count: int) -> Numbers:
    """A number as a column of floats where it is one, else as a list of what it is."""
    column = columns[value.node.number] if isinstance(value, Traced) and not isinstance(value, (Choice, Opaque)) else None
    return column if column is not None and column.dtype == float else row_values(value, columns, count)


def floats(value: object, columns: Columns, count: int) -> np.ndarray:
    """A number as a column of floats."""
    if isinstance(value, Choice) and not symbols_in(value.values):
        return floats_of(list(value.values))[columns[value.node.number]]
    return floats_of(exact(value, columns, count)) if symbols_in(value) else np.full(count, float(value))  # type: ignore[arg-type]


def others(o: ObjectTemplate) -> dict[str, object]:
    """The properties that have no field of their own."""
    return {name: value for name, value in o.properties.items() if name not in OWN_FIELDS}


def attempts_of(block: Block) -> np.ndarray:
    """How many attempts the scenes in the columns needed."""
    return block.attempts[block.rows - block.start] + 1


# JSON


def scene_json_text(value: object) -> str:
    """The JSON text of a value in the scene format. Raises `ValueError` for numbers that JSON does not have."""
    return in_json(value)


def finite_number_cells(values: Numbers) -> Cells:
    """The JSON text of numbers. Raises `ValueError` for those that JSON does not have."""
    if isinstance(values, np.ndarray) and np.isfinite(values).all():
        return values
    return list(map(scene_json_text, listed_numbers(values)))


def json_pieces(value: object) -> Sequence[Cells]:
    """A value in JSON, parts of which are written already, in pieces."""
    match value:
        case Written(pieces=pieces):
            return pieces
        case dict():
            inner = [(f"{', ' if number else ''}{scene_json_text(name)}: ", *json_pieces(part)) for number, (name, part) in enumerate(value.items())]
            return ["{", *chain.from_iterable(inner), "}"]
        case list():
            return ["[", *chain.from_iterable((", " if number else "", *json_pieces(part)) for number, part in enumerate(value)), "]"]
        case _:
            return [scene_json_text(value)]


def json_object_pieces(values: dict[str, object], columns: Columns, count: int) -> Sequence[Cells]:
    """An object of JSON, in pieces."""
    return json_pieces({name: Written(cells(value, columns, count)) for name, value in values.items()})


def sequence(values: Sequence[object], columns: Columns, count: int) -> Sequence[Cells]:
    """An array of JSON, in pieces."""
    return json_pieces([Written(cells(value, columns, count)) for value in values])


def cells(value: object, columns: Columns, count: int) -> Sequence[Cells]:
    """The JSON text of `json_value(value)` in each row, in pieces."""
    match value:
        case _ if not symbols_in(value):
            return [scene_json_text(json_value(value))]
        case Choice() if not symbols_in(value.values):
            return [Picked([scene_json_text(json_value(v)) for v in value.values], columns[value.node.number])]
        case Traced() if not isinstance(value, (Choice, Opaque)):
            return [numbers(columns[value.node.number])]
        case Random():
            return cells(value.value, columns, count)
        case Vector():
            return sequence([value.x, value.y], columns, count)
        case list() | tuple() if type(value) in (list, tuple):
            return sequence(value, columns, count)
        case dict() if type(value) is dict and all(type(key) is str for key in value):
            return json_object_pieces(value, columns, count)
    return [[scene_json_text(json_value(v)) for v in row_values(value, columns, count)]]


def numbers(column: np.ndarray) -> Cells:
    """Numbers and truth values as JSON."""
    if column.dtype == bool:
        return Picked(TRUTHS, column.astype(np.int64))
    if column.dtype.kind in "iu" or (column.dtype.kind == "f" and np.isfinite(column).all()):
        return column
    return [scene_json_text(json_value(v)) for v in column.tolist()]

