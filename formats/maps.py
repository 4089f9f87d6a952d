"""Maps below pictures of scenes and of themselves: areas, and the direction of traffic."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..roads.network import Network, NetworkElement
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
    """What of a map meets the window: areas, what is on top last, and the direction of lanes."""
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
