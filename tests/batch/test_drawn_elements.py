"""What is drawn from a road network: the batch backend asks it for attributes and methods, and gives the interpreter's scenes and errors."""

from __future__ import annotations

import contextlib
import operator
import random
from collections import Counter

import pytest
import scenic_ref
from scenic_ref.inference.batch import symbolic, tracing
from scenic_ref.inference.batch.graph import RowCall
from scenic_ref.semantics.machine.outcome import Requirement
from scenic_ref.semantics.space.symbol_seam import NotLifted
from scenic_ref.semantics.store.errors import AttemptsExhausted, ScenicError

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
    "either = Uniform(fixed, network.laneAt(spot, reject=True))\nparam side = either.sections[0].laneToLeft.uid",
    "either = Uniform(network.laneAt(0 @ x), fixed, lane)\nparam side = either.group._opposite is None",
    "either = Uniform(lane.sections[0]._laneToLeft, fixed.sections[0], lane.sections[-1])\nparam side = either.lane.group.sidewalk.uid",
)  # fmt: skip


def invented(seed: int) -> str:
    """A program that draws a lane, and asks it and a fixed one for more."""
    numbers = random.Random(seed)
    among = numbers.choice(["network.lanes", "network.intersections[4].incomingLanes", "network.lanes[:3]"])
    start = f"lane = Uniform(*{among})\nfixed = network.lanes[{seed % 20}]\nx = Range(2, 4)\nn = Uniform(1, 2)\nspot = {numbers.choice(PLACES)}\n"
    return MODEL + start + "\n".join(["ego = Car at spot", *numbers.sample(FURTHER, numbers.randint(0, 2))]) + "\n"


FILTERS = (
    "lambda m: m.type is ManeuverType.LEFT_TURN", "lambda m: m.type is not ManeuverType.STRAIGHT and len(m.conflictingManeuvers) > 2",
    "lambda m: m.startLane.trafficLight.stateAt(t) == 'red'", "lambda m: m.startLane.sections[0].laneToLeft is not None", "short", "None",
    "lambda m: m.reverseManeuvers[n].type is ManeuverType.STRAIGHT", "lambda m: t > 20", "lambda m: Range(0, 1) < 0.7", "lambda m: t > 20 or m.type",
)  # fmt: skip
RESULTS = (
    "m = Uniform(*found)\nego = Car on m.startLane.centerline", "m = Uniform(*found)\nego = Car at m.connectingLane.centerline.pointAlongBy(1)",
    "ego = Car on inter, with many len(found)", "m = Uniform(*found, inter.maneuvers[0])\nego = Car on m.endLane",
    "m = Uniform(*Uniform(*found).conflictingManeuvers)\nego = Car on m.startLane", "ego = Car on found[0].startLane",
    "ego = Car on inter, with v found[-1].type",
)  # fmt: skip


def filtering(seed: int) -> str:
    """A program that filters a container of a random length, and draws from what is left."""
    numbers = random.Random(seed)
    among = numbers.choice(["network.intersections", "network.intersections[2:5]", "filter(lambda i: i.is4Way, network.intersections)"])
    return (
        f"{MODEL}inter = Uniform(*{among})\nt = Range(0, 60)\nn = {numbers.randint(0, 1)}\n"
        "def short(m):\n    found = m.startLane.centerline.length\n    return found < 90\n"
        f"found = filter({numbers.choice(FILTERS)}, inter.maneuvers)\n{numbers.choice(RESULTS)}\nOther = Range(0, 1)\nparam after = Other\n"
    )


