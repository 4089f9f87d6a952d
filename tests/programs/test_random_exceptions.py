"""No program learns from an exception what was drawn: what something random raises is not caught, by any backend (reading `random-branch`)."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import RandomBranch

SEEDS = range(8)
DEFINITIONS = """
ego = Object with foo 1
o2 = Object at 10 @ 10
def f(a): return a
def g(a, b=2): return a
def unpacked(u):
    a, b = u
def unpacked_in_a_loop(u):
    for a, *b in [u]:
        pass
def augmented(u):
    u += 3
def thrown(u):
    raise u
def thrown_from(u):
    raise KeyError('a') from u
def asserted(u):
    assert u
def said(u):
    assert False, u
class C(list):
    z = 3
    def m(self): return 1
    def __getitem__(self, i): return 1
class D(dict):
    def __getitem__(self, i): raise KeyError(i)
"""
RAISED_BY_SOME = [
    ("[1]", "[1, 2]", "u[1]"), ("0", "5", "[1, 2][u]"), ("'a'", "'b'", "{'a': 1}[u]"), ("1", "'a'", "[1, 2][:u]"), ("C()", "D()", "u[0]"),
    ("1.5", "(1 @ 2)", "u.x"), ("1.5", "(1 @ 2)", "getattr(u, 'x')"), ("'real'", "'nope'", "getattr(1.0, u)"), ("ego", "o2", "u.foo"),
    ("'a'", "[1]", "u.upper()"), ("C()", "2", "u.m()"), ("C()", "D()", "u.z"), ("1", "[1]", "{u: 3}"), ("1", "[1]", "{u}"), ("1", "[1]", "hash(u)"),
    ("{'a': 1}", "{'b': 1}", "f(**u)"), ("{'a': 1}", "3", "{**u}"), ("[1]", "[1, 2, 3, 4]", "g(*u)"), ("[1]", "3", "(*u,)"),
    ("abs", "3", "u(1)"), ("f", "3", "u(1)"), ("C", "2", "u()"), ("[1, 2]", "[1, 2, 3]", "unpacked(u)"), ("[]", "[1, 2]", "unpacked_in_a_loop(u)"),
    ("[1, 2]", "3", "1 in u"), ("1 @ 2", "3", "u in everywhere"), ("'a'", "3", "u < 3"), ("'a'", "3", "u + 3"), ("'a'", "3", "-u"),
    ("'a'", "3", "augmented(u)"), ("'a'", "3", "f'{u:d}'"), ("'a'", "3", "'%d' % u"), ("'a'", "3", "int(u)"), ("0", "1", "1 / u"),
    ("True", "False", "asserted(u)"), ("[]", "[1]", "next(iter(u))"), ("[1]", "[2]", "u.index(2)"), ("1", "2", "[1].index(u)"),
    ("int", "3", "isinstance(3, u)"), ("int", "3", "issubclass(u, int)"), ("'a'", "2", "sorted([1, u])"), ("'a'", "2", "max([1, u], key=abs)"),
    ("'a'", "2", "[abs(x) for x in [u]]"), ("[1]", "[(1, 2)]", "dict(u)"), ("-1", "65", "chr(u)"),
]  # fmt: skip
RAISED_BY_ALL = [("ValueError('x')", "KeyError('y')", "thrown(u)"), ("ValueError", "KeyError", "thrown(u)"), ("1", "2", "thrown(ValueError(u))"),
    ("ValueError('x')", "KeyError('y')", "thrown_from(u)"), ("1", "2", "said(u)"), ("[]", "{}", "u[0]")]  # fmt: skip


def program(first: str, second: str, operation: str) -> str:
    return f"{DEFINITIONS}u = Uniform({first}, {second})\nz = 1\ntry:\n    y = {operation}\nexcept Exception:\n    z = 2\nparam z = z\n"


@pytest.mark.parametrize(("first", "second", "operation"), RAISED_BY_SOME + RAISED_BY_ALL)
def test_what_something_random_raises_is_not_caught(first: str, second: str, operation: str) -> None:
    scenario = scenic_ref.loads(program(first, second, operation))
    refused = 0
    for seed in SEEDS:
        try:
            assert scenario.sample(seed=seed).params["z"] == 1
        except RandomBranch:
            refused += 1
    assert 0 < refused <= len(SEEDS)
    assert refused == len(SEEDS) or (first, second, operation) in RAISED_BY_SOME
    with pytest.raises(RandomBranch):
        for _ in scenario.sample_many(20, seed=0):
            pass


CAUGHT = ["f(u, u)", "f(u, b=2)", "g(b=u)", "[u][1]", "{'a': u}['b']", "ego.nothing", "o2.foo", "[1].index(3)", "{u: 1}.nothing", "abs.nothing"]


@pytest.mark.parametrize("operation", CAUGHT)
def test_what_is_raised_whatever_is_drawn_is_caught(operation: str) -> None:
    scenario = scenic_ref.loads(program("1", "2", operation))
    if operation.startswith("{u"):  # the dictionary is random as a whole
        with pytest.raises(RandomBranch):
            scenario.sample(seed=0)
        return
    assert {scene.params["z"] for scene in scenario.sample_many(12, seed=0)} == {scenario.sample(seed=1).params["z"]} == {2}


BEHAVIOR = """
u = Uniform('a', '1')
behavior B():
    while True:
        try:
            take int(u)
        except ValueError:
            take 10
ego = Object with behavior B
"""


def test_a_behavior_may_catch_it() -> None:
    scenario = scenic_ref.loads(BEHAVIOR)
    taken = {scenario.simulate(steps=1, seed=seed, backend="interpreter").simulation.moments[0].actions[0][0] for seed in SEEDS}
    assert taken == {1, 10}
