"""Traces: every rule that fired in a run, with its probability, what it changed, and where it stands in the source."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from ...semantics.dynamics.coroutines import Coroutine, Yielded
from ...semantics.dynamics.frames import Invoked
from ...semantics.machine.config import Config, State
from ...semantics.machine.implicit_positions import waits
from ...semantics.machine.outcome import Act, Change, Done, Draw, Finish, Next, Observe, Outcome, Stuck
from ...semantics.machine.simulation_state import agent_of, simulation_of
from ...semantics.machine.values import Instance, Random, unwrap
from ...semantics.python.string_methods import stable_repr
from ...semantics.rules import RULES
from ...semantics.scenes.object_definitions import Defaulting
from ...semantics.space.distributions.distribution import Distribution
from ...semantics.space.vectors import Vector
from ...semantics.syntax.nodes import NOWHERE, Span
from .program_run import Accepted, Chooser, Run, generate_scene

MISSING = object()
LONGEST = 80


class Assigned(NamedTuple):
    """A variable (σ), global parameter (π) or property (O) that got a value, both as texts."""

    where: str
    name: str
    value: str


@dataclass(frozen=True, slots=True)
class Event:
    """One rule that fired.

    `log_density` is the logarithm of its probability, 0 for rules without, and of a density if `is_density`; `change` says
    what became what, `assigned` the same piece by piece; `kind` is "rule", "draw", "requirement", "time", "done" or "stuck";
    `in_default`: it belongs to the evaluation of a default value; `step`: the time step in which it fired, None while the scene is generated.
    """

    number: int
    rule: str
    kind: str
    span: Span
    log_density: float = 0.0
    change: str = ""
    is_density: bool = False
    in_default: bool = False
    assigned: tuple[Assigned, ...] = ()
    step: int | None = None

    @property
    def name(self) -> str:
        """The paper's name of the rule."""
        return RULES[self.rule].name if self.rule in RULES else ""

    @property
    def inherited(self) -> bool:
        """Whether the rule is one of Python's."""
        return self.rule in RULES and RULES[self.rule].inherited

    def to_json(self) -> dict[str, object]:
        """The event for the page that steps through a trace."""
        return {
            "number": self.number, "rule": self.rule, "name": self.name, "kind": self.kind, "file": self.span.file, "line": self.span.line,
            "column": self.span.column, "endLine": self.span.end_line, "endColumn": self.span.end_column, "logDensity": json_number(self.log_density),
            "change": self.change, "isDensity": self.is_density, "inDefault": self.in_default, "assigned": [list(a) for a in self.assigned],
            "step": self.step,
        }


def json_number(number: float) -> float | str:
    """A number as JSON can hold it."""
    return number if math.isfinite(number) else repr(number)


@dataclass
class Trace:
    """The events of one run, the draws by address, and how the run ended; `state` is the latest one."""

    events: list[Event] = field(default_factory=list)
    draws: dict[tuple[int, ...], object] = field(default_factory=dict)
    run: Run | None = None
    state: State | None = None

    @property
    def log_density(self) -> float:
        """The logarithm of the product of the probabilities of all rules that fired: the density of the execution trace."""
        return math.fsum(e.log_density for e in self.events if e.kind != "stuck")

    @property
    def accepted(self) -> bool:
        """Whether the run ended with a scene."""
        return isinstance(self.run, Accepted)

    def follow(self, config: Config, choose: Chooser, *, fuel: int) -> None:
        """Run once and keep every rule that fires. Raises the program's error, the events before it being kept."""
        self.state = config.state
        self.run = generate_scene(config, choose, fuel=fuel, witness=self.witness)

    def witness(self, outcome: Outcome, drawn: object) -> None:
        """Add an outcome of the run."""
        state = state_after(outcome, drawn)
        time = time_of(state if state is not None else self.state)
        if state is not None and time is not None and time != time_of(self.state):
            self.events.append(next_step(len(self.events) + 1, outcome, self.state, state))
            self.state = state
        after = next_config(outcome, drawn)
        assigned = ()
        if state is not None and not (isinstance(outcome, Next) and outcome.rule == ""):
            assigned = assignments(outcome, self.state, state)
            self.state = state
        event = event_of(len(self.events) + 1, outcome, drawn, after, assigned)
        if event is not None:
            self.events.append(replace(event, step=time))
        if isinstance(outcome, Draw):
            self.draws[outcome.address] = drawn


def trace_run_rules(config: Config, choose: Chooser, *, fuel: int) -> Trace:
    """Run once and keep every rule that fired. Raises the program's errors."""
    found = Trace()
    found.follow(config, choose, fuel=fuel)
    return found


