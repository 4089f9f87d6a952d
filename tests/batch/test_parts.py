"""The parts of the batch backend, each alone: numbers, graph, plan, tests on polygons, clipped curves."""

from __future__ import annotations

import math
import operator

import numpy as np
import pytest
import scenic_ref
import shapely
from scenic_ref.inference.batch.evaluation_plan import plan, segments
from scenic_ref.inference.batch.graph import GraphNode, Site, bounds_of, decide_comparison
from scenic_ref.inference.batch.graph_builder import Recorder
from scenic_ref.inference.batch.numpy_evaluator import ACCEPTED, LEFT, evaluate
from scenic_ref.inference.batch.primitives.drawn_points import CurveTests
from scenic_ref.inference.batch.primitives.point_in_polygon import FieldTests, PolygonTests
from scenic_ref.inference.batch.primitives.random_numbers import Numbers
from scenic_ref.inference.batch.tracing import trace_program
from scenic_ref.interpreter.runtime.answerers import PER_SCENE
from scenic_ref.interpreter.runtime.random_streams import Stream, philox_words
from scenic_ref.semantics.space.numeric_functions import arc_tangent, either, every, larger, search
from scenic_ref.semantics.space.regions import CircularRegion, PolylineRegion, SectorRegion
from scenic_ref.semantics.space.regions.approximation import box_shape
from scenic_ref.semantics.space.symbol_seam import NotLifted
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.budget import Budget

ADDRESSES = ((0,), (3, 1), (7, 2, 5))


def numbers_one_by_one(seed: int, scene: int, attempt: int, site: Site) -> float:
    stream = Stream(seed, scene, PER_SCENE if site.per_scene else attempt).at(site.address)
    return [stream() for _ in range(site.index + 1)][-1]


# Numbers


@pytest.mark.parametrize("seed", [0, 5, -3, 2**70])
@pytest.mark.parametrize("rows", ["consecutive", "with gaps", "far apart", "several attempts"])
def test_columns_of_numbers_are_those_of_the_streams(seed, rows):
    scenes = {
        "consecutive": np.arange(100, 140), "with gaps": np.arange(0, 90, 3), "far apart": np.array([0, 5000, 2**40, 2**63]),
        "several attempts": np.repeat([3, 4, 9], 4),
    }[rows].astype(np.uint64)
    attempts = np.tile(np.arange(4), 3).astype(np.uint64) if rows == "several attempts" else np.full(len(scenes), 2, dtype=np.uint64)
    numbers = Numbers(seed, scenes, attempts)
    for address in ADDRESSES:
        for index in (0, 1, 3, 4, 9):
            for per_scene in (False, True):
                site = Site(address, index, per_scene)
                expected = [numbers_one_by_one(seed, int(s), int(a), site) for s, a in zip(scenes, attempts, strict=True)]
                assert numbers.column(site).tolist() == expected
    kept = np.arange(len(scenes)) % 2 == 0
    numbers.keep(kept)
    site = Site((11,), 2, per_scene=False)
    expected = [numbers_one_by_one(seed, int(s), int(a), site) for s, a in zip(scenes[kept], attempts[kept], strict=True)]
    assert numbers.column(site).tolist() == expected

@pytest.mark.extra("fast")
@pytest.mark.parametrize("key", [(0, 0), (5, 2**64 - 1)])
@pytest.mark.parametrize("counter", [(0, 0, 0), (2**64 - 1, 3, 1), (17, PER_SCENE, 4)])
def test_compiled_numbers_are_those_of_the_streams(key, counter):
    from scenic_ref.inference.batch.primitives.numba_kernels import philox_uniforms as compiled

    words = philox_words(key, (*counter, 0))
    assert compiled(*map(np.uint64, (*key, *counter))) == tuple((word >> 11) * 2.0**-53 for word in words)



# The graph


@pytest.fixture
def symbols() -> tuple:
    made = Recorder(lambda site: 0.25 + site.index / 10, Budget())
    return made, made.site((0,), 0, False), made.site((0,), 1, False)


def test_equal_operations_are_one_node(symbols):
    made, x, y = symbols
    assert (x + y).node is (x + y).node
    assert (x + y).node is not (y + x).node
    assert (x + 1).node is (x + 1.0).node
    assert made.site((0,), 0, False).node is x.node


def test_constants_are_computed_at_once(symbols):
    made, x, _ = symbols
    count = len(made.graph.nodes)
    assert larger(2.0, 3.0) == 3.0
    assert made.apply_ufunc(np.add, (2.0, 3.0)) == 5.0
    assert (x < 2) is True
    assert (x >= 1) is False
    assert ((x < 0.5) & False) is False
    assert (True & (x < 0.5)).node is (x < 0.5).node
    assert len(made.graph.nodes) == count + 1


