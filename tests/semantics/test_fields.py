"""Vector fields: values, precedence of cells, and what lies outside."""

from __future__ import annotations

import pytest
import scenic_ref
from hypothesis import given, settings
from hypothesis import strategies as st
from scenic_ref.semantics.space.fields import OutsideField, PolygonalVectorField, VectorField
from scenic_ref.semantics.space.regions import CircularRegion
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import RunError, ScenicError
from shapely.geometry import Point, Polygon, box

HERE = Vector(0.5, 0.5)
triangles = st.lists(st.tuples(st.integers(-6, 6), st.integers(-6, 6)), min_size=3, max_size=3).map(Polygon).filter(lambda p: p.area > 0)


def test_a_field_is_its_function() -> None:
    assert VectorField("twice", lambda v: 2 * v.x).at(Vector(3.0, 0.0)) == 6


@pytest.mark.slow
@given(st.lists(triangles, max_size=12), st.tuples(st.integers(-24, 24), st.integers(-24, 24)))
@settings(deadline=None, max_examples=200)
def test_the_first_cell_that_contains_the_point_wins(cells: list[Polygon], quarters: tuple[int, int]) -> None:
    """Compared with trying every cell in turn, also at points on edges and corners."""
    v = Vector(quarters[0] / 4, quarters[1] / 4)
    field = PolygonalVectorField("field", [(cell, float(number)) for number, cell in enumerate(cells)])
    expected = next((number for number, cell in enumerate(cells) if cell.intersects(Point(v.x, v.y))), None)
    assert field.cell_at(v) == expected
    if expected is None:
        with pytest.raises(OutsideField) as outside:
            field.at(v)
        assert outside.value.field is field
        assert outside.value.point == v
    else:
        assert field.at(v) == expected


def test_cells_are_closed() -> None:
    field = PolygonalVectorField("field", [(box(0, 0, 1, 1), 7.0)])
    assert [field.at(Vector(x, y)) for x, y in ((0, 0), (1, 1), (1, 0.5), (0.25, 0))] == [7.0] * 4


@pytest.mark.parametrize("number", [float("nan"), float("inf"), -float("inf"), 1e300])
def test_points_that_are_nowhere_are_outside(number: float) -> None:
    with pytest.raises(OutsideField):
        PolygonalVectorField("field", [(box(0, 0, 1, 1), 7.0)]).at(Vector(number, 0.0))


def test_a_default_heading_holds_outside_and_in_cells_without_heading() -> None:
    field = PolygonalVectorField("field", [(box(0, 0, 1, 1), None)], defaultHeading=2.0)
    assert (field.at(HERE), field.at(Vector(5.0, 5.0))) == (2, 2)


def test_a_heading_function_holds_in_cells_without_heading_only() -> None:
    field = PolygonalVectorField("field", [(box(0, 0, 1, 1), None), (box(1, 0, 2, 1), 4.0)], headingFunction=lambda v: v.x)
    assert (field.at(HERE), field.at(Vector(1.5, 0.5))) == (0.5, 4)
    with pytest.raises(OutsideField):
        field.at(Vector(5.0, 5.0))


def test_a_cell_may_have_a_function_of_its_own() -> None:
    assert PolygonalVectorField("field", [(box(0, 0, 1, 1), lambda v: v.x + v.y)]).at(HERE) == 1


def test_a_cell_without_any_heading_is_refused() -> None:
    with pytest.raises(ValueError, match="cell 0 of the vector field road has no heading"):
        PolygonalVectorField("road", [(box(0, 0, 1, 1), None)])


def test_a_field_without_cells_is_nowhere_defined() -> None:
    with pytest.raises(OutsideField):
        PolygonalVectorField("field", []).at(HERE)


def test_cells_of_very_different_sizes_are_all_found() -> None:
    field = PolygonalVectorField("field", [*((box(i, 0, i + 1, 1), float(i)) for i in range(50)), (box(-1e5, -1e5, 1e5, 1e5), -1.0)])
    assert [field.at(Vector(x, 0.5)) for x in (3.5, 49.5, 60.0, -9e4)] == [3, 49, -1, -1]


