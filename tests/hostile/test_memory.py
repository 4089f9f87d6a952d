"""A lack of memory is the program's error whoever meets it: Python, GEOS, or the library that writes tables."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest
import scenic_ref
import shapely
from scenic_ref.cli.error_messages import report_error
from scenic_ref.cli.session import Session
from scenic_ref.errors import ProgramError
from scenic_ref.interpreter.runtime.limits import Limits
from scenic_ref.interpreter.runtime.process_sandbox import WALL, limit_time
from scenic_ref.interpreter.runtime.regular_file import read_regular_file
from scenic_ref.roads.geodata import read_site
from scenic_ref.semantics.machine.values import Native
from scenic_ref.semantics.python import builtins
from scenic_ref.semantics.store.memory_errors import is_out_of_memory

OF_GEOS = shapely.errors.GEOSException("std::bad_alloc")
linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only there the address space is limited like this")
PLAIN = "ego = Object at 1 @ 2\nparam z = 1\n"
LARGE = (
    "ego = Object at Range(0, 1) @ 2\nt = 'x' * 1000000\n"
    "for i in range(100):\n    Object at 0 @ (5 * i + 10), with s t, with requireVisible False\n"
)
"""Each row of a table has the text; in memory, before it is written, there is one."""
FORMATS = [".npz", ".csv", *(pytest.param(one, marks=pytest.mark.extra("parquet")) for one in (".parquet", ".arrow"))]


def no_memory(*_: object, **__: object) -> object:
    """What GEOS does where it gets no memory."""
    raise OF_GEOS


def written(folder: Path, text: str, *options: str) -> subprocess.CompletedProcess[bytes]:
    """The command `run` for a program, in a process of its own."""
    (folder / "p.scenic").write_text(text)
    return subprocess.run(
        [sys.executable, "-m", "scenic_ref", "run", "p.scenic", *options], cwd=folder, capture_output=True, check=False
    )


@pytest.mark.parametrize(("error", "expected"), [
    (MemoryError(), True), (OF_GEOS, True), (shapely.errors.GEOSException("IllegalArgumentException"), False),
    (OSError("std::bad_alloc"), True), (OSError(2, "No such file", "std::bad_alloc"), False), (ValueError("std::bad_alloc"), False),
])  # fmt: skip
def test_what_a_lack_of_memory_is(error, expected):
    assert is_out_of_memory(error) is expected


def test_geos_without_memory_is_an_error_of_the_program(monkeypatch):
    """One that the program cannot catch, at the place of the operation."""
    monkeypatch.setitem(builtins.BUILTINS, "hole", Native("hole", no_memory))
    text = "try:\n    x = hole()\nexcept Exception:\n    x = 1\nego = Object\n"
    with pytest.raises(ProgramError, match="more memory than there is") as told:
        scenic_ref.loads(text).sample()
    assert told.value.span.line == 2


@pytest.mark.parametrize("name", ["force_2d", "from_wkt", "get_coordinates"])
def test_geos_without_memory_is_no_fault_of_a_map(monkeypatch, name, tmp_path):
    (tmp_path / "map.wkt").write_text("POINT (1 2)\n# " + name)
    monkeypatch.setattr(shapely, name, no_memory)
    with pytest.raises(shapely.errors.GEOSException):
        read_site(tmp_path / "map.wkt")


def test_geos_without_memory_is_an_error_within_the_walls(monkeypatch, capfd):
    WALL.build(Limits(None, 60))
    try:
        with pytest.raises(ProgramError, match="the program needs more memory than it may have"):
            limit_time("reading a map")(no_memory)()
    finally:
        WALL.open()
    assert report_error(OF_GEOS, Session()) == 1
    assert "more memory" in capfd.readouterr().err


@linux
@pytest.mark.slow
@pytest.mark.parametrize("limit", ["16M", "100M", "300M"])
@pytest.mark.parametrize("suffix", FORMATS)
def test_the_library_that_writes_a_table_has_memory_of_its_own(suffix, limit, tmp_path):
    done = written(tmp_path, PLAIN, "-n", "3", "-o", f"o{suffix}", "--limit-memory", limit)
    assert done.returncode == 0, done.stderr
    assert sorted(file.name for file in tmp_path.iterdir()) == [f"o{suffix}", "p.scenic"]


@linux
@pytest.mark.slow
@pytest.mark.extra("parquet")
def test_the_library_that_writes_a_stream_has_memory_of_its_own(tmp_path):
    done = written(tmp_path, PLAIN, "-n", "3", "--format", "arrow", "--limit-memory", "16M")
    assert (done.returncode, bool(done.stdout)) == (0, True), done.stderr


@linux
@pytest.mark.slow
@pytest.mark.extra("parquet")
@pytest.mark.parametrize("suffix", [".parquet", ".arrow"])
def test_a_table_that_needs_too_much_memory_is_an_error_of_the_program(suffix, tmp_path):
    done = written(tmp_path, LARGE, "-n", "12", "-o", f"o{suffix}", "--limit-memory", "100M")
    assert done.returncode == 1, done.stderr
    assert b"needs more memory than" in done.stderr and b"--limit-memory" in done.stderr
    assert [file.name for file in tmp_path.iterdir()] == ["p.scenic"]


def test_reading_a_file_takes_the_memory_of_the_file_and_not_of_the_largest_that_may_be(tmp_path):
    (tmp_path / "small").write_bytes(b"x" * 1000)
    tracemalloc.start()
    try:
        assert read_regular_file(tmp_path / "small", 1 << 28) == b"x" * 1000
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()
    assert read_regular_file(tmp_path / "small", 1000) == b"x" * 1000
    with pytest.raises(OSError, match="too large"):
        read_regular_file(tmp_path / "small", 999)
    if Path("/proc/self/status").exists():  # which does not say its size
        assert read_regular_file("/proc/self/status", 1 << 20).startswith(b"Name:")
