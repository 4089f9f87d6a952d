"""The loop of a simulation: the policy chooses actions, a simulator executes them for one time step, and its objects are read back.

A simulator is anything with the methods of `Simulator`. A run that fails a requirement is rejected as a whole (reading
`rejected-simulation`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import NamedTuple, Protocol

from ..data.scene import Scene, portable, scene_of
from ..data.simulation import Body, Moment, Pose, Simulated
from ..interpreter.runtime.program_run import DEFAULT_FUEL, Chooser, Witness, drive
from ..interpreter.runtime.random_streams import simulator_seed
from ..roads.network import Network
from ..semantics.dynamics.invocations import describe_behaviors
from ..semantics.dynamics.policy import after_one_step, begin, policy
from ..semantics.machine.config import Config, State
from ..semantics.machine.error_places import caller_in, of_program
from ..semantics.machine.outcome import Act, Done, Finish, Next, Outcome, Requirement, Stuck
from ..semantics.machine.simulation_state import Running, satisfied_eventually_lines, simulation_of, span_line_text
from ..semantics.machine.values import Instance, copy_containers, value_in_run
from ..semantics.programs import ego_of
from ..semantics.scenes.default_requirements import workspace_of
from ..semantics.store.errors import RunError, SimulatorError, UsageError
from ..semantics.syntax.nodes import NOWHERE, Span
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
from .still import Still
from .worlds.driving import MAP

OF_SIMULATOR = "simulator"
"""The kind of what a run fails that a simulator rejects: no condition of the program."""
TERMINATED, LIMIT, ENDED, SETTLED = "terminated", "time limit", "ended by the simulator", "settled"
"""The results of a simulation."""


Settled = Callable[[Moment], str | None]
"""Is shown each time step when it has passed; what it says, if anything, is why the outcome of the simulation is settled, which ends then."""


class Failed(NamedTuple):
    """A simulation that was rejected: the requirement, and the time step in which it failed (None: while the scene was generated)."""

    requirement: Requirement
    step: int | None

    @property
    def place(self) -> str:
        """When it failed, in words."""
        return "in the scene" if self.step is None else f"in time step {self.step}"


def rejected_by_simulator(problem: RejectRun, step: int) -> Failed:
    """A run that the simulator rejects, in a time step."""
    return Failed(Requirement(OF_SIMULATOR, NOWHERE, f"the simulator rejected the run: {problem.reason}"), step)


class Policy(Protocol):
    """The chooser of actions in each time step: the machine, or compiled code that gives the same."""

    def __call__(self, state: State, limit: str) -> Act | Finish | Stuck:
        """The actions of a time step, or its end; `limit` is the reason to end in it if there is no other."""
        ...

    def doing(self, state: State) -> dict[int, str]:
        """Which behaviors each agent is in, with the number of its instance."""
        ...

    def place(self, instance: Instance, state: State) -> tuple[Span, str]:
        """Return where an object has taken its actions of this time step, and a hint if a library module did
        it for the program.
        """
        ...


PolicyMaker = Callable[[State, Witness], Policy]
"""Gives the policy of a simulation from the state before its first time step; the witness is to be shown what is an event."""


class MachinePolicy:
    """The policy that the machine computes."""

    def __init__(self, choose: Chooser, fuel: int, state: State, witness: Witness) -> None:
        self.choose, self.fuel, self.witness = choose, fuel, witness

    def __call__(self, state: State, limit: str) -> Act | Finish | Stuck:
        """The seven steps, by their rules. Raises the program's error."""
        outcome, _ = drive(policy(state, limit), self.choose, fuel=self.fuel, witness=self.witness)
        assert isinstance(outcome, (Act, Finish, Stuck))
        return outcome

    def doing(self, state: State) -> dict[int, str]:
        """Which behaviors each agent is in, and where."""
        return {n: text for n, agent in simulation_of(state).agents.items() if (text := describe_behaviors(agent))}

    def place(self, instance: Instance, state: State) -> tuple[Span, str]:
        """Return where the behavior waits, if it does so in a statement; else where the object was made."""
        process = simulation_of(state).agents[instance.number].process
        if process is None or not process.span.line:
            return instance.span, ""
        caller = caller_in(process.frames)
        return of_program(process.span, instance.span if caller == NOWHERE else caller)


