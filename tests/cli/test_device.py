"""`scenic-ref run --device`: the same scenes by torch, the report says what torch did not do, and what is missing is told."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from .conftest import Ask

MIXED = """\
import math
x = Range(0, 1)
ego = Object at (x, Normal(0, 1)), facing Range(0, 360) deg
Object at (math.exp(x) + 6, Range(0, 3)), facing toward ego, with c Uniform('a', 'b')
require x > 0.3
param p = x
"""


def nearly(left: object, right: object) -> bool:
    """Whether two values of JSON are the same, numbers up to the rounding that is promised."""
    if isinstance(left, float) and isinstance(right, float):
        return math.isclose(left, right, rel_tol=1e-9, abs_tol=1e-9)
    if isinstance(left, dict) and isinstance(right, dict):
        return left.keys() == right.keys() and all(nearly(left[k], right[k]) for k in left)
    if isinstance(left, list) and isinstance(right, list):
        return len(left) == len(right) and all(map(nearly, left, right))
    return left == right


def scenes(path: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in Path(path).read_text().splitlines()]


@pytest.mark.extra("torch")
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_torch_writes_the_same_scenes(ask: Ask, workers: int):
    Path("mixed.scenic").write_text(MIXED)
    plain = ask("run", "mixed.scenic", "-n", 60, "-o", "plain.jsonl")
    found = ask("run", "mixed.scenic", "-n", 60, "-o", "torch.jsonl", "--device", "cpu", "--workers", workers)
    assert found.code == 0, found.err
    assert all(map(nearly, scenes("plain.jsonl"), scenes("torch.jsonl")))
    assert len(scenes("torch.jsonl")) == 60
    lines = found.err.splitlines()
    assert lines[1] == "drawn by the batch backend with torch on cpu; 0 runs were left to the interpreter, 0 to NumPy, since rounding might decide"
    assert lines[2] == "by NumPy, with all that it is made of, since torch does not have it: exp"
    assert lines[3:] == plain.err.splitlines()[2:]


@pytest.mark.extra("torch")
def test_one_scene_is_drawn_by_torch_as_well_if_that_is_asked_for(ask: Ask):
    assert "with torch on cpu" in ask("run", "random.scenic", "--device", "cpu", "-o", "one.jsonl").err
    assert "with torch on cpu" in ask("run", "random.scenic", "--device", "cpu", "--scene", "3", "-o", "three.jsonl").err
    ask("run", "random.scenic", "-n", 4, "-o", "four.jsonl")
    assert nearly(scenes("one.jsonl") + scenes("three.jsonl"), [scenes("four.jsonl")[0], scenes("four.jsonl")[3]])


@pytest.mark.extra("torch")
def test_what_torch_does_not_draw_is_told(ask: Ask):
    found = ask("run", "prints.scenic", "-n", 12, "--device", "cpu", "-o", "out.jsonl")
    assert "drawn by the interpreter, since the batch backend cannot draw from this program" in found.err
    apart = "".join(f"{name}Object at (Range({k}, {k + 9}), 0), with requireVisible False\n" for name, k in (("ego = ", 0), ("other = ", 30)))
    Path("apart.scenic").write_text(apart + "require ego.position.x > 8.9\nrequire other.position.x > 38.9\n")
    found = ask("run", "apart.scenic", "-n", 12, "--device", "cpu", "--prune", "-o", "out.jsonl")
    assert "drawn by the batch backend, without torch: parts of a scene are drawn apart" in found.err


@pytest.mark.extra("torch")
def test_without_a_gpu_it_is_told_what_is_missing(ask: Ask, monkeypatch: pytest.MonkeyPatch):
    import torch

    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    found = ask("run", "random.scenic", "-n", 60, "--device", "cuda", "-o", "out.jsonl")
    assert found.code == 2
    assert f"the device cuda cannot be used: torch {torch.__version__}" in found.err
    assert not Path("out.jsonl").exists()


def test_device_is_about_the_batch_backend(ask: Ask):
    for options in (("--backend", "smc"), ("--backend", "interpreter"), ("--backend", "enumerate"), ("--resume", "-o", "out.jsonl")):
        found = ask("run", "random.scenic", "--device", "cpu", *options)
        assert found.code == 2
        assert "cannot be given with --device" in found.err
