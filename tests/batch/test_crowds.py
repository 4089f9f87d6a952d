"""Many objects in columns: whether any two meet is one operation, and the scenes are those of the interpreter."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
import scenic_ref
from scenic_ref.api import Backend
from scenic_ref.inference.batch.block_rejection import Batch
from scenic_ref.inference.batch.graph import Crowd
from scenic_ref.semantics.scenes import default_requirements
from scenic_ref.semantics.space import box_crowds
from scenic_ref.semantics.store.errors import AttemptsExhausted

JUMBLE = """\
ego = Object at 0 @ 0, with width 1, with allowCollisions {allow}
for i in range({count}):
    Object at (4 * (i % 8) + Range(0, {away})) @ (4 * (i // 8) + 4), facing Range(0, 360) deg, with width Range(1, 3), with requireVisible False
"""


def program(count: int, away: float, allow: str = "False", rest: str = "") -> str:
    return JUMBLE.format(count=count, away=away, allow=allow) + rest


def batch_of(text: str) -> Batch:
    scenario = scenic_ref.loads(text)
    return Batch(scenario.start, fuel=scenario.fuel)


def scenes(text: str, backend: Backend, n: int, seed: int = 3) -> list[dict[str, Any]]:
    return [scene.to_json() for scene in scenic_ref.loads(text).sample_many(n, seed, backend=backend)]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "text",
    [
        program(55, 2.5), program(55, 2.5, "True"), program(60, 0.8, rest="require ego.position.x < 1\n"),
        program(55, 2.3, rest="mutate ego\n"), program(52, 0.5, rest="Object at Uniform(3 @ 0, 4 @ 0, 0.2 @ 0.2), with requireVisible False\n"),
        program(56, 2.3, rest="workspace = Workspace(RectangularRegion(14 @ 14, 0, 60, 60))\n"),
    ],
)  # fmt: skip
def test_the_scenes_are_those_of_the_interpreter(text: str) -> None:
    found = scenes(text, "batch", 12)
    assert found == scenes(text, "interpreter", 12)
    assert "Range(0, 2" not in text or max(one["attempts"] for one in found) > 1
    assert any(isinstance(node.function, Crowd) for node in batch_of(text).graph.nodes)


def test_few_objects_are_pairs() -> None:
    assert not any(isinstance(node.function, Crowd) for node in batch_of(program(20, 1.2)).graph.nodes)


@pytest.mark.parametrize("backend", ["interpreter", "batch"])
def test_open_boxes_may_touch(backend: Backend) -> None:
    text = "ego = Object at Range(0, 0.001) @ 9\nfor i in range(60):\n    Object at (i @ 0), with requireVisible False\n"
    with pytest.raises(AttemptsExhausted):
        next(iter(scenic_ref.loads(text).sample_many(1, 0, backend=backend, max_attempts=50)))
    allowed = scenic_ref.loads(text, readings={"touching": "allow"})
    assert next(iter(allowed.sample_many(1, 0, backend=backend, max_attempts=50)))


def test_a_graph_grows_with_the_objects_and_not_with_their_pairs() -> None:
    sizes = [len(batch_of(program(count, 0.5)).graph.nodes) for count in (60, 120, 240)]
    assert sizes[2] - sizes[1] < 2.2 * (sizes[1] - sizes[0])
    assert sizes[0] < 60 * 40


@pytest.mark.slow
@pytest.mark.extra("fast")
def test_compiled_scenes_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer objects than make a crowd else, since compiling takes as long as there are objects."""
    monkeypatch.setattr(default_requirements, "MANY", 15)
    text = program(20, 2.5)
    batch = batch_of(text)
    assert any(isinstance(node.function, Crowd) for node in batch.graph.nodes)
    assert batch.compile(), batch.not_compiled
    assert [scene.to_json() for scene in batch.scenes(60, 5)] == scenes(text, "interpreter", 60, 5)


@pytest.mark.extra("fast")
@pytest.mark.parametrize("closed", [True, False])
def test_compiled_a_crowd_meets_if_it_does_in_columns(closed: bool) -> None:
    from scenic_ref.inference.batch.primitives.numba_kernels import row_meets

    told = [row_meets(row, closed) for row in map(crowd, range(200))]
    assert told == [box_crowds.row_meets(row.T, closed) for row in map(crowd, range(200))]
    assert 40 < sum(told) < 160


def crowd(seed: int) -> np.ndarray:
    """The numbers of boxes, few of which meet; some touch but for rounding, some have no bounds."""
    choose = random.Random(seed)
    rows = []
    for k in range(70):
        angle = choose.uniform(-4, 4)
        size = choose.choice([0.1, 0.5, 1.0, 1.2])
        rows.append([3.0 * (k % 9), 3.0 * (k // 9) + choose.uniform(-0.4, 0.4), math.cos(angle), math.sin(angle), size, choose.uniform(0.1, 1.2)])
    if seed % 4 == 1:
        rows[3], rows[60] = [99.0, 1.0, 1.0, 0.0, 0.5, 0.5], [100.0, 1.3, 1.0, 0.0, 0.5, 0.5]
    if seed % 4 == 2:
        rows[seed % 70][choose.choice([0, 1, 4, 5])] = choose.choice([math.inf, math.nan, 1e300, -1.0])
    return np.array(rows)


@pytest.mark.slow
def test_importance_gives_no_scene_in_which_boxes_meet() -> None:
    """Without the requirement some three eighths of the scenes would be such (1.6 attempts per scene by rejection).

    That none of these is one happens by chance once in 80,000.
    """
    found = scenic_ref.loads(program(55, 2.5, "True")).infer("importance", 24, 1).scenes
    assert len(found) == 24
    for scene in found:
        boxes = [(o.position.x, o.position.y, o.heading, o.width, o.length) for o in scene.objects[1:]]
        numbers = [n for x, y, heading, w, h in boxes for n in (x, y, math.cos(heading), math.sin(heading), w / 2, h / 2)]
        assert not box_crowds.crowd_meets(True, *numbers)


@pytest.mark.extra("torch")
def test_by_torch_the_scenes_are_the_same() -> None:
    text = program(55, 2.3)
    found = list(scenic_ref.loads(text).on_device("cpu").sample_many(12, 3, backend="batch"))
    plain = list(scenic_ref.loads(text).sample_many(12, 3, backend="batch"))
    assert [s.attempts for s in found] == [s.attempts for s in plain]
    assert all(abs(a.position.x - b.position.x) < 1e-9 for s, t in zip(found, plain, strict=True) for a, b in zip(s.objects, t.objects, strict=True))


def test_a_crowd_of_which_no_run_is_left_is_rejected() -> None:
    """Here ego sees hardly any of the objects, so that all runs of a block are rejected before collisions are looked at."""
    text = "ego = Object at 0 @ -5\nfor i in range(55):\n    Object at Range(0, 900) @ Range(0, 900)\n"
    with pytest.raises(AttemptsExhausted, match="visible from ego"):
        list(scenic_ref.loads(text).sample_many(20, 0, backend="batch", max_attempts=300))
    assert len(box_crowds.crowd_meets(True, *[np.zeros(0)] * 60)) == 0  # type: ignore[arg-type]
