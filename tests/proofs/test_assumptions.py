"""Every theorem of `proofs/` is proved from nothing, or from the real numbers of Coq's standard library, and its premises are there to be read.

`python -m tests.proofs.test_assumptions` writes anew what Coq says of each theorem: `proofs/assumptions.txt`, what it assumes, and
`proofs/statements.txt`, its statement with all premises, those of its section included.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import dedent

import pytest

from .coq import PROOFS, needs_coq, printed

PROJECT = (PROOFS / "_CoqProject").read_text().splitlines()
THEORIES = [line for line in PROJECT if line.endswith(".v")]
REALS = {
    "ClassicalDedekindReals.sig_forall_dec", "ClassicalDedekindReals.sig_not_dec", "FunctionalExtensionality.functional_extensionality_dep",
}  # fmt: skip
"""What the standard library's real numbers assume."""
ALLOWED = {"scenes/Operators.v": REALS, "inference/Pruning.v": REALS, "inference/PrunedScenarios.v": REALS}
"""What a theory may assume; the others nothing."""
PREMISES = {
    "forall s, (0 < s)%Q -> is_distribution (noise s)": "Machine.v, Programs.v: the noise that the machine is given is a finite distribution",
    "forall a, In a space -> q a == 0 -> p a == 0": "Rejection.v: the law that importance sampling draws from gives whatever the target gives",
    "NoDup (map fst d)": "Resolution.v, of lemmas alone: a dictionary has each key once, which is proved where they are used",
    "forall p x, lookup p d = Some x <-> determines x p": "Resolution.v, of lemmas alone: the dictionary that is meant, likewise",
}
"""The propositions that sections assume, with the reason. They are premises of what is proved there."""
DATA = {
    "Type", "Q", "bool", "vertex -> list vertex", "forall x y : vertex, {x = y} + {x <> y}", "class", "list specifier", "dict specification",
    "specification -> list (option value) -> property -> value", "Q -> dist Q", "bindings -> bindings -> bool", "A -> bool", "B -> bool",
    "A * B -> bool", "dist A", "dist B", "list A", "A -> Q", "dist K", "K -> A -> A", "K -> K",
}  # fmt: skip
"""The types of the data that sections are about."""
CLOSED = "Closed under the global context"
UNPROVED = re.compile(r"\b(?:Admitted|[Aa]dmit|Axioms?|Parameters?|Conjectures?|bypass_check|Unset\s+\w+\s+Checking)\b|-type-in-type")
"""What leaves something unproved, or turns one of Coq's checks off."""
DECLARED = re.compile(r"\b(?:Variables?|Hypothes[ie]s|Context)\s+(.*?)\.(?=\s)", re.DOTALL)
AXIOM = re.compile(r"[\w.']+(?= : |$)")
COMMENT = re.compile(r"\(\*.*?\*\)", re.DOTALL)
SECTION = re.compile(r"^Section (\w+)\..*?^End \1\.", re.DOTALL | re.MULTILINE)
HEAD = re.compile(r"^(?:From|Import|Open|Local Open) .*\.$", re.MULTILINE)


def code_of(theory: str) -> str:
    """A theory without its comments."""
    return COMMENT.sub("", (PROOFS / theory).read_text())


def theorems_of(theory: str) -> list[str]:
    """The names of the theorems of a theory."""
    return re.findall(r"^\s*Theorem\s+(\w+)", code_of(theory), re.MULTILINE)


def module_of(theory: str) -> str:
    """The name of a theory in Coq."""
    return theory.removesuffix(".v").replace("/", ".")


def declared(code: str) -> Iterator[tuple[str, str]]:
    """What sections declare: names and their type."""
    for text in DECLARED.findall(code):
        for binder in binders(text) if text[0] in "({[`" else [text]:
            names, _, type_ = binder.partition(" : ")
            yield names, type_


def binders(text: str) -> Iterator[str]:
    """What stands between the outer brackets."""
    depth, begin = 0, 0
    for place, sign in enumerate(text):
        if sign in "({[":
            depth += 1
            begin = place + 1 if depth == 1 else begin
        if sign in ")}]":
            depth -= 1
            if depth == 0:
                yield text[begin:place]


def hidden(code: str) -> list[str]:
    """What a theory assumes that is neither data of a known type nor among `PREMISES`, or outside sections."""
    unknown = [names for names, type_ in declared(code) if type_ not in DATA and type_ not in PREMISES]
    return unknown + [names for names, _ in declared(SECTION.sub("", code))]


def test_every_theory_is_listed_and_coq_is_given_no_option() -> None:
    assert sorted(THEORIES) == sorted(str(path.relative_to(PROOFS)) for path in PROOFS.rglob("*.v"))
    assert [line for line in PROJECT if line not in THEORIES] == ["-Q . ScenicRef"]


@pytest.mark.parametrize("theory", THEORIES)
def test_nothing_is_left_unproved(theory: str) -> None:
    """Sections may have variables, and the premises that are told here."""
    assert not UNPROVED.findall(code_of(theory))
    assert not hidden(code_of(theory))


def test_every_premise_and_type_that_is_told_is_there() -> None:
    assert {type_ for theory in THEORIES for _, type_ in declared(code_of(theory))} == DATA | set(PREMISES)