def next_config(outcome: Outcome, drawn: object) -> Config | None:
    """The configuration after an outcome, None where the run ends."""
    match outcome:
        case Next(config=config) | Observe(config=config):
            return config
        case Draw(resume=resume):
            return resume(drawn)
        case _:
            return None


def state_after(outcome: Outcome, drawn: object) -> State | None:
    """The state after an outcome, None for one that has none."""
    if isinstance(outcome, (Done, Act, Finish)):
        return outcome.state
    after = next_config(outcome, drawn)
    return None if after is None else after.state


def time_of(state: State | None) -> int | None:
    """The time step that a state belongs to, None while the scene is generated."""
    return None if state is None or state.simulation is None else state.simulation.step


def next_step(number: int, outcome: Outcome, before: State | None, state: State) -> Event:
    """A time step begins: what the simulator has changed since the one before, nothing of which is a rule."""
    simulation = simulation_of(state)
    moved = assignments(outcome, before, state) if time_of(before) is not None else ()
    text = f"time step {simulation.step}, {simulation.step * simulation.timestep:g} s"
    said = describe(None, moved)
    return Event(number, "", "time", NOWHERE, change=f"{text}: the simulator: {said}" if said else text, assigned=moved, step=simulation.step)


def event_of(number: int, outcome: Outcome, drawn: object, after: Config | None = None, assigned: tuple[Assigned, ...] = ()) -> Event | None:
    """The event of an outcome; bookkeeping between rules has none."""
    in_default = after is not None and is_in_default(after)
    match outcome:
        case Next(rule=""):
            return None
        case Next(rule=rule, node=node, change=change, config=config):
            span = node.span if node is not None else getattr(config.control, "span", NOWHERE)
            text = describe(change, assigned) or (describe_coroutine(config) if rule.startswith("D-") else "")
            return Event(number, rule, "rule", span, change=text, in_default=in_default, assigned=assigned)
        case Draw(rule=rule, node=node, distribution=distribution):
            parameters = ", ".join(f"{k}={trace_text(v)}" for k, v in distribution.parameters.items())
            change = f"{trace_text(drawn)} ~ {distribution.name}({parameters})"
            log_density = log_density_of(distribution, drawn)
            is_density = distribution.support() is None
            return Event(number, outcome.fires(drawn), "draw", node.span, log_density, change, is_density, in_default, assigned)
        case Observe(rule=rule, requirement=requirement):
            return Event(number, rule, "requirement", requirement.span, change=f"{requirement.text}: holds", in_default=in_default)
        case Done(rule=rule):
            return Event(number, rule, "done", NOWHERE, change="all default requirements hold: (π, O)")
        case Act(rule=rule, actions=actions, state=state):
            return Event(number, rule, "done", NOWHERE, change=describe_actions(actions, state))
        case Finish(rule=rule, reason=reason):
            return Event(number, rule, "done", NOWHERE, change=f"the scenario ends: {reason}")
        case Stuck(rule=rule, requirement=requirement):
            return Event(number, rule, "stuck", requirement.span, -math.inf, f"{requirement.text}: does not hold, so no rule applies")
        case _:
            return None


def describe_actions(actions: Mapping[int, tuple[object, ...]], state: State) -> str:
    """The actions of a time step, agent by agent."""
    agents = {instance.number: state.names.get(instance.number) or repr(instance) for instance in state.scene}
    return "; ".join(f"{agents[n]} takes {', '.join(map(trace_text, taken))}" for n, taken in actions.items()) or "no agent takes an action"


def describe_coroutine(config: Config) -> str:
    """Whose coroutine runs: an agent, with the behaviors that it is in, or a block of a scenario; nothing between them."""
    stack, result = config.stack, getattr(config.control, "value", None)
    inside: list[object] = list(result.rest.frames) if isinstance(result, Yielded) else []  # what has just been suspended
    while stack and not isinstance(stack[0], Coroutine):
        inside.append(stack[0])
        stack = stack[1]
    if not stack:
        return ""
    who, state = stack[0].who, config.state
    if who.kind == "behavior":
        agent = agent_of(who, state)
        names = [repr(frame.behavior) for frame in reversed(inside) if isinstance(frame, Invoked)]
        return " > ".join([state.names.get(agent.number) or repr(agent), *names])
    scenario = simulation_of(state).scenarios.get(who.number)
    return f"{'a monitor' if who.kind == 'monitor' else 'the compose block'} of {scenario.name if scenario is not None else 'a scenario'}"


