"""Many objects: pairs that are far from each other are settled together, and nothing is settled wrongly."""

from __future__ import annotations

import math
import random
from itertools import combinations

import numpy as np
import pytest
import scenic_ref
from scenic_ref.conformance.implementations.reference import trace_first_run
from scenic_ref.semantics.scenes import default_requirements
from scenic_ref.semantics.space import box_crowds, geometry
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import AttemptsExhausted, ProgramError

ROW = "ego = Object at 0 @ 0\nfor i in range({}):\n    Object at (2 * i + 2) @ 0, with requireVisible False\n"
Box = tuple[float, float, float, float, float]


def boxes(seed: int, count: int = 90) -> list[Box]:
    """x, y, headings and sizes; some objects are large, some thin, some without a size, some touch their neighbour but for rounding."""
    choose = random.Random(seed)
    side = choose.choice([20, 100, 1e6])
    found: list[Box] = []
    while len(found) < count:
        size = choose.choice([0.0, 1e-9, 0.3, 1, 3, side / 4])
        heading, width, length = choose.uniform(-4, 4), size, choose.choice([size, 1.0, 0.01])
        x, y = choose.uniform(-side, side), choose.uniform(-side, side)
        found.append((x, y, heading, width, length))
        if choose.random() < 0.2:
            found.append((x + width * math.cos(heading), y + width * math.sin(heading), heading, width, length))
    return found[:count]


def meeting(found: list[Box], *, closed: bool = True) -> set[tuple[int, int]]:
    """The pairs that intersect, one by one."""
    return {
        (i, j) for (i, (x, y, h, w, n)), (j, (x2, y2, h2, w2, n2)) in combinations(enumerate(found), 2)
        if geometry.boxes_intersect(Vector(x, y), h, w, n, Vector(x2, y2), h2, w2, n2, closed=closed)
    }  # fmt: skip


@pytest.mark.parametrize("seed", range(12))
def test_every_pair_that_intersects_may_meet(seed: int) -> None:
    found = boxes(seed)
    near = box_crowds.near_pairs(found)
    assert near is not None
    assert near == sorted(set(near), key=lambda pair: (pair[1], pair[0]))
    assert meeting(found) <= set(near)
    assert len(near) < math.comb(len(found), 2)


@pytest.mark.parametrize("rival", ["half the reach", "no margin at all"])
def test_a_reach_that_is_too_small_would_be_noticed(rival: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if rival == "half the reach":
        monkeypatch.setattr(np, "hypot", lambda width, length: (width + length) / 4)
    else:
        monkeypatch.setattr(box_crowds, "MARGIN", -1e-3)
    with pytest.raises(AssertionError):
        for seed in range(12):
            test_every_pair_that_intersects_may_meet(seed)


@pytest.mark.parametrize("strange", [math.inf, math.nan])
def test_beside_a_box_without_bounds_all_pairs_are_looked_at(strange: float) -> None:
    found = [*boxes(1, 60), (0.0, 0.0, 0.0, strange, 1.0)]
    assert box_crowds.near_pairs(found) == [(i, j) for j in range(61) for i in range(j)]


@pytest.mark.parametrize("closed", [True, False])
def test_a_crowd_meets_if_two_of_its_boxes_do(closed: bool) -> None:
    crowds_ = [apart_or_not(seed) for seed in range(40)]
    told = [bool(meeting(found, closed=closed)) for found in crowds_]
    assert 3 < sum(told) < 37
    rows = np.array([numbers_of(found) for found in crowds_])
    assert list(box_crowds.crowd_meets(closed, *rows.T)) == told  # type: ignore[call-overload]
    assert [box_crowds.crowd_meets(closed, *row) for row in rows] == told


def apart_or_not(seed: int) -> list[Box]:
    """Boxes in a row that turn; sometimes one lies too near, and sometimes two touch."""
    choose = random.Random(seed)
    found = [(3.0 * k, choose.uniform(-0.5, 0.5), choose.uniform(-4, 4), 1.5, choose.uniform(0.1, 2)) for k in range(60)]
    if seed % 3 == 1:
        found[17] = (3.0 * 23 + choose.uniform(-1.5, 1.5), 0.9, choose.uniform(-4, 4), 1.5, 1.0)
    if seed % 3 == 2:
        found[5], found[41] = (200.0, 0.0, 0.0, 1.0, 1.0), (201.0, 0.3, 0.0, 1.0, 1.0)
    return found


def numbers_of(found: list[Box]) -> list[float]:
    return [n for x, y, heading, width, length in found for n in (x, y, math.cos(heading), math.sin(heading), width / 2, length / 2)]


def test_what_collides_is_rejected_for_the_pair_that_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    text = ROW.format(80) + "Object at 81 @ 0.3, with requireVisible False\n"
    with pytest.raises(AttemptsExhausted) as many:
        scenic_ref.loads(text).sample(seed=0, max_attempts=1)
    monkeypatch.setattr(default_requirements, "MANY", 1000)
    with pytest.raises(AttemptsExhausted) as all_pairs:
        scenic_ref.loads(text).sample(seed=0, max_attempts=1)
    assert str(many.value) == str(all_pairs.value)


def test_the_trace_tells_that_pairs_were_settled_together() -> None:
    told = [event for event in trace_first_run(scenic_ref.loads(ROW.format(60)), 0, 0).events if event.rule == "T-Check"]
    assert "no two of the 61 objects intersect" in str(told)
    assert len(told) < 200
    few = [event for event in trace_first_run(scenic_ref.loads(ROW.format(30)), 0, 0).events if event.rule == "T-Check"]
    assert len(few) >= math.comb(31, 2)


def test_values_that_are_no_numbers_are_told_where_they_are_needed() -> None:
    text = ROW.format(60) + "ego.width = 'wide'\n"
    with pytest.raises(ProgramError) as many:
        scenic_ref.loads(text).sample(seed=0)
    with pytest.raises(ProgramError) as few:
        scenic_ref.loads(text.replace("range(60)", "range(20)")).sample(seed=0)
    assert str(many.value) == str(few.value)


@pytest.mark.parametrize("width", ["1e9", "1.7e308"])
def test_a_box_as_wide_as_the_world_meets_all(width: str) -> None:
    text = ROW.format(60) + f"Object at 1000 @ 0.2, with width {width}, with requireVisible False\n"
    with pytest.raises(AttemptsExhausted, match=r"ego and Object \(object 61\) intersect"):
        scenic_ref.loads(text).sample(seed=0, max_attempts=1)


def test_of_what_is_no_number_nothing_is_said():
    assert box_crowds.near_pairs([(0.0, 0.0, 0.0, 1.0, 1.0), (0.5, 0.0, 0.0, "wide", 1.0)]) is None  # type: ignore[list-item]
