"""Corners in which compiled behaviors once differed from the machine: whose draws and exceptions are whose, identity, limits, what is told."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.inference import simulation_rejection

from .compared import differences, said

AGAIN = """
def again(runtime):
    try:
        raise
    except RuntimeError:
        return runtime
    except ValueError:
        return not runtime
"""
HANDLING = """
behavior B():
    try:
        raise ValueError('x')
    except ValueError:
        while True:
            take [1]
"""
SAME = {
    "a drawn invariant beside actions that the machine reduces": """
behavior B():
    while True:
        take [Range(0, 1)]
scenario Main():
    invariant: Range(0, 1) < 0.8
    setup:
        ego = new Object with behavior B()
""",
    "an invariant sees no exception that a behavior handles": f"""{AGAIN}{HANDLING}
scenario Main():
    invariant: again(True)
    setup:
        ego = new Object with behavior B()
""",
    "nor does a condition beside a compose block": f"""{AGAIN}{HANDLING}
scenario Main():
    setup:
        ego = new Object with behavior B()
        terminate when again(False)
    compose:
        while True:
            wait
""",
    "behaviors at the same time handle nothing of their caller": """
behavior A():
    try:
        raise
    except RuntimeError as e:
        take 'runtime', str(e)
    except ValueError:
        take 'value'
behavior C():
    take 'c'
behavior B():
    try:
        raise ValueError('x')
    except ValueError:
        do A(), C()
ego = new Object with behavior B()
""",
    "and what they raise is seen by it": """
behavior A():
    raise
behavior B():
    try:
        raise ValueError('x')
    except ValueError:
        try:
            do A(), A()
        except RuntimeError:
            take 'runtime'
        except ValueError:
            take 'value'
        try:
            raise
        except ValueError as e:
            take str(e)
ego = new Object with behavior B()
""",
    "each precondition of an option has a scope of its own": """
def pop(m):
    return m.pop('a', 0) == 1
behavior A(**m):
    precondition: pop(m)
    precondition: pop(m)
    take 'a'
behavior B():
    do choose A(a=1)
ego = new Object with behavior B()
""",
    "a list that was given is told as it is now": """
xs = [1]
behavior A(ys):
    while True:
        take len(ys)
        ys.append(0)
behavior B():
    do A(xs)
ego = new Object with behavior B()
""",
    "equal literals are not identical": """
behavior B():
    x, y, z = 1000, 'a b', 2.5
    take x is 1000, y is 'a b', z is 2.5
    take None is None, True is True
ego = new Object with behavior B()
""",
    "actions of constants are not identical": """
from scenic.domains.driving.actions import *
seen = []
behavior B():
    while True:
        a = SetBrakeAction(0.5)
        seen.append(a)
        take 1 if seen[0] is a else 2
ego = new Object with behavior B()
""",
    "behaviors count among open calls": """
def f(n):
    return 0 if n <= 0 else 1 + f(n - 1)
behavior C(n):
    take f(n)
behavior B():
    do C(2998)
ego = new Object with behavior B()
""",
    "texts are compared": """
x = 'a' * 300
behavior B(mode='go'):
    take mode == 'go', mode != 'go', mode == 'stop', x == x + '', x != 'a', mode == 3
ego = new Object with behavior B()
""",
    "a variable grows by what is not a number": """
class Car(Object):
    speed: 3
behavior B():
    x = 1
    y = [1]
    z = 'a'
    for i in range(3):
        x += self.speed
        y += [i]
        z += 'b'
        take x, len(y), z
ego = new Car with behavior B()
""",
}

ERRORS = {"behaviors count among open calls"}
"""Those of the programs whose simulations end with an error."""


@pytest.mark.parametrize("name", SAME)
def test_the_machine_says_the_same(name: str) -> None:
    scenario = scenic_ref.loads(SAME[name], dialect="scenic-3")
    assert not list(differences(scenario, range(3), steps=12))
    found = [said(scenario, "compiled", seed, steps=12)[0] for seed in range(3)]
    assert all(isinstance(one, type if name in ERRORS else str) for one in found)


@pytest.mark.parametrize("retry", ["retry", "discard"])
def test_drawn_invariants_of_a_scenario_are_drawn_anew(retry: str) -> None:
    """Also when its scene is kept: a scenario without a compose block once drew the same in each of its simulations."""
    text = "scenario Main():\n    invariant: Range(0, 1) < 0.6\n    setup:\n        ego = new Object"
    scenario = scenic_ref.loads(text, dialect="scenic-3", readings={"rejected-simulation": retry})
    failed = []
    for backend in ("compiled", "interpreter"):
        steps: list[int | None] = []
        scenario.simulate(steps=8, seed=1, backend=backend, on_failed=lambda one, steps=steps: steps.append(one.step))
        failed.append(steps)
    assert failed[0] == failed[1]
    assert len(failed[0]) > 2
    assert len(set(failed[0])) > 1


@pytest.mark.parametrize(
    "text",
    [
        "behavior B:\n    while True:\n        if simulation.currentTime > 0:\n            continue\n        wait\nego = Object with behavior B",
        "behavior B:\n    xs = [1]\n    for x in xs:\n        xs.append(1)\n        if x: continue\n        take 1\nego = Object with behavior B",
        "monitor M:\n    while True:\n        if simulation.currentTime > 0:\n            continue\n        wait\nego = Object",
    ],
)
def test_a_loop_that_goes_round_its_take_is_an_endless_one(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation_rejection, "DEFAULT_FUEL", 20_000)
    scenario = scenic_ref.loads(text, fuel=20_000)
    assert said(scenario, "compiled", 0, steps=3) == said(scenario, "interpreter", 0, steps=3)
    assert set(scenario.compiled.wholes) == {"a time step of very many turns"}


@pytest.mark.parametrize("fuel", [300, 900, 1500, 2000, 20_000])
def test_fuel_is_that_of_a_time_step(fuel: int) -> None:
    text = (
        "def work(n):\n    s = 0\n    for i in range(n):\n        s = s + i\n    return s\n"
        "behavior B:\n    t = 0\n    for i in range(20):\n        t = t + work(20)\n    take t\nego = Object with behavior B"
    )
    assert not list(differences(scenic_ref.loads(text, fuel=fuel), range(1), steps=2))


def test_what_the_machine_does_for_compiled_code_has_half_of_the_fuel(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that what it did not do for it fits into the rest."""
    monkeypatch.setattr(simulation_rejection, "DEFAULT_FUEL", 100)
    text = "behavior B:\n    for i in range(20):\n        x = [k for k in range(10)]\n    take len(x)\nego = Object with behavior B"
    verdicts = []
    for fuel in range(500, 40_500, 2_500):
        scenario = scenic_ref.loads(text, fuel=fuel)
        verdicts.append((said(scenario, "compiled", 0, steps=2) == said(scenario, "interpreter", 0, steps=2), bool(scenario.compiled.wholes)))
    assert {same for same, _ in verdicts} == {True}
    assert {left for _, left in verdicts} == {True, False}


def test_long_texts_that_are_compared_cost_the_run_what_they_cost_the_machine() -> None:
    text = (
        "x = 'a' * 100000\ny = 'a' * 100000\nbehavior B:\n    n = 0\n    for i in range(4900):\n        if x == y:\n            n = n + 1\n"
        "    take n\nego = Object with behavior B"
    )
    scenario = scenic_ref.loads(text)
    assert said(scenario, "compiled", 0, steps=2) == said(scenario, "interpreter", 0, steps=2)
