"""Torch gives the columns' scenes: the same runs are accepted, and numbers differ by no more than they are said to."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
import shapely
from scenic_ref.api import Scenario
from scenic_ref.conformance.generator import ProgramSettings, random_programs
from scenic_ref.inference.batch import Batch, Block
from scenic_ref.inference.batch.graph import Site
from scenic_ref.inference.batch.primitives.point_in_polygon import FieldTests, PolygonTests
from scenic_ref.inference.batch.primitives.random_numbers import Numbers
from scenic_ref.semantics.space.numeric_functions import (
    arc_tangent,
    exponential,
    exponential_less_one,
    logarithm,
    logarithm_of_one_more,
)
from scenic_ref.semantics.store.errors import ScenicError, UsageError
from scipy import special

pytestmark = pytest.mark.extra("torch")
GALLERY = sorted((Path(__file__).parent.parent.parent / "examples" / "gallery").glob("*.scenic"))
QUICK = ("noise", "single_car", "two_cars")
FEW = {"bumper_to_bumper": 60, "mars_bottleneck": 100, "simplest": 200}
PLACES = "ego = Object at Range(1, 2) @ Range(1, 2)\nparam d = distance from ego to 0 @ 0\n"
HOST = """
import math
x = Range(0, 10)
ego = Object at round(x) @ 0, facing math.floor(x) deg
Object at (x + 20) @ Range(0, 3), facing toward ego
require x > 1
"""
CURVE = """
road = PolylineRegion([0@0, 10@5, 20@0], orientation=None)
ego = Object at Range(0, 10) @ 0, with viewDistance 12
p = Point on visible road
Object at p.position, with requireVisible False
require (distance from ego to p) < Normal(6, 1)
"""
NORMAL = "ego = Object at Normal(0, 2) @ TruncatedNormal(0, 1, -1, 3), facing Discrete({1: 2, 2: 1}) deg\nrequire abs(ego.position.x) > 1\n"
SOFT = "x = Range(0, 1)\nego = Object at x @ 0\nrequire[0.7] x < 0.2\nrequire x < 0.9 or x > 0.95\n"
PROGRAMS = [HOST, CURVE, NORMAL, SOFT]


def by_torch(scenario: Scenario) -> Batch:
    found = scenario.on_device("cpu").batch
    assert found is not None and found.tensors is not None
    return found


def by_numpy(scenario: Scenario) -> Batch:
    assert scenario.batch is not None
    scenario.batch.may_compile = False
    return scenario.batch


def agree(scenario: Scenario, count: int, *, draws_there: bool = False, attempts: int = 10_000) -> Block:
    """The block of torch, which is that of NumPy but for the rounding of numbers."""
    from scenic_ref.inference.batch.torch_lowering import ROUNDING

    one, other = by_numpy(scenario), by_torch(scenario)
    assert other.tensors is not None
    other.tensors.draws_there = draws_there
    expected, found = (batch.block(5, 3, 3 + count, max_attempts=attempts) for batch in (one, other))
    assert found.attempts.tolist() == expected.attempts.tolist()
    assert found.rows.tolist() == expected.rows.tolist()
    assert (found.stuck, found.runs, found.left, str(found.error)) == (expected.stuck, expected.runs, expected.left, str(expected.error))
    for node in one.outputs:
        left, right = expected.columns[node.number], found.columns[node.number]
        assert left.dtype == right.dtype
        if left.dtype == float:
            near = np.abs(left - right) <= ROUNDING * np.maximum(np.abs(left), 1.0)
            assert (near | (np.isnan(left) & np.isnan(right))).all()
        else:
            assert list(map(repr, left.tolist())) == list(map(repr, right.tolist()))
    return found


@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem, marks=() if p.stem in QUICK else pytest.mark.slow) for p in GALLERY])
def test_the_gallerys_scenes_are_those_of_the_columns(path: Path) -> None:
    found = agree(scenic_ref.load(path), FEW.get(path.stem, 1_000))
    assert found.doubtful <= 0.01 * found.runs


@pytest.mark.parametrize("text", PROGRAMS)
@pytest.mark.parametrize("draws_there", [False, True], ids=["moved", "drawn there"])
def test_scenes_are_those_of_the_columns(text: str, draws_there: bool) -> None:
    found = agree(scenic_ref.loads(text), 700, draws_there=draws_there)
    assert found.doubtful <= 0.01 * found.runs


@pytest.mark.parametrize("settings", [ProgramSettings(), ProgramSettings().as_finite()], ids=["any", "finite"])
@pytest.mark.parametrize("count", [12, pytest.param(60, marks=pytest.mark.slow)])
def test_random_programs_give_the_scenes_of_the_columns(settings: ProgramSettings, count: int) -> None:
    looked = 0
    for program in random_programs(count, 4711, settings):
        scenario = scenic_ref.loads(program.text)
        try:
            batch = scenario.batch
        except ScenicError:
            continue
        if batch is not None:
            agree(scenario, 60, attempts=40)
            looked += 1
    assert looked >= count / 3


def test_programs_with_operations_that_torch_does_not_have_say_which() -> None:
    assert by_torch(scenic_ref.loads(HOST)).tensors.kit.reasons == ("round", "floor")  # type: ignore[union-attr]
    reasons = by_torch(scenic_ref.loads(CURVE)).tensors.kit.reasons  # type: ignore[union-attr]
    assert reasons == ("a point that is drawn in a region which differs from run to run",)
    assert not by_torch(scenic_ref.loads(NORMAL)).tensors.kit.reasons  # type: ignore[union-attr]


APART = """
ego = Object at Range(0, 9) @ 0, with requireVisible False
other = Object at Range(30, 39) @ 0, with requireVisible False
require ego.position.x > 8.9
require other.position.x > 38.9
"""


def test_what_is_drawn_in_parts_is_left_to_the_columns() -> None:
    scenario = scenic_ref.loads(APART).pruned()
    assert scenario.in_parts
    batch = scenario.on_device("cpu").batch
    assert batch is not None and batch.tensors is None
    ours, theirs = (b.block(5, 0, 50) for b in (by_numpy(scenario), batch))
    assert all((ours.columns[node.number] == theirs.columns[node.number]).all() for node in batch.outputs)


# What rounding might decide


def places(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Distances of the first attempts at scenes, by NumPy and by torch."""
    scenario = scenic_ref.loads(PLACES)
    found = []
    for batch in (by_numpy(scenario), by_torch(scenario)):
        distance = batch.template.params["d"].node.number  # type: ignore[attr-defined]
        found.append(batch.block(5, 0, count).columns[distance])
    return found[0], found[1]


