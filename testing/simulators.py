"""What any simulator must do, checked call by call: for the tests of those who connect their own.

    from scenic_ref.testing import check_simulator

    def test_my_simulator():
        check_simulator(MySimulator, action=SetSpeed(3))
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy

from ..formats.recordings import Body, Pose
from ..interpreter.choosers import from_stream
from ..interpreter.running import drive
from ..scenario import loads
from ..semantics.kernel.outcome import Done
from ..semantics.space.vectors import Vector
from ..simulators.protocol import Simulator
from ..simulators.simulating import body_of

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


def check_simulator(make: Callable[[], Simulator], action: object = None, *, class_name: str = "Car") -> None:
    """Check the simulator that `make` gives, as often as it is called; with `action`, also that an object can take this one.

    The objects are of a class of that name, 2 m wide and 4 m long, 30 m apart. Raises `BrokenContract`, which says what was promised, and
    whatever the simulator raises.
    """
    bodies = bodies_of(class_name)
    first, other = make(), make()
    check_declarations(first)
    given = deepcopy([dict(body.properties) for body in bodies])
    course = course_of(first, bodies, action)
    promise([dict(body.properties) for body in bodies] == given, "the properties of the bodies that it is given stay as they are")
    check_poses(first, bodies, course)
    check_answers(first, bodies, action)
    promise(course_of(first, bodies, action) == course, "after destroy() it can be used again, and the same actions give the same course")
    other.create(bodies[:1])
    promise(course_of(first, bodies, action) == course, "two simulators do not affect each other")
    other.destroy()
    other.destroy()


def promise(kept: bool, text: str) -> None:
    """Raise `BrokenContract` unless the promise is kept."""
    if not kept:
        raise BrokenContract(f"the simulator breaks this promise: {text}")


def bodies_of(class_name: str) -> list[Body]:
    """The objects, as a scenario gives them to a simulator."""
    generated, _ = drive(loads(CLASS.format(class_name) + PROGRAM.format(class_name)).start(), from_stream(0, 0, 0))
    assert isinstance(generated, Done)
    return [body_of(k, generated.state) for k in range(len(generated.state.scene))]


def check_declarations(simulator: Simulator) -> None:
    """`timestep` and `properties`."""
    is_number = isinstance(simulator.timestep, (int, float)) and math.isfinite(simulator.timestep)
    promise(is_number and simulator.timestep > 0, "`timestep` is a positive number of seconds")
    names = simulator.properties
    promise(isinstance(names, (set, frozenset)) and all(isinstance(name, str) for name in names), "`properties` is a set of names")
    if names:
        promise("position" in names, "where anything moves, `position` is among the `properties`")


def course_of(simulator: Simulator, bodies: Sequence[Body], action: object) -> Course:
    """A simulation of two objects, to which a third is added after the first time step: what `read` gives before each step and at the end."""
    early, late = list(bodies[:2]), list(bodies[2:])
    actions: Mapping[int, Sequence[object]] = {} if action is None else {0: (action,)}
    try:
        simulator.create(early)
        course: Course = [{body.id: dict(simulator.read(body.id)) for body in early}]
        for number in range(STEPS):
            if number == 1:
                simulator.create(late)
                course[-1] |= {body.id: dict(simulator.read(body.id)) for body in late}
            events = simulator.step(actions)
            is_told = isinstance(events, Sequence) and not isinstance(events, str) and all(isinstance(event, str) for event in events)
            promise(is_told, "step() gives what happened as a sequence of texts")
            there = bodies if number >= 1 else early
            course.append({body.id: dict(simulator.read(body.id)) for body in there})
    finally:
        simulator.destroy()
    return course


def check_poses(simulator: Simulator, bodies: Sequence[Body], course: Course) -> None:
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
        for body in new:
            for name in ("position", "heading"):
                if name in poses[body.id]:
                    promise(poses[body.id][name] == body.properties[name], f"after create() the {name} of an object is that of its body")


def check_answers(simulator: Simulator, bodies: Sequence[Body], action: object) -> None:
    """`check` gives a reason, or None."""
    simulator.create(bodies)
    try:
        for value in (Nothing(), action):
            answer = simulator.check(bodies[0], value)
            promise(answer is None or (isinstance(answer, str) and answer != ""), "check() gives None or a reason, for any value")
        promise(action is None or simulator.check(bodies[0], action) is None, f"object 0 can take the action {action!r}")
    finally:
        simulator.destroy()
