"""Scenes as pictures, seen from above. Like `movies`, it imports matplotlib only when a picture is drawn."""

from __future__ import annotations

import io
import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from warnings import catch_warnings, filterwarnings

import numpy as np
import shapely

from ..interpreter.runtime.atomic_files import write_whole
from ..roads.network import MapWorkspace
from ..semantics.space.geometry import corners, direction
from ..semantics.space.regions import Region, everywhere
from ..semantics.space.vectors import Vector
from ..semantics.store.errors import UsageError
from .map_layers import Window, draw_map, draw_site, map_features_in, marks, polygons_in

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure
    from shapely.geometry.base import BaseGeometry

    from ..data.scene import Scene, SceneObject

Outline = Sequence[tuple[float, float]]
FORMATS = ("png", "pdf", "svg")
LAND, EDGE, EGO, INK = "#e4e4e1", "#c2c2bd", "#d55e00", "#222222"
CLASSES = ("#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555")
"""Of the objects other than ego, by class: with ego's, the colours of Okabe and Ito, which people of any colour vision tell apart."""
MARGIN = 8.0  # metres around the objects, at most
FARTHEST = 1e9  # metres from the origin that can still be told apart in a picture
CROWD = 8  # with more objects than this, only those with a name are labelled, and colours are explained
SIDE = 3.6  # inches of a small multiple
ALONE = 6.5  # inches of a picture of one scene
QUIET = "#7a7a76"
"""What belongs to the map."""
LETTER, LINE = 0.62, 1.35  # a letter's width and a line's height, in sizes of the font, both with some room
INCH = 72  # points
ARC_STEP = math.radians(2)
CIRCLE_SIDES = 256


def picture(scenes: Iterable[Scene], *, format: str = "png", roads: Region | None = None) -> bytes:
    """The scenes side by side; `roads` is drawn below them in place of their workspaces. Raises `UsageError`."""
    check_format(format)
    return figure_bytes(figure_of(list(scenes), roads), format)


def check_format(format: str) -> None:
    """Raise `UsageError` for a format that no picture has."""
    if format not in FORMATS:
        raise UsageError(f"pictures have the formats {', '.join(FORMATS)}, not {format!r}")


def figure_bytes(figure: Figure, format: str) -> bytes:
    """The figure in a format, the same bytes every time."""
    from matplotlib import rc_context

    out = io.BytesIO()
    metadata = {"png": {"Software": None}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}[format]
    with rc_context({"svg.hashsalt": "scenic-ref"}), catch_warnings():  # names in a picture are drawn at random otherwise
        filterwarnings("ignore", "Glyph .* missing from font")  # a box stands for it
        figure.draw_without_rendering()  # the layout, which is not settled in one pass: titles could be cut off at the edge
        figure.savefig(out, format=format, dpi=150, metadata=metadata)
    return out.getvalue()


def save_picture(scenes: Iterable[Scene], path: str | Path, *, roads: Region | None = None) -> None:
    """Write the picture of the scenes, in the format that the path ends in. Raises `UsageError`, `OSError`."""
    write_whole(Path(path), picture(scenes, format=Path(path).suffix[1:].lower(), roads=roads))


def bar_chart(labels: Sequence[str], heights: Sequence[float], title: str, *, format: str = "png") -> bytes:
    """Horizontal bars, one below the other, each with its label and its height in per cent. Raises `UsageError`."""
    check_format(format)
    figure = new_figure(ALONE * 1.3, 1.0 + 0.27 * len(labels))
    axes = figure.add_subplot()
    places = range(len(labels))
    axes.barh(places, heights, color=CLASSES[0], height=0.72)
    for place, height in zip(places, heights, strict=True):
        axes.text(height, place, f" {height:.3%}", va="center", fontsize=8, color=INK)
    axes.set_yticks(list(places), labels, fontsize=8)
    axes.invert_yaxis()
    axes.set_xlim(0, max(heights, default=1.0) * 1.15)
    axes.xaxis.set_visible(False)
    axes.set_title(title, fontsize=10, color=INK)
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    return figure_bytes(figure, format)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def multiples_layout(count: int) -> tuple[int, int, float]:
    """The rows and columns of small multiples, and the inches of each."""
    columns = max(1, math.ceil(math.sqrt(count)))
    return max(1, math.ceil(count / columns)), columns, ALONE if count <= 1 else SIDE


def figure_of(scenes: Sequence[Scene], roads: Region | None) -> Figure:
    """The scenes as small multiples, one panel each."""
    rows, columns, side = multiples_layout(len(scenes))
    figure = new_figure(columns * side, rows * (side + 0.3))
    draw_scenes(figure, scenes, roads)
    return figure


