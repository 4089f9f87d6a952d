"""What is drawn from a list, such as a lane, is a number in its column: what is asked of it is a table, and nothing is left to be done row by row."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable

import numpy as np
import pytest
import scenic_ref
from scenic_ref.inference.batch import tracing
from scenic_ref.inference.batch.graph import RowCall, RowDraw, SearchPart
from scenic_ref.inference.batch.numpy_evaluator import search_parts
from scenic_ref.inference.batch.row_calls import column_methods, heading_along
from scenic_ref.semantics.space.regions import PolylineRegion
from scenic_ref.semantics.space.vectors import Vector

MODEL = "# dialect: scenic-3\nmodel scenic.domains.driving.model\n"
PROGRAMS = {
    "lane": "lane = Uniform(*network.lanes)\nego = new Car on lane.centerline\n",
    "area of a lane": "lane = Uniform(*network.lanes)\nego = new Car on lane, with regionContainedIn lane\n",
    "maneuver": "i = Uniform(*network.intersections)\nm = Uniform(*i.maneuvers)\n"
    "ego = new Car on m.startLane.centerline\nrequire (distance to i) < 30\n",
    "filtered lane": "road = Uniform(*filter(lambda r: len(r.lanes) >= 2, network.roads))\n"
    "lane = Uniform(*filter(lambda l: all([s._laneToLeft is not None for s in l.sections]), road.lanes))\nego = new Car on lane.centerline\n",
    "conflict": "lane = Uniform(*Uniform(*network.intersections).incomingLanes)\n"
    "turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, lane.maneuvers))\n"
    "other = Uniform(*filter(lambda m: m.type is ManeuverType.STRAIGHT, turn.conflictingManeuvers))\n"
    "ego = new Car on lane.centerline\nnew Car on other.startLane.centerline\n",
    "neighbour": "s = Uniform(*network.laneSections)\nego = new Car on s.laneToLeft.centerline, with isForward s.isForward\n",
    "one of two drawn ones": "a = Uniform(*network.lanes[:4])\nb = Uniform(*network.lanes[4:])\nego = new Car on Uniform(a, b).centerline\n",
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_scenes_are_the_interpreters_and_nothing_is_done_row_by_row(name):
    scenario = scenic_ref.loads(MODEL + PROGRAMS[name])
    drawn, one_by_one = ([s.to_line() for s in scenario.sample_many(20, seed=5, backend=b)] for b in ("batch", "interpreter"))  # type: ignore[arg-type]
    assert drawn == one_by_one
    calls = [node.function for node in scenario.batch.graph.nodes]
    assert not any(isinstance(call, RowDraw) for call in calls)
    assert [c.text for c in calls if isinstance(c, RowCall) and column_methods(c) is None] == []
    assert scenario.batch.block(5, 0, 20).left == 0


def test_what_rejects_a_run_is_said_as_the_interpreter_says_it():
    scenario = scenic_ref.loads(f"{MODEL}s = Uniform(*network.laneSections[:5])\nego = new Car on s.fasterLane\nrequire ego.position.x > 10 ** 6\n")
    said = []
    for backend in ("batch", "interpreter"):
        with pytest.raises(scenic_ref.errors.AttemptsExhausted) as caught:
            list(scenario.sample_many(1, seed=2, backend=backend, max_attempts=60))  # type: ignore[arg-type]
        said.append({requirement.text: count for requirement, count in caught.value.stuck if "faster lane" in requirement.text})
    assert said[0] == said[1] != {}


RARE = "lists = [[] for i in range(499)] + [[0]]\nx = Uniform(*Uniform(*lists))\nego = Object at x @ Range(0, 1)\n"


def test_a_program_is_traced_along_a_run_with_values_that_few_runs_have(monkeypatch):
    scenario = scenic_ref.loads(RARE)
    assert scenario.not_lifted is None
    drawn, one_by_one = (scenario.sample_many(3, seed=1, backend=b) for b in ("batch", "interpreter"))  # type: ignore[arg-type]
    assert [s.to_line() for s in drawn] == [s.to_line() for s in one_by_one]
    monkeypatch.setattr(tracing, "LOOKED_AT", tracing.TRIES)
    assert scenic_ref.loads(RARE).not_lifted is not None


@pytest.mark.parametrize(("name", "value"), [("LOOKED_AT", 40), ("MOST_STEPS", 200)])
def test_the_search_for_such_a_run_has_an_end(name, value, monkeypatch):
    monkeypatch.setattr(tracing, name, value)
    assert "no run with all values was found" in str(scenic_ref.loads(RARE).not_lifted)


def test_what_only_some_values_have_is_the_interpreters_error_where_the_others_are_drawn():
    scenario = scenic_ref.loads(f"{MODEL}thing = Uniform(*network.lanes[:3], network.intersections[0])\nego = new Car on thing.centerline\n")
    said = []
    for backend in ("batch", "interpreter"):
        with pytest.raises(scenic_ref.errors.UncaughtException) as caught:
            list(scenario.sample_many(30, seed=4, backend=backend))  # type: ignore[arg-type]
        said.append((caught.value.message, caught.value.span))
    assert said[0] == said[1]
    assert "no attribute centerline" in said[0][0]


def test_a_distance_from_pairs_that_are_drawn_is_the_interpreters():
    text = f"{MODEL}line = network.lanes[0].centerline\nego = Object at 0 @ Range(0, 1)\nparam d = line.distanceTo(Uniform((1, 2), (3, 4)))\n"
    scenario = scenic_ref.loads(text.replace("scenic-3", "scenic-2.1"))
    drawn, one_by_one = (scenario.sample_many(12, seed=1, backend=b) for b in ("batch", "interpreter"))  # type: ignore[arg-type]
    assert [s.to_line() for s in drawn] == [s.to_line() for s in one_by_one]


def test_the_heading_along_a_curve_is_that_of_each_point_alone_at_its_corners_too():
    curve = PolylineRegion([(0, 0), (0, 10), (5, 20), (5, 20.5), (-5, 20.5), (0, 10)])
    points = [*curve.lines[0], Vector(0, 5), Vector(3, 10), Vector(-5, 15), Vector(0.1, 10), Vector(1e6, -1e6)]
    columns = np.array([[v.x for v in points], [v.y for v in points]])
    assert heading_along(curve, *columns).tolist() == [curve.heading_at(v) for v in points]


@pytest.mark.parametrize("of", [float, lambda x: np.nextafter(x, 0), lambda x: np.nextafter(x, 9)])
def test_a_number_is_found_in_its_part_of_an_array(of: Callable[[float], float]):
    parts = [[1.0, 2.0, 2.0, 5.0], [], [0.5], [3.0] * 7]
    values = np.array([end for part in parts for end in (*part, np.inf)])
    starts = np.cumsum([0, *(len(part) + 1 for part in parts)])
    for k, part in enumerate(parts):
        asked = np.array([of(x) for x in (*part, 0.0, 2.5, 8.0)])
        found = search_parts(SearchPart(values, starts), np.full(len(asked), k), asked)
        assert (found - starts[k]).tolist() == [bisect_right(part, x) for x in asked]
