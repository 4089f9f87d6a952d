"""Importance sampling, splitting and Markov chains: their scenes have the program's law, their estimates hold the truth, their doubts are right."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.conformance.generator import ProgramSettings
from scenic_ref.data.scene import Scene
from scenic_ref.inference import chain_diagnostics, mcmc, smc
from scenic_ref.inference.comparison.exact_laws import Categorical, Continuous, contradicts
from scenic_ref.inference.importance import mean_weight
from scenic_ref.inference.moves import states
from scenic_ref.inference.moves.proposals import Moves
from scenic_ref.inference.moves.target import Target
from scenic_ref.inference.result import Inferred, Probability
from scenic_ref.semantics.store.errors import AttemptsExhausted, ScenicError, UsageError

BACKENDS = ("importance", "smc", "mcmc")
FINITE = ProgramSettings().as_finite()
RARE = """
xs = [Range(0, 1) for i in range(4)]
ego = Object at xs[0] @ 0
s = xs[0] + xs[1] + xs[2] + xs[3]
require s < 0.2
param s = s
"""
"""The sum of four uniform numbers is below s < 1 with probability s⁴ / 24."""
EXACT = 0.2**4 / 24
SUM = Continuous("s", lambda s: (min(max(s, 0.0), 0.2) / 0.2) ** 4, 0.0, 0.2)
SOFT = "x = Range(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire[0.5] x < 0.1\nrequire x > 0.05\nparam x = x\n"


@pytest.mark.parametrize("backend", BACKENDS)
def test_scenes_of_a_rare_event_have_their_law(backend: str) -> None:
    found = scenic_ref.loads(RARE).infer(backend, 500, 2)
    assert not found.doubts
    assert len(found.scenes) == 500
    assert [scene.index for scene in found.scenes] == list(range(500))
    assert not contradicts([scene.params["s"] for scene in found.scenes], SUM)


@pytest.mark.slow
def test_the_interval_holds_the_probability_in_20_of_20_repetitions() -> None:
    scenario = scenic_ref.loads(RARE)
    for seed in range(20):
        found = scenario.infer("smc", 10, seed).acceptance
        assert found.low <= EXACT <= found.high
        assert found.high < 6 * EXACT
        assert found.low > EXACT / 6


@pytest.mark.slow
def test_an_estimate_without_the_weight_of_a_level_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rival forgets the first level below that of any violation."""
    scenario = scenic_ref.loads(RARE)
    right = scenario.infer("smc", 10, 1).acceptance
    assert right.low <= EXACT <= right.high
    split = smc.run_splitting

    def forgetful(*arguments: object, **keywords: object) -> tuple[list[smc.Population], Moves]:
        found, moves = split(*arguments, **keywords)  # type: ignore[arg-type]
        return [p._replace(levels=(p.levels[0], *p.levels[2:])) for p in found], moves

    monkeypatch.setattr(smc, "run_splitting", forgetful)
    wrong = scenario.infer("smc", 10, 1).acceptance
    assert 2.5 < wrong.estimate / right.estimate < 4.5
    assert not wrong.low <= EXACT <= wrong.high


@pytest.mark.slow
def test_levels_fall_to_0_and_their_parts_multiply_to_the_probability() -> None:
    batch = scenic_ref.loads(RARE).batch
    assert batch is not None
    seen: list[tuple[float, float]] = []
    found, _ = smc.run_splitting(Target(batch, 1), 2, 300, np.random.Generator(np.random.Philox(1)), on_level=lambda *told: seen.append(told))
    for population in found:
        violations = [level.violation for level in population.levels]
        assert violations == sorted(violations, reverse=True)
        assert violations[-1] == 0
        assert population.log_probability == pytest.approx(sum(math.log(level.kept) for level in population.levels))
        assert all(0 < level.taken["redraw"] < 1 for level in population.levels[1:])
    assert seen[-1][0] == 1


