"""Contact sheets: moments of simulations side by side, seen from above, with the ways that the objects have come and the lights of the map."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from scenic_ref.data.simulation import Simulated
from scenic_ref.pictures.map_layers import Window, draw_lights, draw_site
from scenic_ref.pictures.movies import Course, courses_of
from scenic_ref.pictures.scene_figures import INK, draw_land, draw_scale, figure_bytes, new_figure
from scenic_ref.roads.network import MapWorkspace
from scenic_ref.semantics.space.geometry import corners, direction

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIDE, HEAD = 2.6, 0.3
"""Inches of a panel, and of its title."""
LEAST, MARGIN = 44.0, 8.0
"""Metres that a panel shows at least, and around what is in it."""
MOST = 70.0
"""Metres from the first object beyond which others need not be seen."""


def contact_sheet(simulation: Simulated, steps: Sequence[int], *, columns: int = 4) -> bytes:
    """The simulation in these time steps, as a picture in the format PNG: the same bytes every time."""
    columns = min(columns, len(steps))
    rows = -(-len(steps) // columns)
    figure = new_figure(columns * SIDE, rows * (SIDE + HEAD))
    courses = courses_of(simulation)
    windows = [window_of(courses, step) for step in steps]
    across = max(east - west for west, _, east, _ in windows)
    for number, (step, (west, south, east, north)) in enumerate(zip(steps, windows, strict=True)):
        x, y = (west + east) / 2, (south + north) / 2
        window = (x - across / 2, y - across / 2, x + across / 2, y + across / 2)
        draw_moment(figure.add_subplot(rows, columns, number + 1), simulation, courses, step, window)
    return figure_bytes(figure, "png")


def window_of(courses: Sequence[Course], step: int) -> Window:
    """A square around the first object and those that are near it."""
    poses = [course.poses[step] for course in courses]
    [(first, _), *_] = [pose for pose in poses if pose is not None]
    near = [pose[0] for pose in poses if pose is not None and math.hypot(pose[0].x - first.x, pose[0].y - first.y) < MOST]
    west, east = min(p.x for p in near), max(p.x for p in near)
    south, north = min(p.y for p in near), max(p.y for p in near)
    half = max(LEAST, max(east - west, north - south) + 2 * MARGIN) / 2
    x, y = (west + east) / 2, (south + north) / 2
    return x - half, y - half, x + half, y + half


def draw_moment(axes: Axes, simulation: Simulated, courses: Sequence[Course], step: int, window: Window) -> None:
    """Draw the objects of one time step."""
    west, south, east, north = window
    seconds = step * simulation.timestep
    axes.set(xlim=(west, east), ylim=(south, north), aspect="equal", xticks=[], yticks=[], facecolor="#fbfbfa")
    axes.set_title(f"{seconds:.1f} s", fontsize=8, color=INK)
    for spine in axes.spines.values():
        spine.set_edgecolor("#bbbbbb")
    land = simulation.scene.workspace
    draw_land(axes, land, window)
    draw_site(axes, simulation.scene.site, window)
    if isinstance(land, MapWorkspace):
        draw_lights(axes, land.network, window, seconds)
    for course in courses:
        draw_course(axes, course, step)
    draw_scale(axes, window, 7)


def draw_course(axes: Axes, course: Course, step: int) -> None:
    """An object, and the way that it has come."""
    from matplotlib.patches import Polygon

    pose = course.poses[step]
    if pose is None:
        return
    way = [past[0] for past in course.poses[: step + 1] if past is not None]
    axes.plot([p.x for p in way], [p.y for p in way], color=course.colour, linewidth=1.0, alpha=0.5, zorder=5)
    (x, y), heading = pose
    ahead = direction(heading) * (course.length / 2)
    box = [(c.x, c.y) for c in corners(*pose, course.width, course.length)]
    axes.add_patch(Polygon(box, closed=True, facecolor=course.colour, edgecolor=INK, linewidth=0.5, alpha=0.9, zorder=6))
    axes.plot([x, x + ahead.x], [y, y + ahead.y], color=INK, linewidth=0.9, solid_capstyle="butt", zorder=7)
