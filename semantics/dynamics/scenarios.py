"""Modular scenarios (Section "Compositional Scenarios"): their setup, their course, their end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from typing import NamedTuple

from ..machine.conditions import condition_truth
from ..machine.config import Abrupt, Config, Properties, Stack, State, Value
from ..machine.operand_kinds import is_scalar, kind_name
from ..machine.outcome import Next, Outcome
from ..machine.simulation_state import (
    Clause,
    Deadline,
    Declared,
    Running,
    Setting,
    Suspended,
    Who,
    flag_end,
    has_passed,
    simulation_of,
    with_scenario,
    with_simulation,
)  # fmt: skip
from ..machine.values import Dynamic, value_in_run
from ..python.control_flow import block
from ..python.functions import LARGEST_DEPTH, body_as_statement
from ..scenes.termination import apply_termination_rules
from ..store.errors import RunError
from ..store.scopes import BEGUN, Scope
from ..syntax import dynamics as d
from ..syntax.nodes import Node
from .coroutines import Coroutine, Ended, Yielded, address_of, suspend
from .endings import end_scenario
from .frames import Scenarios
from .guards import INVARIANTS, compose_guards, guarded_apart, guards_of, reduce_guards, return_from_do, scope_of
from .interrupts import run_for_one_step, run_until_limit
from .temporal_requirements import condition_at, decision, over_time


class Stepping(NamedTuple):
    """Frame: the compose block of a scenario is running for one time step."""

    number: int


class Ending(NamedTuple):
    """Frame: termination condition number `i` of a scenario is being reduced."""

    number: int
    i: int
    outer: State


GOES_ON = object()
"""Instead of the value of a condition: it has been true, and ends the simulation, not the scenario at once."""


class Over(NamedTuple):
    """A scenario has come to its end in this time step, and why."""

    reason: str


class Going(NamedTuple):
    """A scenario goes on in the next time step."""


# Beginning


def begin_scenarios(
    node: Node, invocations: tuple[Dynamic, ...], stack: Stack, state: State, until: Clause | None = None, *, enabled: bool = False
) -> Outcome:
    """`do S1, ..., Sn` in a compose block: set them up one after the other, then run them for one time step unless they are to end already."""
    if state.depth >= LARGEST_DEPTH:
        raise RunError(f"{invocations[0]!r} invokes itself too deeply ({LARGEST_DEPTH} scenarios are open)", node.span, rule="D-Do")
    return set_up(Setting(node, invocations, state, until, enabled), stack, state)


def set_up(frame: Setting, stack: Stack, state: State) -> Outcome:
    """One scenario after the other: its preconditions, its setup block, the default requirements about what that makes. Then all of them run."""
    if frame.i == len(frame.invocations):
        after = state._replace(sigma=frame.before.sigma, dynamic=frame.before.dynamic)
        scenarios = Scenarios(frame.node, frame.begun)
        if frame.until is not None:
            return run_until_limit(frame.node, frame.until, Value(None), scenarios, stack, after)
        return run_scenarios(scenarios, stack, after)
    scenario = frame.invocations[frame.i]
    scope = fresh_space(scenario, frame.node, state)
    preconditions = () if frame.enabled else guards_of(scenario, scope)[:1]
    return reduce_guards(preconditions, partial(enter_setup, scope), (frame, stack), state)


def enter_setup(scope: Scope, stack: Stack, state: State) -> Outcome:
    """The preconditions hold: the setup block, in the scope of the scenario, whose invariants may be about what that makes."""
    frame, below = stack
    definition = frame.invocations[frame.i].definition
    assert isinstance(definition, d.ScenarioDefinition)
    here = frame._replace(stage="setup block", objects=len(state.scene))
    return setup(definition, frame.node, (here, below), with_simulation(state._replace(sigma=scope, dynamic=()), setting=True))


def setup(definition: d.ScenarioDefinition, node: Node, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Modular Scenarios": "The setup block contains code that runs once when the scenario begins to execute, and is a list
    of statements like a top-level Scenic program".
    """
    return block(definition.setup or (), stack, state, "D-Setup", node)


