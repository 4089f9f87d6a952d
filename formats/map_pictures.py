"""Maps as pictures, seen from above: lanes with their direction, intersections, sidewalks, crosswalks, signals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from ..roads.network import Network
from ..semantics.space.vectors import Vector
from .maps import BIKE, JUNCTION, LINE, ROAD, SHOULDER, SIGNAL, WALK, draw_areas, draw_arrows
from .pictures import INK, check_format, draw_scale, new_figure, written

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
    return written(figure, format)


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
