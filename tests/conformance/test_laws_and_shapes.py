"""Distribution functions and shapes that vectors may name, against values worked out by hand."""

from __future__ import annotations

import math
import tomllib

import pytest
from scenic_ref.conformance.matchers.common import close, read_path
from scenic_ref.conformance.matchers.distributions import (
    FAMILIES,
    SHAPES,
    THRESHOLD,
    Moments,
    contradiction,
    read_cdf,
    read_shape,
)
from scenic_ref.conformance.strict_tables import VectorFields

CDFS = [
    ('name = "uniform"\nlow = -2\nhigh = 2', {-3: 0, -2: 0, -1: 0.25, 0: 0.5, 2: 1, 9: 1}),
    ('name = "normal"\nmean = 1\ndeviation = 2', {1: 0.5, 3: 0.8413447460685429, -1: 0.15865525393145707, -99: 0}),
    ('name = "truncated-normal"\nmean = 0\ndeviation = 1\nlow = -1\nhigh = 1', {-1: 0, 0: 0.5, 1: 1, 5: 1, -5: 0}),
    ('name = "triangular"\nlow = 0\nmode = 1\nhigh = 2', {0: 0, 0.5: 0.125, 1: 0.5, 1.5: 0.875, 2: 1}),
    ('name = "triangular"\nlow = 0\nmode = 0\nhigh = 1', {-1: 0, 0.5: 0.75, 1: 1}),
    ('name = "triangular"\nlow = 0\nmode = 1\nhigh = 1', {0.5: 0.25, 1: 1}),
    ('name = "power"\nlow = 1\nhigh = 3\nexponent = 2', {1: 0, 2: 0.25, 3: 1, 4: 1}),
    ('name = "piecewise-linear"\nknots = [[0, 0], [1, 0.5], [3, 1]]', {-1: 0, 0.5: 0.25, 1: 0.5, 2: 0.75, 3: 1, 4: 1}),
]


@pytest.mark.parametrize(("text", "values"), CDFS)
def test_distribution_functions_have_the_values_of_their_closed_form(text: str, values: dict[float, float]) -> None:
    law = read_cdf(VectorFields("f", tomllib.loads(text)))
    assert {x: law.cdf(x) for x in values} == pytest.approx(values, abs=1e-12)


@pytest.mark.parametrize(("text", "values"), CDFS)
def test_values_outside_of_the_support_contradict_a_law_at_once(text: str, values: dict[float, float]) -> None:
    law = read_cdf(VectorFields("f", tomllib.loads(text)))
    bounded = 'name = "normal"' not in text
    assert (math.isfinite(law.low), math.isfinite(law.high)) == (bounded, bounded)
    median = min(values, key=lambda x: abs(values[x] - 0.5))
    assert contradiction([median], law) < THRESHOLD
    if bounded:
        assert (law.cdf(law.low), law.cdf(law.high)) == (0, 1)
        assert contradiction([median, law.low - 1e-6], law) == contradiction([law.high + 1e-6], law) == math.inf
        assert contradiction([law.low - 1e-12, law.high + 1e-12], law) < THRESHOLD


def test_every_family_has_a_case() -> None:
    assert {tomllib.loads(text)["name"] for text, _ in CDFS} == set(FAMILIES)


