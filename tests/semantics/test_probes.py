"""Every probe under every alternative: the exact value, the exact probability, or the class of error that it must show."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations

import pytest
import scenic_ref
from scenic_ref.data.scene import Scene
from scenic_ref.inference.comparison import Categorical, contradicts
from scenic_ref.semantics.machine.outcome import Requirement
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store import errors
from scipy.stats import norm


def Φ(u: float) -> float:
    """The distribution function of the standard normal."""
    return float(norm.cdf(u))



@dataclass(frozen=True)
class Gives:
    """In each of some scenes, `observe(scene)` equals `expected`, numbers to 1e-12."""

    expected: object
    observe: Callable[[Scene], object] = lambda scene: list(scene.params.values())
    scenes: int = 5


@dataclass(frozen=True)
class Chance:
    """P(event) = p exactly; `rivals` are the probabilities under readings that the machine does not implement.

    About `runs` runs of the machine are made, where a scene takes `attempts` of them on average.
    """

    p: float
    event: Callable[[Scene], bool]
    rivals: tuple[float, ...] = ()
    attempts: float = 1.0
    runs: int = 5_000
    always: Callable[[Scene], bool] = lambda scene: True

    @property
    def scenes(self) -> int:
        """How many scenes are drawn."""
        return int(self.runs / self.attempts)


@dataclass(frozen=True)
class Fails:
    """The program stops with an error of that class, from the rule."""

    error: type[errors.ScenicError]
    rule: str = ""


@dataclass(frozen=True)
class Stuck:
    """Every attempt gets stuck at one requirement of that kind."""

    kind: str


Expectation = Gives | Chance | Fails | Stuck


def ego(name: str) -> Callable[[Scene], object]:
    return lambda scene: scene.ego[name]


def x_of(scene: Scene) -> float:
    return scene.ego.position.x


def positions(scene: Scene) -> list[Vector]:
    return [o.position for o in scene.objects]


def area(u: float) -> float:
    """An antiderivative of Φ."""
    return u * Φ(u) + float(norm.pdf(u))


def inside(a: float, b: float) -> float:
    """The integral over y from a to b of P(|y + n| <= 1.5) for a standard normal n."""
    return (area(1.5 - a) - area(1.5 - b)) - (area(-1.5 - a) - area(-1.5 - b))


EXPECTED: Mapping[str, Mapping[str, Expectation]] = {
    # conflicts
    "soft": {
        "run": Chance(0.1 / 0.55, lambda s: s.ego["v"] < 0.1, attempts=1 / 0.55, runs=20_000),  # type: ignore[operator]
        "scene": Chance(0.55, lambda s: s.ego["v"] < 0.1, attempts=5.5, runs=20_000),  # type: ignore[operator]
    },
    "require-time": {
        "statement": Chance(0.5, lambda s: x_of(s) < 0, runs=20_000),
        "end": Chance(0.5 / Φ(1), lambda s: x_of(s) < 0, attempts=1 / Φ(1), runs=20_000, always=lambda s: x_of(s) < 1),
    },
    "object-order": {
        "creation": Gives([Vector(5, 5), Vector(0, 0)], lambda s: [o.position for o in s.objects]),
        "ego-first": Gives([Vector(0, 0), Vector(5, 5)], lambda s: [o.position for o in s.objects]),
    },
    "heading-property": {"raw": Gives([3.5]), "wrapped": Gives([3.5 - 2 * math.pi])},
    "random-length": {
        "value": Chance(
            1 / 2, lambda s: s.params["x"] == 4, rivals=(1 / 3,), attempts=1.5,
            always=lambda s: s.params["n"] == (1 if s.params["x"] == 4 else 2),
        ),
    },
    "offset-by": {"local": Gives([Vector(-5, 0)]), "global": Gives([Vector(0, 5)])},
    "oriented-offset": {"local": Gives([math.sqrt(50)]), "global": Gives([0])},
    "height": {"length": Gives([Vector(0, -2), Vector(9, -2), 4]), "own": Gives([Vector(0, -2), Vector(9, -0.5), 0])},
    "view-distance": {"viewDistance": Gives([5, True, False, 20, 20]), "own": Gives([5, True, True, 20, 50])},
    "mutate-color": {
        "no": Chance(0, lambda s: s.ego["color"] != (0.5, 0.5, 1), rivals=(1,)),
        "yes": Chance(Φ(-1), lambda s: s.ego["color"][0] == 0, rivals=(0,), always=lambda s: max(s.ego["color"]) <= 1),  # type: ignore[index, arg-type]
    },
    "mutate-scale": {"factor": Chance(2 * Φ(-1), lambda s: abs(s.ego.heading) > math.radians(10), rivals=(2 * Φ(-math.radians(10) / 2),))},
    "point-size": {"zero": Gives([Vector(2, 0)]), "error": Fails(errors.MissingProperty, "R-MissingProperty")},
    "alg1-graph": {"specifiers": Gives([Vector(0, -1)])},
    "is-in": {"in": Gives([True, True, False, True])},
    "in-whole": {"whole": Gives([False, True, True])},
    "no-orientation": {"none": Gives([1.25])},
    "scene-objects": {"objects": Gives(1, lambda s: len(s.objects))},
    "nested-objects": {"kept": Gives([Vector(5, 0), Vector(0, 0)], positions)},
    "velocity": {"derived": Gives([Vector(-2, 0)])},
    "superclasses": {"python": Gives([3, 4])},
    "wide-views": {"sector": Gives([False, True])},
    "sees-box": {"box": Gives([True, False])},
    "oncoming-range": {"conditioned": Chance(5 / 10.5, lambda s: s.ego["y"] < 25, rivals=(1 / 4,), attempts=20 / 10.5)},  # type: ignore[operator]
    "distance-words": {"either": Gives([3 * math.sqrt(2), 3 * math.sqrt(2), 5, math.pi / 2])},
    "distance-region": {"nearest": Gives([8, 0])},
    "heading-scalar": {"scalar": Gives([math.pi / 2, True])},
    "import-names": {"dialect": Gives(["Rover", Vector(0, -2)], lambda s: [s.ego.class_name, s.ego.position])},
    # conflicts about the policy that the parser and the checks decide, and about pruning
    "setup-block": {"setup": Gives(1, lambda s: len(s.objects))},
    "override-place": {"scenario": Gives(1, lambda s: len(s.objects))},
    "take-in-monitor": {"ignored": Gives(1, lambda s: len(s.objects))},
    "monitor-structure": {"optional": Gives(1, lambda s: len(s.objects))},
    "prune-mutated": {
        "never": Chance(
            2 * inside(1.5, 2) / inside(-2, 2), lambda s: abs(s.ego["y"]) > 1.5, rivals=(0,),  # type: ignore[arg-type]
            attempts=4 / inside(-2, 2) / (2 * Φ(1.5) - 1),
        )
    },
    # silences
    "angle": {
        "heading": Gives([math.pi / 2, math.pi, -math.pi / 2, 0, 19 * math.pi / 9]),
        "wrapped": Gives([math.pi / 2, math.pi, -math.pi / 2, 0, math.pi / 9]),
    },
    "resample": {"remembered": Chance(0.5, lambda s: s.ego["gap"] < 0, rivals=(0,), always=lambda s: 0 <= s.ego["above"] <= 1)},  # type: ignore[operator]
    "resample-constant": {"point-mass": Gives([3]), "error": Fails(errors.RunError, "E-Resample")},
    "distance-past": {"local-y": Gives([5, -2, 3])},
    "can-see-vector": {"in-region": Gives([True, False, True, False])},
    "vector-relative": {"sum": Gives([Vector(2, 6), Vector(4, 6)])},
    "field-outside": {"stuck": Stuck("field")},
    "requirement-capture": {"values": Gives(1, lambda s: s.attempts)},
    "beside-object-by": {"from-side": Gives([Vector(-3, 0), Vector(0, 4)])},
    "optional-unknown": {"extend": Gives([1.5]), "ignore": Fails(errors.UncaughtException)},
    "field-dependency": {"position": Gives([1.25])},
    "follow": {"appendix": Gives([Vector(-3, 1), math.pi / 2])},
    "region-sampling": {"measure": Chance(1 / 4, lambda s: s.ego.position.y == 0, rivals=(1 / 2,))},
    "ego-of-modules": {"own": Gives([False])},
    "retraced-polyline": {"once": Chance(1 / 2, lambda s: s.ego.position.x > 1, rivals=(2 / 3,))},
    "visible-clip": {"no": Chance(1 / math.pi, lambda s: s.params["inside"] is True, rivals=(1,))},
    "region-contained": {
        "both": Chance(
            1 / 2, lambda s: s.objects[1]["x"] < 1, rivals=(1 / 4,), attempts=2, always=lambda s: s.objects[1]["x"] <= 2  # type: ignore[operator]
        )
    },
    "touching": {"collide": Stuck("collision"), "allow": Gives([Vector(0, 0), Vector(-1, 0)], positions)},
    "mutate-all": {"existing": Gives([2, 0], lambda s: [o["mutationScale"] for o in s.objects])},
    "mutate-copies": {"no": Gives([Vector(0, 0.5)])},
    "zero-stddev": {
        "point-mass": Gives([Vector(1, 2), math.radians(3), Vector(9, 9)], lambda s: [s.ego.position, s.ego.heading, s.objects[1].position])
    },
    "ego-late": {"error": Fails(errors.RunError, "E-Variable")},
    "no-ego": {"error": Fails(errors.RunError, "T-Mutate"), "allowed": Gives([None, 1], lambda s: [s.ego_id, len(s.objects)])},
    "ego-twice": {"last": Gives([Vector(0, 5), Vector(85, 0)])},
    "random-branch": {
        "error": Fails(errors.RandomBranch, "E-Branch"),
        "in-requirements": Chance(1 / 3, lambda s: s.ego["x"] == 3, rivals=(1 / 4, 1 / 2), attempts=4 / 3, always=lambda s: s.ego["x"] > 2),  # type: ignore[operator]
    },
    "boolean-random": {"short-circuit": Gives([True, 0]), "operator": Gives([True, 1])},
    "is-none": {"identity": Gives([2])},
    "default-arguments": {"definition": Gives([0, True], lambda s: [s.params["shared"], s.params["independent"] != 0])},
    "specifier-arguments": {"left-to-right": Gives([[(5, 5), 1, 2, 3]])},
    "bare-class": {"by-place": Gives([True, True, 1.5, True, 2], lambda s: [*s.params.values(), len(s.objects)])},
    "intervals": {
        "dialect": Gives([True, True, Vector(3, 4)], lambda s: [1 <= s.ego["x"] <= 2, s.ego["x"] != s.ego["y"], s.ego.position])  # type: ignore[operator]
    },
    "invalid-parameters": {
        "error": Fails(errors.RunError, "E-Distributions"),
        "stuck": Chance(1 / 2, lambda s: s.params["d"] == 1, rivals=(1 / 3,), attempts=1.5, always=lambda s: s.params["d"] > 0),  # type: ignore[operator]
    },
    "reversed-range": {"invalid": Fails(errors.RunError, "E-Distributions"), "either": Gives([True])},
    "pairs": {"vector": Gives([[4, 6], [2, 4]]), "tuple": Gives([[1, 2, 3, 4], [1, 2, 1, 2]])},
    "boundaries": {"tolerance": Gives([True, False])},
    "condition-truth": {
        "boolean": Fails(errors.RunError, "S-Require"),
        "any": Chance(1 / 2, lambda s: s.ego["x"] == 1, rivals=(1 / 3,), attempts=1.5, always=lambda s: s.ego["x"] != 0),
    },
    "set-order": {"insertion": Gives([["pear", "apple", "plum"]])}, "workspace-value": {"region": Gives([0])},
    "combined-orientation": {"first": Gives([0.5])},
    "point-set": {"once": Chance(1 / 2, lambda s: s.ego.position.x == 4, rivals=(1 / 4,))},
    "offset-amounts": {"table": Fails(errors.RunError, "P-Beyond"), "either": Gives([Vector(6, 8)], lambda s: [s.objects[1].position])},
    "model-params": {
        alternative: Gives(alternative == "keep", lambda s: s.params["weather"] == "HAIL OF STONES") for alternative in ("assign", "keep")
    },
    "always-in-scenes": {"ignored": Chance(1 / 2, lambda s: s.ego["x"] == 2, rivals=(1,)), "required": Gives(2, lambda s: s.ego["x"])},
    "offset-heading": {"none": Gives([0]), "ego": Gives([math.pi / 2])},
    "distance-method": {"position": Gives([[5, 5, 5, 5]]), "box": Gives([[4, 3, 3, 5]])},
    "only-scenario": {"named": Fails(errors.RunError, "T-Mutate"), "begins": Gives([Vector(1, 2)], positions)},
    "time-unit": {"seconds": Gives([15, 3]), "steps": Gives([15, 3])},
}

UNDECIDED = {"time-unit"}
"""Readings whose alternatives differ only in behaviors: their probes show what they agree on."""

CASES = [(name, alternative) for name, cases in EXPECTED.items() for alternative in cases]


def event_of(p: float) -> Categorical:
    """An event of probability p."""
    return Categorical({True: p, False: 1 - p})


def close(found: object, expected: object) -> bool:
    """Equality, numbers to 1e-12, inside vectors and lists as well."""
    match expected:
        case bool() | str() | None:
            return found is expected or found == expected
        case int() | float():
            return isinstance(found, (int, float)) and abs(found - expected) <= 1e-12
        case Vector(x=x, y=y):
            return isinstance(found, Vector) and close(found.x, x) and close(found.y, y)
        case list() | tuple():
            return isinstance(found, (list, tuple)) and len(found) == len(expected) and all(map(close, found, expected))
        case _:
            raise TypeError(type(expected))


def load(name: str, alternative: str) -> scenic_ref.Scenario:
    probe = READINGS[name].probe
    assert probe is not None
    return scenic_ref.loads(probe.program, readings={name: alternative})


def error_of(program: str, readings: Mapping[str, str] | None = None) -> errors.ScenicError:
    with pytest.raises(errors.ScenicError) as caught:
        scenic_ref.loads(program, readings=readings).sample(max_attempts=20)
    return caught.value


def test_every_reading_of_the_scene_has_an_expectation_for_every_alternative() -> None:
    for name, reading in READINGS.items():
        if reading.about == "scene":
            assert list(EXPECTED[name]) == list(reading.alternatives)
    assert set(EXPECTED) <= set(READINGS)


@pytest.mark.slow
@pytest.mark.parametrize("name, alternative", CASES, ids=[f"{n}={a}" for n, a in CASES])
def test_probe_shows_what_the_reading_says(name: str, alternative: str) -> None:
    expectation = EXPECTED[name][alternative]
    match expectation:
        case Gives(expected=expected, observe=observe, scenes=scenes):
            scenario = load(name, alternative)
            found = [observe(scenario.sample(1, index)) for index in range(scenes)]
            assert all(close(f, expected) for f in found), found
        case Fails(error=error, rule=rule):
            with pytest.raises(errors.ScenicError) as caught:
                load(name, alternative).sample()
            assert (type(caught.value), caught.value.rule) == (error, rule)
        case Stuck(kind=kind):
            with pytest.raises(errors.AttemptsExhausted) as exhausted:
                load(name, alternative).sample(max_attempts=20)
            (requirement, count), = exhausted.value.stuck
            assert isinstance(requirement, Requirement)
            assert (requirement.kind, count) == (kind, exhausted.value.attempts)  # every attempt, or the first if nothing is drawn
        case Chance():
            scenes = list(load(name, alternative).sample_many(expectation.scenes, seed=1))
            assert all(expectation.always(scene) for scene in scenes)
            found = [bool(expectation.event(scene)) for scene in scenes]
            assert not contradicts(found, event_of(expectation.p))
            others = [c for a, c in EXPECTED[name].items() if a != alternative and isinstance(c, Chance) and not expectation.rivals]
            rivals = [c.p for c in others] + list(expectation.rivals)
            assert rivals
            assert all(contradicts(found, event_of(p)) for p in rivals)


@pytest.mark.parametrize("name", [n for n, cases in EXPECTED.items() if len(cases) > 1 and n not in UNDECIDED])
def test_probe_tells_the_alternatives_apart(name: str) -> None:
    for first, second in combinations(EXPECTED[name].values(), 2):
        if isinstance(first, Chance) and isinstance(second, Chance):
            continue  # see below
        if isinstance(first, Gives) and isinstance(second, Gives):
            assert not close(first.expected, second.expected)
        else:
            assert first != second


# What the probes say besides


def test_the_soft_requirement_of_the_paper_holds_less_often_than_claimed() -> None:
    q, p = 0.1, 0.9
    assert q / (1 - p + p * q) == pytest.approx(0.1 / 0.19)
    assert q / (1 - p + p * q) < p < p + (1 - p) * q


def test_a_mutated_object_may_violate_a_requirement_made_before_mutation() -> None:
    scenario = scenic_ref.loads("ego = Object at (0, 0)\nmutate ego\nrequire ego.position.x < 1")
    scenes = list(scenario.sample_many(200, seed=2))
    assert max(x_of(s) for s in scenes) > 1
    assert {s.attempts for s in scenes} == {1}


def test_default_requirements_are_checked_after_mutation() -> None:
    program = "workspace = Workspace(RectangularRegion((0, 0), 0, 4, 4))\nego = Object at (0, 0)\nmutate ego by 2"
    scenes = list(scenic_ref.loads(program).sample_many(100, seed=2))
    assert all(abs(x_of(s)) <= 1.5 for s in scenes)
    assert max(s.attempts for s in scenes) > 1


def test_a_late_requirement_sees_the_values_of_its_statement() -> None:
    probe = READINGS["requirement-capture"].probe
    assert probe is not None
    for time in ("statement", "end"):
        scene = scenic_ref.loads(probe.program, readings={"require-time": time}).sample()
        assert (scene.attempts, scene.objects[0]["x"], scene.ego.position) == (1, 2, Vector(5, 0))


def test_a_late_requirement_that_fails_at_its_statement_stays_failed() -> None:
    error = error_of("x = 1\nego = Object at (0, 0)\nrequire x == 2\nx = 2", {"require-time": "end"})
    assert isinstance(error, errors.AttemptsExhausted)


@pytest.mark.parametrize("specifiers", ["with viewDistance 4, with visibleDistance 4", "with length 4, with height 4"])
def test_both_spellings_of_a_property_on_one_object_are_an_error(specifiers: str) -> None:
    assert error_of(f"ego = Object at (0, 0), {specifiers}").rule == "R-SpecifiedTwice"


@pytest.mark.parametrize("first, second", [("viewDistance", "visibleDistance"), ("length", "height")])
def test_both_spellings_of_a_property_in_one_class_are_an_error(first: str, second: str) -> None:
    assert isinstance(error_of(f"class C:\n    {first}: 4\n    {second}: 5\nego = C at (0, 0)"), errors.CheckError)


@pytest.mark.parametrize("order", ["left of (0, 0), with width 2, facing 90 deg", "facing 90 deg, with width 2, left of (0, 0)"])
def test_the_order_of_specifiers_does_not_matter(order: str) -> None:
    assert close(scenic_ref.loads(f"ego = Object {order}").sample().ego.position, Vector(0, -1))


FIELD = "F = VectorField('F', lambda p: p.x)\nego = Object at (0, 0)\n"


@pytest.mark.parametrize(
    "program, error, rule",
    [
        (FIELD + "Object left of (1, 5), facing 0.25 relative to F", errors.CyclicDependencies, "R-Cyclic"),
        (FIELD + "param x = 0.25 relative to F", errors.NeedsPosition, "O-RelativeTo-HeadingField"),
        ("ego = Object at (0, 0)\nx = Range(0, 1) + 1\ny = resample(x)", errors.RunError, "E-Resample"),
        ("ego = Object at (0, 0)\nx = Uniform(1, None)\ny = 1 if x is None else 2", errors.RandomBranch, "E-Branch"),
        ("Object at (0, 0)", errors.RunError, "T-Mutate"),
        ("ego = Object at (0, 0), with x self.width", errors.RunError, "E-Variable"),
        ("import mars\nego = Rover at (0, 0)", errors.RunError, "E-Variable"),
        ("ego = Object at (0, 0)\nscenario S():\n    start:\n        Object", errors.ParseError, ""),
        ("ego = Object at (0, 0)\nbehavior B():\n    override ego with x 3", errors.CheckError, ""),
        ("ego = Object at (0, 0)\nmonitor M:\n    override ego with x 3", errors.CheckError, ""),
        ("model scenic.simulators.gta.model\nego = Car\nego.x = roadDirection relative to 3", errors.NeedsPosition, "O-RelativeTo-HeadingField"),
    ],
)
def test_what_the_readings_forbid_is_an_error_of_its_rule(program: str, error: type[errors.ScenicError], rule: str) -> None:
    found = error_of(program)
    assert (type(found), found.rule) == (error, rule)


def test_a_random_branch_is_found_whatever_is_drawn() -> None:
    program = "ego = Object at (0, 0)\nx = Range(0, 1)\nrequire x > 2\ny = 1 if x > 5 else 2"
    assert isinstance(error_of(program), errors.RandomBranch)


def test_an_empty_region_makes_the_run_stuck() -> None:
    error = error_of("ego = Object at (0, 0)\nObject in nowhere")
    assert isinstance(error, errors.AttemptsExhausted)
    assert [r.kind for r, _ in error.stuck if isinstance(r, Requirement)] == ["region"]


def test_points_outside_a_field_are_counted_under_one_requirement() -> None:
    program = "from scenic.simulators.gta.map import roadDirection\nx = Range(1, 2)\nego = Object at (0, 0)\ny = roadDirection at (x * 1e7, 0)"
    error = error_of(program)
    assert isinstance(error, errors.AttemptsExhausted)
    assert [count for _, count in error.stuck] == [20]


def test_color_noise_scales_with_the_mutation_and_leaves_other_values_alone() -> None:
    def colors(program: str) -> list[object]:
        return [s.ego["color"] for s in scenic_ref.loads(program, readings={"mutate-color": "yes"}).sample_many(300, seed=3)]

    assert set(map(repr, colors("ego = Object at (0, 0), with color 'red'\nmutate"))) == {"'red'"}
    assert set(map(repr, colors("ego = Object at (0, 0), with color (0.5, 0.5, 0.5)"))) == {"(0.5, 0.5, 0.5)"}
    spread = [abs(c[0] - 0.5) for c in colors("ego = Object at (0, 0), with color (0.5, 0.5, 0.5)\nmutate by 2")]  # type: ignore[index]
    within = [d < 0.1 for d in spread]  # the deviation is 2 · 0.05
    assert not contradicts(within, event_of(2 * Φ(1) - 1))
    assert contradicts(within, event_of(2 * Φ(2) - 1))  # without the factor of `mutate by 2`
