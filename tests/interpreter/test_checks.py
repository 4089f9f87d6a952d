"""Static checks: each fault is found, at its place, and legal neighbours of it are not."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from scenic_ref.interpreter.language.checks import check_runnable
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import CheckError

FAULTY: dict[str, tuple[int, int, str]] = {
    "take a": (1, 1, "`take` cannot stand at the top level"),
    "wait": (1, 1, "`wait` cannot stand at the top level"),
    "terminate": (1, 1, "`terminate` cannot stand at the top level"),
    "def f():\n  do A()": (2, 3, "`do` cannot stand in a function"),
    "behavior B():\n  def f():\n    wait": (3, 5, "`wait` cannot stand in a function"),
    "scenario S():\n  compose:\n    take a": (3, 5, "`take` cannot stand in a compose block"),
    "scenario S():\n  setup:\n    do choose A": (3, 5, "`do choose` cannot stand in a setup block"),
    "behavior B():\n  override x with y 3": (2, 3, "`override` cannot stand in a behavior"),
    "behavior B():\n  abort": (2, 3, "`abort` stands outside of any `try` with `interrupt when`"),
    "behavior B():\n  try: abort\n  except: pass": (2, 8, "`abort` stands outside of any `try` with `interrupt when`"),
    "return 3": (1, 1, "`return` cannot stand at the top level"),
    "class A:\n  return": (2, 3, "`return` cannot stand in a class body"),
    "break": (1, 1, "`break` stands outside of any loop"),
    "while a:\n  def f():\n    continue": (3, 5, "`continue` stands outside of any loop"),
    "while a: pass\nelse: break": (2, 7, "`break` stands outside of any loop"),
    "try: pass\ninterrupt when x: pass": (2, 1, "`interrupt when` cannot stand at the top level"),
    "def f():\n  require always x": (2, 3, "`require always` cannot stand in a function"),
    "behavior B():\n  require eventually x": (2, 3, "`require eventually` cannot stand in a behavior"),
    "behavior B():\n  terminate when x": (2, 3, "`terminate when` cannot stand in a behavior"),
    "def f(a, *a): pass": (1, 10, "parameter `a` is given twice"),
    "x = lambda a, a: 3": (1, 15, "parameter `a` is given twice"),
    "f(a=1, b=g(c=1, c=2))": (1, 17, "keyword argument `c` is given twice"),
    "param a = 1, a = 2": (1, 14, "parameter `a` is given twice"),
    "class A:\n  x: 1\n  x: 2": (3, 3, "property `x` is given twice"),
    "nonlocal x": (1, 1, "`nonlocal` cannot stand at the top level"),
    "require[1.5] x": (1, 9, "the probability of a soft requirement must be a number from 0 to 1"),
    "require[-0.5] x": (1, 9, "the probability of a soft requirement must be a number from 0 to 1"),
    "require['a'] x": (1, 9, "the probability of a soft requirement must be a number from 0 to 1"),
    "behavior B():\n  if in initial scenario: pass": (2, 6, "`in initial scenario` cannot stand in a behavior"),
    "def f():\n  from a import *": (2, 3, "`import *` cannot stand in a function"),
    "x = *a": (1, 5, "`*` needs a list, a tuple or a call around it"),
    "try: pass\nexcept: pass\nexcept A: pass": (2, 1, "an `except` that catches everything must come last"),
    "x = f(a=1, a=2)\nbreak": (1, 12, "keyword argument `a` is given twice"),
}

LEGAL = [
    "behavior B():\n  take a\n  wait\n  terminate\n  do A()\n  return",
    "monitor M():\n  take a\n  wait\n  do A() until x\n  terminate",
    "scenario S():\n  setup:\n    override x with y 3\n    require always x\n  compose:\n    do A()\n    wait\n    override x with y 3",
    "behavior B():\n  while a:\n    try: do A()\n    interrupt when x:\n      if y: abort\n      break",
    "def f():\n  x = 1\n  def g():\n    nonlocal x\n    return x\n  return g",
    "for a in b:\n  if c: break\n  else: continue",
    "require[0.5] x\nrequire[p] x\nrequire[1] x\nrequire[0] x",
    "if in initial scenario: ego = Car",
    "scenario S():\n  setup:\n    if in initial scenario: ego = Car",
    "terminate when x\nrequire always x",
    "f(*a, b=1, **c)",
]


@pytest.mark.parametrize("text", FAULTY)
def test_fault_is_found_at_its_place(text: str) -> None:
    with pytest.raises(CheckError) as caught:
        check_runnable(parse(text))
    error = caught.value
    assert (error.span.line, error.span.column, error.message) == FAULTY[text]


@pytest.mark.parametrize("text", LEGAL)
def test_legal_program_passes(text: str) -> None:
    check_runnable(parse(text))


def test_every_whole_listing_of_the_paper_passes() -> None:
    fragments = {"936", "946", "961", "1005", "1013"}  # pieces of compose blocks, shown alone
    for chunk in Path(__file__).with_name("listings.txt").read_text("utf-8").split("=== ")[1:]:
        head, _, body = chunk.partition("\n")
        line, _, dialect = (part.strip() for part in head.split("|"))
        if line not in fragments:
            check_runnable(parse(textwrap.dedent(body), dialect=dialect))
