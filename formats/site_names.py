"""Where the names and directions of a map of one's own stand in a picture of a scene: inside of what they belong to, and clear of everything else."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from .maps import Window
from .site_land import Laid

MOST_MARKS = 24
"""So many names, and so many directions, are shown at most: those of the largest features."""
CELLS = 40
"""A place is one of so many times so many in the window."""
ALONG = np.linspace(0.02, 0.98, 25)
"""The places beside a line, as parts of its length."""
NAME_ARROW = 0.05
"""The length of an arrow, as part of the width of the window."""


class Mark(NamedTuple):
    """A name, or an arrow if that is empty, its centre and, for an arrow, its two parts."""

    text: str
    x: float
    y: float
    ahead: tuple[float, float] = (0.0, 0.0)


def marks(found: Sequence[Laid], window: Window, taken: Sequence[Window], width_of: Callable[[str], float], height: float) -> list[Mark]:
    """The marks, in whatever order; `found` are the features in the order in which they are drawn, `taken` is where something stands already.

    A mark for which there is no clear place is left out.
    """
    used, made = list(taken), list[Mark]()
    for one in largest_features([one for one in found if one.name]):
        size = width_of(one.name), height
        if (spot := clear(spots(one.kind, visible(one, found), window, height), size, used, window)) is not None:
            made.append(Mark(one.name, *spot))
            used.append(room(spot, size))
    length = NAME_ARROW * (window[2] - window[0])
    for one in largest_features([one for one in found if one.heading is not None]):
        if (spot := clear(spots(one.kind, visible(one, found), window, height), (length, length), used, window)) is not None:
            assert one.heading is not None
            made.append(Mark("", *spot, (-math.sin(one.heading) * length / 2, math.cos(one.heading) * length / 2)))
            used.append(room(spot, (length, length)))
    return made


def largest_features(found: Sequence[Laid]) -> list[Laid]:
    """The largest features."""
    return sorted(found, key=lambda one: (-one.shape.area, -one.shape.length))[:MOST_MARKS]


def visible(one: Laid, found: Sequence[Laid]) -> BaseGeometry:
    """What is seen of a feature below the areas that are drawn later."""
    if one.kind != "areas":
        return one.shape
    later = [other.shape for other in found[found.index(one) + 1 :] if other.kind == "areas"]
    over = np.flatnonzero(shapely.intersects(one.shape, later)).tolist()
    return shapely.difference(one.shape, shapely.union_all([later[k] for k in over]))


def spots(kind: str, shape: BaseGeometry, window: Window, height: float) -> np.ndarray:
    """Where a mark of a feature may have its centre, (n, 2) in metres."""
    above = np.array([0.0, height])
    if kind == "areas":
        x, y = (np.linspace(low, high, CELLS + 2)[1:-1] for low, high in ((window[0], window[2]), (window[1], window[3])))
        grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        inner = shapely.buffer(shape, -0.7 * height, quad_segs=1)
        return grid[shapely.contains_xy(shape if inner.is_empty else inner, *grid.T)]
    if kind == "lines":
        points = [shapely.line_interpolate_point(part, ALONG, normalized=True) for part in shapely.get_parts(shape) if part.length]
        return shapely.get_coordinates(points) + above
    return shapely.get_coordinates(shape) + above


def clear(places: np.ndarray, size: tuple[float, float], used: Sequence[Window], window: Window) -> tuple[float, float] | None:
    """The place that is farthest from all that is there, where something of this size covers none of it; None if there is no such place."""
    half = np.array(size) / 2
    west, south, east, north = window
    inside = ((places - half >= (west, south)) & (places + half <= (east, north))).all(axis=1)
    places = places[inside]
    boxes = np.array(used, dtype=float).reshape(-1, 4)
    gaps = np.maximum(boxes[:, :2] - (places + half)[:, None], (places - half)[:, None] - boxes[:, 2:])
    away = np.concatenate([gaps.max(axis=2), np.full((len(places), 1), (east - west) / 4)], axis=1).min(axis=1)
    if not len(places) or away.max() <= 0:
        return None
    x, y = places[away.argmax()].tolist()
    return x, y


def room(place: tuple[float, float], size: tuple[float, float]) -> Window:
    """What something of a size takes at a place."""
    (x, y), (width, height) = place, size
    return x - width / 2, y - height / 2, x + width / 2, y + height / 2


__all__ = ["Mark", "marks"]
