"""A map of one's own below pictures of scenes: its areas, lines and points in faint colours, which do not compete with objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..roads.user_maps import FEATURES, SITE, SiteMap
from ..semantics.kernel.config import State
from .maps import Window, fill

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FAINT = ("#d9eaf3", "#d9f0ea", "#f7ebf2", "#fbf1d9", "#e6f4fc", "#e6e6e6")
DIM = ("#8cc0dc", "#8cd3c0", "#e8c3d7", "#f4d48c", "#b3ddf5", "#b2b2b2")
"""The colours that `scenic-ref map` gives to features by name, mixed with white: for areas, and for lines, points and edges."""
UNNAMED = ("#ececea", "#b9b9b4")
LINE_WIDTH, POINT_SIZE = 1.6, 2.6
FINENESS = 1500
"""Features are drawn to this part of the width of a window."""
MOST_POINTS = 10_000
"""So many points are drawn at most."""
KINDS = ("areas", "lines", "points")


class Laid(NamedTuple):
    """A feature inside a window, simplified, and its colours; its name ("" if it has none), and the direction of an area that has one."""

    kind: str
    shape: BaseGeometry
    faint: str
    dim: str
    name: str = ""
    heading: float | None = None


def site_of(state: State) -> SiteMap | None:
    """The map that a program with the model `site_map` is on."""
    module = state.settings.library.get(FEATURES)
    found = module.get(SITE) if isinstance(module, Mapping) else None
    return found if isinstance(found, SiteMap) else None


def laid(site: SiteMap | None, window: Window) -> list[Laid]:
    """What a window shows of a map, large areas first, then lines and points; nothing without a map. The workspace is drawn by itself."""
    if site is None:
        return []
    order = {name: k % len(FAINT) for k, name in enumerate(site.names())}
    box = shapely.box(*window)
    features = [feature for feature in site.features if feature.name != "workspace"]
    seen = [features[k] for k in np.flatnonzero(shapely.intersects([feature.shape for feature in features], box))]
    colours = [UNNAMED if feature.name is None else (FAINT[order[feature.name]], DIM[order[feature.name]]) for feature in seen]
    clipped = shapely.simplify([shapely.intersection(feature.shape, box) for feature in seen], (window[2] - window[0]) / FINENESS)
    found = [
        Laid(feature.kind, shape, *pair, feature.name or "", feature.heading if feature.kind == "areas" else None)
        for feature, shape, pair in zip(seen, clipped, colours, strict=True)
    ]
    return sorted(drawable_features(found), key=lambda one: (KINDS.index(one.kind), -one.shape.area))


def drawable_features(found: list[Laid]) -> Iterator[Laid]:
    """Those that may be drawn: the largest ones, where there are too many."""
    points = 0
    for one in sorted(found, key=lambda one: (-one.shape.area, -one.shape.length)):
        points += int(shapely.get_num_coordinates(one.shape))
        if points <= MOST_POINTS and not one.shape.is_empty:
            yield one


def draw_site(axes: Axes, site: SiteMap | None, window: Window) -> None:
    """What a window shows of a map, above the workspace and below ego's view."""
    for one in laid(site, window):
        if one.kind == "areas":
            fill(axes, [one.shape], one.faint, 0.5, one.dim)
        elif one.kind == "lines":
            for points in lines_in(one.shape):
                axes.plot(*points.T, color=one.dim, linewidth=LINE_WIDTH, solid_capstyle="butt", zorder=0.6)
        else:
            axes.plot(*shapely.get_coordinates(one.shape).T, color=one.dim, linestyle="", marker="o", markersize=POINT_SIZE, zorder=0.7)


def lines_in(shape: BaseGeometry) -> Iterator[np.ndarray]:
    """The points of each line."""
    return (shapely.get_coordinates(part) for part in shapely.get_parts(shape) if isinstance(part, shapely.LineString))
