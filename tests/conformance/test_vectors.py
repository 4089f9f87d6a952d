"""Every vector holds on ourselves, and together they cover rules, readings, syntax, properties, distributions and faults."""

from __future__ import annotations

import inspect
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import fields
from math import inf, log, sqrt
from statistics import mean, stdev

import pytest
from scenic_ref.conformance import ConformanceVector, Ourselves, judge, load_vectors
from scenic_ref.conformance.matchers import distributions
from scenic_ref.conformance.matchers.distributions import (
    THRESHOLD,
    Probabilities,
    QuantityLaw,
    QuantitySupport,
)
from scenic_ref.conformance.matchers.errors import REQUIREMENTS, Error, Rejection
from scenic_ref.conformance.matchers.simulations import Simulations
from scenic_ref.conformance.matchers.values import SceneValues
from scenic_ref.conformance.reports import UNREACHABLE, shows
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.python.builtins import CONSTRUCTORS
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.rules import RULES
from scenic_ref.semantics.store.built_in_classes import OBJECT_CLASS, ORIENTED_POINT_CLASS, POINT_CLASS
from scenic_ref.semantics.syntax import Node, expressions, python_expressions, specifiers, statements

VECTORS = load_vectors()
BY_NAME = {v.name: v for v in VECTORS}
OURSELVES = Ourselves()


LONG = {
    "reading-rejected-simulation-retry", "regions-far-in-the-south-west", "agents-and-monitors-draw-independently",
    "behaviors-at-a-time-draw-independently", "in-points-beside-a-draw-of-infinitely-many-values", "reading-oncoming-range",
    "conditions-over-time-draw-independently", "boxes-whose-corners-lie-on-an-arc", "edges-of-generators-exceptions-and-scopes",
    "scenarios-at-a-time-draw-independently", "points-between-numbers-that-are-drawn", "reading-soft-scene",
    "refused-a-default-that-makes-its-own-class-without-end", "a-line-in-a-narrow-sector", "areas-and-edges-left-of-combinations-with-arcs",
    "lines-through-regions-in-several-frames", "calls-one-after-another", "mutation-scale-at-random",
}  # fmt: skip
"""Those which take the machine more than a second."""


def takes_long(vector: ConformanceVector) -> bool:
    """Whether it is left to the slow tests; where a thousand scenes or more are drawn, the batch backend draws them in the quick ones."""
    return vector.name in LONG or (isinstance(vector.matcher, QuantityLaw) and vector.matcher.samples >= 1000)


@pytest.mark.parametrize("vector", [pytest.param(v, marks=pytest.mark.slow) if takes_long(v) else v for v in VECTORS], ids=lambda v: v.name)
def test_the_vector_holds_on_ourselves(vector: ConformanceVector) -> None:
    verdict = judge(OURSELVES, vector).verdict
    assert (verdict.status, verdict.reason) == ("passed", "")


SAMPLED = [v for v in VECTORS if isinstance(v.matcher, (QuantityLaw, QuantitySupport))]


@pytest.mark.parametrize("vector", SAMPLED, ids=lambda v: v.name)
def test_the_vector_holds_on_the_batch_backend(vector: ConformanceVector) -> None:
    verdict = judge(Ourselves.by_batch(), vector).verdict
    assert (verdict.status, verdict.reason) == ("passed", "")


def test_what_is_left_to_the_slow_tests_is_a_vector() -> None:
    assert set(BY_NAME) >= LONG


# A right implementation passes whatever its seed: its samples contradict the rival


@pytest.mark.parametrize("vector", [v for v in VECTORS if isinstance(v.matcher, (Probabilities, Simulations))], ids=lambda v: v.name)
def test_there_are_samples_enough_to_contradict_the_rival(vector: ConformanceVector) -> None:
    """The evidence that is expected lies five deviations above what is wanted: a right sampler fails a vector once in three million seeds."""
    matcher = vector.matcher
    assert isinstance(matcher, (Probabilities, Simulations))
    shares = [(float(p), float(q)) for p, q in zip(matcher.probabilities, matcher.rival, strict=True) if p]
    gain, square = expected_log_ratio(shares)
    learnt = log(matcher.samples) * (len(matcher.rival) - 1) / 2  # what a bet costs whose odds are learnt from the draws
    if gain == inf:  # one draw is enough of what the rival never gives
        assert sum(p for p, q in shares if q) ** matcher.samples <= 3e-7
    else:
        assert len(shares) == 1 or matcher.samples * gain - THRESHOLD * log(10) - learnt >= 5 * sqrt(matcher.samples * (square - gain**2))


def expected_log_ratio(shares: list[tuple[float, float]]) -> tuple[float, float]:
    """The mean of log(p / q) and of its square, for outcomes that have the probability p, and the rival's q."""
    ratios = [(p, log(p / q) if q else inf) for p, q in shares]
    return sum(p * ratio for p, ratio in ratios), sum(p * ratio**2 for p, ratio in ratios)


