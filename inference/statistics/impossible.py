"""Values that cannot be: one is enough to tell two distributions apart, however rare it is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..enumeration import Enumeration
from .columns import OTHERWISE, Column, Table, is_angle, table_of, text_of
from .features import FeatureTest, assigned
from .laws import SAME

MOST_LISTED = 5


def wrong_constants(table: Table, constants: Mapping[str, object], start: int = 0) -> list[str]:
    """What a table holds that a constant of the program cannot be, one line per feature; scenes are counted from `start` + 1."""
    found: list[str] = []
    for name in sorted(constants, key=lambda name: name != "objects"):
        wrong = first_other(table, name, constants[name]) if name in table.columns else None
        if wrong is not None:
            always, seen = shown(constants[name]), shown(value_in(table, name, wrong))
            what = "the number of objects" if name == "objects" else name
            found.append(f"{what} is always {always}, but {seen} in sample {start + wrong + 1}")
            if name == "objects":
                break  # the features of a missing object are wrong as well
    return found[:MOST_LISTED]


def value_in(table: Table, name: str, row: int) -> object:
    """The value of a feature in a scene; its text where it is no number though others are."""
    value = table.columns[name].values[row]
    otherwise = table.columns.get(name + OTHERWISE)
    return otherwise.values[row] if otherwise is not None and isinstance(value, float) and math.isnan(value) else value


def shown(value: object) -> str:
    """A value, for people."""
    return f"{value:.9g}" if isinstance(value, float) else text_of(value)


def first_other(table: Table, name: str, value: object) -> int | None:
    """The first scene in which a feature has not its constant value (to 1e-9), None if there is none."""
    column = table.columns[name]
    if column.is_number and isinstance(value, (int, float)) and not isinstance(value, bool):
        off = np.abs(column.values - value)
        if is_angle(name):
            off = np.minimum(off % math.tau, math.tau - off % math.tau)
        wrong = np.flatnonzero(~(off <= SAME * max(1.0, abs(value))))
    else:
        wrong = np.flatnonzero(np.array([str(v) for v in column.values]) != text_of(value))
    return int(wrong[0]) if len(wrong) else None


def constants_of_law(law: Enumeration) -> dict[str, object]:
    """The features that have one value in all outcomes."""
    columns = table_of(law.scenes).columns.values()
    return {c.name: value_of(c) for c in columns if not c.is_relation and c.name != "attempts" and len(set(c.values.tolist())) == 1}


def value_of(column: Column) -> object:
    """The one value of a column."""
    return float(column.values[0]) if column.is_number else column.values[0]


def off_the_law(table: Table, tests: Sequence[FeatureTest], start: int = 0) -> list[str]:
    """What a table holds that has probability 0 under the laws of the tests, one line per feature."""
    single = [test for test in tests if len(test.cuts) == 1 and test.law is not None]
    cells = assigned([test.cuts[0] for test in single], table)
    found: list[str] = []
    for test in single:
        assert test.law is not None
        wrong = np.flatnonzero(test.law[test.cells(cells)] <= 0)
        if len(wrong) and test.name in table.columns:
            seen = shown(value_in(table, test.name, int(wrong[0])))
            found.append(f"{test.name} is {seen} in sample {start + int(wrong[0]) + 1}, which has probability 0")
    return found[:MOST_LISTED]
