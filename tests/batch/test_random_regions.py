"""Regions, curves and containers that are drawn: the batch backend gives the interpreter's scenes, without calling it."""

from __future__ import annotations

import random

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import AttemptsExhausted

REGIONS = (
    "CircularRegion(2 @ 1, 6)", "SectorRegion(0 @ 0, 8, 30 deg, 100 deg)", "RectangularRegion(-1 @ 2, 20 deg, 8, 5)",
    "PolygonalRegion([(-6, -5), (5, -6), (0, 7)])", "PolygonalRegion([(-6, -5), (5, -6), (0, 7)], orientation=f)",
    "PolygonalRegion([(0, 0), (9, 0), (9, 9), (4, 4)])", "PolylineRegion([(-5, -5), (0, 3), (6, 6)])",
    "PolylineRegion([(-5, 5), (0, -3), (7, 0)], orientation=False)", "PointSetRegion('spots', [(1, 1), (-3, 2), (4, -4)])",
)  # fmt: skip
CURVES = ("PolylineRegion([(-5, -5), (0, 3), (6, 6)])", "PolylineRegion([(-5, 5), (0, -3)])", "PolylineRegion([(7, 0), (0, 0), (7, 7), (2, 1)])")


def invented(seed: int) -> str:
    """A program whose objects depend on a region and a curve that are drawn, and on items of containers of several lengths."""
    numbers = random.Random(seed)
    regions = ", ".join(numbers.sample(REGIONS, numbers.randint(2, 4)))
    curves = ", ".join(numbers.sample(CURVES, numbers.randint(2, 3)))
    lists = ", ".join(str([numbers.randint(-5, 5) for _ in range(numbers.randint(1, 4))]) for _ in range(3))
    lines = [
        "f = VectorField('f', lambda v: v.x * 10 deg)", f"r = Uniform({regions})", f"c = Uniform({curves})", f"x = Uniform(*Uniform({lists}))",
        numbers.choice(["ego = Object in r", "ego = Object on r, with requireVisible False", "ego = Object at x @ 0", "ego = Object on visible r"]),
    ]  # fmt: skip
    if lines[-1].endswith("visible r"):
        lines.insert(-1, "ego = Object at 0 @ 0, with viewDistance 6, with requireVisible False, with allowCollisions True")
    further = [
        "Object on c, with allowCollisions True", "Object at c[0] offset by 2 @ x", "Object at c.points[-1], facing Range(0, 90) deg",
        "Object at c[1] offset by 0 @ c.length", "require ego in r", "require (distance from 3 @ x to r) < 4",
        "Object at x @ x, with regionContainedIn Uniform(CircularRegion(0 @ 0, 4), r)", "require[0.5] (x @ 1) in r",
        "Object in Uniform(r, CircularRegion(0 @ 0, x + 7)), with allowCollisions True", "require len(c.points) > 2",
        "param m = max(*Uniform([1, 2, 3], [4, 5])), n = Uniform(x, *Uniform([1], [2, 3]))",
    ]  # fmt: skip
    return "\n".join([*lines, *numbers.sample(further, numbers.randint(1, 4))]) + "\n"


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(60))
def test_the_scenes_are_those_of_the_interpreter(seed):
    scenario = scenic_ref.loads(invented(seed))

    def drawn(backend: str) -> list[str] | str:
        try:
            return [repr(scene.to_json()) for scene in scenario.sample_many(12, seed=seed, backend=backend, max_attempts=150)]  # type: ignore[arg-type]
        except AttemptsExhausted as exhausted:
            return str(exhausted)
        except Exception as problem:
            return f"{type(problem).__name__}: {problem}"

    assert drawn("batch") == drawn("interpreter"), invented(seed)


@pytest.mark.slow
def test_all_but_one_kind_have_a_graph():
    """Those that have none take the maximum of a random number of arguments."""
    for seed in range(60):
        text = invented(seed)
        assert scenic_ref.loads(text).not_lifted is None or "max(*" in text