@pytest.mark.slow
@pytest.mark.parametrize("vector", [v for v in VECTORS if isinstance(v.matcher, QuantityLaw)], ids=lambda v: v.name)
def test_there_are_samples_enough_whatever_the_seed(vector: ConformanceVector, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of twelve seeds each passes, and the evidence against the rival lies four of its deviations above what is wanted."""
    found: list[float] = []
    monkeypatch.setattr(distributions, "told_apart", lambda against, against_rival, what: found.append(against_rival))
    backend = Ourselves.by_batch()
    assert {judge(backend, vector, seed=seed).verdict.status for seed in range(12)} == {"passed"}
    assert len(found) == 12
    assert min(found) == inf or mean(found) - THRESHOLD >= 4 * stdev(found)


# What the vectors cover, each of them holding by the test above


def test_there_are_at_least_300_vectors_and_no_two_say_the_same() -> None:
    said = Counter(
        (v.texts.get("paper") or tuple(v.texts.items()), tuple(sorted(v.files.items())), tuple(sorted(v.readings.items())), repr(v.matcher))
        for v in VECTORS
    )
    assert len(VECTORS) >= 300
    assert max(said.values()) == 1


def test_every_catalogued_rule_fires_or_refuses_a_program() -> None:
    """No program reaches the branch of Algorithm 1 that is left out: tests/semantics/test_resolution.py calls the algorithm itself."""
    assert set(RULES) - {rule for v in VECTORS for rule in shows(v)} == UNREACHABLE == {"R-SpecifiedTwiceOptionally"}


def test_every_alternative_of_every_reading_about_the_scene_has_a_vector() -> None:
    wanted = {(r.id, alternative) for r in READINGS.values() if r.about == "scene" for alternative in r.alternatives}
    assert wanted <= {pair for v in VECTORS for pair in v.readings.items()}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", [r.id for r in READINGS.values() if r.about == "scene" and len(r.alternatives) > 1])
def test_the_alternatives_of_a_reading_are_told_apart(name: str) -> None:
    """By a vector that fails when the other alternative is followed; the two of `time-unit` differ only while a simulation runs."""

    class Other(Ourselves):
        def scenes(self, task, count, *, seed, attempts):
            return super().scenes(swapped(task, name), count, seed=seed, attempts=min(attempts, 1000))

        def enumerated(self, task):
            return super().enumerated(swapped(task, name))

    told = [v for v in VECTORS if name in v.readings and judge(Other(), v).verdict.status == "failed"]
    assert bool(told) == (name != "time-unit")


def swapped(task, name: str):
    other = next(a for a in READINGS[name].alternatives if a != task.readings[name])
    return type(task)(task.program, task.dialect, {**task.readings, name: other})


def nodes(tree: object) -> Iterator[Node]:
    if isinstance(tree, (tuple, list)):
        for item in tree:
            yield from nodes(item)
    elif isinstance(tree, Node):
        yield tree
        for f in fields(tree):  # pyright: ignore[reportArgumentType]
            yield from nodes(getattr(tree, f.name))


def holds(vector: ConformanceVector) -> bool:
    return not isinstance(vector.matcher, Error) and "paper" in vector.texts


SEEN = {type(node) for v in VECTORS if holds(v) for node in nodes(parse(v.texts["paper"], dialect="paper").statements)}
NOT_STATIC_OR_NOT_THE_PAPERS = {
    "IntervalOrPair", "Interrupt", "RelativePosition", "NotVisible", "Intersects", "NotVisibleSpecifier", "ContainedInSpecifier", "ChooseSimulator",
}  # fmt: skip


@pytest.mark.parametrize("module", [expressions, python_expressions, specifiers, statements], ids=lambda m: m.__name__.rpartition(".")[2])
def test_every_production_of_the_static_language_stands_in_a_program_that_runs(module: object) -> None:
    made = [c for _, c in inspect.getmembers(module, inspect.isclass) if issubclass(c, Node) and c.__module__ == module.__name__]  # type: ignore[attr-defined]
    concrete = {c for c in made if not any(d is not c and issubclass(d, c) for d in made)}
    assert {c.__name__ for c in concrete - SEEN} <= NOT_STATIC_OR_NOT_THE_PAPERS


FORMS = [
    r"\bat \(", r"offset by \(", r"offset along \S+ deg by", r"offset along [fg] by", r"beyond .* by \([^)]*\)$", r"beyond .* by .* from ",
    r"Object visible,", r"visible from ", r"\bin \w", r"\bon \w", r"following \w+ for", r"following \w+ from .* for", r"facing \S+ deg",
    r"facing [fg]\b", r"facing toward", r"facing away from", r"apparently facing \S+ deg,", r"apparently facing \S+ deg from", r"with \w+ ",
    *(f"{side} (of )?{where}{by}" for side in ("left of", "right of", "ahead of", "behind") for where in (r"\([^)]*\)", "op", "(taxi|ego)")
      for by in (r"( |,|$)(?!by)", " by ")),
]  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_every_syntactic_form_of_every_specifier_has_a_vector(form: str) -> None:
    assert [v.name for v in VECTORS if holds(v) and re.search(form, v.texts["paper"], re.MULTILINE)]


@pytest.mark.parametrize("name", CONSTRUCTORS)
def test_every_distribution_has_vectors_that_draw_and_one_that_is_refused(name: str) -> None:
    using = [v for v in VECTORS if any(f"{name}(" in text for text in v.texts.values())]
    assert any(isinstance(v.matcher, (Probabilities, QuantityLaw)) and "E-Distributions" in v.fires for v in using)
    assert any(isinstance(v.matcher, Error) and v.matcher.rule == "E-Distributions" for v in using)


@pytest.mark.parametrize("class_", [POINT_CLASS, ORIENTED_POINT_CLASS, OBJECT_CLASS], ids=lambda c: c.name)
def test_every_property_default_has_a_vector(class_) -> None:
    name = {"Point": "defaults-of-point", "OrientedPoint": "defaults-of-oriented-point", "Object": "defaults-of-object"}[class_.name]
    matcher = BY_NAME[name].matcher
    assert isinstance(matcher, SceneValues)
    stated = {key for _, properties in matcher.objects for key in properties}
    read = set(re.findall(r"p\.(\w+)", BY_NAME[name].texts["paper"]))
    assert set(class_.own_defaults) <= stated | read


# Where there is a condition, one vector must not meet it


@pytest.mark.parametrize("requirement", REQUIREMENTS)
def test_every_kind_of_requirement_is_violated_by_a_vector(requirement: str) -> None:
    assert [v for v in VECTORS if isinstance(v.matcher, Rejection) and v.matcher.requirement == requirement]


CONDITIONAL = {
    "R-SpecifiedTwice": "optional-and-non-optional-is-no-conflict",
    "R-MissingProperty": "dependency-supplied-by-a-specifier",
    "R-Cyclic": "not-cyclic-for-an-oriented-point",
    "E-Branch": "branch-on-a-constant",
    "E-Resample": "resample-of-a-copy",
    "E-Variable": "soft-keywords-as-variables",
    "E-ObjectDefinition": "bare-class-makes-an-object",
    "E-Distributions": "range-of-length-zero",
    "S-Mutate": "mutate-every-object",
    "P-At": "at-vector",
    "O-RelativeTo-Headings": "explicit-instead-of-ambiguous",
    "O-RelativeTo-HeadingField": "heading-relative-to-field",
    "S-Assignment": "random-elements-of-containers",
    "S-Require": "requirement-about-geometry",
    "S-Class": "several-superclasses",
    "O-Intersects": "intersects",
    "S-SoftReq-Check": "soft-requirement-of-probability-one",
    "T-Mutate": "no-mutation-no-noise",
    "E-Call-Host": "methods-of-texts-and-their-arguments",
    "E-Seconds": "do-for-seconds",
    "S-Import": "a-module-says-what-a-star-imports",
    "S-Dynamic": "monitors-with-arguments",
    "D-Choose": "a-choice-with-a-limit",
    "D-Do": "do-for-steps",
    "D-Initial": "random-precondition-of-the-initial-scenario",
    "D-Interrupt": "an-interrupt-and-resumption-where-it-left-off",
    "D-Precondition": "any-number-of-preconditions",
    "P-Beyond": "beyond-from",
    "D-Override": "override-of-a-property",
}
"""For each rule that refuses programs: a vector near the border, on the side where it does not."""


def test_every_rule_that_refuses_has_a_neighbour_that_it_does_not_refuse() -> None:
    refusing = {v.matcher.rule for v in VECTORS if isinstance(v.matcher, Error) and v.matcher.rule is not None}
    assert refusing == set(CONDITIONAL)
    assert all(not isinstance(BY_NAME[name].matcher, Error) for name in CONDITIONAL.values())


def rewriting_pairs() -> list[str]:
    """The rules that supply ego, or a distance of 0, for what is left out."""
    return [rule for rule in RULES if rule.endswith("-Ego") and rule != "O-Visible-Ego"] + ["P-Beside-Zero", "P-OffsetBy-Global", "S-Require-Capture"]


@pytest.mark.parametrize("rule", [*rewriting_pairs(), "S-Require", "S-SoftReq-Check", "S-SoftReq-Skip", "S-Mutate", "O-Visible-Ego"])
def test_every_rule_with_a_condition_has_a_vector_in_which_it_must_not_fire(rule: str) -> None:
    assert [v.name for v in VECTORS if rule in v.fires]
    assert [v.name for v in VECTORS if rule in v.avoids]


def test_every_statistical_vector_has_a_rival_and_every_support_something_to_reach() -> None:
    assert all(v.matcher.rival != v.matcher.probabilities for v in VECTORS if isinstance(v.matcher, Probabilities))
    assert all(v.matcher.reaches for v in VECTORS if isinstance(v.matcher, QuantitySupport))
