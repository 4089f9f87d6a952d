"""The grammar: every production of Scenic's own, each ambiguity that was designed for, and all listings of the paper."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import ParseError
from scenic_ref.semantics.syntax import Expression, Statement
from scenic_ref.semantics.syntax import dynamics as d
from scenic_ref.semantics.syntax import expressions as e
from scenic_ref.semantics.syntax import python_expressions as p
from scenic_ref.semantics.syntax import specifiers as sp
from scenic_ref.semantics.syntax import statements as s

LISTINGS = [chunk.partition("\n") for chunk in Path(__file__).with_name("listings.txt").read_text("utf-8").split("=== ")[1:]]


def one(text: str, dialect: str | None = None) -> Statement:
    (statement,) = parse(text, dialect=dialect).statements
    return statement


def value(text: str, dialect: str | None = None) -> Expression:
    statement = one(f"_ = ({text})", dialect)
    assert isinstance(statement, s.Assignment)
    node = statement.value
    return node.value if isinstance(node, e.ObjectOrValue) else node


def n(name: str) -> p.Name:
    return p.Name(name=name)


def c(constant: object) -> p.Constant:
    return p.Constant(value=constant)


def obj(head: str, *specifiers: object) -> e.ObjectDefinition:
    return e.ObjectDefinition(class_=n(head), specifiers=specifiers)  # type: ignore[arg-type]


def either(head: str, specifier: object, operator: Expression) -> e.ObjectOrOperator:
    return e.ObjectOrOperator(head=n(head), as_object=obj(head, specifier), as_operator=operator)


@pytest.mark.parametrize(("head", "_", "body"), LISTINGS, ids=[head for head, _, _ in LISTINGS])
def test_listing_of_the_paper_parses(head: str, _: str, body: str) -> None:
    assert parse(textwrap.dedent(body), dialect=head.split("|")[-1].strip()).statements


def test_there_are_sixty_listings() -> None:
    assert len(LISTINGS) >= 60


# -- Objects and operators


def test_class_alone_is_object_or_value_where_an_object_may_stand() -> None:
    bare = e.ObjectOrValue(value=n("Car"))
    assert one("Car") == s.ExpressionStatement(value=bare)
    assert one("ego = Car") == s.Assignment(targets=(n("ego"),), value=bare)
    assert one("def f(): return Car").body == (s.Return(value=bare),)  # type: ignore[attr-defined]
    assert one("class A:\n  x: lib.Car").properties[0].value == e.ObjectOrValue(value=p.Attribute(value=n("lib"), name="Car"))  # type: ignore[attr-defined]
    assert value("f(Car)") == p.Call(function=n("f"), arguments=(n("Car"),))


def test_name_before_an_operator_that_is_a_specifier_keeps_both_readings() -> None:
    assert value("E at X") == either("E", sp.AtSpecifier(vector=n("X")), e.FieldAt(field=n("E"), vector=n("X")))
    assert value("E offset by X") == either("E", sp.OffsetBySpecifier(offset=n("X")), e.OffsetBy(base=n("E"), offset=n("X")))
    along = e.OffsetAlong(base=n("E"), direction=n("D"), offset=n("V"))
    assert value("E offset along D by V") == either("E", sp.OffsetAlongSpecifier(direction=n("D"), offset=n("V")), along)
    seen = e.VisibleFrom(region=n("E"), viewer=n("P"))
    assert value("E visible from P") == either("E", sp.VisibleSpecifier(viewer=n("P")), seen)
    comparison = p.Comparison(left=n("E"), operators=("in",), operands=(n("R"),))
    assert value("E in R") == either("E", sp.InSpecifier(keyword="in", region=n("R")), comparison)


def test_in_within_a_condition_is_a_comparison() -> None:
    comparison = p.Comparison(left=n("ego"), operators=("in",), operands=(n("road"),))
    assert one("require ego in road") == s.Require(condition=comparison)
    assert one("if ego in road: pass").test == comparison  # type: ignore[attr-defined]
    assert value("not ego in road") == p.UnaryOperation(operator="not", operand=comparison)
    assert value("ego is in road") == comparison


def test_specifier_keywords_that_are_no_operators_make_objects() -> None:
    assert value("Car on R") == obj("Car", sp.InSpecifier(keyword="on", region=n("R")))
    assert value("Car visible") == obj("Car", sp.VisibleSpecifier())
    assert value("Car left of X by 3") == obj("Car", sp.BesideSpecifier(side="left", reference=n("X"), gap=c(3)))
    assert value("Car right of X") == obj("Car", sp.BesideSpecifier(side="right", reference=n("X")))
    assert value("Car ahead of X") == obj("Car", sp.BesideSpecifier(side="ahead", reference=n("X")))
    assert value("Car behind X") == obj("Car", sp.BesideSpecifier(side="behind", reference=n("X")))
    assert value("Car beyond A by O from B") == obj("Car", sp.BeyondSpecifier(vector=n("A"), offset=n("O"), origin=n("B")))
    assert value("Car following F from V for S") == obj("Car", sp.FollowingSpecifier(field=n("F"), origin=n("V"), distance=n("S")))
    assert value("Car facing H") == obj("Car", sp.FacingSpecifier(direction=n("H")))
    assert value("Car facing toward V") == obj("Car", sp.FacingTowardSpecifier(vector=n("V")))
    assert value("Car facing away from V") == obj("Car", sp.FacingAwayFromSpecifier(vector=n("V")))
    assert value("Car apparently facing H from V") == obj("Car", sp.ApparentlyFacingSpecifier(heading=n("H"), origin=n("V")))
    assert value("Car with x not a") == obj("Car", sp.WithSpecifier(property="x", value=p.UnaryOperation(operator="not", operand=n("a"))))


def test_specifier_comma_wins_over_the_comma_of_arguments_and_tuples() -> None:
    car = obj("Car", sp.AtSpecifier(vector=n("X")), sp.FacingSpecifier(direction=n("H")))
    assert value("f(Car at X, facing H, y)") == p.Call(function=n("f"), arguments=(car, n("y")))
    assert value("[Car at X, facing H, y]") == p.ListDisplay(items=(car, n("y")))
    assert value("f(x, at, facing=3)") == p.Call(function=n("f"), arguments=(n("x"), n("at")), keywords=(p.Keyword(name="facing", value=c(3)),))
    assert value("f(Car visible, with v 3)") == p.Call(
        function=n("f"), arguments=(obj("Car", sp.VisibleSpecifier(), sp.WithSpecifier(property="v", value=c(3))),)
    )


@pytest.mark.parametrize("gap", [",\n    ", ",  # why\n\n  # because\n    ", ", \\\n", ",\n\t"])
def test_comma_that_ends_a_line_continues_the_specifier_list(gap: str) -> None:
    assert one(f"Car at X{gap}facing H\n") == one("Car at X, facing H")


def test_tuple_that_ends_a_line_is_not_continued_by_a_statement() -> None:
    first, second = parse("if a:\n    x = 1,\n    at = 2").statements[0].then  # type: ignore[attr-defined]
    assert isinstance(first, s.Assignment)
    assert isinstance(second, s.Assignment)


# -- Precedence


def test_at_takes_the_rest_of_the_chain() -> None:
    tail = value("X offset by Y")
    assert value("F at X offset by Y") == either("F", sp.AtSpecifier(vector=tail), e.FieldAt(field=n("F"), vector=tail))
    assert value("H relative to F at X") == e.RelativeTo(left=n("H"), right=value("F at X"))


def test_offset_and_relative_associate_to_the_left() -> None:
    chain = value("3 offset by B offset by C")
    assert chain == e.OffsetBy(base=e.OffsetBy(base=c(3), offset=n("B")), offset=n("C"))
    chain = value("A relative to B relative to C")
    assert chain == e.RelativeTo(left=e.RelativeTo(left=n("A"), right=n("B")), right=n("C"))


def test_everything_after_the_first_operator_is_the_specifiers_argument() -> None:
    point = obj("OrientedPoint", sp.AtSpecifier(vector=value("(front of car) offset by (x @ y)")), sp.FacingSpecifier(direction=n("h")))
    assert value("OrientedPoint at (front of car) offset by (x @ y), facing h") == point
    assert value("Car at 3 relative to taxi").as_object == obj("Car", sp.AtSpecifier(vector=value("3 relative to taxi")))  # type: ignore[attr-defined]


def test_front_of_binds_tighter_than_offset() -> None:
    assert value("front of car offset by v") == e.OffsetBy(base=e.SideOf(side="front", object=n("car")), offset=n("v"))


def test_prefix_operators_end_before_a_comparison() -> None:
    distance = e.Distance(origin=n("ego"), target=n("b"))
    assert value("distance from ego to b < 10") == p.Comparison(left=distance, operators=("<",), operands=(c(10),))
    assert value("distance to b from ego") == distance
    assert value("distance from ego") == e.Distance(origin=n("ego"))
    assert value("angle to b from ego") == e.Angle(origin=n("ego"), target=n("b"))
    assert value("distance past x.car > 10").left == e.DistancePast(vector=p.Attribute(value=n("x"), name="car"))  # type: ignore[attr-defined]
    assert value("distance of a past b") == e.DistancePast(oriented_point=n("a"), vector=n("b"))
    assert value("relative heading of a from b") == e.RelativeHeading(heading=n("a"), origin=n("b"))
    assert value("apparent heading of a from b") == e.ApparentHeading(oriented_point=n("a"), origin=n("b"))
    assert value("follow F from V for S") == e.Follow(field=n("F"), origin=n("V"), distance=n("S"))
    assert value("visible ego.curb") == e.Visible(region=p.Attribute(value=n("ego"), name="curb"))
    assert value("a can see b") == e.CanSee(viewer=n("a"), target=n("b"))


@pytest.mark.parametrize("side", ["front", "back", "left", "right", "front left", "front right", "back left", "back right"])
def test_side_of_an_object(side: str) -> None:
    assert value(f"{side} of car") == e.SideOf(side=side, object=n("car"))  # type: ignore[arg-type]


def test_units_bind_tighter_than_arithmetic() -> None:
    assert value("a * (b) deg") == p.BinaryOperation(operator="*", left=n("a"), right=e.Degrees(value=n("b")))
    assert value("-5 deg") == p.UnaryOperation(operator="-", operand=e.Degrees(value=c(5)))
    assert value("R(1) seconds") == e.Seconds(value=p.Call(function=n("R"), arguments=(c(1),)))
    assert value("3 deg relative to f") == e.RelativeTo(left=e.Degrees(value=c(3)), right=n("f"))


# -- Soft keywords

WORDS = [
    "at",
    "by",
    "to",
    "on",
    "behind",
    "beyond",
    "past",
    "deg",
    "seconds",
    "steps",
    "until",
    "visible",
    "following",
    "facing",
    "param",
    "model",
    "mutate",
    "take",
    "wait",
    "terminate",
    "do",
    "choose",
    "shuffle",
    "abort",
    "override",
    "behavior",
    "monitor",
    "scenario",
    "precondition",
    "invariant",
    "setup",
    "compose",
    "interrupt",
    "when",
    "require",
    "ego",
    "workspace",
    "simulation",
    "relative",
    "offset",
    "front",
    "left",
    "of",
    "can",
    "see",
    "apparent",
    "initial",
    "new",
    "follow",
    "distance",
    "angle",
    "always",
    "eventually",
]


@pytest.mark.parametrize("word", WORDS)
def test_soft_keyword_is_a_variable(word: str) -> None:
    assert one(f"{word} = 3") == s.Assignment(targets=(n(word),), value=c(3))
    assert value(f"1 + {word}") == p.BinaryOperation(operator="+", left=c(1), right=n(word))
    assert value(f"f({word}={word})") == p.Call(function=n("f"), keywords=(p.Keyword(name=word, value=n(word)),))
    assert value(f"x.{word}.y") == p.Attribute(value=p.Attribute(value=n("x"), name=word), name="y")
    assert value(f"{word}.y[{word}]") == p.Subscript(value=p.Attribute(value=n(word), name="y"), index=n(word))
    assert one(f"def f({word}): return ({word})").parameters[0].name == word  # type: ignore[attr-defined]
    assert one(f"class A:\n    {word}: 3").properties[0].name == word  # type: ignore[attr-defined]
    assert value(f"Car with {word} 3") == obj("Car", sp.WithSpecifier(property=word, value=c(3)))


# -- Statements


def test_static_statements() -> None:
    assert one("model a.b.model") == s.Model(name="a.b.model")
    assert one("param time = 3, 'x y' = 4") == s.Param(
        assignments=(s.ParamAssignment(name="time", value=c(3)), s.ParamAssignment(name="x y", value=c(4)))
    )
    assert one("param a = 1,\n      b = 2") == one("param a = 1, b = 2")
    assert one("require[0.5] x") == s.SoftRequire(probability=c(0.5), condition=n("x"))
    assert one("require(x)") == s.Require(condition=n("x"))
    assert one("mutate") == s.Mutate()
    assert one("mutate a, b by 2") == s.Mutate(objects=(n("a"), n("b")), scale=c(2))
    assert one("mutate by 2") == s.Mutate(scale=c(2))


def test_dynamic_statements() -> None:
    a = p.Call(function=n("A"))
    assert one("take a, (b, c)") == d.Take(actions=(n("a"), p.TupleDisplay(items=(n("b"), n("c")))))
    assert one("take (a, b)") == d.Take(actions=(p.TupleDisplay(items=(n("a"), n("b"))),))
    assert one("wait") == d.Wait()
    assert one("terminate") == d.Terminate()
    assert one("abort") == d.Abort()
    assert one("terminate when x") == d.TerminateWhen(condition=n("x"))
    assert one("require always x") == d.RequireAlways(condition=n("x"))
    assert one("require eventually x") == d.RequireEventually(condition=n("x"))
    assert one("do A(), A()") == d.Do(invocations=(a, a))
    assert one("do A() for 30 seconds") == d.Do(invocations=(a,), limit=d.TimeLimit(amount=c(30), unit="seconds"))
    product = p.BinaryOperation(operator="*", left=c(2), right=n("x"))
    assert one("do A() for 2 * x seconds") == d.Do(invocations=(a,), limit=d.TimeLimit(amount=product, unit="seconds"))
    assert one("do A() for 3 steps") == d.Do(invocations=(a,), limit=d.TimeLimit(amount=c(3), unit="steps"))
    assert one("do A() until x in y").limit == d.Until(condition=p.Comparison(left=n("x"), operators=("in",), operands=(n("y"),)))  # type: ignore[attr-defined]
    assert one("do choose A, B") == d.DoChoose(invocations=(n("A"), n("B")))
    assert one("do shuffle {A: 2, B: 1}") == d.DoShuffle(invocations=(n("A"), n("B")), weights=(c(2), c(1)))
    assert one("override x at y, with z 3") == d.Override(
        object=n("x"), specifiers=(sp.AtSpecifier(vector=n("y")), sp.WithSpecifier(property="z", value=c(3)))
    )


def test_definitions_with_guards_and_blocks() -> None:
    behavior = one("behavior B(a, *b):\n  'doc'\n  precondition: x\n  invariant: y\n  wait")
    assert isinstance(behavior, d.BehaviorDefinition)
    assert behavior.preconditions == (n("x"),)
    assert behavior.invariants == (n("y"),)
    assert behavior.body[-1] == d.Wait()
    assert one("monitor M:\n  wait") == d.MonitorDefinition(name="M", parameters=(), body=(d.Wait(),))
    scenario = one("scenario S(gap=3):\n  precondition: x\n  setup:\n    y = 1\n  compose:\n    wait")
    assert isinstance(scenario, d.ScenarioDefinition)
    assert scenario.setup == parse("y = 1").statements
    assert scenario.compose == (d.Wait(),)
    plain = one("scenario S():\n  y = 1")
    assert isinstance(plain, d.ScenarioDefinition)
    assert plain.setup == parse("y = 1").statements


def test_try_with_interrupts() -> None:
    node = one("try:\n  pass\ninterrupt when x in y:\n  pass\nexcept (A, B) as e:\n  pass\nelse: pass\nfinally: pass")
    assert isinstance(node, s.Try)
    assert node.interrupts[0].condition == p.Comparison(left=n("x"), operators=("in",), operands=(n("y"),))
    assert node.handlers[0].name == "e"
    assert node.otherwise == node.final == (s.Pass(),)


def test_class_has_properties_and_python_members() -> None:
    node = one("class A(B):\n  'doc'\n  x: 1\n  def f(self): pass\n  y = 2\n  z: 1, 2")
    assert isinstance(node, s.ClassDefinition)
    assert [item.name for item in node.properties] == ["x", "z"]
    assert [type(item) for item in node.body] == [s.ExpressionStatement, s.FunctionDefinition, s.Assignment]


# -- Texts and places


def test_f_string_is_split_into_pieces() -> None:
    node = value('f"a{b!r:>{w}}c{d=}"')
    layout = p.FString(parts=(">", p.FormattedValue(value=n("w"))))
    expected = ("a", p.FormattedValue(value=n("b"), conversion="r", format=layout), "cd=", p.FormattedValue(value=n("d"), conversion="r"))
    assert node == p.FString(parts=expected)


def test_spans_are_one_based_and_exact() -> None:
    program = parse("x = 1\nif a:\n    Car at (1, 2),\n        facing 30 deg\ny = f'{a} {bc}'\n", "f")
    branch = program.statements[1]
    assert isinstance(branch, s.If)
    assert branch.span == ("f", 2, 1, 4, 22)
    car = branch.then[0].value  # type: ignore[attr-defined]
    assert car.span == ("f", 3, 5, 4, 22)
    assert car.specifiers[1].span == ("f", 4, 9, 4, 22)
    interpolated = program.statements[2].value.parts[2]  # type: ignore[attr-defined]
    assert interpolated.span == ("f", 5, 12, 5, 14)


# -- Dialects


def test_pldi19_pair_is_an_interval_outside_vector_positions() -> None:
    interval = e.IntervalOrPair(low=c(1), high=c(2))
    assert value("(1, 2)", "pldi19") == interval
    assert value("(1, 2) deg", "pldi19") == e.Degrees(value=interval)
    assert value("(1, 2) @ (1, 2)", "pldi19") == e.VectorOf(x=interval, y=interval)
    pair = p.TupleDisplay(items=(c(1), c(2)))
    assert value("Car offset by (1, 2), at (1, 2)", "pldi19") == obj("Car", sp.OffsetBySpecifier(offset=pair), sp.AtSpecifier(vector=pair))
    assert value("(1, 2)") == pair


def test_first_line_names_the_dialect() -> None:
    assert parse("# dialect: pldi19\nx = (1, 2)").dialect == "pldi19"
    assert parse("# dialect: pldi19\nx = (1, 2)", dialect="paper").dialect == "paper"


def test_scenic_3_makes_objects_with_new() -> None:
    assert value("new Car", "scenic-3") == obj("Car")
    assert value("new Car at X, facing H", "scenic-3") == value("Car at X, facing H")
    assert value("Car", "scenic-3") == n("Car")
    assert one("ego = Car", "scenic-3") == s.Assignment(targets=(n("ego"),), value=n("Car"))
    assert one("require monitor M()", "scenic-3") == d.RequireMonitor(monitor=p.Call(function=n("M")))
    assert value("initial scenario", "scenic-3") == e.InInitialScenario()
    with pytest.raises(ParseError, match="new"):
        parse("Car with x 3", dialect="scenic-3")
    with pytest.raises(ParseError, match="scenic-3"):
        parse("new Car")




# -- Blanks before brackets

TIGHT = [
    ("ego = {new}Object at(0, 0), facing(3)", "ego = {new}Object at (0, 0), facing (3)"),
    ("ego = {new}Object with paint[0.2, 0.4], with tags{{1: 2}}", "ego = {new}Object with paint [0.2, 0.4], with tags {{1: 2}}"),
    ("ego = {new}Object at x, with offset(0, 1), with name'a'", "ego = {new}Object at x, with offset (0, 1), with name 'a'"),
    ("ego = {new}Object left of(x) by(3), facing toward(1, 2)", "ego = {new}Object left of (x) by (3), facing toward (1, 2)"),
    ("ego = {new}Object with a 1, in(region), apparently facing(3)", "ego = {new}Object with a 1, in (region), apparently facing (3)"),
    ("ego = {new}Object with a 1, offset by(1, 2)", "ego = {new}Object with a 1, offset by (1, 2)"),
    ("ego = {new}Object with a 1, at(1, 2)", "ego = {new}Object with a 1, at (1, 2)"),
    ("ego = {new}Object with a 1,\n    beyond(1, 2) by(3, 4),\n    on(region)", "ego = {new}Object with a 1, beyond (1, 2) by (3, 4), on (region)"),
    ("x = [{new}Object at(1, 2), behind(y)]", "x = [{new}Object at (1, 2), behind (y)]"),
    ("require always(x)", "require always (x)"),
    ("require eventually(x)", "require eventually (x)"),
    ("y = visible(r)", "y = visible (r)"),
    ("behavior B():\n    take(1)", "behavior B():\n    take (1)"),
    ("behavior B():\n    do(C())", "behavior B():\n    do (C())"),
    ("scenario S():\n    compose:\n        do choose(C()), D()", "scenario S():\n    compose:\n        do choose (C()), D()"),
    ("scenario S():\n    compose:\n        do shuffle{{C(): 1}}", "scenario S():\n    compose:\n        do shuffle {{C(): 1}}"),
]


@pytest.mark.parametrize("dialect", ["paper", "scenic-2.1", "scenic-3"])
@pytest.mark.parametrize(("tight", "spaced"), TIGHT, ids=[tight.replace("\n", " ") for tight, _ in TIGHT])
def test_a_bracket_may_follow_at_once(tight: str, spaced: str, dialect: str) -> None:
    new = "new " if dialect == "scenic-3" else ""
    assert parse(tight.format(new=new), dialect=dialect).statements == parse(spaced.format(new=new), dialect=dialect).statements


@pytest.mark.parametrize("word", ["at", "on", "behind", "beyond", "following", "facing", "take", "do", "always", "choose"])
def test_a_name_that_is_a_word_of_the_language_stays_one(word: str) -> None:
    """Where no object is being defined, `facing(b)` behind a comma is a call; a word is a name where something is assigned to it."""
    assert one(f"x = (a, {word}.b, {word})") == s.Assignment(
        targets=(n("x"),), value=p.TupleDisplay(items=(n("a"), p.Attribute(value=n(word), name="b"), n(word)))
    )
    assert isinstance(one(f"{word} = 3"), s.Assignment)
    call = p.Call(function=n(word), arguments=(n("b"),))
    assert one(f"x = f(a, {word}(b))") == s.Assignment(targets=(n("x"),), value=p.Call(function=n("f"), arguments=(n("a"), call)))


def test_a_line_that_goes_on_with_a_call_after_a_comma_is_not_joined() -> None:
    with pytest.raises(ParseError, match="indentation"):
        parse("x = 1,\n    facing(3)\n")


SPECIFIERS = (
    "facing 3", "with width 2", "at (3, 4)", "in R", "on R", "left of A", "right of A by 2", "ahead of A", "behind A", "beyond A by O", "visible",
    "visible from A", "offset by V", "offset along D by V", "following F for 3", "facing toward V", "facing away from V", "apparently facing H",
)  # fmt: skip


@pytest.mark.parametrize("specifier", SPECIFIERS)
@pytest.mark.parametrize("comma", [",\n", ", # why\n", ",\n\n# why\n\n", "\n,\n", "\n, "])
def test_indentation_within_brackets_does_not_count(specifier: str, comma: str) -> None:
    """Python's rule: within brackets the lines of a program have no structure, so that a specifier may begin in the first column."""
    assert value(f"Car with p 1{comma}{specifier}") == value(f"Car with p 1, {specifier}")
    assert value(f"[f(Car with p 1{comma}{specifier}), 2]") == value(f"[f(Car with p 1, {specifier}), 2]")


