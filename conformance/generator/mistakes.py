"""Ill-formed programs: one mistake planted into a program that is right, with the error that it must give."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from textwrap import indent
from typing import Literal

from ...interpreter.language.printer import to_source
from ...semantics.store.errors import (
    CheckError,
    CyclicDependencies,
    FuelExhausted,
    ImportRefused,
    MissingProperty,
    NeedsPosition,
    ParseError,
    ProgramError,
    RandomBranch,
    RunError,
    SpecifiedTwice,
    UncaughtException,
)
from ...semantics.syntax import Program, Statement
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import ObjectDefinition
from ...semantics.syntax.python_expressions import Name
from .choice_sources import Choices
from .programs import DEFAULT, generate
from .settings import ProgramSettings

Phase = Literal["parse", "check", "resolve", "run"]

FUEL = 100_000
"""Steps that every ill-formed program may take: enough for all but endless loops."""


@dataclass(frozen=True, slots=True)
class Mistake:
    """Lines with one mistake, the class of the error, and the id of the rule that cannot be applied ("" where no rule is named)."""

    name: str
    lines: str
    error: type[ProgramError]
    rule: str = ""
    before_ego: bool = False
    last: bool = False


def parse(name: str, lines: str) -> Mistake:
    """A mistake in the grammar."""
    return Mistake(name, lines, ParseError)


def check_mistake(name: str, lines: str) -> Mistake:
    """Something that stands where it can never run."""
    return Mistake(name, lines, CheckError)


def run_mistake(name: str, rule: str, lines: str) -> Mistake:
    """A premise that cannot hold, whatever is drawn."""
    return Mistake(name, lines, RunError, rule)


def branch(name: str, lines: str) -> Mistake:
    """Control flow that depends on a draw."""
    return Mistake(name, lines, RandomBranch, "E-Branch")


def uncaught(name: str, lines: str) -> Mistake:
    """A Python exception that nothing catches."""
    return Mistake(name, lines, UncaughtException)


GRAMMAR = (
    parse("unclosed bracket", "wrong = (1, 2"),
    parse("bracket that closes nothing", "wrong = 1, 2)"),
    parse("missing colon", "if True\n    pass"),
    parse("assignment as a condition", "require wrong = 3"),
    parse("misspelt specifier", "Object wiht width 3"),
    parse("missing comma", "Object at (1, 2) facing 3"),
    parse("comma after the class", "Object, with width 3"),
    parse("vector without brackets", "Object at 1, 2"),
    parse("missing by", "Object left of (1, 2) 0.5"),
    parse("unexpected indentation", "wrong = 1\n    wrong = 2"),
    parse("missing block", "if True:\nwrong = 1"),
    parse("unterminated string", "wrong = 'abc"),
    parse("target that cannot be assigned to", "abs(3) = 3"),
    parse("parameter without default after one with", "def wrong(a=1, b): pass"),
    parse("annotation without a value", "wrong: int"),
    parse("generator function", "yield 3"),
    parse("new of another dialect", "wrong = new Object"),
    parse("no character of the language", "wrong = 1 ? 2"),
    parse("soft requirement without brackets", "require 0.5 True"),
    parse("statement nested too deeply", "wrong = " + "(1, " * 500 + "1" + ")" * 500),
    parse("NUL character", "wrong = '\0'"),
)

MISPLACED = (
    check_mistake("take at the top level", "take 3"),
    check_mistake("wait at the top level", "wait"),
    check_mistake("terminate at the top level", "terminate"),
    check_mistake("do in a function", "def wrong():\n    do 3"),
    check_mistake("do choose in a setup block", "scenario Wrong():\n    setup:\n        do choose 3"),
    check_mistake("do shuffle in a function", "def wrong():\n    do shuffle 3"),
    check_mistake("abort in a function", "def wrong():\n    abort"),
    check_mistake("abort outside of an interrupt", "behavior Wrong():\n    abort"),
    check_mistake("override in a behavior", "behavior Wrong():\n    override self with speed 3"),
    check_mistake("interrupt at the top level", "try:\n    pass\ninterrupt when True:\n    pass"),
    check_mistake("require always in a function", "def wrong():\n    require always True"),
    check_mistake("require eventually in a behavior", "behavior Wrong():\n    require eventually True"),
    check_mistake("terminate when in a behavior", "behavior Wrong():\n    terminate when True"),
    check_mistake("monitor in a function", "def wrong():\n    monitor Wrong():\n        wait"),
    check_mistake("scenario in a function", "def wrong():\n    scenario Wrong():\n        setup:\n            pass"),
    check_mistake("model in a function", "def wrong():\n    model mars"),
    check_mistake("return at the top level", "return 3"),
    check_mistake("break outside of a loop", "break"),
    check_mistake("continue outside of a loop", "continue"),
    check_mistake("nonlocal at the top level", "nonlocal wrong"),
    check_mistake("import of everything in a function", "def wrong():\n    from math import *"),
    check_mistake("in initial scenario in a behavior", "behavior Wrong():\n    wrong = in initial scenario"),
    check_mistake("parameter given twice", "def wrong(a, a):\n    pass"),
    check_mistake("lambda parameter given twice", "wrong = lambda a, a: 3"),
    check_mistake("keyword argument given twice", "wrong = dict(a=1, a=2)"),
    check_mistake("global parameter given twice", "param wrong = 1, wrong = 2"),
    check_mistake("property given twice", "class Wrong:\n    a: 1\n    a: 2"),
    check_mistake("probability above 1", "require[1.5] True"),
    check_mistake("negative probability", "require[-0.5] True"),
    check_mistake("probability that is no number", "require['a'] True"),
    check_mistake("star outside of a list", "wrong = *ego"),
    check_mistake("handler after one that catches everything", "try:\n    pass\nexcept:\n    pass\nexcept KeyError:\n    pass"),
)

RESOLUTION = (
    Mistake("position specified twice", "Object at (1, 2), offset by (3, 4)", SpecifiedTwice, "R-SpecifiedTwice"),
    Mistake("heading specified twice", "Object at (1, 2), facing 3, with heading 2", SpecifiedTwice, "R-SpecifiedTwice"),
    Mistake("property specified twice", "Object at (1, 2), with width 3, with width 2", SpecifiedTwice, "R-SpecifiedTwice"),
    Mistake("property specified twice under two names", "Object at (1, 2), with length 3, with height 2", SpecifiedTwice, "R-SpecifiedTwice"),
    Mistake("default that needs an unknown property", "class Wrong:\n    a: self.nothing\nWrong at (1, 2)", MissingProperty, "R-MissingProperty"),
    Mistake("Point without heading", "Point left of (1, 2)", MissingProperty, "R-MissingProperty"),
    Mistake("defaults in a circle", "class Wrong:\n    a: self.b\n    b: self.a\nWrong at (1, 2)", CyclicDependencies, "R-Cyclic"),
    Mistake("default that needs itself", "class Wrong:\n    a: self.a + 1\nWrong at (1, 2)", CyclicDependencies, "R-Cyclic"),
    Mistake("position and heading in a circle", "Object left of (1, 2), facing toward (3, 4)", CyclicDependencies, "R-Cyclic"),
    Mistake("width in a circle", "class Wrong:\n    width: self.position.x\nWrong left of (1, 2), facing 3", CyclicDependencies, "R-Cyclic"),
)

NAMES = (
    run_mistake("unknown name", "E-Variable", "wrong = nothing"),
    run_mistake("unknown class", "E-Variable", "Objet at (1, 2), facing 3"),
    run_mistake("local variable before its assignment", "E-Variable", "def wrong():\n    return a\n    a = 1\nwrong()"),
    Mistake("ego before its assignment", "wrong = ego.width", RunError, "E-Variable", before_ego=True),
    run_mistake("private name", "E-Attribute", "wrong = (1).__class__"),
    run_mistake("assignment in the body of a Scenic class", "S-Class", "class Wrong:\n    width = 7\nWrong at (1, 2)"),
    run_mistake("super", "E-Call-Host", "wrong = super()"),
)

OPERATORS = (
    run_mistake("deg of a string", "O-Deg", "wrong = 'a' deg"),
    run_mistake("vector of strings", "O-VectorOf", "wrong = 'a' @ 2"),
    run_mistake("relative heading of a string", "O-RelativeHeading", "wrong = relative heading of 'a'"),
    run_mistake("apparent heading of a vector", "O-ApparentHeading", "wrong = apparent heading of (1, 2)"),
    run_mistake("distance from a scalar", "O-Distance", "wrong = distance from 3 to ego"),
    run_mistake("distance past a scalar", "O-DistancePast", "wrong = distance past 3"),
    run_mistake("angle to a string", "O-Angle", "wrong = angle to 'a'"),
    run_mistake("scalar that sees", "O-CanSee-Object", "wrong = 3 can see ego"),
    run_mistake("scalar as a field", "O-At", "wrong = 3 at (1, 2)"),
    run_mistake("vector relative to a scalar", "O-RelativeTo-Fields", "wrong = (1, 2) relative to 3"),
    run_mistake("oriented points relative to each other", "O-RelativeTo-Headings", "wrong = ego relative to ego"),
    Mistake(
        "field relative to a heading for no object", "param wrong = VectorField('wrong', lambda v: 1) relative to 3", NeedsPosition,
        "O-RelativeTo-HeadingField",
    ),
    run_mistake("scalar offset by a vector", "O-OffsetBy-OrientedPoint", "wrong = 3 offset by (1, 2)"),
    run_mistake("offset along a string", "O-OffsetAlong-Heading", "wrong = (1, 2) offset along 'a' by (3, 4)"),
    run_mistake("visible scalar", "O-VisibleFrom", "wrong = visible (3)"),
    run_mistake("follow a scalar", "O-Follow", "wrong = follow (3) from (1, 2) for 4"),
    run_mistake("front of a point", "O-FrontOf", "wrong = front of (OrientedPoint at (1, 2))"),
)

SPECIFIERS = (
    run_mistake("at a scalar", "P-At", "Object at (3), facing 1"),
    run_mistake("offset by a scalar", "P-OffsetBy-Local", "Object offset by (3), facing 1"),
    run_mistake("specifier offset along a string", "P-OffsetAlong-Heading", "Object offset along 'a' by (1, 2), facing 1"),
    run_mistake("left of a string", "P-LeftOf-Object", "Object left of ('a')"),
    run_mistake("ahead of a vector by a vector", "P-AheadOf-Object", "Object ahead of ego by (1, 2)"),
    run_mistake("beyond a scalar", "P-Beyond", "Object beyond (3) by (1, 2)"),
    run_mistake("visible from a scalar", "P-Visible", "Object visible from 3, facing 1"),
    run_mistake("in a vector", "P-In", "Object in ((1, 2)), facing 1"),
    run_mistake("following a scalar", "P-Following", "Object following (3) for 2"),
    run_mistake("facing a string", "P-Facing-Heading", "Object facing ('north')"),
    run_mistake("facing toward a scalar", "P-FacingToward", "Object facing toward 3"),
    run_mistake("facing away from a scalar", "P-FacingAwayFrom", "Object facing away from 3"),
    run_mistake("apparently facing a string", "P-ApparentlyFacing", "Object apparently facing ('north')"),
    run_mistake("specifiers behind no class", "E-ObjectDefinition", "wrong = 3\nwrong at (1, 2), facing 3"),
    run_mistake("class with brackets", "E-ObjectDefinition", "wrong = Object(1, 2)"),
    run_mistake("negative width", "E-ObjectDefinition", "Object with width (-1)"),
    run_mistake("width that is no number", "E-ObjectDefinition", "Object with width ('a')"),
    run_mistake("infinite position", "E-ObjectDefinition", "Object at (1e999, 0), facing 1"),
    run_mistake("flag that is no boolean", "E-ObjectDefinition", "Object with allowCollisions (3)"),
    run_mistake("class that contains itself", "E-ObjectDefinition", "class Wrong:\n    a: Wrong at (1, 2)\nWrong at (1, 2)"),
    run_mistake("random point of the whole plane", "P-In", "Object in everywhere, facing 1"),
)

DISTRIBUTIONS = (
    run_mistake("no value to choose", "E-Distributions", "wrong = Uniform()"),
    run_mistake("missing parameter", "E-Distributions", "wrong = Range(2)"),
    run_mistake("interval that is upside down", "E-Distributions", "wrong = Range(2, 1)"),
    run_mistake("parameter that is no number", "E-Distributions", "wrong = Normal('a', 1)"),
    run_mistake("negative standard deviation", "E-Distributions", "wrong = Normal(0, -1)"),
    run_mistake("empty window", "E-Distributions", "wrong = TruncatedNormal(0, 1, 2, 1)"),
    run_mistake("weights that are no dictionary", "E-Distributions", "wrong = Discrete(3)"),
    run_mistake("no weights", "E-Distributions", "wrong = Discrete({})"),
    run_mistake("weights of 0", "E-Distributions", "wrong = Discrete({1: 0})"),
    run_mistake("negative weight", "E-Distributions", "wrong = Discrete({1: 1, 2: -1})"),
    run_mistake("resampled operation", "E-Resample", "wrong = resample(Range(0, 1) + 1)"),
    run_mistake("draw inside of a library call", "E-Call-Host", "wrong = sorted([2, 1], key=lambda a: Range(0, 1))"),
)

STATEMENTS = (
    run_mistake("requirement that is no boolean", "S-Require", "require 3"),
    run_mistake("behavior as a statement", "D-Do", "behavior Wrong():\n    wait\nWrong()"),
    run_mistake("scenario's name as a statement", "D-Do", "scenario Wrong():\n    setup: pass\nWrong"),
    run_mistake("random probability", "S-SoftReq-Check", "wrong = Uniform(0.25, 0.5)\nrequire[wrong] True"),
    run_mistake("computed probability above 1", "S-SoftReq-Check", "wrong = 2\nrequire[wrong] True"),
    run_mistake("mutated scalar", "S-Mutate", "wrong = 3\nmutate wrong"),
    run_mistake("negative scale of a mutation", "S-Mutate", "mutate ego by (-1)"),
    run_mistake("endless recursion", "E-Call", "def wrong(a): return wrong(a + 1)\nwrong(0)"),
    run_mistake("negative radius", "E-Call-Host", "wrong = CircularRegion((1, 2), -1)"),
    run_mistake("polygon with two corners", "E-Call-Host", "wrong = PolygonalRegion([(1, 2), (3, 4)])"),
    run_mistake("sequence that is too long", "E-Call-Host", "wrong = list(range(10 ** 12))"),
    Mistake("workspace that is no region", "workspace = 3", RunError, "T-Check", last=True),
)

BRANCHES = (
    branch("if on a draw", "if Range(0, 1) < 2:\n    pass"),
    branch("if on a random position", "wrong = Object at (Range(1, 2), 3), with allowCollisions True\nif wrong.position.x < 5:\n    pass"),
    branch("while on a draw", "while Uniform(1, 2) > 3:\n    pass"),
    branch("random number of turns", "for wrong in range(Uniform(1, 2)):\n    pass"),
    branch("random condition of an expression", "wrong = 1 if Uniform(1, 2) < 3 else 2"),
    branch("random filter", "wrong = [a for a in range(3) if Uniform(1, 2) < 3]"),
    branch("random assertion", "assert Uniform(1, 2) < 3"),
    branch("random function", "wrong = Uniform(lambda a: a, lambda a: 2 * a)(3)"),
    branch("random number of arguments", "wrong = (lambda *a: a)(*range(Uniform(2, 3)))"),
)

EXCEPTIONS = (
    uncaught("division by zero", "wrong = 1 / 0"),
    uncaught("place outside of a list", "wrong = [][3]"),
    uncaught("unknown key", "wrong = {}['a']"),
    uncaught("unknown property", "wrong = ego.nothing"),
    uncaught("raised exception", "raise ValueError('wrong')"),
    uncaught("membership in a scalar", "wrong = ego is in 3"),
    uncaught("failed assertion", "assert False, 'wrong'"),
    uncaught("wrong number of arguments", "def wrong(a): pass\nwrong()"),
    uncaught("unhashable key", "wrong = {[]: 1}"),
    uncaught("sum of a string and a number", "wrong = 'a' + 1"),
    uncaught("exception out of a handler", "try:\n    raise KeyError('a')\nexcept KeyError:\n    raise ValueError('b')"),
    Mistake("import of a Python module", "import os", ImportRefused, "S-Import"),
    Mistake("import from a Python module", "from subprocess import run", ImportRefused, "S-Import"),
    uncaught("import of no module", "import nothing_of_that_name"),
    uncaught("import of no name", "from math import nothing_of_that_name"),
    uncaught("relative import of no module", "from .math import sqrt"),
    Mistake("endless loop", "while True:\n    pass", FuelExhausted),
)

MISTAKES: tuple[Mistake, ...] = (
    *GRAMMAR, *MISPLACED, *RESOLUTION, *NAMES, *OPERATORS, *SPECIFIERS, *DISTRIBUTIONS, *STATEMENTS, *BRANCHES, *EXCEPTIONS,
)  # fmt: skip

UNREACHABLE: dict[str, str] = {
    "NoEgo": "it is raised where a scene is asked for of a program whose ego a compose block makes, not by a run",
    "NeedsElements": "the machine computes the elements, and makes the call again",
    "OutOfTime": "whether it is raised depends on the machine and on the limit that whoever runs the program sets",
    "SimulatorError": "it is the fault of a simulator, not of the program",
    "SpecifiedTwiceOptionally": "only position specifiers specify another property optionally, and two of them specify the position twice",
}
"""Errors of programs that no program gives, and why."""


Form = Callable[[Choices, Program], "IllFormed | None"]


@dataclass(frozen=True, slots=True)
class IllFormed:
    """A program text with one mistake: its name, the error that it must give, and the rule that cannot be applied ("" if none is named)."""

    mistake: str
    text: str
    error: type[ProgramError]
    rule: str


def right(settings: ProgramSettings) -> ProgramSettings:
    """The settings without whatever could end a run before it comes to the mistake."""
    return replace(settings, requirements=0.0, soft=0.0, regions=0.0, visibility=0.0, random_length=0.0, released=0.0)


def ill_formed(choices: Choices, settings: ProgramSettings = DEFAULT) -> IllFormed:
    """A program with one mistake, out of the table or by a change to one of its statements."""
    program = generate(choices, right(settings))
    options: list[tuple[int, Form]] = [(8, planted_somewhere), (1, omit_closing_bracket), (1, repeat_specifier), (1, without_ego)]
    return choices.weighted(options)(choices, program) or planted_somewhere(choices, program)


def planted_somewhere(choices: Choices, program: Program) -> IllFormed:
    """One of the mistakes of the table."""
    return plant_mistake(choices, program, choices.pick(MISTAKES))


def plant_mistake(choices: Choices, program: Program, mistake: Mistake) -> IllFormed:
    """The mistake at some place of the top level, perhaps in a block or function that is run there."""
    texts = [to_source((statement,)) for statement in program.statements]
    ego = place_of_ego(program)
    if mistake.last:
        place = len(texts)
    elif mistake.before_ego:
        place = choices.integer(0, ego)
    else:
        place = choices.integer(ego + 1, len(texts))
    texts.insert(place, mistake_lines(choices, mistake))
    return IllFormed(mistake.name, "".join(texts), mistake.error, mistake.rule)


def mistake_lines(choices: Choices, mistake: Mistake) -> str:
    """The lines of the mistake; those that fail at run time may also stand in a block or in a function."""
    lines = mistake.lines + "\n"
    if not issubclass(mistake.error, RunError) or mistake.last or "class " in lines or "scenario " in lines:
        return lines
    match choices.integer(0, 3):
        case 0:
            return f"if True:\n{indent(lines, '    ')}"
        case 1 if not mistake.lines.startswith("import"):
            return f"def wrongly():\n{indent(lines, '    ')}wrongly()\n"
        case _:
            return lines


def place_of_ego(program: Program) -> int:
    """The place of the statement that assigns ego."""
    return next(i for i, statement in enumerate(program.statements) if assigns_ego(statement))


def assigns_ego(statement: Statement) -> bool:
    """Whether this is `ego = ...`."""
    return isinstance(statement, s.Assignment) and any(isinstance(target, Name) and target.name == "ego" for target in statement.targets)


def omit_closing_bracket(choices: Choices, program: Program) -> IllFormed | None:
    """The program without one of its closing brackets."""
    text = program.text
    places = [i for i, character in enumerate(text) if character in ")]"]
    if not places:
        return None
    place = choices.pick(places)
    return IllFormed("bracket left out", text[:place] + text[place + 1 :], ParseError, "")


def repeat_specifier(choices: Choices, program: Program) -> IllFormed | None:
    """The program with a specifier of one of its objects given twice."""
    found = [i for i, x in enumerate(program.statements) if isinstance(x, s.Assignment) and isinstance(x.value, ObjectDefinition)]
    if not found:
        return None
    place = choices.pick(found)
    statement = program.statements[place]
    assert isinstance(statement, s.Assignment)
    definition = statement.value
    assert isinstance(definition, ObjectDefinition)
    repeated = replace(definition, specifiers=(*definition.specifiers, choices.pick(definition.specifiers)))
    statements = (*program.statements[:place], replace(statement, value=repeated), *program.statements[place + 1 :])
    return IllFormed("specifier given twice", to_source(statements), SpecifiedTwice, "R-SpecifiedTwice")


def without_ego(choices: Choices, program: Program) -> IllFormed | None:
    """The statements before ego alone."""
    return IllFormed("no ego", to_source(program.statements[: place_of_ego(program)]), RunError, "T-Mutate")

