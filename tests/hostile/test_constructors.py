"""Constructors check what they are given: whatever it is, the answer is a value or an error of the program, with its place."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store import errors

WRONG = [
    "3", "'x'", "None", "[]", "(1,)", "(1, 2)", "[(0, 0)]", "{}", "ego", "everywhere", "CircularRegion((0, 0), 3)", "lambda v: 'a'", "True", "-1", "1e400",
    "Range", "[[everywhere, 1]]", "Object", "VectorField",
]  # fmt: skip
TRIANGLE = "PolygonalRegion([(0, 0), (1, 0), (1, 1)])"
REGION = "Object in x, with requireVisible False, with allowCollisions True\nrequire (0, 0) in x\nworkspace = x"
USES = {
    **dict.fromkeys(("CircularRegion", "SectorRegion", "RectangularRegion", "PolygonalRegion", "PolylineRegion", "PointSetRegion", "Workspace"), REGION),
    "VectorField": "Object at (3, 3), facing x", "PolygonalVectorField": "Object at (0.9, 0.1), facing x", "Vector": "Object at x",
}  # fmt: skip
LEADING = ("", "0, ", "'F', lambda v: 1, ", "(0, 0), ", "'F', ", "(0, 0), 3, ", "(0, 0), 3, 1, ", "polygon=", "[(0, 0), (1, 0), (1, 1)], orientation=", f"'F', [[{TRIANGLE}, 1]], ")


@pytest.mark.sampled(8)
@pytest.mark.parametrize("constructor", USES)
def test_a_constructor_gives_a_value_or_an_error_of_the_program(constructor):
    made = 0
    for leading in LEADING:
        for wrong in WRONG:
            text = f"ego = Object at (20, 20)\nx = {constructor}({leading}{wrong})\n{USES[constructor]}\n"
            try:
                scenic_ref.loads(text, fuel=100_000).sample(max_attempts=5)
                made += 1
            except errors.ProgramError as error:
                assert error.span.line >= 2, text
            except errors.AttemptsExhausted:
                made += 1
    assert made > 0


def test_the_cells_of_a_field_may_be_regions():
    text = f"f = PolygonalVectorField('F', [[{TRIANGLE}, 0.25]])\nego = Object at (0.9, 0.1), facing f\n"
    assert scenic_ref.loads(text).sample().ego.heading == 0.25


def test_two_curves_meet_in_points():
    text = "a = PolylineRegion([(0, 0), (2, 2)])\nb = PolylineRegion([(0, 2), (2, 0)])\nego = Object in a.intersect(b)\n"
    assert tuple(scenic_ref.loads(text).sample().ego.position) == (1, 1)


def test_a_thousand_open_calls_are_ordinary():
    text = "def f(n):\n    return 0 if n == 0 else 1 + f(n - 1)\nego = Object\nparam r = f({})\n"
    assert scenic_ref.loads(text.format(2_500)).sample().params == {"r": 2_500}
    with pytest.raises(errors.RunError, match="is called too deeply"):
        scenic_ref.loads(text.format(10_000)).sample()


def test_there_is_no_simulation_in_a_static_scene():
    with pytest.raises(errors.RunError, match="there is no simulation"):
        scenic_ref.loads("ego = Object with foo simulation()\n").sample()


@pytest.mark.parametrize(
    "region",
    [
        "PolylineRegion([(0, 0), ({}, 0)])", "PolylineRegion([(0, 0), ({}, 0), (-{}, 0)])", "PolygonalRegion([(0, 0), ({}, 0), ({}, {})])",
        "CircularRegion((0, 0), {})", "SectorRegion((0, {}), 1, 0, 1)", "RectangularRegion((0, 0), 0, 1, {})", "PointSetRegion('p', [({}, 0)])",
    ],
)
def test_a_region_reaches_only_as_far_as_its_shapes_can_be_computed(region):
    uses = "Object in x, with requireVisible False\nparam p = ego in x, q = x.intersects(CircularRegion((0, 0), 1)), r = distance to x\n"
    for size in ("1e99", "1e160", "1e308"):
        text = f"ego = Object at (20, 20)\nx = {region.replace('{}', size)}\n{uses}"
        if size == "1e99":
            assert scenic_ref.loads(text).sample().params["p"] in (True, False)
        else:
            with pytest.raises(errors.RunError, match="at most 1e\\+100"):
                scenic_ref.loads(text).sample()