def resume_setting(frame: Setting, result: object, stack: Stack, state: State) -> Outcome:
    """The block ended: mutate its objects and check the requirements about them (reading `dynamic-objects`); then on with the next scenario."""
    simulation = simulation_of(state)
    checked = frame.in_block and state.reading("dynamic-objects") == "setup-end"
    if checked and (len(state.scene) > frame.objects or (simulation.egoless and state.ego is not None)):
        return apply_termination_rules((frame._replace(stage="default requirements"), stack), state, since=frame.objects)
    number = simulation.begun
    running = scenario_from(number, frame.invocations[frame.i], state.sigma, state.dynamic, state.depth + 1, simulation.step)
    if number in simulation.scenarios:  # what its setup overrode
        running = running._replace(overrides=simulation.scenarios[number].overrides)
    state = with_simulation(state, begun=number + 1, known=state.made, setting=False, egoless=state.ego is None)
    state = with_scenario(state, running).with_objects(settle_properties(state.objects))
    state = state._replace(dynamic=frame.before.dynamic, sigma=frame.before.sigma)
    return set_up(frame._replace(i=frame.i + 1, begun=(*frame.begun, number), stage="preconditions"), stack, state)


def unwind_setting(frame: Setting, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Some scenario of the `do` statement cannot begin: none does; their objects, variables, overrides and conditions are gone, ego is as before."""
    number = simulation_of(state).begun
    for begun in (number, *reversed(frame.begun)):
        state = end_scenario(begun, state)
    left = {n: running for n, running in simulation_of(state).scenarios.items() if n not in (number, *frame.begun)}
    state = with_simulation(state, scenarios=left, begun=number + 1, setting=False, egoless=frame.before.ego is None)
    before = frame.before
    for scenario in frame.invocations[: frame.i + 1]:
        assert scenario.space is not None
        scenario.space.refill({})
    after = state._replace(sigma=before.sigma, dynamic=before.dynamic, scene=before.scene, ego=before.ego, names=before.names)
    return Next("", Config(abrupt, stack, after))


def fresh_space(scenario: Dynamic, node: Node, state: State) -> Scope:
    """The variables of a scenario that begins: its arguments, and nothing of an earlier run of the same instance. Raises `RunError` if it runs."""
    scope = scenario.space
    assert scope is not None
    if any(running.dynamic is scenario and not running.over for running in simulation_of(state).scenarios.values()):
        raise RunError(f"this instance of {scenario!r} is running already", node.span, rule="D-Do", hint="make another one")
    scope.refill({**scope_of(scenario, state).bindings, BEGUN: True})
    return scope


def settle_properties(objects: Mapping[int, Properties]) -> Mapping[int, Properties]:
    """The properties of objects once their setup block is over: what was drawn is known."""
    return {number: {name: value_in_run(value) for name, value in properties.items()} for number, properties in objects.items()}


def scenario_from(
    number: int, dynamic: Dynamic | None, scope: Scope, declared: Iterable[Declared], depth: int = 0, first_step: int = 0
) -> Running:
    """A scenario whose setup is done, with what it declared; it is inside `depth` others."""
    found: dict[str, list[Declared]] = {field: [] for field in FIELDS.values()}
    for one in declared:
        found[FIELDS[type(one.node)]].append(one)
    definition = None if dynamic is None else dynamic.definition
    compose = definition.compose if isinstance(definition, d.ScenarioDefinition) else None
    return Running(
        number, dynamic, scope, None if compose is None else Suspended(body_as_statement(compose), (), scope, depth=depth),
        tuple(found["always"]), tuple(found["eventually"]), tuple(found["terminations"]), tuple(monitor(m) for m in found["monitors"]),
        tuple(found["records"]), first_step=first_step,
    )  # fmt: skip


FIELDS = {
    d.RequireAlways: "always", d.RequireEventually: "eventually", d.TerminateWhen: "terminations", d.TerminateAfter: "terminations",
    d.MonitorDefinition: "monitors", d.Record: "records",
}  # fmt: skip
"""Where a scenario that runs keeps what it declared."""


def monitor(declared: Declared) -> Suspended:
    """A monitor before its first time step: monitors "run in parallel with the scenario", from their definition on (reading `monitor-structure`)."""
    node = declared.node
    assert isinstance(node, d.MonitorDefinition)
    return Suspended(body_as_statement(node.body), (), declared.scope, begun=False)


# One time step


def run_scenarios(frame: Scenarios, stack: Stack, state: State) -> Outcome:
    """Run the next of the scenarios for one time step; `do` "does not return until the sub-behavior/sub-scenario terminates"."""
    if frame.i < len(frame.numbers):
        return step_of_scenario(frame.numbers[frame.i], (frame, stack), state)
    if not frame.left:
        return return_from_do(stack, state)
    return suspend((), Value(None), (Scenarios(frame.node, frame.left), stack), state, "")


def resume_scenarios(frame: Scenarios, result: object, stack: Stack, state: State) -> Outcome:
    """A scenario has run for one time step (or, the value being None, a new step begins)."""
    number = frame.numbers[frame.i] if frame.i < len(frame.numbers) else 0
    if isinstance(result, Going):
        frame = frame._replace(i=frame.i + 1, left=(*frame.left, number))
    elif isinstance(result, Over):
        frame = frame._replace(i=frame.i + 1)
        state = end_scenario(number, state)
    return run_scenarios(frame, stack, state)


def unwind_scenarios(frame: Scenarios, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The `do` statement is left otherwise: its scenarios end."""
    for number in frame.numbers:
        state = end_scenario(number, state)
    return Next("", Config(abrupt, stack, state))


def step_of_scenario(number: int, stack: Stack, state: State) -> Outcome:
    """The compose block for one time step, then the termination conditions; the frame below gets `Going` or `Over`."""
    simulation = simulation_of(state)
    running = simulation.scenarios.get(number)
    if running is None or running.over:
        return Next("", Config(Value(Over("a monitor executed `terminate`")), stack, state))
    state = with_simulation(state, active=(*simulation.active, number))
    if not running.ran:
        state = with_scenario(state, running._replace(ran=True))
    if state.reading("requirements-order") == "before":
        return resume_requirements_first(RequirementsFirst(number), None, stack, state)
    return compose_or_conditions(number, stack, state)


class RequirementsFirst(NamedTuple):
    """Frame: the requirements over time of a scenario are looked at before its compose block runs (reading `requirements-order`)."""

    number: int
    next: int = 0
    outer: State | None = None


def resume_requirements_first(frame: RequirementsFirst, result: object, stack: Stack, state: State) -> Outcome:
    """Step 2 of the policy for one scenario, before step 1."""
    todo = list(over_time(simulation_of(state).scenarios[frame.number]))
    if frame.outer is not None:
        place, declared = todo[frame.next]
        below = (RequirementsFirst(frame.number, frame.next + 1), stack)
        return decision(frame.number, place, declared)(declared.node, result, below, as_before(frame.outer, state))
    if frame.next < len(todo):
        return condition_at(frame.number, *todo[frame.next], (frame._replace(outer=state), stack), state)
    return compose_or_conditions(frame.number, stack, state)


def unwind_requirements_first(frame: RequirementsFirst, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The condition raised an exception."""
    return Next("", Config(abrupt, stack, state if frame.outer is None else as_before(frame.outer, state)))


def compose_or_conditions(number: int, stack: Stack, state: State) -> Outcome:
    """The compose block of a scenario for one time step, or, where there is none, its guards and termination conditions."""
    running = simulation_of(state).scenarios[number]
    if running.compose is not None:
        return run_for_one_step(running.compose, Who("compose", number), (Stepping(number), stack), state)
    invariants = compose_guards(number, state)
    return guarded_apart(Who("compose", number, INVARIANTS), (invariants,), partial(check_termination, number, 0), stack, state)


def resume_stepping(frame: Stepping, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 1: "finishes its compose block (if any), one of its terminate when conditions is
    true, or it executes terminate". So any scenario ends, not the top-level one alone; while its block waits, it goes on unless a condition is true.
    """
    running = simulation_of(state).scenarios[frame.number]
    if isinstance(result, Yielded):
        return check_termination(frame.number, 0, stack, with_scenario(state, running._replace(compose=result.rest)))
    assert isinstance(result, Ended)
    reason = "`terminate` was executed" if result.terminates else "its compose block is finished"
    return Next("D-Scenario-End", Config(Value(Over(reason)), stack, state))


def check_termination(number: int, index: int, stack: Stack, state: State) -> Outcome:
    """The next termination condition is reduced; if none is left, the scenario goes on."""
    running = simulation_of(state).scenarios[number]
    if index == len(running.terminations):
        return Next("", Config(Value(Going()), stack, state))
    declared = running.terminations[index]
    if declared.deadline is not None:
        if not has_passed(declared.deadline, running.first_step, simulation_of(state)):
            return check_termination(number, index + 1, stack, state)
        return time_is_over(declared, running, stack, state)
    assert isinstance(declared.node, d.TerminateWhen)
    prefix = address_of(Who("condition", number, index), state)
    inner = state._replace(sigma=declared.scope, prefix=prefix, draws=0)
    return Next("", Config(declared.node.condition, (Ending(number, index, state), stack), inner))


def time_is_over(declared: Declared, running: Running, stack: Stack, state: State) -> Outcome:
    """⟦terminate after T⟧ = ⟦terminate when T has passed since the scenario began⟧."""
    reason = f"the time limit on line {declared.node.span.line} is reached"
    return Next("D-TerminateAfter", Config(Value(Over(reason)), stack, state), declared.node)


def deadline_of(limit: d.TimeLimit, amount: object, node: Node, rule: str, state: State) -> Deadline:
    """The time limit, once its amount is a value. Raises `RunError` for one that is no number, or below 0."""
    time = value_in_run(amount)
    word = "after" if isinstance(node, d.TerminateAfter) else "for"
    if not is_scalar(time):
        raise RunError(f"the time of `{word}` must be a number, not {kind_name(time)}", node.span, rule=rule)
    if time < 0:  # type: ignore[operator]
        raise RunError(f"the time of `{word}` must be at least 0, not {time}", node.span, rule=rule)
    return Deadline(float(time), limit.unit, state.reading("between-steps") == "rounded-up")  # type: ignore[arg-type]


def resume_ending(frame: Ending, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Termination Conditions": "defines a condition which is monitored as in require eventually, but which when true causes
    the scenario to end."
    """
    node = simulation_of(state).scenarios[frame.number].terminations[frame.i].node
    assert isinstance(node, d.TerminateWhen)
    after = as_before(frame.outer, state)
    if result is GOES_ON or not condition_truth(result, node.condition.span, state, "a termination condition", "D-TerminateWhen"):
        return check_termination(frame.number, frame.i + 1, stack, after)
    reason = f"the termination condition on line {node.span.line} is true"
    if node.simulation:  # the scenario itself goes on, to the end of the time step
        return Next("D-TerminateWhen", Config(Value(GOES_ON), (Ending(frame.number, frame.i, frame.outer), stack), flag_end(reason, state)), node)
    return Next("D-TerminateWhen", Config(Value(Over(reason)), stack, after), node)


def unwind_ending(frame: Ending, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """The condition raised an exception."""
    return Next("", Config(abrupt, stack, as_before(frame.outer, state)))


def as_before(outer: State, state: State) -> State:
    """The state with the scope and the numbering of draws of another."""
    return state._replace(sigma=outer.sigma, prefix=outer.prefix, draws=outer.draws)


# What compose blocks declare


def declare(declared: Declared, stack: Stack, state: State) -> State:
    """A monitor, requirement or termination condition belongs to the scenario that is set up, or whose compose block runs."""
    while stack:
        frame, stack = stack
        if isinstance(frame, Setting) and frame.in_block:
            break
        if isinstance(frame, Coroutine) and frame.who.kind == "compose":
            running = simulation_of(state).scenarios[frame.who.number]
            if isinstance(declared.node, d.MonitorDefinition):
                return with_scenario(state, running._replace(monitors=(*running.monitors, monitor(declared))))
            field = FIELDS[type(declared.node)]
            return with_scenario(state, running._replace(**{field: (*getattr(running, field), declared)}))
    return state._replace(dynamic=(*state.dynamic, declared))
