"""Generators, and what goes through them: the same as Python's, with Python itself as the oracle; and what Python does not know, draws."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
from scenic_ref.api import loads
from scenic_ref.semantics.store import errors

from .stepping import stepping
from .test_purity import Again

AS_IN_PYTHON = dict(
    part.split("\n", 1) for part in re.split("^# ", (Path(__file__).parent / "as_in_python.txt").read_text(), flags=re.MULTILINE)[1:]
)
"""Programs of Python, by what they show; `r` is their result."""
PRELUDE = """
seen = []
def note(x):
    seen.append(x)
    return x
def caught(f, *kinds):
    try:
        f()
    except kinds as e:
        return type(e).__name__
"""


DRAWS = [
    (
        "random elements, by keyword",
        "x = Uniform(3, 3)\nr = PolylineRegion(points=(Vector(x * i, 0) for i in range(3)))\nparam r = r.length",
        6,
    ),
    (
        'drawn when asked for',
        'g = (Uniform(x, x) for x in (1, 2))\nparam r = [next(g), sum(g)]',
        [1, 2],
    ),
    (
        'objects when asked for',
        'g = (Object at 10 * x @ 0 for x in (1, 2))\no = next(g)\nparam r = o.position.x',
        10,
    ),
    (
        'random elements',
        "x = Uniform(3, 3)\nparam r = [max(y * x for y in [1, 2]), [y for y in (x for y in 'ab')], [*map(lambda y: y + x, [1])]]",
        [6, [3, 3], [4]],
    ),
    (
        'any of random elements',
        'x = Uniform(3, 3)\nparam r = [any(x > y for y in [5, 1]), all(x > y for y in [5, 1]), any(y > x or y for y in [0, 7])]',
        [True, False, True],
    ),
    (
        'a random list of known length',
        "x = Uniform([1, 2], [1, 2])\nparam r = [list(enumerate(x)), [y for y in reversed(x)], list(zip(x, 'ab'))]",
        [[[0, 1], [1, 2]], [2, 1], [[1, 'a'], [2, 'b']]],
    ),
    (
        'resampled',
        'x = Uniform(3, 3)\nparam r = sum(resample(x) for _ in range(3))',
        9,
    ),
    (
        'distributions of a generator',
        'param r = Uniform(*(x for x in [4, 4]))',
        4,
    ),
    (
        'no draw for what is never asked for',
        'g = (Uniform(*[]) for x in [1])\nh = (x for x in [1 / 1])\nparam r = next(h)',
        1,
    ),
    (
        'in a requirement',
        'xs = [Uniform(2, 2), Uniform(3, 3)]\nrequire all(x > y for x in xs for y in [0, 1])\nparam r = 1',
        1,
    ),
]
REFUSALS = [
    (
        'a random condition',
        'x = Uniform(1, 2)\nparam r = list(y for y in [1, 2] if y > x)',
        errors.RandomBranch, 'the condition of this comprehension',
    ),
    (
        'a random number of elements',
        'x = Uniform([1], [2, 3])\nparam r = sum(y for y in x)',
        errors.RandomBranch, 'how many elements this has',
    ),
    (
        'without an end',
        'import itertools\nparam r = sum(x for x in itertools.count())',
        errors.FuelExhausted, 'endless',
    ),
    (
        'kept by library code',
        "import itertools\nparam r = list(itertools.chain.from_iterable([(x for x in 'ab')]))",
        errors.RunError, 'keeps a generator',
    ),
    (
        'a draw for library code',
        'import functools\nparam r = functools.reduce(lambda a, b: a + next(Uniform(x, x) for x in [b]), [1, 2])',
        errors.RunError, 'draws a random',
    ),
]


def result_of(program: str) -> object:
    return plain(loads(f"ego = Object\n{program}\n").sample().params["r"])


def plain(value: object) -> object:
    """Lists for tuples, all the way down."""
    return [plain(v) for v in value] if isinstance(value, (list, tuple)) else value


@pytest.mark.parametrize("claim", AS_IN_PYTHON)
def test_as_in_python(claim: str):
    program = PRELUDE + AS_IN_PYTHON[claim]
    scope: dict[str, object] = {}
    exec(program, scope)
    assert result_of(f"{program}\nparam r = r") == plain(scope["r"])


@pytest.mark.parametrize(("program", "expected"), [each[1:] for each in DRAWS], ids=[each[0] for each in DRAWS])
def test_draws(program: str, expected: object):
    assert result_of(program) == expected


@pytest.mark.slow
@pytest.mark.parametrize(("program", "kind", "message"), [each[1:] for each in REFUSALS], ids=[each[0] for each in REFUSALS])
def test_refused(program: str, kind: type[errors.ScenicError], message: str):
    with pytest.raises(kind) as caught:
        result_of(program)
    assert message in caught.value.message
    assert caught.value.span.line in (2, 3)


LAW = """
ego = Object
g = (Uniform(1, 2) + x for x in [0, 10, 20] if x != 10)
first = next(g)
param a = first, b = sum(g), c = any(y > 3 for y in map(lambda x: x * first, [1, 2])), d = Uniform(*(x for x in [1, 2, 2]))
"""


def test_every_backend_draws_them():
    scenario = loads(LAW)
    law = scenario.enumerate().law(lambda scene: (scene.params["a"], scene.params["b"], scene.params["c"], scene.params["d"]))
    assert len(law) == 8
    assert sum(p for (a, _, c, _), p in law.items() if c is (a == 2)) == 1
    assert sum(p for (*_, d), p in law.items() if d == 2) == Fraction(2, 3)
    expected = [scene.to_line() for scene in scenario.sample_many(40, backend="interpreter")]
    assert scenario.batch is not None
    assert [scene.to_line() for scene in scenario.sample_many(40, backend="batch")] == expected


@pytest.mark.slow
def test_a_configuration_can_be_stepped_again():
    """What a generator gave is given again, and what its body did is done again, whatever it gave in between (`docs/machine.md`)."""
    for claim, program in AS_IN_PYTHON.items():
        watching = Again(share=1.0)
        with stepping(watching):
            result_of(f"{PRELUDE}{program}\nparam r = r")
        assert watching.compared > 20, claim


def test_agents_share_a_generator():
    """`for` asks for an element in each turn, so each agent gets some; a list would be used up by the first."""
    result = loads(AGENTS, dialect="scenic-2.1").simulate(seed=0, steps=3, backend="interpreter")
    assert plain(result.simulation.records["log"][0][1]) == [["a", 0], ["b", 10], ["a", 20], ["b", 30], ["a", 40], ["b", 50]]


AGENTS = """
log = []
g = (x * 10 for x in range(6))
behavior B(name):
    for x in g:
        log.append((name, x))
        take x
ego = Object with behavior B('a')
Object at 9 @ 9, with behavior B('b')
record final list(log) as log
"""
