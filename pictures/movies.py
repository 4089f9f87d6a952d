"""Simulations as animations (GIF), seen from above, in real time."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..data.simulation import Simulated
from ..semantics.space.geometry import corners, direction
from ..semantics.space.vectors import Vector
from ..semantics.store.errors import UsageError
from .map_layers import draw_site
from .scene_figures import CROWD, EGO, FARTHEST, INK, MARGIN, Window, colours_by_class, draw_land, draw_scale

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL.Image import Image

RATE = 25
"""The most frames per second of the simulation."""
MOST_FRAMES = 1000
"""A longer simulation is shown with fewer frames per second."""
HOLD, LONGEST = 100, 65_535
"""How long the last frame is held, and the longest that the format can hold one, in its unit of 10 ms."""
LONG_SIDE, SHORT_SIDE = 6.4, 3.2
"""The longer side of the map in inches, and the least of the shorter one."""
HEAD = 0.8
"""Inches for the title and the time."""
DPI = 100
LONGEST_TITLE = 50


class Frame(NamedTuple):
    """A time step that is shown, and for how long, in milliseconds."""

    step: int
    duration: int


class Course(NamedTuple):
    """An object: its label, to its left or right, colour and size, and in each time step its position and heading (None: it is not there yet)."""

    label: str
    side: str
    colour: str
    width: float
    length: float
    poses: tuple[tuple[Vector, float] | None, ...]


class Artists(NamedTuple):
    """The artists of an object: they alone are drawn anew in each frame."""

    course: Course
    artists: tuple[Artist, ...]


def frames_of(simulation: Simulated) -> list[Frame]:
    """The time steps that are shown, for as long as they take: the first, some between, the last."""
    last = simulation.moments[-1].step
    stride = max(1, math.ceil(1 / (RATE * simulation.timestep) - 1e-9), math.ceil(last / (MOST_FRAMES - 1)))
    steps = [*range(0, last, stride), last]
    ends = [round(min(step * simulation.timestep, 1e9) * 100) for step in steps]
    durations = [min(max(after - before, 2), LONGEST) for before, after in pairwise(ends)]
    return [Frame(step, 10 * duration) for step, duration in zip(steps, [*durations, HOLD])]


def movie(simulation: Simulated, title: str, on_frame: Callable[[], None] = lambda: None) -> bytes:
    """The animation, the same bytes every time. Raises `UsageError` where nothing can be drawn."""
    courses = courses_of(simulation)
    window = window_around(courses)
    canvas, axes = stage(window, title, simulation)
    time = canvas.figure.text(0.5, 0.02, "", ha="center", va="bottom", fontsize=9, color=INK, animated=True)
    drawn = [artists_of(axes, course, window) for course in courses]
    canvas.draw()
    empty = canvas.copy_from_bbox(canvas.figure.bbox)

    def image(step: int) -> Image:
        canvas.restore_region(empty)  # type: ignore[attr-defined]
        for one in drawn:
            place(one, step, window)
        for layer in zip(*(one.artists for one in drawn)):
            for artist in layer:
                axes.draw_artist(artist)
        time.set_text(f"time step {step:,}, {step * simulation.timestep:.2f} s")
        canvas.figure.draw_artist(time)
        return image_of(canvas)

    frames = frames_of(simulation)
    palette = palette_of([image(frames[k].step) for k in sorted({0, len(frames) // 2, len(frames) - 1})])
    return gif_bytes((image(frame.step) for frame in frames), palette, [frame.duration for frame in frames], on_frame)


def courses_of(simulation: Simulated) -> list[Course]:
    """Return the course of each object; a property that the simulator does not report keeps its value."""
    scene = simulation.scene
    things = [(o.name or "", o.class_name, o.position, o.heading, o.width, o.length) for o in scene.objects]
    for body in simulation.created:
        own = (body.properties[name] for name in ("position", "heading", "width", "length"))
        things.append(("", body.class_name, *own))  # type: ignore[arg-type]
    colours = colours_by_class(kind for id, (_, kind, *_) in enumerate(things) if id != scene.ego_id)
    found = []
    middle = sum(thing[2].x for thing in things) / len(things)
    for id, (name, kind, position, heading, width, length) in enumerate(things):
        colour = EGO if id == scene.ego_id else colours[kind]
        poses = tuple(pose_in(moment.objects[id], position, heading) if id < len(moment.objects) else None for moment in simulation.moments)
        label = name if len(things) <= CROWD else ""
        found.append(Course(label, "right" if position.x >= middle - 1e-9 else "left", colour, float(width), float(length), poses))
    return found


def pose_in(pose: Mapping[str, object], position: object, heading: object) -> tuple[Vector, float]:
    """Position and heading in a time step."""
    return pose.get("position", position), float(pose.get("heading", heading))  # type: ignore[return-value, arg-type]


def window_around(courses: Sequence[Course]) -> Window:
    """Return the window that holds all objects in all time steps, with a margin. Raises `UsageError`."""
    points = np.array([(p.x, p.y) for c in courses for pose in c.poses if pose is not None for p in corners(*pose, c.width, c.length)])
    if not np.all(np.abs(points) < FARTHEST):
        raise UsageError(f"the simulation cannot be drawn: it has coordinates of {FARTHEST:g} m or more")
    (west, south), (east, north) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    extent = max(east - west, north - south)
    margin = min(MARGIN, max(0.25 * extent, 1e-3))
    least = (extent + 2 * margin) * SHORT_SIDE / LONG_SIDE
    across, along = max(east - west + 2 * margin, least) / 2, max(north - south + 2 * margin, least) / 2
    x, y = (west + east) / 2, (south + north) / 2
    return x - across, y - along, x + across, y + along


def stage(window: Window, title: str, simulation: Simulated) -> tuple[FigureCanvasAgg, Axes]:
    """The picture without the objects: axes that hold the window, the workspace, a scale."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    west, south, east, north = window
    scale = LONG_SIDE / max(east - west, north - south)
    width, height = max((east - west) * scale, SHORT_SIDE) + 0.7, (north - south) * scale + HEAD
    figure = Figure(figsize=(width, height), dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.55 / width, 0.5 / height, 1 - 0.7 / width, 1 - HEAD / height))
    axes.set_xlim(west, east)
    axes.set_ylim(south, north)
    axes.set_title(title if len(title) <= LONGEST_TITLE else f"...{title[3 - LONGEST_TITLE:]}", fontsize=9, color=INK)
    axes.tick_params(labelsize=8, colors="#777777", length=2)
    axes.locator_params(nbins=4)
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.set_facecolor("#fbfbfa")
    for spine in axes.spines.values():
        spine.set_edgecolor("#bbbbbb")
    draw_land(axes, simulation.scene.workspace, window)
    draw_site(axes, simulation.scene.site, window)
    draw_scale(axes, window, 9)
    return canvas, axes


