"""Every rule of the catalogue: the conformance vectors make it fire with the value of the paper's equation, and refuse what it must not accept."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
import scenic_ref
from scenic_ref.conformance import ConformanceVector, load_vectors
from scenic_ref.conformance.implementations.reference import load_task, trace_first_run
from scenic_ref.conformance.matchers.errors import Error, Rejection
from scenic_ref.conformance.reports import UNREACHABLE, shows
from scenic_ref.semantics.rules import CATALOGUE, RELEASED, RULES, Rule
from scenic_ref.semantics.store import errors

VECTORS = load_vectors()
BY_NAME = {v.name: v for v in VECTORS}

MESSAGES = {
    "ego-is-undefined": "never assigns ego",
    "reading-ego-late": "this is seen from ego, which is not assigned yet",
    "undefined-variable": "Objet is not defined",
    "two-positions": "position is specified twice",
    "default-needs-a-property-that-is-missing": "needs the property nothing",
    "cyclic-position-and-heading": "circle",
    "reading-random-branch": "Range(...) (line 2)",
    "random-loop": "random",
    "oriented-points-relative-to-each-other": "oriented points",
    "at-needs-a-vector": "expects a vector",
    "uniform-over-nothing": "nothing to draw",
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


EQUATION = re.compile(r"⟦[^⟧]+⟧ = \S")
INFERENCE = re.compile(r"(If .+ then )?⟨.+⟩ →")


def begins_with_the_rule(rule: Rule) -> bool:
    """Whether the docstring of the rule's function begins with the rule: an inference rule, an equation, or the paper's sentence with its place."""
    sentence = re.compile(re.escape(rule.place) + ': "[^"]+"')
    syntax_error = re.compile(re.escape(rule.place) + f': .*"syntax error: {re.escape(rule.name)}"')
    forms = {
        "E": (INFERENCE, sentence), "O": (EQUATION,), "P": (EQUATION, INFERENCE), "R": (sentence, syntax_error), "S": (INFERENCE, sentence),
        "T": (INFERENCE,), "D": (sentence,),
    }
    of_releases = (EQUATION, INFERENCE) if rule.place == RELEASED else ()
    return any(form.match(rule.statement) for form in (*forms[rule.id[0]], *of_releases))


@pytest.mark.parametrize("rule", CATALOGUE, ids=lambda rule: rule.id)
def test_the_docstring_of_a_rule_begins_with_the_rule(rule: Rule) -> None:
    assert begins_with_the_rule(rule), rule.statement


STEP = RULES["D-Policy-7"].place


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("D-Policy-7", "Return the choice of actions."), ("D-Policy-7", f"{STEP}: return the choice of actions."),
        ("D-Policy-7", '"Return the choice."'),
        ("D-Policy-7", f'{STEP.replace("step 7", "step 6")}: "Return the choice of actions."'), ("D-Policy-7", "⟨actions⟩ → v."),
        ("D-Policy-7", f'The last step.\n\n{STEP}: "Return the choice of actions."'),
        ("R-Cyclic", f'{RULES["R-Cyclic"].place}: an error: "property P specified twice".'), ("R-Cyclic", 'If G is cyclic: "syntax error".'),
        ("S-If", "The condition decides: ⟨if B: s⟩ → ⟨s⟩."), ("S-If", "If ⟨B⟩ → True, the block."), ("E-Call", "Apply a function value."),
        ("O-At", "The heading: ⟦F at V⟧ = ⟦F⟧(⟦V⟧)."), ("O-At", "⟦F at V⟧: the heading."), ("T-Check", "⟦Done⟧ = (π, O)."),
    ],
)  # fmt: skip
def test_a_docstring_that_begins_otherwise_is_found(name: str, text: str) -> None:
    def function() -> None:
        pass

    function.__doc__ = text
    assert not begins_with_the_rule(replace(RULES[name], function=function))


def rules_of(vector: ConformanceVector) -> set[str]:
    """The rules that fire in one run of a vector's program."""
    return {event.rule for event in trace_first_run(load_task(vector.task("paper")), 0, 0).events}


@pytest.mark.slow
def test_every_rule_that_the_machine_names_is_in_the_catalogue() -> None:
    fired = {rule for v in VECTORS if "paper" in v.texts and not isinstance(v.matcher, (Error, Rejection)) for rule in rules_of(v)}
    assert fired <= set(RULES)
