"""Samples of any implementation, read from files (JSON Lines or a table), checked against what is known, and kept in a random order."""

from __future__ import annotations

import codecs
import csv
import gc
import json
import pickle
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from itertools import chain, count, islice
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import Any

import numpy as np

from ...data.scene import SCHEMA, Scene, is_count, problem_of
from ...semantics.store.errors import UsageError
from .betting import Array
from .feature_names import SHORT, SampleNames, long_name
from .impossible_values import Findings
from .known_features import Facts
from .rounding import DEFAULT_TOLERANCE
from .scene_columns import FeatureTable, features_table, stack_tables

HEAPS = 32
KEPT = 64 << 20
"""Bytes that stay in memory."""
SHUFFLED_CHUNK = 1 << 14
"""Scenes of the tables into which pieces are joined before they are dealt out."""

Packed = tuple[str, object, object]


class Shuffled:
    """Scenes to which others are added until they are read, in an order that is a function of the seed."""

    def __init__(self, seed: int) -> None:
        self.source = np.random.Generator(np.random.Philox(seed % (1 << 64)))
        self.file = SpooledTemporaryFile(max_size=KEPT)  # noqa: SIM115 - it is closed, and gone, with the object
        self.heaps: list[list[tuple[int, int]]] = [[] for _ in range(HEAPS)]
        self.waiting: list[FeatureTable] = []
        self.kinds: dict[str, Array] = {}
        self.n = 0

    def add(self, table: FeatureTable) -> None:
        """Add further scenes to the sample."""
        self.n += table.n
        self.waiting.append(table)
        if sum(t.n for t in self.waiting) >= SHUFFLED_CHUNK:
            self.deal()

    def deal(self) -> None:
        """Write the scenes that wait to random heaps."""
        table, self.waiting = stack_tables(self.waiting), []
        heap = self.source.integers(HEAPS, size=table.n)
        order = np.argsort(heap, kind="stable")
        ends = np.searchsorted(heap[order], np.arange(HEAPS + 1))
        for number in range(HEAPS):
            rows = order[ends[number] : ends[number + 1]]
            if len(rows):
                piece = table.chosen(rows)
                written = pickle.dumps((piece.n, piece.numbers, {name: pack_column(values) for name, values in piece.arrays.items()}), protocol=5)
                self.heaps[number].append((self.file.tell(), len(written)))
                self.file.write(written)
        for name, values in table.arrays.items():
            self.kinds.setdefault(name, values[:0])

    def tables(self) -> Iterator[FeatureTable]:
        """All scenes, table by table, in random order; every table has all features, absent or not."""
        if self.waiting:
            self.deal()
        for heap in self.heaps:
            if heap:
                whole = stack_tables([*map(self.read, heap), FeatureTable(self.kinds, 0)])
                yield whole.chosen(self.source.permutation(whole.n))

    def read(self, place: tuple[int, int]) -> FeatureTable:
        """A piece of a heap: only what `deal` has written is ever read."""
        start, length = place
        self.file.seek(start)
        n, numbers, columns = pickle.loads(self.file.read(length))
        return FeatureTable({name: unpack_column(values) for name, values in columns.items()}, n, numbers)


def pack_column(values: Array) -> Packed:
    """A column in little room: one value where all are equal, texts once."""
    if bool((values == values[0]).all()):
        return "same", values[:1].copy(), len(values)
    if values.dtype == np.float64:
        return "numbers", values, None
    places: dict[str, int] = {}
    codes = np.array([places.setdefault(v, len(places)) for v in values], dtype=np.int32)
    return "texts", list(places), codes


def unpack_column(column: Packed) -> Array:
    """Return the column as it was packed."""
    kind, values, rest = column
    if kind == "same":
        return np.broadcast_to(values, rest)  # type: ignore[arg-type]
    return values if kind == "numbers" else np.array(values, dtype=object)[rest]  # type: ignore[return-value, index]


CHUNK = 512
"""Scenes that are read together."""

AnyScene = Scene | Mapping[str, object]
"""A scene, or the JSON object of one."""
Given = FeatureTable | Iterable[AnyScene] | str | Path
"""Scenes as a table, as such, or in a file."""


