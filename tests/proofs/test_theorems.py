"""The catalogue names theorems that there are, and the README of the proofs tells of every theory."""

from __future__ import annotations

from scenic_ref.semantics.rules import RULES
from scenic_ref.semantics.theorems import THEOREMS

from .coq import PROOFS
from .test_assumptions import THEORIES, theorems_of


def test_rules_and_theorems_exist() -> None:
    assert THEOREMS.keys() <= RULES.keys()
    there = {theory: set(theorems_of(theory)) for theory in THEORIES}
    named = [(theory, name) for theories in THEOREMS.values() for theory, names in theories.items() for name in names]
    assert not [(theory, name) for theory, name in named if name not in there[theory]]


def test_the_readme_tells_of_every_theory() -> None:
    text = (PROOFS / "README.md").read_text()
    assert not [theory for theory in THEORIES if f"`{theory}`" not in text]
