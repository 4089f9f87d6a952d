"""What is said about the numbers of a graph is true of every run; angles wrap."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from hypothesis import given
from hypothesis import strategies as st
from scenic_ref.inference.batch.evaluation_plan import plan
from scenic_ref.inference.batch.graph import GraphEvent, GraphNode
from scenic_ref.inference.batch.numpy_evaluator import evaluate
from scenic_ref.inference.pruning.accepted_facts import field_lookup_points, limits, min_radius, truths
from scenic_ref.inference.pruning.node_bounds import ALL, TAU, Interval, Operand, Point, angles_meet, bounds, field_alignment, offset
from scenic_ref.inference.pruning.traced_points import Recorded, record_points

from .programs import EGO, MAP

EXAMPLES = Path(__file__).parent.parent.parent / "examples" / "gallery"
ABREAST = MAP + EGO.strip() + ", facing direction\nother = Object at ego offset by (7, Range(-2, 2)), facing Range(0, 0.2) relative to direction\n"
NAMES = ["single_car", "overlapping_cars", "bumper_to_bumper", "platoon", "oncoming_car"]
PROGRAMS = [scenic_ref.load(EXAMPLES / f"{name}.scenic") for name in NAMES] + [scenic_ref.loads(ABREAST)]


@pytest.fixture(scope="module", params=PROGRAMS, ids=[*NAMES, "abreast"])
def runs(request: pytest.FixtureRequest) -> tuple[Recorded, dict[int, np.ndarray]]:
    """A program, and the columns of its numbers in accepted runs."""
    recorded = record_points(request.param.start, 1_000_000)
    numbers = [n for n in recorded.graph.nodes if n.kind in ("float", "bool")]
    scenes = np.arange(4000, dtype=np.uint64)
    return recorded, dict(evaluate(plan(recorded.graph, numbers), 0, scenes, np.zeros_like(scenes)).columns)


def value(operand: Operand, columns: dict[int, np.ndarray]) -> np.ndarray:
    return columns[operand.number] if isinstance(operand, GraphNode) else np.array(operand)


def coordinates(point: Point, columns: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    x, y = point
    return value(x, columns), value(y, columns)


@pytest.mark.slow
def test_every_number_is_within_its_bounds(runs):
    recorded, columns = runs
    known = [n for n in recorded.graph.nodes if n.kind == "float" and bounds(n) != ALL]
    assert len(known) > 10
    for node in known:
        low, high = bounds(node)
        assert (columns[node.number] >= low - 1e-9).all()
        assert (columns[node.number] <= high + 1e-9).all()


def test_aligned_headings_are_those_of_the_field_up_to_the_deviation(runs):
    recorded, columns = runs
    found = [(n, a) for n in recorded.graph.nodes if n.kind == "float" and (a := field_alignment(n)) is not None]
    for node, (field, point, deviation) in found:
        xs, ys = coordinates(point, columns)
        for heading, x, y in list(zip(columns[node.number], np.broadcast_to(xs, len(columns[node.number])), ys * np.ones(1), strict=False))[:20]:
            rest = heading - field.at(scenic_ref.semantics.space.vectors.Vector(float(x), float(y)))
            assert deviation.low - 1e-9 <= rest <= deviation.high + 1e-9


@pytest.mark.slow
def test_offsets_are_where_they_are_said_to_be(runs):
    recorded, columns = runs
    points = [drawn.point for drawn in recorded.points.values()] + [there.point for there in field_lookup_points(recorded.graph)]
    angles = {n.arguments[0] for n in recorded.graph.nodes if n.function is np.cos}
    seen = 0
    for origin in points[:3]:
        for angle in angles:
            for point in points:
                found = offset(origin, angle, point)  # type: ignore[arg-type]
                if found is None:
                    continue
                (x0, y0), (x1, y1), heading = coordinates(origin, columns), coordinates(point, columns), value(angle, columns)  # type: ignore[arg-type]
                dx, dy = x1 - x0, y1 - y0
                across, along = dx * np.cos(heading) + dy * np.sin(heading), dy * np.cos(heading) - dx * np.sin(heading)
                away = np.hypot(
                    np.maximum(0, np.maximum(found.across.low - across, across - found.across.high)),
                    np.maximum(0, np.maximum(found.along.low - along, along - found.along.high)),
                )
                assert (away <= found.slack + 1e-6).all()
                assert (np.hypot(dx, dy) <= found.distance + 1e-6).all()
                seen += len(away)
    assert seen


def test_facts_and_limits_hold_in_accepted_runs(runs):
    recorded, columns = runs
    facts = list(truths(recorded.graph))
    for node, holds in facts:
        assert (columns[node.number] == holds).all()
    for node, intervals in limits(facts).items():
        if node.kind == "float":
            values = columns[node.number]
            assert np.any([(values >= i.low - 1e-9) & (values <= i.high + 1e-9) for i in intervals], axis=0).all()


def test_conjunctions_are_taken_apart_and_soft_requirements_are_left_out():
    program = "x = Range(0, 9)\ny = Range(0, 9)\nego = Object at (x, y)\nrequire x < 5 and not (y <= 2 or x > 4)\nrequire[0.5] y > 8\n"
    recorded = record_points(scenic_ref.loads(program).start, 1_000_000)
    x, y = (c for c in recorded.state.objects[recorded.state.scene[0].number]["position"].value)
    found = limits(list(truths(recorded.graph)))
    assert found[x.node] == [Interval(-math.inf, 4.0)] or found[x.node] == [Interval(-math.inf, 4)]
    assert found[y.node] == [Interval(2.0, math.inf)]
    assert limits(list(truths(recorded.graph, soft=True)))[y.node] == [Interval(8.0, math.inf)]
    assert all(isinstance(e, GraphEvent) for e in recorded.graph.events)


def test_the_radius_of_a_box_is_half_its_smaller_side():
    assert min_radius(2, 4.0) == 1
    assert min_radius(4, 2) == 1
    assert min_radius("?", 2) == 0


NUMBER = st.floats(-10, 10)


@given(NUMBER, st.floats(0, 2), NUMBER, st.floats(0, 7), st.floats(-1, 1), st.floats(0, 1), st.integers(-3, 3))
def test_angles_that_share_a_value_modulo_a_turn_meet(angle, spread, low, size, share, along, turns):
    """`low + along * size` is allowed; an angle that is off by at most the spread, and any number of turns, meets it."""
    assert angles_meet(low + along * size - share * spread + turns * TAU, spread, Interval(low, low + size))
    del angle


@given(NUMBER, st.floats(0, 1), NUMBER, st.floats(0, 1))
def test_angles_meet_only_if_they_share_a_value_modulo_a_turn(angle, spread, low, size):
    shared = any(Interval(angle - spread + k * TAU, angle + spread + k * TAU).meets(Interval(low - 1e-6, low + size + 1e-6)) for k in range(-8, 9))
    assert angles_meet(angle, spread, Interval(low, low + size)) <= shared
    assert angles_meet(angle, spread, Interval(low, low + size), math.inf) <= shared


@given(NUMBER, NUMBER, NUMBER, NUMBER, st.floats(0, 1), st.floats(0, 1))
def test_intervals_hold_sums_products_and_opposites(a, b, c, d, s, t):
    one, two = Interval(min(a, b), max(a, b)), Interval(min(c, d), max(c, d))
    x, y = one.low + s * (one.high - one.low), two.low + t * (two.high - two.low)
    slack = 1e-9

    def holds(interval: Interval, number: float) -> bool:
        return interval.low - slack <= number <= interval.high + slack

    assert holds(one + two, x + y)
    assert holds(one.times(two), x * y)
    assert holds(-one, -x)
    assert one.smallest - slack <= abs(x) <= one.largest + slack
    assert one.meets(two) == (one.common(two).low <= one.common(two).high)
