"""The tool that changes `semantics`: what it changes, what it leaves alone, and that the list of equivalent changes is about this tree."""

from __future__ import annotations

import ast
import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import PurePath
from textwrap import dedent

import pytest

from . import changes
from .changes import files, mutants
from .processes import allow, each
from .results import Results, State, equivalents
from .vectors import outcome


@pytest.fixture
def changed(monkeypatch, tmp_path):
    """Gives the changes of a text."""

    def of(text: str) -> list[changes.Mutant]:
        monkeypatch.setattr(changes, "ROOT", tmp_path)
        (tmp_path / "some.py").write_text(dedent(text))
        return mutants("some.py")

    return of


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("a < b", {"a <= b", "None"}),
        ("a == b", {"a != b", "None"}),
        ("a is None", {"a is not None", "None"}),
        ("a in b", {"a not in b", "None"}),
        ("a + 1", {"a", "1", "a - 1", "a + 2", "None"}),
        ("-a", {"a", "None"}),
        ("not a", {"a", "None"}),
        ("a and b and c", {"b and c", "a and c", "a and b", "None"}),
        ("True", {"False", "None"}),
        ("a if b else c", {"a", "c", "None"}),
        ("isinstance(a, b)", {"False", "None"}),
        ("f(a, b)", {"a", "None"}),
        ("a.f()", {"a", "None"}),
        ("[a for a in b if c]", {"[a for a in b if True]", "None"}),
        ("cast(a | b, c)", {"None"}),
        ("'text'", {"None"}),
        ("f'{a + 1}'", {"None"}),
        ("'text' + a", {"None"}),
        ("[*zip(a, strict=True)]", {"[*a]", "None"}),
    ],
)
def test_an_expression_is_changed_in_each_way(changed, before, after):
    found = changed(f"def f():\n    return {before}\n")
    assert {m.after.removeprefix("return ") for m in found if m.kind != "body to raise"} == after
    assert {m.before for m in found if m.kind != "body to raise"} == {f"return {before}"}


def test_what_is_no_behaviour_is_left_alone(changed):
    text = '''
        """Texts, -1."""
        from typing import TYPE_CHECKING

        if TYPE_CHECKING:
            x: int = 1

        Kinds = int | str

        @dataclass(frozen=True)
        class C:
            """A class."""

            y: int | None

            def __repr__(self):
                return 1 + 2

            def says(self):
                """Nothing."""
                ...

        def g(a: int | None) -> int | None:
            """Nothing."""
            assert a > 0
            raise ValueError(a + 1)
    '''
    assert [m.after for m in changed(text)] == ["def g: raise AssertionError"]


def test_branches_and_statements_are_removed(changed):
    text = '''
        def f(a):
            if a:
                g(a)
            for b in a:
                a += b
            match a:
                case 1:
                    return
                case _:
                    pass
            try:
                a.b = 1
            except E:
                pass
    '''
    found = {(m.kind, m.before, m.after) for m in changed(text)}
    assert {
        ("branch removed", "a", "True"), ("branch removed", "a", "False"), ("branch removed", "a", "()"), ("statement removed", "g(a)", "pass"),
        ("statement removed", "a += b", "pass"), ("branch removed", "case 1: return", ""), ("branch removed", "except E: pass", "except E: raise"),
        ("body to raise", "def f: if a:", "def f: raise AssertionError"),
    } <= found


@pytest.mark.slow
def test_each_change_of_the_semantics_is_one_and_compiles():
    """In one file of each folder: the changed code is never the old one."""
    folders = {PurePath(f).parent: f for f in files()}
    for file in folders.values():
        old = ast.unparse(ast.parse((changes.ROOT / file).read_text()))
        for number in range(0, len(mutants(file)), 7):
            mutant = mutants(file)[number]
            mutant.finder()
            assert ast.unparse(mutant.tree) != old, mutant


