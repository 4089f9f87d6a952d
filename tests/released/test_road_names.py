"""What the released classes of roads have is what programs may ask ours for, but for what is listed here and in docs/roads.md."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import scenic_ref

RELEASED: dict[str, list[str]] = json.loads(Path(__file__).with_name("road_names.json").read_text())
INTERNAL = frozenset({
    "conditionTo", "deserializeValue", "evaluateIn", "evaluateInner", "getContextValues", "makeContext", "sample", "sampleAll", "sampleGiven",
    "serializeValue", "containsRegionInner", "uniformPointInner", "DigestMismatchError", "pickledExt",
})  # fmt: skip
"""How the released implementation draws and keeps values."""
MISSING = frozenset({
    "AABB", "buffer", "containsRegion", "dimensionality", "footprint", "inradius", "orient", "points", "projectVector", "show",
    "size", "uniformPointIn", "unionAll",
})  # fmt: skip
"""Of regions of 3.1.1, in space or as shapes of the library shapely."""


ONE = {
    "Network": "network", "ManeuverType": "ManeuverType", "VehicleType": "VehicleType", "NetworkElement": "network.intersections[0]",
    "LinearElement": "network.roads[0]", "Road": "network.roads[0]", "LaneGroup": "network.laneGroups[0]", "Lane": "network.lanes[0]",
    "RoadSection": "network.roadSections[0]", "LaneSection": "network.laneSections[0]", "Sidewalk": "network.sidewalks[0]",
    "PedestrianCrossing": "network.crossings[0]", "Shoulder": "network.shoulders[0]", "Intersection": "network.intersections[0]",
    "Signal": "network.signals[0]", "Maneuver": "network.lanes[0].maneuvers[0]",
}  # fmt: skip
"""One of each class in a program on the default map."""
REJECTING = frozenset({
    "successor", "predecessor", "opposite", "sidewalk", "bikeLane", "shoulder", "laneToLeft", "laneToRight", "fasterLane", "slowerLane",
})  # fmt: skip
"""Names that reject a run where there is no such thing, which has another one with an underscore."""


def lacking(name: str) -> set[str]:
    """What of the released class a program may not ask ours for."""
    asked = [n for n in RELEASED[name] if n not in INTERNAL | REJECTING]
    text = f"model scenic.domains.driving.model\nego = Car\none = {ONE[name]}\nparam there = [{', '.join(f'hasattr(one, {n!r})' for n in asked)}]\n"
    return {n for n, there in zip(asked, scenic_ref.loads(text).sample().params["there"], strict=True) if not there}


@pytest.mark.parametrize("name", RELEASED)
def test_programs_may_ask_for_what_the_released_classes_have(name):
    of_regions = "AABB" in RELEASED[name]
    assert lacking(name) == (MISSING if of_regions else set())


def test_an_element_and_a_line_stand_for_their_shapes():
    text = """model scenic.domains.driving.model
ego = Car
lane = Uniform(*network.lanes)
line = lane.centerline.lineString
param areas = [lane.polygon.area, lane.area, PolygonalRegion(polygon=lane.polygon).area]
param lengths = [line.length, lane.centerline.length]
param inside = lane.polygon.containsPoint(line.coords[0])
"""
    for backend in ("interpreter", "batch"):
        for scene in scenic_ref.loads(text).sample_many(10, seed=3, backend=backend):
            one, two, three = scene.params["areas"]
            assert one == two == pytest.approx(three, abs=1e-6)
            assert scene.params["lengths"][0] == scene.params["lengths"][1]
            assert scene.params["inside"] is True
