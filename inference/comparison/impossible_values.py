"""Impossible values: one is enough to tell two distributions apart, however rare it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from .betting import Array
from .features import FeatureTest, assign_cells
from .known_features import Facts, Support, equal, missing_mask
from .scene_columns import A_NUMBER, ABSENT, OTHERWISE, FeatureTable, comparable_text, is_angle

MOST_LISTED = 5
Place = Callable[[int], str]
"""How a scene is named, by its number."""


def sample_number(number: int) -> str:
    """A scene by its number alone."""
    return f"sample {number}"


class Findings:
    """The impossible values in samples: one line per feature, for the first scene in which one was seen."""

    def __init__(self, facts: Facts, tolerance: float, place: Place = sample_number) -> None:
        self.facts = facts
        self.tolerance = tolerance
        self.place = place
        self.found: dict[str, str] = {}

    @property
    def lines(self) -> list[str]:
        """The first of them."""
        return list(self.found.values())[:MOST_LISTED]

    def look(self, table: FeatureTable) -> None:
        """Look at the features of further scenes that stand in them."""
        if "objects" in self.found:
            return  # the features of a missing object are wrong as well
        for name, row, text in impossible_in(table, self.facts, self.tolerance):
            self.found.setdefault(name, text + f" in {self.place(int(table.numbers[row]))}")
            if name == "objects":
                return

    def look_derived(self, table: FeatureTable) -> None:
        """Look at features that follow from others."""
        for name, support in self.facts.supports.items():
            if name not in self.found and "(" in name and name in table.arrays:
                row = first(support.outside(table.arrays[name], self.tolerance))
                if row is not None:
                    self.found[name] = f"{name} is {support}, but {value_in_scene(table, name, row)} in {self.place(int(table.numbers[row]))}"

    def look_at_law(self, table: FeatureTable, tests: Sequence[FeatureTest]) -> None:
        """Look for what has probability 0 under the laws of the tests: in one feature, or else in all together."""
        single = [test for test in tests if len(test.cuts) == 1 and test.law is not None]
        cells = assign_cells([test.cuts[0] for test in single], table)
        known = len(self.found)
        for test in single:
            assert test.law is not None
            row = first(test.law[test.cells(cells)] <= 0)
            if row is None or test.name in self.found or (test.cuts[0].whole and len(self.found) > known):
                continue
            where = self.place(int(table.numbers[row]))
            if test.cuts[0].whole:
                self.found[test.name] = f"the values in {where}, each of which is possible, have probability 0 together"
            elif test.name in table.arrays:
                self.found[test.name] = f"{test.name} is {value_in_scene(table, test.name, row)} in {where}, which has probability 0"


def impossible_in(table: FeatureTable, facts: Facts, tolerance: float) -> Iterator[tuple[str, int, str]]:
    """Each feature with a value that cannot be, the first row of it, and what is wrong there; the number of objects comes first."""
    for name in sorted(facts.constants, key=lambda name: name != "objects"):
        values = table.arrays.get(name)
        if values is not None:
            row = first(~equal(values, facts.constants[name], tolerance, angle=is_angle(name)))
            if row is not None:
                what = "the number of objects" if name == "objects" else name
                yield name, row, f"{what} is always {format_feature_value(facts.constants[name])}, but {value_in_scene(table, name, row)}"
    for name, values in table.arrays.items():
        row = first(not_finite(table, name))
        if row is not None:
            yield name, row, f"{name} is {format_feature_value(float(values[row]))}"
            continue
        support = facts.supports.get(name)
        row = first(outside(table, name, support, tolerance)) if support is not None else None
        if row is not None:
            yield name, row, f"{name} is {support}, but {value_in_scene(table, name, row)}"


def outside(table: FeatureTable, name: str, support: Support, tolerance: float) -> Array:
    """Return a mask of the scenes in which a feature is outside its support; a scene without the feature is
    not.
    """
    values = table.arrays[name]
    wrong = support.outside(values, tolerance)
    otherwise = table.arrays.get(name + OTHERWISE)
    if otherwise is not None and support.values is None:
        return wrong | (np.isnan(values) & (otherwise != ABSENT))
    if otherwise is not None and support.values is not None:
        texts = support.outside(otherwise, tolerance) & (otherwise != ABSENT)
        return np.where(np.isnan(values), texts, wrong)
    return wrong & ~missing_mask(values)


def not_finite(table: FeatureTable, name: str) -> Array:
    """Return a mask of the scenes in which a feature is an infinite number, or NaN."""
    values = table.arrays[name]
    if values.dtype != np.float64:
        return np.zeros(len(values), dtype=bool)
    otherwise = table.arrays.get(name + OTHERWISE)
    return ~np.isfinite(values) & (True if otherwise is None else otherwise == A_NUMBER)


def first(where: Array) -> int | None:
    """The first place at which something holds, None if there is none."""
    found = np.flatnonzero(where)
    return int(found[0]) if len(found) else None


def value_in_scene(table: FeatureTable, name: str, row: int) -> str:
    """The value of a feature in a scene, for people; its text where it is not a number though others are."""
    value = table.arrays[name][row]
    otherwise = table.arrays.get(name + OTHERWISE)
    return format_feature_value(otherwise[row] if otherwise is not None and isinstance(value, float) and math.isnan(value) else value)


def format_feature_value(value: object) -> str:
    """A value, for people."""
    return f"{value:.9g}" if isinstance(value, float) else comparable_text(value)


def constants_of(table: FeatureTable) -> dict[str, object]:
    """The features that have one value in all scenes."""
    columns = [c for c in table.columns.values() if not c.is_relation and c.name != "attempts" and len(set(c.values.tolist())) == 1]
    return {c.name: float(c.values[0]) if c.is_number else c.values[0] for c in columns}