@pytest.mark.parametrize("word", ["visible", "at (3)", "facing (3)", "on (3)"])
def test_outside_of_brackets_a_line_in_the_first_column_is_a_statement(word: str) -> None:
    first, second = parse(f"x = 1,\n{word}\n").statements
    assert (first, [second]) == (one("x = 1,"), [*parse(word).statements])


VISIBLE = [
    "(1, {})", "(x, {})", "[1,\n{}]", "{{1, {}}}", "f(1, {})", "x[1, {}]", "(a.b, {}, c)", "(f(x), {})", "(Car with p (1, {}), facing 3)",
    "((Car at V), {})", "{{1: (2, {})}}", "lambda: (1, {})",
]  # fmt: skip


@pytest.mark.parametrize("text", VISIBLE)
def test_visible_behind_a_comma_is_a_variable_where_no_specifier_stands_before_it(text: str) -> None:
    """Nodes are equal wherever they stand; texts of the name are compared as that of another."""
    named, other = (repr(parse(f"_ = {text.format(name)}").statements).replace(repr(name), "NAME") for name in ("visible", "vehicle"))
    assert named == other


@pytest.mark.parametrize("text", ["Car with p 1, visible", "Car visible, visible", "Car in R, visible", "Car with p (1, x), visible"])
def test_visible_behind_a_comma_is_a_specifier_where_one_stands_before_it(text: str) -> None:
    found = value(text)
    assert isinstance(found, e.ObjectDefinition)
    assert found.specifiers[-1] == sp.VisibleSpecifier()




@pytest.mark.parametrize("end", ["", ","])
def test_the_specifiers_of_a_new_object_may_stand_in_lines_of_their_own(end: str) -> None:
    """Scenic 3 reads `new C,` with an indented block of specifiers, whose last line may end with a comma."""
    block = parse(f"ego = new Car,\n    at (1, 2),\n    with x 3{end}\nnew Car,\n    facing 3{end}\n", dialect="scenic-3").statements
    assert block == parse("ego = new Car at (1, 2), with x 3\nnew Car facing 3\n", dialect="scenic-3").statements
    half = parse(f"ego = new Car at (1, 2),\n    with x 3{end}\n", dialect="scenic-3").statements
    assert half == parse("ego = new Car at (1, 2), with x 3\n", dialect="scenic-3").statements


def test_a_comma_behind_an_object_in_one_line_makes_a_tuple() -> None:
    statement = one("x = new Car with y 1,", "scenic-3")
    assert isinstance(statement, s.Assignment) and isinstance(statement.value, p.TupleDisplay)
    with pytest.raises(ParseError, match="a specifier follows"):
        parse("ego = new Car, with x 3", dialect="scenic-3")
