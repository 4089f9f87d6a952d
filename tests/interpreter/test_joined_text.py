"""Blanks and line breaks: before the brackets behind a word of the language, and inside brackets, where line structure is Python's."""

from __future__ import annotations

import pytest
from scenic_ref.interpreter.language.checks import check_runnable
from scenic_ref.interpreter.language.conversion import Comments
from scenic_ref.interpreter.language.logical_lines import join_text
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import ParseError
from scenic_ref.semantics.syntax import dynamics as d
from scenic_ref.semantics.syntax import expressions as e
from scenic_ref.semantics.syntax import python_expressions as p
from scenic_ref.semantics.syntax import statements as s

DIALECTS = ("paper", "scenic-2.1", "scenic-3")
RELEASES = DIALECTS[1:]
IN_BEHAVIORS = [
    "take [1]", "take [1][0]", "take {1: 2}", "take (1)", "take [1], [2]", "do [C()][0]", "do [C()][0] for 3 seconds", "do [C()][0] until (x)",
    "do (C())", "do {C(): 1}", "do choose [C()]", "do choose {C(): 1}", "do shuffle (C())", "override (ego) with width 3",
    "if x: take [1]", "y = 1; take [1]", "do C() for (3) seconds", "do C() until [x]",
]  # fmt: skip
STATEMENTS = [
    "require (x)", "require {x}", "require always (x)", "require always [x]", "require always {x}", "require eventually [x]",
    "require eventually {x}", "mutate by (3)", "mutate ego by (3)", "terminate when (x)", "terminate when [x]", "x = follow (f) from (0, 0) for (3)",
    "x = follow (f) for (3)", "x = visible (r)", "x = distance from (0, 0) to (1, 1)", "x = front of (a)", "x = (a) offset by (b)", "x = (a) at (b)",
    "x = relative heading of (a) from (b)", "x = (3) if (a) else (b)", "x = apparent heading of (a)", "x = (a) can see (b)",
    "require (always [x])",
]  # fmt: skip
OF_RELEASES = [
    "record (ego.a)", "record [ego.a]", "record {1: 2}", "record initial (ego.a)", "record initial [ego.a]", "record final (ego.a) as q",
    "record final [ego.a]", "record (ego.width) as q", "record initial {1: 2}", "simulator (3)", "simulator [3]", "simulator {3: 2}",
    "require (x) as q", "terminate after (3) seconds", "terminate simulation when (x)", "x = not visible (r)",
]  # fmt: skip


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("line", [*(f"behavior B():\n    {line}" for line in IN_BEHAVIORS), *STATEMENTS, *OF_RELEASES])
def test_no_blank_is_needed_before_or_behind_a_bracket(line: str, dialect: str) -> None:
    if line in OF_RELEASES and dialect not in RELEASES:
        with pytest.raises(ParseError, match=r"belongs? to dialects"):
            parse(without_blanks(line), dialect=dialect)
    else:
        assert parse(without_blanks(line), dialect=dialect).statements == parse(line, dialect=dialect).statements


