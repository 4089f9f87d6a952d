"""Ill-formed programs: one mistake planted into a program that is right, so that the mistake's error is the one it gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from textwrap import indent

from ...interpreter.language.printer import to_source
from ...semantics.kernel.errors import ParseError, ProgramError, RunError, SpecifiedTwice
from ...semantics.syntax import Program, Statement
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import ObjectDefinition
from ...semantics.syntax.python_expressions import Name
from .choices import Choices
from .generate import DEFAULT, generate
from .mistakes import MISTAKES, Mistake
from .settings import ProgramSettings

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
    options: list[tuple[int, Form]] = [(8, planted_somewhere), (1, unclosed), (1, doubled), (1, without_ego)]
    return choices.weighted(options)(choices, program) or planted_somewhere(choices, program)


def planted_somewhere(choices: Choices, program: Program) -> IllFormed:
    """One of the mistakes of the table."""
    return planted(choices, program, choices.pick(MISTAKES))


def planted(choices: Choices, program: Program, mistake: Mistake) -> IllFormed:
    """The mistake at some place of the top level, perhaps in a block or function that is run there."""
    texts = [to_source((statement,)) for statement in program.statements]
    ego = place_of_ego(program)
    if mistake.last:
        place = len(texts)
    elif mistake.before_ego:
        place = choices.integer(0, ego)
    else:
        place = choices.integer(ego + 1, len(texts))
    texts.insert(place, housed(choices, mistake))
    return IllFormed(mistake.name, "".join(texts), mistake.error, mistake.rule)


def housed(choices: Choices, mistake: Mistake) -> str:
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


def unclosed(choices: Choices, program: Program) -> IllFormed | None:
    """The program without one of its closing brackets."""
    text = program.text
    places = [i for i, character in enumerate(text) if character in ")]"]
    if not places:
        return None
    place = choices.pick(places)
    return IllFormed("bracket left out", text[:place] + text[place + 1 :], ParseError, "")


def doubled(choices: Choices, program: Program) -> IllFormed | None:
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
