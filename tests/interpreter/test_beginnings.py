"""Attempts that begin where the first draw is made are those that begin where the program does, whatever the program changes in between."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.data.scene import scene_of
from scenic_ref.data.simulation import to_line
from scenic_ref.inference.rejection import sample
from scenic_ref.interpreter.runtime import program_run
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import Beginnings, generate_scene
from scenic_ref.semantics.machine.config import Config
from scenic_ref.semantics.store import budget
from scenic_ref.semantics.store.errors import ScenicError
from scenic_ref.simulators import by_name
from scenic_ref.simulators.loop import Simulated, simulate_once

CHANGES = {
    "list": ("L = [1]", "L.append(3)\nL[0] = 2", "L"),
    "dictionary": ("D = {'a': 1}", "D['b'] = 2\nD.pop('a')", "[list(D.items())]"),
    "set": ("S = {1}", "S.add(2)\nS.discard(1)", "sorted(S)"),
    "deque": ("from collections import deque\nQ = deque([1, 2])", "Q.popleft()\nQ.append(3)", "list(Q)"),
    "counter": ("from collections import Counter\nC = Counter([1, 1])", "C.update([1])", "C[1]"),
    "iterator": ("I = iter([1, 2, 3, 4])", "next(I)", "next(I)"),
    "generator": ("G = (i for i in range(9))\nnext(G)", "next(G)", "next(G)"),
    "count": ("import itertools\nI = itertools.count()", "next(I)", "next(I)"),
    "map": ("I = map(lambda v: v + 1, [1, 2, 3])", "next(I)", "next(I)"),
    "class": ("class K(object):\n    made = 0\n    def __init__(self): K.made += 1\nk = K()", "k.here = 1\nK()", "(K.made, hasattr(k, 'here'))"),
    "closure": ("def make():\n    n = 0\n    def f():\n        nonlocal n\n        n += 1\n        return n\n    return f\nf = make()", "f()", "f()"),
    "default": ("def f(v, seen=[]):\n    seen.append(v)\n    return len(seen)\nf(1)", "f(2)", "f(3)"),
    "parameter": ("param a = 1, b = [1]", "param a = globalParameters.a + 1\nglobalParameters.b.append(2)", "globalParameters.b"),
    "object": ("o = Object at (9, 9), with n 1", "o.n += 1", "o.n"),
    "exception": ("e = ValueError([1])", "e.args[0].append(2)", "e.args[0]"),
    "enumeration": ("from enum import Enum\nclass E(Enum):\n    A = 1", "E.A.note = 2", "E.A.value"),
    "mutation": ("o = Object at (9, 9)", "mutate o by 0", "1"),
    "import": ("import math\nfrom math import floor", "math.floor(x)", "floor(1.5)"),
    "definition": ("n = 1", "def h(): return n\nn = 2", "n"),
}  # fmt: skip
"""By kind: what stands before the first draw, what changes it afterwards, and what a requirement and a parameter look at."""


@pytest.mark.parametrize("kind", CHANGES)
def test_what_stands_before_the_first_draw_is_the_same_for_each_attempt(kind: str) -> None:
    before, after, seen = CHANGES[kind]
    text = f"{before}\nx = Range(0, 1)\n{after}\ny = {seen}\nparam y = y\nego = Object at (0, 0)\nrequire x > 0.9\n"
    scenario = scenic_ref.loads(text)
    found = [sample(scenario.start, 3, index) for index in range(6)]
    assert max(one.scene.attempts for one in found) > 5
    for index, one in enumerate(found):
        assert (one.scene.to_line(), one.steps) == from_the_beginning(scenario, 3, index)
        assert one.scene.params["y"] == found[0].scene.params["y"]


def from_the_beginning(scenario: Scenario, seed: int, index: int) -> tuple[str, int]:
    """The scene, and the steps of all attempts at it, each of which begins where the program does."""
    steps = 0
    for attempt in itertools.count():
        ended = generate_scene(scenario.start(), from_stream(seed, index, attempt))
        steps += ended.steps
        if isinstance(ended, program_run.Accepted):
            return scene_of(ended.state, seed, index, attempt + 1).to_line(), steps
    raise AssertionError


def ending(begin: Callable[[], Config], attempt: int, fuel: int = program_run.DEFAULT_FUEL) -> object:
    """The steps of an attempt, or its error."""
    try:
        return generate_scene(begin(), from_stream(1, 0, attempt), fuel=fuel).steps
    except ScenicError as problem:
        return problem.message


def test_an_attempt_has_as_much_fuel_as_from_the_beginning() -> None:
    scenario = scenic_ref.loads("for i in range(50): pass\nx = Range(0, 1)\nfor i in range(20): pass\nego = Object\nrequire x > 2\n")
    steps = ending(scenario.start, 0)
    assert isinstance(steps, int)
    for fuel in range(steps - 80, steps + 3):
        begin = Beginnings(scenario.start, fuel)
        assert [ending(begin, a, fuel) for a in range(3)] == [ending(scenario.start, a, fuel) for a in range(3)]


@pytest.mark.parametrize("most", range(10_000, 200_000, 10_000))
def test_an_attempt_may_do_as_much_work_as_from_the_beginning(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "LARGEST_WORK", most)
    scenario = scenic_ref.loads("L = [0] * 6000\nx = Range(0, 1)\nM = [1] * 6000\nego = Object\nrequire x > 2\n")
    begin = Beginnings(scenario.start, program_run.DEFAULT_FUEL)
    assert [ending(begin, a) for a in range(3)] == [ending(scenario.start, a) for a in range(3)]


def test_a_beginning_that_is_out_of_reach_is_made_anew() -> None:
    begin = Beginnings(scenic_ref.loads("L = [1]\nego = Object at (Range(0, 1), 0)\nL.append(2)\nparam n = len(L)\n").start, 10_000)
    for attempt in range(6):
        ended = generate_scene(begin(), from_stream(0, 0, attempt))
        assert isinstance(ended, program_run.Accepted)
        assert ended.state.params["n"] == 2
        if attempt % 2:  # driven on, as a simulation does
            ended.state.version.versions.begin_anew()


def test_simulations_are_the_same() -> None:
    text = """\
