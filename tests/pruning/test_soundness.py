"""Pruned and unpruned programs have the same scenes: no accepted run has a point outside the smaller regions, and the rest is as before."""

from __future__ import annotations

import itertools
import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.data.scene import Scene
from scenic_ref.inference.batch.block_rejection import Batch
from scenic_ref.inference.pruning import Pruning, accepted_facts, analysis, prune
from scenic_ref.inference.pruning.analysis import prune_recorded
from scenic_ref.inference.pruning.traced_points import Recorded, record_points
from scenic_ref.inference.rejection import sample
from scenic_ref.interpreter.runtime.answerers import from_stream, from_trace
from scenic_ref.interpreter.runtime.program_run import Accepted, generate_scene
from scenic_ref.semantics.machine.outcome import Draw
from scenic_ref.semantics.space.distributions import PointIn
from scenic_ref.semantics.space.symbol_seam import NotLifted
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.testing import same_distribution

from .drawn import accepted_points, lost
from .programs import EGO, MAP, NEAR, OTHER, SOFTLY_ALIGNED, random_program

GALLERY = sorted((Path(__file__).parent.parent.parent / "examples" / "gallery").glob("*.scenic"))
PRUNABLE = {p.stem for p in GALLERY} - {"noise"}
COUNT = int(os.environ.get("SCENIC_REF_PROGRAMS", "30"))
RUNS = 6_000
FUEL = 1_000_000
OPPOSITE = "require abs(relative heading of other) >= 2.8\n"
SOME_COURSE = MAP + EGO + "other = Object in road, facing Range(-0.1, 0.1) relative to direction, with width 2, with length 4\n"


@cache
def gallery(name: str) -> tuple[Scenario, Recorded, Pruning]:
    scenario = scenic_ref.load(next(p for p in GALLERY if p.stem == name))
    recorded = record_points(scenario.start, FUEL)
    return scenario, recorded, prune_recorded(recorded)


# No accepted run is lost


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(PRUNABLE))
def test_no_accepted_run_of_the_gallery_has_a_point_outside_the_smaller_regions(name):
    _, recorded, pruning = gallery(name)
    assert pruning.pruned
    points = accepted_points(recorded, RUNS if name != "mars_bottleneck" else 60_000)
    assert sum(map(len, points.values())) > 20
    assert lost(pruning, points) == 0


def test_what_is_mutated_in_the_gallery_is_not_pruned():
    assert not gallery("noise")[2].pruned


@pytest.mark.sampled(8)
@pytest.mark.parametrize("number", range(COUNT))
def test_no_accepted_run_of_a_random_program_has_a_point_outside_the_smaller_regions(number):
    scenario = scenic_ref.loads(random_program(np.random.default_rng(number)))
    try:
        recorded = record_points(scenario.start, FUEL)
    except NotLifted:
        return  # it never has a scene
    points = accepted_points(recorded, RUNS, seed=number)
    pruning = prune_recorded(recorded)
    assert lost(pruning, points) == 0
    assert not any("nothing would be left" in f.reason for f in pruning.findings) or not any(map(len, points.values()))


# Wrong versions are caught


def is_caught(program: str) -> bool:
    """Whether some accepted run has a point outside the regions that are left."""
    recorded = record_points(scenic_ref.loads(program).start, FUEL)
    return lost(prune_recorded(recorded), accepted_points(recorded, RUNS)) > 0


SOFT = SOME_COURSE + (NEAR + OPPOSITE).replace("require", "require[0.5]")
MUTATED = SOME_COURSE + "mutate ego by 5\n"
WIDE = MAP + EGO.replace("with length 2", "with length 5")


@pytest.mark.parametrize("program", [SOFT, MUTATED, WIDE, SOME_COURSE + NEAR + OPPOSITE, SOFTLY_ALIGNED])
def test_these_programs_are_pruned_rightly(program):
    assert not is_caught(program)


def test_an_erosion_by_the_larger_side_or_the_diagonal_is_caught(monkeypatch):
    for wrong in (lambda a, b: max(a, b) / 2, lambda a, b: np.hypot(a, b) / 2):
        monkeypatch.setattr(accepted_facts, "min_radius", wrong)
        assert is_caught(WIDE)


def test_a_soft_requirement_taken_for_a_hard_one_is_caught(monkeypatch):
    monkeypatch.setattr(analysis, "truths", lambda graph: (t for soft in (False, True) for t in accepted_facts.truths(graph, soft=soft)))
    assert is_caught(SOFT)


def test_mutation_that_is_ignored_is_caught(monkeypatch):
    recorded = record_points(scenic_ref.loads(MUTATED).start, FUEL)
    (first, *_) = recorded.points.values()
    right = accepted_facts.position_of
    monkeypatch.setattr(accepted_facts, "position_of", lambda s, o: first.point if s.names.get(o.number) == "ego" else right(s, o))
    assert lost(prune_recorded(recorded), accepted_points(recorded, RUNS)) > 0


def test_a_deviation_that_is_ignored_is_caught(monkeypatch):
    course = SOME_COURSE + NEAR.replace("9", "30") + OPPOSITE.replace("2.8", "2.95")
    assert not is_caught(course)
    right = analysis.prune_by_heading
    monkeypatch.setattr(analysis, "prune_by_heading", lambda cells, a, m, d, turn: right(cells, a, m, 0.0, turn))
    assert is_caught(course)


def test_an_erosion_by_ten_centimetres_more_is_caught(monkeypatch):
    right = analysis.prune_by_containment
    monkeypatch.setattr(analysis, "prune_by_containment", lambda r, c, m: right(r, c, m + 0.1))
    assert is_caught(WIDE)


# The same distribution


