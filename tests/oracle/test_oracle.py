"""The machine gives random dynamic programs the histories, with the probabilities, that the oracle gives them; wrong oracles are found out."""

from __future__ import annotations

import ast
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

from .by_hand import BY_HAND
from .faults import FAULTS
from .invention import STEPS, invented
from .judging import differences, is_accepted
from .policy import Law, Policy, TooManyRuns, law_of
from .programs import DynamicProgram, text_of

SEED = 1
PROGRAMS, PORTION = 200, 20
MANY, LARGE_PORTION = 800, 50
OWN = ("by_hand", "coroutines", "faults", "invention", "oracle", "policy", "programs", "running")


@cache
def program_of(number: int) -> DynamicProgram:
    """One of the programs."""
    return invented(SEED, number)


@cache
def law_by_oracle(program: DynamicProgram) -> Law:
    """What the oracle says of it."""
    return law_of(program, STEPS)


def programs() -> list[DynamicProgram]:
    """Those by hand, and the first of the invented ones."""
    return [*BY_HAND.values(), *map(program_of, range(PROGRAMS))]


def check_portion(first: int, count: int) -> None:
    """The oracle and the machine agree on these programs."""
    for number in range(first, first + count):
        program = program_of(number)
        told = differences(program)
        assert not told, f"program {number}{told}\n{text_of(program)}"


@pytest.mark.parametrize("name", BY_HAND)
def test_programs_by_hand_have_the_histories_of_the_oracle(name: str) -> None:
    told = differences(BY_HAND[name])
    assert not told, f"{told}\n{text_of(BY_HAND[name])}"


@pytest.mark.sampled(8)
@pytest.mark.parametrize("first", range(0, PROGRAMS, PORTION))
def test_random_programs_have_the_histories_of_the_oracle(first: int) -> None:
    check_portion(first, PORTION)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(PROGRAMS, PROGRAMS + MANY, LARGE_PORTION))
def test_many_random_programs_have_the_histories_of_the_oracle(first: int) -> None:
    check_portion(first, LARGE_PORTION)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_a_wrong_oracle_is_found_out(fault: type[Policy]) -> None:
    """By one of the programs of the tests above: there the machine says something else than the wrong oracle."""
    assert any(differences(program, fault) for program in programs() if says_otherwise(program, fault))


def says_otherwise(program: DynamicProgram, fault: type[Policy]) -> bool:
    """Whether a wrong oracle gives the program another law; one that never comes to an end is none."""
    try:
        return law_of(program, STEPS, fault, most=1000).histories != law_by_oracle(program).histories
    except TooManyRuns:
        return False


def test_the_probabilities_of_a_program_are_one_together() -> None:
    assert all(sum(law_by_oracle(program).histories.values()) == 1 for program in programs())


def test_most_programs_have_histories_and_many_have_several() -> None:
    accepted = [sum(is_accepted(h) for h in law_by_oracle(program).histories) for program in programs()]
    assert sum(count > 0 for count in accepted) > PROGRAMS // 2
    assert sum(count > 1 for count in accepted) > PROGRAMS // 4


LEAST = {
    "Assign in behavior": 88, "Assign in compose": 12, "Assign in monitor": 80, "Assign in setup": 133, "Attempt in behavior": 44,
    "Attempt in compose": 25, "Attempt in monitor": 28, "Branch in behavior": 8, "Branch in compose": 8, "Branch in monitor": 9,
    "Carry in behavior": 46, "Carry in compose": 65, "Creation in setup": 136, "Declaration in compose": 11, "Declaration in setup": 76,
    "Demand in behavior": 6, "Demand in compose": 2, "Demand in monitor": 15, "Demand in setup": 10, "InvariantViolation": 30,
    "Leave in behavior": 28, "Leave in compose": 27, "Leave in monitor": 41, "LetStepPass in behavior": 31, "LetStepPass in compose": 47,
    "LetStepPass in monitor": 56, "Overriding in compose": 15, "Overriding in setup": 31, "PreconditionViolation": 11, "Repeat in behavior": 33,
    "Repeat in compose": 8, "Repeat in monitor": 30, "TakeActions in behavior": 75, "TakeActions in monitor": 47, "Watchman in setup": 86,
    "behavior reverted": 14, "cannot begin": 2, "caught": 6, "disabled": 6, "do choose in behavior": 14, "do choose in compose": 16,
    "do shuffle in behavior": 11, "do shuffle in compose": 17, "draw": 105, "interrupt": 74, "interrupt of a handler": 10, "limit": 28,
    "monitor terminates": 28, "new object": 25, "rejected: always": 4, "rejected: collision": 9, "rejected: eventually": 13,
    "rejected: guard": 34, "rejected: precondition": 4, "rejected: require": 3, "terminated": 50, "time limit": 38, "time step": 136,
    "x reverted": 12,
}  # fmt: skip
"""In how many programs a thing happens, at least: a statement is executed, or what is said comes about in some run."""


def test_what_the_programs_are_for_happens_in_them() -> None:
    found = Counter(what for program in programs() for what, times in law_by_oracle(program).happened.items() if times)
    assert not {what: found[what] for what, least in LEAST.items() if found[what] < least}
    assert not set(found) - set(LEAST), "what happens is counted"


def test_the_oracle_shares_no_code_with_the_machine() -> None:
    here = Path(__file__).parent
    assert set(OWN) == {path.stem for path in here.glob("*.py")} - {"judging", "test_oracle"}
    library = {"__future__", "collections", "collections.abc", "contextlib", "dataclasses", "fractions", "functools", "random", "types", "typing"}
    for name in OWN:
        for node in ast.walk(ast.parse((here / f"{name}.py").read_text())):
            if isinstance(node, ast.ImportFrom):
                assert node.module in (OWN if node.level == 1 else library), (name, node.module)
            assert not isinstance(node, ast.Import), name
