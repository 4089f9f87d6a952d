"""What the user reads for the most common mistakes: message, place and the one repair."""

from __future__ import annotations

import re

import pytest
from scenic_ref.api import loads
from scenic_ref.interpreter.language.node_builders import NOT_RECORDED
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.language.tree_builder import BY_DIALECT
from scenic_ref.semantics.store.errors import ParseError, ProgramError, UsageError

# text: (line, column, message, hint)
MISTAKES: dict[str, tuple[int, int, str, str]] = {
    "Car left of spot 0.5": (1, 18, "the distance needs `by`", "write `left of spot by 0.5`"),
    "require x = 3": (1, 11, "`=` assigns", "write `==` to compare"),
    "if x = 3: pass": (1, 6, "`=` assigns", "write `==` to compare"),
    "Car offset (1, 2)": (1, 5, "`offset` needs `by` or `along`", "write `offset by ...`"),
    "Car wiht x 3": (1, 5, "`wiht` is not a specifier or operator", "did you mean `with`?"),
    "Car ahead off ego by 2": (1, 5, "`ahead` is no specifier without `of`", "write `ahead of ...`"),
    "Car left ego": (1, 5, "`left` is no specifier without `of`", "write `left of ...`"),
    "Car at X, facign 3": (1, 11, "`facign` is not a specifier", "did you mean `facing`?"),
    "Car facing towards ego": (1, 12, "`facing towards` is spelt `facing toward`", "write `facing toward`"),
    "ego = new Car": (1, 7, "`new` belongs to dialect scenic-3", "leave out `new`, or begin the program with `# dialect: scenic-3`"),
    "require monitor M()": (1, 1, "`require monitor` belongs to dialect scenic-3", "leave it out: a monitor runs as soon as it is defined"),
    "if initial scenario: pass": (1, 4, "`initial scenario` without `in` belongs to dialect scenic-2.1 and scenic-3", "write `in initial scenario`"),
    "if x\n  y": (1, 5, "a `:` is missing at the end of the line", "end the line with `:`"),
    "behavior Foo\n  wait": (1, 10, "a `:` is missing at the end of the line", "write `behavior Foo():`"),
    "x = (1, 2\ny = 3": (1, 5, "this `(` is never closed", "add `)`"),
    "x = (Car at V,\n with width)": (2, 12, "`with width` needs an argument", "write `with width ...`"),
    "Car with width, with color 3": (1, 15, "`with width` needs an argument", "write `with width ...`"),
    "x = (Car at X, facing toward)": (1, 29, "`facing toward` needs an argument", "write `facing toward ...`"),
    "x = {1: 2, on}": (1, 14, "unexpected `}`; expected `:`", ""),
    "x = station)": (1, 12, "`)` closes no bracket", "remove it, or open a bracket before it"),
    "x = 1, 2)": (1, 9, "`)` closes no bracket", "remove it, or open a bracket before it"),
    "x = (1, 2]": (1, 10, "`]` does not close the `(` of line 1", "write `)`"),
    "if x:\n\ty = 3\n        z = 4": (3, 1, "tabs and spaces are mixed in the indentation", "indent with spaces only"),
    'x = "abc': (1, 5, "this string is not terminated", "end it with the quotation mark it began with"),
    "terminate after 5 seconds": (
        1, 1, "`terminate after` belongs to dialects scenic-2.1 and scenic-3",
        f"write `terminate when simulation.currentTime >= 5`, or {BY_DIALECT}",
    ),
    "record ego.speed": (1, 1, "`record` belongs to dialects scenic-2.1 and scenic-3", f"{NOT_RECORDED}, or {BY_DIALECT}"),
    "require 0.5 x > 3": (1, 9, "the probability of a soft requirement stands in brackets", "write `require[0.5] ...`"),
    "mutate x, by 2": (1, 14, "there is no comma before `by`", "remove the comma"),
    "param x: 3": (1, 8, "a parameter is set with `=`", "write `param name = value`"),
    "Car with color = red": (1, 16, "specifiers take no `=`: `with` is followed by the property and its value", "write `with color ...`"),
    "Car at = 3": (1, 8, "specifiers take no `=`", "write `at ...`"),
    "Car with width 3, facing  toward = 3": (1, 34, "specifiers take no `=`", "write `facing  toward ...`"),
    "Car at 1, 2": (1, 8, "a vector needs parentheses", "write `(x, y)`"),
    "Car at 1, 2, facing 3": (1, 11, "a vector needs parentheses", "write `(x, y)`"),
    "Car facing 30 degrees": (1, 15, "the unit of angles is spelt `deg`", "write `deg`"),
    "x = road visible from": (1, 22, "`visible from` needs an argument", "write `visible from ...`"),
    "x = distance between a and b": (1, 14, "there is no `between`", "write `from ... to ...`"),
    "if x: pass\nelse if y: pass": (2, 6, "`else if` is spelt `elif`", "write `elif`"),
    "if x: pass\nelsif y: pass": (2, 7, "`elsif` is spelt `elif`", "write `elif`"),
    "if a && b: pass": (1, 6, "`&&` is not an operator", "write `and`"),
    "if a || b: pass": (1, 6, "`||` is not an operator", "write `or`"),
    "if !a: pass": (1, 4, "`!` is not an operator", "write `not`"),
    "require ego can se (1, 2)": (1, 13, "`can se` is not an operator", "write `can see`"),
    "Car next to": (1, 5, "there is no `next to`", "write `left of X by S`, `ahead of X by S`, ..."),
    "Car at can facing 3": (1, 12, "a comma is missing before `facing`", "separate specifiers with commas"),
    "Car at 1 @ 2, aheadof ego": (1, 15, "`aheadof` is two words", "write `ahead of`"),
    "Car leftof ego by 2": (1, 5, "`leftof` is two words", "write `left of`"),
    "Car nextto ego": (1, 5, "there is no `nextto`", "write `left of X by S`, `ahead of X by S`, ..."),
    "i++": (1, 2, "there is no increment operator", "write `+= 1` or `-= 1`"),
    "Car at X facing 3": (1, 10, "a comma is missing before `facing`", "separate specifiers with commas"),
    "Car, with x 3": (1, 1, "a comma stands before the first specifier", "remove the comma after the class"),
    "yield x": (1, 1, "`yield` is not part of the language", "return a list, or write a behavior"),
    "@d\nclass C: pass": (1, 2, "decorators of classes are not part of the language", "call it after the class: C = decorator(C)"),
    "require a implies b": (1, 11, "`implies` is not part of the language", "write `not B or C` for `B implies C`"),
    "with a as b: pass": (1, 1, "Python's `with` statement is not part of the language", "use try and finally"),
    "async def f(): pass": (1, 1, "`async` and `await` are not part of the language", "write a behavior"),
    "match x:\n  case 1: pass": (1, 7, "Python's `match` statement is not part of the language", "use if and elif"),
    "if (x := 3): pass": (1, 7, "assignment expressions (`:=`) are not part of the language", "assign in a statement of its own"),
    "x: int": (1, 1, "`name: default` lines belong in classes", "give the variable a value, as in `x: int = 3`"),
    "print x": (1, 1, "`print` is a function", "write `print(...)`"),
    "if x:\ny = 3": (2, 1, "the block of `if x:` (line 1) is not indented", "indent the line, or write `pass`"),
    "x = 3\n  y = 4": (2, 3, "unexpected indentation", "align the line with the one before"),
    "  x = 3": (1, 3, "unexpected indentation", "begin the first statement in the first column"),
    "if x:\n    y\n  z": (3, 1, "this line's indentation matches no enclosing block", "align it with the block it belongs to"),
    "x = “a”": (1, 5, "these quotation marks are not those of the language", "write \" or '"),
    "do X() for 5": (1, 12, "a time limit needs a unit", "write `for 5 seconds` or `for 5 steps`"),
    "f() = 3": (1, 1, "this cannot be assigned to", "write == to compare"),
    "behavior B():\n  x = 3\n  precondition: x": (
        3,
        3,
        "`precondition` lines must come first in their definition",
        "move it to the head of the definition",
    ),
    "x = 0123": (1, 5, "a decimal integer cannot begin with 0; write 0o17 for an octal number", ""),
    "x = 3j": (1, 5, "complex numbers are not part of the language", ""),
    "x = ²": (1, 5, "'²' is not a name", ""),
    "x = a\0b": (1, 6, "the text contains a NUL character", ""),
    "x = 3 +": (1, 8, "the line ends too early; expected an expression", ""),
    'x = f"{a b}"': (1, 10, "unexpected `b`; expected `,` or a specifier or an operator", ""),
    'x = f"{a"': (1, 5, "f-string: expected '}'", ""),
}


