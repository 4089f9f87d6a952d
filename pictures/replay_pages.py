"""Data for the page that replays simulations: the objects of each in the colours of pictures, and the land
below them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ..roads.network import MapWorkspace, Network
from .map_layers import ARROW, Window, areas_of, arrows_of, lines_in, map_features_in, polygons_in, ways_of
from .scene_figures import EDGE, EGO, FARTHEST, LAND, colours_by_class, land_in

if TYPE_CHECKING:
    from ..data.scene import Scene

Json = Mapping[str, object]
ROOM, LEAST = 1.25, 30.0
"""How much of the land around the objects is on a page: a share of their extent on each side, and metres."""
FINENESS = 8000
"""Land is drawn to this part of its width."""
ARROWS, APART, LONGEST_ARROW = 60, 12.0, 4.0
"""At most so many arrows across the land of a page, at least so far apart, and at most so long, in metres."""
OF_OBJECT = ("id", "name", "class", "position", "heading", "width", "length")


def run_shown(run: Json) -> dict[str, object]:
    """Return the page's data for a simulation in the simulation format: its objects by number, those of the
    scene first, each with its colour.
    """
    scene, created = run["scene"], run["created"]
    assert isinstance(scene, Mapping) and isinstance(created, Sequence)
    things: list[Json] = [*scene["objects"], *created]
    ego = scene["ego"]
    colours = colours_by_class(str(o["class"]) for k, o in enumerate(things) if k != ego)
    objects = [
        {name: o[name] for name in OF_OBJECT if name in o} | {"colour": EGO if k == ego else colours[str(o["class"])]} for k, o in enumerate(things)
    ]
    return {name: run[name] for name in ("seed", "run", "timestep", "steps", "result", "reason")} | {"ego": ego, "objects": objects}


def land_below(scene: Scene, run: Json) -> dict[str, object] | None:
    """Return the land around the objects of a simulation (`land_around`); None for a road network
    (`map_below`), of which all runs share one.
    """
    window = window_around([run])
    if isinstance(scene.workspace, MapWorkspace):
        return None
    return {"areas": []} if window is None else land_around(scene, window)


def land_around(scene: Scene, window: Window) -> dict[str, object]:
    """The workspace of a scene, and the areas, lines and points of a map of one's own, in a window."""
    digits = digits_for(window)
    features = map_features_in(scene.site, window)
    found = areas(land_in(scene.workspace, window), LAND, EDGE, window)
    found += [area for one in features if one.kind == "areas" for area in areas([one.shape], one.faint, one.dim, window)]
    ways = [(one.dim, line) for one in features if one.kind == "lines" for line in lines_in(one.shape)]
    points = [(one.dim, shapely.get_coordinates(one.shape)) for one in features if one.kind == "points"]
    drawn = {"lines": ways, "points": points}
    below: dict[str, object] = {"areas": found}
    return below | {
        kind: [{"colour": colour, "points": [round_point(point, digits) for point in places.tolist()]} for colour, places in some]
        for kind, some in drawn.items() if some
    }


def map_below(network: Network, runs: Sequence[Json]) -> dict[str, object]:
    """The map around the objects of simulations (`map_in`)."""
    window = window_around(runs)
    return {"areas": []} if window is None else map_in(network, window)


def map_in(network: Network, window: Window) -> dict[str, object]:
    """The part of a map in a window: areas, what is on top last, the direction of traffic, and the ways through intersections."""
    apart = max(APART, (window[2] - window[0]) / ARROWS)
    box, digits = shapely.box(*window), digits_for(window)
    found = [area for shapes, colour, _, edge in areas_of(network, window) for area in areas(shapes, colour, edge, window)]
    arrows = [[round(place.x, digits), round(place.y, digits), round(h, 3)] for place, h in arrows_of(network, window, apart)]
    ways = [[round_point(point, digits) for point in way] for way in ways_of(network) if box.intersects(shapely.LineString(way))]
    return {"areas": found, "arrows": arrows, "length": min(0.35 * apart, LONGEST_ARROW), "ways": ways, "ink": ARROW}


def areas(shapes: Iterable[BaseGeometry], colour: str, edge: str | None, window: Window) -> list[object]:
    """The parts of shapes inside the window, each with its colours and rings."""
    box, digits = shapely.box(*window), digits_for(window)
    fine = shapely.simplify([shapely.intersection(shape, box) for shape in shapes], (window[2] - window[0]) / FINENESS)
    rings = (
        [[round_point(point, digits) for point in np.asarray(ring.coords)[:, :2].tolist()] for ring in (polygon.exterior, *polygon.interiors)]
        for shape in fine for polygon in polygons_in(shape)
    )  # fmt: skip
    return [{"colour": colour, "edge": edge or colour, "rings": found} for found in rings]


def digits_for(window: Window) -> int:
    """How many digits behind the point the coordinates of land have."""
    return max(0, 4 - math.floor(math.log10(window[2] - window[0])))


def round_point(point: Sequence[float], digits: int) -> list[float]:
    """A point with so many digits."""
    return [round(float(c), digits) for c in point[:2]]


def window_around(runs: Iterable[Json]) -> Window | None:
    """Return a window that holds all objects of the simulations in all time steps, with much room around
    them; None if they are too far away.
    """
    places = [place for run in runs for place in places_in(run)]
    if not places or not all(abs(x) < FARTHEST and abs(y) < FARTHEST for x, y in places):
        return None
    (west, south), (east, north) = np.min(places, axis=0).tolist(), np.max(places, axis=0).tolist()
    x, y, reach = (west + east) / 2, (south + north) / 2, ROOM * max(east - west, north - south) + LEAST
    return x - reach, y - reach, x + reach, y + reach


def places_in(run: Json) -> Iterable[tuple[float, float]]:
    """Yield the positions of all objects, at first and later."""
    scene, created, steps = run["scene"], run["created"], run["steps"]
    for one in (*scene["objects"], *created, *(o for step in steps for o in step["objects"])):  # type: ignore[index, misc]
        if "position" in one:
            yield tuple(one["position"])
