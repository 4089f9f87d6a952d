"""The texts of many numbers are those of `json`, digit for digit."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenic_ref.inference.batch.jobs import text_rows
from scenic_ref.inference.batch.jobs.text_rows import ALIKE, number_texts

EDGES = [0.0, -0.0, 5e-324, 1e-5, 1e-4, *ALIKE, 1e16, 1e17, 1e22, 2.0**53, 0.1 + 0.2, 1 / 3, 1e-7, 123456789012345.6, 999999999999999.9, 1.7e308]


def compiled(values: np.ndarray) -> list[str]:
    """The texts by compiled code."""
    from scenic_ref.inference.batch.numba_json import CompiledRows

    return b"".join(bytes(text) for text, _ in CompiledRows().joined([values, "\n"], len(values))).decode().splitlines()


@pytest.fixture(params=["quickly", "by Python", pytest.param("compiled", marks=pytest.mark.extra("fast"))])
def writer(request, monkeypatch):
    if request.param == "compiled":
        return compiled
    if request.param == "by Python":
        monkeypatch.setattr(text_rows, "quick_dumps", lambda: None)
    elif text_rows.quick_dumps() is None:
        pytest.skip("needs the extra fast")
    return number_texts


def test_many_numbers_of_all_sizes(writer):
    rng = np.random.default_rng(0)
    sizes = 10 ** rng.uniform(-8, 20, 60_000) * rng.choice([-1, 1], 60_000)
    bits = rng.integers(0, 2**64, 20_000, dtype=np.uint64).view(float)
    near = np.nextafter(np.repeat(EDGES[4:12], 3), np.tile([-np.inf, np.inf, 0], 8))
    values = np.concatenate([sizes, bits[np.isfinite(bits)], np.round(sizes, 3), np.floor(sizes), EDGES, near, -near])
    assert writer(values) == [json.dumps(v) for v in values.tolist()]


def test_numbers_at_the_edges_of_floats(writer):
    """Powers of two, where the floats below lie nearer than those above, powers of ten, and the smallest floats."""
    twos, tens = 2.0 ** np.arange(-1074, 1024), np.array([float(f"1e{k}") for k in range(-323, 309)])
    edges = np.concatenate([twos, tens, 5e-324 * np.arange(1, 300), np.arange(300) / 8, [2.0**-44, 9e15 + 0.5]])
    values = np.concatenate([edges, np.nextafter(edges, np.inf), np.nextafter(edges, 0), -edges])
    assert writer(values) == [json.dumps(v) for v in values.tolist()]


@pytest.mark.extra("fast")
def test_whole_numbers_compiled():
    values = np.array([0, 1, 9, 10, 99, 100, 10**7, 10**8 - 1, 10**8, 10**15, 10**16, 10**17, 2**63 - 1, -1, -10, -(2**63)], dtype=np.int64)
    assert compiled(values) == [str(v) for v in values.tolist()]


@settings(derandomize=True, deadline=None)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=5))
def test_any_numbers(values):
    assert number_texts(np.array(values, dtype=float)) == [json.dumps(v) for v in values]
