"""Programs nested up to the limit run, are printed, converted and saved; beyond it they are refused."""

from __future__ import annotations

import sys

import pytest
from scenic_ref.api import loads
from scenic_ref.data.checkpoint import resume, save
from scenic_ref.interpreter.language.conversion import convert
from scenic_ref.interpreter.language.nesting import LIMIT
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import drive
from scenic_ref.semantics.dynamics.policy import begin
from scenic_ref.semantics.machine.outcome import Done
from scenic_ref.semantics.store.errors import ParseError

NESTED = {
    "a sum": lambda n: "x = " + " + ".join(["1"] * n),
    "powers": lambda n: "x = " + " ** ".join(["1"] * n),
    "a sum of draws": lambda n: "x = " + " + ".join(["Range(0, 1)"] * n),
    "elif": lambda n: "y = 3\nif y == 0:\n    x = 0\n" + "".join(f"elif y == {i + 5}:\n    x = {i}\n" for i in range(n)) + "else:\n    x = 7",
    "not": lambda n: "x = " + "not " * n + "True",
    "minus": lambda n: "x = " + "-" * n + "1",
    "lists": lambda n: "x = len(" + "[" * n + "]" * n + ")",
    "conditional expressions": lambda n: "x = " + "1 if False else " * n + "2",
    "calls": lambda n: "def f(x): return x\nx = " + "f(" * n + "1" + ")" * n,
    "functions without a name": lambda n: "x = 1\ny = " + "lambda: " * n + "1",
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("shape", NESTED)
def test_up_to_the_limit(shape: str):
    before = sys.getrecursionlimit()
    text = f"ego = Object at 0 @ 0\n{NESTED[shape](LIMIT - 8)}\nparam x = x\nbehavior B():\n    take x\n"
    scenario = loads(text)
    assert "x" in scenario.sample(seed=1).params
    assert [s.params for s in scenario.sample_many(2)] == [s.params for s in scenario.sample_many(2, backend="interpreter")]
    assert parse(convert(parse(text), "scenic-2.1", {}), dialect="scenic-2.1").statements
    generated, _ = drive(scenario.start(), from_stream(0, 0, 0))
    assert isinstance(generated, Done)
    state = begin(generated.state, 1.0)
    assert save(resume(save(state)))
    assert sys.getrecursionlimit() == before


@pytest.mark.parametrize("shape", NESTED)
def test_beyond_it(shape: str):
    with pytest.raises(ParseError) as caught:
        parse(f"ego = Object\n{NESTED[shape](LIMIT + 10)}\n")
    assert "nested too deeply" in caught.value.message
    assert caught.value.span.line > 1


FAR_BEYOND = {
    "parentheses": "(" * 5000 + "x" + ")" * 5000,
    "unary": "-" * 5000 + "x",
    "sum": "x" + " + x" * 10000,
    "lists": "[" * 5000 + "]" * 5000,
    "calls": "f(" * 3000 + ")" * 3000,
    "attributes": "x" + ".a" * 10000,
    "readings": "x" + " at x" * 40,
    "chain": "x" + " offset by x" * 3000,
    "conjunction": "x" + " and x" * 10000,
    "lambdas": "lambda: " * 3000 + "x",
    "conditionals": "1 if x else " * 3000 + "2",
    "elif": "if a: pass\n" + "elif b: pass\n" * 2000,
    "blocks": "\n".join(" " * i + "if x:" for i in range(500)) + "\n" + " " * 500 + "pass",
    "targets": "((" * 300 + "a" + ",),)" * 300 + " = 3",
    "limit": "do x for " + "-" * 3000 + "3 seconds",
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("text", FAR_BEYOND.values(), ids=FAR_BEYOND)
def test_deep_nesting_gives_a_tree_or_a_parse_error(text: str) -> None:
    try:
        parse(text)
    except ParseError as error:
        assert "nested too deeply" in error.message
