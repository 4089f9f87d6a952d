"""Scenes of two origins as one picture: where the objects are in many scenes of each, side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..semantics.space.geometry import corners, direction
from ..semantics.space.vectors import Vector
from .scene_figures import CLASSES, EGO, FARTHEST, INK, SIDE, figure_bytes, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Box = tuple[float, float, float, float, float]
"""Of an object: x, y (metres), heading (radians), width, length (metres)."""
Boxes = Sequence[Sequence[Box]]
"""The objects of some scenes; ego is the first of each."""
DIGITS = 3
AROUND = 0.08
"""What is left free around the boxes, as a part of the extent."""


def boxes_of(scenes: Sequence[Mapping[str, object]]) -> list[list[Box]]:
    """The boxes in scenes of the scene format, rounded to millimetres; objects whose place is no finite number are left out."""
    return [[box for thing in objects_ego_first(scene) if (box := box_of(thing)) is not None] for scene in scenes]


def objects_ego_first(scene: Mapping[str, object]) -> list[Mapping[str, object]]:
    """The objects of a scene, ego first."""
    objects: list[Mapping[str, object]] = list(scene["objects"])  # type: ignore[call-overload]
    return sorted(objects, key=lambda thing: thing.get("id") != scene.get("ego"))


def box_of(thing: Mapping[str, object]) -> Box | None:
    """The box of an object, if it can be drawn; one without a size is a point."""
    place, heading = thing.get("position"), thing.get("heading")
    if not isinstance(place, (list, tuple)) or len(place) < 2:
        return None
    found = [*place[:2], heading, thing.get("width", 0.0), thing.get("length", 0.0)]
    if not all(isinstance(value, (int, float)) and abs(value) < FARTHEST for value in found):
        return None
    x, y, turned, width, length = (round(float(value), DIGITS) for value in found)
    return x, y, turned, width, length


def side_by_side(sides: Mapping[str, Boxes], *, format: str = "png") -> bytes:
    """A panel for each side, all of the same stretch of land: the boxes of its scenes over each other, ego's in red."""
    figure = new_figure(len(sides) * SIDE, SIDE + 0.3)
    every = [box for scenes in sides.values() for scene in scenes for box in scene]
    points = [c for x, y, turned, width, length in every for c in corners(Vector(x, y), turned, width, length)] or [Vector(0, 0)]
    west, east = min(p.x for p in points), max(p.x for p in points)
    south, north = min(p.y for p in points), max(p.y for p in points)
    half = max(east - west, north - south, 1.0) * (0.5 + AROUND)
    for number, (name, scenes) in enumerate(sides.items()):
        axes = figure.add_subplot(1, len(sides), number + 1)
        axes.set_aspect("equal")
        axes.set_xlim((west + east) / 2 - half, (west + east) / 2 + half)
        axes.set_ylim((south + north) / 2 - half, (south + north) / 2 + half)
        axes.set_title(name if scenes else f"{name}: no scene", fontsize=9, color=INK)
        axes.tick_params(labelsize=7, colors="#777777", length=2)
        axes.locator_params(nbins=4)
        for scene in scenes:
            for place, box in enumerate(scene):
                draw_box(axes, box, EGO if place == 0 else CLASSES[(place - 1) % len(CLASSES)], half, len(scenes))
    return figure_bytes(figure, format)


def draw_box(axes: Axes, box: Box, colour: str, half: float, count: int) -> None:
    """A box with a tick to its front, the fainter the more scenes there are; a point where it is too small to be seen."""
    from matplotlib.patches import Polygon

    x, y, turned, width, length = box
    faint = max(0.08, 0.5 / math.sqrt(count))
    outline = [(c.x, c.y) for c in corners(Vector(x, y), turned, width, length)]
    axes.add_patch(Polygon(outline, closed=True, facecolor=colour, alpha=faint, linewidth=0, zorder=3))
    axes.add_patch(Polygon(outline, closed=True, fill=False, edgecolor=colour, alpha=min(1.0, 2 * faint), linewidth=0.8, zorder=4))
    ahead, reach = direction(turned), max(length / 2, half / 25)
    axes.plot([x, x + ahead.x * reach], [y, y + ahead.y * reach], color=INK, alpha=min(1.0, 2 * faint), linewidth=0.8, zorder=5)
    if max(width, length) < half / 25:
        axes.plot([x], [y], marker="o", markersize=3, color=colour, alpha=min(1.0, 2 * faint), zorder=5)