SHAPE_CASES = [
    ("interval = { low = 1, high = 2 }", [1, 1.5, 2], [0.9, 2.1, math.nan, "x", [1, 2], True]),
    ("disc = { center = [1, 1], radius = 2 }", [[1, 1], [3, 1], [1, -1]], [[3.1, 1], [1], 1, [math.nan, 1]]),
    ("disc = { center = [0, 0], radius = 2, inner = 1 }", [[1, 0], [0, 2]], [[0, 0], [0.5, 0.5]]),
    ("sector = { center = [0, 0], radius = 2, heading = 0, angle = 1.5708 }", [[0, 0], [0, 2], [1, 1.001]], [[1, 0.9], [0, -1], [0, 2.1]]),
    ("sector = { center = [0, 0], radius = 2, heading = 3.0, angle = 1.0 }", [[0.1, -1], [-0.1, -1], [0.3, -1]], [[0.5, -1], [0, 1]]),
    ("rectangle = { center = [1, 0], width = 4, length = 2 }", [[3, 1], [-1, -1], [1, 0]], [[3.1, 0], [1, 1.1]]),
    ("rectangle = { center = [0, 0], heading = 1.5707963267948966, width = 4, length = 2 }", [[0.9, 1.9], [-0.9, -1.9]], [[1.9, 0], [0, 2.1]]),
    ("polygon = { points = [[0, 0], [4, 0], [4, 2]] }", [[3, 1], [4, 2], [2, 1], [3.9, 0.1]], [[1, 1], [5, 1], [-1, 0]]),
    ("polygon = { points = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]] }", [[2, 0.5], [0.5, 2]], [[2, 2], [1.5, 1.5]]),
    ("polyline = { points = [[0, 0], [1, 0], [1, 3]] }", [[0.5, 0], [1, 2], [1, 3]], [[0.5, 0.1], [1, 3.1], [0, 1]]),
    ("points = { points = [[0, 0], [1, 2]] }", [[0, 0], [1, 2]], [[0, 1]]),
    ("any = [{ interval = { low = 0, high = 1 } }, { interval = { low = 2, high = 3 } }]", [0.5, 2.5], [1.5, 4]),
]


@pytest.mark.parametrize(("text", "inside", "outside"), SHAPE_CASES)
def test_shapes_hold_what_they_should(text: str, inside: list, outside: list) -> None:
    shape = read_shape(VectorFields("f", tomllib.loads(text)))
    assert all(shape(value, 1e-9) for value in inside)
    assert not any(shape(value, 1e-9) for value in outside)


def test_every_shape_has_a_case() -> None:
    assert {next(iter(tomllib.loads(text))) for text, _, _ in SHAPE_CASES} == {*SHAPES, "any"}


def test_moments_are_contradicted_by_the_mean_the_square_and_the_range() -> None:
    level = [0.5] * 500
    assert contradiction(level, Moments(0.5, 0.0, 1.0)) < THRESHOLD
    assert contradiction(level, Moments(0.7, 0.0, 1.0)) > THRESHOLD
    assert contradiction(level, Moments(0.5, 0.0, 1.0, 1 / 3)) > THRESHOLD
    assert contradiction([*level, 1.5], Moments(0.5, 0.0, 1.0)) == math.inf


def test_two_moments_are_two_bets_with_half_of_the_stake_each() -> None:
    values = [0.5] * 40
    one, both = contradiction(values, Moments(0.6, 0.0, 1.0)), contradiction(values, Moments(0.6, 0.0, 1.0, 0.25))
    assert both == pytest.approx(one - math.log10(2), abs=1e-12)


SCENE = {"params": {"r": 1}, "ego": 1, "objects": [{"heading": 0.5, "properties": {"v": 7, "heading": 9}}, {"heading": 1.5}]}


@pytest.mark.parametrize(
    ("path", "value"), [("params.r", 1), ("objects[0].v", 7), ("objects[0].properties.v", 7), ("objects[0].heading", 0.5), ("ego.heading", 1.5)]
)
def test_paths_find_their_place(path: str, value: object) -> None:
    assert read_path(VectorFields("f", {"of": path})).read(SCENE) == value


@pytest.mark.parametrize(
    ("found", "expected", "same"),
    [
        (None, {"none": True}, True), (0, {"none": True}, False), (1, 1.0, True), (True, 1, False), (1, True, False), ("1", 1, False),
        ([1, [2.0]], [1, [2]], True), ([1], [1, 2], False), ((1, 2), [1, 2], False), ({"a": 1, "b": 2}, {"a": 1}, True), ({"b": 2}, {"a": 1}, False),
        (math.nan, 1.0, False), (math.inf, 1.0, False), ("a", "a", True), ("a", "b", False), (None, 0, False),
    ],
)  # fmt: skip
def test_values_are_compared_as_json(found: object, expected: object, same: bool) -> None:
    assert close(found, expected, 1e-9) is same