def drawn(text: str, backend: str, seed: int) -> list[str] | str:
    """The scenes, or the error that drawing them ends with."""
    try:
        return [scene.to_line() for scene in scenic_ref.loads(text).sample_many(12, seed=seed, backend=backend, max_attempts=200)]  # type: ignore[arg-type]
    except AttemptsExhausted as exhausted:
        return exhausted.message.partition(":")[0]  # another requirement may be checked first
    except Exception as problem:
        return f"{type(problem).__name__}: {problem}"


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", range(24))
def test_what_is_left_of_a_random_container_is_what_the_interpreter_leaves(seed):
    assert drawn(filtering(seed), "batch", seed) == drawn(filtering(seed), "interpreter", seed), filtering(seed)


@pytest.mark.slow
def test_most_of_these_programs_have_a_graph():
    texts = [*map(invented, range(12)), *map(filtering, range(12))]
    without = 0
    for text in texts:
        with contextlib.suppress(ScenicError):
            without += scenic_ref.loads(text).not_lifted is not None
    assert without < len(texts) / 3


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("ego = Car on Uniform(*network.lanes)\nn = filter(None, network.nominalDirectionsAt(ego.position))", "3:5: which"),
        ("i = Uniform(*network.intersections)\nn = filter(lambda m: m.type is i and m.startLane, i.maneuvers)\nego = Car on i", "3:5: a function"),
        ("d = {Uniform('a', 'b'): 1}\nego = Car with d d", "a dictionary with random keys"),
        ("f = Uniform(*network.lanes)\nprint(f.uid)\nego = Car on f", "3:1: the text of a random value is needed, in `print(f.uid)`"),
    ],
)  # fmt: skip
def test_why_there_is_no_graph_names_the_construct_and_its_line(text, reason):
    assert reason in scenic_ref.loads(MODEL + text + "\n").not_lifted


REJECTIONS = {
    "one of none": "inter = Uniform(*network.intersections)\nhere = network.intersections[0]\n"
    "m = Uniform(*filter(lambda m: m.intersection is here, inter.maneuvers))\nego = Car on m.startLane",
    "one of none, row by row": "lane = Uniform(*network.lanes)\nlong = filter(lambda s: s.centerline.length > 25, lane.sections)\n"
    "ego = Car on Uniform(*Uniform(*long).lane.adjacentLanes)",
    "no lane there": "x = Range(-300, 300)\nlane = network.laneAt(x @ Range(-200, 200), reject=True)\nego = Car on lane",
    "words of the program": "x = Range(-300, 300)\nlane = network.laneAt(x @ 0, reject=Uniform('far', 'away'))\nego = Car on lane",
    "of some of a few": "lane = Uniform(*network.lanes[::4])\nego = Car on lane.sections[0].laneToLeft",
    "of the rows": "lane = network.laneAt((Range(-300, 300), 0), reject=True)\nego = Car on lane.sections[0].laneToLeft",
}


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["importance", "smc", "mcmc"])
def test_other_backends_draw_elements_and_ask_them_too(backend):
    text = "lane = Uniform(*network.lanes[:9])\nspot = lane.centerline.pointAlongBy(5)\nego = Car at spot\nrequire spot.x > 0\n"
    found = scenic_ref.loads(MODEL + text).infer(backend, 4, 1)
    assert len(found.scenes) == 4
    assert all(scene.objects[0].position.x > 0 for scene in found.scenes)


def test_a_program_cannot_catch_what_rejects_a_run_or_ends_a_trace():
    text = f"{MODEL}lane = network.lanes[0]\ntry:\n    lane = network.laneAt(Range(-300, 300) @ 0, reject=True).sections[0].laneToLeft.lane\n"
    text += "except BaseException:\n    lane = network.lanes[1]\nfinally:\n    found = lane.uid\nego = Car on lane, with found found\n"
    assert scenic_ref.loads(text).not_lifted is None
    assert drawn(text, "batch", 5) == drawn(text, "interpreter", 5)


