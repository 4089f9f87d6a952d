"""The catalogue is a fact: when a rule fires, the function that the catalogue names has run in that very step."""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from types import CodeType, FrameType
from typing import Any

import pytest
from scenic_ref.conformance import load_vectors
from scenic_ref.conformance.implementations.protocol import Refused
from scenic_ref.conformance.implementations.reference import Ourselves
from scenic_ref.conformance.judge import fired_in, judge
from scenic_ref.conformance.reports import UNREACHABLE
from scenic_ref.conformance.vector import ConformanceVector
from scenic_ref.semantics.machine.config import Config
from scenic_ref.semantics.machine.outcome import Draw, Fault, Outcome
from scenic_ref.semantics.rules import RULES, Rule
from scenic_ref.semantics.scenes import released_forms
from scenic_ref.semantics.step import step
from scenic_ref.semantics.syntax.specifiers import AtSpecifier, FacingSpecifier

from .stepping import stepping


def code_of(rule: Rule) -> CodeType:
    """The code of the function that the catalogue names."""
    function: object = rule.function
    while isinstance(function, partial) or hasattr(function, "__wrapped__"):
        function = function.func if isinstance(function, partial) else function.__wrapped__  # type: ignore[attr-defined]
    return function.__code__  # type: ignore[attr-defined]


CODES = {code_of(rule): rule.id for rule in RULES.values()}


@dataclass
class Watched:
    """How often each rule fired with its function, and where it fired without."""

    bound: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    unbound: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))

    def watched(self, function: Callable[[Any], Any], argument: object) -> tuple[Any, set[CodeType]]:
        """What the function gives, and what of the catalogue ran meanwhile."""
        called: set[CodeType] = set()

        def profile(frame: FrameType, event: str, _: object) -> None:
            if event == "call" and frame.f_code in CODES:
                called.add(frame.f_code)

        sys.setprofile(profile)
        try:
            return function(argument), called
        finally:
            sys.setprofile(None)

    def step(self, vector: str, config: Config) -> Outcome:
        """One step, in which every function of the catalogue that is called is noted."""
        outcome, called = self.watched(step, config)
        if isinstance(outcome, Draw) and outcome.otherwise:
            return outcome._replace(resume=partial(self.resume, vector, outcome))
        self.note(fired(outcome), called, vector)
        return outcome

    def resume(self, vector: str, draw: Draw, drawn: object) -> Config:
        """Which of two rules a coin chooses is known when it is thrown."""
        config, called = self.watched(draw.resume, drawn)
        self.note(draw.fires(drawn), called, vector)
        return config

    def note(self, rule: str, called: set[CodeType], vector: str) -> None:
        """A rule has fired, while these functions ran."""
        if rule in RULES:
            if code_of(RULES[rule]) in called:
                self.bound[rule] += 1
            else:
                self.unbound[rule].add(vector)


def fired(outcome: Outcome) -> str:
    """The rule of an outcome. An error names the one that could not be applied, but for those rules that say that there is an error."""
    if isinstance(outcome, Fault):
        return outcome.error.rule if outcome.error.rule.startswith("R-") or outcome.error.rule == "E-Branch" else ""
    return outcome.rule


def watch(vectors: tuple[ConformanceVector, ...]) -> Watched:
    """What fires in the vectors, watched."""
    found = Watched()
    ours = Ourselves()
    for vector in vectors:
        task = replace(vector.task(next(d for d in ours.dialects if d in vector.texts)), seed=0)
        with stepping(partial(found.step, vector.name)):
            try:
                fired_in(ours, vector, task)
            except Refused:
                continue
    return found


@pytest.mark.slow
def test_the_function_that_the_catalogue_names_runs_when_the_rule_fires() -> None:
    watched, reachable = watch(load_vectors()), RULES.keys() - UNREACHABLE
    assert not watched.unbound.keys() & reachable, watched.unbound
    assert watched.bound.keys() >= reachable


def test_no_two_rules_have_one_function() -> None:
    """But for the two about a constant: `resample` is one function of the paper's text; and for the twelve forms that `by_vector` makes of others."""
    shared = {rule.id for rule in RULES.values() if [code_of(r) for r in RULES.values()].count(code_of(rule)) > 1}
    assert {rule for rule in shared if not rule.endswith("-By-Vector")} <= {"E-Resample", "E-Resample-Constant", "E-Constant", "E-Variable"}


@pytest.mark.parametrize(("rule", "node"), [("P-At", AtSpecifier), ("P-Facing-Heading", FacingSpecifier)])
def test_a_function_that_the_machine_does_without_is_found(rule: str, node: type, monkeypatch: pytest.MonkeyPatch) -> None:
    names, forms = released_forms.FORMS[node]
    planted = tuple(form._replace(function=lambda value: value) if form.rule == rule else form for form in forms)
    monkeypatch.setattr(released_forms, "FORMS", {**released_forms.FORMS, node: (names, planted)})
    vector = next(v for v in load_vectors() if rule in v.fires)
    assert watch((vector,)).unbound[rule] == {vector.name}


@pytest.mark.parametrize(("rule", "node"), [("P-At", AtSpecifier), ("P-Facing-Heading", FacingSpecifier)])
def test_a_vector_notices_a_function_that_only_raises(rule: str, node: type, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(value: object) -> object:
        raise AssertionError("planted")

    names, forms = released_forms.FORMS[node]
    planted = tuple(form._replace(function=broken) if form.rule == rule else form for form in forms)
    monkeypatch.setattr(released_forms, "FORMS", {**released_forms.FORMS, node: (names, planted)})
    assert judge(Ourselves(), next(v for v in load_vectors() if rule in v.fires)).verdict.status != "passed"
