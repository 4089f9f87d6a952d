"""Scenes for which a test failed, kept in pytest's cache: a file of JSON for each, to be looked at and to be run first the next time."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import pytest

SCHEMA = "scenic-ref/failed-scene/1"
FOLDER = "scenic"
MOST_KEPT = 20
"""So many scenes are kept of one test, the first that failed."""


class SceneNumber(NamedTuple):
    """Scene `number` of `seed`."""

    seed: int
    number: int

    def __str__(self) -> str:
        return f"scene {self.number} of seed {self.seed}"


class KeptScenes:
    """The scenes that are kept for the tests of one run; without pytest's cache there are none."""

    def __init__(self, config: pytest.Config) -> None:
        cache = getattr(config, "cache", None)
        self.cache = cache
        self.kept: dict[str, dict[SceneNumber, Path]] = {}
        for path in [] if cache is None else sorted(Path(str(cache._cachedir), "d", FOLDER).glob("*.json")):
            found = read_failure(path)
            if found is not None:
                self.kept.setdefault(found[0], {})[found[1]] = path

    def of(self, test: str) -> list[SceneNumber]:
        """The scenes of a test, the smallest first."""
        return sorted(self.kept.get(test, {}))

    def keep(self, test: str, number: SceneNumber, record: Mapping[str, object]) -> None:
        """Keep a scene; a disk that is full or read-only keeps none."""
        mine = self.kept.setdefault(test, {})
        if self.cache is None or (number not in mine and len(mine) >= MOST_KEPT):
            return
        with suppress(OSError):
            path = Path(self.cache.mkdir(FOLDER)) / failure_file_name(test, number)
            begun = path.with_suffix(".begun")
            begun.write_text(json.dumps({"schema": SCHEMA, "test": test, **number._asdict(), **record}, indent=2) + "\n", encoding="utf-8")
            begun.replace(path)
            mine[number] = path

    def drop(self, test: str, number: SceneNumber) -> None:
        """Keep a scene no longer, since the test passed."""
        path = self.kept.get(test, {}).pop(number, None)
        if path is not None:
            with suppress(OSError):
                path.unlink(missing_ok=True)

    def path(self, test: str, number: SceneNumber) -> Path | None:
        """Return the path at which a scene is kept, whether or not it exists; None without a cache."""
        return None if self.cache is None else Path(str(self.cache._cachedir), "d", FOLDER, failure_file_name(test, number))


def failure_file_name(test: str, number: SceneNumber) -> str:
    """The name of a file: the test's, as far as it can stand in one, and a digest of all of it."""
    plain = re.sub(r"\W+", "_", test.rpartition("::")[2], flags=re.ASCII)[:60].strip("_")
    digest = hashlib.sha256(f"{test}\0{number.seed}\0{number.number}".encode("utf-8", "surrogatepass")).hexdigest()[:12]
    return f"{plain}-{digest}.json"


def read_failure(path: Path) -> tuple[str, SceneNumber] | None:
    """The test and the scene of a file; None of one that is not ours, or broken."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        return None
    test, seed, number = found.get("test"), found.get("seed"), found.get("number")
    if not isinstance(test, str) or type(seed) is not int or type(number) is not int or number < 0:
        return None
    return test, SceneNumber(seed, number)


class SceneKeeper:
    """Hears how the tests of a run ended, whichever process ran them, and keeps or drops their scenes at its end."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.failed: dict[tuple[str, SceneNumber], Mapping[str, object]] = {}
        self.passed: set[tuple[str, SceneNumber]] = set()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a scene for which a test failed or passed."""
        said = getattr(report, ATTRIBUTE, None)
        if said is not None:
            test, seed, number, record = json.loads(said)
            key = test, SceneNumber(seed, number)
            if record is None:
                self.passed.add(key)
            else:
                self.failed.setdefault(key, record)

    def pytest_sessionfinish(self) -> None:
        """Keep the scenes that failed, and drop those that failed before and did not this time."""
        if self.failed or self.passed:
            kept = KeptScenes(self.config)
            for test, number in self.passed - self.failed.keys():
                kept.drop(test, number)
            for (test, number), record in self.failed.items():
                kept.keep(test, number, record)


ATTRIBUTE = "scenic_scene"
"""Of a report: the test, the seed, the number and what is to be kept, None if it passed, in JSON; reports may come from other processes."""