@pytest.mark.parametrize(("steps", "message"), [
    ("minSteps=0", "positive whole number"), ("minSteps=1.5", "positive whole number"), ("defaultStepSize=0", "positive number"),
    ("defaultStepSize='a'", "positive number"), ("defaultStepSize=1e-9", "4000000000 steps"), ("step=1", "has no parameter step"),
])  # fmt: skip
def test_steps_along_a_field_are_a_reasonable_number(steps: str, message: str) -> None:
    program = f"ego = Object\nF = VectorField('F', lambda p: 0, {steps})\nparam x = follow F from (0, 0) for 4\n"
    with pytest.raises(ScenicError, match=message):
        scenic_ref.loads(program).sample()


@pytest.mark.parametrize("arguments", ["(0, 0)", "(0, 0), 4, size=2", "(0, 0), 4, dist=3"])
def test_methods_name_the_parameters_that_they_have(arguments: str) -> None:
    program = f"ego = Object\nF = VectorField('F', lambda p: 0)\nparam x = F.followFrom({arguments})\n"
    with pytest.raises(ScenicError, match=r"followFrom\(\) takes \(pos, dist, steps, stepSize\)"):
        scenic_ref.loads(program).sample()


def test_steps_that_are_drawn_are_taken_by_every_backend() -> None:
    program = "ego = Object\nF = VectorField('F', lambda p: p.x / 10, minSteps=Uniform(3, 4), defaultStepSize=1)\n"
    program += "param x = [follow F from (1, 0) for Range(2, 9), F.followFrom((0, 0), Range(3, 6), steps=Uniform(2, 3))]\n"
    scenario = scenic_ref.loads(program)
    assert [s.to_json() for s in scenario.sample_many(10, 3)] == [scenario.sample(3, index).to_json() for index in range(10)]


def test_a_circle_has_no_resolution() -> None:
    assert CircularRegion(Vector(0, 0), 2, 4, "a") == CircularRegion(Vector(0, 0), 2, resolution=64)


@pytest.mark.parametrize("area", ["[(0, 0), (4, 0), (4, 2), (0, 2)]", "RectangularRegion((2, 1), 0, 4, 2)", "PolygonalRegion([0@0, 4@0, 4@2, 0@2])"])
def test_areas_are_given_by_points_or_by_regions_with_straight_edges(area: str) -> None:
    text = f"area = {area}\nF = PolygonalVectorField('F', [(area, 1)])\nR = PolygonalRegion(area)\nworkspace = Workspace(area)\n"
    text += "ego = Object at 2@1, with a (F at 4@2), with b R.measure(), with c (4@2) in workspace, with d (4.1@2) in workspace\n"
    found = scenic_ref.loads(text).sample().ego.properties
    assert [found[name] for name in "abcd"] == [1, 8.0, True, False]


@pytest.mark.parametrize(
    ("area", "message"),
    [
        ("[(0, 0), (4, 0)]", "at least 3 different points"), ("[(0, 0), (4, 4), (4, 0), (0, 4)]", "is not a polygon: Self-intersection"),
        ("[1, 2, 3]", "must be vectors"), ("CircularRegion((0, 0), 4)", "must be a pair of a polygonal region, or its corners, and a heading"),
        ("RectangularRegion((0, 0), 0, 0, 2)", "must be a pair of a polygonal region, or its corners, and a heading"),
    ],
)  # fmt: skip
def test_a_cell_that_is_no_area_is_an_error(area: str, message: str) -> None:
    with pytest.raises(RunError, match=message):
        scenic_ref.loads(f"F = PolygonalVectorField('F', [({area}, 1)])\nego = Object\n").sample()


@pytest.mark.parametrize("cells", ["3", "None"])
def test_the_cells_must_be_a_list(cells):
    with pytest.raises(RunError, match="the cells of a vector field must be a list of pairs, not"):
        scenic_ref.loads(f"f = PolygonalVectorField('f', {cells})\nego = Object\n").sample()
