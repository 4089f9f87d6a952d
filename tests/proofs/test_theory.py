"""The machine of the proofs, extracted, as one more implementation: it passes the vectors of its core, through the harness protocol too."""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections import Counter, defaultdict
from fractions import Fraction
from pathlib import Path

import pytest
from scenic_ref.conformance import Task, judge, load_vectors
from scenic_ref.conformance.implementations.harness_client import External
from scenic_ref.conformance.implementations.protocol import Unsupported

from . import theory
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
WRONG = {
    "no two objects intersect": ("upright_boxes_intersect", "(fun _ _ => false)"),
    "nothing is seen": ("sees_upright_box", "(fun _ _ => false)"),
    "the last statement is lost": ("(begin program)", "(begin (removelast program))"),
}
"""What is wrong with a machine, by its part of what Coq extracts."""
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
@pytest.mark.parametrize(("right", "wrong"), WRONG.values(), ids=WRONG.keys())
def test_a_wrong_machine_fails_vectors(right: str, wrong: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Coq extracts the machine with another parameter, or with another program to run."""
    assert theory.TOLD.count(right) == 1
    monkeypatch.setattr(theory, "TOLD", theory.TOLD.replace(right, wrong))
    runs_of.cache_clear()
    assert any(judge(Theory(), v).verdict.status == "failed" for v in VECTORS if v.name not in OTHERWISE)
    runs_of.cache_clear()


@pytest.mark.slow
@needs_coq
def test_it_is_asked_through_the_harness_protocol() -> None:
    with External(COMMAND) as served:
        assert served.name == "machine of the proofs 1"
        scenes = list(served.scenes(Task(COIN, "paper"), 200, seed=1, attempts=50))
        assert {s["params"]["x"] for s in scenes} == {1, 2}  # type: ignore[index]
        with pytest.raises(Unsupported, match="the core has no place for"):
            list(served.scenes(Task("ego = Object facing 3\n", "paper"), 1, seed=1, attempts=1))


@needs_coq
@pytest.mark.slow
@pytest.mark.parametrize(("condition", "verdict"), [("", "agree"), ("negb", "differ")])
def test_diff_agrees_with_it_and_finds_a_wrong_machine(condition: str, verdict: str, tmp_path: Path) -> None:
    """The wrong one accepts the runs that the right one rejects for a visible object that is not seen."""
    program = tmp_path / "visible.scenic"
    program.write_text("ego = Object\nx = Uniform(20, 40, 60)\nObject at 0 @ x\nparam x = x\n")
    changed = f"theory.TOLD.replace('sees_upright_box', '(fun a b => {condition} (sees_upright_box a b))')"
    served = f"from tests.proofs import theory; theory.TOLD = {changed}; theory.serve(theory.Theory())"
    command = shlex.join([*COMMAND[:3], "-c", served])
    asked = [sys.executable, "-m", "scenic_ref", "diff", str(program), "--impl", command]
    done = subprocess.run(asked, capture_output=True, text=True)
    assert done.stdout.startswith(f"{verdict}: "), done.stdout + done.stderr
    assert done.returncode == (verdict == "differ")


@pytest.mark.slow
@needs_coq
def test_the_law_that_it_enumerates_is_that_of_the_rule() -> None:
    found = Theory().enumerated(Task(COIN, "paper"))
    assert found is not None
    law: dict[float, Fraction] = defaultdict(Fraction)
    for probability, scene in found.outcomes:
        law[scene["params"]["x"]] += probability  # type: ignore[index]
    assert (law, found.acceptance) == ({1: Fraction(2, 5), 2: Fraction(3, 5)}, Fraction(5, 8))
