"""`condition_on`: what is given of a scene, by every backend."""

from __future__ import annotations

import math
import pickle
from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.semantics.machine.outcome import KnownDraw
from scenic_ref.semantics.space.distributions import Range, Uniform
from scenic_ref.semantics.store.errors import AttemptsExhausted, UsageError

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
        ({"scene": SCENE, "objects": 0}, "by their numbers"),
        ({"scene": FINITE.sample(1)}, "not a scene"),
        ({"scene": 3}, "`scene` is a scene that this scenario gave, not 3"),
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
    with pytest.raises(AttemptsExhausted, match=r"the parameter b is 1\.5, as is given"):
        scenario.condition_on(params={"b": 1.5}).sample(max_attempts=9)


def test_a_pickled_scene_can_be_given() -> None:
    scene = pickle.loads(pickle.dumps(SCENE))
    assert SCENARIO.condition_on(scene).sample(8).params == SCENE.params
    assert SCENARIO.condition_on(scene, objects=(1,)).sample(8).objects[1].position == SCENE.objects[1].position


SOFT = "x, y = Uniform(0, 1), Uniform(0, 1)\nego = Object at (0, 0)\nrequire[0.5] x + y == 2\nparam x = x, y = y"


def test_coins_of_runs_are_conditioned_and_those_of_scenes_refused() -> None:
    """Of four equally likely runs one is accepted for sure and three with their coin: P(x = 1) = 3/5, and P(y = 1 | x = 1) = 2/3."""
    given = scenic_ref.loads(SOFT).condition_on(params={"x": 1})
    assert given.enumerate().law(lambda s: s.params["y"]) == {0: Fraction(1, 3), 1: Fraction(2, 3)}
    with pytest.raises(UsageError, match="rates at which runs are accepted") as refused:
        scenic_ref.loads(SOFT, readings={"soft": "scene"}).condition_on(params={"x": 1})
    assert refused.value.span.line == 3
    hard = scenic_ref.loads(SOFT.replace("[0.5]", ""), readings={"soft": "scene"})
    assert hard.condition_on(params={"x": 1}).enumerate().law(lambda s: s.params["y"]) == {1: 1}


@pytest.mark.parametrize(
    "text",
    [
        "scenario Main():\n    setup:\n        x, y = Uniform(1, 2), Uniform(1, 2)\n        ego = Object at (x, 0)\n        param q = x + y, x = x\n",
        "x, y = Uniform(1, 2), Uniform(1, 2)\nglobalParameters = 3\nego = Object at (x, 0)\nparam q = x + y, x = x\nq = 4",
    ],
)
def test_parameters_are_checked_at_the_end_of_a_run_whatever_the_program_calls_things(text: str) -> None:
    given = scenic_ref.loads(text).condition_on(params={"q": 3})
    assert given.enumerate().law(lambda s: (s.params["x"], s.params["q"])) == {(1, 3): Fraction(1, 2), (2, 3): Fraction(1, 2)}
    assert given.not_lifted is None
    by_columns, by_runs = (list(given.sample_many(20, backend=backend)) for backend in ("batch", "interpreter"))
    assert [s.to_json() for s in by_columns] == [s.to_json() for s in by_runs]
    assert {s.params["x"] for s in by_runs} == {1, 2}


LINE = scenic_ref.loads("u = Range(0, 1)\nego = Object at (u, 0)\nparam u = u, again = u, twice = 2 * u, fixed = 7", params={"outside": (1, 2)})
ON_LINE = LINE.sample(1)


@pytest.mark.parametrize(
    "arguments, said",
    [
        ({"scene": ON_LINE, "params": {"u": 0.5}}, "contradicts itself: the parameter u is"),
        ({"scene": ON_LINE, "objects": (0,), "params": {"u": 0.5}}, "contradicts itself: the same draw"),
        ({"scene": ON_LINE, "objects": (0,), "params": {"twice": 0.5}}, "it is not so that the parameter twice is 0.5"),
        ({"params": {"u": 0.2, "again": 0.3}}, "contradicts itself"),
        ({"params": {"u": math.nan}}, "cannot be nan"),
        ({"params": {"twice": math.nan}}, "cannot be nan"),
        ({"params": {"u": "far"}}, "cannot be 'far'"),
        ({"params": {"twice": 3}}, "it is not so that the parameter twice is 3"),
        ({"params": {"fixed": 8}}, "it is always 7"),
        ({"params": {"outside": (1, 3)}}, r"it is always \(1, 2\)"),
        ({"objects": (0,)}, "in which scene"),
    ],
)
def test_conditions_that_never_hold_are_errors(arguments: dict, said: str) -> None:
    with pytest.raises(UsageError, match=said) as refused:
        LINE.condition_on(**arguments)
    assert "line 0" not in str(refused.value)


