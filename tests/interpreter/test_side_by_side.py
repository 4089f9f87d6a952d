"""Runs of one scenario side by side: in threads, or one begun while another stands in a host call. Each has a state of its own."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest
import scenic_ref

KEYS = """
def key(x):
    total = 0
    for i in range(5):
        total = total + x * i
    return -total

a = Range(0, 1)
b = Range(0, 1)
F = VectorField("F", lambda p: p.x * a + key(b))
ego = Object at Range(0, 1) @ 0, facing F
low, high = sorted([a, b], key=lambda v: key(v) + ego.position.x)
order = []

def noted(x):
    order.append(x)
    return x

noted(a)
sorted([a, b, a + b], key=lambda x: x + len(order))
Object at (10 + low, high), facing F, with tag order
"""
MEETING = "from meeting import meet\nego = Object at Range(0, 1) @ 0\nparam x = meet(lambda: ego.position.x)\n"


def features(scene: scenic_ref.Scene) -> list[object]:
    """What the tests compare of a scene."""
    return [*((o.position, o.heading) for o in scene.objects), sorted(scene.params.items())]


@pytest.fixture
def scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> scenic_ref.Scenario:
    """A program that gives a function to a module of Python; the test says what `meet` does."""
    (tmp_path / "meeting.py").write_text("hooks = []\ndef meet(f):\n    for hook in hooks:\n        hook()\n    return f()\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "meeting", raising=False)
    return scenic_ref.loads(MEETING, trust=True, directory=tmp_path)


def test_a_run_inside_a_host_call_of_another_leaves_it_as_it_was(scenario: scenic_ref.Scenario) -> None:
    alone = [features(scenario.sample(0, index)) for index in range(3)]
    hooks = sys.modules["meeting"].hooks
    inner: list[object] = []

    def begin_another() -> None:
        hooks.clear()
        inner.append(features(scenario.sample(0, 1)))

    hooks.append(begin_another)
    assert features(scenario.sample(0, 0)) == alone[0]
    assert inner == [alone[1]]


def test_two_threads_inside_host_calls_at_once_draw_the_scenes_of_one(scenario: scenic_ref.Scenario) -> None:
    alone = [features(scenario.sample(0, index)) for index in range(4)]
    both = Barrier(2)
    sys.modules["meeting"].hooks.append(lambda: both.wait() and None)
    with ThreadPoolExecutor(2) as threads:
        assert [features(scene) for scene in threads.map(lambda index: scenario.sample(0, index), range(4))] == alone


@pytest.mark.slow
@pytest.mark.parametrize("many", [False, True])
def test_threads_that_switch_all_the_time_draw_the_scenes_of_one(many: bool) -> None:
    scenario = scenic_ref.loads(KEYS)
    alone = [features(scenario.sample(0, index)) for index in range(40)]

    def draw(_: int) -> list[list[object]]:
        if many:
            return [features(scene) for scene in scenario.sample_many(40, 0, backend="auto")]
        return [features(scenario.sample(0, index)) for index in range(40)]

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-4)
    try:
        with ThreadPoolExecutor(4) as threads:
            assert list(threads.map(draw, range(4))) == [alone] * 4
    finally:
        sys.setswitchinterval(interval)
