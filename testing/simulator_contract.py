"""The contract of simulators, checked call by call: for the tests of those who connect their own.

    from scenic_ref.testing import check_simulator

    def test_my_simulator():
        check_simulator(MySimulator, action=SetSpeed(3))
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from ..api import loads
from ..data.scene import json_value
from ..data.simulation import Body, Pose
from ..interpreter.runtime.answerers import from_stream
from ..interpreter.runtime.program_run import drive
from ..semantics.machine.outcome import Done
from ..semantics.space.vectors import Vector
from ..simulators.loop import body_of, surroundings
from ..simulators.protocol import EndRun, RejectRun, Simulator, Surroundings

STEPS = 3
CLASS = "class {}:\n    width: 2\n    length: 4\n    drives: True\n"
PROGRAM = """
ego = {0} at (0, 0)
{0} at (30, 0), facing 1
{0} at (-30, 0), with velocity (0, 2)
"""

Course = list[dict[int, Pose]]


class BrokenContract(AssertionError):
    """A simulator does not do what `Simulator` says."""


class Nothing:
    """A value that is not an action, except in the world `still`."""


class Checked(NamedTuple):
    """Objects, as a scenario gives them to a simulator, and what surrounds them; the seed is 0 unless another is asked for."""

    bodies: list[Body]
    about: Callable[[int], Surroundings]


def check_simulator(
    make: Callable[[], Simulator], action: object = None, *, class_name: str = "Car", program: str | None = None, tolerance: float = 0.0,
    rejected: str | None = None, ends_within: int | None = None,
) -> None:  # fmt: skip
    """Check the simulator that `make` gives, as often as it is called; with `action`, also that object 0 can take this one.

    The objects are three of a class of that name, 2 m wide and 4 m long, 30 m apart, or those of `program`, of which the third and later ones are
    created after the first time step. Numbers of courses that must be the same may differ by `tolerance` (in the unit of the property), and so may
    where an object is from where it was put. `rejected` is a program whose scenes the simulator rejects; `ends_within` says after how many
    time steps, with this action, it will have ended a run.

    Raises `BrokenContract`, which says what was promised, and whatever the simulator raises.
    """
    first, other = make(), make()
    check_declarations(first)
    scene = scene_for(first, CLASS.format(class_name) + PROGRAM.format(class_name) if program is None else program)
    bodies = scene.bodies
    given = bodies_json(bodies)
    course = course_of(first, scene, action)
    promise(bodies_json(bodies) == given, "the properties of the bodies that it is given stay as they are")
    check_poses(first, bodies, course, tolerance)
    check_answers(first, scene, action)

    def same(promised: str, seed: int = 0) -> None:
        promise(is_same_course(course_of(first, scene, action, seed), course, tolerance), promised)

    same("after destroy() it can be used again, and the same actions give the same course")
    if not first.random:
        same("where `random` is False, nothing follows from the seed", seed=1)
    other.create(bodies[:1], scene.about(0))
    same("two simulators do not affect each other")
    other.destroy()
    other.destroy()
    if rejected is not None:
        check_rejection(first, scene_for(first, rejected), action)
        same("after a run that it rejected it can be used again")
    if ends_within is not None:
        check_end(first, scene, action, ends_within)
        same("after a run that it ended it can be used again")


def promise(kept: bool, text: str) -> None:
    """Raise `BrokenContract` unless the promise is kept."""
    if not kept:
        raise BrokenContract(f"the simulator breaks this promise: {text}")


def scene_for(simulator: Simulator, program: str) -> Checked:
    """The first scene of a program, as a scenario gives it to a simulator. Raises `AttemptsExhausted`, and the errors of the program."""
    scenario = loads(program)
    generated, _ = drive(scenario.start(), from_stream(0, 0, scenario.sampled().scene.attempts - 1))
    assert isinstance(generated, Done)
    state = generated.state
    return Checked([body_of(k, state) for k in range(len(state.scene))], lambda seed: surroundings(simulator, state, seed))


def bodies_json(bodies: Sequence[Body]) -> list[dict[str, object]]:
    """Return the current properties of the bodies as JSON."""
    return [{name: json_value(value) for name, value in body.properties.items()} for body in bodies]


def is_same_course(one: Course, other: Course, tolerance: float) -> bool:
    """Whether two courses are the same, up to a tolerance."""
    if len(one) != len(other) or any(a.keys() != b.keys() for a, b in zip(one, other)):
        return False
    poses = [(a[id], b[id]) for a, b in zip(one, other) for id in a]
    return all(was.keys() == now.keys() and all(near(name, was[name], now[name], tolerance) for name in was) for was, now in poses)


def near(name: str, one: object, other: object, tolerance: float) -> bool:
    """Whether two values of a property are the same, up to a tolerance; headings may differ by full turns."""
    if isinstance(one, Vector) and isinstance(other, Vector):
        return abs(one.x - other.x) <= tolerance and abs(one.y - other.y) <= tolerance
    if isinstance(one, float) and isinstance(other, (int, float)):
        return abs(math.remainder(one - other, math.tau) if name == "heading" else one - other) <= tolerance
    return one == other


def check_declarations(simulator: Simulator) -> None:
    """`timestep` and `properties`."""
    is_number = isinstance(simulator.timestep, (int, float)) and math.isfinite(simulator.timestep)
    promise(is_number and simulator.timestep > 0, "`timestep` is a positive number of seconds")
    promise(isinstance(getattr(simulator, "random", None), bool), "`random` is True or False")
    names = simulator.properties
    promise(isinstance(names, (set, frozenset)) and all(isinstance(name, str) for name in names), "`properties` is a set of names")
    if names:
        promise("position" in names, "where anything moves, `position` is among the `properties`")


def course_of(simulator: Simulator, scene: Checked, action: object, seed: int = 0) -> Course:
    """A simulation of two objects, to which the others are added after the first time step: what `read` gives before each step and at the end."""
    bodies, about = scene.bodies, scene.about(seed)
    early, late = list(bodies[:2]), list(bodies[2:])
    there = early
    try:
        simulator.create(early, about)
        course: Course = [{body.id: dict(simulator.read(body.id)) for body in early}]
        for number in range(STEPS):
            if number == 1 and late:
                simulator.create(late, about)
                course[-1] |= {body.id: dict(simulator.read(body.id)) for body in late}
                there = bodies
            ended = step_once(simulator, action)
            course.append({body.id: dict(simulator.read(body.id)) for body in there})
            if ended:
                break
    except RejectRun as problem:
        raise BrokenContract(f"the simulator rejects the scene of this check ({problem.reason}): give another `program`") from None
    except EndRun as problem:
        raise BrokenContract(f"the simulator breaks this promise: only step() ends a run ({problem.reason})") from None
    finally:
        simulator.destroy()
    return course


def step_once(simulator: Simulator, action: object) -> bool:
    """One time step, in which object 0 takes the action; whether the simulator ends the run with it."""
    actions: Mapping[int, Sequence[object]] = {} if action is None else {0: (action,)}
    ended = False
    try:
        events = simulator.step(actions)
    except EndRun as end:
        events, ended = end.events, True
    is_told = isinstance(events, Sequence) and not isinstance(events, str) and all(isinstance(event, str) for event in events)
    promise(is_told, "step() gives what happened as a sequence of texts")
    return ended


def check_rejection(simulator: Simulator, scene: Checked, action: object) -> None:
    """A scene that the simulator rejects, when it is created or within some time steps."""
    rejected = False
    try:
        simulator.create(scene.bodies, scene.about(0))
        for _ in range(STEPS):
            if step_once(simulator, action):
                break
            for body in scene.bodies:
                simulator.read(body.id)
    except RejectRun:
        rejected = True
    finally:
        simulator.destroy()
    promise(rejected, "the scene of `rejected` is rejected, with `RejectRun`")


def check_end(simulator: Simulator, scene: Checked, action: object, steps: int) -> None:
    """A run that the simulator ends; it can be read once more."""
    try:
        simulator.create(scene.bodies, scene.about(0))
        promise(any(step_once(simulator, action) for _ in range(steps)), f"a run is ended within {steps} time steps, with `EndRun`")
        poses = [simulator.read(body.id) for body in scene.bodies]
        promise(all(set(pose) == set(simulator.properties) for pose in poses), "after the last time step read() gives all of the `properties`")
    finally:
        simulator.destroy()


def check_poses(simulator: Simulator, bodies: Sequence[Body], course: Course, tolerance: float) -> None:
    """Every property comes back for every object, as a number that is one; what has just been created is where it was put."""
    for poses in course:
        for id, pose in poses.items():
            promise(set(pose) == set(simulator.properties), f"read() gives all of the `properties`, and no others, for object {id}")
            for name, value in pose.items():
                numbers = (value.x, value.y) if isinstance(value, Vector) else (value,)
                is_number = all(not isinstance(n, float) or math.isfinite(n) for n in numbers)
                promise(is_number, f"the {name} of object {id} is a finite number or a Vector of two")
            if "position" in pose:
                promise(isinstance(pose["position"], Vector), "a position is a `Vector`")
    for poses, new in ((course[0], bodies[:2]), (course[1], bodies[2:])):
        for body in (body for body in new if body.id in poses):
            for name in ("position", "heading"):
                if name in poses[body.id]:
                    there = near(name, poses[body.id][name], body.properties[name], tolerance)
                    promise(there, f"after create() the {name} of an object is that of its body")


def check_answers(simulator: Simulator, scene: Checked, action: object) -> None:
    """`check` gives a reason, or None."""
    simulator.create(scene.bodies, scene.about(0))
    try:
        for value in (Nothing(), action):
            answer = simulator.check(scene.bodies[0], value)
            promise(answer is None or (isinstance(answer, str) and answer != ""), "check() gives None or a reason, for any value")
        promise(action is None or simulator.check(scene.bodies[0], action) is None, f"object 0 can take the action {action!r}")
    except (RejectRun, EndRun) as problem:
        raise BrokenContract(f"the simulator breaks this promise: check() neither rejects nor ends a run ({problem.reason})") from None
    finally:
        simulator.destroy()
