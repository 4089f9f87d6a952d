"""How much work parsing is, and the tables that are kept between processes."""

from __future__ import annotations

import hashlib
import json
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from lark import Lark
from scenic_ref.interpreter.language import parser
from scenic_ref.interpreter.language.parser import LARGEST_TABLES, cache_file, parse, tables
from scenic_ref.interpreter.runtime.cache_folders import DIGEST, read_kept

BLOCK = """class Foo{i}(Car):
    position: Point on road
    def f(self, a, b=3):
        for i in range(10):
            x = Car left of spot by 0.5, facing Range(-5, 5) deg relative to roadDirection
            if x.position in road and (distance from x to ego) < 10:
                y = [a * b + c for a in self.items if a > 3]
        return Uniform(1.0, -1.0) * (10 + 3 * self.x[3]) deg
ego = Car at (120, 300), with behavior Follow(3, key=lambda r: r.x), facing 37 deg
require[0.5] ego can see car2 and car.width < 4.5
"""


def test_a_thousand_lines_parse_within_about_two_seconds_of_a_processor(effort: Callable[[Callable[[], object]], float]) -> None:
    parse("x = 1")
    text = "".join(BLOCK.replace("{i}", str(i)) for i in range(100))
    assert any(effort(lambda: parse(text)) < 20 for _ in range(3))  # a busy machine only adds to it


@pytest.mark.slow
def test_ten_thousand_lines_parse() -> None:
    program = parse("".join(BLOCK.replace("{i}", str(i)) for i in range(1000)))
    assert len(program.statements) == 3000


def test_tables_are_kept_in_the_users_cache_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert Path(cache_file() or "").is_relative_to(tmp_path)


def test_unusable_cache_directory_is_tolerated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert cache_file() is None


class Planted:
    """A pickle of it makes a file where it is read."""

    def __init__(self, marker: Path) -> None:
        self.marker = marker

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self.marker,)


def without_parts(data: bytes) -> bytes:
    """The tables as JSON, and their digest, with nothing in them but the right key."""
    text = json.dumps({"key": json.loads(data[DIGEST:])["key"], "data": [], "memo": {}}).encode()
    return hashlib.blake2b(text).digest() + text


def test_tables_that_somebody_else_wrote_are_never_run_and_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    text = "ego = Object at Range(0, 1) @ 2\n"
    tables.cache_clear()
    first, place = parse(text), cache_file()
    assert place is not None
    written = place.read_bytes()
    tables.cache_clear()
    monkeypatch.setattr(parser, "Lark", SimpleNamespace(load=Lark.load))  # nothing is made anew
    assert parse(text) == first
    monkeypatch.setattr(parser, "Lark", Lark)
    marker = tmp_path / "marker"
    pickled = pickle.dumps(Planted(marker))
    altered = bytearray(written)
    altered[len(written) // 2] ^= 1
    for data in (
        b"0" * 64 + b"\n" + pickled, hashlib.blake2b(pickled).digest() + pickled, bytes(altered), written[:100], b"", without_parts(written),
    ):  # fmt: skip
        place.write_bytes(data)
        tables.cache_clear()
        assert parse(text) == first
        assert read_kept(place, LARGEST_TABLES) is not None
    assert not marker.exists()
    place.unlink()
    os.mkfifo(place)
    tables.cache_clear()
    assert parse(text) == first


def test_a_relative_cache_directory_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert cache_file() == tmp_path / "home" / ".cache" / "scenic-ref" / "grammar.tables"
    assert not Path("here").exists()
