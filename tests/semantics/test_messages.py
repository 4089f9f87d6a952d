"""What errors of a run say: which of several messages, where each would be one."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import ProgramError, SpecifiedTwice

BEHAVIOR = """
behavior Go():
    while True: take 1
behavior B():
{}
ego = Object at (0, 0), with behavior B
"""


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("ego = Object at (0, 0)\np = Point at (5, 5)\nmutate p", "only Objects can be mutated, not an instance of Point"),
        ("ego = Object at (0, 0)\nmutate ego by -1", "`mutate ... by` expects a number that is at least 0, not -1"),
        ("ego = Object at (0, 0)\nraise ValueError('this and no more')", "ValueError: this and no more"),
        ("ego = Object at (0, 0)\nraise ValueError('a' * 1000)", f"ValueError: {'a' * 1000}"),
        ("ego = Object at (0, 0)\nraise ValueError('a' * 1001)", f"ValueError: {'a' * 1000}..."),
        ("ego = Object at (0, 0)\nx = [*Uniform(range(2000001), range(1, 2000002))]", "2000001 elements are too many"),
        ("ego = Object at (0, 0), with width 'wide'", "the property width must be a scalar, not a string (from `with width`)"),
        ("ego = Object at (0, 0), with requireVisible 1", "the property requireVisible must be True or False, not 1 (from `with requireVisible`)"),
        ("ego = Object\no = Uniform(ego, Object at (9, 9))\no.width += 3",
         "which instance of Object this changes is random: it depends on Uniform(...) (line 2)"),
        ("ego = Object\ndel ego", "ego cannot be deleted"),
        ("workspace = Workspace(everywhere)\nego = Object\ndel workspace", "workspace cannot be deleted"),
        ("ego = Object\nego += 1", "TypeError: unsupported operand type(s) for +: 'Vector' and 'int'"),
        ("ego = Object\nx = 1 - ego", "TypeError: unsupported operand type(s) for -: 'int' and 'Vector'"),
        ("ego = Object\nx = len(ego)", "TypeError: object of type 'instance' has no len()"),
        ("ego = Object\nfor i in ego: pass", "TypeError: 'instance' object is not iterable"),
        ("ego = Object\nx = len(Object)", "TypeError: object of type 'class' has no len()"),
        ("ego = Object\nx = len(lambda: 1)", "TypeError: object of type 'function' has no len()"),
        ("behavior B(): wait\nego = Object\nx = B() + 1", "TypeError: unsupported operand type(s) for +: 'behavior or scenario' and 'int'"),
        ("ego = Object\nx = Range + 1", "TypeError: unsupported operand type(s) for +: 'distribution' and 'int'"),
        ("import math\nego = Object\nx = len(math)", "TypeError: object of type 'module' has no len()"),
        ("r = CircularRegion((0, 0), 3)\nr.orientation = VectorField('f', lambda p: 1)\nego = Object",
         "regions do not change: orientation of a region cannot be assigned"),
        ("ego = Object in Region", "`in` expects a region, not the class Region"),
        ("ego = Object\nx = everywhere.intersect(3)", "intersect() takes a region, not 3"),
        ("ego = Object\nx = CircularRegion((0, 0), 3).union('a')", "union() takes a region, not 'a'"),
        ("ego = Object\nx = everywhere.difference(ego)", "difference() takes a region, not (0.0, 0.0)"),
        ("ego = Object\nrequire everywhere.intersects(3)", "intersects() takes a region, not 3"),
        ("ego = Object\nrequire CircularRegion((0, 0), 3).containsPoint(3)", "containsPoint() takes a vector, not 3"),
        ("ego = Object at (0, 0), with length -2", "the property length must be at least 0, not -2 (from `with length`)"),
    ],
)
def test_an_error_of_a_scene_says(program: str, message: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program).sample()
    assert raised.value.message == message


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("    do Go() until 7", "the condition of `until` must be a boolean, not a scalar"),
        ("    try:\n        do Go()\n    interrupt when 7:\n        take 2", "the condition of an interrupt must be a boolean, not a scalar"),
    ],
)
def test_an_error_of_a_behavior_says(body: str, message: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(BEHAVIOR.format(body)).simulate(steps=2, backend="interpreter")
    assert raised.value.message == message


OTHERS = """
scenario Sub():
    setup:
        Object at (9, 9)
monitor M:
    wait
