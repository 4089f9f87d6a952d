"""The policy: from the state of a simulation to the actions of its agents, in the seven steps of Section "Semantics of Scenic", "Dynamic Constructs".

"A function mapping the history of past scenes to the choice of actions": the history is in the state, as what the coroutines still have to do.
A step that fails a requirement discards the simulation (`Stuck`).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

from ..machine.config import PASS, Abrupt, Config, Stack, State, Value
from ..machine.host_calls import HostException
from ..machine.operand_kinds import kind_name
from ..machine.outcome import Act, Finish, Next, Outcome, Requirement, Stuck
from ..machine.simulation_state import (
    TOP,
    Agent,
    Declared,
    Running,
    Simulation,
    Suspended,
    Who,
    flag_end,
    simulation_of,
    with_agent,
    with_scenario,
    with_simulation,
)  # fmt: skip
from ..machine.value_nesting import check_nesting, expanded_size
from ..machine.values import Dynamic, copy_containers, value_in_run
from ..store.errors import GuardViolation, RunError
from ..syntax import dynamics as d
from ..syntax.nodes import NOWHERE, Node
from . import guards
from .coroutines import Ended, Yielded
from .endings import end_scenario
from .guards import PRECONDITIONS, guarded_apart, opening_guards
from .interrupts import run_for_one_step
from .invocations import Begin, Beginning, begin_all, with_arguments
from .scenarios import Over, as_before, scenario_from, settle_properties, step_of_scenario
from .temporal_requirements import condition_at, decision, over_time

DEFAULT_TIMESTEP = 0.1
"""Seconds."""


class Step(NamedTuple):
    """Frame of a step of the policy: what comes `next` in it is the thing at that place; `outer` is the state to evaluate in."""

    number: int
    next: int = 0
    outer: State | None = None


# The beginning, and the time between


def begin(state: State, timestep: float = DEFAULT_TIMESTEP, fixed: frozenset[str] = frozenset()) -> State:
    """The state of a simulation before its first time step, from that at the end of the generation of a scene.

    `timestep` is in seconds; `fixed` are the properties that the simulator updates.
    """
    own = state.initial.space if state.initial is not None else None
    top = scenario_from(TOP, state.initial, own or state.sigma, state.dynamic)
    fixed |= {"position", "heading"}
    simulation = Simulation(0, timestep, {TOP: top}, active=(TOP,), fixed=fixed, known=state.made, egoless=state.ego is None)
    return state._replace(simulation=simulation, objects=settle_properties(state.objects), dynamic=(), handling=(), depth=0)


def policy(state: State, limit: str = "") -> Config:
    """The configuration that computes the actions of a time step: it ends with `Act`, `Finish` or `Stuck`.

    `limit` is the reason to end in this time step if there is no other: the time limit (reading `time-limit`).
    """
    return Config(PASS, (Step(1), ()), with_simulation(state, flag="", limit=limit))


def after_one_step(state: State) -> State:
    """The state in the next time step; the simulator has updated the objects."""
    simulation = simulation_of(state)
    return state.with_simulation(tuple.__new__(Simulation, (simulation.step + 1, *simulation[1:])))  # pyright: ignore[reportUnknownMemberType]


# The seven steps


def resume_step(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Go on with the policy's step."""
    return STEPS[frame.number](frame, result, stack, state)