def at_the_edge() -> Scenario:
    """A program whose scene is accepted by NumPy at the first attempt, with the very number that is required at most, and by torch alone not."""
    ours, theirs = places(4_000)
    larger = np.flatnonzero(theirs > ours)
    assert len(larger), "torch and NumPy agree to the last bit"
    return scenic_ref.loads(f"{PLACES}require (distance from ego to 0 @ 0) <= {float(ours[larger[0]])!r}\n")


def test_what_rounding_might_decide_is_decided_by_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    from scenic_ref.inference.batch import torch_lowering

    scenario = at_the_edge()
    one, other = by_numpy(scenario), by_torch(scenario)
    expected, found = one.block(5, 0, 4_000), other.block(5, 0, 4_000)
    assert found.attempts.tolist() == expected.attempts.tolist()
    assert found.doubtful >= 1
    monkeypatch.setattr(torch_lowering, "LIBRARY", 0.0)  # the rival: libraries are taken to agree
    assert other.block(5, 0, 4_000).attempts.tolist() != expected.attempts.tolist()


def test_a_requirement_that_is_always_at_its_edge_is_numpys_alone() -> None:
    found = agree(scenic_ref.loads("x = Range(1, 2)\nego = Object at x @ 0\nrequire (distance from ego to 0 @ 0) <= x\n"), 300)
    assert found.doubtful == found.runs == 300


Drawn = Callable[[np.random.Generator, int], np.ndarray]


def between(low: float, high: float, *special_values: float) -> Drawn:
    """Numbers of an interval, among them some that are special."""

    def draw(random: np.random.Generator, count: int) -> np.ndarray:
        found = random.uniform(low, high, count)
        found[: 10 * len(special_values)] = np.repeat(special_values, 10)
        return found

    return draw


def tiny(random: np.random.Generator, count: int) -> np.ndarray:
    """Numbers of very different size, of both signs."""
    return random.choice([-1.0, 1.0], count) * 10.0 ** random.uniform(-15, 3, count)


WIDE, UNIT = between(-20, 20, 0.0), between(1e-12, 1 - 1e-12, 0.5)
OPERANDS: dict[object, Sequence[Drawn]] = {
    np.add: (WIDE, tiny), np.subtract: (WIDE, tiny), np.multiply: (WIDE, tiny), np.true_divide: (WIDE, tiny), np.mod: (WIDE, between(0.5, 7)),
    np.fmod: (WIDE, between(0.5, 7)), np.negative: (WIDE,), np.positive: (WIDE,), np.absolute: (tiny,), np.minimum: (WIDE, WIDE),
    np.maximum: (WIDE, WIDE), np.sqrt: (between(-0.01, 20, 0.0),), np.sin: (WIDE,), np.cos: (WIDE,), np.hypot: (tiny, tiny),
    arc_tangent: (tiny, tiny), exponential: (WIDE,), exponential_less_one: (tiny,), logarithm: (between(-0.01, 20, 0.0, 1.0),),
    logarithm_of_one_more: (between(-1.01, 20, -1.0, 0.0),), special.ndtri: (UNIT,), special.log_ndtr: (WIDE,),
    special.ndtri_exp: (between(-600, 0, -1e-9),),
}  # fmt: skip


