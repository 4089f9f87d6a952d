"""Maps as pictures and below pictures of scenes: areas, lanes with their direction, and the names of a map of one's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..roads.network import Network, NetworkElement
from ..roads.user_maps import FEATURES, SITE, SiteMap
from ..semantics.machine.config import State
from ..semantics.space.vectors import Vector

if TYPE_CHECKING:
    from matplotlib.axes import Axes


ROAD, JUNCTION, WALK, SHOULDER, BIKE, LINE, ARROW, SIGNAL = "#d5d5d1", "#c3c9d3", "#efe7d6", "#e3e3dd", "#d3e4d3", "#ffffff", "#5f6b7a", "#d1495b"
MAP_INK = "#222222"
LIGHTS = {"green": "#2ca02c", "yellow": "#f2c014", "red": "#d62728", "off": "#888888"}
ARROWS_OF_SCENE = 8
"""About so many arrows fit across the picture of a scene."""

Window = tuple[float, float, float, float]
"""West, south, east, north."""


def draw_map(axes: Axes, network: Network, window: Window) -> None:
    """Draw the part of a road network in the window: areas, the topmost last, and the direction of lanes."""
    draw_areas(axes, network, window)
    draw_arrows(axes, network, window, max(window[2] - window[0], window[3] - window[1]) / ARROWS_OF_SCENE)


class Areas(NamedTuple):
    """Shapes of one kind, the colours of their inside and their edge, and the layer on which they lie."""

    shapes: list[BaseGeometry]
    colour: str
    layer: int
    edge: str | None = None


def areas_of(network: Network, window: Window) -> Iterator[Areas]:
    """Everything that has an area and meets the window, what is on top last."""
    box = shapely.box(*window)

    def seen(elements: Iterable[NetworkElement]) -> list[BaseGeometry]:
        return [e.polygon for e in elements if box.intersects(e.polygon)]

    yield Areas(seen(network.sidewalks), WALK, 0)
    yield Areas(seen(network.shoulders), SHOULDER, 0)
    yield Areas(seen(network.bikeLanes), BIKE, 1)
    yield Areas(seen(lane for road in network.roads for lane in road.lanes), ROAD, 1, LINE)
    yield Areas(seen(network.intersections), JUNCTION, 2)
    yield Areas(seen(network.crossings), LINE, 3, MAP_INK)


def draw_areas(axes: Axes, network: Network, window: Window) -> None:
    """Everything that has an area, what is on top last."""
    for shapes, colour, layer, edge in areas_of(network, window):
        fill(axes, shapes, colour, layer, edge)


def fill(axes: Axes, shapes: Iterable[BaseGeometry], colour: str, layer: float, edge: str | None = None) -> None:
    """Shapes in one colour."""
    from matplotlib.collections import PathCollection
    from matplotlib.path import Path as Outline

    outlines = [
        Outline.make_compound_path(*(Outline(np.asarray(ring.coords)[:, :2], closed=True) for ring in (polygon.exterior, *polygon.interiors)))
        for shape in shapes for polygon in polygons_in(shape)
    ]  # fmt: skip
    axes.add_collection(PathCollection(outlines, facecolors=colour, edgecolors=edge or colour, linewidths=0.4, zorder=layer), autolim=False)


def arrows_of(network: Network, window: Window, apart: float) -> Iterator[tuple[Vector, float]]:
    """Places along each lane inside the window, so far apart in metres, and the direction of traffic there."""
    west, south, east, north = window
    for lane in (lane for road in network.roads for lane in road.lanes):
        line = lane.centerline.polyline
        count = max(1, round(line.length / apart))
        for i in range(count):
            place = line.geoms[0].interpolate((i + 0.5) / count, normalized=True)
            if west <= place.x <= east and south <= place.y <= north:
                found = Vector(place.x, place.y)
                yield found, lane.centerline.heading_at(found)


def ways_of(network: Network) -> list[list[tuple[float, ...]]]:
    """The lines along which one drives through intersections."""
    return [[tuple(v) for v in lane.centerline.lines[0]] for road in network.connectingRoads for lane in road.lanes]


def draw_arrows(axes: Axes, network: Network, window: Window, apart: float) -> None:
    """The direction of traffic along each lane; through intersections a thin line."""
    from matplotlib.collections import LineCollection

    found = list(arrows_of(network, window, apart))
    if found:
        headings = [heading for _, heading in found]
        x, y = np.array([tuple(p) for p, _ in found]).T
        u, v = -np.sin(headings), np.cos(headings)
        length = apart * 0.35
        axes.quiver(
            x, y, u * length, v * length, angles="xy", scale_units="xy", scale=1, pivot="middle", color=ARROW, width=length * 0.12, units="xy",
            headwidth=5, headlength=5, headaxislength=4.5, zorder=4,
        )  # fmt: skip
    axes.add_collection(LineCollection(ways_of(network), colors=ARROW, linewidths=0.5, alpha=0.6, zorder=4), autolim=False)


def draw_lights(axes: Axes, network: Network, window: Window, seconds: float) -> None:
    """The traffic lights as they are by plan, so many seconds after the beginning: a dot beside the line before which their lane waits."""
    west, south, east, north = window
    lights = {lane._trafficLight for lane in network.lanes if lane._trafficLight is not None}
    seen = [(s.position, LIGHTS[s.stateAt(seconds)]) for s in network.signals if s in lights]
    shown = [(place.x, place.y, colour) for place, colour in seen if west <= place.x <= east and south <= place.y <= north]
    if shown:
        x, y, colours = zip(*shown, strict=True)
        axes.scatter(x, y, s=22, c=colours, edgecolors=MAP_INK, linewidths=0.5, zorder=8)


def polygons_in(shape: BaseGeometry) -> list[shapely.Polygon]:
    """The polygons that a shape consists of."""
    return [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon) and not part.is_empty]


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
    """Return the largest features, at most `MOST_MARKS`."""
    return sorted(found, key=lambda one: (-one.shape.area, -one.shape.length))[:MOST_MARKS]


def visible(one: Laid, found: Sequence[Laid]) -> BaseGeometry:
    """Return the part of a feature that areas drawn later leave visible."""
    if one.kind != "areas":
        return one.shape
    later = [other.shape for other in found[found.index(one) + 1 :] if other.kind == "areas"]
    over = np.flatnonzero(shapely.intersects(one.shape, later)).tolist()
    return shapely.difference(one.shape, shapely.union_all([later[k] for k in over]))


def spots(kind: str, shape: BaseGeometry, window: Window, height: float) -> np.ndarray:
    """Return candidate centres for a mark of a feature, (n, 2) in metres."""
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
    """Return the window that a text of some size covers when it is centred at a place."""
    (x, y), (width, height) = place, size
    return x - width / 2, y - height / 2, x + width / 2, y + height / 2


__all__ = ["Mark", "marks"]


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


def map_features_in(site: SiteMap | None, window: Window) -> list[Laid]:
    """Return the features of a map in a window, large areas first, then lines and points; none without a map.
    The workspace is drawn separately.
    """
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
    """Yield the features that may be drawn: the largest ones, if together they have too many points."""
    points = 0
    for one in sorted(found, key=lambda one: (-one.shape.area, -one.shape.length)):
        points += int(shapely.get_num_coordinates(one.shape))
        if points <= MOST_POINTS and not one.shape.is_empty:
            yield one


def draw_site(axes: Axes, site: SiteMap | None, window: Window) -> None:
    """Draw the features of a map in a window, above the workspace and below ego's view."""
    for one in map_features_in(site, window):
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