@pytest.mark.parametrize("text", MISTAKES)
def test_mistake_is_explained_with_its_place_and_one_repair(text: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(text, "f")
    error = caught.value
    assert (error.span.line, error.span.column, error.message, error.hint) == MISTAKES[text]
    assert error.span.file == "f"
    assert len(error.expected) <= 8


NAMED = {
    "record ego.speed as v": ("", NOT_RECORDED, "record"),
    "record initial ego.speed as v": ("", NOT_RECORDED, "record initial"),
    "record final ego.speed as 'v'": ("", NOT_RECORDED, "record final"),
    "require monitor M() as m": ("", "leave it out: a monitor runs as soon as it is defined", "require monitor"),
    "require b as c": ("require b", "leave out the name", "as"),
    "terminate when b as c": ("terminate when b", "leave out the name", "as"),
    "terminate simulation when b as c": ("terminate when b", "write `terminate when ...`, without a name", "terminate simulation when"),
}
"""Statements of the releases with a name, what is left if one does what the hint says, the hint, and what belongs to the releases."""


@pytest.mark.parametrize("text", NAMED)
def test_who_follows_the_hint_about_a_statement_with_a_name_meets_no_other_error(text: str) -> None:
    followed, hint, construct = NAMED[text]
    with pytest.raises(ParseError) as caught:
        parse(text, "f")
    assert caught.value.hint.partition(", or begin the program with ")[0] == hint
    assert caught.value.message.startswith(f"`{construct}` belongs to dialect")
    parse(followed, "f")
    parse(text, "f", "scenic-3")  # "or begin the program with ..."


ODD = ["\x01", "x = \u2028", "\ud800", "x = \U0001f600", "é = 1\nx = ﬁ + ?", "\\", "x \\ y", "(", "'", "f'{'", "#", "@", "param '\\x' = 3"]


@pytest.mark.parametrize("text", ODD)
def test_odd_text_gives_a_tree_or_a_parse_error(text: str) -> None:
    try:
        parse(text)
    except ParseError as error:
        assert error.message
        assert error.span.line >= 1


def test_unknown_dialect_is_a_usage_error() -> None:
    with pytest.raises(UsageError, match="klingon"):
        parse("x = 1", dialect="klingon")


@pytest.mark.parametrize(
    "text",
    [
        "require always ((b) and eventually (c))", "require (always (b)) and c", "require not (eventually (b))", "require always eventually (b)",
        "require[0.5] always (b)", "require next (b)",
    ],
)
def test_a_formula_over_time_that_looks_like_a_call_is_refused_when_it_is_read(text: str) -> None:
    with pytest.raises(ParseError) as refused:
        parse(f"ego = new Object\n{text}\n", "p.scenic", "scenic-3")
    assert refused.value.span.line == 2
    assert re.search("no other formulas|stands directly behind `require`", str(refused.value))
    parse(f"ego = Object\n{text}\n", "p.scenic", "paper")


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("require (always ego.x < 3 and ego.y < 3)", "require always ego.x < 3 and ego.y < 3"),
        ("require ((always (ego.x) < 3))", "require always ego.x < 3"),
        ("require (eventually (ego.x < 3) or b) as c", "require eventually ego.x < 3 or b as c"),
    ],
)
@pytest.mark.parametrize("dialect", ["scenic-2.1", "scenic-3"])
def test_a_formula_over_time_in_parentheses_is_the_statement(text: str, same: str, dialect: str) -> None:
    assert parse(text, dialect=dialect).statements == parse(same, dialect=dialect).statements