def compose_blocks(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 1: "Run the compose blocks of all currently-running scenarios for one time step.
    If any require conditions fail, discard the simulation. If instead the top-level scenario finishes its compose block (if any), one of its
    terminate when conditions is true, or it executes terminate, set a flag to remember this".
    """
    if result is None:
        first, inner = partial(step_of_scenario, TOP), with_simulation(state, active=())
        return guarded_apart(Who("compose", TOP, PRECONDITIONS), opening_guards(state), first, (frame, stack), inner)
    reason = result.reason if isinstance(result, Over) else ""
    return advance_policy(frame, "D-Policy-1", stack, flag_end(reason, state))


def requirements_over_time(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 2: "Check all require always conditions of currently-running scenarios; if any fail,
    discard the simulation."

    Here it is seen as well which `require eventually` conditions hold now; one of a scenario that is over, and that never held, discards the
    simulation (reading `eventually-window`).
    """
    todo = list(conditions(state))
    if frame.outer is not None:
        number, place, declared = todo[frame.next]
        decide = conclude_record if isinstance(declared.node, d.Record) else decision(number, place, declared)
        return decide(declared.node, result, (frame._replace(next=frame.next + 1, outer=None), stack), as_before(frame.outer, state))  # type: ignore[arg-type]
    if frame.next < len(todo):
        return condition_at(*todo[frame.next], (frame._replace(outer=state), stack), state)
    ended = (running for running in simulation_of(state).scenarios.values() if running.over)
    missed = next((missed for running in ended if (missed := never_held(running)) is not None), None)
    return never_satisfied(missed) if missed is not None else advance_policy(frame, "D-Policy-2", stack, state)


def conclude_record(node: d.Record, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨E, σ⟩ → v in time step t then ⟨record E as name, σ⟩ → ⟨pass, σ⟩, and (t, v) is recorded under the name.

    Of `record initial E` that is so in the first time step of the scenario, of `record final E` in its last. The last statement of a name counts.
    """
    name, now = name_of_record(node), simulation_of(state).step
    check_nesting("a recorded value", result, node.span)
    state.settings.door.budget.spend(expanded_size(result))
    recorded = simulation_of(state).recorded
    before = () if node.time == "final" else tuple(earlier for earlier in recorded.get(name, ()) if earlier[0] < now)
    after = with_simulation(state, recorded={**recorded, name: (*before, (now, copy_containers(value_in_run(result), {})))})
    return Next("D-Record", Config(PASS, stack, after), node)


def name_of_record(node: d.Record) -> str:
    """The name under which values are kept: that of the statement, or its line."""
    return node.name or f"line {node.span.line}"


def is_due(declared: Declared, running: Running, simulation: Simulation) -> bool:
    """Whether a value is recorded in this time step."""
    node = declared.node
    assert isinstance(node, d.Record)
    return node.time != "initial" or simulation.step == running.first_step


def never_satisfied(missed: Requirement) -> Stuck:
    """Section "Dynamic Scenarios", "Requirements and Monitors": "we can require that a condition hold at some time during the scenario using the
    require eventually statement". One that never did discards the simulation, in step 4 of the policy.
    """
    return Stuck("D-Eventually", missed)


def conditions(state: State) -> Iterator[tuple[int, int, Declared]]:
    """Yield the conditions of step 2: the scenario, the place among its kind, and the requirement."""
    simulation = simulation_of(state)
    for number in dict.fromkeys(simulation.active):
        running = simulation.scenarios[number]
        if state.reading("requirements-order") == "after":
            yield from ((number, place, one) for place, one in over_time(running))
        yield from ((number, place, one) for place, one in enumerate(running.records) if is_due(one, running, simulation))


def monitors(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 3: "Run all monitors of currently-running scenarios for one time step. As above,
    discard the simulation if any require conditions fail, and set the terminate flag if the terminate statement is executed."
    """
    there, active = simulation_of(state).scenarios, simulation_of(state).active
    todo = [(number, place) for number in dict.fromkeys(active) for place in range(len(there[number].monitors))]
    if result is not None:
        number, place = todo[frame.next]
        running = simulation_of(state).scenarios[number]
        rest = result.rest if isinstance(result, Yielded) else None
        kept = (*running.monitors[:place], rest, *running.monitors[place + 1 :])
        state = with_scenario(state, running._replace(monitors=kept))
        if isinstance(result, Ended) and result.terminates:
            state = ended_by_monitor(number, state)
        frame = Step(frame.number, frame.next + 1)
    while frame.next < len(todo):
        number, place = todo[frame.next]
        process = simulation_of(state).scenarios[number].monitors[place]
        if process is not None:
            return run_for_one_step(process, Who("monitor", number, place), (frame, stack), state)
        frame = Step(frame.number, frame.next + 1)
    left = {number: running for number, running in simulation_of(state).scenarios.items() if not running.over or has_unreported_eventually(running)}
    return advance_policy(frame, "D-Policy-3", stack, with_simulation(state, scenarios=left))


def has_unreported_eventually(running: Running) -> bool:
    """Whether a scenario that a monitor has ended just now has a `require eventually` that never held: the next check of these finds it."""
    return never_held(running) is not None


def ended_by_monitor(number: int, state: State) -> State:
    """`terminate` in a monitor ends the scenario that declares it, the top level by the flag; or the flag is the simulation's (`terminate-who`)."""
    if number == TOP or state.reading("terminate-who") == "simulation":
        return flag_end("a monitor executed `terminate`", state)
    return end_scenario(number, state)


def check_flag(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 4: "If the flag is set, check that all require eventually conditions were
    satisfied at some time step: if so, terminate the simulation; otherwise, discard it."
    """
    return end_or_advance(frame, "D-Policy-4", stack, state)


def check_flag_again(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 6: "Repeat (4) to check the terminate flag."
    """
    return end_or_advance(frame, "D-Policy-6", stack, state)


def end_or_advance(frame: Step, rule: str, stack: Stack, state: State) -> Outcome:
    """The end of the scenario, if there is a reason for it."""
    simulation = simulation_of(state)
    reason = simulation.flag or simulation.limit
    if not reason:
        return advance_policy(frame, rule, stack, state)
    missed = first_unsatisfied(state)
    if missed is not None:
        return never_satisfied(missed)
    if simulation.flag and state.ego is None and state.reading("no-ego") == "error":
        where = NOWHERE if state.initial is None else state.initial.definition.span
        text = "the simulation ended, and none of its scenarios had made ego"
        raise RunError(text, where, rule=rule, hint="write ego = Object ... in the scenario, or in one that it always runs")
    return Finish(rule, reason, state)


def first_unsatisfied(state: State) -> Requirement | None:
    """A `require eventually` that never held."""
    return next((missed for r in simulation_of(state).scenarios.values() if (missed := never_held(r)) is not None), None)


def never_held(running: Running) -> Requirement | None:
    """The first `require eventually` of a scenario that never held while it ran; one that did not run at all has missed nothing."""
    for place, declared in enumerate(running.eventually):
        if running.ran and place not in running.satisfied:
            return Requirement("eventually", declared.node.span, f"`require eventually` on line {declared.node.span.line}")
    return None


def behaviors(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 5: "Run all the behaviors of dynamic agents for one time step, gathering their
    actions and discarding the simulation or setting the terminate flag as in (3)."
    """
    if frame.next == 0 and result is None:
        state = with_simulation(state, agents={n: a._replace(actions=()) for n, a in simulation_of(state).agents.items()})
    if result is not None:
        instance = state.scene[frame.next]
        agent = simulation_of(state).agents[instance.number]
        if isinstance(result, Yielded):
            state = with_agent(state, agent._replace(process=result.rest, actions=result.actions))
        else:
            state = with_agent(state, agent._replace(process=None, ended=True))
            if isinstance(result, Ended) and result.terminates:
                state = flag_end(f"the behavior of {instance!r} executed `terminate`", state)
        frame = Step(frame.number, frame.next + 1)
    stopped = simulation_of(state).flag and state.reading("behaviors-after-terminate") == "stop"
    while frame.next < len(state.scene) and not stopped:
        instance = state.scene[frame.next]
        agent = simulation_of(state).agents.get(instance.number, Agent(instance))
        behavior = value_in_run(state.objects[instance.number].get("behavior"))
        if behavior is not None and not agent.ended:
            process = agent.process or first_step(behavior, instance.span, state)
            who = Who("behavior", instance.number)
            return run_for_one_step(process, who, (frame, stack), with_agent(state, agent))
        frame = Step(frame.number, frame.next + 1)
    return advance_policy(frame, "D-Policy-5", stack, state)


def first_step(behavior: object, span: object, state: State) -> Suspended:
    """The course of an agent's behavior before its first time step."""
    node = Node(span=span)  # type: ignore[arg-type]
    if not isinstance(behavior, Dynamic) or not isinstance(behavior.definition, d.BehaviorDefinition):
        raise RunError(f"the property behavior must be a behavior, not {kind_name(behavior)}", node.span, rule="D-Policy-5")
    try:
        begun = Begin(node, (with_arguments(behavior, node, state),))
    except HostException as problem:
        raise RunError(str(problem.exception), node.span, rule="D-Policy-5") from None
    return Suspended(Value(begun), (Beginning(begin_all),), state.sigma, begun=False)


def actions(frame: Step, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Semantics of Scenic", "Dynamic Constructs", step 7: "Return the choice of actions selected by the dynamic agents."
    """
    chosen = {number: agent.actions for number, agent in simulation_of(state).agents.items() if agent.actions}
    return Act("D-Policy-7", chosen, state)


STEPS = {1: compose_blocks, 2: requirements_over_time, 3: monitors, 4: check_flag, 5: behaviors, 6: check_flag_again, 7: actions}


def advance_policy(frame: Step, rule: str, stack: Stack, state: State) -> Outcome:
    """A step of the policy is done: on with the next."""
    return Next(rule, Config(PASS, (Step(frame.number + 1), stack), state))


def unwind_step(frame: Step, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception leaves a time step: a guard's violation rejects, any other is the program's error."""
    if isinstance(abrupt.value, GuardViolation):
        return guards.at_top_level(abrupt)
    return Next("", Config(abrupt, stack, state))