def draw_scenes(figure: Figure | SubFigure, scenes: Sequence[Scene], roads: Region | None) -> None:
    """Draw scenes side by side in an existing figure, with the meaning of the colours below."""
    from matplotlib.patches import Patch

    rows, columns, _ = multiples_layout(len(scenes))
    colours = colours_of(scenes)
    views = views_of(scenes)
    for number, (scene, view) in enumerate(zip(scenes, views, strict=True), 1):
        draw(figure.add_subplot(rows, columns, number), scene, roads, colours, view, small=len(scenes) > 1)
    egos = {"ego": EGO} if any(scene.ego_id is not None for scene in scenes) else {}
    patches = [Patch(facecolor=colour, alpha=0.7, label=shorten_name(name)) for name, colour in (egos | colours).items()]
    if any(views):
        patches.append(Patch(facecolor=(EGO, 0.10), edgecolor=(EGO, 0.45), label="what ego can see"))
    if len(patches) > len(egos):
        figure.legend(handles=patches, loc="outside lower center", ncols=min(len(patches), max(5, 3 * columns)), frameon=False, fontsize=8)


def colours_of(scenes: Sequence[Scene]) -> dict[str, str]:
    """The colour of each class of objects other than ego, in order of appearance."""
    return colours_by_class(o.class_name for scene in scenes for o in scene.objects if o.id != scene.ego_id)


def colours_by_class(names: Iterable[str]) -> dict[str, str]:
    """The colour of each class, in order of appearance."""
    return dict(zip(dict.fromkeys(names), itertools.cycle(CLASSES), strict=False))


def draw(axes: Axes, scene: Scene, roads: Region | None, colours: Mapping[str, str], view: Outline = (), *, small: bool) -> None:
    """One scene: its workspace, ego's view if there is one, the objects with their headings and names, and a scale."""
    west, south, east, north = window = window_of(scene)
    axes.set_aspect("equal")
    axes.set_xlim(west, east)
    axes.set_ylim(south, north)
    size = 7 if small else 9
    axes.set_title(f"seed {shorten_name(str(scene.seed))}, scene {shorten_name(str(scene.index))}", fontsize=size + 1, color=INK)
    axes.tick_params(labelsize=size - 1, colors="#777777", length=2)
    axes.locator_params(nbins=4)
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.set_facecolor("#fbfbfa")
    for spine in axes.spines.values():
        spine.set_edgecolor("#bbbbbb")
    draw_land(axes, scene.workspace if roads is None else roads, window)
    draw_site(axes, scene.site, window)
    draw_view(axes, view)
    for o in scene.objects:
        draw_object(axes, o, EGO if o.id == scene.ego_id else colours[o.class_name], east - west)
    taken = draw_names(axes, scene, size, window)
    draw_marks(axes, scene, size, window, taken)
    draw_scale(axes, window, size)


def window_of(scene: Scene) -> Window:
    """A square around all objects and a little of what surrounds them. Raises `UsageError` where no picture can be drawn."""
    points = [c for o in scene.objects for c in corners(o.position, o.heading, o.width, o.length)] or [Vector(0, 0)]
    if not all(abs(p.x) < FARTHEST and abs(p.y) < FARTHEST for p in points):
        raise UsageError(f"scene {scene.index} cannot be drawn: it has coordinates of {FARTHEST:g} m or more")
    west, east = min(p.x for p in points), max(p.x for p in points)
    south, north = min(p.y for p in points), max(p.y for p in points)
    extent = max(east - west, north - south)
    half = 1e-6 + extent / 2 + min(MARGIN, extent * (2.0 if len(scene.objects) == 1 else 0.25)) if extent else MARGIN / 2
    x, y = (west + east) / 2, (south + north) / 2
    return x - half, y - half, x + half, y + half


def bounds_of_shape(shapes: Sequence[BaseGeometry]) -> Window:
    """Return the window that holds all of the shapes, with a margin."""
    west, south, east, north = (float(x) for x in shapely.total_bounds(np.array(shapes, dtype=object)))
    margin = 0.04 * max(east - west, north - south) or 1.0
    return west - margin, south - margin, east + margin, north + margin


