"""Machine code that is kept between processes: nothing is compiled twice, and nothing is run that somebody else may have written."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

pytestmark = pytest.mark.extra("fast")

COUNTING = """
import sys
sys.path[:] = {path!r}
import scenic_ref
from numba.core import event
with event.install_recorder("numba:compile") as compiled:
    scenario = scenic_ref.loads({program!r})
    assert scenario.batch.compile(), scenario.batch.not_compiled
    lines = [scene.to_line() for scene in scenario.sample_many(50, backend="batch")]
print(len(compiled.buffer), hash(tuple(lines)))
"""
PROGRAM = "ego = Object at (Range(0, 9), 0), facing Range(0, 1)\nother = Object at (Normal(3, 1), Range(4, 8))\nrequire ego can see other\n"


def counted(cache: Path, program: str = PROGRAM, **variables: str) -> tuple[int, str]:
    """How many functions a new process compiles for a program, and a digest of the scenes."""
    environment: Mapping[str, str] = {**os.environ, "XDG_CACHE_HOME": str(cache), "PYTHONHASHSEED": "0", **variables}
    text = COUNTING.format(path=sys.path, program=program)
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, env=environment, check=True)
    count, digest = done.stdout.split()
    return int(count), digest


def kept(cache: Path) -> list[Path]:
    """The files of code."""
    return sorted((cache / "scenic-ref" / "compiled").glob("*"))


def test_a_second_process_compiles_nothing(tmp_path: Path) -> None:
    first, scenes = counted(tmp_path)
    assert first > 0 and kept(tmp_path)
    before = [(path.name, path.read_bytes()) for path in kept(tmp_path)]
    assert counted(tmp_path) == (0, scenes)
    assert [(path.name, path.read_bytes()) for path in kept(tmp_path)] == before
    assert all(path.suffix == ".code" and not path.stat().st_mode & 0o077 for path in kept(tmp_path))


@pytest.mark.slow
def test_other_programs_share_what_is_the_same_in_them(tmp_path: Path) -> None:
    first, _ = counted(tmp_path)
    other, _ = counted(tmp_path, PROGRAM.replace("Range(4, 8)", "Range(5, 8)"))
    assert 0 < other < first


@pytest.mark.slow
@pytest.mark.parametrize("harm", ["cut off", "one bit", "empty", "of another"])
def test_what_is_damaged_is_compiled_anew(harm: str, tmp_path: Path) -> None:
    first, scenes = counted(tmp_path)
    files = kept(tmp_path)
    texts = [path.read_bytes() for path in files]
    for number, path in enumerate(files):
        data = texts[number]
        changed = {
            "cut off": data[: len(data) // 2], "one bit": bytes([*data[:-9], data[-9] ^ 1, *data[-8:]]), "empty": b"", "of another": texts[number - 1]
        }  # fmt: skip
        path.write_bytes(changed[harm])
    again, same = counted(tmp_path)
    assert (again, same) == (first, scenes)


@pytest.mark.slow
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o702])
def test_nothing_is_read_or_kept_where_others_may_write(mode: int, tmp_path: Path) -> None:
    first, scenes = counted(tmp_path)
    folder = tmp_path / "scenic-ref" / "compiled"
    os.chmod(folder, mode)
    assert counted(tmp_path) == (first, scenes)
    os.chmod(folder, 0o700)
    assert counted(tmp_path) == (0, scenes)
    os.chmod(folder.parent, mode)
    assert counted(tmp_path) == (first, scenes)


@pytest.mark.slow
def test_nothing_is_kept_where_nothing_can_be_written(tmp_path: Path) -> None:
    (tmp_path / "scenic-ref").write_text("a file")
    assert counted(tmp_path)[0] > 0
    assert (tmp_path / "scenic-ref").read_text() == "a file"


@pytest.mark.slow
def test_several_processes_may_write_at_once(tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "PYTHONHASHSEED": "0"}
    text = COUNTING.format(path=sys.path, program=PROGRAM)
    running = [subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, env=environment, text=True) for _ in range(3)]
    answers = {process.communicate()[0].split()[1] for process in running}
    assert len(answers) == 1
    assert counted(tmp_path)[0] == 0
    assert not list((tmp_path / "scenic-ref" / "compiled").glob("*.part"))
