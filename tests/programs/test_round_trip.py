"""parse(print(p)) = p for generated programs, and they pass the static checks."""

from __future__ import annotations

import pytest
from hypothesis import given
from scenic_ref.conformance.generator.hypothesis_strategies import finite_programs, programs
from scenic_ref.interpreter.language.checks import check_runnable
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.language.printer import to_source
from scenic_ref.semantics.syntax import Program

from .cases import quick


@pytest.mark.slow
@quick(200)
@given(programs())
def test_parsing_what_is_printed_gives_the_same_tree(program: Program):
    again = parse(to_source(program))
    assert again.statements == program.statements
    assert to_source(again) == program.text


@pytest.mark.slow
@quick(100)
@given(finite_programs())
def test_finite_programs_are_the_trees_of_their_texts(program: Program):
    assert parse(program.text).statements == program.statements


@pytest.mark.slow
@quick(100)
@given(programs())
def test_programs_pass_the_static_checks(program: Program):
    check_runnable(parse(program.text))
