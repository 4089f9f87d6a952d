"""Enumeration gives the exact distribution: probabilities worked out by hand, both readings of `soft`, limits and refusals."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.inference.comparison import Categorical, contradicts
from scenic_ref.inference.enumeration import content_of_scene, radical_inverse
from scenic_ref.semantics.store import errors

F = Fraction


def law(program: str, name: str = "r", **options):
    return scenic_ref.loads(program, **options).enumerate().law(lambda scene: scene.params[name])


def test_draws_multiply_and_equal_outcomes_add_up():
    assert law("x = Uniform(1, 2)\ny = Uniform(1, 2, 3)\nego = Object\nparam r = x + y\n") == {2: F(1, 6), 3: F(1, 3), 4: F(1, 3), 5: F(1, 6)}


def test_requirements_condition_and_renormalise():
    found = scenic_ref.loads("x = Uniform(1, 2, 3)\nrequire x > 1\nego = Object\nparam r = x\n").enumerate()
    assert found.law(lambda scene: scene.params["r"]) == {2: F(1, 2), 3: F(1, 2)}
    assert found.acceptance == F(2, 3)
    assert sum(found.stuck.values()) == F(1, 3)
    assert found.runs == 3


SOFT = "x = Uniform(1, 2, 3, 4)\nrequire[0.75] x == 1\nego = Object\nparam r = x\n"


def test_the_coin_of_a_soft_requirement_is_thrown_per_run():
    # heads (3/4): x = 1 in 1/4 of the runs; tails (1/4): any x. P(accepted) = 3/16 + 1/4 = 7/16; P(x = 1) = (3/16 + 1/16) / (7/16)
    assert law(SOFT) == {1: F(4, 7), 2: F(1, 7), 3: F(1, 7), 4: F(1, 7)}


def test_or_once_per_scene_under_the_other_reading():
    # heads: x = 1 for certain; tails: uniform. P(x = 1) = 3/4 + 1/4 * 1/4
    found = scenic_ref.loads(SOFT, readings={"soft": "scene"}).enumerate()
    assert found.law(lambda scene: scene.params["r"]) == {1: F(13, 16), 2: F(1, 16), 3: F(1, 16), 4: F(1, 16)}
    assert found.acceptance == F(3, 4) * F(1, 4) + F(1, 4)
    assert found.attempts_probability(2) == F(3, 4) * F(1, 4) * F(3, 4)


def test_two_coins_thrown_once_per_scene_have_a_rejection_loop_for_each_way_they_come_up():
    program = "x = Uniform(1, 2, 3)\nrequire[0.5] x > 1\nrequire[0.5] x > 2\nego = Object\nparam r = x\n"
    # neither: uniform; first only: 2 or 3; second, with or without the first: 3
    expected = {1: F(1, 4) * F(1, 3), 2: F(1, 4) * F(1, 3) + F(1, 4) * F(1, 2), 3: F(1, 4) * F(1, 3) + F(1, 4) * F(1, 2) + F(1, 2)}
    assert law(program, readings={"soft": "scene"}) == expected


def test_a_decimal_weight_is_the_decimal_fraction_that_is_written():
    assert law("x = Discrete({1: 0.1, 2: 0.2, 3: 0.7})\nego = Object\nparam r = x\n") == {1: F(1, 10), 2: F(1, 5), 3: F(7, 10)}


def test_distributions_of_distributions_and_objects_as_values():
    program = "a = Object at (0, 0)\nb = Object at (0, 9)\nego = Uniform(a, b)\nparam r = ego.position.y + resample(Uniform(0, Uniform(1, 2)))\n"
    # the inner draw is 1 or 2, the outer 0 or that; resample draws from the outer with its value kept
    assert law(program) == {0: F(1, 4), 1: F(1, 8), 2: F(1, 8), 9: F(1, 4), 10: F(1, 8), 11: F(1, 8)}


def test_default_requirements_count():
    found = scenic_ref.loads("ego = Object at (0, 0)\nObject at (Uniform(0, 1, 2, 3), 0)\n").enumerate()
    assert found.acceptance == F(1, 2)
    assert [scene.objects[1].position.x for scene in found.scenes] == [2, 3]


def test_attempts_are_geometric():
    found = scenic_ref.loads("x = Uniform(1, 2, 3)\nrequire x > 1\nego = Object\n").enumerate()
    assert [found.attempts_probability(k) for k in (1, 2, 3)] == [F(2, 3), F(2, 9), F(2, 27)]


def test_sampled_frequencies_agree_and_those_of_the_other_reading_do_not():
    def drawn(**readings: str) -> list[object]:
        return [scene.params["r"] for scene in scenic_ref.loads(SOFT, readings=readings).sample_many(2000, seed=3)]

    exact = Categorical(law(SOFT))
    assert not contradicts(drawn(), exact)
    assert contradicts(drawn(soft="scene"), exact)


def test_continuous_draws_are_refused_at_their_place():
    with pytest.raises(errors.UsageError) as caught:
        scenic_ref.loads("ego = Object\nx = Range(0, 1)\n").enumerate()
    assert (caught.value.span.line, caught.value.span.column) == (2, 5)


def test_discretized_draws_are_quantiles_and_say_so():
    found = scenic_ref.loads("ego = Object\nparam r = Range(0, 4)\n").enumerate(discretize=4)
    assert found.discretized == 4
    assert found.law(lambda scene: scene.params["r"]) == {0.5: F(1, 4), 1.5: F(1, 4), 2.5: F(1, 4), 3.5: F(1, 4)}
    assert found.to_json()["exact"] is False


def test_a_finite_program_stays_exact_when_discretizing_is_allowed():
    assert scenic_ref.loads("ego = Object\nparam r = Uniform(1, 2)\n").enumerate(discretize=4).discretized is None


def test_discretized_points_fill_a_region_evenly():
    found = scenic_ref.loads("ego = Object in RectangularRegion((0, 0), 0, 2, 2)\n").enumerate(discretize=256)
    quarter = sum(p for p, scene in found.outcomes if scene.ego.position.x < 0 and scene.ego.position.y < 0)
    assert abs(float(quarter) - 0.25) < 0.03


def test_the_radical_inverse_mirrors_digits():
    assert [radical_inverse(i, 2) for i in range(4)] == [0, 0.5, 0.25, 0.75]


def test_too_many_runs_end_with_the_size_reached():
    program = "for i in range(30):\n    x = Uniform(1, 2)\nego = Object\n"
    with pytest.raises(errors.RunsExhausted) as caught:
        scenic_ref.loads(program).enumerate(max_runs=64)
    assert (caught.value.runs, caught.value.covered) == (64, F(64, 2**30))
    assert caught.value.exit_code == 3


def test_exactly_the_allowed_number_of_runs_is_no_error():
    assert scenic_ref.loads("x = Uniform(1, 2, 3, 4)\nego = Object\n").enumerate(max_runs=4).runs == 4


def test_an_infeasible_program_names_its_requirement():
    with pytest.raises(errors.AttemptsExhausted) as caught:
        scenic_ref.loads("x = Uniform(1, 2)\nego = Object\nrequire x > 2\n").enumerate()
    assert caught.value.span.line == 3


def test_an_error_of_one_branch_is_the_error_of_the_program():
    with pytest.raises(errors.UncaughtException):
        scenic_ref.loads("x = Uniform(1, 0)\nego = Object with v 1 / x\n").enumerate()


def test_the_json_can_be_read_back():
    found = json.loads(json.dumps(scenic_ref.loads("ego = Object\nparam r = Uniform(1, 2)\n").enumerate().to_json()))
    assert found["schema"] == "scenic-ref/enumeration/1"
    assert [o["probability"] for o in found["outcomes"]] == ["1/2", "1/2"]


CHANGED = {
    "list": ("L = []", "L.append(x)", "L"), "deque": ("from collections import deque\nQ = deque([])", "Q.append(x)", "Q"),
    "counter": ("from collections import Counter\nC = Counter()", "C['n'] += 1", "C"), "nested": ("D = {'a': ([],)}", "D['a'][0].append(x)", "D"),
    "set": ("S = {1}", "S.add(9)", "S"),
}  # fmt: skip


@pytest.mark.parametrize("kind", CHANGED)
def test_what_a_run_changes_does_not_change_the_scenes_of_others(kind: str):
    before, change, value = CHANGED[kind]
    program = scenic_ref.loads(f"{before}\nx = Uniform(1, 2, 3)\nego = Object at (x, 0), with value {value}\n{change}\nparam value = {value}\n")
    enumerated = {content_of_scene(scene) for scene in program.enumerate().scenes}
    assert enumerated == {content_of_scene(program.sample(seed)) for seed in range(60)}
    assert len(enumerated) == 3