@pytest.mark.parametrize("error", [0.0, 1e-14, 1e-10])
@pytest.mark.parametrize("function", OPERANDS, ids=lambda f: f.__name__)
def test_a_result_is_as_near_to_numpys_as_it_says(function: Callable[..., np.ndarray], error: float) -> None:
    import torch
    from scenic_ref.inference.batch.torch_lowering import RULES, Doubts, Rounded

    random = np.random.default_rng(7)
    exact = [draw(random, 20_000) for draw in OPERANDS[function]]
    moved = [a + random.uniform(-error, error, len(a)) for a in exact]
    slack = error * (1 + 1e-6) + (np.spacing(1000.0) if error else 0.0)
    doubts = Doubts(len(exact[0]), torch.device("cpu"))
    found = RULES[function](doubts, *(Rounded(torch.from_numpy(a), slack, float(np.abs(a).max())) for a in moved))
    with np.errstate(all="ignore"):
        expected = function(*exact)
    sure = ~doubts.rows.numpy()
    values = found.values.numpy()[sure]
    assert (np.isnan(values) == np.isnan(expected[sure])).all()
    finite = np.isfinite(values) & np.isfinite(expected[sure])
    assert (values[~finite & ~np.isnan(values)] == expected[sure][~finite & ~np.isnan(values)]).all()
    assert (np.abs(values - expected[sure])[finite] <= found.error).all()
    assert (np.abs(values)[finite] <= found.largest * (1 + 1e-12)).all()
    assert error > 1e-12 or sure.mean() > 0.3


def test_every_operation_on_numbers_is_looked_at() -> None:
    from scenic_ref.inference.batch.torch_lowering import NUMERIC

    assert set(NUMERIC) == set(OPERANDS)


@pytest.mark.parametrize("function", [np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal], ids=lambda f: f.__name__)
def test_a_comparison_is_doubtful_where_rounding_might_decide(function: np.ufunc) -> None:
    import torch
    from scenic_ref.inference.batch.torch_lowering import RULES, Doubts, Rounded

    random, error = np.random.default_rng(3), 1e-9
    a = np.append(random.uniform(-1, 1, 5_000), [np.nan, np.inf])
    b = np.append(a[:-2] + random.uniform(-5e-9, 5e-9, 5_000), [0.0, 0.0])
    moved = a + random.uniform(-error, error, len(a))
    doubts = Doubts(len(a), torch.device("cpu"))
    found = RULES[function](doubts, Rounded(torch.from_numpy(moved), error, 1.0), Rounded(torch.from_numpy(b), 0.0, 1.0))
    sure = ~doubts.rows.numpy()
    assert (found.values.numpy() == function(a, b))[sure].all()
    assert 0.7 < sure.mean() < 0.9
    assert sure[-2:].all()


@pytest.mark.parametrize("function", [f for f, operands in OPERANDS.items() if f not in (np.add, np.subtract, np.multiply, np.negative, np.positive)])
def test_libraries_differ_by_less_than_a_quarter_of_what_is_allowed(function: Callable[..., np.ndarray]) -> None:
    import torch
    from scenic_ref.inference.batch.torch_lowering import LIBRARY, RULES, Doubts, Rounded

    exact = [draw(np.random.default_rng(9), 50_000) for draw in OPERANDS[function]]
    doubts = Doubts(len(exact[0]), torch.device("cpu"))
    values = RULES[function](doubts, *(Rounded(torch.from_numpy(a), 0.0, math.inf) for a in exact)).values.numpy()
    with np.errstate(all="ignore"):
        expected = function(*exact)
        gap = np.abs(values - expected)
    finite = np.isfinite(expected) & ~doubts.rows.numpy()
    assert gap[finite].max() <= LIBRARY / 4 * max(1.0, np.abs(expected[finite]).max())


# Polygons

RING = shapely.Polygon([(0, 0), (60, 0), (60, 40), (0, 40)], [[(20, 10), (20, 30), (25, 30), (25, 10)]])
TWO = shapely.MultiPolygon([RING, shapely.Polygon([(70, 0), (90, 0), (80, 30)])])


