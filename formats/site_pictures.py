"""Maps of one's own as pictures, seen from above: areas with their directions, lines, points, and names."""

from __future__ import annotations

import math

import numpy as np
import shapely

from ..roads.user_maps import SiteMap
from .pictures import CLASSES, INK, bounds_of_shape, check_format, draw_scale, new_figure, shortened, written

SITE_SIZE = 8.0
"""Inches of the longer side."""


def site_picture(site: SiteMap, *, format: str = "png") -> bytes:
    """The map in a format of `pictures`. Raises `UsageError` for another one."""
    from matplotlib.patheffects import withStroke

    check_format(format)
    west, south, east, north = window = bounds_of_shape([feature.shape for feature in site.features])
    figure = new_figure(max(3.0, SITE_SIZE * min(1.0, (east - west) / (north - south))), max(3.0, SITE_SIZE * min(1.0, (north - south) / (east - west))))
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
            label = axes.annotate(shortened(feature.name), (place.x, top), (0, up), textcoords="offset points", ha="center", fontsize=8, color=INK)
            label.set_path_effects([withStroke(linewidth=2, foreground="white")])
    draw_scale(axes, window, 9)
    return written(figure, format)
