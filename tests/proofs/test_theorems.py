"""The catalogue names theorems that there are, the README of the proofs tells of every theory, and `make proofs` says what it needs."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
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


@pytest.mark.parametrize(
    ("tools", "said"),
    [
        ({}, "make proofs needs Coq 8.16, and there is no coqc (Debian: apt-get install coq)"),
        ({"coqc": "8.16.1 4.13.1"}, "make proofs needs Coq 8.16, and there is no coq_makefile (Debian: apt-get install coq)"),
        ({"coqc": "8.20.0 5.1.1", "coq_makefile": ""}, "make proofs needs Coq 8.16, and this is Coq 8.20.0"),
    ],
)
def test_make_proofs_says_what_it_needs(tools: dict[str, str], said: str, tmp_path: Path) -> None:
    make, cut = shutil.which("make"), shutil.which("cut")
    assert make is not None and cut is not None
    (tmp_path / "cut").symlink_to(cut)
    for tool, version in tools.items():
        (tmp_path / tool).write_text(f"#!/bin/sh\necho {version}\n")
        (tmp_path / tool).chmod(0o755)
    made = subprocess.run([make, "proofs"], cwd=PROOFS.parent, env={"PATH": str(tmp_path)}, capture_output=True, text=True)
    assert made.returncode != 0 and made.stderr.splitlines()[0] == said
