"""Errors cross processes whole: a worker's error is the user's."""

from __future__ import annotations

import pickle
from fractions import Fraction

import pytest
from scenic_ref.semantics.store import errors
from scenic_ref.semantics.syntax import Span

HERE = Span("p.scenic", 1, 2, 3, 4)


@pytest.mark.parametrize(
    "error",
    [
        errors.RunsExhausted("too many", HERE, runs=3, covered=Fraction(1, 2), hint="fewer"),
        errors.ParseError("unexpected", HERE, expected=("a name",)),
        errors.RunError("wrong", HERE, rule="E-Call", hint="right"),
        errors.UsageError("no such file"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_an_error_is_the_same_after_pickling(error: errors.ScenicError):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error) and vars(again) == vars(error)
