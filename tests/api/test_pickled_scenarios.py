"""Scenarios that are pickled draw the same scenes again; what cannot be pickled, or is no longer what it was, is told."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from copy import copy, deepcopy
from dataclasses import replace
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.semantics.store.errors import ParseError, ProgramError, UsageError

TEXT = """
param time = Range(0, 24)
kind = Uniform('a', 'b')
ego = Object at (0, 0), with viewAngle 60 deg
other = Object at (Range(-20, 20), Range(-20, 20)), with kind kind
require (distance to other) < 18
require[0.5] other.position.x > 0
"""
PLAIN = scenic_ref.loads(TEXT)


def lines(scenario: Scenario, count: int = 12, seed: int = 3) -> list[str]:
    return [scene.to_line() for scene in scenario.sample_many(count, seed)]


def again(scenario: Scenario) -> Scenario:
    return pickle.loads(pickle.dumps(scenario))


def conditioned(scenario: Scenario) -> Scenario:
    return scenario.condition_on(scenario.sample(1), objects=iter([1]))


MADE: dict[str, Callable[[], Scenario]] = {
    "plain": lambda: PLAIN,
    "pruned": PLAIN.pruned,
    "given an object": lambda: conditioned(PLAIN),
    "given an object, then pruned": lambda: conditioned(PLAIN).pruned(),
    "pruned, then given an object": lambda: conditioned(PLAIN.pruned()),
    "given twice": lambda: conditioned(PLAIN).condition_on(params={"time": 7.5}),
    "given a parameter": lambda: PLAIN.condition_on(params={"time": 7.5}),
    "given a whole scene": lambda: PLAIN.condition_on(PLAIN.sample(2)),
    "with parameters": lambda: scenic_ref.loads("ego = Object at (Range(0, 1), globalParameters.x)", params={"x": 4}),
    "with readings": lambda: scenic_ref.loads(TEXT, profile="scenic-3", dialect="paper"),
    "in a dialect": lambda: scenic_ref.loads("ego = new Object at (Range(0, 1), 0)", dialect="scenic-3"),
    "with a mark of its dialect": lambda: scenic_ref.loads("# dialect: pldi19\nego = Object at (0, 1) @ 2"),
    "with a world model": lambda: scenic_ref.loads("ego = Car", model="scenic.simulators.gta.model"),
    "one of two scenarios": lambda: scenic_ref.loads(
        "scenario A():\n    setup:\n        ego = Object at (Range(0, 1), 0)\nscenario B():\n    setup:\n        ego = Object at (5, 0)", scenario="A"
    ),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", MADE)
def test_a_pickled_scenario_draws_the_same_scenes(name: str) -> None:
    scenario = MADE[name]()
    found = again(scenario)
    assert lines(found) == lines(scenario)
    assert found.readings == scenario.readings and found.params == scenario.params
    assert lines(again(found), 2) == lines(scenario, 2)


def test_what_was_computed_is_not_pickled() -> None:
    fresh, used = scenic_ref.loads(TEXT), scenic_ref.loads(TEXT)
    lines(used)
    _ = used.pruning, used.constants
    assert pickle.dumps(used) == pickle.dumps(fresh)
    assert len(pickle.dumps(used)) < 5_000


def test_a_pickled_scenario_simulates_the_same() -> None:
    text = "behavior B():\n    while True:\n        take Range(0, 1)\nego = Object at (Range(0, 1), 0), with behavior B()"
    scenario = scenic_ref.loads(text)
    runs = [s.simulate(steps=3, seed=2).simulation for s in (scenario, again(scenario))]
    assert [m.actions for m in runs[0].moments] == [m.actions for m in runs[1].moments]


def test_a_copy_shares_what_was_computed_and_a_deep_one_draws_the_same() -> None:
    scenario = scenic_ref.loads(TEXT)
    expected = lines(scenario)
    assert copy(scenario).batch is scenario.batch
    assert lines(deepcopy(scenario)) == expected


@pytest.mark.extra("torch")
def test_a_scenario_on_a_device_is_on_it_again() -> None:
    scenario = PLAIN.on_device("cpu")
    found = again(scenario)
    assert found.device == "cpu" and lines(found) == lines(scenario)
    assert again(scenario.pruned()).device == "cpu"


# Files


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "main.scenic").write_text("from roads import place\nego = Object at (place, 0)\n")
    (tmp_path / "roads.scenic").write_text("import more\nplace = Range(0, more.far)\n")
    (tmp_path / "more.scenic").write_text("far = 9\n")
    return tmp_path


def test_a_scenario_from_a_file_finds_its_modules_from_anywhere(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory) -> None:
    monkeypatch.chdir(folder)
    scenario = scenic_ref.load("main.scenic")
    saved = pickle.dumps(scenario)
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    (folder / "main.scenic").unlink()  # its text is in the pickle
    assert lines(pickle.loads(saved)) == lines(scenario)


@pytest.mark.parametrize("text, words", [("far = 10\n", "has changed"), (None, "is not there any more")])
def test_a_module_that_is_not_what_it_was_is_told(folder: Path, text: str | None, words: str) -> None:
    saved = pickle.dumps(scenic_ref.load(folder / "main.scenic"))
    (folder / "more.scenic").unlink() if text is None else (folder / "more.scenic").write_text(text)
    with pytest.raises(UsageError, match=f"the module more {words}"):
        pickle.loads(saved)


@pytest.mark.slow
def test_another_process_draws_the_same(folder: Path) -> None:
    scenario = conditioned(scenic_ref.loads(TEXT)).pruned()
    (folder / "saved").write_bytes(pickle.dumps(scenario))
    program = "import pickle, sys; print(*(s.to_line() for s in pickle.load(open(sys.argv[1], 'rb')).sample_many(12, 3)), sep='\\n')"
    found = subprocess.run([sys.executable, "-c", program, folder / "saved"], capture_output=True, text=True, check=True, env=dict(os.environ))
    assert found.stdout.splitlines() == lines(scenario)


# What cannot be


def test_a_parameter_that_cannot_be_pickled_is_named() -> None:
    scenario = scenic_ref.loads("ego = Object", params={"good": 1, "f": lambda x: x})
    with pytest.raises(UsageError, match="the parameter f cannot be pickled"):
        pickle.dumps(scenario)


def test_a_program_without_a_text_is_refused() -> None:
    with pytest.raises(UsageError, match="with the text of its program"):
        pickle.dumps(Scenario(replace(PLAIN.program, text="")))


def test_an_error_of_the_program_is_the_same() -> None:
    scenario = scenic_ref.loads("ego = Object at (0, 0)\nx = nothing", file="mine.scenic")
    for one in (scenario, again(scenario)):
        with pytest.raises(ProgramError, match=r"mine\.scenic:2:5") as found:
            one.sample()
        assert not isinstance(found.value, ParseError)
