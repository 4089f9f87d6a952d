"""Traffic lights and signs, and the plan by which the lights of an intersection change (names of the released library)."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from shapely.geometry import Point

from ..semantics.space.vectors import Vector
from .elements import Lane, LaneGroup, Road
from .fixed import Fixed

if TYPE_CHECKING:
    from .intersections import Intersection, Maneuver
    from .network import Network

GREEN, YELLOW, CLEARING = 10.0, 3.0, 2.0
"""Seconds for which a light is green, then yellow, and for which all lights of its intersection are red before the next ones are green."""
NEAR = 25.0
"""Metres before the end of a lane within which a light stands beside the line at which its vehicles wait."""
TRAFFIC_LIGHTS = frozenset({"1000001", "1000008", "1000009", "1000010", "1000011", "1000012", "1000020"})


class Signal(Fixed):
    """A traffic light or sign."""

    uid: str
    openDriveID: str
    country: str
    type: str
    position: Vector
    roads: tuple[Road, ...]
    intersections: tuple[Intersection, ...] = ()
    """Those whose signal it is."""

    @property
    def isTrafficLight(self) -> bool:
        """Whether it is a traffic light for vehicles (OpenDRIVE: 1000001 and its kin)."""
        return self.type in TRAFFIC_LIGHTS

    def __repr__(self) -> str:
        return f"<Signal {self.uid}>"

    def __reduce__(self) -> tuple[object, ...]:
        """It is pickled as a name in its network."""
        return signal_of, (self.roads[0].network, self.uid)

    @cached_property
    def turn(self) -> tuple[int, int] | None:
        """When its approach is green: after how many others, and how many take turns; None if it is no light for an approach of an intersection."""
        for i in self.intersections:
            for group, lights in lights_of(i).items():
                if self in lights:
                    return i.turns[group], 1 + max(i.turns.values())
        return None

    def stateAt(self, seconds: float) -> str:
        """`green`, `yellow` or `red`, so many seconds after the beginning of a simulation; `off` for what is no light of an intersection."""
        if self.turn is None:
            return "off"
        turn, count = self.turn
        period = GREEN + YELLOW + CLEARING
        within = (seconds - turn * period) % (count * period)
        return "green" if within < GREEN else "yellow" if within < GREEN + YELLOW else "red"

    def changesUntil(self, seconds: float) -> int:
        """How often it has changed until then, counted from when the first light of its intersection became green."""
        if self.turn is None:
            return 0
        turn, count = self.turn
        period = GREEN + YELLOW + CLEARING
        cycles, within = divmod(seconds - turn * period, count * period)
        return 3 * int(cycles) + (within >= GREEN) + (within >= GREEN + YELLOW)

    def stopLine(self, lane: Lane) -> float:
        """Metres along a lane at which its vehicles wait: beside the light, if it stands near the end of the lane, else at this end."""
        place = lane.centerline.polyline.project(Point(self.position.x, self.position.y))
        length = lane.centerline.polyline.length
        return place if length - place < NEAR else length


def lights_on_way(maneuver: Maneuver) -> tuple[Signal, ...]:
    """The lights for a way through an intersection: those that its connecting road names, else those of the road that it comes from."""
    if maneuver.connectingLane is None or maneuver.intersection is None:
        return ()
    for road in (maneuver.connectingLane.road, maneuver.startLane.road):
        found = tuple(s for s in road.signals if s.isTrafficLight and s in maneuver.intersection.signals)
        if found:
            return found
    return ()


def lights_of(intersection: Intersection) -> Mapping[LaneGroup, tuple[Signal, ...]]:
    """The lights of each approach, the lanes of a road that lead to the intersection, that has any."""
    found: dict[LaneGroup, dict[Signal, None]] = {}
    for maneuver in intersection.maneuvers:
        for light in lights_on_way(maneuver):
            found.setdefault(maneuver.startLane.group, {})[light] = None
    return {group: tuple(lights) for group, lights in found.items()}


def turns_of(intersection: Intersection) -> Mapping[LaneGroup, int]:
    """The approaches with lights, each with its turn to be green: no two whose ways conflict have the same."""
    conflicts: dict[LaneGroup, set[LaneGroup]] = {group: set() for group in lights_of(intersection)}
    for maneuver in intersection.maneuvers:
        others = {m.startLane.group for m in maneuver.conflictingManeuvers}
        conflicts.setdefault(maneuver.startLane.group, set()).update(others)
    turns: dict[LaneGroup, int] = {}
    for group in lights_of(intersection):
        taken = {turns[other] for other in conflicts[group] if other in turns}
        turns[group] = next(n for n in itertools.count() if n not in taken)
    return turns


def signal_of(network: Network, uid: str) -> Signal:
    """The signal of that name."""
    return next(signal for signal in network.signals if signal.uid == uid)
