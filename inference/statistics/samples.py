"""Scenes that are given, read once: checked against what is known, and kept in a random order for the bets."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import count, islice
from pathlib import Path

import numpy as np

from ...data.scene import Scene
from .betting import Array
from .columns import FeatureTable, features_table
from .facts import Facts
from .impossible import Findings
from .names import SampleNames
from .reading import scenes_in
from .rounding import DEFAULT_TOLERANCE
from .shuffled import Shuffled

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
