"""Maps as pictures, seen from above: lanes with their direction, intersections, sidewalks, crosswalks, signals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..maps.network import Network
from ..semantics.space.vectors import Vector
from .pictures import INK, check_format, draw_scale, new_figure, polygons_in, written

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROAD, JUNCTION, WALK, SHOULDER, BIKE, LINE, ARROW, SIGNAL = "#d5d5d1", "#c3c9d3", "#efe7d6", "#e3e3dd", "#d3e4d3", "#ffffff", "#5f6b7a", "#d1495b"
SIZE = 9.0
"""Inches of the longer side."""
ARROWS = 40
"""About so many arrows fit along the longer side."""
LEGEND = (("lanes", ROAD), ("intersections", JUNCTION), ("sidewalks", WALK), ("shoulders", SHOULDER), ("bike lanes", BIKE))


def map_picture(network: Network, *, format: str = "png") -> bytes:
    """The map in a format of `pictures`. Raises `UsageError` for another one."""
    check_format(format)
    west, south, east, north = shapely.total_bounds([element.polygon for element in network.by_uid.values()])
    margin = 0.03 * max(east - west, north - south)
    window = (west - margin, south - margin, east + margin, north + margin)
    width, height = window[2] - window[0], window[3] - window[1]
    figure = new_figure(max(3.0, SIZE * min(1.0, width / height)), max(3.0, SIZE * min(1.0, height / width)) + 0.4)
    axes = figure.add_subplot()
    axes.set(xlim=(window[0], window[2]), ylim=(window[1], window[3]), aspect="equal", xticks=[], yticks=[])
    across = max(width, height)
    draw_areas(axes, network)
    draw_arrows(axes, network, across / ARROWS)
    draw_signals(axes, network, across)
    draw_scale(axes, window, 9)
    draw_legend(axes, network)
    return written(figure, format)


def draw_areas(axes: Axes, network: Network) -> None:
    """Everything that has an area, what is on top last."""
    fill(axes, [e.polygon for e in network.sidewalks], WALK, 0)
    fill(axes, [e.polygon for e in network.shoulders], SHOULDER, 0)
    fill(axes, [e.polygon for e in network.bikeLanes], BIKE, 1)
    fill(axes, [lane.polygon for road in network.roads for lane in road.lanes], ROAD, 1, edge=LINE)
    fill(axes, [e.polygon for e in network.intersections], JUNCTION, 2)
    fill(axes, [e.polygon for e in network.crossings], LINE, 3, edge=INK)


def fill(axes: Axes, shapes: Iterable[BaseGeometry], colour: str, layer: int, edge: str | None = None) -> None:
    """Shapes in one colour."""
    from matplotlib.collections import PathCollection
    from matplotlib.path import Path as Outline

    outlines = [
        Outline.make_compound_path(*(Outline(np.asarray(ring.coords)[:, :2], closed=True) for ring in (polygon.exterior, *polygon.interiors)))
        for shape in shapes for polygon in polygons_in(shape)
    ]  # fmt: skip
    axes.add_collection(PathCollection(outlines, facecolors=colour, edgecolors=edge or colour, linewidths=0.4, zorder=layer), autolim=False)


def draw_arrows(axes: Axes, network: Network, apart: float) -> None:
    """The direction of traffic along each lane; through intersections a thin line."""
    from matplotlib.collections import LineCollection

    places: list[Vector] = []
    headings: list[float] = []
    for lane in (lane for road in network.roads for lane in road.lanes):
        line = lane.centerline.polyline
        count = max(1, round(line.length / apart))
        for i in range(count):
            place = line.geoms[0].interpolate((i + 0.5) / count, normalized=True)
            places.append(Vector(place.x, place.y))
            headings.append(lane.centerline.heading_at(places[-1]))
    if places:
        x, y = np.array([tuple(p) for p in places]).T
        u, v = -np.sin(headings), np.cos(headings)
        length = apart * 0.35
        axes.quiver(
            x, y, u * length, v * length, angles="xy", scale_units="xy", scale=1, pivot="middle", color=ARROW, width=length * 0.12, units="xy",
            headwidth=5, headlength=5, headaxislength=4.5, zorder=4,
        )  # fmt: skip
    ways = [[tuple(v) for v in lane.centerline.lines[0]] for road in network.connectingRoads for lane in road.lanes]
    axes.add_collection(LineCollection(ways, colors=ARROW, linewidths=0.5, alpha=0.6, zorder=4), autolim=False)


def draw_signals(axes: Axes, network: Network, across: float) -> None:
    """Traffic lights as dots."""
    lights: Sequence[Vector] = [signal.position for signal in network.signals if signal.isTrafficLight]
    if lights:
        x, y = np.array([tuple(p) for p in lights]).T
        axes.scatter(x, y, s=max(4.0, 60 / math.sqrt(across / 50)), color=SIGNAL, linewidths=0, zorder=5)


def draw_legend(axes: Axes, network: Network) -> None:
    """What the colours mean, of what there is."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    present = (network.roads, network.intersections, network.sidewalks, network.shoulders, network.bikeLanes)
    handles: list[object] = [Patch(facecolor=colour, label=label) for (label, colour), found in zip(LEGEND, present, strict=True) if found]
    if network.crossings:
        handles.append(Patch(facecolor=LINE, edgecolor=INK, label="crosswalks"))
    if any(signal.isTrafficLight for signal in network.signals):
        handles.append(Line2D([], [], color=SIGNAL, marker="o", linestyle="", markersize=4, label="traffic lights"))
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=8)  # type: ignore[union-attr]