def without_blanks(line: str) -> str:
    """A program without the blanks between a word and a bracket."""
    for bracket in "([{":
        line = line.replace(f" {bracket}", bracket)
    for bracket in ")]}":
        line = line.replace(f"{bracket} ", bracket)
    return line


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize(
    ("text", "node"),
    [
        ("def record(x): pass\nrecord(3)", s.ExpressionStatement),
        ("from m import a, record\nrecord(3)", s.ExpressionStatement),
        ("from m import *\nrecord(3)", s.ExpressionStatement),
        ("model own\nrecord(3)", s.ExpressionStatement),
        ("simulator = [1]\nsimulator[0]", s.ExpressionStatement),
        ("take = [1]\ntake[0]", s.ExpressionStatement),
        ("take = [1]\ntake[0] = 3", s.Assignment),
        ("take[0] = 3", s.Assignment),
        ("take[0].x: int = 3", s.Assignment),
        ("for record, x in y: pass\nrecord[0](3)", s.ExpressionStatement),
        ("always = [True]\nrequire always[0]", s.Require),
        ("x = take[1]", s.Assignment),
        ("def take(x): pass\ntake(1, [1, 2])", s.ExpressionStatement),
        ("from m import a, take\ntake(1)", s.ExpressionStatement),
        ("do = f\ndo(1)", s.ExpressionStatement),
        ("def require(x): pass\nrequire(1)", s.ExpressionStatement),
        ("def require(x): pass\nrequire (1)", s.Require),
        ("model own\nrequire(x)", s.Require),
        ("from m import *\nrequire(x)", s.Require),
        ("f(require=3)\nrequire(x)", s.Require),
        ("def g(x): pass\nrequire(g(take=3))", s.Require),
        ("simulator = f\nsimulator({1: 2})", s.ExpressionStatement),
    ],
)
def test_a_name_of_the_program_before_a_bracket_stays_a_name(text: str, node: type, dialect: str) -> None:
    assert isinstance(parse(text, dialect=dialect).statements[-1], node)


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize(
    ("text", "call"),
    [
        ("def visible(x): return x\ny = visible(3)", True),
        ("def f(visible): return 1\ny = visible(3)", True),
        ("visible = f\ny = visible(3)", True),
        ("import m as visible\ny = visible(3)", True),
        ("Object at 1 @ 2, visible\ny = visible(3)", False),
        ("f(visible=True)\ny = visible(3)", False),
        ("y = a.visible(3)", True),
    ],
)
def test_a_function_that_is_called_visible_can_be_called(text: str, call: bool, dialect: str) -> None:
    statement = parse(text.replace("Object at", "ego = new Object at") if dialect == "scenic-3" else text, dialect=dialect).statements[-1]
    assert isinstance(statement, s.Assignment)
    assert isinstance(statement.value, p.Call) is call


def test_a_function_that_is_called_visible_can_be_called_in_requirements_and_texts() -> None:
    statements = parse("def visible(x): return x\nrequire not visible(0)\ny = f'{visible(3)}'\n").statements
    assert isinstance(statements[1].condition, p.UnaryOperation)  # type: ignore[attr-defined]
    assert isinstance(statements[2].value.parts[0].value, p.Call)  # type: ignore[attr-defined]
    text = parse("y = f'{visible(r)}'\n").statements[0]
    assert isinstance(text.value.parts[0].value, e.Visible)  # type: ignore[attr-defined]


def test_a_function_that_is_called_choose_may_give_what_is_done() -> None:
    def done(text: str) -> object:
        return parse(text + "behavior B():\n    do choose(C())\n    do choose[C()]\n").statements[-1].body[0]  # type: ignore[attr-defined]

    assert isinstance(done(""), d.DoChoose)
    assert isinstance(done("def choose(x): return x\n"), d.Do)


def test_a_function_that_is_called_follow_may_stand_in_a_comprehension() -> None:
    statement = parse("def follow(x): return x\ny = [follow(x) for x in (1, 2)]").statements[-1]
    assert isinstance(statement, s.Assignment)
    assert isinstance(statement.value, p.Comprehension)
    assert isinstance(parse("y = [follow(x) for x in (1, 2)]").statements[0].value, p.Comprehension)  # type: ignore[attr-defined]


def test_spans_do_not_count_the_blanks_that_the_user_did_not_write() -> None:
    take, second = parse("behavior B():\n    take[1][0]; take[22]\n").statements[0].body  # type: ignore[attr-defined]
    assert isinstance(take, d.Take)
    assert (take.span[1:], take.actions[0].span[1:]) == ((2, 5, 2, 15), (2, 9, 2, 15))
    assert (second.span[1:], second.actions[0].span[1:]) == ((2, 17, 2, 25), (2, 21, 2, 25))
    with pytest.raises(ParseError) as found:
        parse("behavior B():\n    take[1]; take[2]; take[3] +\n")
    assert found.value.span[1:3] == (2, 32)


