"""The batch backend gives the interpreter's scenes, number for number: columns and compiled code, gallery and random programs."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.conformance.generator import ProgramSettings, random_programs
from scenic_ref.inference.batch import Batch, NotLifted
from scenic_ref.semantics.store import budget
from scenic_ref.semantics.store.errors import ScenicError

GALLERY = sorted((Path(__file__).parent.parent.parent / "examples" / "gallery").glob("*.scenic"))
COMPILED = ("badly_parked_car", "noise", "overlapping_cars")
FEW = {"simplest": 6, "mars_bottleneck": 8, "bumper_to_bumper": 6}
ATTEMPTS = 60


def batch_of(scenario: scenic_ref.Scenario) -> Batch:
    scenario.rehearse()
    return Batch(scenario.start, fuel=scenario.fuel)


def results(scenes) -> tuple[list[str], str]:
    """The lines of the scenes up to the first error, and its kind."""
    lines: list[str] = []
    try:
        lines.extend(scene.to_line() for scene in scenes)
    except ScenicError as error:
        return lines, type(error).__name__
    return lines, ""


def one_by_one(scenario: scenic_ref.Scenario, seed: int, count: int, attempts: int) -> tuple[list[str], str]:
    return results(scenario.sample(seed, i, max_attempts=attempts) for i in range(count))


def from_batch(batch: Batch, seed: int, count: int, attempts: int) -> tuple[list[str], str]:
    return results(batch.scenes(count, seed, max_attempts=attempts))


@pytest.mark.slow
@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_gallery_programs_give_the_same_scenes(path):
    scenario = scenic_ref.load(path)
    batch = batch_of(scenario)
    count = FEW.get(path.stem, 20)
    expected = [scene.to_line() for scene in scenario.sample_many(count, seed=31, backend="interpreter")]
    assert [scene.to_line() for scene in batch.scenes(count, 31)] == expected
    assert [scene.to_line() for scene in batch.scenes(count - 3, 31, start=3)] == expected[3:]


@pytest.mark.slow
@pytest.mark.extra("fast")
@pytest.mark.parametrize("name", COMPILED)
def test_compiled_code_gives_the_same_columns(name):
    scenario = scenic_ref.load(next(path for path in GALLERY if path.stem == name))
    columns, compiled = batch_of(scenario), batch_of(scenario)
    assert compiled.compile(), compiled.not_compiled
    for start in (0, 700):
        one, other = columns.block(5, start, start + 700), compiled.block(5, start, start + 700)
        assert one.attempts.tolist() == other.attempts.tolist()
        assert one.stuck == other.stuck
        assert one.rows.tolist() == other.rows.tolist()
        for node in columns.outputs:
            assert (one.columns[node.number] == other.columns[node.number]).all(), node


@pytest.mark.slow
@pytest.mark.parametrize("settings", [ProgramSettings(), ProgramSettings().as_finite()], ids=["any", "finite"])
def test_random_programs_give_the_same_scenes(settings):
    lifted = 0
    for number, program in enumerate(random_programs(60, 808, settings)):
        scenario = scenic_ref.loads(program.text)
        try:
            batch = batch_of(scenario)
        except (NotLifted, ScenicError):
            continue
        lifted += 1
        assert from_batch(batch, number, 4, ATTEMPTS) == one_by_one(scenario, number, 4, ATTEMPTS), program.text
    assert lifted >= 48


ROAD = "road = PolygonalRegion([(-30, -4), (30, -4), (30, 4), (-30, 4)])\n"
SHORT = {
    "a choice of objects": "a = Object at (0, 5)\nb = Object at (9, 5), facing 1\n"
    "ego = Object left of Uniform(a, b) by Range(1, 2), with requireVisible False",
    "whole numbers stay whole": "ego = Object with v (Uniform(1, 2.5) * 2, min(Range(0, 3), 1), max(1, Uniform(0, 3)), abs(Uniform(-1, 2)))",
    "a soft requirement": "x = Range(0, 1)\nrequire[0.5] x < 0.3\nrequire[0.25] Range(0, 1) < 0.5\nego = Object with v x",
    "rows": "import math\nx = Range(0, 4)\nego = Object with v (math.exp(x), round(x), str(round(x)), x ** 3, [1, x][0], x // 0.3)",
    "an error of some runs": "x = Uniform(0, 1, 2, 3, 4, 5, 6, 7)\nego = Object with v 1 / x",
    "an error behind a requirement": "x = Uniform(0, 1, 2, 3)\nrequire x > 0\nego = Object with v 1 / x",
    "a size that may be negative": "ego = Object with width Range(-0.1, 9)",
    "random parameters": "m = Range(0, 3)\nego = Object with v (Normal(m, m), TruncatedNormal(0, 1, m, 5), Range(m, 4), Discrete({m: 1, 2: 2}))",
    "a random region": "ego = Object in CircularRegion((Range(0, 5), 1), Range(1, 2)), with v Range(0, 1)",
    "an intersection of random regions": "ego = Object\nObject in CircularRegion((0, 0), 9).intersect(CircularRegion((Range(3, 6), 0), 8))",
    "a field of the program": "f = VectorField('f', lambda v: v.x / 10 + v.y)\nego = Object at (Range(0, 9), 1), facing f",
    "mutation": "ego = Object at (0, 0)\nb = Object at (4, 4), with color (0.5, 0.5, 0.5)\nmutate ego by Range(0, 2)\nmutate b",
    "a table of tables": "d = Uniform((1, 'a'), (2, 'b'))\nn, s = d\nego = Object with v [n, s, d]",
    "boxes that touch a border": "workspace = Workspace(PolygonalRegion([(0, 0), (4, 0), (4, 4), (0, 4)]))\n"
    "ego = Object at (Uniform(0.5, 1, 2, 3.5, 3.75), Uniform(0.25, 0.5, 3.5))",
    "a wide sector": "ego = Object with viewAngle 300 deg, with viewDistance 5\nObject at (Range(-4, 4), Range(-4, 4))",
    "flags that are drawn": "ego = Object at (0, 0), with allowCollisions Uniform(True, False)\n"
    "Object at (0.5, 0), with requireVisible Uniform(True, False)\nObject at (99, 0), with requireVisible Uniform(True, False, False)",
    "operands behind one that decides": "x = Uniform(0, 1, 2)\nrequire x > 0 and 1 / x < 0.75 or Range(0, 1) > 0.5\n"
    "ego = Object with v (x, Range(0, 1), 0 < x < 3 / x, x and 1 / x, x or Uniform('a', 'b'))",
    "operands that get stuck": "f = PolygonalVectorField('f', [(PolygonalRegion([(-1, -1), (1, -1), (1, 1), (-1, 1)]), 1)])\n"
    "x = Range(-3, 3)\nrequire abs(x) > 2 or (f at (x, 0)) > 0\nego = Object with v x",
    "functions in operands": "def f(v):\n    w = v + 1\n    return w > 1.25\nx = Range(0, 1)\n"
    "require x > 0.5 and f(x) or f(2 * x)\nego = Object with v x",
    "points of a curve": "ego = Object facing Range(0, 6), with viewAngle 1\n"
    "Object on (visible PolylineRegion([(-9, 3), (0, 9), (9, 3), (4, -9)], orientation=False)), with requireVisible False",
    "points of a road in a view": ROAD + "ego = Object at (Range(-30, 30), Range(-4, 4)), facing Range(0, 6), with viewAngle 1\n"
    "Object on visible road, with requireVisible False, with allowCollisions True",
    "points of a road all round": ROAD + "ego = Object at (Range(-9, 9), 0), with viewDistance Uniform(8, 9)\nObject on visible road",
    "points of a view of some size": ROAD + "ego = Object at (Range(-9, 9), 0), with viewDistance Range(8, 9)\nObject on visible road",
    "points of a yard that is seen": "yard = PolygonalRegion([(0, 0), (2, 0), (1, 2)])\n"
    "ego = Object at (Range(-4, 6), Range(-4, 6)), with viewDistance 5\n"
    "Object on visible yard, with requireVisible False, with allowCollisions True",
    "a strip that is rarely hit": "strip = PolygonalRegion([(-900, 0), (900, 0), (900, 0.02), (-900, 0.02)])\n"
    "ego = Object at (Range(-9, 9), Range(-2, 2)), with viewDistance 1.5\n"
    "Object on visible strip, with requireVisible False, with allowCollisions True",
    "points of a curve off the grid": "ego = Object at (Range(-3, 9), Range(0, 8)), facing Range(0, 6), with viewDistance 7.3, with viewAngle 1.5\n"
    "Object on (visible PolylineRegion([(0.1, 0.3), (0.7, 5.3), (3.9, 7.7), (11.3, 9.1)], orientation=False)), with requireVisible False, "
    "with allowCollisions True",
    "what is not true": "x = Uniform(0, 1, 2)\ny = Uniform(1, Range(-1, 2))\nt = Range(0, 1) < 0.5\nz = Uniform(True, x == 2, t)\n"
    "require (not x) != (not Uniform(0, 1)) or not z\nrequire not (x - 1 and z)\n"
    "ego = Object at (5 + (not x), 0), with v (not x, not not y, not (x and t), (not z) + 1, not [x], not Uniform('', 'a'), not Range(-1, 1)), "
    "with allowCollisions not x",
    "operators on truth values": "t = Range(0, 1) < 0.5\nz = Uniform(True, False, t)\n"
    "ego = Object with v (~t, -t, +t, abs(t), ~z, -z, t & z, t | 2, t + 1)",
    "vectors of whole numbers": "x = Uniform(1, 2)\nv = Vector(x, 0)\nw = Vector(1, Range(0, 1))\n"
    "ego = Object at Vector(x, 3), with v (v, str(w), v.x // 2, (v * 2).x, str(v + Vector(1, 1)), Uniform(Vector(1, 2), v).x, "
    "Vector(2**53 + 1, x).x)",
    "a random workspace": "workspace = Workspace(SectorRegion((0, 0), Range(8, 10), 0, Range(3, 7)))\n"
    "ego = Object at (Range(-9, 9), Range(-9, 9)), facing Range(-4, 4)",
    "a rectangle and a sector": "ego = Object facing Range(0, 6), with viewAngle 2\n"
    "spot = Point in (visible RectangularRegion((1, 1), Range(0, 1), 9, 3))\n"
    "Object at spot, with requireVisible False, with allowCollisions True",
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", SHORT)
def test_short_programs_give_the_same_scenes(name):
    scenario = scenic_ref.loads(SHORT[name])
    assert from_batch(batch_of(scenario), 7, 40, 200) == one_by_one(scenario, 7, 40, 200)


ALSO_COMPILED = (
    "a soft requirement", "operands that get stuck", "functions in operands", "boxes that touch a border", "points of a curve", "random parameters",
    "points of a curve off the grid",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.extra("fast")
@pytest.mark.parametrize("name", ALSO_COMPILED)
def test_short_programs_give_the_same_scenes_compiled(name):
    scenario = scenic_ref.loads(SHORT[name])
    batch = batch_of(scenario)
    assert batch.compile(), batch.not_compiled
    assert from_batch(batch, 7, 40, 200) == one_by_one(scenario, 7, 40, 200)


def test_what_depends_on_more_than_the_numbers_is_not_lifted():
    reasons = {
        "ego = Uniform(Object at (0, 0), Object at (5, 5))": "ego",
        "ego = Object with v Range(0, 1)\nprint('hello')": "prints",
        "x = Range(0, 1)\nego = Object with v {x: 1}": "dictionary",
        "require False\nego = Object with v Range(0, 1)": "the requirement on line 1",
    }
    for text, reason in reasons.items():
        scenario = scenic_ref.loads(text)
        with pytest.raises(NotLifted, match=reason):
            Batch(scenario.start, fuel=scenario.fuel)


@pytest.mark.slow
@pytest.mark.extra("fast")
def test_a_graph_that_would_take_minutes_is_not_compiled():
    text = "ego = Object at (0, 0)\nfor i in range(400):\n    Object at (Range(0, 900), Range(0, 900)), with requireVisible False\n"
    batch = batch_of(scenic_ref.loads(text))
    assert not batch.compile()
    assert "take minutes to compile" in batch.not_compiled


def test_runs_that_take_another_way_are_left_to_the_interpreter():
    scenario = scenic_ref.loads("x = Range(0, 10)\nego = Object with width x - 0.001, with requireVisible False")
    batch = batch_of(scenario)
    with pytest.raises(ScenicError, match="at least 0"):
        list(batch.scenes(200_000, 3))


def test_each_row_that_is_computed_alone_has_a_budget_of_its_own(monkeypatch):
    """Else a long run on columns would use up that of the run that was traced, and be left to the interpreter."""
    monkeypatch.setattr(budget, "LARGEST_WORK", 20 * budget.STEP)
    square = "PolygonalRegion([(-99, -99), (99, -99), (99, 99), (-99, 99)])"
    scenario = scenic_ref.loads(f"f = PolygonalVectorField('f', [[{square}, lambda v: v.x / 10 + v.y]])\nego = Object at (Range(0, 9), 1), facing f")
    assert batch_of(scenario).block(1, 0, 300).left == 0


OPERAND = """
log = []