def draw_land(axes: Axes, region: object, window: Window) -> None:
    """The part of a region, or of the map, inside the window; nothing if there is no region, or if it is the whole plane."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Rings

    if isinstance(region, MapWorkspace):
        draw_map(axes, region.network, window)
        return
    for polygon in land_in(region, window):
        rings = [polygon.exterior, *polygon.interiors]
        outline = Rings.make_compound_path(*(Rings(np.asarray(ring.coords)[:, :2], closed=True) for ring in rings))
        axes.add_patch(PathPatch(outline, facecolor=LAND, edgecolor=EDGE, linewidth=0.8, zorder=0))


def land_in(region: object, window: Window) -> list[shapely.Polygon]:
    """The part of a region inside the window; nothing if it is the whole plane."""
    if not isinstance(region, Region) or region is everywhere or getattr(region, "region", None) is everywhere:
        return []
    box = shapely.box(*window)
    return polygons_in(shapely.intersection(region.approximate(CIRCLE_SIDES, box).cover, box))


def draw_view(axes: Axes, points: Outline) -> None:
    """Ego's visible region, the sector of its view angle and view distance; nothing where there are no points."""
    from matplotlib.patches import Polygon

    if points:
        axes.add_patch(Polygon(points, closed=True, facecolor=EGO, alpha=0.10, linewidth=0, zorder=1))
        axes.add_patch(Polygon(points, closed=True, fill=False, edgecolor=EGO, alpha=0.45, linewidth=0.7, zorder=1))


def views_of(scenes: Sequence[Scene]) -> list[Outline]:
    """Return ego's view in each of the scenes that are shown together; no views at all if ego sees everything
    in every scene.
    """
    views = [view_of(scene.ego) if scene.ego_id is not None else [] for scene in scenes]
    partly = any(view and not is_all(view, window_of(scene)) for view, scene in zip(views, scenes, strict=True))
    return list(views) if partly else [[] for _ in views]


def is_all(view: Outline, window: Window) -> bool:
    """Whether an object that sees this sees all of the window."""
    return shapely.Polygon(view).buffer(0).covers(shapely.box(*window))


def view_of(ego: SceneObject) -> list[tuple[float, float]]:
    """The outline of what an object sees; nothing if that is not known."""
    reach = ego.properties.get("visibleDistance", ego.properties.get("viewDistance"))  # reading `view-distance`
    distance, angle = nonnegative_number(reach), nonnegative_number(ego.properties.get("viewAngle"))
    if not distance or not angle:
        return []
    x, y = ego.position
    turns = np.linspace(-angle / 2, angle / 2, max(2, math.ceil(angle / ARC_STEP) + 1)) + ego.heading
    arc = [(x - distance * math.sin(t), y + distance * math.cos(t)) for t in turns]
    return arc if angle >= math.tau - 1e-9 else [(x, y), *arc]


