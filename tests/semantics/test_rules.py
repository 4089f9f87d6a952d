"""Every rule of the catalogue: the conformance vectors make it fire with the value of the paper's equation, and refuse what it must not accept."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.conformance import Task, Vector, load_vectors
from scenic_ref.conformance.ourselves import load, traced
from scenic_ref.conformance.refusals import Error, Rejection
from scenic_ref.conformance.reports import UNREACHABLE, shows
from scenic_ref.semantics.kernel import errors
from scenic_ref.semantics.rules import CATALOGUE, RULES

VECTORS = load_vectors()
BY_NAME = {v.name: v for v in VECTORS}

MESSAGES = {
    "ego-is-undefined": "never assigns ego",
    "reading-ego-late": "ego is used before",
    "undefined-variable": "Objet is not defined",
    "two-positions": "position is specified twice",
    "default-needs-a-property-that-is-missing": "needs the property nothing",
    "cyclic-position-and-heading": "circle",
    "reading-random-branch": "Range(...) (line 2)",
    "random-loop": "random",
    "oriented-points-relative-to-each-other": "oriented points",
    "at-needs-a-vector": "expects (vector)",
    "uniform-over-nothing": "empty",
    "range-with-one-end": "low, high",
    "resample-of-an-operation": "operation on one",
    "a-negative-width": "at least 0",
    "mutate-a-number": "only Objects",
    "soft-requirement-random-probability": "constant",
}
"""What the message of an error says, besides its class, rule and line, which the vectors state."""


def test_every_rule_of_the_catalogue_is_shown_by_a_vector() -> None:
    """Each vector holds: tests/conformance/test_vectors.py."""
    assert {rule.id for rule in CATALOGUE} == {rule for v in VECTORS for rule in shows(v)} | UNREACHABLE


@pytest.mark.parametrize("name", MESSAGES)
def test_the_message_of_a_refusal_says_what_is_wrong(name: str) -> None:
    with pytest.raises(errors.ProgramError) as caught:
        scenic_ref.loads(BY_NAME[name].texts["paper"], readings=BY_NAME[name].readings).sample()
    assert MESSAGES[name] in caught.value.message


def test_rule_ids_are_unique_and_documented() -> None:
    assert len(RULES) == len(CATALOGUE)
    assert all(rule.statement and rule.place and rule.name for rule in CATALOGUE)


def rules_of(vector: Vector) -> set[str]:
    """The rules that fire in one run of a vector's program."""
    return {event.rule for event in traced(load(Task(vector.texts["paper"], "paper", vector.readings)), 0, 0).events}


def test_every_rule_that_the_machine_names_is_in_the_catalogue() -> None:
    fired = {rule for v in VECTORS if "paper" in v.texts and not isinstance(v.matcher, (Error, Rejection)) for rule in rules_of(v)}
    assert fired <= set(RULES)
