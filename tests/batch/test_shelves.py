"""Files in memory by which processes of one machine hand over texts."""

from __future__ import annotations

import multiprocessing
import os

import pytest
from scenic_ref.cli.options import Source
from scenic_ref.cli.portions import portions
from scenic_ref.cli.workers import Job
from scenic_ref.inference.batch.jobs import shelves
from scenic_ref.inference.batch.jobs.blocks import processes
from scenic_ref.inference.batch.jobs.shelves import Shelf, lay

with Shelf() as tried:
    THERE = tried.lend() is not None
needs_files = pytest.mark.skipif(not THERE, reason="the system has no such files")


def open_files() -> set[str]:
    """The open files of this process."""
    return {target for number in os.listdir("/proc/self/fd") if (target := os.path.realpath(f"/proc/self/fd/{number}")) and "scenes" in target}


@needs_files
def test_texts_of_other_processes_are_read_in_the_order_in_which_files_were_lent():
    with Shelf() as shelf:
        first, second = str(shelf.lend()), str(shelf.lend())
        texts = {first: [b"ab", b"c\n"], second: [b"x" * 3_000_000]}
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            sizes = [pool.apply(lay, (place, texts[place])) for place in (second, first)]
        assert sizes == [3_000_000, 4]
        assert bytes(shelf.read(4)) == b"abc\n"
        shelf.put_back()
        assert bytes(shelf.read(3_000_000)) == b"x" * 3_000_000
        assert shelf.lend() == first, "a file that was put back is lent again"
        assert lay(first, [b"z"]) == 1
        shelf.put_back()
        assert bytes(shelf.read(1)) == b"z"
        assert bytes(shelf.read(0)) == b""
    assert not open_files()


@needs_files
def test_nothing_is_laid_where_nobody_lent_a_file():
    texts = iter([b"a"])
    assert lay(f"/proc/{os.getpid()}/fd/987654", texts) is None
    assert list(texts) == [b"a"], "no text was asked for"


@pytest.mark.slow
@pytest.mark.parametrize("how", ["by files", "no such files", "files that cannot be opened"])
def test_the_lines_of_other_processes_are_the_same_however_they_are_sent(how, monkeypatch):
    source = Source("p.scenic", "ego = Object at Range(0, 1) @ 0, with tag Uniform('ä', 2)\nrequire ego.position.x > 0.5\n")
    if how == "no such files":
        monkeypatch.setattr(Shelf, "lend", lambda _: None)
    elif how != "by files":
        monkeypatch.setattr(Shelf, "lend", lambda _: f"{shelves.OPEN_FILES.format(os.getpid())}/987654")
    job = Job(source, 3, 2, 900, 1000)
    here = b"".join(bytes(text) for portion in portions(source, job, "lines", None) for text in portion.lines)
    several = list[bytes]()
    laid = 0
    for portion in portions(source, job, "lines", processes(2), 2):
        several += map(bytes, portion.lines)
        laid += portion.laid
    assert b"".join(several) == here and here.count(b"\n") == 898
    assert laid == (len(here) if THERE and how == "by files" else 0)