def is_in_default(config: Config) -> bool:
    """Whether a default value is being evaluated."""
    stack = config.stack
    while stack:
        frame, stack = stack
        if type(frame) is Defaulting:
            return True
    return False


def assignments(outcome: Outcome, before: State | None, after: State) -> tuple[Assigned, ...]:
    """Return the assignments between two states; for σ, which is updated in place, the outcome says which."""
    found: list[Assigned] = []
    if isinstance(outcome, Next) and outcome.change is not None and outcome.change.where == "σ":
        found.append(Assigned("σ", outcome.change.name, trace_text(outcome.change.value)))
    if before is None:
        return tuple(found)
    if before.params is not after.params:
        found += [Assigned("π", n, trace_text(v)) for n, v in after.params.items() if before.params.get(n, MISSING) is not v]
    if before.objects is not after.objects:
        for number, properties in after.objects.items():
            known = before.objects.get(number, {})
            if known is not properties:
                owner = after.names.get(number) or instance_in(outcome, number) or in_scene(after, number) or f"<{number}>"
                found += [Assigned("O", f"{owner}.{n}", trace_text(v)) for n, v in properties.items() if known.get(n, MISSING) is not v]
    return tuple(found)


def instance_in(outcome: Outcome, number: int) -> str:
    """An instance that is being made, as the outcome calls it: <Car 3>."""
    change = outcome.change if isinstance(outcome, Next) else None
    instance = change.instance if change is not None else None
    return repr(instance) if instance is not None and instance.number == number else ""


def in_scene(state: State, number: int) -> str:
    """An object of the scene, by its class and number."""
    return next((repr(instance) for instance in state.scene if instance.number == number), "")


def log_density_of(distribution: Distribution, drawn: object) -> float:
    """The logarithm of the density or probability of what was drawn; values among which a draw chooses may be random themselves."""
    support = distribution.support()
    if support is None:
        return distribution.log_density(drawn)
    value = unwrap(drawn)[0]
    share = sum(probability for entry, probability in support if (other := unwrap(entry)[0]) is value or bool(other == value))
    return math.log(share) if share else -math.inf


def describe(change: Change | None, assigned: tuple[Assigned, ...] = ()) -> str:
    """Describe the changes of a step in the paper's notation: O[self.width / 2] and so on."""
    if change is not None and change.where == "print":
        return f"prints {change.value}"
    if change is not None and change.name == "order" and isinstance(change.value, tuple):
        return "order: " + ", ".join(f"{s.name} → {{{', '.join(names)}}}" for s, names in change.value)
    if change is not None and isinstance(change.value, Instance) and change.where == "O":
        return f"O ∪ {{{change.name}}}"
    wheres = dict.fromkeys(a.where for a in assigned)
    return ", ".join(f"{w}[{', '.join(f'{a.name} / {a.value}' for a in assigned if a.where == w)}]" for w in wheres)


def trace_text(value: object) -> str:
    """A value in a line of a trace: short, and the same in every run of the same seed."""
    try:
        plain_value = value if waits(value) else unwrap(value)[0]
    except RecursionError:  # it contains itself
        plain_value = value
    text = rounded_text(plain_value, LONGEST + 1)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def rounded_text(value: object, room: int) -> str:
    """A value with its numbers rounded to six digits: all of it, or at least as many letters of it as there is room for."""
    match value:
        case float():
            return f"{value:.6g}"
        case Vector(x=x, y=y):
            return f"({rounded_text(x, room)}, {rounded_text(y, room)})"
        case tuple() if type(value) is tuple and len(value) <= LONGEST:
            return f"({', '.join(rounded_parts(value, room))}{',' if len(value) == 1 else ''})"
        case Random():
            return rounded_text(value.value, room)
        case type():
            return f"<class {value.__name__}>"
        case list() if len(value) <= LONGEST:
            return f"[{', '.join(rounded_parts(value, room))}]"
        case _:
            return stable_repr(value)


def rounded_parts(values: Iterable[object], room: int) -> Iterator[str]:
    """The parts of a value, written until there is no more room: what contains itself, or the same many times over, has no end."""
    for value in values:
        if room <= 0:
            return
        text = rounded_text(value, room - 1)
        room -= len(text)
        yield text


def lines_of(programs: Mapping[str, str], span: Span) -> str:
    """The source line of a place, stripped; empty where there is none."""
    lines = programs.get(span.file, "").splitlines()
    return lines[span.line - 1].strip() if 0 < span.line <= len(lines) else ""