@pytest.mark.parametrize("shape", [RING, TWO], ids=["ring", "two"])
def test_points_and_boxes_in_polygons_are_those_of_the_columns_where_that_is_sure(shape: shapely.Polygon) -> None:
    import torch
    from scenic_ref.inference.batch.primitives.torch_polygons import TensorPolygon

    random, count = np.random.default_rng(2), 6_000
    tests = PolygonTests(shape)
    polygon = TensorPolygon(tests, torch.device("cpu"))
    x, y = random.uniform(-10, 100, count), random.uniform(-10, 50, count)
    x[:50], y[:50], x[50:60] = 60.0, random.uniform(0, 40, 50), np.nan
    heading, width, length = random.uniform(-4, 4, count), random.uniform(0.5, 6, count), random.uniform(0.5, 12, count)
    width[100:120], length[120:140] = 0.0, 150.0
    for numbers, slack in itertools.product(((x, y), (x, y, heading, width, length)), (0.0, 1e-8)):
        box = len(numbers) > 2
        moved = [torch.from_numpy(n + random.uniform(-slack, slack, count) / 20) for n in numbers]
        inside, doubtful = polygon.contains_box(*moved, slack) if box else polygon.contains_point(*moved, slack)
        expected = tests.contains_box(*numbers) if box else tests.contains_point(*numbers)
        sure = ~doubtful.numpy()
        assert (inside.numpy() == expected)[sure].all()
        assert not sure[:50].any() or box
        assert sure[140:].mean() > 0.99 and 0.1 < expected.mean() < 0.9


@pytest.mark.parametrize("slack", [0.0, 1e-9])
def test_the_cells_of_fields_are_those_of_the_columns_where_that_is_sure(slack: float) -> None:
    import torch
    from scenic_ref.inference.batch.primitives.torch_polygons import TensorField

    random = np.random.default_rng(4)
    corners = random.uniform(0, 80, (60, 2))
    cells = tuple(shapely.Point(x, y).buffer(random.uniform(2, 12), quad_segs=2) for x, y in corners)
    tests = FieldTests(cells)
    x, y = random.uniform(-10, 90, 8_000), random.uniform(-10, 90, 8_000)
    x[:40], y[:40] = shapely.get_coordinates(cells[0].boundary.interpolate(np.linspace(0, 9, 40))).T
    moved = (torch.from_numpy(v + random.uniform(-slack, slack, len(v)) / 4) for v in (x, y))
    found, doubtful = TensorField(tests, torch.device("cpu")).first(*moved, slack)
    sure = ~doubtful.numpy()
    assert (found.numpy() == tests.first(x, y))[sure].all()
    assert sure.mean() > 0.99


# Random numbers and devices


@pytest.mark.parametrize("seed", [0, 5, 2**63 + 11, 2**64 - 1])
@pytest.mark.parametrize("per_scene", [False, True])
def test_random_numbers_on_the_device_are_the_same_bits(seed: int, per_scene: bool) -> None:
    import torch
    from scenic_ref.inference.batch.torch_evaluator import DeviceNumbers

    random = np.random.default_rng(1)
    scenes, attempts = (random.integers(0, 2**64, 500, dtype=np.uint64) for _ in range(2))
    ours, theirs = Numbers(seed, scenes, attempts), DeviceNumbers(seed, scenes, attempts, torch.device("cpu"))
    kept = random.random(500) < 0.5
    for step in range(2):
        for index in (0, 3, 4, 9):
            site = Site((1, 2, step), index, per_scene)
            assert (ours.column(site) == theirs.column(site).numpy()).all()
        if step == 0:
            ours.keep(kept)
            theirs.keep(torch.from_numpy(np.flatnonzero(kept)))


@pytest.mark.parametrize(
    ("build", "available", "said"),
    [(None, False, "is a build without CUDA"), ("13.0", False, "finds no GPU, or no driver for it"), ("13.0", True, "no kernel image")],
)
def test_a_gpu_that_cannot_be_used_is_told(build: str | None, available: bool, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    import torch

    def fail(*arguments: object, **keywords: object) -> None:
        raise RuntimeError("no kernel image")

    monkeypatch.setattr(torch.version, "cuda", build)
    monkeypatch.setattr(torch.version, "hip", None)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: available)
    monkeypatch.setattr(torch, "zeros", fail)
    with pytest.raises(UsageError, match=f"the device cuda cannot be used: .*{said}") as caught:
        scenic_ref.loads(SOFT).on_device("cuda")
    assert caught.value.hint == "the device cpu needs no GPU"


def test_other_devices_are_refused() -> None:
    with pytest.raises(UsageError, match="there is no device tpu"):
        scenic_ref.loads(SOFT).on_device("tpu")
