"""What is asked of a drawn element of a map, compiled: the bits of the columns, and of GEOS, or the run is left to the interpreter."""

from __future__ import annotations

import numpy as np
import pytest
import scenic_ref
import shapely
from scenic_ref.inference.batch.graph import SearchPart
from scenic_ref.inference.batch.numpy_evaluator import search_parts
from scenic_ref.inference.batch.primitives.point_in_polygon import edges_of
from scenic_ref.inference.batch.row_calls import distance_from_polygon, heading_along
from scenic_ref.roads.network import Lane
from scenic_ref.semantics.space.regions import PolygonalRegion
from scenic_ref.simulators.worlds.driving import default_network

pytestmark = pytest.mark.extra("fast")

HEAD = "model scenic.domains.driving.model\n"
PROGRAMS = {
    "a lane": "lane = Uniform(*network.lanes)\nego = Car on lane.centerline\nparam h = ego.heading\n",
    "a maneuver": (
        "inter = Uniform(*network.intersections)\nturn = Uniform(*inter.maneuvers)\nego = Car on turn.startLane.centerline\n"
        "param d = distance from ego to inter\nrequire (distance from ego to inter) < 20\n"
    ),
    "a maneuver with conflicts": (
        "inter = Uniform(*filter(lambda i: len(i.incomingLanes) > 2, network.intersections))\n"
        "turn = Uniform(*filter(lambda m: len(m.conflictingManeuvers) > 0, inter.maneuvers))\nother = Uniform(*turn.conflictingManeuvers)\n"
        "ego = Car on turn.startLane.centerline\nsecond = Car on other.startLane.centerline\nrequire 5 < (distance from ego to inter) < 25\n"
    ),
    "a lane of a road": (
        "road = Uniform(*network.roads)\nlane = Uniform(*filter(lambda l: all([s._laneToRight is None for s in l.sections]), road.lanes))\n"
        "ego = Car on lane.centerline\nparam h = lane.orientation at ego\n"
    ),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_compiled_scenes_are_those_of_the_columns_and_of_the_interpreter(name: str) -> None:
    columns, compiled, interpreter = (scenic_ref.loads(HEAD + PROGRAMS[name]) for _ in range(3))
    assert compiled.batch is not None
    assert compiled.batch.compile(), compiled.batch.not_compiled
    found = [scene.to_line() for scene in compiled.sample_many(300, seed=5, backend="batch")]
    assert found == [scene.to_line() for scene in columns.sample_many(300, seed=5, backend="batch")]
    assert found[:20] == [scene.to_line() for scene in interpreter.sample_many(20, seed=5, backend="interpreter")]
    assert compiled.batch.block(5, 0, 300).left < 10


def lanes() -> list[Lane]:
    """Some lanes of the default map."""
    return list(default_network().lanes[::5])


def test_headings_are_those_of_the_nearest_segment_of_geos() -> None:
    from scenic_ref.inference.batch.primitives import numba_kernels

    random = np.random.default_rng(3)
    unsure = count = 0
    for lane in lanes():
        curve = lane.centerline
        ends = shapely.get_coordinates(curve.segment_tree.geometries).reshape(-1, 4)
        on = random.choice(shapely.get_coordinates(curve.polyline), 100)
        points = np.concatenate([on + random.normal(0, 3, on.shape), on, on + random.normal(0, 1e-10, on.shape)])
        expected = heading_along(curve, *points.T)
        for (x, y), heading in zip(points, expected):
            known, found = numba_kernels.nearest_heading(x, y, ends, np.asarray(curve.headings), 0, len(ends))
            assert not known or found == heading
            unsure += not known
            count += 1
    assert 0 < unsure < 0.7 * count


def test_distances_from_polygons_are_those_of_geos() -> None:
    from scenic_ref.inference.batch.primitives import numba_kernels

    random = np.random.default_rng(4)
    with_a_hole = PolygonalRegion(polygon=shapely.Point(0, 0).buffer(9, quad_segs=5).difference(shapely.box(-3, -2, 4, 1)))
    for region in (with_a_hole, *default_network().intersections, *(PolygonalRegion(polygon=lane.polygon) for lane in lanes())):
        edges = edges_of(region.polygon)
        west, south, east, north = region.polygon.bounds
        points = random.uniform((west - 20, south - 20), (east + 20, north + 20), (200, 2))
        expected = distance_from_polygon(region, *points.T)
        for (x, y), away in zip(points, expected):
            known, found = numba_kernels.polygon_distance(x, y, edges, 0, len(edges))
            assert known and found == away
        for x, y in random.choice(shapely.get_coordinates(region.polygon), 20):
            assert not numba_kernels.polygon_distance(x, y, edges, 0, len(edges))[0]


def test_parts_are_searched_as_in_columns() -> None:
    from scenic_ref.inference.batch.primitives import numba_kernels

    random = np.random.default_rng(5)
    parts = [np.append(np.sort(random.choice(9, n).astype(float)), np.inf) for n in (0, 1, 2, 5, 9)]
    values, starts = np.concatenate(parts), np.cumsum([0, *map(len, parts)])
    part, value = random.integers(0, 5, 400), random.choice(np.arange(-1, 10, 0.5), 400)
    expected = search_parts(SearchPart(values, starts), part, value)
    assert [numba_kernels.search_part(values, starts, k, v) for k, v in zip(part, value)] == expected.tolist()
