"""All that the driving library lets one call says which of its arguments is wrong, what it was, and what is wanted."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import ProgramError
from scenic_ref.semantics.syntax.dynamics import BehaviorDefinition, ScenarioDefinition
from scenic_ref.semantics.syntax.statements import FunctionDefinition
from scenic_ref.simulators import actions as a
from scenic_ref.simulators import actions as basic
from scenic_ref.simulators.actions import Wanted
from scenic_ref.simulators.worlds.driving import arguments as ours
from scenic_ref.simulators.worlds.driving import driving_module_text
from scenic_ref.simulators.worlds.driving.arguments import WANTED

DOCS = Path(__file__).parent.parent.parent / "docs" / "roads.md"
MODEL = "model scenic.domains.driving.model\n"
A_TEXT, NEGATIVE, NAN, NONE, NUMBERS, TRUTH = "'fast'", "-3", "float('nan')", "None", "[1, 2]", "True"
ALL = (A_TEXT, NEGATIVE, NAN, NONE, NUMBERS, TRUTH)
REFUSED: Mapping[Wanted, tuple[str, ...]] = {
    basic.SPEED: ALL, basic.DISTANCE: ALL, basic.SHARE: ALL, ours.LANE: ALL, ours.SECTION: ALL, ours.WAY: ALL, ours.TRAIL: ALL, ours.OBJECT: ALL,
    ours.STEP: ALL, ours.DRIVEN: ALL, ours.SIGNAL: ALL, ours.LIGHT: ALL, ours.COLOR: ALL,
    ours.INTERSECTION: ALL, ours.SCENARIOS: ALL, basic.STEERING: ALL,
    basic.NUMBER: (A_TEXT, NAN, NONE, NUMBERS, TRUTH), basic.HEADING: (A_TEXT, NAN, NONE, NUMBERS, TRUTH),
    basic.TRUTH: (A_TEXT, NEGATIVE, NAN, NONE, NUMBERS), ours.PLACE: (A_TEXT, NEGATIVE, NAN, NONE, TRUTH),
    basic.VECTOR: (A_TEXT, NEGATIVE, NAN, NONE, TRUTH, "[1, 2, 3]", "[1, 'x']"),
}  # fmt: skip
"""What is refused where each kind is wanted."""
FITTING = {
    "x": "0.5", "trajectory": "ego.lane", "laneSectionToSwitch": "ego.laneSection", "reference_actor": "ego", "leader": "ego",
    "trail": "Trail([ego.lane], ego)",
    "lane": "ego.lane", "vehicle": "ego", "other": "ego", "speed": "1", "threshold": "1", "target": "ego", "speed_error": "1", "cte": "1",
    "agent": "ego", "throttle": "1", "brake": "1", "steer": "1", "past_steer": "1", "handBrake": "True", "reverse": "True", "enabled": "True",
    "car": "ego", "thresholdDistance": "1", "signal": "[s for s in network.signals if s.isTrafficLight][0]", "color": "'red'",
    "intersection": "network.intersections[0]", "position": "ego", "scenarios": "[Jaywalker, ParkedCar]", "metres": "1",
    "pos": "ego", "offset": "ego", "heading": "1", "xVel": "1", "yVel": "1",
}  # fmt: skip
"""Arguments that fit, for the parameters without a default."""
DEFINED = {
    d.name: d for module in ("behaviors", "scenarios") for d in parse(driving_module_text(module)).statements
    if isinstance(d, (BehaviorDefinition, ScenarioDefinition))
}  # fmt: skip
PLAIN = {
    d.name: d for module in ("model", "lights", "scenarios")
    for d in parse(driving_module_text(module)).statements if isinstance(d, FunctionDefinition)
}
"""Functions of the library, those for its own use among them."""


def refused(kind: Wanted) -> tuple[str, ...]:
    """The wrong values for a kind; None fits some."""
    words = kind.words.removesuffix(", or None")
    plain = next(k for k in REFUSED if k.words in (words, words.partition(" (Set")[0]))
    return tuple(value for value in REFUSED[plain] if value != NONE or not kind.words.endswith("or None"))


def calls(name: str, kinds: Mapping[str, Wanted]) -> dict[str, tuple[str, str]]:
    """Calls with one wrong argument each: the argument and its value."""
    found = {}
    for wrong, kind in kinds.items():
        fitting = {other: FITTING[other] for other in kinds if other != wrong and other in FITTING}
        for value in refused(kind):
            found[f"{name}({', '.join(f'{k}={v}' for k, v in {**fitting, wrong: value}.items())})"] = (wrong, value)
    return found


def test_the_table_has_every_behavior_and_scenario_with_its_parameters() -> None:
    taking = {name: [p.name for p in d.parameters] for name, d in DEFINED.items() if d.parameters}
    assert {name: list(kinds) for name, kinds in WANTED.items() if name in DEFINED} == taking


def test_the_table_has_every_function_that_is_documented_with_its_parameters() -> None:
    documented = re.findall(r"`(\w+)[(`]", DOCS.read_text(encoding="utf-8"))
    taking = {name: [p.name for p in d.parameters] for name, d in PLAIN.items() if d.parameters and name in documented}
    assert {name: list(kinds) for name, kinds in WANTED.items() if name in PLAIN} == taking


BEHAVIORS = [name for name in WANTED if isinstance(DEFINED.get(name), BehaviorDefinition)]
SCENARIOS = [name for name in WANTED if isinstance(DEFINED.get(name), ScenarioDefinition)]
FUNCTIONS = [name for name in WANTED if name in PLAIN]
CONTROLLERS = [name for name in WANTED if name not in {*DEFINED, *PLAIN} and "." not in name]
ACTIONS: Mapping[str, Mapping[str, Wanted]] = {
    **{name: action.wanted for name, action in a.ACTIONS.items() if action.wanted},
    "SetHandBrakeAction": {"handBrake": basic.TRUTH}, "SetVelocityAction": dict.fromkeys(("xVel", "yVel", "zVel"), basic.NUMBER),
}  # fmt: skip


def told(calls: Iterable[str], way: str) -> list[str]:
    """What is said of wrong calls, which a program catches one after the other."""
    tried = "".join(f"        try:\n            {way} {call}\n        except ValueError as e:\n            said.append(str(e))\n" for call in calls)
    composed = tried if way == "run" else "        wait\n"
    body = "" if way == "run" else f"    if True:\n{tried}"
    program = (
        f"{MODEL}from scenic.domains.driving.scenarios import *\nsaid = []\nbehavior B():\n{body}    wait\nscenario Main():\n    setup:\n"
        f"        ego = Car with behavior B\n        record final said as said\n    compose:\n{composed.replace('run ', 'do ')}        wait\n"
    )
    run = scenic_ref.loads(program, dialect="scenic-2.1", scenario="Main").simulate("kinematic", 4, 0).simulation
    return run.records["said"][-1][1]  # type: ignore[return-value]


def check_told(name: str, kinds: Mapping[str, Wanted], way: str, owner: str = "", of: str = "") -> None:
    """Each wrong argument is named, with its value and what is wanted."""
    wrong = {f"{owner}{call}": one for call, one in calls(name, kinds).items()}
    if name == "SetVelocityAction":
        wrong = {call: one for call, one in wrong.items() if one != ("yVel", NONE)}  # then xVel is the vector
    expected = [f"{of or name}: {arg} must be {kinds[arg].words}, not {'nan' if value == NAN else value}" for arg, value in wrong.values()]
    assert told(wrong, way) == expected


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", BEHAVIORS)
def test_a_behavior_refuses_what_it_cannot_take(name: str) -> None:
    check_told(name, WANTED[name], "do")


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_scenario_refuses_what_it_cannot_take(name: str) -> None:
    check_told(name, WANTED[name], "run")


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_controller_refuses_what_it_cannot_take(name: str) -> None:
    check_told(name, WANTED[name], "", "simulation()." if name.startswith("get") else "")
    if f"{name}.run_step" in WANTED:
        check_told("run_step", WANTED[f"{name}.run_step"], "", f"{name}().", f"{name}.run_step")


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_refuses_what_it_cannot_take(name: str) -> None:
    check_told(name, WANTED[name], "")


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", ACTIONS)
def test_an_action_refuses_what_it_cannot_be(name: str) -> None:
    check_told(name, ACTIONS[name], "take")


def test_every_action_checks_its_arguments() -> None:
    assert set(ACTIONS) == set(a.ACTIONS)
    assert all(set(action.wanted) == {f.name for f in fields(action)} for action in a.ACTIONS.values() if action.wanted)


LINES = {
    "of an object": ("ego = Car with behavior FollowLaneBehavior('fast')\n", 3),
    "that a behavior invokes": ("behavior B():\n    wait\n    do PassingBehavior(-1)\nego = Car with behavior B\n", 5),
    "that another of the library's invokes": ("behavior B():\n    do CrossInFrontOf(self, 1 @ 2, 3, 1)\nego = Car with behavior B\n", 4),
    "an action": ("behavior B():\n    x = 2\n    take SetBrakeAction(x)\nego = Car with behavior B\n", 5),
    "a controller": ("behavior B():\n    c = PIDLateralController(dt=0)\n    wait\nego = Car with behavior B\n", 4),
    "a step of a controller": ("behavior B():\n    c = PIDLateralController()\n    c.run_step(None)\n    wait\nego = Car with behavior B\n", 5),
    "a function": ("behavior B():\n    while withinDistanceToAnyCars(self, -1):\n        wait\nego = Car with behavior B\n", 4),
    "a function of a requirement": ("ego = Car\nrequire always not withinDistanceToAnyObjs(ego, None)\n", 4),
    "a scenario": ("scenario Main():\n    setup:\n        ego = Car\n    compose:\n        do Jaywalker('far')\n", 7),
}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("what", LINES)
def test_it_is_told_at_the_line_of_the_program(what: str) -> None:
    body, line = LINES[what]
    with pytest.raises(ProgramError) as found:
        scenic_ref.loads(f"{MODEL}from scenic.domains.driving.scenarios import *\n{body}").simulate("kinematic", 3, 0)
    assert (found.value.span.file, found.value.span.line) == ("<string>", line)


ALLOWED = [
    "FollowLaneBehavior(0)", "FollowLaneBehavior(target_speed=5, laneToFollow=ego.lane)", "FollowLaneBehavior(laneToFollow=None)",
    "FollowTrajectoryBehavior(trajectory=[ego.lane, *[m.connectingLane for m in ego.lane.maneuvers]], target_speed=5, turn_speed=None)",
    "FollowTrajectoryBehavior(trajectory=[ego.lane], turn_speed=3)", "TurnBehavior(trajectory=ego.lane.centerline, target_speed=4)",
    "TurnBehavior([ego.lane])", "LaneChangeBehavior(laneSectionToSwitch=ego.laneSection, is_oppositeTraffic=False, target_speed=9)",
    "DriveAvoidingCollisions(target_speed=25, avoidance_threshold=10)", "DriveAvoidingCollisions(avoidance_threshold=1e999)",
    "ConstantThrottleBehavior(1)", "AccelerateForwardBehavior()", "FollowTrajectoryBehavior(3, [ego.laneSection])",
    "FollowTrajectoryBehavior(3, [ego, (ego offset by 0 @ 5).position, ego.lane.centerline])",
]  # fmt: skip
"""What the released library's documentation allows, and a little more."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize("call", ALLOWED)
def test_what_the_released_library_documents_is_taken(call: str) -> None:
    run = scenic_ref.loads(f"{MODEL}behavior B():\n    do {call}\nego = Car with behavior B\n").simulate("kinematic", 2, 0).simulation
    assert run.moments[0].actions


def test_what_is_long_is_told_short() -> None:
    assert basic.short_value_text("x" * 100) == f"{'x' * 39!r}"[:-1] + "..."
    assert basic.short_value_text(list(range(1000))) == "a list of 1000"
    assert basic.short_value_text([object()]) == "a list of 1"
    assert basic.short_value_text(math.inf) == "inf"