def grid_law(scenario: Scenario, pruning: Pruning, points: list[Vector], *, pruned: bool) -> set[tuple[Vector, ...]]:
    """The accepted combinations when every point is drawn from the points of a grid (those in its smaller region, if `pruned`)."""
    addresses = [p.address for p in pruning.pruned]
    regions = [p.region if pruned else p.original for p in pruning.pruned]
    choices = [[v for v in points if region.contains_point(v)] for region in regions]
    accepted = set()
    for combination in itertools.product(*choices):
        ended = generate_scene(scenario.start(), from_trace(dict(zip(addresses, combination, strict=True)), refuse))
        if isinstance(ended, Accepted):
            accepted.add(combination)
    return accepted


def refuse(draw: Draw) -> object:
    raise AssertionError(draw.address)


@pytest.mark.slow
@pytest.mark.parametrize(
    "program",
    [
        EGO.replace("in road", "in road, facing direction"),
        EGO.replace("in road", "in road, facing direction") + "other = Object at ego offset by (7, 1), with width 0.5, facing direction\n",
        EGO + OTHER.strip() + ", facing direction\n" + NEAR + OPPOSITE,
    ],
)
def test_on_a_grid_the_exact_distribution_is_the_same(program):
    """All combinations are equally likely, so that the distributions are equal exactly if the same ones are accepted."""
    scenario = scenic_ref.loads(MAP + program)
    pruning = prune(scenario.start)
    side = 12 if len(pruning.pruned) == 1 else 4
    points = [Vector(x, y) for x in np.linspace(0.31, 25.7, 2 * side).tolist() for y in np.linspace(0.17, 59.9, side).tolist()]
    without, with_ = (grid_law(scenario, pruning, points, pruned=pruned) for pruned in (False, True))
    assert without == with_
    assert without


class Drawn:
    """Scenes of a program with pruned draws, from the batch backend."""

    def __init__(self, scenario: Scenario, pruning: Pruning) -> None:
        self.batch = Batch(scenario.start, fuel=FUEL, draws=pruning.draws)

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> list[Scene]:
        return list(self.batch.scenes(n, seed, start=start))


def without_attempts(scenes: list[Scene]) -> list[dict[str, object]]:
    """Scenes as JSON, all with one attempt: pruning is meant to change their number."""
    return [{**scene.to_json(), "attempts": 1} for scene in scenes]


def positions(scenes: list[Scene]) -> list[float]:
    return [c for scene in scenes for o in scene.objects for c in (o.position.x, o.position.y, o.heading)]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["single_car", "simplest", "badly_parked_car", "oncoming_car"])
def test_pruned_scenes_of_the_gallery_have_the_same_distribution(name):
    scenario, _, pruning = gallery(name)
    n = 1500
    plain = without_attempts(list(Batch(scenario.start, fuel=FUEL).scenes(n, 1)))
    pruned = without_attempts(Drawn(scenario, pruning).sample_many(n, 2))
    assert same_distribution(pruned, scenario, reference=plain).kind != "different"


@pytest.mark.slow
def test_a_smaller_region_that_is_wrong_is_told_from_the_distribution():
    scenario, _, pruning = gallery("single_car")
    (one,) = pruning.pruned
    west = type(one.region)(points=[(-800, -700), (-640, -700), (-640, -380), (-800, -380)])
    half = one._replace(region=type(one.region)(polygon=one.region.polygon.intersection(west.polygon)))
    plain = without_attempts(list(Batch(scenario.start, fuel=FUEL).scenes(500, 1)))
    wrong = without_attempts(Drawn(scenario, pruning._replace(pruned=(half,))).sample_many(500, 2))
    assert same_distribution(wrong, scenario, reference=plain).kind == "different"


# The draws


@pytest.mark.slow
@pytest.mark.parametrize("name", ["single_car", "oncoming_car", "bumper_to_bumper"])
def test_interpreter_and_batch_give_the_same_pruned_scenes(name):
    scenario, _, pruning = gallery(name)
    by_batch = Drawn(scenario, pruning).sample_many(4, seed=7)
    one_by_one = [sample(scenario.start, 7, index, draws=pruning.draws).scene for index in range(4)]
    assert [scene.attempts for scene in by_batch] == [scene.attempts for scene in one_by_one]
    assert positions(by_batch) == positions(one_by_one)


@pytest.mark.slow
def test_pruning_saves_attempts():
    scenario, _, pruning = gallery("bumper_to_bumper")
    pruned = sum(scene.attempts for scene in Drawn(scenario, pruning).sample_many(400))
    plain = sum(scene.attempts for scene in Batch(scenario.start, fuel=FUEL).scenes(400, 0))
    assert pruned < 0.85 * plain


def test_pruned_draws_are_in_the_smaller_regions_and_others_are_as_before():
    scenario, _, pruning = gallery("single_car")
    (one,) = pruning.pruned
    seen: list[Draw] = []
    choose, plain = from_stream(3, 4, 5, pruning.draws), from_stream(3, 4, 5)

    def answer(draw: Draw) -> object:
        drawn = choose(draw)
        if draw.address == one.address:
            assert isinstance(drawn, Vector)
            assert one.region.contains_point(drawn)
            seen.append(draw)
        else:
            assert drawn == plain(draw)
        return drawn

    generate_scene(scenario.start(), answer)
    assert len(seen) == 1
    assert seen[0].distribution == PointIn(one.original)


def test_a_draw_that_is_no_point_is_never_replaced():
    scenario = scenic_ref.loads("x = Range(0, 1)\nego = Object at (x, 0)\n")
    pruned = sample(scenario.start, 0, 0, draws={(0,): PointIn(scenic_ref.semantics.space.regions.everywhere)}).scene
    assert pruned.to_json() == {**scenario.sample(0).to_json(), "pruned": True}