LINES = [
    "x = [distance|to (3, 4)]", "x = (angle|to (3, 4))", "x = (ego can|see (1, 2))", "x = (ego|can|see|(1, 2))", "x = (Object|left|of (3, 4))",
    "x = (Object facing|toward (3, 4))", "x = (Object at (3, 3), facing away|from (9, 9))", "x = (relative|heading of b)",
    "x = [apparent|heading|of b]", "x = (a offset|by b)", "x = (a offset|along b|by c)", "x = (a relative|to b)", "x = f(a visible|from b)",
    "x = (visible|r)", "x = (Object at a, with|width|3)", "x = (a is|not b)", "x = (a not|in b)",
    "x = (front|left|of a)", "x = (in|initial|scenario)",
    "x = (Object|ahead|of b|by 3)", "x = (Object apparently|facing 3)", "x = {follow|f from a|for 3}", "x = (distance|of a past|b)",
    "require (a can|see b)", "x = (Object at a,|facing|(directly|))", "x = (Object at a, visible|from b)", "x = f'{(a|can|see b)}'",
]  # fmt: skip


@pytest.mark.parametrize("gap", ["\n  ", "\n", "  # why (\n\n\t", "  \\\n", "\n# [ ' why\n"])
@pytest.mark.parametrize("line", LINES)
def test_a_line_break_in_brackets_is_white_space(line: str, gap: str) -> None:
    text, plain = line.replace("|", gap), line.replace("|", " ")
    if plain.startswith("x = f'"):
        text, plain = text.replace("'", '"' * 3), plain
        if "#" in gap or "\\" in gap:
            return
    first, second = parse(text + "\ny = 1").statements
    assert first == parse(plain).statements[0]
    assert (second.span.line, second.span.column) == (text.count("\n") + 2, 1)


def test_a_backslash_joins_the_words_of_an_operator() -> None:
    assert parse("x = distance \\\n   to (3, 4)").statements == parse("x = distance to (3, 4)").statements
    assert parse("x = a offset \\\n by b").statements == parse("x = a offset by b").statements


def test_attributes_of_a_property_may_stand_on_several_lines() -> None:
    program = parse("class Car:\n    foo[dynamic,  # changes\n        final]: 3\n", dialect="scenic-3")
    assert program.statements == parse("class Car:\n    foo[dynamic, final]: 3\n", dialect="scenic-3").statements


def test_spans_are_those_of_the_lines_as_they_are_written() -> None:
    statement = parse("x = (3 +  # one\n     (distance\n   to b))\n").statements[0]
    assert isinstance(statement, s.Assignment)
    assert isinstance(statement.value, p.BinaryOperation)
    distance = statement.value.right
    assert isinstance(distance, e.Distance)
    assert distance.span[1:] == (2, 7, 3, 8)
    assert distance.target is not None
    assert distance.target.span[1:] == (3, 7, 3, 8)
    with pytest.raises(ParseError) as found:
        parse("x = (3,\n   4 5)\n")
    assert found.value.span[1:] == (2, 6, 2, 7)


def test_strings_and_unclosed_brackets_are_not_joined() -> None:
    for text in ('x = ("""a\n# b\n""")\n', "x = (1\ny = 2\n", "x = 1  # (\ny = 2  # )\n", "x = '(\\\n'\n", "x = (1]\ny = (\n3)\n"):
        assert join_text(text).text == text
    value = parse('x = ("""a\n# b\n""",\n 3)').statements[0].value  # type: ignore[attr-defined]
    assert value.items[0] == p.Constant(value="a\n# b\n")


def test_comments_stay_where_they_are() -> None:
    text = "x = (distance  # one\n  to b)  # two\n# three\ny = 1\n"
    comments = Comments(parse(text))
    assert [(line.start, line.end) for line in comments.code] == [((1, 1), (2, 8)), ((4, 1), (4, 6))]
    check_runnable(parse(text))