def simulate_once(
    config: Config, choose: Chooser, simulator: Simulator, steps: int, *, seed: int = 0, index: int = 0, attempt: int = 0,
    tried: int | None = None, fuel: int = DEFAULT_FUEL, witness: Witness | None = None, by: PolicyMaker | None = None,
    settled: Settled | None = None,
) -> Simulated | Failed:  # fmt: skip
    """One run: a scene, then at most `steps` time steps. Raises the program's error, `SimulatorError` for the simulator's, and `UsageError`.

    `attempt` is the scene's, `tried` that of the simulation, from which the simulator's seed follows; they differ where a scene is kept. The policy
    is the machine's, or is made `by` something else. The run ends early where its outcome is `settled`.
    """
    check_usable(simulator)
    generated, _ = drive(config, choose, fuel=fuel, witness=witness)
    if isinstance(generated, Stuck):
        return Failed(generated.requirement, None)
    assert isinstance(generated, Done)
    scene = scene_of(generated.state, seed, index, attempt + 1, simulated=True)
    with in_use(simulator):
        chance = simulator_seed(seed, index, attempt if tried is None else tried)
        return simulate_scene(scene, generated.state, by or partial(MachinePolicy, choose, fuel), simulator, steps, chance, witness, settled)


def simulate_scene(
    scene: Scene, generated: State, make: PolicyMaker, simulator: Simulator, steps: int, chance: int, witness: Witness | None,
    settled: Settled | None = None,
) -> Simulated | Failed:
    """The time steps of a scene: in the last one, after `steps` of them, the time limit ends the scenario if nothing else does.

    The simulator, whose seed is `chance`, may end it as well: the policy then finds that in the next time step, as it does the time limit.
    """
    state = begin(generated, simulator.timestep, simulator.properties)
    moments: list[Moment] = []
    told: list[str] = []
    chosen = make(state, listening_witness(told, witness, file_of(state)))
    held: set[int] = set()
    known: Mapping[int, Running] = {}
    first = len(state.scene)
    made = new_bodies(state, 0)
    try:
        create(simulator, made, state, chance)
    except RejectRun as problem:
        return rejected_by_simulator(problem, 0)
    limit = "1 time step has passed" if steps == 1 else f"{steps:,} time steps have passed"
    ended, is_settled = "", False
    shown: tuple[Instance, ...] = ()
    ids: dict[int, int] = {}
    same = False  # whether objects have the same numbers in the scene as among all instances
    for number in range(steps + 1):
        told.clear()
        outcome = chosen(state, ended or (limit if number == steps else ""))
        if isinstance(outcome, Stuck):
            return Failed(outcome.requirement, number)
        if (scenarios := simulation_of(outcome.state).scenarios) is not known:
            known, now = scenarios, satisfied_eventually_lines(outcome.state)
            told += [f"`require eventually` on line {line} is satisfied" for line in sorted(now - held)]
            held |= now
        if isinstance(outcome, Finish):
            made += new_bodies(outcome.state, len(made))
            moments.append(Moment(number, poses(outcome.state, simulator), {}, tuple(told)))
            recorded = simulation_of(outcome.state).recorded
            otherwise = SETTLED if is_settled else ENDED if ended else LIMIT
            result = TERMINATED if simulation_of(outcome.state).flag else otherwise
            return Simulated(scene, tuple(moments), result, outcome.reason, simulator.timestep, tuple(made[first:]), recorded)
        state = outcome.state
        if state.scene is not shown:
            shown = state.scene
            ids = {instance.number: k for k, instance in enumerate(state.scene)}
            same = all(number == id for number, id in ids.items())
        actions = {n if same else ids[n]: copy_containers(taken, {}) for n, taken in outcome.actions.items()}
        before = poses(state, simulator)
        try:
            if len(made) < len(state.scene):
                made += create_new(simulator, state, len(made), chance)
            check_actions(simulator, state, actions, chosen)
            events, ended = step_of(simulator, actions)
            after = read_back(simulator, state)
        except RejectRun as problem:
            return rejected_by_simulator(problem, number)
        doings = chosen.doing(state) if same else {ids[n]: text for n, text in chosen.doing(state).items()}
        moments.append(Moment(number, before, actions, (*told, *events), doings))
        if settled is not None and not ended:
            ended = reason_of(settled(moments[-1]))
            is_settled = bool(ended)
        state = after_one_step(after)
    raise AssertionError("the policy ends at the time limit")


def reason_of(answer: object) -> str:
    """Why the outcome of a simulation is settled, or "". Raises `UsageError` for what is no text."""
    if answer is None or isinstance(answer, str):
        return answer or ""
    hint = 'for instance lambda moment: "collision" if moment.events else None'
    raise UsageError(f"settled gives a text, the reason, or None, not {answer!r}", hint=hint)


