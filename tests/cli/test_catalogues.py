"""`scenic-ref rules`, `readings` and `check`."""

from __future__ import annotations

import json
import re

import pytest
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.rules import CATALOGUE
from scenic_ref.semantics.theorems import theorems_of


def test_rules_lists_the_whole_catalogue(ask):
    out = ask("rules").out
    assert all(rule.id in out and rule.code in out for rule in CATALOGUE)


def test_rules_of_a_prefix_are_those_that_begin_with_it(ask):
    lines = ask("rules", "T-").out.splitlines()[2:]
    assert {line.split()[0] for line in lines} == {r.id for r in CATALOGUE if r.id.startswith("T-")}


def test_a_single_rule_is_shown_with_its_statement(ask):
    out = ask("rules", "s-softreq-check").out
    assert "⟨require[p] B, σ, π, O⟩ →^p ⟨require B, σ, π, O⟩" in out
    assert 'Figure "Semantics of statements"' in out


def test_theorems_are_said_to_be_of_the_theories(ask):
    lines = ask("rules", "D-Policy-4").out.splitlines()
    told = lines.index("theorems  of the theories in proofs/; tests tie these to the code")
    assert [line.split() for line in lines[told + 1 :]] == [name.split() for name in theorems_of("D-Policy-4")]
    assert "theorems" not in ask("rules", "P-In").out


def test_rules_in_json_hold_the_same(ask):
    assert [r["id"] for r in json.loads(ask("rules", "--json").out)] == [r.id for r in CATALOGUE]


def test_readings_mark_the_alternative_that_is_followed(ask):
    def line(*options: str) -> str:
        return next(text for text in ask("readings", *options).out.splitlines() if text.startswith("soft "))

    assert "run* | scene" in line()
    assert "run | scene*" in line("--profile", "prose")
    assert "run | scene*" in line("--reading", "soft=scene")


@pytest.mark.slow
def test_a_reading_is_explained(ask):
    for name, reading in READINGS.items():
        out = ask("readings", name).out
        assert all(re.search(rf"^[* ] {alternative}\s", out, re.MULTILINE) for alternative in reading.alternatives)


def test_readings_in_json_hold_the_same(ask):
    found = json.loads(ask("readings", "--json", "--profile", "prose").out)
    assert {r["id"]: r["selected"] for r in found} == {name: r.under("prose") for name, r in READINGS.items()}


def test_check_says_ok(ask):
    assert ask("check", "random.scenic").out == "ok\n"
