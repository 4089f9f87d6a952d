"""`condition_on`: what is given of a scene, by every backend."""

from __future__ import annotations

import pickle
from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.kernel.errors import AttemptsExhausted, UsageError

PROGRAM = """
ego = Object at (Range(0, 1), 0)
x = Range(5, 9)
a = Object at (x, 0), with c Uniform(1, 2)
b = Object left of a by Range(1, 2), with allowCollisions True
param t = Uniform('day', 'night'), h = Range(0, 24), s = x + 1, d = a.c + 1
require a.position.x - ego.position.x > 5
mutate b
"""
SCENARIO = scenic_ref.loads(PROGRAM)
SCENE = SCENARIO.sample(3)
FINITE = scenic_ref.loads("""
x, y = Uniform(1, 2), Uniform(1, 2, 3)
ego = Object at (x, 0)
o = Object at (x + 2 * y, 0)
param p = y, q = x + y
require y >= x
""")


def test_the_given_objects_are_those_of_the_scene_and_the_others_are_drawn() -> None:
    given = SCENARIO.condition_on(SCENE, objects=(1,))
    for scenes in (list(given.sample_many(5)), list(given.sample_many(20, seed=1)), list(given.pruned().sample_many(12))):
        assert {s.objects[1].position for s in scenes} == {SCENE.objects[1].position}
        assert {s.objects[1]["c"] for s in scenes} == {SCENE.objects[1]["c"]}
        assert len({s.objects[0].position.x for s in scenes}) == len({s.objects[2].position.x for s in scenes}) == len(scenes)
        assert all(s.objects[1].position.x - s.objects[0].position.x > 5 for s in scenes)
    assert [s.to_json() for s in given.sample_many(12, backend="interpreter")] == [s.to_json() for s in given.sample_many(12, backend="batch")]


def test_all_of_a_scene_makes_the_same_objects() -> None:
    again = SCENARIO.condition_on(SCENE).sample(8)
    assert [o.to_json() for o in again.objects] == [o.to_json() for o in SCENE.objects]
    assert again.params == SCENE.params


def test_the_law_is_the_conditional_one() -> None:
    def law(scenario: scenic_ref.Scenario) -> dict[tuple[object, object], Fraction]:
        return scenario.enumerate().law(lambda s: (s.params["p"], s.params["q"]))  # type: ignore[return-value]

    whole = law(FINITE)
    assert sum(whole.values()) == 1
    for params, kept in (({"p": 2}, lambda p, q: p == 2), ({"q": 4}, lambda p, q: q == 4), ({"p": 3, "q": 4}, lambda p, q: (p, q) == (3, 4))):
        part = {pq: probability for pq, probability in whole.items() if kept(*pq)}
        assert law(FINITE.condition_on(params=params)) == {pq: probability / sum(part.values()) for pq, probability in part.items()}


def test_parameters_that_are_draws_are_given_without_rejection() -> None:
    given = SCENARIO.condition_on(params={"h": 3.5, "t": "day"})
    assert {(s.params["h"], s.params["t"]) for s in given.sample_many(20)} == {(3.5, "day")}
    both = given.condition_on(params={"d": 2})
    scenes = list(both.sample_many(30))
    assert {(s.params["h"], s.params["d"], s.objects[1]["c"]) for s in scenes} == {(3.5, 2, 1)}


@pytest.mark.parametrize(
    "arguments, said",
    [
        ({"params": {"zz": 1}}, "there is no global parameter 'zz'"),
        ({"params": {"t": "dusk"}}, "cannot be 'dusk'"),
        ({"params": {"h": 30}}, "cannot be 30"),
        ({"scene": SCENE, "objects": (7,)}, "there is no object 7"),
        ({"scene": FINITE.sample(1)}, "not a scene"),
    ],
)
def test_what_cannot_be_given_is_an_error(arguments: dict, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        SCENARIO.condition_on(**arguments)


def test_single_objects_need_a_graph() -> None:
    printed = scenic_ref.loads("ego = Object at (Range(0, 1), 0)\nprint(ego)")
    with pytest.raises(UsageError, match="on which draws"):
        printed.condition_on(printed.sample(), objects=(0,))
    assert printed.condition_on(printed.sample()).sample(5).ego.position == printed.sample().ego.position


def test_a_parameter_whose_distribution_depends_on_draws_tells_about_them() -> None:
    """2 is likelier from the shorter list; to give the draw its value, whatever the list, would leave both equally likely: 1/2."""
    text = "x = Uniform([1, 2], [2, 3, 4])\nego = Object at (0, 0)\nparam t = Uniform(*x), n = len(x)"
    given = scenic_ref.loads(text).condition_on(params={"t": 2})
    assert given.enumerate().law(lambda s: s.params["n"]) == {2: Fraction(3, 5), 3: Fraction(2, 5)}
    nested = scenic_ref.loads("x = Uniform(1, 2)\nego = Object at (x, 0)\nparam t = Uniform(x, 2)")
    assert nested.condition_on(params={"t": 2}).enumerate().law(lambda s: s.ego.position.x) == {1: Fraction(1, 3), 2: Fraction(2, 3)}
    with pytest.raises(UsageError, match="depends on other draws"):
        scenic_ref.loads("x = Range(0, 1)\nego = Object at (x, 0)\nparam t = Range(0, x)").condition_on(params={"t": 0.5})


def test_a_choice_of_objects_is_given_as_that_of_each_run() -> None:
    objects = "ego = Object at (0, 0)\nb = Object at (Range(5, 9), 0)\nany = Uniform(ego, b)\n"
    chosen = scenic_ref.loads(objects + "param same = any is b, x = any.position.x")
    scene = chosen.sample(2)
    assert all(s.params == scene.params for s in chosen.condition_on(scene).sample_many(3))


def test_a_parameter_that_hardly_ever_has_the_value_is_named() -> None:
    scenario = scenic_ref.loads("param a = Range(0, 1)\nparam b = globalParameters.a + 1\nego = Object\n")
    with pytest.raises(AttemptsExhausted, match="that the parameter b has the value that is given"):
        scenario.condition_on(params={"b": 1.5}).sample(max_attempts=9)


def test_a_pickled_scene_can_be_given() -> None:
    scene = pickle.loads(pickle.dumps(SCENE))
    assert SCENARIO.condition_on(scene).sample(8).params == SCENE.params
    assert SCENARIO.condition_on(scene, objects=(1,)).sample(8).objects[1].position == SCENE.objects[1].position
