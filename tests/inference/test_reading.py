"""Samples are read alike with the quick decoder of the extra `fast` and without it."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from scenic_ref.inference.comparison import sample_files
from scenic_ref.inference.comparison.sample_files import scenes_in
from scenic_ref.semantics.store.errors import UsageError

BOM = b"\xef\xbb\xbf"
ODD = [
    '{"objects": [], "params": {"x": 1e400, "y": NaN, "z": -Infinity}}',
    '{"objects": [], "seed": 123456789012345678901234567890, "scene": 3}',
    '{"objects": [], "seed": 18446744073709551615, "params": {"a": 1, "a": 2, "b": -0.0, "c": 0.1e-400}}',
    '{"objects": [], "params": {"t": "\\ud800", "u": "\\u00e9\u00e9 \u2028"}}',
    '{"objects": [], "params": {"n": 18446744073709551616, "deep": ' + "[" * 500 + "]" * 500 + "}}",
]


@pytest.fixture(params=["plain", pytest.param("quick", marks=pytest.mark.extra("fast"))])
def decoder(request, monkeypatch):
    if request.param == "plain":
        monkeypatch.setattr(sample_files, "quick_decoder", lambda: None)
    else:
        assert sample_files.quick_decoder() is not None


def written(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def same(one: object, other: object) -> bool:
    """Equality in which NaN is equal to itself, and large integers to the floats nearest to them."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, float) and isinstance(other, (int, float)):
        return one == float(other) or (math.isnan(one) and math.isnan(other))
    return type(one) is type(other) and one == other


def test_odd_values_are_read(decoder, tmp_path):
    for number, text in enumerate(ODD):
        found = list(scenes_in(written(tmp_path / f"{number}.jsonl", f"{text}\n\n{text}".encode())))
        assert [line for line, _ in found] == [1, 3]
        assert all(same(scene, json.loads(text)) for _, scene in found)
        assert all(type(scene.get("seed", 0)) is int for _, scene in found)


def test_a_mark_of_the_byte_order_and_ends_of_lines_do_not_matter(decoder, tmp_path):
    found = list(scenes_in(written(tmp_path / "x.jsonl", BOM + b'  {"objects": []} \r\n\t{"objects": [], "weight": 1}\r\n')))
    assert [line for line, _ in found] == [1, 2]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (b'{"objects": [}', "line 2: this is not JSON"), (b"[1]", "line 2: a scene is an object"), (b'{"objects": ["\xff"]}', "not text in UTF-8"),
        (b'{"objects": []}, {"objects": []}', "line 2: this is not JSON"), (b'{"objects": [], "weight": 2}', "weighted scenes"),
    ],
)  # fmt: skip
def test_what_is_no_scene_is_told_with_its_line(decoder, line, told, tmp_path):
    with pytest.raises(UsageError, match=told):
        list(scenes_in(written(tmp_path / "x.jsonl", b'{"objects": []}\n' + line + b"\n" + b'{"objects": []}\n')))
