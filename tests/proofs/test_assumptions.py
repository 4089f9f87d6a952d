"""Every theorem of `proofs/` is proved from nothing but the real numbers of Coq's standard library.

`python -m tests.proofs.test_assumptions` writes `proofs/assumptions.txt` anew: each theorem with what Coq says that it assumes.
"""

from __future__ import annotations

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from .coq import PROOFS, needs_coq, printed

THEORIES = [line for line in (PROOFS / "_CoqProject").read_text().splitlines() if line.endswith(".v")]
ALLOWED = {
    "ClassicalDedekindReals.sig_forall_dec", "ClassicalDedekindReals.sig_not_dec", "FunctionalExtensionality.functional_extensionality_dep",
}
"""What the standard library's real numbers assume."""
ESCAPES = re.compile(r"\b(?:Admitted|admit|Axioms?|Parameters?|Conjecture|Hypothes[ie]s|Variables?|Unset Guard Checking|bypass_check)\b")
COMMENT = re.compile(r"\(\*.*?\*\)", re.DOTALL)


def code_of(theory: str) -> str:
    """A theory without its comments."""
    return COMMENT.sub("", (PROOFS / theory).read_text())


def theorems_of(theory: str) -> list[str]:
    """The names of the theorems of a theory."""
    return re.findall(r"^\s*Theorem\s+(\w+)", code_of(theory), re.MULTILINE)


def test_every_theory_is_listed() -> None:
    assert sorted(THEORIES) == sorted(str(path.relative_to(PROOFS)) for path in PROOFS.rglob("*.v"))


@pytest.mark.parametrize("theory", THEORIES)
def test_nothing_is_left_unproved(theory: str) -> None:
    """Sections may have variables: these become premises of what is proved in them."""
    outside = re.sub(r"^Section (\w+)\..*?^End \1\.", "", code_of(theory), flags=re.DOTALL | re.MULTILINE)
    assert not ESCAPES.findall(outside)
    assert not re.search(r"\b(?:Admitted|admit|Axioms?|Parameters?)\b", code_of(theory))


def assumed(answer: str) -> set[str]:
    """The axioms that `Print Assumptions` tells of."""
    found = set(re.findall(r"^([\w.]+)\s*:", answer, re.MULTILINE))
    assert found or answer.strip() == "Closed under the global context", answer
    return found - {"Axioms"}


@needs_coq
def test_theorems_assume_the_real_numbers_alone(tmp_path: Path) -> None:
    modules = {theory.removesuffix(".v").replace("/", "."): theorems_of(theory) for theory in THEORIES}
    assert all(modules.values())
    asked = [
        f"Definition all_of_{i} := ({', '.join(f'@{module}.{name}' for name in names)}).\nPrint Assumptions all_of_{i}."
        for i, (module, names) in enumerate(modules.items())
    ]
    for module, answer in zip(modules, printed(modules, asked, tmp_path), strict=True):
        assert assumed(answer) <= ALLOWED, module


@needs_coq
def test_an_assumption_is_found(tmp_path: Path) -> None:
    planted = "Axiom wrong : False.\nTheorem nothing_is_true : False. Proof. exact wrong. Qed.\nPrint Assumptions nothing_is_true."
    assert assumed(printed([], [planted], tmp_path)[0]) == {"wrong"}
    assert assumed(printed(["scenes.Resolution"], ["Print Assumptions List.app_nil_r."], tmp_path)[0]) == set()


def list_of_assumptions(folder: Path) -> str:
    """Each theorem with its assumptions, as Coq prints them."""
    modules = {theory.removesuffix(".v").replace("/", "."): theorems_of(theory) for theory in THEORIES}
    names = [f"{module}.{name}" for module, names in modules.items() for name in names]
    answers = printed(modules, [f"Print Assumptions {name}." for name in names], folder)
    return "\n\n".join(f"{name}\n{answer.strip()}" for name, answer in zip(names, answers, strict=True)) + "\n"


@pytest.mark.slow
@needs_coq
def test_the_list_of_assumptions_is_what_coq_prints(tmp_path: Path) -> None:
    assert (PROOFS / "assumptions.txt").read_text() == list_of_assumptions(tmp_path)


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        (PROOFS / "assumptions.txt").write_text(list_of_assumptions(Path(folder)))
