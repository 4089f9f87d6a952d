"""What the tests of the dynamic listings share: simulations of the programs, each made once, and questions about them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.conformance.listings import read_manifest
from scenic_ref.data.simulation import Moment, Simulated
from scenic_ref.roads import Network, read_map
from scenic_ref.semantics.space.geometry import corners
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.simulators.worlds.driving import default_network
from shapely.geometry import Point, Polygon

FOLDER = Path(__file__).parents[2] / "examples" / "paper" / "dynamic"
LISTINGS, PROGRAMS = read_manifest(FOLDER)
SIMULATORS = ["kinematic", pytest.param("pymunk", marks=[pytest.mark.extra("dynamics"), pytest.mark.slow])]


@cache
def avenue() -> Network:
    """The long street."""
    return read_map(FOLDER / "avenue.xodr")


def network_of(file: str) -> Network:
    """The map of a program."""
    return avenue() if "avenue.xodr" in (FOLDER / file).read_text("utf-8") else default_network()


@cache
def loaded(file: str) -> scenic_ref.Scenario:
    """The program."""
    [program] = [program for program in PROGRAMS if program.file == file]
    return scenic_ref.load(FOLDER / file, readings=program.readings)


@cache
def simulated(file: str, simulator: str, seed: int = 0) -> tuple[Simulated, Counter[str]]:
    """A simulation of the program, and how many runs each kind of requirement rejected before it."""
    [program] = [program for program in PROGRAMS if program.file == file]
    found = loaded(file).simulate(simulator, program.steps, seed, max_attempts=100)
    stuck: Counter[str] = Counter()
    for failed, often in found.stuck.items():
        stuck[failed.requirement.kind] += often
    return found.simulation, stuck


def place(moment: Moment, number: int = 0) -> Vector:
    """Where an object is."""
    return moment.objects[number]["position"]  # type: ignore[return-value]


def speed(moment: Moment, number: int = 0) -> float:
    """How fast an object is."""
    return float(moment.objects[number]["speed"])  # type: ignore[arg-type]


def apart(moment: Moment, one: int, other: int) -> float:
    """The distance between the middles of two objects."""
    return abs(complex(*(place(moment, one) - place(moment, other))))


def doing(run: Simulated, number: int = 0) -> Iterator[tuple[int, list[str]]]:
    """In each time step, the names of the behaviors that an object is in, from the outermost."""
    for moment in run.moments:
        if number in moment.doing:
            yield moment.step, [text.split("(")[0].split(",")[0] for text in moment.doing[number].split(" > ")]


def boxes(run: Simulated, moment: Moment) -> list[Polygon]:
    """The areas of the objects."""
    sizes = [(o.width, o.length) for o in run.scene.objects] + [(b.properties["width"], b.properties["length"]) for b in run.created]
    poses = zip(moment.objects, sizes, strict=False)
    return [Polygon([tuple(c) for c in corners(p["position"], p["heading"], *size)]) for p, size in poses]  # type: ignore[arg-type]


def within(run: Simulated, moment: Moment, area: Polygon, number: int = 0) -> bool:
    """Whether all of an object is in an area."""
    return area.covers(boxes(run, moment)[number])


def off_lanes(network: Network, where: Vector) -> float:
    """The distance to the nearest centerline."""
    return min(lane.centerline.polyline.distance(Point(where.x, where.y)) for lane in network.lanes)
