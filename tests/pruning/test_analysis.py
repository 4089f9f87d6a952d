"""What can be pruned is found in the program, and is off, with the reason, where an assumption fails."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.inference.pruning import PAPER, TECHNIQUES, Finding, Pruning, prune
from scenic_ref.semantics.space.symbol_seam import NotLifted

from .programs import EGO, MAP, NEAR, OTHER, SEES_ALL

ALIGNED = "other = Object in road, with width 2, with length 4, facing Range(-0.1, 0.1) relative to direction\n"


def pruning(text: str, *, world: str = MAP, **options: object) -> Pruning:
    return prune(scenic_ref.loads(world + text, **options).start)  # type: ignore[arg-type]


def finding(found: Pruning, objects: str, technique: str) -> Finding:
    (one,) = (f for f in found.findings if (f.objects, f.technique) == (objects, technique))
    return one


def reason(text: str, technique: str, objects: str = "ego", **options: object) -> str:
    """Why the technique is off."""
    found = finding(pruning(text, **options), objects, technique)
    assert found.after is None
    return found.reason


# Containment


def test_containment_uses_half_the_smallest_side_that_the_box_can_have():
    found = finding(pruning(EGO), "ego", "containment")
    assert found.before == pytest.approx(18 * 60)
    assert found.after == pytest.approx(11 * 59 + 5 * 59, rel=2e-3)
    random = EGO.replace("with width 1", "with width Range(2, 3)").replace("with length 2", "with length Uniform(4, 5)")
    assert finding(pruning(random), "ego", "containment").after == pytest.approx(10 * 58 + 4 * 58, rel=5e-3)


GAP = """
road = PolygonalRegion(polygon=[PolygonalRegion([(0, 0), (5, 0), (5, 10), (0, 10)]), PolygonalRegion([(G, 0), (10, 0), (10, 10), (G, 10)])])
workspace = Workspace(road)
ego = Object in road, with width 4, with length 4
"""


def test_a_gap_that_the_boundary_closes_erodes_nothing():
    for gap, kept in (("5 + 1e-8", 36.0), ("5.001", 2 * 6.0 * 1.0)):
        assert finding(pruning(GAP.replace("G", gap), world=""), "ego", "containment").after == pytest.approx(kept, rel=6e-2)


def test_a_side_that_may_be_0_erodes_nothing():
    assert reason(EGO.replace("with width 1", "with width Range(0, 1)"), "containment") == "nothing to remove: minRadius 0 m"


def test_the_container_may_be_regionContainedIn_or_a_hard_requirement_or_the_rectangular_workspace():
    for container in (EGO.strip() + ", with regionContainedIn west\n", EGO + "require ego in west\n", EGO + "require ego in west and 1 < 2\n"):
        assert finding(pruning(container), "ego", "containment").after == pytest.approx(5 * 59, rel=5e-3)
    rectangle = "workspace = Workspace(RectangularRegion((0, 0), 0, 10, 10))\n"
    assert finding(pruning("ego = Object in workspace\n", world=rectangle), "ego", "containment").after == pytest.approx(81, rel=1e-2)


def test_a_container_that_is_no_polygon_and_a_soft_requirement_and_no_container_are_no_containers():
    circle = "workspace = Workspace(CircularRegion((0, 0), 9))\n"
    assert "polygonal container" in reason("ego = Object in RectangularRegion((0, 0), 0, 9, 9)\n", "containment", world=circle)
    assert "polygonal container" in reason(EGO + "require[0.9] ego in west\n", "containment", world=MAP.replace("workspace", "nothing"))


@pytest.mark.parametrize(
    ("program", "why"),
    [
        (EGO + "mutate\n", "its position is mutated"),
        (EGO + "mutate ego by 0.1\n", "its position is mutated"),
        (EGO.replace("in road", "at (3, 9)"), "its position is not random"),
        (EGO.replace("in road", "at (3, Range(2, 9))"), "its position is not drawn uniformly from a fixed polygonal region"),
        (EGO.replace("in road", "in CircularRegion((3, 9), 2)"), "its position is not drawn uniformly from a fixed polygonal region"),
        (EGO.replace("in road", "in CircularRegion((3, 9), Range(1, 2))"), "its position is not drawn uniformly from a fixed polygonal region"),
    ],
)
def test_a_position_that_is_not_uniform_in_the_end_is_not_pruned(program, why):
    found = pruning(program)
    assert not found.pruned
    assert {(f.technique, f.reason) for f in found.findings} == {(t, why) for t in TECHNIQUES}


def test_an_object_that_is_not_mutated_is_pruned_though_another_is():
    found = pruning(EGO + OTHER + "mutate other\n")
    assert [p.techniques for p in found.pruned] == [("containment",)]
    assert finding(found, "other", "containment").reason == "its position is mutated"


# Orientation

OPPOSITE = "require abs(relative heading of other) >= 2.8\n"


def test_orientation_is_found_from_a_hard_requirement_a_distance_and_two_aligned_objects():
    found = finding(pruning(EGO + ALIGNED + NEAR + OPPOSITE), "ego", "orientation")
    assert found.reason == "M 9 m, δ 0.05, A [2.8, inf] or [-inf, -2.8]"
    assert found.before == pytest.approx(16 * 59, rel=5e-3)
    assert found.after == pytest.approx(11 * 59 + (12 + 9 - 20.5) * 59, rel=0.02)  # `far` is within 9 m of `east` up to x = 21


def test_the_distance_may_come_from_visibility():
    near = EGO.replace("viewDistance 200", "viewDistance 20")
    assert finding(pruning(near + ALIGNED + OPPOSITE), "ego", "orientation").reason.startswith("nothing to remove: M 22.2 m")
    drawn = ALIGNED.strip() + ", with requireVisible Uniform(True, False)\n"
    assert reason(near + drawn + OPPOSITE, "orientation").startswith("nothing to remove: M 196 m"), "the map alone bounds it"


def test_a_soft_requirement_orients_nothing():
    why = reason(EGO + ALIGNED + NEAR + OPPOSITE.replace("require", "require[0.9]"), "orientation")
    assert why == "no hard requirement bounds its heading relative to that of another object that is aligned to a polygonal field"
    anywhere = ALIGNED.replace("in road", "at (Normal(3, 1), 9)").strip() + ", with requireVisible False\n"
    assert reason(EGO + anywhere + NEAR.replace("require", "require[0.9]") + OPPOSITE, "orientation") == "nothing bounds the distance of the two"


@pytest.mark.parametrize(
    "heading", ["facing Normal(0, 0.1) relative to direction", "facing Range(0, 1)", "facing toward (0, 0)", "facing 2 relative to ego"]
)
def test_an_object_that_is_not_aligned_within_a_bound_orients_nothing(heading):
    other = ALIGNED.replace("facing Range(-0.1, 0.1) relative to direction", heading)
    assert "is aligned to a polygonal field" in reason(EGO + other + NEAR + OPPOSITE, "orientation")


def test_a_field_with_a_heading_outside_its_polygons_or_given_by_a_function_orients_nothing():
    default = MAP.replace("(far.polygon, 0.2)]", "(far.polygon, 0.2)], None, 1")
    assert "is aligned to a polygonal field" in reason(EGO + ALIGNED + NEAR + OPPOSITE, "orientation", world=default)
    function = MAP.replace("(far.polygon, 0.2)", "(far.polygon, lambda p: 0.2)")
    assert "calls" in reason(EGO, "containment", "all objects", world=function)


def test_an_interval_of_plain_numbers_is_compared_without_wrapping():
    """The operator does not wrap (reading `angle`): 3.1 - 0 is not -3.18."""
    found = finding(pruning(EGO + ALIGNED + NEAR + "require (relative heading of other) <= -2.9\n"), "ego", "orientation")
    assert found.after is not None
    assert found.after < 600


@pytest.mark.parametrize("condition", ["abs((relative heading of other) - 3) <= 0.2", "abs(3 - (relative heading of other)) <= 0.2"])
def test_a_relative_heading_may_be_compared_with_an_angle_by_their_difference(condition):
    found = finding(pruning(EGO + ALIGNED + NEAR + f"require {condition}\n"), "ego", "orientation")
    same = finding(pruning(EGO + ALIGNED + NEAR + "require 2.8 <= (relative heading of other) <= 3.2\n"), "ego", "orientation")
    assert found.after is not None
    assert found.after == pytest.approx(same.after)


# Size

ACROSS = "other = Object at ego offset by (7, 0), with width 0.5, facing direction\n"


def test_size_is_found_from_a_point_across_in_the_same_map():
    program = EGO.replace("in road", "in road, facing direction") + ACROSS
    assert reason(program, "size") == "nothing to remove: minWidth 7 m, M 7 m"  # all lanes are near others


def test_size_removes_a_narrow_polygon_far_from_others():
    apart = MAP.replace("(20, 0), (26, 0), (26, 60), (20, 60)", "(40, 0), (46, 0), (46, 60), (40, 60)").replace("0.2)", "0)")
    found = finding(pruning(EGO.replace("in road", "in road, facing direction") + ACROSS, world=apart), "ego", "size")
    assert found.before == pytest.approx(16 * 59, rel=0.01)
    assert found.after == pytest.approx(11 * 59, rel=0.01)


def test_size_is_off_without_points_across():
    assert "apart across" in reason(EGO + OTHER, "size")


# Offset, reachability


def test_offset_restricts_a_point_to_where_its_companion_fits():
    found = finding(pruning(EGO.replace("in road", "in road, facing direction") + ACROSS), "ego", "offset")
    assert found.reason == "[7, 7] m across, [0, 0] m ahead"
    assert found.after is not None
    assert found.after < 0.6 * (found.before or 0)


def test_offset_is_an_addition_that_can_be_left_out():
    program = EGO.replace("in road", "in road, facing direction") + ACROSS
    found = prune(scenic_ref.loads(MAP + program).start, techniques=PAPER)
    assert {f.technique for f in found.findings} == set(PAPER)
    assert "offset" not in found.pruned[0].techniques


def test_reachability_says_why_it_is_off():
    assert reason(EGO, "reachability") == "no requirement says that it must reach a region in a given time"


# Programs that are left alone


def test_a_program_that_may_take_another_course_is_not_pruned():
    assert reason(EGO + "param q = 1 / Range(-1, 1)\n", "containment", "all objects") == "the program branches on a random value"
    assert reason(EGO + "param q = round(Range(0, 9))\n", "containment", "all objects").startswith("the program calls round")


TWO = "b = Object\na = Object in road\nego = Uniform(a, b)\n"
CHOICE = "Uniform(road, west)"


@pytest.mark.parametrize("text", [TWO, f"workspace = Workspace({CHOICE})\n{EGO}"])
def test_a_random_ego_or_workspace_has_no_graph_to_prune_by(text):
    with pytest.raises(NotLifted):
        pruning(text)


def test_a_position_in_a_random_region_is_not_pruned():
    text = EGO.replace("road", CHOICE)
    assert {line.split(": ", 1)[1].split(" ", 1)[1] for line in str(pruning(text)).splitlines()} == {"off: the program branches on a random value"}


def test_a_report_names_objects_techniques_areas_and_reasons():
    text = str(pruning(EGO + OTHER + "mutate other\n"))
    assert "ego: containment: 1,080 -> 945 m2 (87.5%), minRadius 0.5 m" in text
    assert "other: containment off: its position is mutated" in text
    assert str(Pruning((), ())) == "no object's position is random"


def test_a_program_without_scenes_is_not_pruned_to_nothing():
    found = pruning(f"ego = Object in road, with width 7, with length 7, {SEES_ALL}\n", world=MAP.replace("[east", "[far"))
    assert not any(p.region.polygon.is_empty for p in found.pruned)
