"""What a file is written as is what its ending says; an ending that nobody knows is refused before anything is drawn."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

REFUSED = [
    (("run", "random.scenic", "-n", 3, "-o"), ("x.feather", "x.txt", "x.jsonl.gz"), "a name without an ending, .parquet, .arrow, .npz or .csv"),
    (("run", "random.scenic", "--plot"), ("x.jpg", "x", "-"), ".png, .pdf or .svg"),
    (("run", "ok.scenic", "--backend", "enumerate", "-o"), ("x.csv", "x.jsonl", "x"), "as .json"),
    (("run", "ok.scenic", "--backend", "enumerate", "--plot"), ("x.jpg",), ".png, .pdf or .svg"),
    (("simulate", "ok.scenic", "-o"), ("x.csv", "x.parquet", "x.npz"), ".jsonl, .ndjson or a name without an ending"),
    (("simulate", "ok.scenic", "--html"), ("x.txt", "x"), ".html or .htm"),
    (("simulate", "ok.scenic", "--gif"), ("x.png", "x"), "as .gif"),
    (("trace", "ok.scenic", "--html"), ("x.txt",), ".html or .htm"),
    (("check", "ok.scenic", "--samples", "ok.scenic", "--report"), ("x.txt",), "as .html"),
    (("check", "ok.scenic", "--samples", "ok.scenic", "--junit"), ("x.txt",), "as .xml"),
    (("conformance", "--json"), ("x.csv",), "as .json"),
    (("bench", "ok.scenic", "--json"), ("x.csv",), "as .json"),
    (("bench", "ok.scenic", "--plot"), ("x.jpg",), ".png, .pdf or .svg"),
]  # fmt: skip


@pytest.mark.parametrize(("command", "path", "known"), [(command, path, known) for command, paths, known in REFUSED for path in paths])
def test_an_unknown_ending_is_refused_by_name(ask, command, path, known):
    before = set(Path().iterdir())
    found = ask(*command, path)
    assert (found.code, found.out) == (2, "")
    assert f"{command[-1]} {path}: " in found.err
    assert known in found.err
    assert set(Path().iterdir()) == before


def test_an_ending_is_read_whatever_its_case(ask):
    assert ask("run", "random.scenic", "-n", 2, "-o", "x.NPZ").code == 0
    assert ask("run", "random.scenic", "-n", 2, "-o", "x.JSONL").code == 0
    assert Path("x.NPZ").read_bytes()[:2] == b"PK"
    assert [json.loads(line)["scene"] for line in Path("x.JSONL").read_text().splitlines()] == [0, 1]


def test_what_is_written_without_an_ending_can_be_checked(ask):
    assert ask("run", "ok.scenic", "-n", 20, "-o", "scenes").code == 0
    assert ask("check", "ok.scenic", "--samples", "scenes", "--detect-tv", 0.9).code in (0, 5)


def test_devices_need_no_ending(ask):
    assert ask("run", "ok.scenic", "-n", 2, "-o", "/dev/null").code == 0
