"""The pruning algorithms of the paper (Section "Domain-Specific Sampling Techniques" and Appendix "Sampling Algorithms").

Each restricts the positions of an object X to a smaller set that holds every position which X has in some scene. Pure geometry: what
a program must be like for an algorithm to apply is stated here as an assumption, and established by `analysis`. Metres and
radians. Every result may be larger than the algorithm's, by rounding, and never smaller.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import MultiPoint, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from ...semantics.space.boundaries import common, unite_shapes
from .node_bounds import TAU, Interval, angles_meet

Shape = Polygon | MultiPolygon
CHORDS = 8
"""Chords for a quarter of a circle."""
SIMPLIFIED = 0.01
"""The share of its distance by which a buffer may be off, since corners are simplified first (JTS, `BufferInputLineSimplifier`)."""
ROUNDING = 1e-6
"""Metres by which coordinates computed from others may be off, generously."""
OUTWARD = (1 + SIMPLIFIED) / math.cos(math.pi / (4 * CHORDS))
NOTHING = Polygon()


def erode(shape: BaseGeometry, distance: float) -> Shape:
    """At least the points whose distance from everything outside `shape` is `distance` metres or more. Holes count as outside."""
    if distance < 0:
        raise ValueError(f"a region is eroded by a distance, not by {distance}")
    return polygons_of(shape.buffer(ROUNDING - (1 - SIMPLIFIED) * distance, quad_segs=CHORDS))


def dilate(shape: BaseGeometry, distance: float) -> Shape:
    """At least the points within `distance` metres of `shape`."""
    if distance < 0:
        raise ValueError(f"a region is dilated by a distance, not by {distance}")
    return polygons_of(shape.buffer(ROUNDING + OUTWARD * distance, quad_segs=CHORDS))


def polygons_of(shape: BaseGeometry) -> Shape:
    """The areas in a geometry: lines and points, which no uniform point ever meets, are left out."""
    found = [part for part in _simple_geometries(shape) if isinstance(part, Polygon) and part.area > 0]
    return found[0] if len(found) == 1 else MultiPolygon(found) if found else NOTHING


def _simple_geometries(shape: BaseGeometry) -> list[BaseGeometry]:
    members = getattr(shape, "geoms", None)
    return [shape] if members is None else [part for member in members for part in _simple_geometries(member)]


def union_of(shapes: list[Shape]) -> Shape:
    """The union of some shapes."""
    return polygons_of(unite_shapes(shapes)) if shapes else NOTHING


def common_part(first: BaseGeometry, second: BaseGeometry) -> Shape:
    """The points in both shapes, and those within rounding of them."""
    return polygons_of(common(first, second))


Cell = tuple[Shape, float]
"""A polygon and the heading of the vector field in it."""


def prune_by_containment(region: BaseGeometry, container: BaseGeometry, min_radius: float) -> Shape:
    """R ∩ erode(C, minRadius) (paragraph "Pruning Based on Containment").

    Assumes: X's centre is in `region`; its bounding box lies in `container`; every point of the box's edges is at least
    `min_radius` from its centre.
    """
    return common_part(region, erode(container, min_radius))


def prune_by_heading(
    cells: Sequence[Cell], allowed: Sequence[Interval], distance: float, deviation: float, turn: float = TAU
) -> Shape:  # fmt: skip
    """pruneByHeading(map, A, M, δ), Algorithm "alg:prune_head".

    Assumes: X and Y each lie in a polygon of the map, with a heading that differs from the polygon's by at most `deviation` (δ);
    they are at most `distance` (M) apart; the heading of Y minus that of X is in A, the union of the intervals `allowed`, up to
    multiples of `turn` (infinite: as plain numbers). "relHead(P, Q) ± 2δ ∈ A" is read as: the interval *meets* A (reading
    `prune-heading`). Where polygons overlap, each point has the heading of any one of them.
    """
    shapes = np.array([shape for shape, _ in cells], dtype=object)
    near = _pairs_within(shapes, distance)
    kept: list[Shape] = []
    for p, (shape, heading) in enumerate(cells):
        matching = [q for q in near[p] if _heads(cells[q][1] - heading, deviation, allowed, turn)]
        if matching:
            kept.append(common_part(shape, dilate(unite_shapes(list(shapes[matching])), distance)))
    return union_of(kept)


def _heads(relative: float, deviation: float, allowed: Sequence[Interval], turn: float) -> bool:
    """relHead(P, Q) ± 2δ meets A."""
    return any(angles_meet(relative, 2 * deviation, interval, turn) for interval in allowed)


def _pairs_within(shapes: np.ndarray, distance: float) -> list[list[int]]:
    """For each shape the numbers of those within `distance` of it, itself included."""
    pairs = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=distance + ROUNDING)
    near: list[list[int]] = [[] for _ in shapes]
    for p, q in pairs.T.tolist():
        near[p].append(q)
    return near


def prune_by_width(cells: Sequence[Cell], distance: float, min_width: float) -> Shape:
    """pruneByWidth(map, M, minWidth), Algorithm "alg:prune_width".

    Assumes: X and the other points of a configuration each lie in a polygon of the map, the others at most `distance` (M) from X; two
    of the points (X may be one) are at least `min_width` apart across the heading of X's polygon. So where that polygon is
    thinner than this, one of the others lies in another polygon.
    """
    narrow_cells = set(narrow(cells, min_width))
    shapes = np.array([shape for shape, _ in cells], dtype=object)
    near = _pairs_within(shapes, distance)
    kept = [shape for p, (shape, _) in enumerate(cells) if p not in narrow_cells]
    for p in sorted(narrow_cells):
        others = [q for q in near[p] if q != p]
        if others:
            kept.append(common_part(shapes[p], dilate(unite_shapes(list(shapes[others])), distance)))
    return union_of(kept)


def narrow(cells: Sequence[Cell], min_width: float) -> list[int]:
    """The numbers of the polygons that are thinner than `min_width`, measured across their heading."""
    return [p for p, (shape, heading) in enumerate(cells) if width_across(shape, heading) < min_width - ROUNDING]


def width_across(shape: BaseGeometry, heading: float) -> float:
    """The extent of a shape at right angles to a heading."""
    across = shapely.get_coordinates(shape) @ np.array([np.cos(heading), np.sin(heading)])
    return float(np.ptp(across))


def prune_by_reachability(
    region: BaseGeometry, goal: BaseGeometry, speed: float, time: float, within: BaseGeometry | None = None, steps: int = 16
) -> Shape:  # fmt: skip
    """R ∩ dilate(goal, S T) (paragraph "Pruning Based on Reachability"); with `within`, only along paths inside that container.

    Assumes: X's centre must enter `goal` within `time` (T, seconds), starts in `region`, and moves at most at `speed` (S, metres per
    second); with `within` (C), it stays in C all the time. A path of length D in C is `steps` pieces of length D / steps that begin and end in
    C, so the starts are among the points got by dilating and clipping that often; more steps keep fewer points.
    """
    reach = speed * time
    if within is None:
        return common_part(region, dilate(goal, reach))
    reached = common_part(dilate(goal, 0.0), dilate(within, 0.0))
    for _ in range(steps):
        reached = common_part(dilate(reached, reach / steps), dilate(within, 0.0))
    return common_part(region, reached)


def prune_by_offset(
    cells: Sequence[Cell], target: BaseGeometry, across: Interval, along: Interval, deviation: float, slack: float
) -> Shape:  # fmt: skip
    """The points from which a point at a known offset can lie in `target`: the configuration space of one pair.

    NON-SPEC: sharper than the paper's techniques, which know a distance only; dilate(Q, M) becomes the sum of Q and the offsets.
    Assumes: X lies in a polygon of the map, with a heading that differs from the polygon's by at most `deviation`; a point of the
    configuration lies in `target`, `across` metres to the right of X and `along` metres ahead, as X is headed, up to `slack` metres.
    """
    blur = slack + ROUNDING + deviation * float(np.hypot(across.largest, along.largest))
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(target))
    tree = shapely.STRtree(pieces)
    kept: list[Shape] = []
    for shape, heading in cells:
        back = -_rectangle(across, along) @ _rotation(heading).T
        hits = pieces[tree.query(dilate(_hull_of_sums(shape, -back), blur), predicate="intersects")]
        starts = union_of([_hull_of_sums(piece, back) for piece in hits])
        kept.append(common_part(shape, dilate(starts, blur)))
    return union_of(kept)


def _rectangle(across: Interval, along: Interval) -> np.ndarray:
    return np.array([[x, y] for x in across for y in along])


def _rotation(heading: float) -> np.ndarray:
    return np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])


def _hull_of_sums(shape: BaseGeometry, offsets: np.ndarray) -> Shape:
    """The convex hull of the sums of a shape's points and some offsets, (n, 2): for a convex shape, its sum with their hull."""
    sums = (shapely.get_coordinates(shape)[:, None] + offsets[None]).reshape(-1, 2)
    return polygons_of(MultiPoint(sums).convex_hull)


__all__ = [
    "Cell", "narrow", "polygons_of", "prune_by_containment", "prune_by_heading", "prune_by_offset", "prune_by_reachability",
    "prune_by_width", "width_across",
]