@pytest.mark.slow
def test_estimates_are_right_on_average_and_with_levels_of_ones_own_they_are_too_large() -> None:
    """Populations of 30 states, a fourth of what tells one estimate apart from another. The law of the mean: 4.9 standard errors, 1e-6."""
    batch = scenic_ref.loads(RARE).batch
    assert batch is not None
    random, target = np.random.Generator(np.random.Philox(1)), Target(batch, 1)
    found, _ = smc.run_splitting(target, 300, 30, random, passes=4)
    own = [math.prod(p.kept for p in smc.explore(target, smc.moves_of(target), 30, random, 4)) for _ in range(100)]

    def away(estimates: list[float]) -> float:
        ratios = np.array(estimates) / EXACT
        return float((ratios.mean() - 1) / (ratios.std(ddof=1) / math.sqrt(len(ratios))))

    assert abs(away([math.exp(p.log_probability) for p in found])) < 4.9
    assert away(own) > 4.9


def test_an_interval_is_no_point_where_nothing_is_rejected() -> None:
    """All 2,400 states are accepted, which tells of a probability of 1 only within bounds."""
    found = scenic_ref.loads("x = Range(0, 1)\nego = Object at x @ 0\nrequire x > 0.00001\n").infer("smc", 5, 1).acceptance
    assert 0.99 < found.low < 0.99999
    assert found.high == 1


def test_as_many_scenes_are_given_as_asked_for() -> None:
    random = np.random.Generator(np.random.Philox(1))
    assert smc.systematic_counts(np.array([0.0, 1.0, 3.0]), 400, random) == [0, 100, 300]
    assert sorted(smc.some(100, 300, random).tolist()) == sorted([*range(100)] * 3)
    assert len(smc.some(7, 0, random)) == 0


@pytest.mark.slow
def test_states_are_moved_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smc, "CHUNK", 700)
    monkeypatch.setattr(states, "CHUNK", 700)
    found = scenic_ref.loads(RARE).infer("smc", 300, 1)
    assert found.acceptance.low <= EXACT <= found.acceptance.high
    assert not contradicts([scene.params["s"] for scene in found.scenes], SUM)


@pytest.mark.slow
@pytest.mark.extra("fast")
def test_means_of_scenes_in_a_full_yard_are_those_of_rejection() -> None:
    """Two runs of a million are accepted. Level: 1e-6 for each of the fifteen means of each backend, by the normal law."""
    scenario = scenic_ref.load(Path(__file__).parents[2] / "examples" / "yard.scenic")

    def numbers(scenes: list[Scene]) -> np.ndarray:
        return np.array([[v for o in s.objects for v in (o.position.x, o.position.y, o.heading)] for s in scenes])

    exact = numbers(list(scenario.pruned().sample_many(80, 1, max_attempts=100_000_000)))
    for backend in ("smc", "mcmc"):
        found = scenario.infer(backend, 1_000, 1)
        assert not found.doubts
        drawn = numbers(found.scenes)
        worth = min(found.diagnosis.bulk, len(drawn))
        spread = np.sqrt(exact.var(axis=0, ddof=1) / len(exact) + drawn.var(axis=0, ddof=1) / worth)
        assert (np.abs(exact.mean(axis=0) - drawn.mean(axis=0)) < 4.9 * spread).all(), backend
        poses = drawn.reshape(-1, 5, 3)  # the rival: chains that keep the order of the lorries
        rival = np.take_along_axis(poses, np.argsort(poses[:, :, :1], axis=1), axis=1).reshape(len(drawn), -1)
        assert (np.abs(exact.mean(axis=0) - rival.mean(axis=0)) > 4.9 * spread).any()


@pytest.mark.parametrize("backend", ["smc", pytest.param("mcmc", marks=pytest.mark.slow)])
def test_a_coin_that_seldom_shows_tails_is_as_likely_as_it_is(backend: str) -> None:
    """Of the accepted runs 27 % show tails, the others meet the condition: to lose either part would be found out."""
    program = "xs = [Range(0, 1) for i in range(3)]\nego = Object at xs[0] @ 0, with requireVisible False\ns = xs[0] + xs[1] + xs[2]\n"
    p, s = 5e-4, 0.2**3 / 6
    found = scenic_ref.loads(f"{program}require[{1 - p}] s < 0.2\nparam s = s\n").infer(backend, 1_000, 1)
    exact = p + (1 - p) * s
    assert found.acceptance.low <= exact <= found.acceptance.high
    met = sum(scene.params["s"] < 0.2 for scene in found.scenes)
    share = s / exact
    bound = 4.9 * math.sqrt(share * (1 - share) / min(1_000.0, found.diagnosis.bulk))  # 1e-6
    assert abs(met / 1_000 - share) < bound < min(share, 1 - share)


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
def test_the_same_seed_gives_the_same_scenes(backend: str) -> None:
    scenario = scenic_ref.loads(SOFT)
    lines = [[scene.to_line() for scene in scenario.infer(backend, 5, seed).scenes] for seed in (4, 4, 5)]
    assert lines[0] == lines[1] != lines[2]