def test_bounds_hold(symbols):
    _, x, y = symbols
    values = np.random.default_rng(4).random((2, 500))
    for expression in (lambda x, y: x * 4 - y, lambda x, y: abs(x - 0.5) / (y + 1), lambda x, y: -(x * (y - 0.5)), lambda x, y: larger(x, y * 2)):
        low, high = expression(x, y).node.bounds
        found = expression(*values)
        assert low <= found.min() <= found.max() <= high
    assert (x / y).node.bounds is None
    assert bounds_of(np.sqrt, (-1.0,)) is None


def test_comparisons_within_bounds_are_decided():
    half = GraphNode(0, None, (), "float", 0.1, (0.0, 0.5))
    assert decide_comparison(np.less, (half, 0.6)) is True
    assert decide_comparison(np.less, (half, 0.5)) is None
    assert decide_comparison(np.less_equal, (half, 0.5)) is True
    assert decide_comparison(np.greater, (half, 0.5)) is False
    assert decide_comparison(np.equal, (half, 0.7)) is False
    assert decide_comparison(np.less, (half, math.inf)) is True
    assert decide_comparison(np.less, (GraphNode(0, None, (), "float", 0.1), math.inf)) is None


def test_a_guard_says_what_was_so_in_the_traced_run(symbols):
    made, x, y = symbols
    assert bool(x < y)
    assert not bool(y < x)
    assert [(event.kind, event.expected) for event in made.graph.events] == [("guard", True), ("guard", False)]


def test_what_needs_one_number_is_refused(symbols):
    _, x, _ = symbols
    for use in (float, int, hash, str, repr, list, lambda v: f"{v}", lambda v: [1, 2][v]):
        with pytest.raises(NotLifted):
            use(x)


def test_choices_keep_the_types_of_their_values(symbols):
    made, x, y = symbols
    chosen = made.pick(x * 3, (1, 2.5, "a"))
    assert chosen.values == (1, 2.5, "a")
    doubled = made.operate(operator.mul, (made.pick(x * 2, (1, 2.5)), 2))
    assert [(v, type(v)) for v in doubled.values] == [(2, int), (5.0, float)]
    assert made.pick(x * 2, (4, 4)) == 4
    both = made.operate(operator.add, (made.pick(x * 2, (1, 2)), made.pick(y * 2, (10, 20))))
    assert sorted(both.values) == [11, 12, 21, 22]
    point = made.pick(x * 2, (Vector(1.0, 2.0), Vector(3.0, 2.0)))
    assert point.y == 2.0
    assert point.x.node.bounds == (1.0, 3.0)


def test_functions_are_the_same_for_floats_arrays_and_symbols(symbols):
    made, x, _ = symbols
    values = np.linspace(-3, 3, 50)
    assert arc_tangent(values, 2.0).tolist() == [math.atan2(v, 2.0) for v in values]
    assert either(values > 0, lambda: values, lambda: -values).tolist() == [either(v > 0, lambda v=v: v, lambda v=v: -v) for v in values.tolist()]
    assert search([0.2, 0.5], 0.5) == 2
    assert search([0.2, 0.5], x).example == 1
    assert every([True, False, 1 / 1 > 0]) is False
    assert every([x < 0.5, True]).node is (x < 0.5).node
    assert made.apply(np.where, (x < 0.5, 1.0, 2.0), float).example == 1.0


# The plan


PROGRAM = "a = Range(0, 1)\nb = Range(0, 1)\nrequire a * a * a < b * b * b * b\nrequire b < 0.5\nego = Object with width a - 0.1\nrequire a < 0.9\n"


def graph_of(text: str):
    scenario = scenic_ref.loads(text)
    scenario.rehearse()
    return trace_program(scenario.start, scenario.fuel)


def test_cheap_requirements_come_first_but_none_passes_a_guard():
    graph, _ = graph_of(PROGRAM)
    kinds = [[graph.events[k].kind for k in segment] for segment in segments(graph.events, range(len(graph.events)))]
    assert kinds == [["require", "require"], ["guard"], ["require", "require"]]  # the last one: ego is visible from itself
    steps = plan(graph, [])
    lines = [step.event.requirement.span.line if step.event.requirement else None for step in steps if step.event]
    assert lines[:4] == [4, 3, None, 6]


def test_a_site_is_computed_when_a_requirement_needs_it():
    graph, _ = graph_of("a = Range(0, 1)\nb = Range(0, 1)\nrequire a < 0.5\nego = Object with v (a, b)\n")
    first = plan(graph, [])[0]
    assert [node.function.address for node in first.nodes if isinstance(node.function, Site)] == [(0,)]


def test_evaluation_says_which_step_rejected_a_run():
    graph, _ = graph_of(PROGRAM)
    steps = plan(graph, [])
    scenes, attempts = np.arange(2000, dtype=np.uint64), np.zeros(2000, dtype=np.uint64)
    fate = evaluate(steps, 9, scenes, attempts).fate
    for row in range(200):
        a, b = (numbers_one_by_one(9, row, 0, Site((k,), 0, False)) for k in (0, 1))
        expected = 0 if b >= 0.5 else 1 if a**3 >= b**4 else LEFT if a - 0.1 < 0 else 3 if a >= 0.9 else ACCEPTED
        assert fate[row] == expected


