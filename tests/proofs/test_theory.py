"""The machine of the proofs as one more implementation: it passes the vectors of its core, through the harness protocol too."""

from __future__ import annotations

import sys
from collections import Counter, defaultdict
from fractions import Fraction

import pytest
from scenic_ref.conformance import Task, judge, load_vectors
from scenic_ref.conformance.external import External
from scenic_ref.conformance.implementation import Unsupported

from . import translation
from .coq import PROOFS, needs_coq
from .theory import Theory, runs_of

COMMAND = ("env", f"PYTHONPATH={PROOFS.parent}", sys.executable, "-m", "tests.proofs.theory")
OTHERWISE = {
    "defaults-of-object": "the scene has no objects[0].viewAngle",
    "objects-have-the-names-of-the-variables": "objects[1].name is None, not 'car' (tolerance 0)",
    "objects-that-touch-with-their-front": "gave 1 scenes, and no run may be accepted",
    "reading-boundaries-numbers": "params.larger is False, not True (tolerance 1e-12)",
}
"""What the core leaves out of its scenes, and where its numbers are rational and compared without tolerance."""
VECTORS = [v for v in load_vectors() if v.steps is None and "paper" in v.texts]
COIN = """ego = Object
x = Discrete({1: 1, 2: 3})
require x > 1 or x == 1
param x = x
require[0.5] x == 1
"""


@needs_coq
@pytest.mark.slow
def test_the_machine_of_the_proofs_passes_the_vectors_of_its_core() -> None:
    verdicts = {v.name: judge(Theory(), v).verdict for v in VECTORS}
    assert {name: v.reason.strip() for name, v in verdicts.items() if v.status not in ("passed", "skipped")} == OTHERWISE
    assert Counter(v.status for v in verdicts.values())["passed"] >= 90


@needs_coq
@pytest.mark.slow
def test_a_machine_that_answers_wrongly_fails_vectors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(translation.BINARY, "<", translation.BINARY["=="])
    runs_of.cache_clear()
    assert any(judge(Theory(), v).verdict.status == "failed" for v in VECTORS if {"<", ">"} & set(v.texts["paper"]))
    runs_of.cache_clear()


@needs_coq
def test_it_is_asked_through_the_harness_protocol() -> None:
    with External(COMMAND) as served:
        assert served.name == "machine of the proofs 1"
        scenes = list(served.scenes(Task(COIN, "paper"), 200, seed=1, attempts=50))
        assert {s["params"]["x"] for s in scenes} == {1, 2}  # type: ignore[index]
        with pytest.raises(Unsupported, match="the core has no place for"):
            list(served.scenes(Task("ego = Object facing 3\n", "paper"), 1, seed=1, attempts=1))


@needs_coq
def test_the_law_that_it_enumerates_is_that_of_the_rule() -> None:
    found = Theory().enumerated(Task(COIN, "paper"))
    assert found is not None
    law: dict[float, Fraction] = defaultdict(Fraction)
    for probability, scene in found.outcomes:
        law[scene["params"]["x"]] += probability  # type: ignore[index]
    assert (law, found.acceptance) == ({1: Fraction(2, 5), 2: Fraction(3, 5)}, Fraction(5, 8))
