"""The tables of a path give what Shapely and NumPy do, to 1e-9 m, for places near and far and in windows along it."""

from __future__ import annotations

import math
from random import Random

import numpy as np
import pytest
import shapely
from scenic_ref.roads.network import Lane
from scenic_ref.roads.vehicle_paths import (
    AHEAD,
    BEHIND,
    LOOKED_AT,
    SIDEWAYS,
    SLOWING,
    WINDOW,
    PathTable,
    Trajectory,
    table_along,
)
from scenic_ref.simulators.worlds.driving import default_network
from shapely.geometry import LineString, Point
from shapely.ops import substring


def winding(chance: Random) -> np.ndarray:
    """The points of a path that winds, with segments of a metre at most."""
    heading, points = chance.uniform(-3, 3), [(0.0, 0.0)]
    for _ in range(chance.randrange(3, 150)):
        heading += chance.choice([0, 0, 0, chance.uniform(-0.3, 0.3), chance.uniform(-2, 2)])
        length = chance.choice([1.0, chance.uniform(0.01, 1)])
        x, y = points[-1]
        points.append((x + length * math.cos(heading), y + length * math.sin(heading)))
    return np.array(points)


def paths() -> list[np.ndarray]:
    """Paths that wind, and some of the default map."""
    chance = Random(3)
    of_map = []
    for lane in default_network().lanes[::7]:
        for maneuver in lane.maneuvers:
            parts = [part for part in (lane, maneuver.connectingLane, maneuver.endLane) if part is not None]
            of_map.append(np.column_stack([table_along(tuple(parts), False).xs, table_along(tuple(parts), False).ys]))
    return [winding(chance) for _ in range(60)] + of_map


@pytest.mark.parametrize("window", [False, True])
def test_the_nearest_point_is_that_of_shapely(window: bool) -> None:
    chance = Random(5)
    count = 0
    for points in paths():
        table, line = PathTable(points), LineString(points)
        for _ in range(60):
            x, y = points[chance.randrange(len(points))]
            x, y = x + chance.gauss(0, 4), y + chance.gauss(0, 4)
            low, high = 0.0, table.length
            if window:
                last = chance.uniform(-1, table.length)
                low, high = max(0.0, last - BEHIND), min(table.length, last + AHEAD)
            expected = low + substring(line, low, high).project(Point(x, y))
            found = table.project(x, y, low, high)
            count += abs(found - expected) < 1e-9
            # where two places are as near, rounding decides: then the distance is the same
            assert line.interpolate(found).distance(Point(x, y)) == pytest.approx(line.interpolate(expected).distance(Point(x, y)), abs=1e-9)
            assert low - 1e-9 <= found <= high + 1e-9
    assert count > 0.999 * 60 * len(paths())


def test_of_several_points_that_are_as_near_the_first_is_found() -> None:
    square = shapely.get_coordinates(LineString([(0, 0), (8, 0), (8, 8), (0, 8), (0, 0)]).segmentize(1))
    for guess in range(len(square) - 1):
        table = PathTable(square)
        table.nearest = guess, guess
        assert table.project(4, 4, 0, 32) == 4
        assert table.project(4, 4, 6, 32) == 12


def test_points_and_their_order() -> None:
    chance = Random(7)
    for points in paths():
        table, line = PathTable(points), LineString(points)
        for _ in range(40):
            place = chance.uniform(-3, table.length)
            expected = line.interpolate(max(0.0, place))
            assert tuple(table.point(place)) == pytest.approx((expected.x, expected.y), abs=1e-9)


def test_the_speed_limit_heeds_every_bend_that_is_ahead() -> None:
    chance = Random(9)
    bends = 0
    for points in paths():
        table = PathTable(points)
        for _ in range(40):
            place = chance.uniform(0, table.length)
            ahead = np.arange(0.0, LOOKED_AT, 1.0)
            at = np.minimum(place + ahead, table.length)
            turned = np.interp(at + WINDOW / 2, table.middles, table.directions) - np.interp(at - WINDOW / 2, table.middles, table.directions)
            expected = float(np.sqrt((SIDEWAYS / np.maximum(np.abs(turned) / WINDOW, 1e-9) + 2 * SLOWING * ahead).min()))
            assert table.speed_limit(place) == pytest.approx(expected, rel=1e-9)
            bends += expected < 20
    assert bends > 500


def test_a_path_along_elements_of_a_map_is_made_once() -> None:
    lane = default_network().lanes[0]
    assert isinstance(lane, Lane)
    assert Trajectory([lane]).table is Trajectory((lane,)).table is Trajectory(lane).table
    assert Trajectory([lane], True).table is not Trajectory([lane]).table
    assert Trajectory([lane, (0, 0)]).table is not Trajectory([lane, (0, 0)]).table
