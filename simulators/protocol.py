"""The protocol of simulators: their methods, and calls to them in which any mistake of theirs is an error
that says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from types import MappingProxyType
from typing import NamedTuple, Protocol, TypeVar

from ..data.simulation import Body, Pose
from ..roads.network import Network
from ..semantics.machine.operand_kinds import is_scalar
from ..semantics.space.regions import Region, everywhere
from ..semantics.space.vectors import Vector
from ..semantics.store.built_in_classes import SCALAR_PROPERTIES, VECTOR_PROPERTIES
from ..semantics.store.errors import ScenicError, SimulatorError, UsageError
from ..semantics.syntax.nodes import NOWHERE, Span
from .controls import CONTROLS, SHOWN

Given = TypeVar("Given")

PROPERTIES_READ = frozenset({"drives", "walks", "color", SHOWN})
"""Properties that the simulators, or pictures of others, read of a body, beside those of the built-in classes."""


class Surroundings(NamedTuple):
    """The information for a simulator about a scene, besides its objects; nothing in it that can be changed
    is shared with the program or with other runs.

    `params` are copies of the global parameters now, as plain data: what is none is its text. `ego` is the
    number of the ego, None if there is none (yet). `seed`, from 0 to 2^31 - 1, is a function of the seed, of
    the number of the simulation and of the attempt: whatever a simulator draws is to follow from it.
    `timestep` is the simulator's own, in seconds. `network` is the map of a program that uses one,
    `workspace` its workspace (the whole plane, if it has none).
    """

    params: Mapping[str, object] = MappingProxyType({})
    ego: int | None = None
    seed: int = 0
    timestep: float = 1.0
    network: Network | None = None
    workspace: Region = everywhere


class RejectRun(Exception):
    """Raised by `create`, `step` or `read`: this run cannot be simulated, and is discarded with its scene, as if it violated a requirement."""

    def __init__(self, reason: str) -> None:
        super().__init__(checked_reason(reason))
        self.reason = reason


class EndRun(Exception):
    """Raised by `step`: the time step has passed, and was the last one.

    The objects are read once more, and the policy ends the simulation, or discards it if a requirement does not hold. `events` are what happened
    in the time step, as `step` else returns it.
    """

    def __init__(self, reason: str, events: Sequence[str] = ()) -> None:
        super().__init__(checked_reason(reason))
        self.reason = reason
        self.events = events


def checked_reason(reason: object) -> str:
    """A reason in words. Raises `TypeError` for what is none."""
    if not isinstance(reason, str) or not reason.strip():
        raise TypeError(f"the reason must be a text, not {reason!r}")
    return reason


class Simulator(Protocol):
    """The mover of objects; one simulator is used for one simulation after the other.

    `timestep` is in seconds; `properties` are the names of those that `read` gives; `random` says whether
    anything follows from the seed that `create` is given. Whatever it raises ends the simulation with an
    error, but for `RejectRun` and `EndRun`.
    """

    timestep: float
    properties: frozenset[str]
    random: bool

    def create(self, bodies: Sequence[Body], scene: Surroundings) -> None:
        """Begin a simulation with these objects, or add further ones to it: `bodies` are the new ones, in the order of their numbers."""

    def check(self, body: Body, action: object) -> str | None:
        """Why this object cannot take this action, None if it can."""

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """Let the objects take their actions, by number, and let one time step pass. What happened, such as a collision, in words."""
        ...

    def read(self, id: int) -> Pose:
        """The properties of an object now."""
        ...

    def destroy(self) -> None:
        """The simulation has ended."""


METHODS = ("create", "check", "step", "read", "destroy")


def check_usable(simulator: Simulator) -> None:
    """Whether this is a simulator, and not something else. Raises `UsageError`."""
    if isinstance(simulator, type):
        raise UsageError(f"a simulator is an instance, but this is the class {simulator.__name__}", hint=f"give {simulator.__name__}(...)")
    missing = [name for name in METHODS if not callable(getattr(simulator, name, None))]
    if missing:
        hint = f"a simulator must have the methods {', '.join(METHODS)}"
        raise UsageError(f"a simulator is needed, but a {type(simulator).__name__} has no method {', '.join(missing)}", hint=hint)
    timestep = getattr(simulator, "timestep", None)
    if not isinstance(timestep, (int, float)) or isinstance(timestep, bool) or not 0 < timestep < math.inf:
        raise UsageError(f"the timestep of a simulator must be a positive number of seconds, not {timestep!r}")
    properties = getattr(simulator, "properties", None)
    if not (isinstance(properties, (set, frozenset)) and all(isinstance(name, str) for name in properties)):
        raise UsageError("the properties of a simulator must be a set of names")
    if not isinstance(getattr(simulator, "random", None), bool):
        hint = "does anything follow from the seed that create() is given?"
        raise UsageError("the attribute random of a simulator must be True or False", hint=hint)


@contextmanager
def in_use(simulator: Simulator) -> Iterator[None]:
    """A simulation, after which `destroy` is called, however it ended. Raises `SimulatorError`."""
    try:
        yield
    except BaseException:
        with suppress(Exception):  # that it failed before is what counts
            simulator.destroy()
        raise
    call_simulator(simulator.destroy)


class Passed(NamedTuple):
    """A time step in a simulator: what happened, in words, and why it was the last one ("" if it was not)."""

    events: tuple[str, ...]
    ended: str = ""


NOTHING_HAPPENED = Passed(())


def step_of(simulator: Simulator, actions: Mapping[int, tuple[object, ...]]) -> Passed:
    """One time step in the simulator. Raises `SimulatorError`, `RejectRun`."""
    reason = ""
    try:
        events = call_simulator(simulator.step, dict(actions), may=(RejectRun, EndRun))
    except EndRun as end:
        events, reason = end.events, end.reason
    if events == () and not reason:
        return NOTHING_HAPPENED
    if isinstance(events, str) or not isinstance(events, Sequence) or not all(isinstance(event, str) for event in events):
        raise SimulatorError(f"step() must return what happened as a sequence of texts, not {events!r}", NOWHERE)
    return Passed(tuple(events), reason)


def read_poses(simulator: Simulator, objects: Iterable[tuple[int, object, Span]]) -> list[Pose]:
    """Read the simulator's current values of objects, each given by its number, its name in errors and its
    place.

    Each is checked and copied before the next is read, since a simulator may give the same mapping again.
    Raises `SimulatorError`, `RejectRun`.
    """

    def read() -> list[Pose]:
        return [dict(checked_pose(simulator.read(id), simulator, who, span)) for id, who, span in objects]

    return call_simulator(read, may=(RejectRun,))


def controls_of(id: int, properties: Mapping[str, object], simulator: Simulator) -> Pose:
    """Return how the controls of an object are set, if it is one that shows them and the simulator has such controls."""
    told = getattr(simulator, "controls", None)
    return told(id) if told is not None and properties.get(SHOWN) is True else {}


def updated_properties(properties: Mapping[str, object], simulator: Simulator) -> Pose:
    """Return those properties of an object that the simulator updates, as far as it has them."""
    names = sorted(simulator.properties)
    if properties.get(SHOWN) is True and hasattr(simulator, "controls"):
        names += CONTROLS
    return {name: properties[name] for name in names if name in properties}


def checked_pose(pose: Pose, simulator: Simulator, who: object, span: Span) -> Pose:
    """Check the simulator's values of an object, whose name in errors is `who`.

    Raises `SimulatorError` for other properties than it declares, and values that they cannot have.
    """
    if not isinstance(pose, Mapping) or pose.keys() != simulator.properties:
        said = ", ".join(sorted(map(str, pose))) if isinstance(pose, Mapping) else repr(pose)
        declared = ", ".join(sorted(simulator.properties)) or "nothing"
        raise SimulatorError(f"the simulator gives {said or 'nothing'} for {who}, but declares {declared}", span)
    for name, value in pose.items():
        if not could_be(name, value):
            raise SimulatorError(f"the simulator gives {value!r} as the {name} of {who}", span)
    return pose


def could_be(name: str, value: object) -> bool:
    """Whether this is a value of the property: finite numbers, in a vector or alone, where the language wants one of these."""
    if type(value) is float:
        return math.isfinite(value) and name not in VECTOR_PROPERTIES
    if type(value) is Vector:
        return math.isfinite(value.x) and math.isfinite(value.y) and name not in SCALAR_PROPERTIES
    return name not in VECTOR_PROPERTIES and (is_scalar(value) or name not in SCALAR_PROPERTIES)


def call_simulator(operation: Callable[..., Given], *arguments: object, may: tuple[type[Exception], ...] = ()) -> Given:
    """Return the simulator's answer; whatever it raises becomes a `SimulatorError`, except what it `may`
    raise.
    """
    try:
        return operation(*arguments)
    except (ScenicError, *may):
        raise
    except (RejectRun, EndRun) as problem:
        what, where = ("rejected", "create(), step() and read()") if isinstance(problem, RejectRun) else ("ended", "step()")
        name = getattr(operation, "__name__", "?")
        raise SimulatorError(f"the simulator {what} the run in {name}(), which only {where} can: {problem.reason}", NOWHERE) from problem
    except Exception as problem:
        raise SimulatorError(f"the simulator failed: {type(problem).__name__}: {problem}", NOWHERE) from problem
