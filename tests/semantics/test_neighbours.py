"""Many objects: pairs that are far from each other are settled together, and nothing is settled wrongly."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import pytest
import scenic_ref
from scenic_ref.conformance.ourselves import traced
from scenic_ref.semantics.kernel.errors import AttemptsExhausted, ProgramError
from scenic_ref.semantics.scenes import default_requirements, neighbours
from scenic_ref.semantics.space import geometry
from scenic_ref.semantics.space.vectors import Vector

FEW = "ego = Object at 0 @ 0\nfor i in range({}):\n    Object at (2 * i + 2) @ 0, with requireVisible False\n"


def boxes(seed: int, count: int) -> list[tuple[float, float, float, float, float]]:
    """Positions, headings and sizes; some objects are large, some thin, some touch their neighbour but for rounding."""
    choose = random.Random(seed)
    side = choose.choice([20, 100, 1e6])
    found = []
    for _ in range(count):
        size = choose.choice([0.0, 1e-9, 0.3, 1, 3, side / 4])
        box = (choose.uniform(-side, side), choose.uniform(-side, side), choose.uniform(-4, 4), size, choose.choice([size, 1.0, 0.01]))
        found.append(box)
        if choose.random() < 0.2 and len(found) < count:
            x, y, heading, width, length = box
            found.append((x + width * math.cos(heading), y + width * math.sin(heading), heading, width, length))
    return found[:count]


def program(found: Sequence[tuple[float, ...]]) -> str:
    lines = [f"Object at ({x!r}, {y!r}), facing {h!r}, with width {w!r}, with length {n!r}, with requireVisible False" for x, y, h, w, n in found]
    return f"ego = {lines[0]}\n" + "\n".join(lines[1:]) + "\n"


@pytest.mark.parametrize("seed", range(12))
def test_every_pair_that_intersects_may_meet(seed: int) -> None:
    found = boxes(seed, 90)
    near = pairs(program(found))
    told = set(near)
    assert list(near) == sorted(near, key=lambda pair: (pair[1], pair[0]))
    meeting = {
        (i, j)
        for j, (x2, y2, *second) in enumerate(found)
        for i, (x1, y1, *first) in enumerate(found[:j])
        if geometry.boxes_intersect(Vector(x1, y1), *first, Vector(x2, y2), *second)
    }
    assert meeting <= told
    assert len(told) < len(found) * (len(found) - 1) / 2


def pairs(text: str) -> list[tuple[int, int]]:
    """What `pairs_that_may_meet` says at the end of the program's run."""
    said: list[list[tuple[int, int]]] = []

    def noted(objects, state):
        said.append(neighbours.pairs_that_may_meet(objects, state) or [])
        return []

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(default_requirements, "pairs_that_may_meet", noted)
        scenic_ref.loads(text).sample(seed=0)
    return said[-1]


@pytest.mark.parametrize("rival", ["half the reach", "no margin at all"])
def test_a_reach_that_is_too_small_would_be_noticed(rival: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if rival == "half the reach":
        monkeypatch.setattr(neighbours.np, "hypot", lambda width, length: (width + length) / 4)
    else:
        monkeypatch.setattr(neighbours, "MARGIN", -1e-3)
    with pytest.raises(AssertionError):
        for seed in range(12):
            test_every_pair_that_intersects_may_meet(seed)


def test_what_collides_is_rejected_for_the_pair_that_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    text = FEW.format(80) + "Object at 81 @ 0.3, with requireVisible False\n"
    with pytest.raises(AttemptsExhausted) as many:
        scenic_ref.loads(text).sample(seed=0, max_attempts=1)
    monkeypatch.setattr(neighbours, "MANY", 1000)
    with pytest.raises(AttemptsExhausted) as all_pairs:
        scenic_ref.loads(text).sample(seed=0, max_attempts=1)
    assert str(many.value) == str(all_pairs.value)


def test_the_trace_tells_that_pairs_were_settled_together() -> None:
    scenario = scenic_ref.loads(FEW.format(60))
    told = [event for event in traced(scenario, 0, 0).events if event.rule == "T-Check"]
    assert "the other pairs of the 61 objects are too far from each other" in str(told)
    assert len(told) < 61 * 60 / 4
    few = [event for event in traced(scenic_ref.loads(FEW.format(30)), 0, 0).events if event.rule == "T-Check"]
    assert len(few) > 31 * 30 / 2 - 1


def test_values_that_are_no_numbers_are_told_where_they_are_needed() -> None:
    text = FEW.format(60) + "ego.width = 'wide'\n"
    with pytest.raises(ProgramError) as many:
        scenic_ref.loads(text).sample(seed=0)
    with pytest.raises(ProgramError) as few:
        scenic_ref.loads(text.replace("range(60)", "range(20)")).sample(seed=0)
    assert str(many.value) == str(few.value)


@pytest.mark.parametrize("width", ["1e9", "1.7e308"])
def test_a_box_as_wide_as_the_world_meets_all(width: str) -> None:
    text = FEW.format(60) + f"Object at 1000 @ 0.2, with width {width}, with requireVisible False\n"
    with pytest.raises(AttemptsExhausted, match=r"ego and Object \(object 61\) do not intersect"):
        scenic_ref.loads(text).sample(seed=0, max_attempts=1)