def test_weights_count_the_coins_of_soft_requirements() -> None:
    scenario = scenic_ref.loads(SOFT)
    found = scenario.infer("importance", 4_000, 1)
    assert {(scene.params["x"] < 0.1, scene.weight) for scene in found.scenes} == {(True, 1.0), (False, 0.5)}
    exact = 0.05 + 0.9 * 0.5
    assert found.acceptance.low < exact < found.acceptance.high < 1.1 * exact
    weights = np.array([scene.weight for scene in found.scenes])
    share = weights[[scene.params["x"] < 0.1 for scene in found.scenes]].sum() / weights.sum()
    assert abs(share - 0.05 / exact) < 0.03
    assert "--resample" in found.notes[0]
    equal = scenario.infer("importance", 2_000, 1, resample=True)
    assert {scene.weight for scene in equal.scenes} == {1.0}
    assert not contradicts([scene.params["x"] < 0.1 for scene in equal.scenes], Categorical({True: 0.05 / exact, False: 1 - 0.05 / exact}))


OPERAND = """
g = PolygonalVectorField('g', [[PolygonalRegion([-1 @ -1, -1 @ 1, 0.5 @ 1, 0.5 @ -1]), 0.3]])
x, y = Range(0, 1), Range(0, 1)
ego = Object at 0 @ 0, with requireVisible False
require not (x < 0.5 and (g at y @ 0) > 1)
param x = x
"""


def test_only_the_coins_of_soft_requirements_are_counted() -> None:
    """Where y > 0.5 there is no heading, which rejects the runs in which it is asked for: a condition that is no coin."""
    scenario = scenic_ref.loads(OPERAND)
    assert scenario.batch is not None
    assert any(event.condition is not None for event in scenario.batch.graph.events)
    assert not scenario.batch.graph.coins
    found = scenario.infer("importance", 4_000, 1)
    assert {scene.weight for scene in found.scenes} == {1.0}
    assert found.acceptance.low < 0.75 < found.acceptance.high
    assert not contradicts([scene.params["x"] < 0.5 for scene in found.scenes], Categorical({True: 1 / 3, False: 2 / 3}))
    soft = scenic_ref.loads(SOFT).batch
    assert soft is not None
    assert list(soft.graph.coins.values()) == [0.5]


def test_the_bounds_of_a_mean_weight_hold_for_any_number_of_runs() -> None:
    assert mean_weight(1000, 0, 0, share=0.5, is_simple=True)[:3] == (0.0, 0.0, pytest.approx(0.5 * (1 - 0.0005 ** (1 / 1000))))
    found = mean_weight(1001, 500.5, 400.4, share=1.0, is_simple=False)
    once = math.log(2 / 0.0005)
    assert (found.high - found.low) / 2 == pytest.approx(math.sqrt(2 * 0.15015 * once / 1001) + 7 * once / 3000, rel=1e-9)
    hidden = mean_weight(10_000, 1e-3, 1e-10, share=1.0, is_simple=False)  # all weights are alike: what has weight 1 was perhaps not seen
    assert hidden.low == 0 and hidden.high > 1e-3


def test_scenes_that_may_lack_most_of_the_probability_are_doubted() -> None:
    """Of the accepted runs half meet a condition that none of 16,384 runs meets: the weights that were seen are all alike."""
    program = "x = Range(0, 1)\nego = Object at x @ 0, with requireVisible False\nrequire[0.9999999] x < 1e-7\n"
    found = scenic_ref.loads(program).infer("importance", 5, 1)
    assert any("were not seen" in doubt for doubt in found.doubts)
    assert found.acceptance.low <= 2e-7 <= found.acceptance.high


