"""Columns of values that have a type: truth values, numbers, texts, lists of numbers of one length; the JSON text of a value where there is none.

The type of a column depends on the values in it only, not on the pieces in which they came: the type of two columns together is that of `joint`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from .scene import SURROGATE, in_json

NOTHING, BOOL, INT53, INT64, FLOAT, TEXT, JSON = "nothing", "bool", "int53", "int64", "float64", "text", "json"
"""The types but for lists of numbers: n of them are `vector_type(n)`. An `int53` is a float64 without loss, and joins numbers that are none."""
EXACT = 2**53
NOT_FINITE = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}
"""Numbers that JSON does not have are {"repr": NAME} in the scene format."""


class TypedColumn(NamedTuple):
    """A type and the values of it: a number for each row (texts: a place in `texts`), or (rows, n) of them for lists.

    Rows that are not `valid` (None: all are) have no value.
    """

    kind: str
    values: np.ndarray
    texts: Sequence[str] = ()
    valid: np.ndarray | None = None

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(self.values)


def vector_type(count: int) -> str:
    """The type of lists of so many numbers."""
    return f"float64[{count}]"


def vector_length(kind: str) -> int | None:
    """How many numbers the lists of a type have, None for other types."""
    return int(kind[8:-1]) if kind.startswith("float64[") else None


def kind_of(value: object) -> str:
    """The type of a value of the scene format."""
    match value:
        case None:
            return NOTHING
        case bool():
            return BOOL
        case int():
            return INT53 if -EXACT <= value <= EXACT else INT64 if -(2**63) <= value < 2**63 else JSON
        case float():
            return FLOAT
        case str():
            return JSON if SURROGATE.search(value) else TEXT  # half a character can only be written as JSON escapes it
        case {"repr": str(name), **others} if name in NOT_FINITE and not others:
            return FLOAT
        case [_, *_] if all(kind_of(v) in (INT53, FLOAT) and not isinstance(v, dict) for v in value):
            return vector_type(len(value))
        case _:
            return JSON


def shown_kind(kind: str) -> str:
    """The name of a type for users."""
    return {INT53: "int64", NOTHING: "null"}.get(kind, kind)


def joint(first: str, second: str) -> str:
    """The type of values of both types."""
    if first == second or second == NOTHING:
        return first
    if first == NOTHING:
        return second
    match {first, second}:
        case kinds if kinds == {INT53, INT64}:
            return INT64
        case kinds if kinds == {INT53, FLOAT}:
            return FLOAT
        case _:
            return JSON


def number_text(value: float) -> str:
    """The JSON text of a number; whole numbers are written without a point, since an `int53` may have become a float."""
    if isinstance(value, float) and not math.isfinite(value):
        return in_json({"repr": repr(value)})
    whole = value == int(value) and abs(value) <= EXACT and not (value == 0 and math.copysign(1, value) < 0)
    return str(int(value)) if whole else in_json(value)


def json_text(value: object) -> str:
    """The JSON text of a value of the scene format, as it is in a column of such texts."""
    kind = kind_of(value)
    if kind in (INT53, INT64, FLOAT):
        return number_text(NOT_FINITE[value["repr"]] if isinstance(value, dict) else value)  # type: ignore[arg-type]
    if vector_length(kind) is not None:
        return list_text(value)  # type: ignore[arg-type]
    return in_json(value, allow_nan=True)


def list_text(values: Iterable[float]) -> str:
    """The JSON text of a list of numbers."""
    return f"[{', '.join(map(number_text, values))}]"


def column_of(values: Sequence[object]) -> TypedColumn:
    """The column of values of the scene format, None where there is no value."""
    kind = reduce(joint, map(kind_of, values), NOTHING)
    valid = None if None not in values else np.array([v is not None for v in values])
    if kind in (TEXT, JSON):
        return encode_texts(kind, [None if v is None else str(v) if kind == TEXT else json_text(v) for v in values])
    if (count := vector_length(kind)) is not None:
        return TypedColumn(kind, np.array([[0.0] * count if v is None else v for v in values], dtype=float).reshape(-1, count), (), valid)
    return TypedColumn(kind, np.array([0 if v is None else number_in(v) for v in values], dtype=dtype_of(kind)), (), valid)


def number_in(value: Any) -> float:
    """A number of the scene format."""
    return NOT_FINITE[value["repr"]] if isinstance(value, dict) else value


def encode_texts(kind: str, values: Iterable[str | None]) -> TypedColumn:
    """A column of texts, equal ones once, in the order in which they come first."""
    places: dict[str, int] = {}
    codes = np.array([-1 if v is None else places.setdefault(v, len(places)) for v in values], dtype=np.int64)
    valid = codes >= 0
    return TypedColumn(kind, np.maximum(codes, 0), list(places) or [""], None if valid.all() else valid)


def dtype_of(kind: str) -> np.dtype[Any]:
    """The NumPy type of the values, or of the places of texts."""
    return np.dtype({BOOL: "bool", FLOAT: "float64"}.get(kind, "float64" if vector_length(kind) is not None else "int64"))


def constant_column(value: object, count: int) -> TypedColumn:
    """A value of the scene format in each row."""
    return repeat_first_row(column_of([value]), count)


def repeat_first_row(column: TypedColumn, count: int) -> TypedColumn:
    """The first row of a column, so many times, but once in memory."""
    return column._replace(
        values=broadcast_first_row(column.values, count), valid=None if column.valid is None else broadcast_first_row(column.valid, count)
    )


def broadcast_first_row(array: np.ndarray, count: int) -> np.ndarray:
    """The first row of an array, so many times: a view of it, which cannot be written."""
    return np.broadcast_to(array[:1], (count, *array.shape[1:]))


def is_alike(array: np.ndarray) -> bool:
    """Whether an array is such a view."""
    return len(array) > 0 and array.strides[0] == 0


def all_alike(array: np.ndarray) -> bool:
    """Whether all rows of an array are the first, bit for bit."""
    if is_alike(array):
        return True
    bits = np.ascontiguousarray(array).reshape(len(array), -1).view(np.uint8)
    return bool((bits[-1] == bits[0]).all() and (bits[1:] == bits[:-1]).all())


def again(column: TypedColumn, count: int) -> TypedColumn:
    """All rows of a column, so many times one after the other."""
    return column._replace(values=tile_rows(column.values, count), valid=None if column.valid is None else tile_rows(column.valid, count))


def tile_rows(array: np.ndarray, count: int) -> np.ndarray:
    """All rows of an array, so many times one after the other; a view of the first, which cannot be written, if all are alike."""
    return broadcast_first_row(array, len(array) * count) if all_alike(array) else np.tile(array, (count, *[1] * (array.ndim - 1)))


def take_rows(column: TypedColumn, rows: np.ndarray) -> TypedColumn:
    """Some rows, any number of times."""
    return column._replace(values=column.values[rows], valid=None if column.valid is None else column.valid[rows])


def empty_column(count: int) -> TypedColumn:
    """No value in any row."""
    return TypedColumn(NOTHING, np.zeros(count, dtype=np.int64), (), np.zeros(count, dtype=bool))


def numbers(values: np.ndarray) -> TypedColumn:
    """A column of truth values, whole numbers or floats, in their NumPy type."""
    if values.dtype.kind in "iu":
        is_exact = not values.size or (int(values.min()) >= -EXACT and int(values.max()) <= EXACT)
        return TypedColumn(INT53 if is_exact else INT64, values.astype(np.int64))
    return TypedColumn(BOOL if values.dtype == bool else FLOAT, values)


def as_kind(column: TypedColumn, kind: str) -> TypedColumn:
    """Return the column with its values converted to `kind`, a type that `joint` gives for its own type and
    others.
    """
    if column.kind == kind:
        return column
    if column.kind == NOTHING:
        count = vector_length(kind)
        values = np.zeros(column.rows if count is None else (column.rows, count), dtype=dtype_of(kind))
        return TypedColumn(kind, values, ("",) if kind in (TEXT, JSON) else (), column.valid)
    if column.rows > 1 and is_alike(column.values) and (column.valid is None or is_alike(column.valid)):
        return repeat_first_row(as_kind(select_rows(column, slice(0, 1)), kind), column.rows)
    if kind != JSON:
        return column._replace(kind=kind, values=column.values.astype(dtype_of(kind)))
    match column.kind:
        case "bool":
            return TypedColumn(JSON, column.values.astype(np.int64), ("false", "true"), column.valid)
        case "text":
            return column._replace(kind=JSON, texts=[in_json(text) for text in column.texts])
        case "int53" | "int64" | "float64":
            bits, codes = np.unique(column.values.view(np.int64), return_inverse=True)  # by their bits, since -0.0 equals 0.0
            return TypedColumn(JSON, codes, [number_text(v) for v in bits.view(column.values.dtype).tolist()], column.valid)
        case _:
            return TypedColumn(JSON, np.arange(column.rows), [list_text(row) for row in column.values.tolist()], column.valid)


def concatenate_columns(columns: Sequence[TypedColumn]) -> TypedColumn:
    """The rows of some columns after those of others."""
    return put_together(columns, np.concatenate)


def interleave_columns(columns: Sequence[TypedColumn]) -> TypedColumn:
    """The first row of each column, then the second of each, ..."""
    return put_together(columns, in_turn)


def in_turn(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """The first row of each array, then the second of each, ..."""
    stacked = np.stack(arrays, axis=1)
    return stacked.reshape(-1, *stacked.shape[2:])


def put_together(columns: Sequence[TypedColumn], arrange: Callable[[Sequence[np.ndarray]], np.ndarray]) -> TypedColumn:
    """The rows of all columns in the type of all, `arrange` saying in which order."""
    if len(columns) == 1:
        return columns[0]
    kind = reduce(joint, (c.kind for c in columns))
    same = [as_kind(c, kind) for c in columns]
    values, texts = same_texts(same)
    valid = None if all(c.valid is None for c in same) else arrange_arrays([valid_in(c) for c in same], arrange)
    return TypedColumn(kind, arrange_arrays(values, arrange), texts, valid)


def arrange_arrays(arrays: Sequence[np.ndarray], arrange: Callable[[Sequence[np.ndarray]], np.ndarray]) -> np.ndarray:
    """The rows of some arrays, `arrange` saying in which order; if all are alike, bit for bit, a view of the first."""
    if all(map(is_alike, arrays)) and len({a[:1].tobytes() for a in arrays}) == 1:
        return broadcast_first_row(arrays[0], sum(map(len, arrays)))
    return arrange(arrays)


def same_texts(columns: Sequence[TypedColumn]) -> tuple[list[np.ndarray], Sequence[str]]:
    """The values of columns of one type, texts as places in one list for all."""
    if columns[0].kind not in (TEXT, JSON):
        return [c.values for c in columns], ()
    texts: list[str] = []
    begun: dict[int | tuple[str, ...], int] = {}
    values = []
    for column in columns:
        known = tuple(column.texts) if len(column.texts) == 1 else id(column.texts)
        if known not in begun:
            begun[known] = len(texts)
            texts += column.texts
        place = begun[known]
        values.append(
            broadcast_first_row(
                column.values[:1] + place, column.rows
            ) if is_alike(column.values) else column.values + place if place else column.values
        )
    return values, texts


def valid_in(column: TypedColumn) -> np.ndarray:
    """Which rows have a value."""
    return np.ones(column.rows, dtype=bool) if column.valid is None else column.valid


def select_rows(column: TypedColumn, rows: slice | np.ndarray) -> TypedColumn:
    """Some of the rows, of the type that they have."""
    valid = None if column.valid is None else column.valid[rows]
    values: np.ndarray = column.values[rows]
    texts = column.texts
    if len(texts) > len(values):
        used, values = np.unique(values, return_inverse=True)
        texts = [str(texts[k]) for k in used.tolist()]
    return TypedColumn(column.kind, values, texts, None if valid is None or valid.all() else valid)


def in_first_order(column: TypedColumn) -> TypedColumn:
    """Return the column with its texts made unique, in the order of their first appearance, without unused
    ones.
    """
    places: dict[str, int] = {}
    number_of = np.array([places.setdefault(v, len(places)) for v in column.texts], dtype=np.int64)
    codes = number_of[column.values]
    used, first, inverse = np.unique(codes if column.valid is None else codes[column.valid], return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    values: list[str] = list(places)
    if column.valid is None:
        codes = rank[inverse]
    else:
        codes = np.full(column.rows, -1)
        codes[column.valid] = rank[inverse]
    return column._replace(values=codes, texts=[values[k] for k in used[order].tolist()])
