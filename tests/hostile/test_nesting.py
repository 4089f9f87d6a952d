"""Values that contain themselves, or are very deep: whatever is done with them is possible, or an error of the program."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store import errors

VALUES = {
    "a list in itself": "a = [1]\na.append(a)\n",
    "a dictionary in itself": "a = {}\na['x'] = a\n",
    "lists": "a = []\nfor i in range(3000):\n    a = [a]\n",
    "tuples": "a = ()\nfor i in range(3000):\n    a = (a,)\n",
    "dictionaries": "a = {}\nfor i in range(3000):\n    a = {'x': a}\n",
}
USES = [
    "param p = a", "ego.z = a", "Object at (5, 5), with foo a", "ego.name = a", "Object at (5, 5), with behavior a", "Object at a", "y = Uniform([a], [a, a])",
    "x = Uniform(a, a)", "x = repr(a)", "x = str(a)", "x = f'{a}'", "x = '%s' % (a,)", "x = a == a", "x = [a] == [a, a]", "x = a < a", "x = hash(a)", "x = {a: 1}",
    "x = set([a])", "print(a)", "x = sorted([a, a])", "x = max([a], key=str)", "x = a in [a, 1]", "x = [a].index(a)", "x = sum(a, [])", "raise ValueError(a)",
    "y = Range(0, 1)\nx = [a, y]\nparam p = x", "from itertools import chain\nx = list(chain(a))", "assert False, a", "b = [1]\nparam q = b\nb.append(a)",
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("name", VALUES)
def test_what_contains_itself_is_no_fault_of_ours(name, use, capsys):
    try:
        scenic_ref.loads("ego = Object at (0, 0)\n" + VALUES[name] + use + "\n").sample().to_line()
    except errors.ProgramError as error:
        assert error.span.line > 0 or use.startswith("b = ")
        assert len(str(error)) < 3000


@pytest.mark.parametrize("name", ["a list in itself", "lists"])
def test_the_error_says_what_it_is_about(name):
    with pytest.raises(errors.RunError, match="the parameter p contains itself, or holds containers more than 100 deep"):
        scenic_ref.loads("ego = Object at (0, 0)\n" + VALUES[name] + "param p = a\n").sample()
    with pytest.raises(errors.RunError, match="nests too deeply"):
        scenic_ref.loads("ego = Object at (0, 0)\n" + VALUES[name] + "x = a == a\n").sample()


def test_a_hundred_lists_in_each_other_can_be_written():
    text = "ego = Object at (0, 0)\na = 1\nfor i in range({}):\n    a = [a]\nparam p = a\n"
    assert scenic_ref.loads(text.format(100)).sample().to_line().count("[") > 100
    with pytest.raises(errors.RunError, match="more than 100 deep"):
        scenic_ref.loads(text.format(102)).sample()


def test_lists_that_share_are_looked_at_once():
    begin = "ego = Object at (0, 0)\na = [1]\nfor i in range(90):\n    a = [a, a]\n"
    assert scenic_ref.loads(begin + "ego.z = len(a)\n").sample().ego["z"] == 2
    for use in ("ego.z = a", "x = str(a)", "x = a == [a[0], a[1]]", "x = f'{a}'", "param p = a", "x = sorted([a, a])", "print(a)"):
        with pytest.raises(errors.RunError, match="2,000,000 parts"):
            scenic_ref.loads(begin + use + "\n").sample()
