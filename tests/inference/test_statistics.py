"""Betting: wealth that draws from the law cannot make, and that draws from a rival do; features, cells and verdicts."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scenic_ref
from scenic_ref.inference.comparison import (
    BoundedMean,
    Categorical,
    Continuous,
    compare,
    compare_invariance,
    contradicts,
    evidence,
)
from scenic_ref.inference.comparison.betting import average_e_values, one_sample_wealth, two_sample_wealth
from scenic_ref.inference.comparison.cells import cells_of, opening_of
from scenic_ref.inference.comparison.comparison import Hardest, detectable, required_draws
from scenic_ref.inference.comparison.known_features import Facts
from scenic_ref.inference.comparison.relations import gap, table_of
from scenic_ref.inference.comparison.scene_columns import Column, FeatureTable, unit_of
from scenic_ref.semantics.space.regions.approximation import box_shape
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import UsageError

UNIFORM = Continuous("uniform", lambda x: min(max(x, 0.0), 1.0))


def numbers(seed: int, *shape: int) -> np.ndarray:
    return np.random.Generator(np.random.Philox(seed)).random(shape)


# Wealth is a martingale: its mean under the null hypothesis, over all outcomes, is at most 1


def test_the_mean_wealth_of_one_sample_is_one():
    p = np.array([0.5, 0.3, 0.2])
    total = 0.0
    for a in range(6):
        for b in range(6 - a):
            counts = np.array([a, b, 5 - a - b])
            ways = math.factorial(5) / math.prod(math.factorial(int(c)) for c in counts)
            total += ways * float(np.prod(p**counts)) * math.exp(float(one_sample_wealth(counts, p)))
    assert total == pytest.approx(1, abs=1e-8)  # log-gamma of the largest concentration has nine digits behind the point


def test_the_mean_wealth_of_two_samples_is_at_most_one():
    p, n, total = (0.6, 0.4), 4, 0.0
    for a in range(n + 1):
        for b in range(n + 1):
            weight = math.comb(n, a) * math.comb(n, b) * p[0] ** (a + b) * p[1] ** (2 * n - a - b)
            total += weight * math.exp(float(two_sample_wealth(np.array([a, n - a]), np.array([b, n - b]))))
    assert 0.5 < total <= 1 + 1e-12


@pytest.mark.parametrize(("p", "seen"), [((0.5, 0.25, 0.25), (500, 0, 0)), ((0.9, 0.05, 0.05), (1000, 0, 0)), ((0.5, 0.3, 0.2), (9, 4, 1))])
def test_no_pair_of_draws_raises_the_wealth_on_average(p, seen):
    """Also where a cell is hit for the first time."""
    counts = np.array(seen)
    before, after = float(two_sample_wealth(counts, counts)), 0.0
    for i in range(3):
        for j in range(3):
            one, other = counts.copy(), counts.copy()
            one[i] += 1
            other[j] += 1
            after += p[i] * p[j] * math.exp(float(two_sample_wealth(one, other)))
    assert after <= math.exp(before) * (1 + 1e-12)


def test_an_impossible_value_is_infinite_evidence():
    assert evidence([1, 2, 1, 3], Categorical({1: 0.5, 2: 0.5})) == math.inf
    assert evidence([0.5, math.nan], UNIFORM) == math.inf


def test_the_average_of_e_values_is_one():
    assert average_e_values(np.log([1.0, 3.0])) == pytest.approx(math.log(2))


@pytest.mark.parametrize(
    ("law", "draws", "rival"),
    [
        (UNIFORM, numbers(1, 4000), 0.05 + 0.95 * numbers(2, 4000)),
        (Categorical({1: 0.25, 2: 0.75}), np.where(numbers(3, 4000) < 0.25, 1, 2), np.where(numbers(4, 4000) < 0.32, 1, 2)),
        (BoundedMean(0.5, 0, 1), numbers(5, 4000), numbers(6, 4000) ** 1.4),
    ],
)
def test_draws_from_the_law_do_not_contradict_it_and_those_of_a_rival_do(law, draws, rival):
    assert not contradicts(draws.tolist(), law)
    assert contradicts(rival.tolist(), law)


def test_false_alarms_are_as_rare_as_stated():
    # 1,000 nulls at 1 in 20: more than 90 alarms have probability below 1e-7 if each has probability 1/20
    alarms = sum(evidence(numbers(100 + k, 400).tolist(), UNIFORM) >= -math.log10(0.05) for k in range(1000))
    assert alarms <= 90


# Cells


def test_angles_are_cut_open_at_their_widest_gap():
    angles = np.concatenate([np.linspace(3.0, math.pi, 50), np.linspace(-math.pi, -3.0, 50)])
    assert abs(opening_of(angles) % math.tau) < 0.1 or abs(opening_of(angles) % math.tau - math.tau) < 0.1
    cells = cells_of(Column("objects[0].heading", angles))
    turned = Column("objects[0].heading", angles + math.tau)
    assert (cells.assign(turned) == cells.assign(Column("objects[0].heading", angles))).all()


def test_rounding_does_not_split_an_atom():
    values = np.concatenate([np.zeros(500), numbers(7, 500)])
    cells = cells_of(Column("x", values))
    assert (cells.assign(Column("x", values)) == cells.assign(Column("x", values - 1e-13))).all()


def test_few_values_have_a_cell_each_and_others_share_one():
    cells = cells_of(Column("x", np.array([1.0, 2.0, 2.0, 5.0])))
    assert cells.assign(Column("x", np.array([1.0, 2.0 + 1e-12, 5.0, 3.0]))).tolist() == [0, 1, 2, 3]


def test_columns_are_named_by_their_place():
    program = "ego = Object at (1, 2), with v (3, 'a')\nObject at (4, 6), facing 90 deg, with requireVisible False\nparam t = 5\n"
    scene = scenic_ref.loads(program).sample()
    table = table_of([scene])
    assert table.columns["objects[0].position[1]"].values.tolist() == [2.0]
    assert table.columns["objects[0].properties.v[1]"].values.tolist() == ["a"]
    assert table.columns["params.t"].values.tolist() == [5.0]
    assert table.columns["distance(0, 1)"].values.tolist() == [5.0]
    assert table.columns["relativeHeading(0, 1)"].values.tolist() == [math.pi / 2]
    assert table.columns["smallestGap"].values[0] == pytest.approx(math.hypot(2, 3))  # the boxes are unit squares


def test_the_gap_between_boxes_is_what_shapely_measures():
    source = np.random.default_rng(3)
    one, other = ([*source.uniform(-5, 5, (2, 500)), source.uniform(-9, 9, 500), *source.uniform(0.1, 8, (2, 500))] for _ in range(2))
    one[0][0] = one[1][0] = other[0][0] = other[1][0] = one[2][0] = other[2][0] = 0.0
    one[3][0], one[4][0], other[3][0], other[4][0] = 8.0, 1.0, 1.0, 8.0  # a cross: no corner of either is in the other
    shapes = [[box_shape(Vector(x, y), turn, w, h) for x, y, turn, w, h in zip(*pose, strict=True)] for pose in (one, other)]
    expected = np.array([a.distance(b) for a, b in zip(*shapes, strict=True)])
    assert 50 < np.count_nonzero(expected) < 450
    assert gap(one, other) == pytest.approx(expected, abs=1e-7)


# Power


LAWS = ([0.5, 0.5, 0.0], [1 / 3] * 3, [0.4999, 0.4999, 0.0001, 0.0001], [0.1] * 10, [0.7, 0.1, 0.1, 0.05, 0.05], [0.95, 0.05])


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("tv", [0.2, 0.05, 0.01])
@pytest.mark.parametrize("law", LAWS, ids=str)
def test_the_stated_power_is_reached(law: list[float], tv: float, exact: bool):
    """The hardest difference, and others: 200 times each, where more than 12 misses have probability below 1e-6 at power 0.99."""
    features, alpha, p = 30, 1e-6, np.array(law)
    hardest = Hardest([p], exact=exact)
    n = required_draws(tv, alpha, features, hardest)
    source = np.random.Generator(np.random.Philox(9))
    known = p > 0
    size = int(known.sum())
    order = np.argsort(-p[known], kind="stable")
    worst = np.zeros((2, size))
    worst[:, order] = (hardest.tilted(tv if exact else tv / 2)[0, :size], hardest.tilted(0 if exact else -tv / 2)[0, :size])
    one = worst[1].copy()  # all of the difference between the two most frequent cells
    first, second = order[:2]
    moved = min(tv, worst[1][first] - 1e-12)
    one[first] -= moved
    one[second] += moved
    cases = [worst[0]] + ([one] if moved == tv else [])
    for q in cases:
        counts = np.zeros((200, len(p)))
        counts[:, known] = source.multinomial(n, q, size=200)
        if exact:
            wealth = one_sample_wealth(counts, np.tile(p, (200, 1)))
        else:
            others = np.zeros((200, len(p)))
            others[:, known] = source.multinomial(n, worst[1], size=200)
            wealth = two_sample_wealth(counts, others)
        misses = int(np.sum(wealth - math.log(features) < -math.log(alpha)))
        assert misses <= 12, (misses, n)
    assert detectable(n, alpha, features, hardest) == pytest.approx(tv, rel=0.03)


# Verdicts


def table(seed: int, n: int, *, shift: float = 0.0, coupled: bool = False) -> FeatureTable:
    x, y, h = numbers(seed, n), numbers(seed + 1, n), math.pi * (2 * numbers(seed + 2, n) - 1)
    return FeatureTable({"x": x + shift * (x < shift), "y": x if coupled else y, "objects[0].heading": h}, n)


def test_samples_of_one_distribution_are_equivalent_within_the_stated_power():
    verdict = compare(table(1, 40_000), table(11, 40_000), detect_tv=0.06)
    assert verdict.kind == "equivalent"
    assert verdict.n <= 40_000
    assert verdict.detectable <= 0.06


def test_too_few_scenes_are_inconclusive_and_say_how_many_are_needed():
    verdict = compare(table(1, 2_000), table(11, 2_000), detect_tv=0.01)
    assert verdict.kind == "inconclusive"
    assert verdict.needed > 100_000
    assert verdict.enough == verdict.needed + 4000
    assert f"some {verdict.enough:,} samples are needed" in str(verdict)


def test_a_dependence_that_no_marginal_shows_is_found_in_the_pair():
    verdict = compare(table(1, 3_000), table(11, 3_000, coupled=True))
    assert verdict.kind == "different"
    assert verdict.worst == "x & y"


def test_a_gap_at_the_end_of_a_range_is_found():
    verdict = compare(table(1, 40_000), table(11, 40_000, shift=0.02))
    assert (verdict.kind, verdict.worst) == ("different", "x")


def test_headings_are_compared_modulo_a_turn():
    one, other = table(1, 3_000), table(11, 3_000)
    columns = {name: column.values for name, column in other.columns.items()}
    turned = FeatureTable({**columns, "objects[0].heading": columns["objects[0].heading"] % math.tau}, 3_000)
    assert compare(one, turned).kind == "inconclusive"


def test_constants_are_compared_exactly():
    one = FeatureTable({"x": np.append(np.full(999, 2.0), 2.1)}, 1000)
    verdict = compare(one, FeatureTable({"x": np.full(1000, 2.0)}, 1000), facts=Facts({"x": 2.0}))
    assert verdict.kind == "different"
    assert "2.1 in sample 1000" in str(verdict)
    assert compare(one, FeatureTable({"x": np.full(1000, 2.0)}, 1000)).kind == "inconclusive"


def test_features_of_one_side_only_are_listed():
    one = FeatureTable({"x": numbers(1, 500), "y": numbers(2, 500)}, 500)
    verdict = compare(one, FeatureTable({"x": numbers(3, 500)}, 500))
    assert verdict.skipped == ("y",)
    assert "not compared, since only one side has them: y" in str(verdict)


def test_an_exact_law_needs_half_the_scenes_and_no_first_block():
    program = "x = Uniform(1, 2)\ny = Uniform(1, 2, 3)\nrequire x <= y\nego = Object with v (x, y)\n"
    scenario, law = scenic_ref.loads(program), scenic_ref.loads(program).enumerate()
    verdict = compare(list(scenario.sample_many(2000)), law, detect_tv=0.15)
    assert (verdict.kind, verdict.burned, verdict.exact) == ("equivalent", 0, True)
    rival = scenic_ref.loads(program.replace("Uniform(1, 2, 3)", "Uniform(1, 2, 3, 3)"))
    assert compare(list(rival.sample_many(2000)), law).kind == "different"


def test_laws_in_closed_form_are_exact_laws():
    scenes = list(scenic_ref.loads("x = Range(0, 1)\nego = Object with v x, with w Uniform(1, 2)\n").sample_many(1500))
    name, other = "objects[0].properties.v", "objects[0].properties.w"
    right = {name: UNIFORM, other: Categorical({1.0: 0.5, 2.0: 0.5})}
    assert compare(scenes, right, detect_tv=0.2).kind == "equivalent"
    verdict = compare(scenes, {**right, name: Continuous("square", lambda x: min(max(x, 0.0), 1.0) ** 2)})
    assert (verdict.kind, verdict.worst) == ("different", name)
    with pytest.raises(UsageError):
        compare(scenes, {"objects[7].heading": UNIFORM})


def test_a_scenario_knows_its_constants():
    wrong = [scenic_ref.loads("ego = Object with v Uniform(1, 2), with width 3\n").sample(7, k).to_json() for k in range(300)]
    verdict = compare(wrong, scenic_ref.loads("ego = Object with v Uniform(1, 2)\n"))
    assert verdict.kind == "different"
    assert "objects[0].width is always 1, but 3 in sample 1" in str(verdict)


def test_a_verdict_can_be_replayed():
    scenario = scenic_ref.loads("ego = Object with v Range(0, 1)\n")
    verdict = compare(scenario, scenario, budget=300, seeds=(3, 4))
    assert verdict.seeds == (3, 4)
    assert verdict.replay == "compare(a, b, alpha=1e-09, detect_tv=0.01, budget=300, seeds=(3, 4))"
    assert compare(scenario, scenario, budget=300, seeds=(3, 4)) == verdict


def test_a_value_outside_the_exact_support_is_found_at_once():
    law = scenic_ref.loads("ego = Object with v Uniform(1, 2)\n").enumerate()
    rival = scenic_ref.loads("ego = Object with v Uniform(1, 2, 3)\n")
    assert compare(list(rival.sample_many(20)), law).kind == "different"


@pytest.mark.slow
def test_a_kernel_that_keeps_the_distribution_passes_and_one_that_does_not_is_found():
    scenario = scenic_ref.loads("ego = Object with v Uniform(1, 2, 3)\n")

    def stays(scene, seed):
        return scene

    def redraws(scene, seed):
        return scenario.sample(5, seed)

    def drifts(scene, seed):
        found = scenario.sample(5, seed)
        return found if found.ego["v"] > scene.ego["v"] else scene

    assert compare_invariance(scenario, stays, 2, budget=1000).kind == "inconclusive"
    assert compare_invariance(scenario, redraws, 2, budget=1000).kind == "inconclusive"
    assert compare_invariance(scenario, drifts, 2, budget=1000).kind == "different"


@pytest.mark.parametrize("wrong", [{"alpha": 0.0}, {"alpha": 2.0}, {"detect_tv": 0.0}, {"budget": 0}])
def test_settings_that_are_none_are_refused(wrong):
    with pytest.raises(UsageError):
        compare(table(1, 500), table(2, 500), **wrong)


@pytest.mark.parametrize("n", [1, 2, 50])
def test_few_scenes_are_inconclusive_but_one_wrong_value_is_still_a_proof(n):
    assert compare(table(1, n), table(2, n)).kind == "inconclusive"
    assert compare(FeatureTable({"x": np.ones(n)}, n), table(2, n), facts=Facts({"x": 2.0})).kind == "different"


def test_no_scenes_are_refused():
    with pytest.raises(UsageError):
        compare(table(1, 0), table(2, 50))


def test_the_order_of_the_scenes_does_not_matter():
    one = table(1, 4_000)
    order = np.argsort(one.columns["x"].values)
    by_x = FeatureTable({name: column.values[order] for name, column in one.columns.items()}, 4_000)
    assert compare(by_x, table(11, 4_000)).kind == "inconclusive"
    law = {"x": UNIFORM}
    assert compare(by_x, law).kind == "inconclusive"


def test_probabilities_that_do_not_quite_add_up_to_one_are_no_evidence():
    assert math.isfinite(float(one_sample_wealth(np.array([100, 0]), np.array([1 - 2**-53, 0]))))
    program = "x = Discrete({5: 2, 10: 3, 20: 1})\ny = Uniform(1, 2, 3)\nego = Object at (0, 0), with v x, with w y\n"
    program += "Object ahead of ego by x, with length Uniform(4, 12)\nrequire y < 3 or x > 5\n"
    scenario = scenic_ref.loads(program)
    assert compare(list(scenario.sample_many(400)), scenario.enumerate()).kind == "inconclusive"


def test_an_impossible_value_is_named_with_its_sample():
    law = scenic_ref.loads("ego = Object with v Uniform('sun', 'rain')\n").enumerate()
    scenes = [scenic_ref.loads("ego = Object with v 'hail'\n").sample()]
    assert "objects[0].properties.v is hail in sample 1, which has probability 0" in str(compare(scenes, law))


def test_nothing_is_tested_against_an_approximation():
    approximation = scenic_ref.loads("ego = Object with v Range(0, 1)\n").enumerate(discretize=4)
    with pytest.raises(UsageError):
        compare([scenic_ref.loads("ego = Object with v Range(0, 1)\n").sample()], approximation)


# What is no number in a feature that is one


def test_one_text_among_numbers_hides_no_difference():
    source = np.random.default_rng(8)
    right = [{"params": {"t": float(v)}, "objects": []} for v in source.uniform(0, 1, 2000)]
    wrong = [{"params": {"t": float(v)}, "objects": []} for v in source.uniform(0, 0.5, 2000)]
    assert compare(wrong, right).kind == "different"
    wrong[700] = {"params": {"t": "noon"}, "objects": []}
    assert compare(wrong, right).kind == "different"
    texts = [{"params": {"t": str(v)}, "objects": []} for v in source.uniform(0, 1, 2000)]
    assert compare(texts, right).kind == "different"


def test_numbers_and_texts_that_a_program_chooses_among_are_compared():
    scenario = scenic_ref.loads("param t = Uniform(Range(0, 1), 'noon')\nego = Object with v Range(0, 1)\n")
    assert compare(list(scenario.sample_many(3000, 5)), scenario, detect_tv=0.2).kind == "equivalent"
    other = scenic_ref.loads("param t = Discrete({Range(0, 1): 1, 'noon': 2})\nego = Object with v Range(0, 1)\n")
    assert compare(list(other.sample_many(3000, 5)), scenario, detect_tv=0.2).kind == "different"


def test_features_of_objects_have_units_where_these_are_known():
    named = {
        "m": ["objects[3].position[1]", "objects[0].width", "distance(0, 1)", "smallestGap", "objects[0].properties.viewDistance"],
        "rad": ["objects[0].heading", "bearing(1, 0)", "relativeHeading(0, 2)", "objects[1].properties.viewAngle"],
        "m/s": ["objects[0].properties.speed", "objects[0].properties.velocity[1]"], "rad/s": ["objects[0].properties.angularSpeed"],
        "": ["attempts", "params.width", "params.time", "objects[0].properties.taste", "objects[0].class"],
    }  # fmt: skip
    assert {unit: [name for name in names if unit_of(name) != unit] for unit, names in named.items()} == {unit: [] for unit in named}