@pytest.mark.parametrize(("text", "word"), [("(always)", "always"), ("(always (x) < 3)", "always"), ("((eventually and x))", "eventually")])
def test_in_the_papers_dialect_these_words_are_names(text: str, word: str) -> None:
    assert f"Name(name='{word}')" in repr(parse(f"require {text}").statements[0].condition)  # type: ignore[attr-defined]


@pytest.mark.parametrize("text", ["at 1 @ 2, with width 3", "in R, with width 3", "offset by 1 @ 1, facing 3", "with width 3"])
def test_objects_of_scenic_3_need_new(text: str) -> None:
    with pytest.raises(ParseError, match="makes objects with `new`"):
        parse(f"ego = Object {text}\n", dialect="scenic-3")


@pytest.mark.parametrize("text", ["ego = new Object with yaw 3", "class C:\n    pitch: 3", "override ego with roll 3"])
def test_orientations_in_space_are_refused(text: str) -> None:
    with pytest.raises(ParseError, match="three-dimensional"):
        parse(f"{text}\n", dialect="scenic-3")
    assert parse(text.replace("new ", "") + "\n").statements


@pytest.mark.parametrize("text", ["in BoxRegion(dimensions=(5, 5, 5))", "with x Vector(1, 2, 3)", "with x ego.position.z", "with x ego.pitch"])
def test_what_is_in_space_is_refused_by_name(text: str) -> None:
    with pytest.raises(ProgramError, match="three-dimensional; this reference is two-dimensional"):
        loads(f"ego = new Object\no = new Object at 9 @ 9, {text}\n".replace("at 9 @ 9, in", "in"), dialect="scenic-3").rehearse()