"""


@pytest.mark.parametrize("backend", ["interpreter", "compiled"])
@pytest.mark.parametrize(
    ("taken", "message", "hint"),
    [
        ("Go()", "Go() is a behavior, not an action", "write `do Go()`"),
        ("Go", "Go is a behavior, not an action", "write `do Go()`"),
        ("1, Go", "Go is a behavior, not an action", "write `do Go()`"),
        ("[1, Go()]", "Go() is a behavior, not an action", "write `do Go()`"),
        ("Sub()", "Sub() is a scenario, not an action", "write `do Sub()` in a compose block"),
        ("M", "M is a monitor, not an action", "a monitor runs from its definition on, or, in dialect scenic-3, by `require monitor`"),
    ],
)
def test_who_takes_what_is_no_action_is_told_what_it_is(taken: str, message: str, hint: str, backend: str) -> None:
    program = BEHAVIOR.format(f"    take {taken}") + OTHERS
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program).simulate(steps=2, backend=backend)
    assert (raised.value.message, raised.value.hint) == (message, hint)
    assert (raised.value.rule, raised.value.span.line) == ("D-Take", 5)


def test_a_class_of_actions_is_no_action() -> None:
    program = "model scenic.domains.driving.model\n" + BEHAVIOR.format("    take SetBrakeAction").replace("Object at (0, 0), with", "Car with")
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program).simulate(steps=2)
    assert raised.value.message == "SetBrakeAction is a class of actions, not an action"


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ("X(1): 0, X(2): 1", "`do shuffle`: the weights of all options that are left and enabled (X(1)) are 0"),
        ("X(1): 0, X(2): 0", "`do shuffle`: the weights of all options that are left and enabled (X(1), X(2)) are 0"),
        ("X(1): 1, X(2): -1", "`do shuffle`: the weight of X(2) must not be negative, but it is -1"),
        ("X(1): 'a'", "`do shuffle`: the weight of X(1) must be a finite number, not a string"),
        ("X(1): 1e400", "`do shuffle`: the weight of X(1) must be a finite number, not inf"),
    ],
)
def test_an_error_of_weights_speaks_of_the_statement(weights: str, message: str) -> None:
    before = f"behavior X(n):\n    take n\nbehavior B():\n    do shuffle {{{weights}}}\nego = Object with behavior B"
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(before).simulate(steps=3, backend="interpreter")
    assert (raised.value.message, raised.value.span.line) == (message, 4)
    assert (raised.value.span.column > 5) == ("the weight of" in message)  # the weight is marked, where one is wrong


@pytest.mark.parametrize(
    ("program", "line", "name"),
    [
        ("def f(n):\n    return f(n + 1)\nego = Object\nparam y = f(0)", 2, "f"),
        ("def a(n):\n    return b(n)\ndef b(n):\n    return a(n)\nego = Object\nparam y = a(0)", 4, "a"),
        ("class K(object):\n    def __init__(self):\n        self.x = K()\nego = Object\nparam y = K()", 3, "__init__"),
        ("f = lambda n: (\n    f(n))\nego = Object\nparam y = f(0)", 2, "<lambda>"),
    ],
)
def test_recursion_that_is_too_deep_points_at_the_call(program: str, line: int, name: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program).sample()
    assert (raised.value.span.line, raised.value.message) == (line, f"{name} is called too deeply (3000 calls are open)")
    assert raised.value.hint.startswith(f"{name} is defined on line ")


@pytest.mark.parametrize(
    ("specifiers", "hint"),
    [
        ("with length 2, with height 3", "height is another spelling of length"),
        ("with width 2, with width 3", ""),
        ("at (9, 9), visible", "to require it of the other's position, leave `visible` out and write `require P can see x`"),
    ],
)
def test_the_hint_about_a_property_that_is_specified_twice(specifiers: str, hint: str) -> None:
    with pytest.raises(SpecifiedTwice) as raised:
        scenic_ref.loads(f"ego = Object at (0, 0)\nObject {specifiers}").sample()
    assert raised.value.hint.startswith(hint) and bool(raised.value.hint) == bool(hint)


@pytest.mark.parametrize("dialect", ["scenic-2.1", "scenic-3"])
def test_names_of_the_releases_that_have_nothing_to_do_here(dialect: str) -> None:
    new = "new " if dialect == "scenic-3" else ""
    program = f"""
from scenic.core.distributions import distributionMethod, distributionFunction
class A(object):
    @distributionMethod
    def f(self, x): return x + 1
@distributionFunction
def g(x): return x + 1
r = PolygonalRegion([(0, 0), (4, 0), (0, 4)])
ego = {new}Object
param sums = A().f(2) + g(Uniform(2, 2)), same = r.polygons.containsPoint((1, 1)) and not r.polygons.containsPoint((9, 9))
"""
    assert scenic_ref.loads(program, dialect=dialect).sample().params == {"sums": 6, "same": True}


@pytest.mark.parametrize(
    ("program", "place"),
    [
        ("a = Object with width 3,\n    with length 4,\n    offset by (1, 2)\nego = Object", (3, 5)),
        ("a = Object with width 3,\n    ahead of (1, 2),\n    facing toward (1, 2),\n    visible\nego = Object", (4, 5)),
        ("ego = Object at (0, 0),\n    with width 2,\n    facing 10**400", (3, 5)),
        ("ego = Object at (10**400, 0),\n    with width 2", (1, 14)),
        ("ego = Object\nimport math as workspace", (2, 8)),
        ("ego = Object\nfrom math import pi as workspace", (2, 18)),
        ("ego = Object\nworkspace = 3", (2, 1)),
    ],
)
def test_the_place_of_an_error_is_that_of_the_specifier_or_import(program: str, place: tuple[int, int]) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(program).sample()
    assert (raised.value.span.line, raised.value.span.column) == place


@pytest.mark.parametrize("value", ["3", "Object", "'B'", "print"])
def test_the_behavior_of_an_override_is_looked_at_there(value: str) -> None:
    program = "scenario Main():\n    setup:\n        ego = Object\n    compose:\n        do Sub()\n"
    program += f"scenario Sub():\n    setup:\n        override ego with behavior {value}\n    compose:\n        wait\n"
    with pytest.raises(ProgramError, match="the property behavior must be a behavior") as raised:
        scenic_ref.loads(program, scenario="Main").simulate(steps=3)
    assert (raised.value.span.line, raised.value.span.column) == (8, 36)