def test_conditions_add_up() -> None:
    once = LINE.condition_on(params={"u": 0.5, "fixed": 7, "outside": (1, 2)})
    assert once.sample(3).params["twice"] == 1
    with pytest.raises(UsageError, match="contradicts itself"):
        once.condition_on(params={"u": 0.7})
    with pytest.raises(UsageError, match="contradicts itself"):
        once.condition_on(ON_LINE)
    assert LINE.condition_on(ON_LINE, objects=(0,)).condition_on(ON_LINE).sample(6).params == ON_LINE.params
    total = FINITE.condition_on(params={"q": 4})
    with pytest.raises(UsageError, match="the parameter q would be 4 and 5"):
        total.condition_on(params={"q": 5})
    assert total.condition_on(params={"q": 4.0, "p": 3}).enumerate().law(lambda s: s.params["p"]) == {3: 1}


def test_what_is_only_known_by_sampling_exhausts_the_attempts_and_says_what_failed() -> None:
    with pytest.raises(AttemptsExhausted, match=r"the parameter twice is 0\.7, as is given") as refused:
        LINE.condition_on(params={"twice": 0.7}).sample(max_attempts=9)
    assert "line" not in str(refused.value)


def test_a_scene_of_the_pruned_scenario_is_none_of_the_scenario() -> None:
    whole = scenic_ref.loads("workspace = Workspace(RectangularRegion((0, 0), 0, 9, 9))\nego = Object in workspace")
    scene = whole.pruned().sample(3)
    with pytest.raises(UsageError, match="not a scene"):
        whole.condition_on(scene)
    assert whole.pruned().condition_on(scene).sample(5).ego.position == scene.ego.position


def test_all_values_that_equal_the_given_one_stay_possible() -> None:
    given = scenic_ref.loads("ego = Object at (0, 0)\nparam u = Uniform(1, True, 2)").condition_on(params={"u": 1})
    assert [(p.probability, p.scene.params["u"]) for p in given.enumerate().outcomes] == [(Fraction(1, 2), 1), (Fraction(1, 2), True)]
    for backend in ("batch", "interpreter"):
        assert {repr(s.params["u"]) for s in given.sample_many(30, backend=backend)} == {"1", "True"}
    number = LINE.condition_on(params={"u": True}).sample()
    assert type(number.params["u"]) is float


def test_points_that_an_object_holds_stay_with_it() -> None:
    text = "ego = Object at (Range(0, 1), 0), with foo [OrientedPoint at (Range(0, 1), 2)]\nparam x = ego.foo[0].position.x, far = Range(0, 1)"
    holding = scenic_ref.loads(text)
    scene = holding.sample(4)
    others = [holding.condition_on(scene, objects=(0,)).sample(seed).params for seed in range(3)]
    assert {p["x"] for p in others} == {scene.params["x"]}
    assert len({p["far"] for p in others}) == 3


def test_a_draw_that_is_drawn_again_is_told_from_the_first() -> None:
    again = scenic_ref.loads("x = Range(0, 1)\ny = resample(x)\nego = Object at (x, y)\nparam x = x, y = y")
    for name, other in (("x", "y"), ("y", "x")):
        params = again.condition_on(params={name: 0.5}).sample(2).params
        assert params[name] == 0.5 != params[other]


def test_what_is_known_of_a_draw_is_its_value_where_there_are_no_places() -> None:
    """Another run may draw there from a distribution that has infinitely many values."""
    assert KnownDraw(3, (0,)).of(Range(0, 5)).support() == KnownDraw(3).of(Uniform((3, 4))).support() == ((3, Fraction(1)),)
    assert KnownDraw(3, (1,)).of(Uniform((3, 4))).support() == ((4, Fraction(1)),)
    assert KnownDraw(3, (0, 2)).of(Uniform((3, 4, 5))).support() == ((3, Fraction(1, 2)), (5, Fraction(1, 2)))


CHANGED = """
scenario Sub():
    setup:
        Object at (3, 3)
        param t = 5
    compose:
        wait
scenario Main():
    setup:
        ego = Object
        param t = Uniform(1, 2) + 1
    compose:
        do Sub()
"""


def test_a_parameter_is_given_of_the_scene_and_may_change_while_time_passes() -> None:
    runs = scenic_ref.loads(CHANGED).condition_on(params={"t": 3}).simulate(steps=3)
    assert runs.simulation.scene.params["t"] == 3