ALONE = ("a property is a name alone", "write `name: default`; elements and attributes are assigned with `=`")
COMMA = ("a comma too many stands in the attributes of this property", "write `name[dynamic]: default`")
EQUALS = ("the default of a property stands behind `:`, not `=`", "write `name[dynamic]: default`")


@pytest.mark.parametrize("dialect", ["scenic-2.1", "scenic-3"])
@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("width[dynamc]: 3", ("`dynamc` is not an attribute of properties", "did you mean dynamic?")),
        ("width[DYNAMIC]: 3", ("`DYNAMIC` is not an attribute of properties", "did you mean dynamic?")),
        ("width[additive, finl]: 3", ("`finl` is not an attribute of properties", "did you mean final?")),
        ("width[constant]: 3", ("`constant` is not an attribute of properties", "there are additive, dynamic, final")),
        ("width[dynamic,]: 3", COMMA), ("width[dynamic] = 3", EQUALS), ("wheel.size: 4", ALONE), ("self.size: 4", ALONE), ("x[1]: 4", ALONE),
        ("x['dynamic']: 4", ALONE), ("x[1:2]: 4", ALONE), ("if True:\n        x[1]: 4", ALONE), ("for i in [1]:\n        x.y: 4", ALONE),
    ],
)
def test_no_line_of_a_class_is_an_annotation_that_loses_its_default(line: str, error: tuple[str, str], dialect: str) -> None:
    with pytest.raises(ParseError) as raised:
        parse(f"class Car:\n    {line}\n", dialect=dialect)
    assert (raised.value.message, raised.value.hint) == error


@pytest.mark.parametrize("line", ["wheel.size: 4", "x[1]: 4", "width[dynamc]: 3", "width[dynamic]: 3"])
def test_no_line_of_a_class_is_an_annotation_in_the_dialect_of_the_paper(line: str) -> None:
    with pytest.raises(ParseError):
        parse(f"class Car:\n    {line}\n")


def test_annotations_elsewhere_stay_what_they_are_in_python() -> None:
    assert parse("x[1]: int\ndef f(y):\n    y.z: float\nclass A:\n    def g(self):\n        self.x: int\n        self.y: int = 3\n").statements


@pytest.mark.parametrize("word", ["toward", "away from"])
def test_directly_is_a_word_of_scenic_3_alone(word: str) -> None:
    assert parse(f"ego = new Car facing directly {word} V\n", dialect="scenic-3").statements
    for dialect in ("paper", "pldi19", "scenic-2.1"):
        with pytest.raises(ParseError) as raised:
            parse(f"ego = Car facing directly {word} V\n", dialect=dialect)
        assert (raised.value.message, raised.value.hint) == (f"`facing directly {word}` belongs to dialect scenic-3", f"write `facing {word} ...`")
