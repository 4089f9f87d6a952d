"""The generator: reproducible, varied, obedient to its settings, and it shrinks."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import pytest
from hypothesis import HealthCheck, find, settings
from scenic_ref.api import Scenario
from scenic_ref.conformance.generator import (
    Choices,
    ProgramSettings,
    generate,
    random_program,
    random_programs,
)
from scenic_ref.conformance.generator.hypothesis_strategies import programs
from scenic_ref.semantics.store.errors import AttemptsExhausted, UsageError
from scenic_ref.semantics.syntax import Node, Program, expressions, python_expressions, specifiers, statements

from .specifier_permutations import nodes

COUNT = 400
SEED = 2026
FEATURES = {
    "classes": "ClassDefinition", "functions": "FunctionDefinition", "loops": "For", "branches": "Try", "resample": "resample",
    "fields": "VectorField",
    "visibility": "CanSee", "requirements": "Require", "soft": "SoftRequire", "mutate": "Mutate", "workspace": "Workspace", "regions": "InSpecifier",
    "random_length": "filter", "released": "RelativePosition",
}
NEVER = {
    "Seconds": "a unit of time, in dynamic programs", "IntervalOrPair": "another dialect", "InInitialScenario": "dynamic programs",
    "Delete": "no variable may go", "Raise": "the ill-formed flavour", "Global": "no function assigns a global variable",
    "ImportFrom": "`import` stands for it",
    "ChooseSimulator": "the released implementations",
    "NotVisibleSpecifier": "the released implementations", "ContainedInSpecifier": "the released implementations",
    "Interrupt": "dynamic programs", "Model": "programs of the language alone", "SetDisplay": "the order of a set is not the program's",
}


def words(program: Program) -> set[str]:
    """The kinds of nodes of a program, and the functions that it calls by name."""
    found: set[str] = set()
    for node in nodes(program):
        found.add(type(node).__name__)
        if isinstance(node, python_expressions.Call) and isinstance(node.function, python_expressions.Name):
            found.add(node.function.name)
    return found


@cache
def vocabulary(finite: bool) -> set[str]:
    return set().union(*map(words, random_programs(COUNT, SEED, ProgramSettings(finite=finite))))


def digest(count: int) -> str:
    return hashlib.sha256("".join(program.text for program in random_programs(count, SEED)).encode()).hexdigest()


@pytest.mark.slow
@pytest.mark.parametrize("hash_seed", ["0", "17"])
def test_another_process_writes_the_same_programs(hash_seed: str):
    code = (
        "import hashlib\nfrom scenic_ref.conformance.generator import random_programs\n"
        f"print(hashlib.sha256(''.join(p.text for p in random_programs(40, {SEED})).encode()).hexdigest())"
    )
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.strip() == digest(40)


@pytest.mark.slow
def test_a_program_is_a_function_of_seed_index_and_settings():
    assert [p.text for p in random_programs(20, 5)] == [random_program(5, index).text for index in range(20)]
    assert random_program(5, 1).text != random_program(5, 2).text != random_program(6, 2).text
    assert len({p.text for p in random_programs(COUNT, SEED)}) > 0.96 * COUNT


def concrete(module: object, base: type[Node]) -> Iterator[str]:
    for name, kind in vars(module).items():
        if isinstance(kind, type) and issubclass(kind, base) and kind.__module__ == getattr(module, "__name__", ""):
            yield name


@pytest.mark.slow
@pytest.mark.parametrize("module", [specifiers, expressions, python_expressions, statements])
def test_every_static_construct_is_written(module: object):
    assert set(concrete(module, Node)) - vocabulary(False) <= set(NEVER)


def test_every_construct_that_is_never_written_exists():
    known = {name for module in (expressions, python_expressions, specifiers, statements) for name in concrete(module, Node)}
    assert set(NEVER) <= known - vocabulary(False)


@pytest.mark.slow
def test_finite_programs_have_all_specifiers_of_position_and_heading():
    assert {name for name in concrete(specifiers, Node) if name not in ("InSpecifier", "VisibleSpecifier", *NEVER)} <= vocabulary(True)


@pytest.mark.sampled(8)
@pytest.mark.parametrize(("feature", "word"), FEATURES.items())
def test_a_feature_that_is_switched_off_is_not_written(feature: str, word: str):
    plain = ProgramSettings(**{feature: 0.0})  # pyright: ignore[reportArgumentType]
    assert word in vocabulary(False)
    assert not any(word in words(program) for program in random_programs(60, SEED, plain))


def test_every_probability_is_a_feature():
    names = {name for name, _ in ProgramSettings().features()}
    assert set(FEATURES) <= names
    nothing = replace(ProgramSettings(), **dict.fromkeys(names, 0.0))
    assert len({program.text for program in random_programs(50, SEED, nothing)}) > 40


def test_programs_keep_within_their_sizes():
    small = ProgramSettings(max_objects=2, max_classes=1, max_statements=4)
    for program in random_programs(60, SEED, small):
        found = list(nodes(program))
        assert sum(isinstance(node, statements.ClassDefinition) for node in found) <= 1
        assert len(program.statements) < 16
        try:
            scene = Scenario(program).sample(max_attempts=10)
        except AttemptsExhausted:
            continue
        assert len(scene.objects) <= 3


@pytest.mark.slow
def test_half_of_the_programs_are_accepted_at_once_and_few_are_infeasible():
    attempts: list[int] = []
    for program in random_programs(100, SEED):
        try:
            attempts.append(Scenario(program).sample(max_attempts=40).attempts)
        except AttemptsExhausted:
            attempts.append(1000)
    assert sorted(attempts)[50] <= 10
    assert sum(each == 1000 for each in attempts) <= 25


class Simplest(Choices):
    """The choices towards which an engine shrinks."""

    def integer(self, low: int, high: int) -> int:
        return max(low, min(0, high))


def test_the_simplest_choices_give_the_simplest_program():
    assert generate(Simplest()).text == "ego = Object at (0, 0)\nx1 = 0\n"


@pytest.mark.slow
def test_hypothesis_can_make_the_simplest_program():
    quiet = settings(derandomize=True, database=None, deadline=None, max_examples=5, suppress_health_check=list(HealthCheck))
    off = dict.fromkeys([name for name, _ in ProgramSettings().features()], 0.0)
    small = replace(ProgramSettings(max_statements=1, max_depth=0), **off)  # pyright: ignore[reportArgumentType]
    assert find(programs(small), lambda program: True, settings=quiet).text.count("\n") <= 3


@pytest.mark.parametrize("wrong", [{"max_objects": 0}, {"regions": 2.0}, {"area": -1.0}, {"max_depth": -3}, {"max_loop": 0}])
def test_settings_that_are_none_are_refused(wrong):
    with pytest.raises(UsageError):
        ProgramSettings(**wrong)
