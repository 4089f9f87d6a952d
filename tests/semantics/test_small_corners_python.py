"""Corners of what Scenic takes over from Python that no vector can show: messages, limits of our own, modules of Python."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.data.scene import json_value
from scenic_ref.semantics.python.builtins import BUILTINS
from scenic_ref.semantics.store.errors import ProgramError, ScenicError

EGO = "ego = Object at (0, 0)\n"
BIG = 2**90_000


@pytest.mark.parametrize(
    ("program", "told"),
    [
        ("x = DiscreteRange(1, 2, {1: 1, 2: 1})", "must be a list of 2 numbers"),
        ("x = Options(5)", "options must be given as [value, ...] or {value: weight, ...}"),
        ("x = set([-i * (2 ** 61 - 1) for i in range(8000)])", "too many keys, or members of a set, have the same hash"),
        ("x = DiscreteRange(1, 100001)", "between 1 and 100,000 numbers"),
        ("class Car(Object, ValueError):\n    pass", "cannot be derived from the Python class ValueError as well"),
        ("class Car(Object, 'fast'):\n    pass", "cannot be derived from a string as well"),
        ("def f():\n    return f()\nx = f()", "f is called too deeply (3000 calls are open)"),
        ("x = '{0.real}'.format(1)", "a format string reads no attributes"),
        ("x = '{0[0]real}'.format('ab')", "a format string reads no attributes"),
        ("p = property(lambda self: 1)\nq = p.setter(p)", "setter does not hold another of its kind"),
    ],
)
def test_a_refused_piece_of_python_is_told_what_is_wrong(program: str, told: str) -> None:
    with pytest.raises(ScenicError) as caught:
        scenic_ref.loads(EGO + program + "\n").sample()
    assert told in caught.value.message


@pytest.mark.parametrize(
    ("use", "told"),
    [
        ("(2 ** 1000) ** 100", "a power is too large"),
        ("pow(2, 3, 2 ** 9000)", "a whole number of 144,016 binary digits is too large"),
        ("('a' * 2000 + 'c').translate({97: 'b' * 2000})", "4,002,000 elements or characters are too many"),
        ("('c' * 2001).translate({97: 'b' * 2000})", "4,002,000 elements or characters are too many"),
        ("('a' * 100000).rfind('b' * 100000)", "the program goes through more, or makes more, than one run may"),
        ("[len(list(numbers)) for i in range(80)]", "the program goes through more, or makes more, than one run may"),
        ("max([2000000] * 250, key=bytes)", "the program goes through more, or makes more, than one run may"),
    ],
)
def test_what_one_call_may_make_has_limits(use: str, told: str) -> None:
    with pytest.raises(ScenicError) as caught:
        scenic_ref.loads(f"{EGO}numbers = [0] * 1000000\nx = {use}\n").sample()
    assert told in caught.value.message


@pytest.mark.parametrize(
    "use",
    [
        "[len(list([0] * 100000)) for i in range(80)]",
        "('ab' * 900000).translate({97: 'c'})",
        "(2 ** 999) ** 100",
        "pow(2 ** 6000, 3, 2 ** 6000)",
        "('a' * 90000).rfind('ab')",
        "max([2000] * 250, key=bytes)",
    ],
)
def test_what_is_within_these_limits_is_made(use: str) -> None:
    assert scenic_ref.loads(f"{EGO}x = {use}\nparam done = 1\n").sample().params["done"] == 1


def test_a_module_beside_the_program_is_named_with_its_dots(tmp_path: Path) -> None:
    (tmp_path / "road.scenic").write_text("lanes = 2\n")
    with pytest.raises(ScenicError, match=r"the module \.road has no width"):
        scenic_ref.loads(f"{EGO}from .road import width\n", directory=tmp_path).sample()


def test_what_a_program_changes_in_a_module_of_python_no_other_run_sees(tmp_path: Path) -> None:
    (tmp_path / "python_of_small_corners.py").write_text("lanes = [1, [2]]\nroads = {'main': [3]}\n")
    program = "from python_of_small_corners import lanes, roads\nparam n = [len(lanes), len(lanes[1]), len(roads), len(roads['main'])]\n"
    program += "lanes.append(5)\nlanes[1].append(6)\nroads['side'] = 7\nroads['main'].append(8)\n"
    scenario = scenic_ref.loads(EGO + program, directory=tmp_path, trust=True)
    assert [scenario.sample(seed=seed).params["n"] for seed in (1, 2)] == [[2, 1, 1, 1]] * 2


def test_a_value_with_a_number_too_long_to_write_is_told_by_its_kind() -> None:
    assert json_value({frozenset({BIG})}) == {"repr": "set with a part, such as a long number, that is not written"}
    assert json_value(frozenset({1})) == {"repr": "frozenset({1})"}


def test_a_choice_among_lists_of_different_lengths_is_left_to_no_interpreter() -> None:
    scenario = scenic_ref.loads(f"{EGO}xs = Uniform([1, 2], [3])\nx = Uniform(*xs)\nparam x = x\n")
    assert scenario.batch is not None and scenario.batch.block(2, 0, 12).left == 0
    drawn, one_by_one = ([s.params["x"] for s in scenario.sample_many(12, seed=2, backend=b)] for b in ("batch", "interpreter"))
    assert drawn == one_by_one and set(drawn) == {1, 2, 3}


def test_what_is_built_in_has_names_that_a_program_can_write() -> None:
    assert [name for name in BUILTINS if not name.isidentifier()] == []
    assert {"resample", "localPath", "super"} <= set(BUILTINS)


@pytest.mark.parametrize("base", ["int", "float"])
@pytest.mark.parametrize("x", ["3", "Uniform(3, 3)"])
def test_a_class_below_a_number_says_itself_what_is_in_it(base: str, x: str) -> None:
    program = f"class A({base}):\n    def __contains__(self, x): return x == 3\nego = Object\nparam r = ({x} in A(4), {x} not in A(4), 5 in A(4))\n"
    assert scenic_ref.loads(program).sample().params["r"] == (True, False, False)


@pytest.mark.parametrize(
    ("definition", "made"),
    [("class A(object): pass", "A()"), ("class A(int): pass", "A(3)"), ("class A(object):\n    def __init__(self): self.v = 0", "A()"),
     ("class A(tuple): pass", "A((1, 2))"), ("class A(object): pass", "(1, A())")],
)
def test_an_instance_of_a_python_class_cannot_be_drawn_again(definition: str, made: str) -> None:
    with pytest.raises(ProgramError, match="resample needs a value drawn from a distribution"):
        scenic_ref.loads(f"{definition}\nego = Object\na = {made}\nb = resample(a)\n").sample()


def test_what_cannot_change_can_be_drawn_again() -> None:
    program = "from collections import namedtuple\nfrom enum import Enum\nP = namedtuple('P', 'a b')\nclass E(Enum):\n    A = 1\n"
    program += "ego = Object\nparam r = (resample(P(1, 2)) == P(1, 2), resample(E.A) is E.A, resample(3), resample('a'))\n"
    assert scenic_ref.loads(program).sample().params["r"] == (True, True, 3, "a")


def test_ordered_dictionaries_and_deques_as_in_python() -> None:
    program = "from collections import OrderedDict, deque\nd = OrderedDict(a=1)\n"
    program += "p = (OrderedDict().pop('z', default=4), d.pop('a'), d.pop('q', 3), d.pop(key='q', default=7), len(d))\nsaid = []\n"
    for call in ("deque([1]).remove(99)", "deque([1]).index(99)", "OrderedDict().pop('z')"):
        program += f"try:\n    {call}\nexcept (ValueError, KeyError) as e:\n    said.append(str(e))\n"
    assert scenic_ref.loads(program + "ego = Object\nparam p = p, said = said\n").sample().params == {
        "p": (4, 1, 3, 7, 0), "said": ["99 is not in deque", "99 is not in deque", "'z'"],
    }  # fmt: skip
