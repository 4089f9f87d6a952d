"""Simulations that were run, as records and as JSON, one a line: the scene, and for each time step the objects, the actions and the events."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import NamedTuple

from ..interpreter.runtime.process_sandbox import limit_time
from ..pictures.notebook_views import count_phrase, short_text
from .scene import OWN_FIELDS, Scene, in_json, json_value, portable

SCHEMA = "scenic-ref/simulation/1"


Pose = Mapping[str, object]
"""Properties of an object that the simulator updates: `position` (a `Vector`, metres), `heading` (radians), `speed` (metres per second), ..."""


class Body(NamedTuple):
    """An object as a simulator sees it: its number in the scene, the name of its class, and its properties."""

    id: int
    class_name: str
    properties: Mapping[str, object]

    def __reduce__(self) -> tuple[Callable[..., Body], tuple[object, ...]]:
        """For `pickle`; see `SceneObject.__reduce__`."""
        return Body, (self.id, self.class_name, portable(dict(self.properties)))


class Moment(NamedTuple):
    """A time step: the objects at its start, the actions taken in it, what happened, and which behavior each agent is in, on which line."""

    step: int
    objects: tuple[Pose, ...]
    actions: Mapping[int, tuple[object, ...]]
    events: tuple[str, ...]
    doing: Mapping[int, str] = MappingProxyType({})

    def __repr__(self) -> str:
        happened = f", {short_text('; '.join(self.events))}" if self.events else ""
        return f"<time step {self.step}, {count_phrase(len(self.objects), 'object')}, {count_phrase(len(self.actions), 'agent')} acting{happened}>"

    def __reduce__(self) -> tuple[Callable[..., Moment], tuple[object, ...]]:
        """For `pickle`."""
        return Moment, (self.step, self.objects, dict(self.actions), self.events, dict(self.doing))


class Simulated(NamedTuple):
    """A simulation that was accepted: its scene, its time steps, how it ended ("terminated" or "time limit") and why; `timestep` is in seconds,
    `created` are the objects that scenarios made on the way, as they were then, and `records` the values that the program recorded, each with its
    time step.
    """

    scene: Scene
    moments: tuple[Moment, ...]
    result: str
    reason: str
    timestep: float
    created: tuple[Body, ...] = ()
    records: Mapping[str, tuple[tuple[int, object], ...]] = MappingProxyType({})

    def __repr__(self) -> str:
        last = self.moments[-1].step if self.moments else 0
        scene = f"simulation {self.scene.index} of seed {self.scene.seed}, {count_phrase(len(self.scene.objects), 'object')}"
        return f"<{scene}, {count_phrase(last, 'time step')} ({last * self.timestep:g} s), {self.result}: {short_text(self.reason)}>"

    def __reduce__(self) -> tuple[Callable[..., Simulated], tuple[object, ...]]:
        """For `pickle`; see `SceneObject.__reduce__`."""
        records = {name: tuple((step, portable(value)) for step, value in values) for name, values in self.records.items()}
        return Simulated, (*self[:-1], records)


@limit_time("writing a simulation")
def to_json(run: Simulated, attempts: int) -> dict[str, object]:
    """A simulation, and how many attempts it took, in the simulation format."""
    records = {name: [[step, json_value(value)] for step, value in values] for name, values in run.records.items()}
    return {
        "schema": SCHEMA, "seed": run.scene.seed, "run": run.scene.index, "attempts": attempts, "timestep": run.timestep,
        "scene": run.scene.to_json(), "created": [body_json(body) for body in run.created],
        "steps": [moment_json(moment) for moment in run.moments], "result": run.result, "reason": run.reason,
        **({"records": records} if records else {}),
    }


def to_line(run: Simulated, attempts: int) -> str:
    """One line of a JSON Lines file. Raises `ValueError` for numbers that JSON does not have."""
    return in_json(to_json(run, attempts))


def body_json(body: Body) -> dict[str, object]:
    """An object that was made while the scenario ran, as it was then."""
    values = {name: json_value(value) for name, value in body.properties.items()}
    own = {name: values.pop(name) for name in OWN_FIELDS}
    return {"id": body.id, "class": body.class_name, **own, "properties": values}


def moment_json(moment: Moment) -> dict[str, object]:
    """Return a time step as JSON."""
    return {
        "step": moment.step,
        "objects": [{"id": k, **{name: json_value(value) for name, value in pose.items()}} for k, pose in enumerate(moment.objects)],
        "actions": actions_json(moment.actions), "events": list(moment.events), "doing": {str(id): text for id, text in sorted(moment.doing.items())},
    }


def actions_json(actions: Mapping[int, tuple[object, ...]]) -> dict[str, object]:
    """The actions of each agent that takes some."""
    return {str(id): [action_json(action) for action in taken] for id, taken in sorted(actions.items())}


def action_json(action: object) -> object:
    """An action with its arguments, or a plain value."""
    if is_dataclass(action) and not isinstance(action, type):
        return {"action": type(action).__name__, "args": [json_value(getattr(action, f.name)) for f in fields(action)]}
    return json_value(action)