def nonnegative_number(value: object) -> float | None:
    """A property as a finite number of at least 0, None if it is something else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    return float(value) if value >= 0 else None


def draw_object(axes: Axes, o: SceneObject, colour: str, across: float) -> None:
    """The box of an object, with a tick from its middle to its front; a point where the box has no size."""
    from matplotlib.patches import Polygon

    x, y = o.position
    box = [(c.x, c.y) for c in corners(o.position, o.heading, o.width, o.length)]
    axes.add_patch(Polygon(box, closed=True, facecolor=colour, alpha=0.55, linewidth=0, zorder=3))
    axes.add_patch(Polygon(box, closed=True, fill=False, edgecolor=colour, linewidth=1.1, joinstyle="miter", zorder=4))
    ahead = direction(o.heading)
    reach = o.length / 2 if o.length > 0 else across / 30
    axes.plot([x, x + ahead.x * reach], [y, y + ahead.y * reach], color=INK, linewidth=1.1, solid_capstyle="butt", zorder=5)
    if max(o.width, o.length) < across / 60:
        axes.plot([x], [y], marker="o", markersize=3, color=colour, zorder=5)


def draw_names(axes: Axes, scene: Scene, size: int, window: Window) -> list[Window]:
    """The name of each object that has one, else its class unless there are many, beside its box and on no other if there is room.

    The rectangles that boxes and names take.
    """
    from matplotlib.patheffects import withStroke

    crowded = len(scene.objects) > CROWD
    named = [o for o in scene.objects if o.name or not crowded]
    point = point_of(window, size)
    boxes = [bounds_of(o) for o in scene.objects]
    taken: list[Window] = []
    for o in named:
        text = shorten_name(o.name or o.class_name)
        spot = room_for(len(text) * LETTER * size * point, LINE * size * point, bounds_of(o), [*boxes, *taken], window)
        taken.append(spot)
        if may_be_mistaken(spot, bounds_of(o), [bounds_of(other) for other in scene.objects if other is not o]):
            draw_leader(axes, spot, o)
        x, y = (spot[0] + spot[2]) / 2, (spot[1] + spot[3]) / 2
        label = axes.text(x, y, text, ha="center", va="center", fontsize=size - 1, color=INK if o.name else "#666666", zorder=6, clip_on=True)
        label.set_path_effects([withStroke(linewidth=2, foreground="white", alpha=0.85)])
    return [*boxes, *taken]


def may_be_mistaken(spot: Window, box: Window, others: Sequence[Window]) -> bool:
    """Whether a name could be that of another object: one that is as near, or nearly."""
    height = spot[3] - spot[1]
    return any(window_distance(spot, other) < window_distance(spot, box) + height / 2 for other in others)


def window_distance(one: Window, other: Window) -> float:
    """The distance of two rectangles."""
    return math.hypot(max(0.0, one[0] - other[2], other[0] - one[2]), max(0.0, one[1] - other[3], other[1] - one[3]))


def draw_leader(axes: Axes, spot: Window, o: SceneObject) -> None:
    """A line from a name to the middle of its object."""
    (x, y), (west, south, east, north) = o.position, spot
    axes.plot([min(max(x, west), east), x], [min(max(y, south), north), y], color=QUIET, linewidth=0.7, solid_capstyle="butt", zorder=5.5)


def point_of(window: Window, size: int) -> float:
    """How many metres one point of a font is."""
    return (window[2] - window[0]) / (INCH * (SIDE if size < 9 else ALONE))


def draw_marks(axes: Axes, scene: Scene, size: int, window: Window, taken: Sequence[Window]) -> None:
    """The names and directions of the features of a map of one's own, where nothing else stands."""
    from matplotlib.patheffects import withStroke

    if scene.site is None:
        return
    point, small = point_of(window, size), size - 2
    west, south, east, north = window
    scale = west, south, west + 0.3 * (east - west), south + 0.1 * (north - south)
    found = marks(
        map_features_in(scene.site, window), window, [*taken, scale], lambda text: len(shorten_name(text)) * LETTER * small * point,
        LINE * small * point
    )
    for mark in found:
        if mark.text:
            label = axes.text(
                mark.x, mark.y, shorten_name(mark.text), ha="center", va="center", fontsize=small, style="italic", color=QUIET, zorder=0.9
            )
            label.set_path_effects([withStroke(linewidth=1.5, foreground="white", alpha=0.85)])
            continue
        x, y = mark.ahead
        ends = (mark.x + x, mark.y + y), (mark.x - x, mark.y - y)
        axes.annotate("", *ends, arrowprops={"arrowstyle": "->", "color": QUIET, "linewidth": 0.8}, zorder=0.9)


def bounds_of(o: SceneObject) -> Window:
    """Return the bounds of an object's box."""
    points = corners(o.position, o.heading, o.width, o.length)
    return min(p.x for p in points), min(p.y for p in points), max(p.x for p in points), max(p.y for p in points)


def room_for(width: float, height: float, box: Window, others: Sequence[Window], window: Window) -> Window:
    """Choose a place for a text beside a box (below, above, right or left of it, or further off) that covers
    least of the others.
    """
    west, south, east, north = box
    x, y, gap = (west + east) / 2, (south + north) / 2, height / 4
    spots = []
    for further in (0.0, height, 2 * height):
        spots += [(x, south - gap - height / 2 - further), (x, north + gap + height / 2 + further)]
        spots += [(east + gap + width / 2 + further, y), (west - gap - width / 2 - further, y)]
    rooms = [(a - width / 2, b - height / 2, a + width / 2, b + height / 2) for a, b in spots]

    def covered(room: Window) -> float:
        return round(sum(common_area(room, other) for other in others) / (width * height) - common_area(room, window) / (width * height), 3)

    return min(rooms, key=covered)


def common_area(one: Window, other: Window) -> float:
    """The area that two rectangles have in common."""
    return max(0.0, min(one[2], other[2]) - max(one[0], other[0])) * max(0.0, min(one[3], other[3]) - max(one[1], other[1]))


def shorten_name(name: str, longest: int = 24) -> str:
    """A name that fits into a picture."""
    return name if len(name) <= longest else f"{name[: longest - 1]}\N{HORIZONTAL ELLIPSIS}"


def draw_scale(axes: Axes, window: Window, size: int) -> None:
    """A bar of a round number of metres in the lower left corner."""
    west, south, east, north = window
    metres = round_below((east - west) / 4)
    x, y = west + (east - west) * 0.04, south + (north - south) * 0.045
    axes.plot([x, x + metres], [y, y], color=INK, linewidth=2, solid_capstyle="butt", zorder=7)
    axes.text(x + metres / 2, y + (north - south) * 0.012, f"{metres:g} m", ha="center", va="bottom", fontsize=size - 1, color=INK, zorder=7)


def round_below(length: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... that is not above `length`."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))
