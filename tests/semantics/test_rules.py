"""Every rule of the catalogue: a program that fires it gives the value of the paper's equation; what it must not accept, it refuses."""

from __future__ import annotations

import importlib
import math
import sys
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.interpreter.choosers import from_stream
from scenic_ref.interpreter.scenes import scene_of
from scenic_ref.interpreter.tracing import trace
from scenic_ref.semantics import errors
from scenic_ref.semantics.rules import CATALOGUE, RULES
from scenic_ref.semantics.vectors import Vector

sys.path.insert(0, str(Path(__file__).parent))
rule_cases = importlib.import_module("rule_cases")
sys.path.pop(0)
CASES, REFUSALS = rule_cases.CASES, rule_cases.REFUSALS


def accepted_trace(case):
    scenario = scenic_ref.loads(case.program, readings=case.readings)
    for attempt in range(100):
        found = trace(scenario.start(), from_stream(0, 0, attempt), fuel=100_000)
        if found.accepted:
            return found
    raise AssertionError("no attempt was accepted")


def assert_close(found, expected):
    if isinstance(found, Vector):
        found = (found.x, found.y)
    if isinstance(expected, (tuple, list)):
        assert len(found) == len(expected)
        for f, e in zip(found, expected, strict=True):
            assert_close(f, e)
    elif isinstance(found, float):
        assert math.isclose(found, expected, rel_tol=1e-12, abs_tol=1e-12), (found, expected)
    else:
        assert found == expected


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.rule)
def test_rule_fires_and_gives_the_value_of_its_equation(case):
    found = accepted_trace(case)
    scene = scene_of(found.run.state, 0, 0, 1)
    for name, expected in case.params.items():
        assert_close(scene.params[name], expected)
    assert case.rule in {event.rule for event in found.events}


@pytest.mark.parametrize("case", REFUSALS, ids=lambda c: f"{c.rule}-{c.error}")
def test_rule_refuses_what_it_must_not_accept(case):
    with pytest.raises(getattr(errors, case.error)) as caught:
        scenic_ref.loads(case.program).sample()
    assert case.message in caught.value.message
    assert type(caught.value).__name__ == case.error


def test_every_rule_of_the_catalogue_has_a_case():
    # no program reaches this branch of Algorithm 1: tests/semantics/test_resolution.py calls the algorithm itself
    covered = {case.rule for case in CASES} | {case.rule for case in REFUSALS} | {"R-SpecifiedTwiceOptionally"}
    assert {rule.id for rule in CATALOGUE} - covered == set()


def test_rule_ids_are_unique_and_documented():
    assert len(RULES) == len(CATALOGUE)
    assert all(rule.statement and rule.place and rule.name for rule in CATALOGUE)


def test_every_rule_that_the_machine_names_is_in_the_catalogue():
    fired = {event.rule for case in CASES for event in accepted_trace(case).events}
    assert fired <= set(RULES)