@pytest.mark.parametrize(("owner", "name"), [(tracing.Recorder, "call"), (tracing, "draw_symbol")])
def test_an_interrupt_ends_a_trace_and_nothing_else(owner, name, monkeypatch):
    def interrupted(*ignored: object) -> None:
        raise KeyboardInterrupt

    scenario = scenic_ref.loads(invented(0))
    with monkeypatch.context() as patch:
        patch.setattr(owner, name, interrupted)
        with pytest.raises(KeyboardInterrupt):
            scenario.batch  # noqa: B018
    assert scenario.not_lifted is None


def test_after_its_run_nobody_is_asked_to_try_another():
    batch = scenic_ref.loads(MODEL + "lane = Uniform(*network.lanes)\nego = Car on lane, with left lane.sections[0]._laneToLeft\n").batch
    left = batch.template.objects[0].properties["left"]
    asked = operator.attrgetter("lane.group.sidewalk")
    for use in (lambda: left.always(lambda value: hasattr(value, "lane")), lambda: left.trace.call(asked, (left,), {})):
        with pytest.raises(NotLifted, match="outlived"):
            use()


def rejected(text: str, backend: str) -> Counter[Requirement]:
    """What failed how often in the attempts at a scene that there is not."""
    with pytest.raises(AttemptsExhausted) as exhausted:
        list(scenic_ref.loads(text).sample_many(1, seed=3, backend=backend, max_attempts=150))  # type: ignore[arg-type]
    return Counter(dict(exhausted.value.stuck))


@pytest.mark.slow
@pytest.mark.parametrize("name", REJECTIONS)
def test_what_is_rejected_is_said_in_the_words_of_the_interpreter(name):
    text = f"{MODEL}{REJECTIONS[name]}\nrequire ego.position.x > 9999\n"
    assert scenic_ref.loads(text).not_lifted is None
    found = rejected(text, "batch")
    assert len(found) > 1
    assert found == rejected(text, "interpreter")


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", range(24))
def test_the_scenes_are_those_of_the_interpreter(seed):
    assert drawn(invented(seed), "batch", seed) == drawn(invented(seed), "interpreter", seed), invented(seed)


def test_a_function_that_draws_cannot_filter_a_drawn_list():
    """As in Scenic 3.1.1, where what it gives is no truth value: the function sees the elements of one run."""
    text = "model scenic.domains.driving.model\n"
    text += "i = Uniform(*network.intersections)\nn = filter(lambda m: Range(0, 1) < 0.5, i.maneuvers)\nego = Car on i"
    with pytest.raises(ScenicError, match="draws a random value while library code calls it") as found:
        scenic_ref.loads(text).sample()
    assert "draw the value before the call" in found.value.hint


BESIDE = """lane = Uniform(*network.lanes)
other = Uniform(*filter(lambda each: each is not lane, lane.road.lanes))
ego = Object on other.centerline, with behavior FollowTrajectoryBehavior(5, [lane, other])
"""


def test_a_call_is_made_once_for_what_was_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """A `filter` whose function looks at what is drawn is made once for each lane; and where symbols stand in a value is found once for all rows."""
    scenario = scenic_ref.loads(MODEL + BESIDE, dialect="scenic-2.1")
    batch = scenario.batch
    assert batch is not None, scenario.not_lifted
    looked = Counter[str]()
    find = symbolic.symbols_in

    def symbols_in(value: object) -> list[object]:
        looked["values"] += 1
        return find(value)  # type: ignore[return-value]

    monkeypatch.setattr(symbolic, "symbols_in", symbols_in)
    found = [scene.to_line() for scene in scenario.sample_many(40, seed=3, backend="batch")]
    few = looked.total()
    assert len(list(scenario.sample_many(400, seed=3, backend="batch"))) == 400
    assert looked.total() < 3 * few
    calls = [n.function for n in batch.graph.nodes if isinstance(n.function, RowCall) and n.function.text == "filter"]
    assert calls and all(len(call.kept) < 400 for call in calls) and any(call.kept for call in calls)
    assert found == [scene.to_line() for scene in scenario.sample_many(40, seed=3, backend="interpreter")]