PLANTED = """
import json
from tests.mutants.changes import files, mutants
from tests.mutants.processes import each
from tests.mutants.vectors import Covered, Known, Trial, by_vectors, outcome, tables

known = Known(tables(), Covered(), {}, [], [])
at = [m for f in files() if f.endswith("/operators.py") for m in mutants(f) if m.function == "distance"]
body = next(m for m in at if m.kind == "body to raise")
trials = [Trial(body, names, (60.0,) * len(names)) for names in ((), ("relative-heading-ego",), ("relative-heading-ego", "distance-ego"))]
print(json.dumps([outcome(told, status)["by"] for _, told, status in each(trials, by_vectors(known), 1)]))
"""


@pytest.mark.slow
def test_a_vector_notices_that_the_function_of_its_rule_is_gone_and_others_do_not():
    """In processes of their own, into which the package was not imported before."""
    told = subprocess.run([sys.executable, "-c", PLANTED], cwd=changes.ROOT, check=True, capture_output=True, text=True).stdout
    assert json.loads(told) == [None, None, "distance-ego"]


@pytest.mark.slow
def test_equivalent_changes_are_changes_of_this_tree():
    named = equivalents()
    assert all(e.reason for e in named)
    there = [m for file in files() if PurePath(file).name in {e.file for e in named} for m in mutants(file)]
    assert not [e for e in named if not any(e.names(m) for m in there)]


def forever(task, tell):
    tell(at="a vector")
    allow(0)
    while True:
        pass


def crashing(task, tell):
    tell(at="a vector")
    raise ValueError("wrong")


def dying(task, tell):
    tell(at="a vector")
    os.kill(os.getpid(), signal.SIGSEGV)


@pytest.mark.parametrize(("work", "how"), [(forever, "time"), (crashing, "errored"), (dying, "crash")])
def test_a_process_that_does_not_end_well_has_noticed(work, how):
    (found,) = [outcome(told, status) for _, told, status in each([1], work, 1)]
    assert (found["by"], found["how"]) == ("a vector", how)


def test_results_are_kept_and_those_about_another_tree_are_not_taken_over(changed, tmp_path):
    """What a vector noticed it still notices when another vector is added; what none noticed is tried again."""
    one, other = changed("def f():\n    return 1\n")[:2]
    path, state = tmp_path / "results.jsonl", State("code", "vectors", "tests")
    first = Results(path, state)
    first.add("vectors", one, {"by": "a", "how": "failed"})
    first.add("vectors", other, {"by": None, "how": "missed"})
    first.add("suite", other, {"by": None, "how": "missed"})
    again = Results(path, state)
    assert (again.vectors, again.suite) == (first.vectors, first.suite)
    assert again.by_vectors(one) and not again.by_suite(other)
    added = Results(path, replace(state, vectors="more"))
    assert list(added.vectors.values()) == [{"by": "a", "how": "failed"}] and added.suite == first.suite
    assert Results(path, replace(state, tests="more")).suite == {}
    assert Results(path, replace(state, code="changed")).vectors == {}


SUITE = """
from tests.mutants import changes, processes, suite, vectors
[mutant] = [m for m in changes.mutants("semantics/space/regions/parameter_intervals.py") if m.function == "complement" and "low <= high" in m.after]
trials = [vectors.Trial(mutant, tuple({names}), (60.0, 60.0)), vectors.Trial(mutant, (), ())]
for _, told, status in processes.each(trials, suite.by_tests(), 1):
    print(vectors.outcome(told, status)["by"])
"""


def test_the_tests_are_run_on_the_change():
    tests = "weights_are_a_list", "the_rest_of_an_interval_from_its_beginning_has_no_empty_part"
    names = [f"tests/semantics/test_corners.py::test_{name}" for name in tests]
    linked = os.environ | {"PYTHONPATH": str(changes.ROOT / ".link")}  # where pytest finds the package by its path, it would load it itself
    command = [sys.executable, "-c", SUITE.format(names=names)]
    found = subprocess.run(command, cwd=changes.ROOT, env=linked, capture_output=True, text=True, check=True)
    assert found.stdout == f"{names[1]}\nNone\n"
