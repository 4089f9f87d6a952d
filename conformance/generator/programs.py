"""The generator: one program for one source of choices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ...interpreter.language.printer import to_source
from ...semantics.syntax import Program, Statement
from . import statements
from .choice_sources import Choices, SeededChoices
from .program_draft import Draft
from .settings import ProgramSettings

FILE = "<generated>"
DEFAULT = ProgramSettings()


def generate(choices: Choices, settings: ProgramSettings = DEFAULT) -> Program:
    """A well-formed program. Its tree is the one that the parser gives for its text; its text is the printer's."""
    features = frozenset(name for name, probability in settings.features() if choices.chance(probability))
    draft = Draft(choices, settings, features)
    body = tuple(top_level(draft))
    program = Program(statements=body, file=FILE, text="", dialect="scenic-2.1" if draft.allows("released") else "paper")
    return replace(program, text=to_source(program))


def top_level(draft: Draft) -> Iterator[Statement]:
    """The statements: some, then ego, others, and `param` with what they computed."""
    count = draft.choices.integer(1, draft.settings.max_statements)
    before = draft.choices.integer(0, min(3, count))
    if draft.allows("workspace"):
        yield from statements.workspace(draft)
    for _ in range(before):
        yield from statements.statement(draft)
    yield from statements.ego(draft)
    for _ in range(count - before):
        yield from statements.statement(draft)
    yield from statements.closing_param(draft)


def random_program(seed: int, index: int, settings: ProgramSettings = DEFAULT) -> Program:
    """Program number `index` of `seed`: a function of these and the settings only."""
    return generate(SeededChoices(seed, index), settings)


def random_programs(count: int, seed: int, settings: ProgramSettings = DEFAULT) -> Iterator[Program]:
    """Programs 0 to `count` - 1 of `seed`."""
    return (random_program(seed, index, settings) for index in range(count))