class Samples:
    """Scenes in a random order (a function of the seed), so that it does not matter how they were sorted, and the impossible values among them.

    The features have the program's names. Memory is bounded: beyond some megabytes the scenes are in a temporary file.
    Raises `UsageError` for a file that cannot be read.
    """

    def __init__(
        self, given: Given, seed: int = 0, *, facts: Facts | None = None, names: SampleNames | None = None, tolerance: float = DEFAULT_TOLERANCE,
        theirs: bool = True,
    ) -> None:
        self.names = names or SampleNames()
        self.kept = Shuffled(seed)
        self.first: FeatureTable | None = None
        self.drawn: dict[object, list[Array]] = {}
        self.lines: list[Array] = []
        self.found = Findings(facts or Facts(), tolerance, self.place)
        rename = self.names.translated if theirs else self.names.kept
        for table in self.tables_of(given):
            if self.first is None and theirs:
                self.names.check(table, [*self.found.facts.constants, *self.found.facts.supports])
            table = rename(table)
            self.first = self.first or table
            self.found.look(table)
            self.kept.add(table)

    @property
    def n(self) -> int:
        """How many scenes there are."""
        return self.kept.n

    def tables(self) -> Iterator[FeatureTable]:
        """The scenes in random order, table by table."""
        return self.kept.tables()

    def place(self, number: int) -> str:
        """How a scene is named: by its number, and its line in a file."""
        if not self.lines:
            return f"sample {number}"
        return f"sample {number} (line {self.lines[(number - 1) // CHUNK][(number - 1) % CHUNK]})"

    def tables_of(self, given: Given) -> Iterator[FeatureTable]:
        """The scenes as they are given, table by table, numbered from 1; the seeds and numbers that they say are noted."""
        if isinstance(given, FeatureTable):
            yield from (given.rows(start, start + CHUNK) for start in range(0, given.n, CHUNK))
            return
        scenes = iter(scenes_in(given) if isinstance(given, (str, Path)) else zip(count(1), given, strict=False))
        start = 1
        while chunk := list(islice(scenes, CHUNK)):
            self.note([scene for _, scene in chunk])
            if isinstance(given, (str, Path)):
                self.lines.append(np.array([line for line, _ in chunk]))
            table = features_table(scene for _, scene in chunk)
            yield FeatureTable(table.arrays, table.n, np.arange(start, start + table.n))
            start += table.n

    def note(self, scenes: Iterable[AnyScene]) -> None:
        """Remember which scenes of which seeds these are, where they say so."""
        found: dict[object, list[int]] = {}
        for scene in scenes:
            seed, number = (scene.seed, scene.index) if isinstance(scene, Scene) else (scene.get("seed"), scene.get("scene"))
            if isinstance(seed, (int, str)):
                of_seed = found.setdefault(seed, [])
                if type(number) is int and abs(number) < 1 << 62:
                    of_seed.append(number)
        for seed, numbers in found.items():
            self.drawn.setdefault(seed, []).append(np.array(numbers, dtype=np.int64))

    def shared_with(self, other: Samples) -> tuple[object, int] | None:
        """The seed and number of a scene that both hold, None if there is none."""
        for seed in self.drawn.keys() & other.drawn.keys():
            both = np.intersect1d(np.concatenate(self.drawn[seed]), np.concatenate(other.drawn[seed]))
            if len(both):
                return seed, int(both[0])
        return None


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
        for number, scene in zip([number for number, _ in several], parse_sample_lines(several, path), strict=True):
            problem = problem_of(scene)
            if problem:
                raise UsageError(f"{path}, line {number}: {problem}", hint=f"the format is {SCHEMA}; `scenic-ref run FILE -n 1` shows an example")
            yield number, scene  # type: ignore[misc]


def parse_sample_lines(lines: Sequence[tuple[int, bytes]], path: str) -> Iterable[object]:
    """Parse lines of a sample: all at a time if each is an object of JSON, which is quicker, else line by
    line. Raises `UsageError`.
    """
    if all(line[0] == OPENING and line[-1] == CLOSING for _, line in lines):
        with suppress(ValueError, RecursionError), pause_garbage_collection():
            found = decode_scene_list(b"[" + b",".join([line for _, line in lines]) + b"]")
            if len(found) == len(lines):
                return found
    return one_by_one(lines, path)


@contextmanager
def pause_garbage_collection() -> Iterator[None]:
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


def decode_scene_list(text: bytes) -> list[Any]:
    """The scenes in a list in JSON. Raises `ValueError`."""
    quick = quick_decoder()
    if quick is not None:
        with suppress(ValueError):
            found = quick(text)
            if not any(isinstance(scene, dict) and type(scene.get("seed")) is float for scene in found):  # a seed may have any size
                return found
    return json.loads(text.decode())


def one_by_one(lines: Sequence[tuple[int, bytes]], path: str) -> Iterator[object]:
    """Parse lines of a sample one by one. Raises `UsageError`."""
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

