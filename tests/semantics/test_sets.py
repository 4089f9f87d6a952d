"""Sets, hashes and texts depend on the program alone: not on how Python hashes texts, nor on where it puts objects."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
import scenic_ref
from hypothesis import given
from hypothesis import strategies as st
from scenic_ref.semantics.store import errors
from scenic_ref.semantics.store.sets import FrozenSet, Set

PROGRAM = """
import enum
class C(object):
    pass
class K(object):
    def __init__(self, v):
        self.v = v
    def __hash__(self):
        return hash(('K', self.v))
    def __eq__(self, other):
        return self.v == other.v
class Color(enum.Enum):
    RED = 'red'
    BLUE = 'blue'
ego = Object with fruit Uniform(*{'apple', 'pear', 'plum'})
a, b = {'x', 'y', 'z', 'w'}, frozenset(['w', 'v', 'x'])
param both = list(a & b), either = list(a | b), less = list(a - b), one = list(a ^ b), keys = list({'q': 1, 'r': 2, 's': 3}.keys() & {'s', 'q'}), \
    comprehended = [v for v in {w + w for w in 'hello'}], text = str({'k', 'l', 'm'}), hashes = [hash('a'), hash(('b', 1)), hash(K('c'))], \
    objects = repr([C(), C]), method = repr([].append), colors = list({Color.RED, Color.BLUE})[0].name, \\
    popped = {'p', 'o'}.pop(), unique = list(set('banana'))
"""
WORKER = "import scenic_ref, sys; s = scenic_ref.loads(sys.stdin.read()); print(*(s.sample(3, i).to_line() for i in range(5)), sep='\\n')"


def lines_with(hash_seed: str) -> str:
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
    return subprocess.run([sys.executable, "-c", WORKER], input=PROGRAM, capture_output=True, text=True, check=True, env=environment).stdout


@pytest.mark.slow
def test_a_scene_does_not_depend_on_how_python_hashes():
    first = lines_with("0")
    assert "apple" in first or "pear" in first or "plum" in first
    assert " at 0x" not in first
    assert first == lines_with("1") == lines_with("4242")


def test_what_has_no_value_of_its_own_has_no_hash():
    with pytest.raises(errors.UncaughtException, match="depends on its address"):
        scenic_ref.loads("class C(object):\n    pass\nego = Object\nx = hash(C())\n").sample()


texts = st.lists(st.sampled_from("abcdefgh"))


@given(texts, texts, st.sampled_from(["union", "intersection", "difference", "symmetric_difference"]), st.booleans())
def test_sets_are_those_of_python_in_an_order_of_their_own(left, right, method, frozen):
    kind, plain = (FrozenSet, frozenset) if frozen else (Set, set)
    made = getattr(kind(left), method)(right)
    assert type(made) is kind
    assert made == getattr(plain(left), method)(right)
    assert list(made) == [v for v in dict.fromkeys([*left, *right]) if v in made]
    operator = {"union": "__or__", "intersection": "__and__", "difference": "__sub__", "symmetric_difference": "__xor__"}[method]
    assert list(getattr(kind(left), operator)(kind(right))) == list(made)
    if not frozen:
        changed = Set(left)
        {"union": changed.update}.get(method, getattr(changed, f"{method}_update", None))(right)  # type: ignore[misc]
        assert list(changed) == list(made)
        assert set(changed) == made
        assert len(changed) == len(made)


@given(texts, st.sampled_from("abcdefgh"))
def test_changes_keep_the_order(items, item):
    changed, order = Set(items), dict.fromkeys(items)
    changed.add(item)
    order[item] = None
    assert list(changed) == list(order)
    changed.discard(item)
    order.pop(item)
    assert list(changed) == list(order) == list(changed.copy())
    if order:
        assert changed.pop() == next(iter(order))
