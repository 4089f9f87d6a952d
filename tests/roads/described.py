"""What a network says of itself, in plain data: the same questions to ours and, as a script, to that of the released implementation.

    python described.py FILE    FILE: {"map": {"path": ..., "lanes": [[x, y], ...], "anywhere": [[x, y], ...]}, ...}

Elements are named by their road, their section and the number of their lane in the file, in which both agree.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

Pairs = Sequence[tuple[float, float]]


@dataclass
class Names:
    """Names of the elements of a network by what they are in the file."""

    network: Any

    def __post_init__(self) -> None:
        self.of: dict[int, str] = {}
        for place in self.network.intersections:
            self.of[id(place)] = f"intersection {place.id}"
        for road in self.network.allRoads:
            self.of[id(road)] = f"road {road.id}"
            for number, section in enumerate(road.sections):
                self.of[id(section)] = f"road {road.id} section {number}"
                for lane in section.lanes:
                    self.of[id(lane)] = f"road {road.id} section {number} lane {lane.openDriveID}"
            for lane in road.lanes:
                self.of[id(lane)] = self.of[id(lane.sections[0])].replace("section", "from section")
            for group in road.laneGroups:
                name = f"road {road.id} {'forward' if group is road.forwardLanes else 'backward'}"
                self.of[id(group)] = name
                for beside in (group._sidewalk, group._shoulder):
                    if beside is not None:
                        self.of[id(beside)] = f"{name} {type(beside).__name__.lower()}"

    def __call__(self, element: Any) -> str | None:
        """The name of an element; None for none, and for a number, which the release leaves where a lane leads out of its road."""
        return None if element is None or isinstance(element, int) else self.of.get(id(element), f"more of {element.uid}")

    def all(self, elements: Iterable[Any]) -> list[str | None]:
        return [self(element) for element in elements]


@dataclass
class Asked:
    """How one implementation is asked for what the two say in their own ways."""

    vector: Callable[[float, float], Any]
    points: Callable[[Any], Pairs]
    area: Callable[[Any], float]
    direction: Callable[[Any, Any], float]
    angles: Callable[[Sequence[Any]], list[float]]


def described(network: Any, ask: Asked, on_lanes: Pairs, anywhere: Pairs) -> dict[str, dict[str, Any]]:
    """All that is compared: by name of the element, by name of the attribute."""
    name = Names(network)

    def lines(element: Any, *more: str) -> dict[str, Any]:
        return {line: ask.points(getattr(element, line)) for line in ("centerline", "leftEdge", "rightEdge", *more)}

    def linear(element: Any, *more: str) -> dict[str, Any]:
        ends = {"successor": name(element._successor), "predecessor": name(element._predecessor)}
        return {**lines(element, *more), **ends, "area": element.polygon.area}

    def maneuver(way: Any) -> list[Any]:
        return [way.type.name, name(way.startLane), name(way.connectingLane), name(way.endLane)]

    found: dict[str, dict[str, Any]] = {"network": {
        **{kind: len(getattr(network, kind)) for kind in ("roads", "connectingRoads", "laneGroups", "lanes", "laneSections", "roadSections",
            "intersections", "crossings", "sidewalks", "shoulders")},
        **{f"{kind} area": ask.area(getattr(network, f"{kind}Region"))
            for kind in ("drivable", "walkable", "road", "lane", "intersection", "sidewalk", "shoulder")},
        "driveOnLeft": network.driveOnLeft, "order of roads": name.all(network.allRoads),
    }}  # fmt: skip
    for road in network.allRoads:
        found[name(road)] = {
            **linear(road), "is1Way": road.is1Way, "all lanes": sorted(name.all(road.lanes)), "forwardLanes": name(road.forwardLanes),
            "backwardLanes": name(road.backwardLanes), "laneGroups": name.all(road.laneGroups), "sections": name.all(road.sections),
            "signals": sorted(str(signal.openDriveID) for signal in road.signals), "sidewalks": name.all(road.sidewalks),
        }  # fmt: skip
        for section in road.sections:
            found[name(section)] = {
                **linear(section), "lanes": name.all(section.lanes), "forwardLanes": name.all(section.forwardLanes),
                "backwardLanes": name.all(section.backwardLanes), "road": name(section.road),
                "lanesByOpenDriveID": sorted((id, name(lane)) for id, lane in section.lanesByOpenDriveID.items()),
            }  # fmt: skip
        for group in road.laneGroups:
            found[name(group)] = {
                **linear(group, "curb"), "lanes": name.all(group.lanes), "sidewalk": name(group._sidewalk), "shoulder": name(group._shoulder),
                "opposite": name(group._opposite), "has a bike lane": group._bikeLane is not None, "road": name(group.road),
            }  # fmt: skip
            for beside in (group._sidewalk, group._shoulder):
                if beside is not None:
                    found[name(beside)] = {**lines(beside), "area": beside.polygon.area, "road": name(beside.road)}
    for lane in network.lanes:
        found[name(lane)] = {
            **linear(lane), "sections": name.all(lane.sections), "adjacentLanes": sorted(set(name.all(lane.adjacentLanes))),
            "maneuvers": [maneuver(way) for way in lane.maneuvers], "group": name(lane.group), "road": name(lane.road),
        }  # fmt: skip
    for lane in network.laneSections:
        beside = {side: name(getattr(lane, f"_{side}")) for side in ("laneToLeft", "laneToRight", "fasterLane", "slowerLane")}
        found[name(lane)] = {
            **linear(lane), **beside, "adjacentLanes": name.all(lane.adjacentLanes), "isForward": lane.isForward, "lane": name(lane.lane),
            "group": name(lane.group), "road": name(lane.road),
        }  # fmt: skip
    for place in network.intersections:
        found[name(place)] = {
            "is3Way": place.is3Way, "is4Way": place.is4Way, "isSignalized": place.isSignalized, "roads": name.all(place.roads),
            "incomingLanes": name.all(place.incomingLanes), "outgoingLanes": name.all(place.outgoingLanes), "outline": place.polygon.wkt,
            "maneuvers": [maneuver(way) for way in place.maneuvers], "signals": sorted(str(signal.openDriveID) for signal in place.signals),
            "traffic lights": sum(signal.isTrafficLight for signal in place.signals),
            **{kind: {str(maneuver(way)): sorted(map(maneuver, getattr(way, kind))) for way in place.maneuvers}
                for kind in ("conflictingManeuvers", "reverseManeuvers")},
        }  # fmt: skip
    for x, y in on_lanes:
        v = ask.vector(x, y)
        found[f"point {x!r} {y!r}"] = {
            "roadDirection": ask.direction(network.roadDirection, v), "nominalDirectionsAt": ask.angles(network.nominalDirectionsAt(v))
        }  # fmt: skip
    for x, y in anywhere:
        v = ask.vector(x, y)
        kinds = ("element", "road", "lane", "laneSection", "laneGroup", "intersection", "sidewalk", "shoulder")
        found[f"place {x!r} {y!r}"] = {f"{kind}At": name(getattr(network, f"{kind}At")(v)) for kind in kinds}
    return found


def of_the_release(path: str, lanes: Pairs, anywhere: Pairs, ref_points: int) -> dict[str, dict[str, Any]]:
    """The released implementation's network of a map."""
    from scenic.core.vectors import Vector  # both are in its own environment alone
    from scenic.domains.driving.roads import Network

    network = Network.fromFile(path, useCache=False, writeCache=False, ref_points=ref_points)
    ask = Asked(
        vector=Vector, points=lambda line: [(float(x), float(y)) for x, y, *_ in line.points],
        area=lambda region: region.polygons.area if hasattr(region, "polygons") else 0.0,
        direction=lambda field, v: float(getattr(field[v], "yaw", field[v])), angles=lambda found: [float(one.yaw) for one in found],
    )  # fmt: skip
    return described(network, ask, lanes, anywhere)


if __name__ == "__main__":
    with open(sys.argv[1]) as file:
        asked = json.load(file)
    for key, given in asked.items():
        print(json.dumps({key: of_the_release(**given)}), flush=True)
