"""Maps as pictures, seen from above: road networks, and maps of one's own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from ..roads.network import Network
from ..roads.user_maps import SiteMap
from ..semantics.space.vectors import Vector
from .map_layers import BIKE, JUNCTION, LINE, ROAD, SHOULDER, SIGNAL, WALK, draw_areas, draw_arrows
from .scene_figures import (
    CLASSES,
    INK,
    bounds_of_shape,
    check_format,
    draw_scale,
    figure_bytes,
    new_figure,
    shorten_name,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MAP_SIZE = 9.0
"""Inches of the longer side."""
ARROWS_OF_MAP = 40
"""About so many arrows fit along the longer side."""
LEGEND = (("lanes", ROAD), ("intersections", JUNCTION), ("sidewalks", WALK), ("shoulders", SHOULDER), ("bike lanes", BIKE))


def map_picture(network: Network, *, format: str = "png") -> bytes:
    """The map in a format of `pictures`. Raises `UsageError` for another one."""
    check_format(format)
    west, south, east, north = shapely.total_bounds([element.polygon for element in network.by_uid.values()])
    margin = 0.03 * max(east - west, north - south)
    window = (west - margin, south - margin, east + margin, north + margin)
    width, height = window[2] - window[0], window[3] - window[1]
    figure = new_figure(max(3.0, MAP_SIZE * min(1.0, width / height)), max(3.0, MAP_SIZE * min(1.0, height / width)) + 0.4)
    axes = figure.add_subplot()
    axes.set(xlim=(window[0], window[2]), ylim=(window[1], window[3]), aspect="equal", xticks=[], yticks=[])
    across = max(width, height)
    draw_areas(axes, network, window)
    draw_arrows(axes, network, window, across / ARROWS_OF_MAP)
    draw_signals(axes, network, across)
    draw_scale(axes, window, 9)
    draw_legend(axes, network)
    return figure_bytes(figure, format)


def draw_signals(axes: Axes, network: Network, across: float) -> None:
    """Traffic lights as dots."""
    lights: Sequence[Vector] = [signal.position for signal in network.signals if signal.isTrafficLight]
    if lights:
        x, y = np.array([tuple(p) for p in lights]).T
        axes.scatter(x, y, s=max(4.0, 60 / math.sqrt(across / 50)), color=SIGNAL, linewidths=0, zorder=5)


def draw_legend(axes: Axes, network: Network) -> None:
    """Draw the legend of the kinds of features that the network has."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    present = (network.roads, network.intersections, network.sidewalks, network.shoulders, network.bikeLanes)
    handles: list[object] = [Patch(facecolor=colour, label=label) for (label, colour), found in zip(LEGEND, present, strict=True) if found]
    if network.crossings:
        handles.append(Patch(facecolor=LINE, edgecolor=INK, label="crosswalks"))
    if any(signal.isTrafficLight for signal in network.signals):
        handles.append(Line2D([], [], color=SIGNAL, marker="o", linestyle="", markersize=4, label="traffic lights"))
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=8)  # type: ignore[union-attr]


SITE_SIZE = 8.0
"""Inches of the longer side."""


def site_picture(site: SiteMap, *, format: str = "png") -> bytes:
    """The map in a format of `pictures`. Raises `UsageError` for another one."""
    from matplotlib.patheffects import withStroke

    check_format(format)
    west, south, east, north = window = bounds_of_shape([feature.shape for feature in site.features])
    figure = new_figure(
        max(3.0, SITE_SIZE * min(1.0, (east - west) / (north - south))), max(3.0, SITE_SIZE * min(1.0, (north - south) / (east - west)))
    )
    axes = figure.add_subplot()
    axes.set(xlim=(west, east), ylim=(south, north), aspect="equal")
    axes.tick_params(labelsize=8, colors="#777777", length=2)
    axes.ticklabel_format(useOffset=False, style="plain")
    colours = {name: CLASSES[k % len(CLASSES)] for k, name in enumerate(site.names())}
    for feature in sorted(site.features, key=lambda feature: -feature.shape.area):
        colour = colours.get(feature.name or "", "#999999")
        for polygon in feature.polygons:
            ring = np.asarray(polygon.exterior.coords)
            axes.fill(*ring.T, facecolor=(colour, 0.25), edgecolor=colour, linewidth=1.0)
            for hole in polygon.interiors:
                axes.fill(*np.asarray(hole.coords).T, facecolor="white", edgecolor=colour, linewidth=1.0)
        if feature.kind == "lines":
            for line in feature.parts:
                axes.plot(*shapely.get_coordinates(line).T, color=colour, linewidth=2.0)
        if feature.kind == "points":
            axes.scatter(*shapely.get_coordinates(feature.shape).T, s=18, color=colour)
        place = feature.shape.representative_point()
        if feature.kind == "areas" and feature.heading is not None:
            length = math.sqrt(feature.shape.area) / 6
            x, y = -math.sin(feature.heading) * length, math.cos(feature.heading) * length
            axes.annotate("", (place.x + x, place.y + y), (place.x - x, place.y - y), arrowprops={"arrowstyle": "->", "color": INK})
        if feature.name is not None:
            top, up = (feature.shape.bounds[3], -11) if feature.kind == "areas" else (place.y, 6)
            label = axes.annotate(shorten_name(feature.name), (place.x, top), (0, up), textcoords="offset points", ha="center", fontsize=8, color=INK)
            label.set_path_effects([withStroke(linewidth=2, foreground="white")])
    draw_scale(axes, window, 9)
    return figure_bytes(figure, format)