L = [1]
behavior B():
    for i in range(len(L)):
        take L[i] + self.position.x
        L.append(3)
x = Range(0, 1)
L.append(2)
ego = Object at (x, 0), with behavior B
require x > 0.5
require eventually x > 0.9
"""
    scenario = scenic_ref.loads(text)
    for backend in ("interpreter", "compiled"):
        found = scenario.simulate("still", 6, seed=4, index=1, backend=backend)
        assert found.attempts > 5
        apart = simulate_once(
            scenario.start(), from_stream(4, 1, found.attempts - 1), by_name("still", None), 6, seed=4, index=1, attempt=found.attempts - 1
        )  # fmt: skip
        assert isinstance(apart, Simulated)
        assert to_line(apart, found.attempts) == to_line(found.simulation, found.attempts)


def test_trusted_programs_begin_at_their_beginning(tmp_path: Path) -> None:
    (tmp_path / "counted.py").write_text("n = 0\ndef again():\n    global n\n    n += 1\n    return n\n")
    (tmp_path / "p.scenic").write_text("import counted\nn = counted.again()\nx = Range(0, 1)\nparam n = n\nego = Object\nrequire x > 0.7\n")
    scenario = scenic_ref.load(tmp_path / "p.scenic", trust=True)
    attempts, seen = 0, 0
    for index in range(5):
        scene = sample(scenario.start, 0, index).scene
        attempts, before, seen = attempts + scene.attempts, seen, scene.params["n"]
        assert index == 0 or seen - before == scene.attempts
    assert attempts > 5