def artists_of(axes: Axes, course: Course, window: Window) -> Artists:
    """The box of an object, a mark from its middle to its front, a point if the box is small, and its name."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import Polygon

    box = Polygon([(0, 0)] * 4, closed=True, facecolor=to_rgba(course.colour, 0.6), edgecolor=course.colour, linewidth=1.1, animated=True)
    axes.add_patch(box)
    (mark,) = axes.plot([], [], color=INK, linewidth=1.1, solid_capstyle="butt", animated=True)
    (point,) = axes.plot([], [], marker="o", markersize=3, color=course.colour, animated=True)
    towards = "left" if course.side == "right" else "right"
    name = axes.text(0, 0, course.label, ha=towards, va="center", fontsize=8, color=INK, clip_on=True, animated=True)
    return Artists(course, (box, mark, point, name))


def place(one: Artists, step: int, window: Window) -> None:
    """Put the artists of an object where it is in a time step."""
    box, mark, point, name = one.artists
    course = one.course
    pose = course.poses[step]
    for artist in one.artists:
        artist.set_visible(pose is not None)
    if pose is None:
        return
    west, south, east, north = window
    across = max(east - west, north - south)
    (x, y), heading = pose
    outline = [(c.x, c.y) for c in corners(*pose, course.width, course.length)]
    ahead = direction(heading)
    reach = course.length / 2 if course.length > 0 else across / 30
    box.set_xy(outline)  # type: ignore[attr-defined]
    mark.set_data([x, x + ahead.x * reach], [y, y + ahead.y * reach])  # type: ignore[attr-defined]
    small = max(course.width, course.length) < across / 60
    point.set_data([x] if small else [], [y] if small else [])  # type: ignore[attr-defined]
    edge = max(x for x, _ in outline) + across / 100 if course.side == "right" else min(x for x, _ in outline) - across / 100
    name.set_position((edge, y))  # type: ignore[attr-defined]


def image_of(canvas: FigureCanvasAgg) -> Image:
    """Return the current content of the canvas as an independent image."""
    from PIL import Image

    return Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())


def palette_of(images: Sequence[Image]) -> Image:
    """An image with the colours of some."""
    from PIL import Image

    wide = Image.fromarray(np.concatenate([np.asarray(image) for image in images]))
    return wide.quantize(255, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def gif_bytes(images: Iterator[Image], palette: Image, durations: Sequence[int], on_frame: Callable[[], None]) -> bytes:
    """The images as a GIF that is repeated for ever; each is made when its turn comes."""
    from PIL.Image import Dither

    def flat() -> Iterator[Image]:
        for image in images:
            yield image.quantize(palette=palette, dither=Dither.NONE)
            on_frame()

    out, flats = io.BytesIO(), flat()
    next(flats).save(out, format="GIF", save_all=True, append_images=flats, duration=list(durations), loop=0, optimize=False)
    return out.getvalue()