# Polygons


STAR = shapely.Polygon(
    [(r * math.cos(t), r * math.sin(t)) for t, r in zip(np.linspace(0, 2 * math.pi, 40, endpoint=False), [9, 4, 7, 5] * 10, strict=True)],
    [[(1, 1), (2, 1), (2, 2)], [(-2, -2), (-1, -2), (-1.5, -1)]],
)
SHAPES = {
    "a star with holes": STAR,
    "two squares": shapely.MultiPolygon([shapely.box(0, 0, 4, 4), shapely.box(6, 1, 8, 7)]),
    "a triangle": shapely.Polygon([(0, 0), (9, 1), (3, 7)]),
    "far from the origin": shapely.affinity.translate(STAR, 5e5, -3e6),
}
shapely.prepare(list(SHAPES.values()))  # as regions do: of boxes that touch an edge, shapely may say something else when it is not prepared


@pytest.mark.parametrize("name", SHAPES)
def test_points_are_where_shapely_says(name):
    shape, random = SHAPES[name], np.random.default_rng(1)
    west, south, east, north = shape.bounds
    corners = shapely.get_coordinates(shape)
    x = np.concatenate([random.uniform(west - 1, east + 1, 4000), corners[:, 0], (corners[1:, 0] + corners[:-1, 0]) / 2, [math.nan, math.inf]])
    y = np.concatenate([random.uniform(south - 1, north + 1, 4000), corners[:, 1], (corners[1:, 1] + corners[:-1, 1]) / 2, [0.0, 0.0]])
    expected = shapely.intersects_xy(shape, x, y)
    assert (PolygonTests(shape).contains_point(x, y) == expected).all()


@pytest.mark.parametrize("name", SHAPES)
def test_boxes_are_where_shapely_says(name):
    shape, random = SHAPES[name], np.random.default_rng(2)
    west, south, east, north = shape.bounds
    count = 3000
    x, y = random.uniform(west, east, count), random.uniform(south, north, count)
    heading, width, length = random.uniform(-4, 4, count), random.uniform(0, 2.5, count), random.uniform(0.01, 4, count)
    x[:200], y[:200] = np.round(x[:200] * 2) / 2, np.round(y[:200] * 2) / 2
    heading[:200], width[:200], length[:200] = np.round(heading[:200]) * math.pi / 2, 1.0, np.round(length[:200])
    width[200:210], width[210:220] = 0.0, 1e3
    rows = np.stack([x, y, heading, width, length], axis=1).tolist()
    expected = [shape.covers(box_shape(Vector(row[0], row[1]), *row[2:])) for row in rows]
    assert PolygonTests(shape).contains_box(x, y, heading, width, length).tolist() == expected


def test_the_first_cell_wins():
    cells = (shapely.box(0, 0, 3, 3), shapely.box(2, 2, 5, 5), shapely.Polygon([(0, 5), (2, 9), (4, 5), (2, 6)]))
    random = np.random.default_rng(3)
    x, y = np.round(random.uniform(-1, 6, 3000), 1), np.round(random.uniform(-1, 10, 3000), 1)
    expected = [next((i for i, cell in enumerate(cells) if shapely.intersects_xy(cell, a, b)), -1) for a, b in zip(x, y, strict=True)]
    assert FieldTests(cells).first(x, y).tolist() == expected


# Curves


@pytest.mark.parametrize("points", [[(-9, 3), (0, 9), (9, 3), (4, -9), (4, 2)], [(-9.1, 3.3), (0.7, 9.3), (9.9, 3.7), (4.1, -9.7), (4.3, 2.1)]])
@pytest.mark.parametrize("angle", [2 * math.pi, 1.0, math.pi, 0.0])
def test_points_of_clipped_curves_are_those_of_the_region(angle, points):
    curve = PolylineRegion(points, orientation=False)
    random = np.random.default_rng(5)
    count = 300
    x, y, heading, uniform = random.uniform(-12, 12, count), random.uniform(-12, 12, count), random.uniform(-4, 4, count), random.random(count)
    radius = random.uniform(0.5, 8, count)
    points = CurveTests(curve, 8.0).sample(x, y, radius, heading, angle, uniform)
    found = 0
    for k in range(count):
        center = Vector(float(x[k]), float(y[k]))
        sector = CircularRegion(center, radius[k]) if angle >= 2 * math.pi else SectorRegion(center, radius[k], heading[k], angle)
        region = curve.intersect(sector)
        try:
            expected = region.sample(lambda k=k: float(uniform[k]))
        except scenic_ref.semantics.space.regions.EmptyRegion:
            assert math.isnan(points[k, 0])
            continue
        found += 1
        assert (expected.x, expected.y) == tuple(points[k])
    assert found > 20 or angle == 0.0
