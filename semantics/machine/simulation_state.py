"""The state of a scenario that runs: the time, the scenarios that are running, and the agents with their
behaviors.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, NamedTuple

from ..store.errors import RunError
from ..store.scopes import Scope
from ..syntax.nodes import NOWHERE, Expression, Node, Span
from ..syntax.statements import Block
from .values import Dynamic, Instance

if TYPE_CHECKING:
    from .config import Abrupt, Stack, State, Value

NAME = re.compile(r".*[/\\\\]")
"""What stands before the name of a file."""
TOP = 0
"""The number of the top-level scenario."""


class Who(NamedTuple):
    """Whose coroutine it is: "behavior" of an object, "monitor" or "compose" of a scenario; `number` tells it from others of its kind."""

    kind: str
    number: int
    part: int = 0


class Suspended(NamedTuple):
    """A coroutine that waits for the next time step, at the statement at `span`; one that has not `begun` waits for its first."""

    control: Node | Value | Abrupt
    frames: tuple[object, ...]
    sigma: Scope
    handling: tuple[BaseException, ...] = ()
    depth: int = 0
    begun: bool = True
    span: Span = NOWHERE


class Declared(NamedTuple):
    """A condition, value or monitor that a scenario declared, with the scope of its variables; or a time limit."""

    node: Node
    scope: Scope
    deadline: Deadline | None = None


class Overridden(NamedTuple):
    """The things that `override` replaced: properties of an object, and the course of its behavior if that is
    one of them; `order` counts overrides.
    """

    object: Instance
    properties: Mapping[str, object]
    agent: Agent | None
    order: int = 0


class Running(NamedTuple):
    """A scenario that is running: the top-level one, whose `dynamic` is None unless it is a modular one, or one that a compose block invoked.

    `compose` is its compose block, None if it has none; `ran` once it has run for a time step, `over` once it has ended, in the time step in which it
    did; `first_step` is the time step in which it began; `satisfied` are the conditions of `require eventually` that held at some
    time, by their place.
    """

    number: int
    dynamic: Dynamic | None
    scope: Scope
    compose: Suspended | None
    always: tuple[Declared, ...] = ()
    eventually: tuple[Declared, ...] = ()
    terminations: tuple[Declared, ...] = ()
    monitors: tuple[Suspended | None, ...] = ()
    records: tuple[Declared, ...] = ()
    satisfied: frozenset[int] = frozenset()
    overrides: tuple[Overridden, ...] = ()
    ran: bool = False
    over: bool = False
    first_step: int = 0

    @property
    def name(self) -> str:
        """The name of the scenario."""
        return "the top-level scenario" if self.dynamic is None else repr(self.dynamic)


class Agent(NamedTuple):
    """An object that takes actions: the course of its behavior (None before it begins, and `ended` after its end), the actions of this time step."""

    instance: Instance
    process: Suspended | None = None
    ended: bool = False
    actions: tuple[object, ...] = ()


class Simulation(NamedTuple):
    """The time in steps, how many seconds a step has, the scenarios by number (in the order in which they began), and the agents.

    `active` are the scenarios that run in this time step, `flag` says why the scenario is to end, once it is ("" until then), `limit` that it is to
    end in this time step in any case, `fixed` are the properties that the simulator updates: those of the Objects among the instances below number
    `known`, which were made in setup blocks that are over; `setting` while a setup block runs,
    `egoless` until one has made ego, and `recorded` are the values of `record` statements by their names, each with its time step.
    """

    step: int
    timestep: float
    scenarios: Mapping[int, Running]
    agents: Mapping[int, Agent] = {}
    active: tuple[int, ...] = ()
    flag: str = ""
    limit: str = ""
    begun: int = 1
    overrides: int = 0
    fixed: frozenset[str] = frozenset()
    known: int = 0
    setting: bool = False
    egoless: bool = False
    recorded: Mapping[str, tuple[tuple[int, object], ...]] = {}


def simulation_of(state: State) -> Simulation:
    """The simulation that a state belongs to."""
    assert isinstance(state.simulation, Simulation)
    return state.simulation


def with_simulation(state: State, **changes: object) -> State:
    """The state with some parts of its simulation replaced."""
    return state.with_simulation(simulation_of(state)._replace(**changes))  # type: ignore[arg-type]


def flag_end(reason: str, state: State) -> State:
    """Remember that the scenario is to end; the first reason counts."""
    return with_simulation(state, flag=simulation_of(state).flag or reason)


def with_scenario(state: State, running: Running) -> State:
    """The state in which a scenario has become this."""
    return with_simulation(state, scenarios={**simulation_of(state).scenarios, running.number: running})


def with_agent(state: State, agent: Agent) -> State:
    """The state in which an agent has become this."""
    return with_simulation(state, agents={**simulation_of(state).agents, agent.instance.number: agent})


def span_line_text(span: Span, file: str) -> str:
    """The line of a place, with the name of its file if that is another one; empty if it has none."""
    if not span.line:
        return ""
    return f"line {span.line}" if span.file == file else f"line {span.line} of {NAME.sub('', span.file)}"


def satisfied_eventually_lines(state: State) -> set[int]:
    """The lines of the `require eventually` that have held so far."""
    found: set[int] = set()
    for running in simulation_of(state).scenarios.values():
        if running.satisfied:
            found.update(running.eventually[place].node.span.line for place in running.satisfied)
    return found


def agent_of(who: Who, state: State) -> Instance:
    """The object whose behavior a coroutine is."""
    agent = simulation_of(state).agents.get(who.number)
    if agent is None:
        raise RunError("there is no agent here: `self` belongs to behaviors", rule="D-Do")
    return agent.instance


class Deadline(NamedTuple):
    """A condition: so many steps or seconds of the simulation have passed."""

    time: float
    unit: str
    rounded_up: bool


def has_passed(deadline: Deadline, first_step: int, simulation: Simulation) -> bool:
    """Whether so many steps or seconds have passed since that time step began, or one step more would exceed them (reading `between-steps`)."""
    steps = simulation.step - first_step
    length = 1.0 if deadline.unit == "steps" else simulation.timestep
    if deadline.rounded_up:
        return steps * length >= deadline.time * (1 - ROUNDING)
    return (steps + 1) * length > deadline.time * (1 + ROUNDING)


ROUNDING = 1e-9
"""Seconds that are multiples of the time step may differ from them by so little."""


class Clause(NamedTuple):
    """A condition, and the block that runs when it is true."""

    condition: Expression | Deadline
    block: Block


class Setting(NamedTuple):
    """Frame: scenario number `i` among those that `do` invokes is set up, and this `stage` of it runs; those before it are the `begun`.

    Objects from number `objects` on are its own. `before` is the state at the statement; preconditions of `enabled` ones are known to hold.
    """

    node: Node
    invocations: tuple[Dynamic, ...]
    before: State
    until: Clause | None
    enabled: bool = False
    i: int = 0
    begun: tuple[int, ...] = ()
    stage: Literal["preconditions", "setup block", "default requirements"] = "preconditions"
    objects: int = 0

    @property
    def in_block(self) -> bool:
        """Whether the setup block runs."""
        return self.stage == "setup block"


def check_setup(what: str, node: Node, stack: Stack) -> int:
    """Objects are made, and mutated, in setup blocks, whose end checks the default requirements: the number of the first. Raises `RunError`."""
    while stack:
        if isinstance(stack[0], Setting) and stack[0].in_block:
            return stack[0].objects
        stack = stack[1]
    raise RunError(f"{what} in a setup block only", node.span, rule="D-Setup", hint="put it into a scenario, and invoke that with `do`")
