"""Files in memory by which processes of one machine hand over texts."""

from __future__ import annotations

import errno
import multiprocessing
import os
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from scenic_ref.cli.scene_outputs import LinesFile
from scenic_ref.inference.batch.jobs import memory_files
from scenic_ref.inference.batch.jobs.memory_files import Shelf, lay
from scenic_ref.inference.batch.jobs.worker_pools import processes
from scenic_ref.interpreter.runtime.process_sandbox import WALL
from scenic_ref.sampling.batch_sampler import Portion, portions
from scenic_ref.sampling.program_source import Source
from scenic_ref.sampling.scene_sampler import Job
from scenic_ref.semantics.store.errors import UsageError

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
        assert b"".join(shelf.read(4)) == b"abc\n"
        shelf.put_back()
        assert b"".join(shelf.read(3_000_000)) == b"x" * 3_000_000
        assert shelf.lend() == first, "a file that was put back is lent again"
        assert lay(first, [b"z"]) == 1
        shelf.put_back()
        assert b"".join(shelf.read(1)) == b"z"
        assert list(shelf.read(0)) == []
    assert not open_files()


@needs_files
def test_nothing_is_laid_where_nobody_lent_a_file():
    texts = iter([b"a"])
    assert lay(f"/proc/{os.getpid()}/fd/987654", texts) is None
    assert list(texts) == [b"a"], "no text was asked for"


@pytest.mark.slow
@pytest.mark.parametrize("how", ["by files", "no such files", "files that cannot be opened"])
def test_the_lines_of_other_processes_are_the_same_however_they_are_sent(how, monkeypatch, request):
    request.addfinalizer(WALL.open)  # what draws the scenes here is what a process of `run` does
    source = Source("p.scenic", "ego = Object at Range(0, 1) @ 0, with tag Uniform('ä', 2)\nrequire ego.position.x > 0.5\n")
    if how == "no such files":
        monkeypatch.setattr(Shelf, "lend", lambda _: None)
    elif how != "by files":
        monkeypatch.setattr(Shelf, "lend", lambda _: f"{memory_files.OPEN_FILES.format(os.getpid())}/987654")
    job = Job(source, 3, 2, 900, 1000)
    here = b"".join(bytes(text) for portion in portions(source, job, "lines", None) for text in portion.lines)
    several = list[bytes]()
    laid = 0
    for portion in portions(source, job, "lines", processes(2), 2):
        several += map(bytes, portion.lines)
        laid += portion.laid
    assert b"".join(several) == here and here.count(b"\n") == 898
    assert laid == (len(here) if THERE and how == "by files" else 0)


@needs_files
def test_a_text_that_was_laid_is_sent_whole(tmp_path: Path) -> None:
    text = bytes(range(256)) * 40_000
    with Shelf() as shelf, (tmp_path / "out").open("wb") as out:
        assert lay(str(shelf.lend()), [text, b"!"]) == len(text) + 1
        out.write(b"before")
        out.flush()
        shelf.read(len(text)).send(out.fileno())
    assert (tmp_path / "out").read_bytes() == b"before" + text


def portion_of(lines: Iterable[bytes | memoryview], count: int) -> Portion:
    return Portion(0, np.ones(count, dtype=int), lines, None, Counter(), (), 0, 0.0, None)


@needs_files
@pytest.mark.parametrize("problem", [errno.EINVAL, errno.ENOSPC])
def test_lines_that_cannot_be_sent_are_written_or_cut_off(problem: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "scenes.jsonl"
    send, limit = os.sendfile, 100

    def fails(target: int, source: int, offset: int, count: int) -> int:
        if offset >= limit:
            raise OSError(problem, os.strerror(problem))
        return send(target, source, offset, min(count, limit - offset))

    with Shelf() as shelf, LinesFile(str(path), resume=False) as output:
        assert lay(str(shelf.lend()), [b"{}\n" * 50]) == 150
        output.write_many(portion_of(shelf.read(150), 50))
        assert output.written == 50
        monkeypatch.setattr(os, "sendfile", fails)
        if problem == errno.EINVAL:
            output.write_many(portion_of(shelf.read(150), 50))
        else:
            with pytest.raises(UsageError, match="cannot be written: No space left"):
                output.write_many(portion_of(shelf.read(150), 50))
        assert output.written == (100 if problem == errno.EINVAL else 50)
    assert path.read_bytes() == b"{}\n" * output.written, "whole lines, without what was half written"
