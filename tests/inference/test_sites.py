"""States and the machine say the same of a run; moves leave the law of accepted states as it is, and wrong ones do not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scenic_ref
from scenic_ref.api import Scenario, loads
from scenic_ref.conformance.generator import ProgramSettings
from scenic_ref.conformance.generator.programs import random_program
from scenic_ref.data.scene import scene_of
from scenic_ref.inference.batch.violations import points_away, polygon_margin
from scenic_ref.inference.comparison.exact_laws import DEFAULT_ALPHA, Categorical, Continuous, contradicts
from scenic_ref.inference.enumeration import content_of_scene
from scenic_ref.inference.moves.proposals import EXCHANGE, REDRAW, STEP, Moves, MovesMade
from scenic_ref.inference.moves.states import States
from scenic_ref.inference.moves.target import Target
from scenic_ref.inference.smc import moves_of
from scenic_ref.semantics.space.regions import PolygonalRegion
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import ScenicError, UsageError

FINITE = ProgramSettings().as_finite()
CARS = """
workspace = Workspace(PolygonalRegion([0@0, 14@0, 14@6, 6@6, 6@10, 0@10]))
def car():
    return Object in workspace, with width 2, with length 4.5, facing Range(-10, 10) deg
ego = car()
car()
car()
"""
ORDER = "x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)\nego = Object at x @ y\nrequire x < y and (y < z or z < 0.1)\nparam z = z\n"
CURVE = """
road = PolylineRegion([0@0, 10@5, 20@0], orientation=None)
ego = Object at Range(0, 10) @ 0, with viewDistance 12
p = Point on visible road
Object at p.position, with requireVisible False
require (distance from ego to 5 @ 2) < 6
"""
SOFT = "x = Range(0, 1)\nego = Object at x @ 0\nrequire[0.7] x < 0.2\nrequire x < 0.9 or x > 0.95\n"
NORMAL = "ego = Object at Normal(0, 2) @ TruncatedNormal(0, 1, -1, 3), facing Discrete({1: 2, 2: 1}) deg\nrequire abs(ego.position.x) > 1\n"
BRANCH = "def f(v):\n    return abs(v) + 1\nxs = sorted([Range(-1, 1), Range(-2, 2)], key=f)\nego = Object at xs[0] @ 0\nrequire xs[1] > 0\n"
PROGRAMS = [CARS, ORDER, CURVE, SOFT, NORMAL]


def random(seed: int = 1) -> np.random.Generator:
    return np.random.Generator(np.random.Philox(seed))


def target_of(scenario: Scenario) -> Target:
    assert scenario.batch is not None, scenario.not_lifted
    return Target(scenario.batch, 7)


def agree(target: Target, count: int) -> int:
    """How many of some states are accepted, by the graph and by the machine alike; their scenes are the same."""
    states = target.simulate(count, random())
    found = target.assess(states, np.inf)
    ended = [target.interpreted(states, row) for row in range(count)]
    assert [v == 0 for v in found.violation] == [e is not None for e in ended]
    assert (target.assess(states).violation == 0).tolist() == [e is not None for e in ended]
    accepted = np.flatnonzero(found.violation == 0)
    made = [content_of_scene(scene) for scene in target.scenes(states.at(accepted), 0)]
    assert made == [content_of_scene(scene_of(ended[row].state, 0, 0, 1)) for row in accepted]  # type: ignore[union-attr]
    return len(accepted)


@pytest.mark.parametrize("text", PROGRAMS)
def test_the_violation_is_0_exactly_where_the_machine_accepts(text: str) -> None:
    assert agree(target_of(scenic_ref.loads(text)), 150) > 0


@pytest.mark.parametrize("index", range(12))
def test_the_same_of_random_programs(index: int) -> None:
    scenario = loads(random_program(11, index, FINITE).text)
    if scenario.batch is not None and not any(site.per_scene for site in target_of(scenario).space.sites):
        agree(target_of(scenario), 40)


@pytest.mark.extra("fast")
@pytest.mark.slow
@pytest.mark.parametrize("text", PROGRAMS)
def test_compiled_violations_are_those_of_the_columns(text: str) -> None:
    target = target_of(scenic_ref.loads(text))
    target.measure(random())
    states = target.simulate(4_000, random())
    for level in (0.0, 0.5, 3.0, np.inf):
        levels = np.full(len(states), level)
        target.compiled = None
        plain = target.violations(states, levels)
        reason = target.compile()
        assert not reason, reason
        compiled = target.violations(states, levels)
        assert ((plain == 0) == (compiled == 0)).all()
        both = np.isfinite(plain) & np.isfinite(compiled)
        assert np.allclose(plain[both], compiled[both], rtol=1e-9, atol=1e-12)
        assert (np.isfinite(plain) != np.isfinite(compiled)).sum() <= 1  # rounding at the level


def test_violations_grow_with_the_distance_from_what_is_required() -> None:
    target = target_of(scenic_ref.loads("x = Range(0, 10)\nego = Object at x @ 0\nrequire x < 2 or x > 9\n"))
    states = States(np.array([[0.1, 0.3, 0.45, 0.55, 0.8, 0.95]]), np.zeros((1, 6), dtype=np.uint64))
    assert target.assess(states, np.inf).violation.tolist() == pytest.approx([0, 1, 2.5, 3.5, 1, 0])


def test_a_point_is_as_far_outside_of_a_polygon_as_it_is() -> None:
    hole = PolygonalRegion([Vector(0, 0), Vector(10, 0), Vector(10, 10), Vector(0, 10)]).polygon.difference(
        PolygonalRegion([Vector(4, 4), Vector(6, 4), Vector(6, 6), Vector(4, 6)]).polygon
    )
    region = PolygonalRegion(polygon=hole)
    x, y = np.array([-3.0, 5.0, 1.0, 13.0, 4.5]), np.array([5.0, 5.0, 1.0, 14.0, 5.0])
    inside = np.array([region.contains_point(Vector(a, b)) for a, b in zip(x, y, strict=True)])
    margins = polygon_margin(region, inside, [x, y])
    assert (-margins[~inside]).tolist() == pytest.approx([3, 1, 5, 0.5])
    assert (margins[inside] > 0).all()
    assert points_away(np.array([[0.0, 0.0, 0.0, 0.0]]), np.array([3.0]), np.array([4.0])).tolist() == [5.0]


def test_coins_that_are_thrown_for_a_scene_are_refused() -> None:
    with pytest.raises(UsageError, match="soft=scene"):
        target_of(scenic_ref.loads(SOFT, readings={"soft": "scene"}))


# Moves

Change = Callable[[Moves, States, np.random.Generator, Target], States]


def moved(target: Target, states: States, generator: np.random.Generator, propose: Change | None, steps: int) -> States:
    moves = moves_of(target)
    zeros = np.zeros(len(states))
    for _ in range(steps):
        proposed = moves.propose(states, generator)[0] if propose is None else propose(moves, states, generator, target)
        states = target.update(states, zeros, proposed, zeros)[0]
    return states


def accepted(target: Target, count: int) -> States:
    """Independent states of accepted runs: by rejection."""
    states = target.simulate(count, random(3))
    return states.at(target.assess(states).violation == 0)


LAW = Continuous("x", lambda x: x * x if x < 1 else 1.0, 0.0, 1.0)
LARGER = "x, y = Range(0, 1), Range(0, 1)\nego = Object at x @ y\nrequire x > y\n"
"""Given that it is the larger of two, x has the distribution function x²."""


def larger(target: Target, states: States) -> list[float]:
    return [scene.objects[0].position.x for scene in target.scenes(states, 0)]


def test_moves_leave_the_law_as_it_is() -> None:
    target = target_of(scenic_ref.loads(LARGER))
    states = accepted(target, 6_000)
    assert not contradicts(larger(target, moved(target, states, random(4), None, 12)), LAW)


ROADS = """model scenic.domains.driving.model
r = Uniform(*filter(lambda r: len(r.lanes) == 2, network.roads))
ego = Car on r
spot = OrientedPoint on visible ego.laneGroup.curb
Car left of spot by 0.25
Pedestrian on visible r.sidewalkRegion
require ego.road is r
require (distance from ego to intersection) < 60
"""


@pytest.mark.parametrize("text", [CURVE, pytest.param(ROADS, marks=pytest.mark.slow)], ids=["a curve that is seen", "roads"])
@pytest.mark.parametrize("level", [1.0, np.inf])
def test_what_a_move_leaves_as_it_is_is_not_computed_again(text: str, level: float) -> None:
    target = target_of(scenic_ref.loads(text))
    target.may_compile = False
    moves, known, generator = moves_of(target), target.remember(), random(6)
    assert known is not None
    states = target.simulate(150, random(3))
    violations = target.assess(states, np.inf).violation
    levels = np.maximum(violations, level)
    asked, same = 0, 0
    for _ in range(12):
        proposed = moves.propose(states, generator)[0]
        expected = target.update(states, violations, proposed, levels)
        found = target.update(states, violations, proposed, levels, known)
        for one, other in zip(expected[1:], found[1:], strict=True):
            assert np.array_equal(one, other)
        states, violations = expected[:2]
        rows = np.arange(len(states))
        asked += len(known.below) * len(rows)
        same += sum(int(known.unchanged(number, rows).sum()) for number in known.below)
    assert asked / 10 < same < asked


def clipped(moves: Moves, states: States, generator: np.random.Generator, target: Target) -> States:
    """Steps that stop at the ends of the interval."""
    return replace(states, uniforms=np.clip(states.uniforms + generator.normal(0, 0.3, states.uniforms.shape), 0.0, 1.0 - 2**-53))


def upwards(moves: Moves, states: States, generator: np.random.Generator, target: Target) -> States:
    """Steps whose size depends on where they begin."""
    return replace(states, uniforms=(states.uniforms * np.exp(generator.normal(0, 0.5, states.uniforms.shape))) % 1.0)


def repaired(moves: Moves, states: States, generator: np.random.Generator, target: Target) -> States:
    """Redraw all, then only x, until the requirement holds."""
    found = target.simulate(len(states), generator)
    for _ in range(60):
        wrong = target.assess(found).violation > 0
        found.uniforms[0, wrong] = generator.random(int(wrong.sum()))
    return found


def copied(moves: Moves, states: States, generator: np.random.Generator, target: Target) -> States:
    """An exchange that forgets one side, after which y is drawn again below x."""
    x = states.uniforms[0]
    return replace(states, uniforms=np.stack([np.maximum(x, generator.random(len(x))), x]))


@pytest.mark.parametrize("wrong", [clipped, upwards, repaired, copied])
def test_wrong_moves_are_found_out(wrong: Change) -> None:
    target = target_of(scenic_ref.loads(LARGER))
    states = accepted(target, 6_000)
    assert contradicts(larger(target, moved(target, states, random(4), wrong, 12)), LAW)


@pytest.mark.parametrize("index", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 60))])
def test_moves_leave_the_laws_of_finite_programs_as_they_are(index: int) -> None:
    scenario = loads(random_program(5, index, FINITE).text)
    try:
        exact = scenario.enumerate(max_runs=400)
    except ScenicError:
        return
    if scenario.batch is None or any(site.per_scene for site in target_of(scenario).space.sites):
        return
    target = target_of(scenario)
    states = accepted(target, 1_500)
    made = [content_of_scene(scene) for scene in target.scenes(moved(target, states, random(6), None, 8), 0)]
    assert not contradicts(made, Categorical(exact.law(content_of_scene)), DEFAULT_ALPHA / 60)


def test_each_kind_of_move_is_made_and_keeps_what_it_should() -> None:
    target = target_of(scenic_ref.loads(CARS))
    states = target.simulate(2_000, random())
    moves = moves_of(target)
    assert len(moves) == len(target.blocks()) == 3
    proposed, kinds, _ = moves.propose(states, random(2))
    changed = proposed.uniforms != states.uniforms
    touched = [changed[sorted(numbers)].any(axis=0) for numbers, _ in target.blocks()]
    for kind, blocks in ((REDRAW, 1), (STEP, 1), (EXCHANGE, 2)):
        rows = kinds == kind
        assert rows.sum() > 100
        assert (np.sum(touched, axis=0)[rows] == blocks).all()
    exchanged = kinds == EXCHANGE
    assert (np.sort(proposed.uniforms, axis=0) == np.sort(states.uniforms, axis=0))[:, exchanged].all()
    steps = np.abs(proposed.uniforms - states.uniforms)[:, kinds == STEP]
    assert 0 < steps[steps > 0].min() < 0.05
    assert ((proposed.uniforms >= 0) & (proposed.uniforms < 1)).all()


def test_steps_of_a_block_become_smaller_where_few_are_taken_and_larger_where_many_are() -> None:
    moves = moves_of(target_of(scenic_ref.loads(CARS)))
    first = moves.smallest.copy()

    def adapt(block: int, made: int, taken: int) -> None:
        counted = MovesMade(len(moves))
        counted.add(np.full(made, STEP), np.full(made, block), np.arange(made) < taken)
        moves.adapt(counted)

    adapt(0, 15, 1)
    assert (moves.smallest == first).all()  # too few to tell, as yet
    adapt(0, 15, 1)
    assert moves.smallest[0] < first[0] and (moves.smallest[1:] == first[1:]).all()
    for _ in range(20):
        adapt(1, 100, 90)
    assert first[1] < moves.smallest[1] <= 0.25
