"""`python -O` leaves assertions out: nothing that matters may stand in one, and the verdicts on vectors are the same."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = (
    "semantics", "interpreter", "roads", "data", "pictures", "simulators", "inference", "api", "sampling", "testing", "conformance", "benchmarks",
    "editors", "playground", "cli",
)  # fmt: skip
PURE = {
    "isinstance", "issubclass", "len", "type", "all", "any", "hasattr", "callable", "is_object", "set", "sum", "max", "min", "sorted", "map",
}  # fmt: skip
COMPUTED = {"rehearsed", "batch", "pruning", "constants", "settings", "impossible"}
"""Attributes that run the program, or raise its errors, when they are read first."""


def effects(test: ast.expr) -> list[str]:
    """What in an assertion may do something: calls of anything but a few functions that only look, assignments, attributes that are computed."""
    found = []
    for node in ast.walk(test):
        match node:
            case ast.Call(func=ast.Name(id=name)) if name in PURE:
                pass
            case ast.Call() | ast.NamedExpr() | ast.Await() | ast.Yield() | ast.YieldFrom():
                found.append(ast.unparse(node))
            case ast.Attribute(attr=name) if name in COMPUTED:
                found.append(ast.unparse(node))
            case _:
                pass
    return found


def test_assertions_have_no_effects():
    wrong = [
        f"{path.relative_to(ROOT)}:{node.lineno}: {effect}"
        for package in PACKAGES
        for path in sorted((ROOT / package).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Assert)
        for effect in effects(node.test)
    ]
    assert not wrong


@pytest.mark.parametrize("text", ["scenario.rehearsed", "done.append(1)", "(x := 3)", "self.batch is not None", "run(x).ok"])
def test_an_effect_is_seen(text):
    assert effects(ast.parse(text, mode="eval").body)


@pytest.mark.slow
def test_vectors_have_the_same_verdicts_without_assertions(tmp_path):
    verdicts = []
    for option in ((), ("-O",)):
        path = tmp_path / f"report{len(option)}.json"
        command = [sys.executable, *option, "-m", "scenic_ref", "conformance", "--chapter", "Operators", "--json", str(path)]
        assert subprocess.run(command, check=False, capture_output=True).returncode == 0
        verdicts.append(json.loads(path.read_text()))
    assert verdicts[0] == verdicts[1]
    assert verdicts[0]["totals"]["passed"] > 20


@pytest.mark.slow
@pytest.mark.parametrize("command", [("check",), ("run",), ("run", "-n", "12"), ("simulate",), ("run", "--backend", "enumerate")], ids=" ".join)
def test_a_branch_on_a_random_value_is_refused_without_assertions_too(command, tmp_path):
    """It is found by running the program through first; the runs themselves would not see it."""
    (tmp_path / "p.scenic").write_text("x = Uniform(1, 2)\nego = Object\nif x > 1:\n    Object at (5, 5)\n")
    command = [sys.executable, "-O", "-m", "scenic_ref", command[0], "p.scenic", *command[1:]]
    done = subprocess.run(command, cwd=tmp_path, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (1, "")
    assert "p.scenic:3" in done.stderr