def late(x):
{body}

a = Range(0, 1)
ego = Object at (a, 0)
require a > 0.3 and late(a)
"""


@pytest.mark.parametrize("body", ["return x < 0.8", "for i in [1, 2]:\n        y = i\n        if i == 2: break\n    return x < 0.4 * y",
                                  "try:\n        return x < 0.8\n    finally:\n        y = 1"])  # fmt: skip
def test_functions_that_change_nothing_are_called_in_some_runs_only(body):
    scenario = scenic_ref.loads(OPERAND.format(body="    " + body))
    assert from_batch(batch_of(scenario), 3, 20, ATTEMPTS) == one_by_one(scenario, 3, 20, ATTEMPTS)


@pytest.mark.parametrize("body", ["log.append(1)\n    return True", "global log\n    log = [1]\n    return True", "log[0] = 1\n    return True",
                                  "try:\n        raise ValueError('no')\n    except ValueError:\n        return True",
                                  "try:\n        return [][0]\n    except IndexError:\n        return True"])  # fmt: skip
def test_functions_that_change_something_or_raise_are_not(body):
    scenario = scenic_ref.loads(OPERAND.replace("log = []", "log = [0]").format(body="    " + body))
    assert len(one_by_one(scenario, 3, 5, ATTEMPTS)[0]) == 5
    with pytest.raises(NotLifted, match="only in some runs changes something"):
        batch_of(scenario)
