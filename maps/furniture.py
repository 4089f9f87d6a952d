"""What stands at roads: signals and crosswalks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import Polygon

from ..semantics.space.vectors import Vector
from .assembly import Assembly
from .curves import along
from .elements import PedestrianCrossing, Sidewalk
from .fixed import complete
from .intersections import Intersection
from .opendrive import CrosswalkRecord, RoadRecord
from .shapes import Points
from .signals import Signal, lights_on_way

SMALLEST = 0.05
"""Square metres of a crosswalk."""
BESIDE = 5.0
"""Metres from an end of a crosswalk to the sidewalk at which it ends."""


def signals(net: Assembly, intersections: Sequence[Intersection]) -> list[Signal]:
    """The signals of the map; intersections get those of their connecting roads, and those towards them that no connecting road names."""
    made: dict[str, Signal] = {}
    of_road: dict[str, list[Signal]] = {}
    towards: dict[str, list[Signal]] = {}
    for record in net.file.roads.values():
        for one in record.signals:
            [x], [y], [direction] = along(record.pieces, np.array([min(max(one.s, 0.0), record.length)]))
            where = Vector(float(x - math.sin(direction) * one.t), float(y + math.cos(direction) * one.t))
            found = Signal.of(uid=f"signal{one.id}_{record.id}", openDriveID=one.id, country=one.country, type=one.type, position=where, roads=())
            made.setdefault(one.id, found)
            if not one.valid:
                continue
            of_road.setdefault(record.id, []).append(made[one.id])
            ends = (("+", record.successor), ("-", record.predecessor))
            for link in (link for sign, link in ends if one.orientation in (sign, "none") and link is not None and link.kind == "junction"):
                towards.setdefault(link.id, []).append(made[one.id])
    for record in net.file.roads.values():
        of_road.setdefault(record.id, []).extend(made[id] for id in record.references if id in made)
    for road in net.roads.values():
        complete(road, signals=tuple(dict.fromkeys(of_road.get(str(road.id), ()))))
    for signal in made.values():
        complete(signal, roads=tuple(r for r in net.roads.values() if signal in r.signals))
    named = {s for id, record in net.file.roads.items() if record.junction is not None for s in of_road.get(id, ())}
    for i in intersections:
        inside = [s for id, record in net.file.roads.items() if record.junction == i.id for s in of_road.get(id, ())]
        complete(i, signals=tuple(dict.fromkeys((*inside, *(s for s in towards.get(str(i.id), ()) if s not in named)))))
    for signal in made.values():
        complete(signal, intersections=tuple(i for i in intersections if signal in i.signals))
    for maneuver in (m for i in intersections for m in i.maneuvers):
        lights = lights_on_way(maneuver)
        if lights and maneuver.startLane._trafficLight is None:
            complete(maneuver.startLane, _trafficLight=lights[0])
    return list(made.values())


def crossings(net: Assembly, intersections: Sequence[Intersection]) -> None:
    """The crosswalks of the map."""
    of_junction = {i.id: i for i in intersections}
    for record in net.file.roads.values():
        parent = of_junction.get(record.junction) if record.junction is not None else net.roads.get(record.id)
        for n, walk in enumerate(record.crosswalks):
            corners, across = crosswalk_corners(record, walk)
            polygon = Polygon(corners)
            if parent is None or not polygon.is_valid or polygon.area < SMALLEST:
                net.notes.add("crosswalks that have no area or no road, which are left out", f"road {record.id}")
                continue
            center, left, right = crossing_lines(corners, across)
            made = net.linear(
                PedestrianCrossing, f"road{record.id}_crossing{n}", left=left, right=right, center=center, polygon=polygon, id=walk.id, parent=parent
            )  # fmt: skip
            ends = [sidewalk_near(net, point) for point in (center[0], center[-1])]
            complete(made, startSidewalk=ends[0], endSidewalk=ends[1])
            for element in {parent, *(e for e in ends if e is not None)}:
                complete(element, crossings=(*element.crossings, made))


def sidewalk_near(net: Assembly, point: Points) -> Sidewalk | None:
    """The nearest sidewalk, if one is near enough."""
    where = shapely.Point(*point)
    found = min(net.of(Sidewalk), key=lambda walk: walk.polygon.distance(where), default=None)
    return found if found is not None and found.polygon.distance(where) < BESIDE else None


def crosswalk_corners(road: RoadRecord, walk: CrosswalkRecord) -> tuple[Points, Points]:
    """The corners of a crosswalk, and the direction across the road there."""
    [x], [y], [direction] = along(road.pieces, np.array([min(max(walk.s, 0.0), road.length)]))
    across = np.array([-math.sin(direction), math.cos(direction)])
    told = np.array(walk.corners)
    if not walk.local:
        xs, ys, directions = along(road.pieces, np.clip(told[:, 0], 0.0, road.length))
        return np.column_stack([xs - np.sin(directions) * told[:, 1], ys + np.cos(directions) * told[:, 1]]), across
    turn = direction + walk.heading
    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    return np.array([x, y]) + walk.t * across + told @ rotation, across


def crossing_lines(corners: Points, across: Points) -> tuple[Points, Points, Points]:
    """The centerline and the edges of a crosswalk, as long as it is in the direction across the road."""
    center = corners.mean(axis=0)
    beside = np.array([across[1], -across[0]])  # to the right of the direction across
    reach, width = (corners - center) @ across, (corners - center) @ beside
    ends = center + np.array([[reach.min()], [reach.max()]]) * across
    return ends, ends + width.min() * beside, ends + width.max() * beside
