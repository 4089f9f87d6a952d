"""Each ill-formed program gives the error of its one mistake, and the mistakes cover every error of programs."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from scenic_ref.api import Scenario, loads
from scenic_ref.conformance.generator import ProgramSettings, SeededChoices, generate
from scenic_ref.conformance.generator.hypothesis_strategies import ill_formed_programs
from scenic_ref.conformance.generator.mistakes import FUEL, MISPLACED, MISTAKES, UNREACHABLE, IllFormed, Mistake, plant_mistake, right
from scenic_ref.interpreter.language import checks
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import CheckError, ParseError, ProgramError, ResolutionError

from .cases import quick

ABSTRACT = {ProgramError, ResolutionError}


def assert_gives_its_error(wrong: IllFormed) -> None:
    """The error's class and rule, in its phase: parsing, checking, or a run."""
    with pytest.raises(ProgramError) as caught:
        program = parse(wrong.text)
        assert wrong.error is not ParseError
        scenario = Scenario(program, fuel=FUEL)
        assert wrong.error is not CheckError
        scenario.sample(max_attempts=1)
    assert type(caught.value) is wrong.error, wrong.mistake
    assert caught.value.rule == wrong.rule, wrong.mistake


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.name)
def test_each_mistake_gives_its_error(mistake: Mistake):
    choices = SeededChoices(2026, MISTAKES.index(mistake))
    assert_gives_its_error(plant_mistake(choices, generate(choices, right(ProgramSettings())), mistake))


@pytest.mark.slow
@quick(150)
@given(ill_formed_programs())
def test_each_ill_formed_program_gives_its_error(wrong: IllFormed):
    assert_gives_its_error(wrong)


@pytest.mark.slow
def test_without_its_mistake_the_program_has_no_error():
    for index in range(40):
        program = generate(SeededChoices(2026, index), right(ProgramSettings()))
        loads(program.text, fuel=FUEL).rehearse()


def family(error: type[ProgramError]) -> Iterator[type[ProgramError]]:
    yield error
    for below in error.__subclasses__():
        yield from family(below)


def test_mistakes_cover_every_error_of_programs():
    named = {error.__name__ for error in family(ProgramError) if error not in ABSTRACT and error.__module__.startswith("scenic_ref")}
    reached = {mistake.error.__name__ for mistake in MISTAKES}
    assert named == reached | set(UNREACHABLE)
    assert not reached & set(UNREACHABLE)


def test_names_of_mistakes_are_unique():
    assert len({mistake.name for mistake in MISTAKES}) == len(MISTAKES)


def test_mistakes_cover_every_static_check():
    """Every place of `checks.py` that makes a CheckError makes one of the messages of the table's programs."""
    messages = set()
    for mistake in MISPLACED:
        with pytest.raises(CheckError) as caught:
            loads(mistake.lines)
        messages.add(caught.value.message)
    for pieces in literal_pieces_of_messages():
        assert any(all(piece in message for piece in pieces) for message in messages), pieces


def literal_pieces_of_messages() -> Iterator[list[str]]:
    """The constant parts of the message of every `CheckError(...)` in the source of the checks."""
    tree = ast.parse(Path(checks.__file__).read_text())
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "CheckError":
            message = node.args[0]
            if isinstance(message, ast.Constant):
                yield [str(message.value)]
            elif isinstance(message, ast.JoinedStr):
                yield [str(part.value) for part in message.values if isinstance(part, ast.Constant)]


OF_OTHER_DIALECTS = {"require monitor"}


@pytest.mark.parametrize("word", [word for word, _ in checks.HOMES.values() if word not in OF_OTHER_DIALECTS])
def test_mistakes_misplace_every_statement_that_has_a_home(word: str):
    found = []
    for mistake in MISPLACED:
        with pytest.raises(CheckError) as caught:
            loads(mistake.lines)
        found.append(caught.value.message.startswith((f"`{word}` cannot stand in", f"`{word}` cannot stand at the top level")))
    assert any(found)
