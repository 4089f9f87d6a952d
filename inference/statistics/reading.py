"""Samples of any implementation, read from a file: scenes as JSON Lines, or a table with a column per feature as CSV.

The CSV has one row per scene. Its first line names the columns by their place in the scene format
(`objects[0].position[0]`, `params.time`, `attempts`), or short: `1.x`, `1.y`, `1.heading`, `1.speed` for x, y, the heading and the property
`speed` of object 1. Metres and radians; the objects stand in the order in which the program makes them.
"""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from ...interpreter.scenes import OWN_FIELDS, SCHEMA
from ...semantics.errors import UsageError

SHORT = re.compile(r"(\d+)\.(\w+)((?:\[\d+\])*)")
LONG = re.compile(r"objects\[(\d+)\]\.(?:(position)\[([01])\]|(heading|width|length|class|properties\.\w+)((?:\[\d+\])*))")
OTHER = re.compile(r"(?:params\.\w+(?:\[\d+\])*|attempts|weight|seed)")
CONSTANTS: Mapping[str, object] = {"None": None, "null": None, "True": True, "true": True, "False": False, "false": False}

Samples = list[dict[str, object]]


def read_samples(path: str | Path) -> Samples:
    """The scenes in a file. Raises `UsageError` naming the line where it is not in one of the two formats."""
    where = Path(path)
    try:
        text = where.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path} is not text in UTF-8") from None
    samples = list(_csv(text, str(path)) if where.suffix.lower() == ".csv" else _lines(text, str(path)))
    if not samples:
        raise UsageError(f"{path} holds no scenes")
    if any(s.get("weight", 1.0) != samples[0].get("weight", 1.0) for s in samples):
        raise UsageError(f"{path} holds weighted scenes, which cannot be compared: draw scenes of equal weight")
    return samples


def _lines(text: str, path: str) -> Iterator[dict[str, object]]:
    for number, line in enumerate(text.split("\n"), 1):
        if not line.strip():
            continue
        try:
            scene = json.loads(line)
        except (ValueError, RecursionError):
            raise UsageError(f"{path}, line {number}: this is not JSON", hint="one scene per line, as `scenic-ref run -o` writes them") from None
        problem = problem_of(scene)
        if problem:
            raise UsageError(f"{path}, line {number}: {problem}", hint=f"the format is {SCHEMA}; `scenic-ref run FILE -n 1` shows an example")
        yield scene


def problem_of(scene: object) -> str:
    """What keeps a value from being a scene of the format; "" if nothing does."""
    if not isinstance(scene, dict):
        return "a scene is an object in braces"
    if scene.get("schema", SCHEMA) != SCHEMA:
        return f"this is {scene['schema']!r}, not a scene"
    objects, params = scene.get("objects"), scene.get("params", {})
    if not isinstance(objects, list) or not isinstance(params, dict):
        return "a scene has a list `objects`" if not isinstance(objects, list) else "`params` maps names to values"
    if "attempts" in scene and not is_count(scene["attempts"]):
        return "`attempts` is not a whole number of at least 1"
    for i, o in enumerate(objects):
        if not isinstance(o, dict) or not isinstance(o.get("properties", {}), dict):
            return f"objects[{i}] is not an object of the format"
        position = o.get("position")
        if not (isinstance(position, list) and len(position) == 2 and all(is_finite(v) for v in position)):
            return f"objects[{i}].position is not a pair of finite numbers"
        wrong = [name for name in OWN_FIELDS[1:] if name in o and not is_finite(o[name])]
        if wrong:
            return f"objects[{i}].{wrong[0]} is not a finite number"
    return ""


def is_finite(value: object) -> bool:
    """Whether a value in JSON is a finite number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_count(value: object) -> bool:
    """Whether a value is a whole number of at least 1."""
    return isinstance(value, int) and not isinstance(value, bool) and value >= 1


def _csv(text: str, path: str) -> Iterator[dict[str, object]]:
    rows = csv.reader(text.splitlines())
    names = [feature_named(name.strip(), path) for name in next(rows, [])]
    if len(set(names)) != len(names):
        raise UsageError(f"{path}: two columns have the same name")
    for row in rows:
        if row and len(row) != len(names):
            raise UsageError(f"{path}, line {rows.line_num}: {len(row)} values, where the first line names {len(names)}")
        if row:
            found = {name: cell_value(cell.strip()) for name, cell in zip(names, row, strict=True)}
            for name, value in found.items():
                if value == "" or (isinstance(value, float) and not math.isfinite(value)) or (name == "attempts" and not is_count(value)):
                    raise UsageError(f"{path}, line {rows.line_num}: {value!r} is no value of {name}", hint="None, True and False can be written so")
            yield {"columns": found}


def feature_named(name: str, path: str) -> str:
    """The feature that a column of a CSV file holds. Raises `UsageError`."""
    if OTHER.fullmatch(name) or LONG.fullmatch(name):
        return name
    short = SHORT.fullmatch(name)
    if short is None:
        raise UsageError(f"{path}: {name!r} names no feature", hint="columns are named like 0.x, 1.heading, objects[1].properties.speed, params.time")
    number, field, indices = short.groups()
    place = f"objects[{int(number)}]"
    if field in ("x", "y"):
        return f"{place}.position[{'xy'.index(field)}]{indices}"
    own = field in ("heading", "width", "length", "class")
    return f"{place}.{field}{indices}" if own else f"{place}.properties.{field}{indices}"


def cell_value(cell: str) -> object:
    """A number, True, False, None, or a string."""
    if cell in CONSTANTS:
        return CONSTANTS[cell]
    try:
        return int(cell) if re.fullmatch(r"[+-]?\d{1,18}", cell) else float(cell)
    except ValueError:
        return cell