ROOM = "workspace = Workspace(PolygonalRegion([0@0, 20@0, 20@10, 0@10]))\nego = Object in workspace, with width 4, with length 4\n"


@pytest.mark.parametrize("backend", BACKENDS)
def test_smaller_regions_of_pruning_count(backend: str) -> None:
    scenario = scenic_ref.loads(ROOM)
    assert scenario.pruning.pruned
    found = scenario.infer(backend, 50, 1)
    exact = 16 * 6 / 200
    assert found.acceptance.low <= exact * 1.0001
    assert exact * 0.9999 <= found.acceptance.high
    assert all(scene.pruned for scene in found.scenes)


@pytest.mark.parametrize("backend", BACKENDS)
def test_programs_without_a_graph_are_refused_with_the_reason(backend: str) -> None:
    scenario = scenic_ref.loads("x = Range(0, 1)\nprint('a')\nego = Object at x @ 0\nrequire x < 0.2\n")
    with pytest.raises(UsageError, match=f"{backend} cannot draw from this program: <string>:2:1: the program prints"):
        scenario.infer(backend, 5, 1)


LEFT = "x = Range(0, 1)\ny = 1 / int(x < 0.5)\nego = Object at 0 @ 0\nparam x = x\nrequire x < 0.4\n"


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_programs_errors_are_said(backend: str) -> None:
    with pytest.raises(ScenicError, match="division by zero"):
        scenic_ref.loads(LEFT).infer(backend, 5, 1)


def test_that_nothing_can_be_found_is_said_with_what_stays_violated() -> None:
    scenario = scenic_ref.loads("x = Normal(0, 1)\nego = Object at 0 @ 0\nrequire x > 60\n")
    for backend in ("smc", "mcmc"):
        with pytest.raises(AttemptsExhausted, match=r"as far as can be seen.*the requirement on line 3") as caught:
            scenario.infer(backend, 5, 1)
        assert caught.value.stuck
    with pytest.raises(AttemptsExhausted, match=r"no scene in [\d,]+ runs"):
        scenario.infer("importance", 5, 1, max_attempts=1000)
    with pytest.raises(UsageError, match="no backend nuts"):
        scenario.infer("nuts", 5, 1)
    with pytest.raises(UsageError, match="n is a whole number"):
        scenario.infer("smc", 0, 1)


def test_chains_that_do_not_agree_are_doubted() -> None:
    """Two islands, each of which the moves seldom leave: with few chains the estimate of their shares cannot be trusted."""
    diagnosis = chain_diagnostics.Diagnosis(1.3, 20.0, 10.0, 0)
    found = Inferred("mcmc", [], Probability(0.1, 0.0, 1.0, 0.999), 10, diagnosis, "the position of ego", 1.0)
    assert [doubt.split(":")[0] for doubt in found.doubts] == [
        "independent parts of the work disagree about the position of ego", "the draws are worth 20 independent ones for means, fewer than 50",
        "the draws are worth 10 independent ones for quantiles, fewer than 50", "the probability that a run is accepted is anything from 0 to 1",
    ]
    assert found.report()["warnings"] == found.doubts
    fine = diagnosis._replace(rhat=1.01, bulk=100.0, tail=60.0)
    assert not found._replace(diagnosis=fine, acceptance=Probability(0.1, 0.05, 0.2, 0.999)).doubts


def test_a_requirement_that_can_be_met_in_several_ways_is_noted() -> None:
    """Populations may all have gone one way: nothing could tell, so it is said."""
    for condition, noted in (("x > 0.9 or y > 0.9", True), ("not (x < 0.9 and y < 0.9)", True), ("x > 0.9 and y > 0.9", False)):
        text = f"x, y = Range(0, 1), Range(0, 1)\nego = Object at x @ y\nrequire {condition}\n"
        found = scenic_ref.loads(text).infer("smc", 5, 1)
        assert any("several ways to meet the requirement on line 3" in note for note in found.notes) == noted
        assert not found.doubts


# Where little can be told apart


NEEDLE = "x = Uniform(*range({}))\nego = Object at 0 @ 0, with requireVisible False\nrequire x == 7\n"
CHOICE = "v = Uniform(*([1] * 9), 0)\nx = Range(0, 1)\nego = Object at 0 @ 0\nrequire max(v, x * 0.5) < 0.005\n"


