"""One small program per rule: what fires the rule, and the value that the paper's equation gives, worked out by hand.

`ego` stands at (3, 4) with heading 90 deg (facing West) unless the program says otherwise; results are params.
"""

from __future__ import annotations

import math
from typing import NamedTuple

D = math.pi / 180
EGO = "ego = Object at (3, 4), facing 90 deg, with allowCollisions True\n"
FAR = ", with allowCollisions True, with requireVisible False"


class Case(NamedTuple):
    """A program, the params that it must give, and readings that differ from the paper's."""

    rule: str
    program: str
    params: dict[str, object]
    readings: dict[str, str] = {}  # noqa: RUF012


def op(rule: str, expression: str, result: object, before: str = "", **readings: str) -> Case:
    """An expression evaluated after ego."""
    return Case(rule, f"{EGO}{before}param r = {expression}\n", {"r": result}, {k.replace("_", "-"): v for k, v in readings.items()})


def spec(rule: str, specifiers: str, position: tuple[float, float], heading: float = 0.0, before: str = "", **readings: str) -> Case:
    """An object made with specifiers after ego: where it stands and how it faces."""
    program = f"{EGO}{before}o = Object {specifiers}{FAR}\nparam p = o.position, h = o.heading\n"
    return Case(rule, program, {"p": position, "h": heading}, {k.replace("_", "-"): v for k, v in readings.items()})


# An oriented point facing South-West-ish: heading 180 deg at (10, 0), so that ahead is -y and left is +x.
OP = "op = OrientedPoint at (10, 0), facing 180 deg\n"
TAXI = "taxi = Object at (10, 0), facing 180 deg, with width 2, with length 4, with requireVisible False\n"
FIELD = "f = VectorField('f', lambda v: 90 deg)\ng = VectorField('g', lambda v: v.x * 1 deg)\n"
POLY = "r = RectangularRegion((0, 0), 0, 4, 2)\n"