def file_of(state: State) -> str | None:
    """The file of the program, or of the scenario that it begins with; None if there is neither an object nor a scenario."""
    if state.scene:
        return state.scene[0].span.file
    return None if state.initial is None else state.initial.definition.span.file


TOLD = {
    "D-Interrupt": "interrupt", "D-Abort": "abort", "D-Setup": "a scenario begins", "D-Scenario-End": "a scenario ends",
    "D-TerminateWhen": "a termination condition is true", "D-Terminate": "terminate", "D-Override": "override",
}  # fmt: skip
"""Rules that are events of a time step."""


def listening_witness(told: list[str], witness: Witness | None, file: str | None) -> Witness:
    """A witness that notes what happens in a time step, and passes it on to another; `file` is that of the program, None if there is no other."""

    def look(outcome: Outcome, drawn: object) -> None:
        if type(outcome) is Next and outcome.rule in TOLD:
            span = None if outcome.node is None else outcome.node.span
            place = "" if span is None else span_line_text(span, span.file if file is None else file)
            told.append(TOLD[outcome.rule] + (f" ({place})" if place else ""))
        if witness is not None:
            witness(outcome, drawn)

    return look


# Between the machine and the simulator


def create_new(simulator: Simulator, state: State, known: int, chance: int) -> list[Body]:
    """Give the simulator, whose seed is `chance`, the objects from number `known` on, and return them. Raises `SimulatorError`, `RejectRun`."""
    new = new_bodies(state, known)
    create(simulator, new, state, chance)
    return new


def create(simulator: Simulator, bodies: list[Body], state: State, chance: int) -> None:
    """Give the simulator new objects, and what surrounds them. Raises `SimulatorError`, `RejectRun`."""
    call_simulator(simulator.create, bodies, surroundings(simulator, state, chance), may=(RejectRun,))


def surroundings(simulator: Simulator, state: State, chance: int) -> Surroundings:
    """Return the information for a simulator besides the objects."""
    ego = ego_of(state, simulated=True)
    number = None if ego is None else next(k for k, instance in enumerate(state.scene) if instance.number == ego.number)
    module = state.settings.library.get(MAP)
    network = module.get("network") if isinstance(module, Mapping) else None
    params = MappingProxyType({name: portable(value) for name, value in state.params.items()})
    return Surroundings(params, number, chance, simulator.timestep, network if isinstance(network, Network) else None, workspace_of(state))


def new_bodies(state: State, known: int) -> list[Body]:
    """The objects from number `known` on."""
    return [body_of(k, state) for k in range(known, len(state.scene))]


def body_of(id: int, state: State) -> Body:
    """An object for the simulator."""
    instance = state.scene[id]
    return Body(id, instance.class_.name, {name: copy_containers(value_in_run(value), {}) for name, value in state.objects[instance.number].items()})


def poses(state: State, simulator: Simulator) -> tuple[Pose, ...]:
    """The properties of all objects that the simulator updates, as far as they have them."""
    if not simulator.properties:
        return tuple([{} for _ in state.scene])
    return tuple(updated_properties(state.objects[instance.number], simulator) for instance in state.scene)


def check_actions(simulator: Simulator, state: State, actions: Mapping[int, tuple[object, ...]], policy: Policy) -> None:
    """Each action is checked against the agent that takes it. Raises `RunError`."""
    if getattr(type(simulator), "check", None) is Still.check:  # any value is one
        return

    def check() -> tuple[Instance, object, object] | None:
        for id, taken in actions.items():
            instance = state.scene[id]
            body = Body(id, instance.class_.name, MappingProxyType(state.objects[instance.number]))
            for action in taken:
                reason = simulator.check(body, action)
                if reason is not None:
                    return instance, action, reason
        return None

    if (found := call_simulator(check)) is not None:
        instance, action, reason = found
        if not isinstance(reason, str):
            raise SimulatorError(f"check() must return None or a reason, not {reason!r}", NOWHERE)
        span, hint = policy.place(instance, state)
        raise RunError(f"{instance!r} cannot take the action {action!r}: {reason}", span, rule="D-Take", hint=hint)


def read_back(simulator: Simulator, state: State) -> State:
    """The state with what the simulator says of the objects. Raises `SimulatorError` for values that a property cannot have."""
    if getattr(type(simulator), "read", None) is Still.read:  # nothing has changed
        return state
    objects = dict(state.objects)
    said = read_poses(simulator, [(id, instance, instance.span) for id, instance in enumerate(state.scene)])
    for id, (instance, pose) in enumerate(zip(state.scene, said, strict=True)):
        before = objects[instance.number]
        objects[instance.number] = {**before, **pose, **controls_of(id, before, simulator)}
    return state.with_objects(objects)
