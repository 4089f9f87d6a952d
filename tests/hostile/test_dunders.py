"""Hostile classes and extreme arguments: nothing of Python's own C code reads memory, or dies, and none of their errors is ours."""

from __future__ import annotations

import builtins
import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.semantics.machine import sandbox_table
from scenic_ref.semantics.python import string_methods
from scenic_ref.semantics.store import errors

sys.path.insert(0, str(Path(__file__).parent))
dunders = importlib.import_module("dunders")
sys.path.pop(0)

RUNNING = """
import sys, scenic_ref
from scenic_ref.semantics.store import errors
text = sys.stdin.read()
try:
    print("scene", scenic_ref.loads(text, fuel=200_000).sample(0, max_attempts=2).to_line())
except (errors.ProgramError, errors.AttemptsExhausted) as error:
    print(type(error).__name__, error, error.hint)
"""
REMOVING = """import collections, functools, itertools
n = [0]
L = []
D = {{}}
O = collections.OrderedDict()
Q = collections.deque()
C = collections.Counter()
class K(object):
    def __init__(self, v): self.v = v
    def __hash__(self): return 1
    def {name}(self, o):
        n[0] = n[0] + 1
        if n[0] == {when}:
            L.clear()
            D.clear()
            O.clear()
            Q.clear()
            C.clear()
        return {answer}
L += [K(1), K(2), K(3)]
Q += [K(1), K(2), K(3)]
for i in [0, K(1), 4.2, 5]:
    try:
        D[i] = i
        O[i] = i
        C[i] = i
    except Exception:
        pass
E = O.copy()
n[0] = 0
{use}
ego = Object
"""
"""A program in which a method removes what Python is looking at."""
USES = {
    "OrderedDict": ("__eq__", "x = O == E"), "OrderedDict.update": ("__eq__", "O.update(E)"), "OrderedDict.pop": ("__eq__", "O.pop(K(9), 0)"), "dict": ("__eq__", "D[K(9)] = 1"),
    "dict.setdefault": ("__eq__", "D.setdefault(K(9), 1)"), "dict.update": ("__eq__", "D.update({K(9): 1})"), "list <": ("__lt__", "x = L < [K(1)]"), "nested <": ("__lt__", "x = (L, 1) < ([K(1)], 1)"),
    "sort": ("__lt__", "L.sort()"), "sorted": ("__lt__", "x = sorted([L, [K(1)]])"), "sorted by a key": ("__lt__", "x = sorted([1, 2], key=lambda v: L)"), "max": ("__gt__", "x = max(L, [K(1)])"),
    "deque <": ("__lt__", "x = Q < collections.deque([K(1)])"), "deque.index": ("__eq__", "x = Q.index(4)"), "deque.remove": ("__eq__", "Q.remove(4)"), "deque.count": ("__eq__", "x = Q.count(4)"),
    "in a deque": ("__eq__", "x = 4 in Q"), "Counter": ("__add__", "C[1] = K(1)\nC.update([1, 1])"), "list.index": ("__eq__", "x = L.index(4)"), "in a list": ("__eq__", "x = 4 in L"),
}  # fmt: skip