CASES: list[Case] = [
    # Scalar operators
    op("O-RelativeHeading-Ego", "relative heading of 100 deg", 10 * D),
    op("O-RelativeHeading", "relative heading of 100 deg from 30 deg", 70 * D),
    op("O-ApparentHeading-Ego", "apparent heading of op", 180 * D - math.atan2(-7, -4), OP),
    op("O-ApparentHeading", "apparent heading of op from (10, -5)", 180 * D, OP),
    op("O-Distance-Ego", "distance to (6, 8)", 5.0),
    op("O-Distance", "distance from (0, 0) to (5, 12)", 13.0),
    op("O-Distance-Region", "distance from (5, 0) to r", 3.0, POLY),
    op("O-DistancePast-Ego", "distance past (10, 4)", 7.0),
    op("O-DistancePast", "distance of op past (10, 3)", 3.0, OP),
    op("O-Angle-Ego", "angle to (3, 9)", 0.0),
    op("O-Angle", "angle from (1, 1) to (0, 1)", 90 * D),
    # Boolean operators
    op("O-CanSee-Object", "(v can see taxi, w can see taxi)", (True, False), TAXI + "v = Point at (10, 12), with viewDistance 10\nw = Point at (10, 12), with viewDistance 9.9\n"),
    op("O-CanSee-Vector", "(v can see (0, 5), v can see (5, 0))", (True, False), "v = OrientedPoint with viewAngle 80 deg, with viewDistance 5\n"),
    op("O-In-Vector", "((2, 1) in r, (2.01, 1) in r)", (True, False), POLY),
    op("O-In-Object", "(a in r, b in r)", (True, False), POLY + f"a = Object at (1.5, 0.5){FAR}\nb = Object at (1.51, 0.5){FAR}\n"),
    # Heading operators
    op("O-Deg", "180 deg", math.pi),
    op("O-At", "g at (30, 7)", 30 * D, FIELD),
    spec("O-RelativeTo-Fields", "at (20, 0), facing f relative to g", (20, 0), 110 * D, FIELD),
    spec("O-RelativeTo-HeadingField", "at (20, 0), facing 5 deg relative to g", (20, 0), 25 * D, FIELD),
    spec("O-RelativeTo-FieldHeading", "at (20, 0), facing g relative to 5 deg", (20, 0), 25 * D, FIELD),
    op("O-RelativeTo-Headings", "10 deg relative to ego", 100 * D),
    # Vector operators
    op("O-VectorOf", "2 @ 3", (2.0, 3.0)),
    op("O-RelativeTo-Vectors", "(1, 2) relative to (10, 20)", (11.0, 22.0)),
    op("O-OffsetBy-Vector", "(1, 2) offset by (10, 20)", (11.0, 22.0)),
    op("O-OffsetAlong-Heading", "(1, 2) offset along 90 deg by (0, 5)", (-4.0, 2.0)),
    op("O-OffsetAlong-Field", "(1, 2) offset along f by (0, 5)", (-4.0, 2.0), FIELD),
    # Region operators
    op("O-Visible-Ego", "((3, 50) in x, (3, 60) in x)", (True, False), "x = visible everywhere\n"),
    op("O-VisibleFrom", "((0, 2) in x, (0, 5) in x)", (True, False), "x = everywhere visible from (Point at (0, 0), with viewDistance 3)\n"),
    # OrientedPoint operators
    op("O-RelativeTo-VectorOrientedPoint", "(q.position, q.heading)", ((9.0, -2.0), 180 * D), OP + "q = (1, 2) relative to op\n"),
    op("O-OffsetBy-OrientedPoint", "(q.position, q.heading)", ((9.0, -2.0), 180 * D), OP + "q = op offset by (1, 2)\n"),
    op("O-Follow-Ego", "(q.position, q.heading)", ((-5.0, 4.0), 90 * D), FIELD + "q = follow f for 8\n"),
    op("O-Follow", "(q.position, q.heading)", ((-8.0, 0.0), 90 * D), FIELD + "q = follow f from (0, 0) for 8\n"),
    op("O-FrontOf", "(front of taxi).position", (10.0, -2.0), TAXI),
    op("O-BackOf", "(back of taxi).position", (10.0, 2.0), TAXI),
    op("O-LeftOf", "(left of taxi).position", (11.0, 0.0), TAXI),
    op("O-RightOf", "(right of taxi).position", (9.0, 0.0), TAXI),
    op("O-FrontLeftOf", "(front left of taxi).position", (11.0, -2.0), TAXI),
    op("O-BackLeftOf", "(back left of taxi).position", (11.0, 2.0), TAXI),
    op("O-FrontRightOf", "(front right of taxi).position", (9.0, -2.0), TAXI),
    op("O-BackRightOf", "(back right of taxi).position", (9.0, 2.0), TAXI),
    # Specifiers for position
    spec("P-With", "at (1, 1), with heading 2", (1, 1), 2.0),
    spec("P-Default", "at (1, 1)", (1, 1)),
    spec("P-At", "at (1, 7)", (1, 7)),
    spec("P-OffsetBy-Local", "offset by (1, 5)", (-2, 5)),
    spec("P-OffsetBy-Global", "offset by (1, 5)", (4, 9), offset_by="global"),
    spec("P-OffsetAlong-Heading", "offset along 180 deg by (1, 5)", (2, -1)),
    spec("P-OffsetAlong-Field", "offset along f by (1, 5)", (-2, 5), 0.0, FIELD),
    spec("P-Beside-Zero", "left of (0, 0)", (-0.5, 0)),
    spec("P-LeftOf-Vector", "left of (0, 0) by 2, with width 4", (-4, 0)),
    spec("P-RightOf-Vector", "right of (0, 0) by 2, with width 4, facing 90 deg", (0, 4), 90 * D),
    spec("P-AheadOf-Vector", "ahead of (0, 0) by 2, with length 4", (0, 4)),
    spec("P-Behind-Vector", "behind (0, 0) by 2, with length 4", (0, -4)),
    spec("P-LeftOf-OrientedPoint", "left of op by 2, with width 4", (14, 0), 180 * D, OP),
    spec("P-RightOf-OrientedPoint", "right of op by 2, with width 4", (6, 0), 180 * D, OP),
    spec("P-AheadOf-OrientedPoint", "ahead of op by 2, with length 4", (10, -4), 180 * D, OP),
    spec("P-Behind-OrientedPoint", "behind op by 2, with length 4", (10, 4), 180 * D, OP),
    spec("P-LeftOf-Object", "left of taxi by 2, with width 4", (15, 0), 180 * D, TAXI),
    spec("P-RightOf-Object", "right of taxi by 2, with width 4", (5, 0), 180 * D, TAXI),
    spec("P-AheadOf-Object", "ahead of taxi by 2, with length 4", (10, -6), 180 * D, TAXI),
    spec("P-Behind-Object", "behind taxi by 2, with length 4", (10, 6), 180 * D, TAXI),
    spec("P-Beyond-Ego", "beyond (3, 14) by (1, 2)", (4, 16)),
    spec("P-Beyond", "beyond (0, 5) by (1, 2) from (5, 5)", (-2, 6)),
    Case("P-Visible-Ego", f"{EGO}o = Object visible{FAR}\nparam r = (distance to o) <= 50\n", {"r": True}),
    Case("P-Visible", f"{EGO}q = Point at (9, 9), with viewDistance 1\no = Object visible from q{FAR}\nparam r = (distance from q to o) <= 1\n", {"r": True}),
    # Specifiers for position and optionally heading
    Case("P-In", f"{EGO}o = Object in PolylineRegion([(0, 0), (0, 9)]){FAR}\nparam r = o.position in PolylineRegion([(0, 0), (0, 9)]), h = o.heading\n", {"r": True, "h": 0.0}),
    spec("P-Following-Ego", "following f for 8", (-5, 4), 90 * D, FIELD),
    spec("P-Following", "following f from (0, 0) for 8", (-8, 0), 90 * D, FIELD),
    # Specifiers for heading
    spec("P-Facing-Heading", "at (0, 0), facing op", (0, 0), 180 * D, OP),
    spec("P-Facing-Field", "at (20, 0), facing g", (20, 0), 20 * D, FIELD),
    spec("P-FacingToward", "at (0, 0), facing toward (-1, 0)", (0, 0), 90 * D),
    spec("P-FacingAwayFrom", "at (0, 0), facing away from (-1, 0)", (0, 0), -90 * D),
    spec("P-ApparentlyFacing-Ego", "at (3, 9), apparently facing 30 deg", (3, 9), 30 * D),
    spec("P-ApparentlyFacing", "at (0, 0), apparently facing 30 deg from (1, 0)", (0, 0), 120 * D),
    # Distributions, classes, object definitions
    Case("E-Distributions", "x = Range(2, 2)\nego = Object\nparam r = x\n", {"r": 2.0}),
    Case("E-Resample", "x = Uniform(7)\ny = resample(x)\nego = Object\nparam r = y\n", {"r": 7}),
    Case("E-Resample-Constant", "ego = Object\nparam r = resample(4)\n", {"r": 4}),
    Case("E-ObjectDefinition", "class A:\n    p: self.q + 1\n    q: 2\nego = A with q 5\nparam r = ego.p\n", {"r": 6}),
    Case("R-ResolveSpecifiers", "ego = Object facing toward (0, 9), at (0, 5)\nparam r = ego.heading\n", {"r": 0.0}),
    Case("S-Class", "class A:\n    w: 3\nclass B(A):\n    v: self.w\nego = B\nparam r = ego.v\n", {"r": 3}),
    # Statements
    Case("S-Assignment", "x = 1\na, *b = x, 2, 3\nego = Object\nparam r = (a, b)\n", {"r": (1, [2, 3])}),
    Case("S-Param", "ego = Object\nparam a = 1, b = 'x'\nparam a = 2\n", {"a": 2, "b": "x"}),
    Case("S-Require", "x = Uniform(1, 2)\nrequire x == 2\nego = Object\nparam r = x\n", {"r": 2}),
    Case("S-Require-Capture", "x = Uniform(1, 2)\nrequire x == 2\nego = Object\nparam r = x\n", {"r": 2}, {"require-time": "end"}),
    Case("S-SoftReq-Check", "x = Uniform(1, 2)\nrequire[1] x == 2\nego = Object\nparam r = x\n", {"r": 2}),
    Case("S-SoftReq-Skip", "require[0] False\nego = Object\nparam r = 1\n", {"r": 1}),
    Case("S-Mutate", "ego = Object at (1, 1), with positionStdDev 0, with headingStdDev 0\nmutate ego by 3\nparam r = ego.mutationScale\n", {"r": 3}),
    Case("S-Model", "model mars\nego = Rover at (0, 0)\nparam r = ego.length\n", {"r": 0.7}),
    Case("S-Dynamic", "ego = Object\nrequire always True\nparam r = 1\n", {"r": 1}),
    Case("S-Definition", "behavior B(x=2):\n    wait\nego = Object with behavior B(3)\nparam r = 1\n", {"r": 1}),
    Case("E-Call-Dynamic", "behavior B(x=2):\n    wait\nego = Object with behavior B(3)\nparam r = 1\n", {"r": 1}),
    Case("E-Seconds", "ego = Object\nparam r = 3 seconds\n", {"r": 3}),
    Case("E-InInitialScenario", "if in initial scenario:\n    x = 1\nelse:\n    x = 2\nego = Object\nparam r = x\n", {"r": 1}),
    Case("T-Mutate", "ego = Object\nparam r = 1\n", {"r": 1}),
    Case("T-Check", "ego = Object\nparam r = 1\n", {"r": 1}),
    # Inherited from Python
    Case("E-Constant", "ego = Object\nparam r = 3 if True else 2\n", {"r": 3}),
    Case("E-Variable", "x = 1\nego = Object\nif x:\n    x = 2\nparam r = x\n", {"r": 2}),
    Case("E-Display", "ego = Object\nparam r = [1, (2, 3), {'k': 4}]\n", {"r": [1, (2, 3), {"k": 4}]}),
    Case("E-FString", "x = 1.5\nego = Object\nparam r = f'{x:.2f}!'\n", {"r": "1.50!"}),
    Case("E-Attribute", "ego = Object at (1, 2)\nparam r = ego.position.y\n", {"r": 2.0}),
    Case("E-Subscript", "x = [1, 2, 3]\nego = Object\nparam r = x[1:]\n", {"r": [2, 3]}),
    Case("E-Arithmetic", "ego = Object\nparam r = 2 + 3 * 4 ** 2 // 5 % 4\n", {"r": 3}),
    Case("E-Not", "ego = Object\nparam r = not 0\n", {"r": True}),
    Case("E-Compare", "ego = Object\nparam r = 1 < 2 <= 2\n", {"r": True}),
    Case("E-Boolean", "ego = Object\nparam r = 0 or 'x'\n", {"r": "x"}),
    Case("E-Conditional", "ego = Object\nparam r = 1 if False else 2\n", {"r": 2}),
    Case("E-Lambda", "f = lambda x, y=2: x + y\nego = Object\nparam r = f(1)\n", {"r": 3}),
    Case("E-Call", "def f(x, *a, k=1, **m): return (x, a, k, m)\nego = Object\nparam r = f(1, 2, z=3)\n", {"r": (1, (2,), 1, {"z": 3})}),
    Case("E-Return", "def f(): return 5\nego = Object\nparam r = f()\n", {"r": 5}),
    Case("E-Call-Host", "ego = Object\nparam r = sorted([2, 3, 1], key=lambda x: -x)\n", {"r": [3, 2, 1]}),
    Case("E-Comprehension", "ego = Object\nparam r = [x * y for x in range(3) if x for y in (1, 10)]\n", {"r": [1, 10, 2, 20]}),
    Case("E-Print", "ego = Object\nprint('hello')\nparam r = 1\n", {"r": 1}),
    Case("E-Raise", "ego = Object\ntry:\n    1 / 0\nexcept ZeroDivisionError as e:\n    param r = str(e)\n", {"r": "division by zero"}),
    Case("S-If", "ego = Object\nif 0:\n    x = 1\nelif 1:\n    x = 2\nparam r = x\n", {"r": 2}),
    Case("S-While", "x = 0\nwhile x < 5:\n    x += 2\nego = Object\nparam r = x\n", {"r": 6}),
    Case("S-For", "x = []\nfor i in range(5):\n    if i == 1: continue\n    x.append(i)\nego = Object\nparam r = x\n", {"r": [0, 2, 3, 4]}),
    Case("S-Break", "for i in range(5):\n    if i == 3: break\nelse:\n    i = 9\nego = Object\nparam r = i\n", {"r": 3}),
    Case("S-Def", "def f():\n    n = 0\n    def g():\n        nonlocal n\n        n += 1\n        return n\n    return g\ng = f()\ng()\nego = Object\nparam r = g()\n", {"r": 2}),
    Case("S-Return", "def f():\n    for i in range(9):\n        if i == 4:\n            return i\nego = Object\nparam r = f()\n", {"r": 4}),
    Case("S-Assert", "ego = Object\nassert 1 < 2, 'never'\nparam r = 1\n", {"r": 1}),
    Case("S-Raise", "class E(Exception): pass\nego = Object\ntry:\n    raise E('a')\nexcept E as e:\n    param r = str(e)\n", {"r": "a"}),
    Case("S-Except", "ego = Object\ntry:\n    [][0]\nexcept KeyError:\n    param r = 1\nexcept (IndexError, ValueError):\n    param r = 2\n", {"r": 2}),
    Case("S-Finally", "def f():\n    try:\n        return 1\n    finally:\n        x.append(2)\nx = []\nego = Object\nparam r = (f(), x)\n", {"r": (1, [2])}),
    Case("S-Delete", "x = [1, 2, 3]\ndel x[1]\nego = Object\nparam r = x\n", {"r": [1, 3]}),
    Case("S-Import", "import math as m\nfrom math import floor\nego = Object\nparam r = floor(m.sqrt(17))\n", {"r": 4}),
]


