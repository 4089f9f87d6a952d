"""Recorded simulations played again: the actions of the recording are taken, in any simulator, and the objects are read back.

The policy does not run. The scene is generated anew from the program, and must be the recorded one. The simulator has the seed of the recording; it
may reject the replay, or end it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from ..data.recording_reader import RecordedAction, RecordedStep, Recording
from ..data.scene import Scene, json_value, scene_of
from ..data.simulation import Body, Moment, Pose, Simulated
from ..interpreter.runtime.answerers import from_stream
from ..interpreter.runtime.program_run import DEFAULT_FUEL, Accepted, generate_scene
from ..interpreter.runtime.random_streams import simulator_seed
from ..semantics.dynamics.policy import begin
from ..semantics.machine.config import Config, State
from ..semantics.store.errors import UsageError
from ..semantics.syntax.nodes import NOWHERE
from .loop import ENDED, Failed, create_new, rejected_by_simulator, surroundings
from .protocol import (
    RejectRun,
    Simulator,
    Surroundings,
    call_simulator,
    check_usable,
    controls_of,
    in_use,
    read_poses,
    step_of,
    updated_properties,
)

TOLERANCE = 1e-9
"""How much numbers may differ: metres, radians, ..., and relative to numbers above 1."""
ActionClasses = Mapping[str, Callable[..., object]]


class Difference(NamedTuple):
    """The `first` time step in which a replay differs from its recording; and how far apart, in metres, which object is at most."""

    first: int
    distance: float
    object: int


def replay_once(
    config: Config, recording: Recording, simulator: Simulator, classes: ActionClasses, *, fuel: int = DEFAULT_FUEL
) -> Simulated | Failed:
    """The recorded actions in a simulator. `classes` are those of actions, by name; what agents do is as recorded, and also how it ends, unless the
    simulator ends it.

    Raises `UsageError` for a recording of another program, and for actions that cannot be taken; `SimulatorError` for the simulator's errors.
    """
    check_usable(simulator)
    state, scene = scene_again(config, recording, fuel)
    state = begin(state, simulator.timestep, simulator.properties)
    chance = simulator_seed(recording.seed, recording.run, recording.attempts - 1)
    about = surroundings(simulator, state, chance)
    moments: list[Moment] = []
    with in_use(simulator):
        try:
            bodies = create_new(simulator, state, 0, chance)
            ended = replay_steps(recording, simulator, classes, bodies, about, moments)
        except RejectRun as problem:
            return rejected_by_simulator(problem, len(moments))
    result, reason = (ENDED, ended) if ended else (recording.result, recording.reason)
    count = len(moments[-1].objects) - len(scene.objects)
    return Simulated(scene, tuple(moments), result, reason, simulator.timestep, recording.created[:count])


def replay_steps(
    recording: Recording, simulator: Simulator, classes: ActionClasses, bodies: list[Body], about: Surroundings, moments: list[Moment]
) -> str:
    """The time steps of a replay, which are added to `moments`; why the simulator ended it, "" if it did not.

    Raises as `replay_once`, and `RejectRun`.
    """
    first, ended = len(bodies), ""
    for number, step in enumerate(recording.steps):
        new = recording.created[len(bodies) - first : len(step.objects) - first]
        bodies = [*bodies, *new]
        if ended or step is recording.steps[-1]:
            moments.append(Moment(number, poses(bodies, simulator), {}, (), step.doing if step is recording.steps[-1] else {}))
            break
        if new:
            call_simulator(simulator.create, list(new), about, may=(RejectRun,))
        actions = actions_of(step, number, bodies, simulator, classes)
        before = poses(bodies, simulator)
        events, ended = step_of(simulator, actions)
        read_again = read_bodies(bodies, simulator)
        moments.append(Moment(number, before, actions, events, step.doing))
        bodies = read_again
    return ended


def scene_again(config: Config, recording: Recording, fuel: int) -> tuple[State, Scene]:
    """The state at the end of the recorded attempt, and its scene. Raises `UsageError` unless that is the recorded scene."""
    generated = generate_scene(config, from_stream(recording.seed, recording.run, recording.scene_attempts - 1), fuel=fuel)
    if isinstance(generated, Accepted):
        scene = scene_of(generated.state, recording.seed, recording.run, recording.scene_attempts, simulated=True)
        if close(json.loads(scene.to_line()), recording.scene):
            return generated.state, scene
    raise UsageError(
        f"its scene is not scene {recording.run} of seed {recording.seed} of this program",
        hint="it was recorded with another program, other options (-p, --scenario, --model, --reading, ...) or another version",
    )


def actions_of(
    step: RecordedStep, number: int, bodies: Sequence[Body], simulator: Simulator, classes: ActionClasses
) -> dict[int, tuple[object, ...]]:
    """The actions of a time step, by object, which the simulator accepts. Raises `UsageError`."""
    return {id: tuple(action_for(bodies[id], one, number, simulator, classes) for one in taken) for id, taken in step.actions.items()}


def action_for(body: Body, recorded: object, number: int, simulator: Simulator, classes: ActionClasses) -> object:
    """A recorded action for an object. Where any value is an action, those of unknown classes are taken as they are written."""
    where = f"object {body.id} (class {body.class_name}) cannot take the action of time step {number}"
    if not isinstance(recorded, RecordedAction):
        action, unknown = recorded, ""
    elif recorded.name in classes:
        action, unknown = construct_action(classes[recorded.name], recorded, where), ""
    else:
        action = {"action": recorded.name, "args": list(recorded.arguments)}
        unknown = f"there is no action {recorded.name[:80]}"
    reason = call_simulator(simulator.check, body, action)
    if reason is not None:
        raise UsageError(f"{where}: {unknown or reason}", hint=f"there are {', '.join(classes)}" if unknown else "")
    return action


def construct_action(kind: Callable[..., object], recorded: RecordedAction, where: str) -> object:
    """The action with its arguments. Raises `UsageError`."""
    try:
        return kind(*recorded.arguments)
    except Exception as problem:  # whatever a class of the program raises, these are not its arguments
        named = "" if str(problem).startswith(f"{recorded.name}:") else f"{recorded.name}: "
        raise UsageError(f"{where}: {named}{problem}") from None


def read_bodies(bodies: Sequence[Body], simulator: Simulator) -> list[Body]:
    """The objects as the simulator has them now. Raises `SimulatorError`."""
    said = read_poses(simulator, [(body.id, f"object {body.id}", NOWHERE) for body in bodies])
    return [
        body._replace(properties={**body.properties, **pose, **controls_of(body.id, body.properties, simulator)})
        for body, pose in zip(bodies, said, strict=True)
    ]


def poses(bodies: Sequence[Body], simulator: Simulator) -> tuple[Pose, ...]:
    """The properties of all objects that the simulator updates, as far as they have them."""
    return tuple(updated_properties(body.properties, simulator) for body in bodies)


# What differs


def difference_of(recording: Recording, simulation: Simulated) -> Difference | None:
    """Return where a replay differs from its recording, as far as it goes; None if it does nowhere.

    What is not recorded in a time step is as it was at first.
    """
    beginnings = beginnings_of(simulation)
    first: int | None = None
    farthest, which = 0.0, None
    for number, (step, moment) in enumerate(zip(recording.steps, simulation.moments)):
        for id, (was, now) in enumerate(zip(step.objects, moment.objects, strict=True)):
            before = {**beginnings[id], **was}
            after = {**beginnings[id], **{name: json_value(value) for name, value in now.items()}}
            if all(close(after[name], before[name]) for name in before.keys() & after.keys()):
                continue
            first = number if first is None else first
            distance = math.dist(before["position"], after["position"])  # type: ignore[arg-type]
            if which is None or distance > farthest:
                farthest, which = distance, id
    return None if first is None or which is None else Difference(first, farthest, which)


def beginnings_of(simulation: Simulated) -> list[Mapping[str, object]]:
    """The properties of all objects at first, as JSON."""
    scene = [{**o.properties, "position": o.position, "heading": o.heading} for o in simulation.scene.objects]
    return [{name: json_value(value) for name, value in one.items()} for one in (*scene, *(dict(body.properties) for body in simulation.created))]


def close(one: object, other: object) -> bool:
    """Whether two JSON values are the same, but for tiny differences of numbers."""
    match one, other:
        case (bool(), _) | (_, bool()):
            return one is other
        case (int() | float(), int() | float()):
            return one == other or near(one, other)
        case (list(), list()):
            return len(one) == len(other) and all(map(close, one, other))
        case (dict(), dict()):
            return one.keys() == other.keys() and all(close(value, other[name]) for name, value in one.items())
        case _:
            return one == other


def near(one: float, other: float) -> bool:
    """Whether two numbers differ by no more than `TOLERANCE`."""
    try:
        return abs(one - other) <= TOLERANCE * max(1.0, abs(one), abs(other))
    except OverflowError:
        return False


