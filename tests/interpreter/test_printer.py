"""The printer: what it prints parses back to the same tree."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.language.printer import to_source

HERE = Path(__file__)
CASES = HERE.with_name("round_trips.txt").read_text("utf-8").split("\n%%\n")
LISTINGS = [
    (textwrap.dedent(body), head.split("|")[-1].strip())
    for head, _, body in (chunk.partition("\n") for chunk in HERE.with_name("listings.txt").read_text("utf-8").split("=== ")[1:])
]
SCENIC_3 = """ego = new Car at x, facing 3
new Car
y = new Car in R
z = new Car with x new C
require monitor M()
if initial scenario: pass
f = C at x
"""


def assert_round_trip(text: str, dialect: str) -> None:
    program = parse(text, dialect=dialect)
    printed = to_source(program)
    assert parse(printed).statements == program.statements, printed


@pytest.mark.parametrize(("text", "dialect"), LISTINGS)
def test_listing_of_the_paper_survives_printing(text: str, dialect: str) -> None:
    assert_round_trip(text, dialect)


@pytest.mark.parametrize("dialect", ["paper", "pldi19", "scenic-2.1"])
@pytest.mark.parametrize("text", CASES)
def test_construct_survives_printing(text: str, dialect: str) -> None:
    assert_round_trip(text, dialect)


def test_scenic_3_survives_printing() -> None:
    assert_round_trip(SCENIC_3, "scenic-3")


NAMES = st.sampled_from(["a", "b.c", "ego", "at", "visible", "take", "by", "require", "follow", "wait"])
INFIX = [
    "at",
    "relative to",
    "offset by",
    "visible from",
    "can see",
    "+",
    "*",
    "@",
    "**",
    "-",
    "<",
    "in",
    "is in",
    "and",
    "or",
    "offset along d by",
]
PREFIX = [
    "-",
    "not ",
    "front of ",
    "left of ",
    "visible ",
    "distance to ",
    "angle from b to ",
    "relative heading of ",
    "follow f for ",
    "lambda: ",
]
POSTFIX = [" deg", " seconds", ".x", "(a, k=b)", "[1:2]", "[a, b]"]
SPECIFIERS = ["on", "at", "left of", "with p", "facing", "beyond a by", "visible from", "offset along d by"]
WRAPPED = ["({0})", "[{0}, a]", "({0}, b)", "{{a: {0}}}", "[x for x in ({0})]", "(({0}) if ({0}) else a)", "(lambda a, b={0}: a)"]


def compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Larger expressions made of smaller ones; operands are parenthesised at random."""
    operand = st.one_of(inner.map(lambda text: f"({text})"), NAMES.map(lambda text: f"({text})"), st.sampled_from(["(1)", "0.5", "'s'"]))
    return st.one_of(
        st.lists(st.tuples(operand, st.sampled_from(INFIX)), min_size=1, max_size=3).map(lambda p: " ".join(f"{o} {w}" for o, w in p) + " (z)"),
        st.tuples(st.sampled_from(["E", "lib.E"]), st.sampled_from(INFIX[:4]), operand, st.sampled_from(INFIX[:4]), operand).map(" ".join),
        st.tuples(st.sampled_from(PREFIX), operand).map("".join),
        st.tuples(operand, st.sampled_from(POSTFIX)).map("".join),
        st.lists(st.tuples(st.sampled_from(SPECIFIERS), operand).map(" ".join), min_size=2, max_size=3).map(lambda s: "(Car " + ", ".join(s) + ")"),
        st.tuples(st.sampled_from(WRAPPED), inner).map(lambda p: p[0].format(p[1])),
    )


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.recursive(NAMES.map(lambda text: f"({text})"), compound, max_leaves=8), st.sampled_from(["paper", "pldi19"]))
def test_random_expression_survives_printing(text: str, dialect: str) -> None:
    assert_round_trip(f"x = {text}\nif {text}: {text}", dialect)


@pytest.mark.parametrize("text", ["-" * 147 + "x", "x" + " + x" * 146, "[" * 147 + "]" * 147, "f(" * 146 + ")" * 146, "Car at " * 12 + "x"])
def test_deepest_legal_trees_survive_printing(text: str) -> None:
    assert_round_trip(text, "paper")
