"""Samples of any implementation, read from a file: scenes as JSON Lines, or a table with a column per feature as CSV.

The CSV has one row per scene. Its first line names the columns by their place in the scene format
(`objects[0].position[0]`, `params.time`, `attempts`), or short: `1.x`, `1.y`, `1.heading`, `1.speed` for x, y, the heading and the property
`speed` of object 1. Metres and radians; the objects stand in the order in which the program makes them.
"""

from __future__ import annotations

import codecs
import csv
import gc
import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from itertools import chain, islice
from pathlib import Path
from typing import Any

from ...data.scene import SCHEMA, is_count, problem_of
from ...semantics.kernel.errors import UsageError
from .names import SHORT, long_name

LONG = re.compile(r"objects\[(\d+)\]\.(?:(position)\[([01])\]|(heading|width|length|class|properties\.\w+)((?:\[\d+\])*))")
OTHER = re.compile(r"(?:params\.\w+(?:\[\d+\])*|attempts|weight|seed)")
CONSTANTS: Mapping[str, object] = {"None": None, "null": None, "True": True, "true": True, "False": False, "false": False}

BOM, OPENING, CLOSING = codecs.BOM_UTF8, ord("{"), ord("}")
AT_ONCE = 256
"""Lines that are read together."""
Numbered = tuple[int, dict[str, object]]
"""A line's number and its scene."""


def scenes_in(path: str | Path) -> Iterator[Numbered]:
    """The scenes in a file, one after the other. Raises `UsageError` naming the line where it is not in one of the two formats."""
    where, weight = Path(path), None
    try:
        is_table = where.suffix.lower() == ".csv"
        with where.open(encoding="utf-8-sig", newline="") if is_table else where.open("rb") as file:
            for number, scene in _csv(file, str(path)) if is_table else _lines(file, str(path)):  # type: ignore[arg-type]
                now = scene_weight(scene)
                weight = now if weight is None else weight
                if now != weight:
                    raise UsageError(f"{path} holds weighted scenes, which cannot be compared: draw scenes of equal weight")
                yield number, scene
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path} is not text in UTF-8") from None


def scene_weight(scene: Mapping[str, object]) -> object:
    """The weight of a scene, or of the row of a CSV file."""
    columns = scene.get("columns")
    return (columns if isinstance(columns, Mapping) else scene).get("weight", 1.0)


def read_samples(path: str | Path) -> list[dict[str, object]]:
    """The scenes in a file, as a list. Raises `UsageError`."""
    return [scene for _, scene in scenes_in(path)]


def _lines(file: Iterable[bytes], path: str) -> Iterator[Numbered]:
    numbered = enumerate(file, 1)
    first = ((number, text.removeprefix(BOM)) for number, text in islice(numbered, 1))
    lines = ((number, line) for number, text in chain(first, numbered) if (line := text.strip()))
    while several := list(islice(lines, AT_ONCE)):
        for number, scene in zip([number for number, _ in several], parsed(several, path), strict=True):
            problem = problem_of(scene)
            if problem:
                raise UsageError(f"{path}, line {number}: {problem}", hint=f"the format is {SCHEMA}; `scenic-ref run FILE -n 1` shows an example")
            yield number, scene  # type: ignore[misc]


def parsed(lines: Sequence[tuple[int, bytes]], path: str) -> Iterable[object]:
    """What stands on some lines: all at a time if each is an object of JSON, which is quicker, else line by line. Raises `UsageError`."""
    if all(line[0] == OPENING and line[-1] == CLOSING for _, line in lines):
        with suppress(ValueError, RecursionError), uncollected():
            found = decoded(b"[" + b",".join([line for _, line in lines]) + b"]")
            if len(found) == len(lines):
                return found
    return one_by_one(lines, path)


@contextmanager
def uncollected() -> Iterator[None]:
    """Without looking for cycles among the values inside, of which there are many and no cycles."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@cache
def quick_decoder() -> Callable[[bytes], Any] | None:
    """The decoder of the extra `fast`, which refuses what JSON has not (NaN, infinities), and makes floats of integers beyond 64 bits."""
    try:
        import orjson
    except ImportError:
        return None
    return orjson.loads


def decoded(text: bytes) -> list[Any]:
    """The scenes in a list in JSON. Raises `ValueError`."""
    quick = quick_decoder()
    if quick is not None:
        with suppress(ValueError):
            found = quick(text)
            if not any(isinstance(scene, dict) and type(scene.get("seed")) is float for scene in found):  # a seed may have any size
                return found
    return json.loads(text.decode())


def one_by_one(lines: Sequence[tuple[int, bytes]], path: str) -> Iterator[object]:
    """What stands on some lines. Raises `UsageError`."""
    for number, line in lines:
        text = line.decode()
        try:
            yield json.loads(text)
        except (ValueError, RecursionError):
            raise UsageError(f"{path}, line {number}: this is not JSON", hint="one scene per line, as `scenic-ref run -o` writes them") from None


def _csv(file: Iterable[str], path: str) -> Iterator[Numbered]:
    rows = csv.reader(file)
    try:
        names = [feature_named(name.strip(), path) for name in next(rows, [])]
        if len(set(names)) != len(names):
            raise UsageError(f"{path}: two columns have the same name")
        for row in rows:
            if row and len(row) != len(names):
                raise UsageError(f"{path}, line {rows.line_num}: {len(row)} values, where the first line names {len(names)}")
            if row:
                found = {name: cell_value(cell.strip()) for name, cell in zip(names, row, strict=True)}
                for name, value in found.items():
                    if value == "" or (name == "attempts" and not is_count(value)):
                        where = f"{path}, line {rows.line_num}"
                        raise UsageError(f"{where}: {value!r} is not a value of {name}", hint="None, True and False are written like this")
                yield rows.line_num, {"columns": found}
    except csv.Error as error:
        raise UsageError(f"{path}, line {rows.line_num}: {error}") from None


def feature_named(name: str, path: str) -> str:
    """The feature that a column of a CSV file holds. Raises `UsageError`."""
    if OTHER.fullmatch(name) or LONG.fullmatch(name):
        return name
    if SHORT.fullmatch(name) is None:
        raise UsageError(f"{path}: {name!r} names no feature", hint="columns are named like 0.x, 1.heading, objects[1].properties.speed, params.time")
    return long_name(name)


def cell_value(cell: str) -> object:
    """A number, True, False, None, or a string."""
    if cell in CONSTANTS:
        return CONSTANTS[cell]
    try:
        return int(cell) if re.fullmatch(r"[+-]?\d{1,18}", cell) else float(cell)
    except ValueError:
        return cell