def end_of(text: str) -> str:
    """How a program ends in a process of its own: "scene" or the class of its error, and what is said."""
    done = subprocess.run([sys.executable, "-X", "faulthandler", "-c", RUNNING], input=text, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{text}\n{done.stderr[-2000:]}"
    assert not dunders.ADDRESS.search(done.stdout), done.stdout
    return done.stdout


@pytest.mark.sampled(6)
@pytest.mark.parametrize("when", [1, 2, 3])
@pytest.mark.parametrize("answer", ["True", "False", "NotImplemented"])
@pytest.mark.parametrize("use", USES)
def test_what_python_looks_at_is_not_removed_under_its_hands(use, answer, when):
    name, statement = USES[use]
    assert end_of(REMOVING.format(name=name, when=when, answer=answer, use=statement))


def test_a_method_that_compares_may_change_other_containers():
    text = "seen = []\nclass K(object):\n    def __lt__(self, o):\n        seen.append(1)\n        return False\nego = Object\nparam a = len(sorted([K(), K(), K()])), b = len(seen)\n"
    scene = scenic_ref.loads(text).sample()
    assert scene.params == {"a": 3, "b": 2}


def test_a_method_that_compares_may_not_change_what_is_compared():
    with pytest.raises(errors.RunError, match="may not change the container"):
        scenic_ref.loads("d = {}\nclass K(object):\n    def __hash__(self):\n        d[1] = 1\n        return 1\nd[K()] = 2\nego = Object\n").sample()


@pytest.mark.parametrize("arguments", ["-10 ** 12, -10 ** 12 + 1", "-1, 0", "0, 10 ** 12", "10 ** 12, 10 ** 12 + 1", "2, 3", "N(-1), N(0)"])
@pytest.mark.parametrize("class_", ["UnicodeDecodeError('utf-8', b'a', {}, 'r')", "UnicodeEncodeError('utf-8', 'a', {}, 'r')", "UnicodeTranslateError('a', {}, 'r')"])
@pytest.mark.parametrize("way", ["str({})", "M({})", "list(map(lambda v: {}, [1]))", "functools.partial({})()"])
def test_no_exception_has_a_place_outside_of_its_text(class_, arguments, way):
    name, _, rest = class_.format(arguments).partition("(")
    made = way.format(rest[:-1]) if way.startswith("M") else way.format(f"{name}, {rest[:-1]}" if "partial" in way else f"{name}({rest}")
    below = f"import functools\nclass N(int):\n    def __index__(self): return 0\nclass M({name}):\n    def __init__(self, *a):\n        super().__init__(*a)\n"
    with pytest.raises(errors.RunError, match="lie within its text"):
        scenic_ref.loads(f"{below}ego = Object\nx = {made}\n").sample()


def test_an_exception_about_a_place_in_a_text_says_what_it_always_did():
    scene = scenic_ref.loads("ego = Object\nparam x = str(UnicodeDecodeError('utf-8', b'ab', 1, 2, 'r'))\n").sample()
    assert scene.params["x"] == "'utf-8' codec can't decode byte 0x62 in position 1: r"


LYING = {
    "a text": ("class S(str):\n    def __str__(self): return 3\nparam p = S('a'), q = {S('k'): S('v')}", {"p": "a", "q": {"k": "v"}}),
    "a dictionary": ("class D(dict):\n    def items(self): return 3\n    def values(self): return 4\n    def __iter__(self): return 5\nparam p = D(a=1)", {"p": {"a": 1}}),
    "a list": ("class L(list):\n    def __iter__(self): return 3\n    def __len__(self): return -1\nparam p = L([1])", {"p": [1]}),
    "a tuple": ("class T(tuple):\n    def __iter__(self): return 3\nparam p = T([1])", {"p": [1]}),
    "a number": ("class I(int):\n    def bit_length(self): return 'a'\n    def __repr__(self): return 3\nparam p = I(7)", {"p": 7}),
    "fields": ("class R(tuple):\n    _field_defaults = 3\n    _fields = 4\nr = R([1])\ntry:\n    r.x\nexcept AttributeError:\n    pass\nparam p = r", {"p": [1]}),
    "arguments": ("class E(Exception):\n    args = 7\ntry:\n    raise E(1)\nexcept E as e:\n    pass\nparam p = 1", {"p": 1}),
    "a hash that changes": ("n = [0]\nclass H(object):\n    def __hash__(self):\n        n[0] += 1\n        return n[0]\nd = {H(): 1}\nd[H()] = 2\nparam p = len(d)", {"p": 2}),
}  # fmt: skip


@pytest.mark.parametrize("what", LYING)
def test_what_a_class_says_of_its_instances_does_not_change_what_they_are(what):
    text, params = LYING[what]
    assert scenic_ref.loads(f"ego = Object\n{text}\n").sample().to_json()["params"] == params


ADDRESSES = ["Discrete({1: A()})", "Uniform(A(), 1) + 1", "Range(A(), 1)", "CircularRegion(A(), 1)", "Object at A()", "int(A())", "{}[A()]", "[].index(A())", "Discrete({A(): A()})", "math.sin(A())", "A().b", "'%d' % A()",
             "raise ValueError(A())", "raise KeyError(A())", "Object with width A()", "Options([A()]) + 1", "follow A() for 1", "DiscreteRange(A(), 1)", "assert False, A()", "Normal(0, [A()])"]  # fmt: skip


@pytest.mark.parametrize("use", ADDRESSES)
def test_no_message_tells_an_address(use):
    with pytest.raises(errors.ProgramError) as caught:
        scenic_ref.loads(f"import math\nclass A(object):\n    pass\nego = Object\n{use if use.startswith(('raise', 'assert')) else f'x = {use}'}\n").sample()
    assert not dunders.ADDRESS.search(f"{caught.value} {caught.value.hint}")


def test_whether_digits_are_too_many_is_known_without_asking_what_an_exception_is_made_of():
    class Hostile:
        def __str__(self) -> str:
            raise AssertionError

    assert not string_methods.too_many_digits(ValueError(Hostile())) and not string_methods.too_many_digits(ValueError())
    with pytest.raises(ValueError) as caught:
        str(10**5000)
    assert string_methods.too_many_digits(caught.value)


@pytest.mark.parametrize("number", ["n5:8", "n11:338"])
def test_an_exception_that_a_comparison_raises_is_the_programs(number):
    seed, _, k = number.partition(":")
    assert dunders.attack(dunders.put_together(seed, int(k))) == "UncaughtException"


def test_an_iterator_is_not_asked_again_while_it_is_asked():
    text = """import itertools
class E(object):
    def __iter__(self): return self
    def __next__(self): return next(i[0])
ego = Object
param ends = []
i = [0]
for make in [lambda: itertools.islice(E(), 3), lambda: iter(E()), lambda: itertools.chain(E()), lambda: itertools.zip_longest(E(), [1]), lambda: itertools.pairwise(E()), lambda: itertools.cycle(E())]:
    i[0] = make()
    try:
        next(i[0])
    except ValueError as e:
        globalParameters.ends.append(str(e))
"""
    assert scenic_ref.loads(text).sample().params["ends"] == ["iterator already executing"] * 6


def test_every_type_of_the_table_says_why_it_is_safe():
    asked = {t for t in sandbox_table.ATTRIBUTES if t.__module__ in ("builtins", "types", "enum", "collections") or t.__module__.endswith(".containers")}
    assert asked <= sandbox_table.SAFE.keys()
    assert sandbox_table.SAFE.keys() <= sandbox_table.ATTRIBUTES.keys()


def test_every_function_of_the_table_says_why_it_is_safe():
    assert {getattr(builtins, name) for name in sandbox_table.BUILTINS} <= sandbox_table.FUNCTIONS
    assert all(sandbox_table.SAFE_FUNCTIONS.values())


def test_hostile_programs_end_in_no_defect():
    ended = list(dunders.run_apart("quick", 0, 60))
    assert len(ended) == 60
    assert not [e for e in ended if e.end.startswith("DEFECT")]
    assert len({e.end for e in ended}) > 2


@pytest.mark.slow
def test_many_hostile_programs_end_in_no_defect():
    ended = list(dunders.run_apart("slow", 0, int(os.environ.get("SCENIC_REF_HOSTILE", "1000"))))
    assert not [e for e in ended if e.end.startswith("DEFECT")]