@pytest.mark.slow
@pytest.mark.parametrize(("text", "exact"), [(NEEDLE.format(100), 1 / 100), (NEEDLE.format(1000), 1 / 1000), (CHOICE, 1 / 1000)])
def test_a_plateau_of_violations_is_no_dead_end(text: str, exact: float) -> None:
    """Where all that is not accepted is violated alike, splitting is rejection by many states: estimates right on average, none without a scene.

    The mean of ten estimates, each of eight populations in which at least ten states are left as a rule: within 4.9 of its standard errors, by 1e-6.
    If a population could not die, and others were only counted where none did, the mean would be 1.3 of what it should be.
    """
    scenario = scenic_ref.loads(text)
    for backend in ("smc", "mcmc"):
        found = [scenario.infer(backend, 5, seed).acceptance for seed in range(10)]
        assert all(one.low <= exact <= one.high for one in found)
        ratios = np.array([one.estimate for one in found]) / exact
        bound = 4.9 * max(float(ratios.std(ddof=1)), 1 / math.sqrt(8 * 10)) / math.sqrt(10)
        rival = 1 / (1 - (1 - exact) ** 128)  # populations of 128 states that are only counted where some are left
        assert abs(ratios.mean() - 1) < bound < abs(ratios.mean() - rival)


def test_a_population_without_states_counts_as_0() -> None:
    some, none = np.zeros((1, 4)), np.zeros((1, 0))
    words = np.zeros((0, 4), dtype=np.uint64), np.zeros((0, 0), dtype=np.uint64)
    living = smc.Population(states.States(some, words[0]), (smc.Level(0.0, 0.5, {}),))
    dead = smc.Population(states.States(none, words[1]), (smc.Level(0.0, 0.0, {}),))
    found = smc.probability([living, dead, living, living], 1.0)
    assert found.estimate == pytest.approx(0.375)
    assert 0 <= found.low < 0.375 < found.high <= 1


ISLANDS = """
import math
point = OrientedPoint in PolygonalRegion([0 @ 0, 1 @ 0, 1 @ 1, 0 @ 1]).union(PolygonalRegion([9 @ 0, 10 @ 0, 10 @ 1, 9 @ 1]))
ego = Object at point, with requireVisible False
z = math.exp(point.position.x / 10)
require z > 1.0001
"""


@pytest.mark.slow
def test_chains_are_compared_by_what_is_in_the_scenes_also_where_an_operation_may_fail() -> None:
    """Without features, R-hat would be 1 and all draws worth as much as independent ones, whatever the chains did."""
    scenario = scenic_ref.loads(ISLANDS)
    found = scenario.infer("mcmc", 200, 1)
    assert "random number" not in " ".join(found.names)
    assert any("position" in name for name in found.names)
    assert len({str(scene.ego.position) for scene in found.scenes}) > 100


@pytest.mark.slow
def test_chains_draw_something_however_small_the_budget_is() -> None:
    batch = scenic_ref.loads(RARE).batch
    assert batch is not None
    for most in (1, 100, 20_000, 40_000):
        assert len(mcmc.draw_mcmc(batch, 5, 1, most_runs=most).scenes) == 5


@pytest.mark.slow
def test_as_many_draws_are_kept_as_many_scenes_need() -> None:
    batch = scenic_ref.loads("x, y = Range(0, 1), Range(0, 1)\nego = Object at x @ y\nrequire x > y\n").batch
    assert batch is not None
    found = mcmc.draw_mcmc(batch, 60_000, 1)
    assert found.attempts < 3_000_000
    assert found.diagnosis.bulk >= 60_000
    assert not found.notes


def test_the_counts_of_importance_sampling_that_gives_up_fit_together() -> None:
    program = "x = Normal(0, 1)\nrequire x > 4\nego = Object\nparam a = x\n"
    with pytest.raises(AttemptsExhausted) as raised:
        scenic_ref.loads(program).infer("importance", 3000, seed=2, max_attempts=40_000)
    counts = [int(number.replace(",", "")) for number in re.findall(r"[\d,]*\d", raised.value.message)]
    since, failed, runs = counts[:3]
    assert since <= runs
    assert failed <= runs
