"""Texts that are none: halves of characters, texts of exceptions that are no texts, addresses."""

from __future__ import annotations

import json

import pytest
import scenic_ref
from scenic_ref.cli import run_command_line
from scenic_ref.inference.batch import Batch
from scenic_ref.semantics.store.errors import RunError, ScenicError, UncaughtException

HALF = "ego = Object at (Range(0, 1), 0)\nparam x = 'a\\ud800\u00e9', y = {'\\udfff': 1}\n"


def test_half_a_character_is_written_as_json_has_it(tmp_path, capfd):
    (tmp_path / "p.scenic").write_text(HALF)
    for arguments in (["run", "-n", "3", "-o", str(tmp_path / "x.jsonl")], ["run", "-n", "3", "-o", str(tmp_path / "x.npz")], ["run", "-n", "1", "-o", "-"]):
        assert run_command_line([arguments[0], str(tmp_path / "p.scenic"), *arguments[1:]]) == 0
    line = (tmp_path / "x.jsonl").read_text(encoding="utf-8").splitlines()[0]
    assert "a\\ud800\u00e9" in line
    assert json.loads(line)["params"] == {"x": "a\ud800\u00e9", "y": {"\udfff": 1}}
    capfd.readouterr()
    assert run_command_line(["trace", str(tmp_path / "p.scenic"), "--html", str(tmp_path / "x.html")]) == 0


def test_columns_write_it_alike():
    scenario = scenic_ref.loads(HALF)
    scenario.rehearse()
    batch = Batch(scenario.start, fuel=scenario.fuel)
    assert [scene.to_line() for scene in batch.scenes(12, 3)] == [scenario.sample(3, i).to_line() for i in range(12)]


@pytest.mark.parametrize("body", ["return 3", "raise E('x')", "raise ValueError", "return 'a' * 10 ** 9"])
def test_an_exception_whose_text_is_none_is_told_without(body):
    text = f"ego = Object at (0, 0)\nclass E(Exception):\n    def __str__(self): {body}\nraise E('a')\n"
    with pytest.raises(UncaughtException) as caught:
        scenic_ref.loads(text).sample()
    assert caught.value.message == "E"


def test_a_very_long_text_of_an_exception_is_cut():
    with pytest.raises(UncaughtException) as caught:
        scenic_ref.loads("ego = Object at (0, 0)\nraise ValueError('a' * 10 ** 6)\n").sample()
    assert 900 < len(caught.value.message) < 1100


def test_hashes_of_nan_are_those_of_the_program():
    text = "ego = Object at (0, 0)\nn = float('nan')\nparam x = [hash(n), hash((n, 1)), hash(complex(n, 1))]\n"
    assert scenic_ref.loads(text).sample(0, 0).params == scenic_ref.loads(text).sample(0, 1).params


def test_no_message_names_an_address():
    with pytest.raises(RunError) as caught:
        scenic_ref.loads("ego = Object at (0, 0)\nclass A(object): pass\nx = PolygonalRegion([A(), A(), A()])\n").sample()
    assert "0x" not in caught.value.message


LONG = "n = 10 ** 5000\n"


@pytest.mark.parametrize("use", ["print(n)", "x = {}[n]", "x = str(n)", "x = f'{n}'", "require[n] True", "assert False, n", "raise ValueError(n)", "mutate ego by n"])
def test_a_number_with_too_many_digits_is_a_mistake_with_its_place(use):
    with pytest.raises(ScenicError) as found:
        scenic_ref.loads(f"ego = Object at (0, 0)\n{LONG}{use}\n").sample()
    assert found.value.span.line == 3


@pytest.mark.parametrize("value", ["{n: 1}", "range(n)", "Exception(n)", "[n]", "(n, {n})"])
def test_a_scene_can_hold_a_number_with_too_many_digits(value):
    scene = scenic_ref.loads(f"ego = Object at (0, 0)\n{LONG}param x = {value}\n").sample()
    assert len(scene.to_line()) < 20_000 and "x" in json.loads(scene.to_line())["params"]
