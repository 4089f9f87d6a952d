"""What is drawn from a road network: the batch backend asks it for attributes and methods, and gives the interpreter's scenes and errors."""

from __future__ import annotations

import random

import pytest
import scenic_ref
from scenic_ref.semantics.kernel.errors import AttemptsExhausted

MODEL = "model scenic.domains.driving.model\n"
PLACES = (
    "lane.centerline.pointAlongBy(5)", "lane.centerline.pointAlongBy(Range(2, 9))", "fixed.centerline.pointAlongBy(Range(5, 20))",
    "fixed.centerline.pointAlongBy(Range(0, 1), normalized=True)", "lane.centerline.project((x, 3))", "fixed.centerline.project(x @ x)",
    "lane.flowFrom(lane.centerline.start, x)", "fixed.flowFrom(fixed.centerline.points[0], x, steps=2)", "lane.centerline.pointsSeparatedBy(4)[1]",
    "lane.centerline.equallySpacedPoints(3)[n]", "lane.rightEdge.pointAlongBy(x / 2)", "lane.road.shiftLanes(lane.centerline.start, 0)",
    "lane.sections[0].shiftedBy(0).centerline.pointAlongBy(x)",
)  # fmt: skip
FURTHER = (
    "section = lane.sectionAt(spot)\nrequire section is lane.sections[0]\nparam length = section.centerline.length",
    "param at = network.laneAt(spot).uid", "param direction = lane.nominalDirectionsAt(spot)[0]",
    "param off = fixed.centerline.signedDistanceTo(spot)",
    "Object on lane.group.opposite.centerline, with allowCollisions True", "other = lane.sections[0].laneToLeft\nparam left = other.uid",
    "other = lane.sections[0]._laneToLeft\nrequire other is not None\nparam left = other.centerline.pointAlongBy(x)",
    "param left = lane.sections[0]._laneToLeft is None", "require lane.sections[-1].slowerLane.contains_point(spot) or x > 3",
    "param opposite = lane.group._opposite is not None", "param light = lane.trafficLight.stateAt(Range(0, 60))",
    "param state = lane._trafficLight.stateAt(7)", "param name = lane.uid.upper()", "param after = lane.successor.centerline.pointAlongBy(1, True)",
    "param road = network.roadAt(spot, reject=True).lanes[0].uid", "param section = lane.road.laneSectionAt(spot)._laneToRight is None",
    "require lane.centerline.heading_at(spot) > 0", "param wrong = lane.centerline.equallySpacedPoints(n - 1)[0]",
    "param far = lane.distanceTo(0 @ x)",
)  # fmt: skip


def invented(seed: int) -> str:
    """A program that draws a lane, and asks it and a fixed one for more."""
    numbers = random.Random(seed)
    among = numbers.choice(["network.lanes", "network.intersections[4].incomingLanes", "network.lanes[:3]"])
    start = f"lane = Uniform(*{among})\nfixed = network.lanes[{seed % 20}]\nx = Range(2, 4)\nn = Uniform(1, 2)\nspot = {numbers.choice(PLACES)}\n"
    return MODEL + start + "\n".join(["ego = Car at spot", *numbers.sample(FURTHER, numbers.randint(0, 2))]) + "\n"


def drawn(text: str, backend: str, seed: int) -> list[str] | str:
    """The scenes, or the error that drawing them ends with."""
    try:
        return [scene.to_line() for scene in scenic_ref.loads(text).sample_many(12, seed=seed, backend=backend, max_attempts=200)]  # type: ignore[arg-type]
    except AttemptsExhausted as exhausted:
        return exhausted.message.partition(":")[0]  # another requirement may be checked first
    except Exception as problem:
        return f"{type(problem).__name__}: {problem}"


@pytest.mark.parametrize("seed", range(80))
def test_the_scenes_are_those_of_the_interpreter(seed):
    assert drawn(invented(seed), "batch", seed) == drawn(invented(seed), "interpreter", seed), invented(seed)
