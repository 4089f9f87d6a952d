"""What is None in some runs, as forms with an underscore are, is a value like others in every backend: no run is left to the interpreter for it."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref

MODEL = "model scenic.domains.driving.model\nego = Car\nleft = ego.laneSection._laneToLeft\nwithin = ego._intersection\n"
PROGRAMS = {
    "asked for, and required": "require left is not None\nCar on left",
    "as a truth value": "param none = left is None\nparam some = within != None\nparam neither = not within",
    "as it is": "param within = within\nparam both = [left, within]\nrequire ego._crossing is None",
    "as a property": "require within is None\nego2 = Car on ego.lane, with foo left, with bar ego._crossing",
    "counted": "param n = len(filter(lambda x: x is not None, [left, within, ego._lane]))",
    "asked for more, if there": "require left is None or left.isForward is not None\nparam forward = left is not None and left.isForward",
    "asked for more, if there, where mostly None": "param signal = within is not None and within.isSignalized",
    "asked for more, after a requirement": "require left is not None\nother = left.lane\nCar on other.centerline\nparam uid = other.uid",
    "asked for more, where mostly None": "require within is not None\nparam way = within.is4Way\nCar on within.roads[0]",
    "among what is drawn": "x = Uniform(left, network.lanes[0].sections[0])\nrequire x is not None\nCar on x.lane",
    "drawn from none but it": "x = Uniform(left, ego.laneSection._laneToRight)\nrequire x is not None\nCar on x",
    "drawn, and asked for": "x = Uniform(within, ego.lane)\nparam none = x is None",
    "of one of a few": "s = Uniform(*network.lanes[:6]).sections[0]\nx = Uniform(s._laneToLeft, s._laneToRight, None)\n"
    "require x is not None\nCar on x",
    "of a light": "light = ego.lane._trafficLight\nrequire light is not None\nparam state = light.stateAt(Range(0, 60))",
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", PROGRAMS)
def test_the_scenes_are_those_of_the_interpreter_and_no_run_is_left_to_it(name):
    scenario = scenic_ref.loads(f"{MODEL}{PROGRAMS[name]}\n")
    drawn, one_by_one = ([s.to_line() for s in scenario.sample_many(12, seed=2, backend=b)] for b in ("batch", "interpreter"))  # type: ignore[arg-type]
    assert drawn == one_by_one
    assert scenario.batch.block(2, 0, 12).left == 0


def test_what_is_not_asked_for_is_left_to_the_interpreter_where_it_is_none_and_so_is_its_error():
    scenario = scenic_ref.loads(f"{MODEL}Car on left\n")
    assert scenario.batch.block(0, 0, 12).left > 0
    said = []
    for backend in ("batch", "interpreter"):
        with pytest.raises(scenic_ref.errors.ScenicError) as wrong:
            list(scenario.sample_many(12, seed=0, backend=backend))  # type: ignore[arg-type]
        said.append(wrong.value.message)
    assert said[0] == said[1]
    assert "not None" in said[0]


@pytest.mark.slow
def test_what_is_asked_of_two_values_that_are_never_there_together_is_left_to_the_interpreter():
    """As the page on the batch backend says, with the same words."""
    asked = "(distance from ego._crossing to ego._intersection) < 5"
    scenario = scenic_ref.loads(f"{MODEL}require ego._crossing is None or ego._intersection is None or {asked}\n")
    reason = "no run with all values was found; in the last one that was traced, this failed: a value is None that is used as something else"
    assert scenario.not_lifted == reason
    page = " ".join((Path(__file__).parents[2] / "docs" / "batch.md").read_text(encoding="utf-8").split())
    assert f"`{asked}` is such a question" in page
    assert reason in page
    assert len(list(scenario.sample_many(3, seed=0))) == 3


def test_a_value_that_is_used_before_it_is_asked_for_is_there_in_the_runs_of_the_graph():
    text = "require left is not None or Range(0, 1) < 0.1\nparam length = left.centerline.length\nparam none = left is None\n"
    scenario = scenic_ref.loads(MODEL + text)
    drawn, one_by_one = ([], [])
    for lines, backend in ((drawn, "batch"), (one_by_one, "interpreter")):
        with pytest.raises(scenic_ref.errors.ScenicError, match="None"):
            lines += [s.to_line() for s in scenario.sample_many(200, seed=1, backend=backend)]  # type: ignore[arg-type]
    assert drawn == one_by_one


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["importance", "smc"])
def test_other_backends_know_what_is_none_too(backend):
    text = "model scenic.domains.driving.model\nlane = Uniform(*network.lanes[:9])\nego = Object on lane.centerline\n"
    text += "x = lane.sections[0]._laneToLeft\ny = network.shoulderAt(ego)\nrequire x is not None and y is None\nparam other = x\n"
    found = scenic_ref.loads(text).infer(backend, 4, 1)
    assert len(found.scenes) == 4
    assert all(scene.params["other"] is not None for scene in found.scenes)