class Refusal(NamedTuple):
    """A program that a rule refuses: the error's class and a piece of its message."""

    rule: str
    program: str
    error: str
    message: str


REFUSALS: list[Refusal] = [
    Refusal("E-Variable", "ego = Object at (0, 0), offset by (1, 2)\n", "RunError", "ego is used before"),
    Refusal("R-SpecifiedTwice", "ego = Object at (0, 0), at (1, 2)\n", "SpecifiedTwice", "position is specified twice"),
    Refusal("R-MissingProperty", "class A:\n    p: self.nothing\nego = A\n", "MissingProperty", "needs the property nothing"),
    Refusal("R-Cyclic", "f = VectorField('f', lambda v: 1)\nego = Object left of (0, 0), facing f\n", "CyclicDependencies", "circle"),
    Refusal("E-Branch", "x = Range(0, 1)\nego = Object\nif x < 2:\n    pass\n", "RandomBranch", "Range(...) (line 1)"),
    Refusal("E-Branch", "x = Range(0, 1)\nego = Object\nfor i in range(Uniform(1, 2)):\n    pass\n", "RandomBranch", "random"),
    Refusal("O-RelativeTo-Headings", EGO + "x = ego relative to ego\n", "RunError", "oriented points"),
    Refusal("P-At", "ego = Object at 3\n", "RunError", "expects (vector)"),
    Refusal("O-CanSee-Object", "ego = Object\nx = 3 can see ego\n", "RunError", "expects (Point, Object)"),
    Refusal("E-Distributions", "ego = Object\nx = Uniform()\n", "RunError", "empty"),
    Refusal("E-Distributions", "ego = Object\nx = Range(2)\n", "RunError", "low, high"),
    Refusal("E-Resample", "x = Range(0, 1) + 1\nego = Object\ny = resample(x)\n", "RunError", "operation on one"),
    Refusal("E-ObjectDefinition", "ego = Object with width -1\n", "RunError", "at least 0"),
    Refusal("T-Mutate", "x = 1\n", "RunError", "never assigns ego"),
    Refusal("S-Mutate", "ego = Object\nx = 3\nmutate x\n", "RunError", "only Objects"),
    Refusal("S-SoftReq-Check", "x = Range(0, 1)\nrequire[x] True\nego = Object\n", "RunError", "constant"),
    Refusal("E-Variable", "ego = Objet\n", "RunError", "Objet is not defined"),
]