@pytest.mark.parametrize(
    "declaration",
    ["Hypothesis foo : False.", "Variable foo : 1 = 2.", "Context (n : bool) (foo : n = true).", "Context `{Foo A}.", "Variables a b : False."],
)
def test_a_premise_of_a_section_is_found(declaration: str) -> None:
    code = f"Section Hole.\n{declaration}\nTheorem anything_holds : 1 = 2.\nProof. contradiction. Qed.\nEnd Hole.\n"
    assert hidden(code)
    assert not hidden(code.replace(declaration, "Context {A : Type} (accepts : A -> bool).\nVariable d : dist A."))
    assert hidden("Variable d : bool.\n")


def assumed(answer: str) -> set[str]:
    """The axioms that `Print Assumptions` tells of. Raises `AssertionError` at anything else, such as a check that was turned off."""
    first, *rest = answer.strip().splitlines()
    if first == CLOSED and not rest:
        return set()
    assert first == "Axioms:" and rest, answer
    names = [AXIOM.match(line) for line in rest if not line.startswith(" ")]
    assert all(names), answer
    return {name[0] for name in names if name}


@pytest.mark.slow
@needs_coq
def test_theorems_assume_the_real_numbers_alone(tmp_path: Path) -> None:
    modules = {module_of(theory): theorems_of(theory) for theory in THEORIES}
    assert all(modules.values())
    asked = [
        f"Definition all_of_{i} := ({', '.join(f'@{module}.{name}' for name in names)}).\nPrint Assumptions all_of_{i}."
        for i, (module, names) in enumerate(modules.items())
    ]
    for theory, answer in zip(THEORIES, printed(modules, asked, tmp_path), strict=True):
        assert assumed(answer) <= ALLOWED.get(theory, set()), theory


PLANTED = "Axiom wrong : False.\nTheorem nothing_is_true : False. Proof. exact wrong. Qed.\nPrint Assumptions nothing_is_true."
POSITIVITY = """Unset Positivity Checking.
Inductive bad := Bad (f : bad -> False).
Definition no (b : bad) : False := match b with Bad f => f b end.
Theorem nothing_is_true : False. Proof. exact (no (Bad no)). Qed.
Print Assumptions nothing_is_true."""
GUARD = """Unset  Guard  Checking.
Fixpoint loop (n : nat) : False := loop n.
Theorem nothing_is_true : False. Proof. exact (loop 0). Qed.
Print Assumptions nothing_is_true."""
UNIVERSE = """Unset Universe Checking.
Definition universe := Type.
Definition its_own : universe := universe.
Theorem a_universe_is_in_itself : exists one : universe, one = universe. Proof. now exists its_own. Qed.
Print Assumptions a_universe_is_in_itself."""


@needs_coq
def test_an_assumption_is_found(tmp_path: Path) -> None:
    assert UNPROVED.search(PLANTED)
    assert assumed(printed([], [PLANTED], tmp_path)[0]) == {"wrong"}
    assert assumed(printed(["scenes.Resolution"], ["Print Assumptions List.app_nil_r."], tmp_path)[0]) == set()


@needs_coq
@pytest.mark.parametrize("planted", [POSITIVITY, GUARD, UNIVERSE], ids=["positivity", "guard", "universe"])
def test_a_check_that_is_turned_off_is_found(planted: str, tmp_path: Path) -> None:
    assert UNPROVED.search(planted)
    [answer] = printed([], [planted], tmp_path)
    with pytest.raises(AssertionError):
        assumed(answer)


def list_of_assumptions(folder: Path) -> str:
    """Each theorem with its assumptions, as Coq prints them."""
    modules = {module_of(theory): theorems_of(theory) for theory in THEORIES}
    names = [f"{module}.{name}" for module, names in modules.items() for name in names]
    answers = printed(modules, [f"Print Assumptions {name}." for name in names], folder)
    return "\n\n".join(f"{name}\n{answer.strip()}" for name, answer in zip(names, answers, strict=True)) + "\n"


def list_of_statements(folder: Path) -> str:
    """Each theorem with its statement, as Coq prints it where what the theory imports is imported."""
    return "\n".join(text for theory in THEORIES for text in statements_of(theory, folder))


def statements_of(theory: str, folder: Path) -> Iterator[str]:
    """The same of one theory."""
    module, names = module_of(theory), theorems_of(theory)
    head = "\n".join((*HEAD.findall(code_of(theory)), f"From ScenicRef Require Import {module}.", "Set Printing Width 96."))
    asked = [f"Check @{name}." for name in names]
    for name, answer in zip(names, printed([], [f"{head}\n{asked[0]}", *asked[1:]], folder), strict=True):
        said, _, statement = answer.partition("\n     : ")
        assert said.removeprefix("@") == name, answer
        lines = dedent(" " * 7 + statement).splitlines()
        yield "\n".join((f"{module}.{name}", *(f"    {line}".rstrip() for line in lines), ""))


LISTS: dict[str, Callable[[Path], str]] = {"assumptions.txt": list_of_assumptions, "statements.txt": list_of_statements}
"""What Coq says of all theorems, by the file in which it stands."""


@pytest.mark.slow
@needs_coq
@pytest.mark.parametrize("name", LISTS)
def test_the_list_is_what_coq_prints(name: str, tmp_path: Path) -> None:
    assert (PROOFS / name).read_text() == LISTS[name](tmp_path)


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        for file, list_of in LISTS.items():
            (PROOFS / file).write_text(list_of(Path(place)))
