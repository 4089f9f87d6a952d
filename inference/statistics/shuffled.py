"""Tables of scenes in a random order, beyond some megabytes in a file: memory stays bounded, however many scenes there are.

Each scene goes to a random heap; the heaps one after the other, each shuffled, are all scenes in an order that is uniform among all.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from tempfile import SpooledTemporaryFile

import numpy as np

from .betting import Array
from .columns import FeatureTable, stacked

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
        """Further scenes."""
        self.n += table.n
        self.waiting.append(table)
        if sum(t.n for t in self.waiting) >= SHUFFLED_CHUNK:
            self.deal()

    def deal(self) -> None:
        """Write the scenes that wait to random heaps."""
        table, self.waiting = stacked(self.waiting), []
        heap = self.source.integers(HEAPS, size=table.n)
        order = np.argsort(heap, kind="stable")
        ends = np.searchsorted(heap[order], np.arange(HEAPS + 1))
        for number in range(HEAPS):
            rows = order[ends[number] : ends[number + 1]]
            if len(rows):
                piece = table.chosen(rows)
                written = pickle.dumps((piece.n, piece.numbers, {name: packed(values) for name, values in piece.arrays.items()}), protocol=5)
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
                whole = stacked([*map(self.read, heap), FeatureTable(self.kinds, 0)])
                yield whole.chosen(self.source.permutation(whole.n))

    def read(self, place: tuple[int, int]) -> FeatureTable:
        """A piece of a heap: only what `deal` has written is ever read."""
        start, length = place
        self.file.seek(start)
        n, numbers, columns = pickle.loads(self.file.read(length))
        return FeatureTable({name: unpacked(values) for name, values in columns.items()}, n, numbers)


def packed(values: Array) -> Packed:
    """A column in little room: one value where all are equal, texts once."""
    if bool((values == values[0]).all()):
        return "same", values[:1].copy(), len(values)
    if values.dtype == np.float64:
        return "numbers", values, None
    places: dict[str, int] = {}
    codes = np.array([places.setdefault(v, len(places)) for v in values], dtype=np.int32)
    return "texts", list(places), codes


def unpacked(column: Packed) -> Array:
    """The column."""
    kind, values, rest = column
    if kind == "same":
        return np.broadcast_to(values, rest)  # type: ignore[arg-type]
    return values if kind == "numbers" else np.array(values, dtype=object)[rest]  # type: ignore[return-value, index]
