"""The algorithms never remove a point from which a valid configuration exists; wrong versions of each do, and are caught."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import shapely
from scenic_ref.inference.pruning.algorithms import (
    Cell,
    Shape,
    common_part,
    dilate,
    erode,
    narrow,
    prune_by_containment,
    prune_by_heading,
    prune_by_offset,
    prune_by_reachability,
    prune_by_width,
    width_across,
)
from scenic_ref.inference.pruning.node_bounds import Interval
from scenic_ref.semantics.space.geometry import normalise_heading
from shapely.geometry import LineString, Point, Polygon

from .maps import random_cells, random_points, random_polygon, turned

MAPS = 12
Lost = Callable[..., int]


def missing(kept: Shape, points: np.ndarray) -> int:
    """How many of the points are not in the shape."""
    return int(len(points) - shapely.intersects_xy(kept, points[:, 0], points[:, 1]).sum()) if len(points) else 0


def in_a_cell(cells: list[Cell], points: np.ndarray) -> np.ndarray:
    """For each cell, which points are in it, (cells, n)."""
    return np.array([shapely.contains_xy(shape, points[:, 0], points[:, 1]) for shape, _ in cells])


def total(lost: Lost, **change: object) -> int:
    """Valid points lost on all maps."""
    return sum(lost(np.random.default_rng(seed), **change) for seed in range(MAPS))


# Containment


def lost_by_containment(rng: np.random.Generator, *, radius: Callable[[float, float], float] = lambda a, b: min(a, b) / 2) -> int:
    region, container = random_polygon(rng), random_polygon(rng)
    width, length = rng.uniform(0.5, 6, 2)
    centers = random_points(rng, region, 400)
    headings = rng.uniform(0, 2 * math.pi, len(centers))
    corners = [np.array([x, y]) for x, y in ((width, length), (-width, length), (-width, -length), (width, -length))]
    boxes = np.stack([centers + turned(np.tile(c / 2, (len(centers), 1)), headings) for c in corners], axis=1)
    valid = shapely.covers(container, shapely.polygons(boxes))
    return missing(prune_by_containment(region, container, radius(width, length)), centers[valid])


def test_containment_keeps_every_centre_of_a_box_in_the_container():
    assert total(lost_by_containment) == 0


def test_an_erosion_that_is_too_large_is_caught():
    assert total(lost_by_containment, radius=max) > 0
    assert total(lost_by_containment, radius=lambda a, b: math.hypot(a, b) / 2) > 0


def test_containment_removes_the_margin_of_a_square():
    square = Polygon([(0, 0), (10, 0), (10, 10), (0, 10)])
    assert prune_by_containment(square, square, 1.0).area == pytest.approx(64, rel=0.01)
    assert prune_by_containment(square, square, 6.0).is_empty


# Orientation


def valid_for_heading(
    rng: np.random.Generator, cells: list[Cell], allowed: list[Interval], distance: float, deviation: float
) -> np.ndarray:  # fmt: skip
    """Positions of X in configurations that meet the assumptions, (n, 2); angles count up to multiples of 2π."""
    found = [np.empty((0, 2))]
    for shape, heading in cells:
        xs = random_points(rng, shape, 300)
        ys = xs + turned(np.stack([np.zeros(len(xs)), distance * np.sqrt(rng.random(len(xs)))], axis=1), rng.uniform(0, 7, len(xs)))
        for inside, (_, other) in zip(in_a_cell(cells, ys), cells, strict=True):
            relative = other - heading + rng.uniform(-2, 2, len(xs)) * deviation + 2 * math.pi * rng.integers(-2, 3, len(xs))
            fits = np.zeros(len(xs), dtype=bool)
            for low, high in allowed:
                fits |= np.mod(relative - low, 2 * math.pi) <= high - low
            found.append(xs[inside & fits])
    return np.concatenate(found)


def lost_by_heading(
    rng: np.random.Generator, *, turn: float = 2 * math.pi, used: float = 1.0, reach: float = 1.0, reading: str = "meets"
) -> int:  # fmt: skip
    cells, distance, deviation = random_cells(rng), float(rng.uniform(5, 25)), float(rng.uniform(0, 0.3))
    low = float(rng.uniform(-math.pi, 2 * math.pi))
    allowed = [Interval(low, low + float(rng.uniform(0.05, 1.0)))]
    valid = valid_for_heading(rng, cells, allowed, distance, deviation)
    asked = allowed if reading == "meets" else [Interval(i.low + 2 * deviation, i.high - 2 * deviation) for i in allowed]
    return missing(prune_by_heading(cells, asked, reach * distance, used * deviation if reading == "meets" else 0.0, turn), valid)


def test_orientation_keeps_every_position_with_a_partner():
    assert total(lost_by_heading) == 0


def test_angles_that_do_not_wrap_are_caught():
    assert total(lost_by_heading, turn=math.inf) > 0


def test_an_interval_that_must_lie_in_a_instead_of_meeting_it_is_caught():
    assert total(lost_by_heading, reading="contains") > 0


def test_a_deviation_or_a_distance_that_is_too_small_is_caught():
    assert total(lost_by_heading, used=0.0) > 0
    assert total(lost_by_heading, used=0.5) > 0
    assert total(lost_by_heading, reach=0.5) > 0


def test_a_pair_whose_exact_relative_heading_is_outside_a_by_less_than_two_delta_survives():
    here, there = Polygon([(0, 0), (1, 0), (1, 1), (0, 1)]), Polygon([(1, 0), (2, 0), (2, 1), (1, 1)])
    cells: list[Cell] = [(here, 0.0), (there, 1.0)]
    allowed = [Interval(1.15, 1.2)]
    assert prune_by_heading(cells, allowed, 5.0, 0.1).covers(here)
    assert prune_by_heading(cells, allowed, 5.0, 0.05).is_empty


def test_orientation_across_south_wraps():
    """170 and -170 degrees differ by 20, not by 340."""
    here, there = Polygon([(0, 0), (1, 0), (1, 1), (0, 1)]), Polygon([(1, 0), (2, 0), (2, 1), (1, 1)])
    cells: list[Cell] = [(here, math.radians(170)), (there, math.radians(-170))]
    allowed = [Interval(math.radians(15), math.radians(25))]
    assert prune_by_heading(cells, allowed, 5.0, 0.0).covers(here)
    assert prune_by_heading(cells, allowed, 5.0, 0.0, turn=math.inf).is_empty
    assert normalise_heading(cells[1][1] - cells[0][1]) == pytest.approx(math.radians(20))


def test_orientation_restricts_a_polygon_to_the_surroundings_of_its_partners():
    here, there = Polygon([(0, 0), (10, 0), (10, 1), (0, 1)]), Polygon([(10, 0), (20, 0), (20, 1), (10, 1)])
    kept = prune_by_heading([(here, 0.0), (there, 1.0)], [Interval(0.9, 1.1)], 3.0, 0.0)
    assert kept.area == pytest.approx(3.0, rel=0.02)
    assert kept.within(dilate(Polygon([(7, 0), (10, 0), (10, 1), (7, 1)]), 0.1))


# Size


def lost_by_width(rng: np.random.Generator, *, wider: float = 1.0, reach: float = 1.0, drop: bool = False) -> int:
    cells, width = random_cells(rng), float(rng.uniform(2, 8))
    along = float(rng.uniform(0, 10))
    distance = math.hypot(1.5 * width, along)
    valid = [np.empty((0, 2))]
    for shape, heading in cells:
        xs = random_points(rng, shape, 300)
        offsets = np.stack([rng.uniform(width, 1.5 * width, len(xs)) * rng.choice([-1, 1], len(xs)), rng.uniform(-along, along, len(xs))], axis=1)
        ys = xs + turned(offsets, np.full(len(xs), heading))
        valid.append(xs[in_a_cell(cells, ys).any(axis=0)])
    kept = prune_by_width(cells, reach * distance, wider * width)
    if drop:
        wide = [shape for p, (shape, _) in enumerate(cells) if p not in narrow(cells, width)]
        kept = common_part(kept, shapely.union_all(wide))
    return missing(kept, np.concatenate(valid))


def test_size_keeps_every_position_with_a_partner_across():
    assert total(lost_by_width) == 0


def test_a_width_that_is_too_large_or_a_distance_that_is_too_small_or_dropping_narrow_polygons_is_caught():
    assert total(lost_by_width, wider=3.0) > 0
    assert total(lost_by_width, reach=0.3) > 0
    assert total(lost_by_width, drop=True) > 0


def test_narrow_polygons_are_measured_across_their_heading():
    lane = Polygon([(0, 0), (3, 0), (3, 20), (0, 20)])
    assert width_across(lane, 0.0) == pytest.approx(3)
    assert width_across(lane, math.pi / 2) == pytest.approx(20)
    assert narrow([(lane, 0.0), (lane, math.pi / 2)], 3.5) == [0]


def test_size_restricts_a_narrow_polygon_to_the_surroundings_of_others():
    lane, far = Polygon([(0, 0), (3, 0), (3, 20), (0, 20)]), Polygon([(0, 25), (9, 25), (9, 34), (0, 34)])
    kept = prune_by_width([(lane, 0.0), (far, 0.0)], 7.0, 4.0)
    assert kept.covers(far)
    assert common_part(kept, lane).area == pytest.approx(6.0, rel=0.1)


# Reachability


def lost_by_reachability(rng: np.random.Generator, *, share: float = 1.0, inside: bool = True) -> int:
    """Starts of random paths in a polygon that end in a goal; `share` of the speed is assumed."""
    container, speed, time = random_polygon(rng), float(rng.uniform(1, 4)), float(rng.uniform(1, 4))
    goal = common_part(container, Point(random_points(rng, container, 1)[0]).buffer(1.0))
    starts = []
    for end in random_points(rng, goal, 40):
        path = [end]
        while (left := speed * time - LineString([*path, path[0]][:-1] if len(path) > 1 else [end, end]).length) > 1e-3 and len(path) < 12:
            step = path[-1] + turned(np.array([[0.0, left * rng.random() ** 0.3]]), rng.uniform(0, 7, 1))[0]
            if not container.covers(LineString([path[-1], step])):
                break
            path.append(step)
        starts.append(path[-1])
    kept = prune_by_reachability(container, goal, share * speed, time, container if inside else None)
    return missing(kept, np.array(starts))


@pytest.mark.slow
def test_reachability_keeps_every_start_of_a_path_to_the_goal():
    assert total(lost_by_reachability) == 0
    assert total(lost_by_reachability, inside=False) == 0


@pytest.mark.slow
def test_a_speed_that_is_too_small_is_caught():
    assert total(lost_by_reachability, share=0.5) > 0


def test_reachability_along_paths_goes_round_corners():
    """A U-shaped road: across the gap it is near, along the road it is far."""
    road = Polygon([(0, 0), (13, 0), (13, 30), (10, 30), (10, 3), (3, 3), (3, 30), (0, 30)])
    goal = Polygon([(0, 27), (3, 27), (3, 30), (0, 30)])
    straight, along = prune_by_reachability(road, goal, 10, 2), prune_by_reachability(road, goal, 10, 2, road)
    across = Point(11, 29)
    assert straight.covers(across)
    assert not along.covers(across)
    assert along.covers(Point(1.5, 8))
    assert along.area < 0.6 * straight.area


# Offset


def lost_by_offset(rng: np.random.Generator, *, shrink: float = 1.0, deviates: bool = True) -> int:
    cells, target = random_cells(rng), random_polygon(rng, size=30.0)
    across, along = (Interval(low, low + float(rng.uniform(0, 4))) for low in rng.uniform(-10, 10, 2))
    deviation, slack = float(rng.uniform(0, 0.2)), float(rng.uniform(0, 1))
    valid = [np.empty((0, 2))]
    for shape, heading in cells:
        xs = random_points(rng, shape, 300)
        n = len(xs)
        local = np.stack([rng.uniform(*across, n), rng.uniform(*along, n)], axis=1)
        around = turned(np.stack([np.zeros(n), slack * np.sqrt(rng.random(n))], axis=1), rng.uniform(0, 7, n))
        ys = xs + turned(local, heading + rng.uniform(-deviation, deviation, n)) + around
        valid.append(xs[shapely.contains_xy(target, ys[:, 0], ys[:, 1])])
    middle = sum(across) / 2
    used = Interval(middle - shrink * (middle - across.low), middle + shrink * (across.high - middle))
    return missing(prune_by_offset(cells, target, used, along, deviation if deviates else 0.0, slack if deviates else 0.0), np.concatenate(valid))


def test_offset_keeps_every_position_whose_partner_can_be_in_the_target():
    assert total(lost_by_offset) == 0


def test_offsets_that_are_too_small_or_exact_are_caught():
    assert total(lost_by_offset, shrink=0.0) > 0
    assert total(lost_by_offset, deviates=False) > 0


# Shapes


@pytest.mark.parametrize("distance", [0.0, 0.3, 2.0, 8.0])
def test_erosion_and_dilation_lose_no_point(distance):
    rng = np.random.default_rng(5)
    for _ in range(10):
        shape = random_polygon(rng)
        inner = random_points(rng, shape, 400)
        deep = inner[shapely.distance(shape.boundary, shapely.points(inner)) >= distance]
        assert missing(erode(shape, distance), deep) == 0
        around = rng.uniform(-40, 40, (400, 2))
        near = around[shapely.distance(shape, shapely.points(around)) <= distance]
        assert missing(dilate(shape, distance), near) == 0


def test_erosion_and_dilation_are_not_much_too_large():
    square = Polygon([(0, 0), (10, 0), (10, 10), (0, 10)])
    assert erode(square, 2.0).area == pytest.approx(36, rel=0.02)
    assert dilate(square, 2.0).area == pytest.approx(100 + 80 + 4 * math.pi, rel=0.01)
    assert erode(square, 6.0).is_empty


@pytest.mark.parametrize("operation", [erode, dilate])
def test_a_negative_distance_is_refused(operation):
    with pytest.raises(ValueError, match="by a distance"):
        operation(Polygon([(0, 0), (1, 0), (1, 1)]), -1.0)
