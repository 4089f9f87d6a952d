"""Files of runs that were ended in the middle: nothing half-written is there, or the next run that writes the same file removes it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from scenic_ref.data.table_files import KINDS_OF_FILE, open_table
from scenic_ref.interpreter.runtime import atomic_files
from scenic_ref.interpreter.runtime.atomic_files import (
    is_running,
    nameless_file,
    remove_unfinished,
    whole_file,
    write_whole,
)

posix = pytest.mark.skipif(sys.platform == "win32", reason="this system has no such signals")
WAYS = ["nameless", "named"]
WRITING = """
import signal, sys, time
from pathlib import Path
from scenic_ref.interpreter.runtime import atomic_files
if hasattr(signal, "SIGHUP"):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # whoever started the tests may have it ignored
if sys.argv[1] == "named":
    atomic_files.NAMELESS = 0
with atomic_files.whole_file(Path("o.npz")) as file:
    file.write(b"half")
    file.flush()
    print("now", flush=True)
    time.sleep(60)
"""
WRITING_A_TABLE = """
import sys, time
from scenic_ref.cli import main
from scenic_ref.data.table_files import KINDS_OF_FILE
kind = KINDS_OF_FILE["." + sys.argv[-1].rpartition(".")[2]]
complete = kind.complete
def slowly(*arguments):
    complete(*arguments)
    arguments[-1].flush()
    print("now", flush=True)
    time.sleep(60)
kind.complete = slowly
main()
"""


@pytest.fixture(params=WAYS)
def way(request, monkeypatch, tmp_path):
    """With files without names, where there are such, and without."""
    if request.param == "named":
        monkeypatch.setattr(atomic_files, "NAMELESS", 0)
    elif nameless_file(tmp_path) is None:
        pytest.skip("there are no files without names here")
    return request.param


def ended(command: list[str], folder: Path, number: int) -> int:
    """The exit code of a process to which a signal is sent as soon as it says "now"."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as running:
        assert running.stdout is not None and running.stdout.readline() == "now\n"
        running.send_signal(number)
        running.communicate()
    return running.returncode


@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT", "SIGKILL"])
@pytest.mark.parametrize("older", [False, True])
def test_a_signal_in_the_middle_leaves_what_was_there_before(way, name, older, tmp_path):
    if older:
        (tmp_path / "o.npz").write_bytes(b"older")
    number = getattr(signal, name)
    assert ended([sys.executable, "-c", WRITING, way], tmp_path, number) == -number
    if (way, name) == ("named", "SIGKILL"):  # nobody could remove it but the next run
        remove_unfinished(tmp_path / "o.npz")
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == ([("o.npz", b"older")] if older else [])


@pytest.mark.slow
@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGKILL"])
@pytest.mark.parametrize("suffix", [".npz", ".csv", *(pytest.param(one, marks=pytest.mark.extra("parquet")) for one in (".parquet", ".arrow"))])
def test_a_run_that_is_ended_while_it_writes_a_table_leaves_nothing(suffix, name, tmp_path):
    if nameless_file(tmp_path) is None:
        pytest.skip("there are no files without names here")
    (tmp_path / "p.scenic").write_text("ego = Object at 1 @ 2\n")
    number = getattr(signal, name)
    command = [sys.executable, "-c", WRITING_A_TABLE, "run", "p.scenic", "-n", "3", "-o", f"o{suffix}"]
    assert ended(command, tmp_path, number) == -number
    assert [file.name for file in tmp_path.iterdir()] == ["p.scenic"]


def test_a_file_has_its_name_when_it_is_whole(way, tmp_path):
    place = tmp_path / "o"
    for data in (b"first", b"second"):
        before = place.exists() and place.read_bytes()
        with whole_file(place) as file:
            file.write(data)
            file.flush()
            assert (place.exists() and place.read_bytes()) == before
        assert place.read_bytes() == data
    with pytest.raises(KeyError), whole_file(place) as file:
        file.write(b"third")
        raise KeyError
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [("o", b"second")]


@posix
def test_a_file_has_the_rights_that_others_have(way, tmp_path):
    with whole_file(tmp_path / "o"):
        pass
    (tmp_path / "other").write_bytes(b"")
    assert (tmp_path / "o").stat().st_mode == (tmp_path / "other").stat().st_mode


@posix
def test_a_link_is_replaced_and_not_followed(way, tmp_path):
    (tmp_path / "precious").write_bytes(b"precious")
    (tmp_path / "o").symlink_to("precious")
    write_whole(tmp_path / "o", b"new")
    assert ((tmp_path / "o").read_bytes(), (tmp_path / "precious").read_bytes()) == (b"new", b"precious")


def test_where_a_file_without_a_name_gets_none_it_is_copied(monkeypatch, tmp_path):
    def link(*_: object) -> None:
        raise OSError

    monkeypatch.setattr(atomic_files, "link", link)
    write_whole(tmp_path / "o", b"data")
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [("o", b"data")]


def test_what_a_process_of_the_same_number_left_is_replaced(way, tmp_path):
    (tmp_path / "o").write_bytes(b"older")
    (tmp_path / f".o.{os.getpid()}.unfinished").write_bytes(b"half")
    write_whole(tmp_path / "o", b"data")
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [("o", b"data")]


def test_handlers_of_signals_are_as_before(way, tmp_path):
    numbers = [getattr(signal, name) for name in atomic_files.ENDING_SIGNALS if hasattr(signal, name)]
    before = [signal.getsignal(number) for number in numbers]
    write_whole(tmp_path / "o", b"data")
    assert [signal.getsignal(number) for number in numbers] == before


@pytest.mark.parametrize("suffix", [".npz", ".csv"])
def test_what_a_killed_run_left_is_removed_by_the_next_one(suffix, tmp_path):
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    left = tmp_path / f".t{suffix}.{gone.pid}.unfinished"
    others = [tmp_path / name for name in (f".t{suffix}.1.unfinished", f".u{suffix}.{gone.pid}.unfinished", f".t{suffix}.x.unfinished")]
    for file in (left, *others):
        file.write_bytes(b"half")
    open_table(tmp_path / f"t{suffix}").close()
    assert not left.exists()
    assert all(other.exists() for other in others)


def test_a_process_is_running_or_not():
    assert is_running(os.getpid()) and not is_running(2**30) and not is_running(2**80)
    assert set(KINDS_OF_FILE) == {".parquet", ".arrow", ".npz", ".csv"}
