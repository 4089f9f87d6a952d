"""Declarations of scenarios for the policy: definitions of behaviors, monitors and scenarios, monitors that
run, and conditions over time.
"""

from __future__ import annotations

from ..machine.config import PASS, Config, Stack, State
from ..machine.operand_kinds import kind_name
from ..machine.outcome import Change, Next, Outcome
from ..machine.premises import premises
from ..machine.simulation_state import Declared
from ..machine.values import Dynamic, value_in_run
from ..store.errors import RunError
from ..store.scopes import descendants
from ..syntax import dynamics as d
from ..syntax import statements as s
from ..syntax.nodes import Node
from ..syntax.python_expressions import Name
from .guards import scope_of
from .invocations import with_arguments
from .scenarios import deadline_of, declare


def dynamic_requirement(node: Node, stack: Stack, state: State, declared: Declared | None = None) -> Outcome:
    """Section "Statements", "Requirements": "define requirements that must hold in every and some time step of the scenario respectively." They,
    and `terminate when`, are conditions for the policy, not the scene; so is what `require monitor` has `declared`.
    """
    control = PASS
    if isinstance(node, d.RequireAlways) and state.simulation is None and state.reading("always-in-scenes") == "required" and not asks_time(node):
        control = s.Require(condition=node.condition, span=node.span)
    return Next("S-Dynamic", Config(control, stack, declare(declared or Declared(node, state.sigma), stack, state)), node)


def asks_time(node: Node) -> bool:
    """Whether a condition speaks of the simulation, so that a scene alone cannot satisfy it."""
    return any(isinstance(part, Name) and part.name == "simulation" for part in descendants(node))


def terminate_after(node: d.TerminateAfter, stack: Stack, state: State) -> Outcome:
    """`terminate after S seconds`: S is evaluated now."""
    return premises(node, [node.limit.amount], conclude_terminate_after, stack, state)


def conclude_terminate_after(node: d.TerminateAfter, values: list[object], stack: Stack, state: State) -> Outcome:
    """Declare the time limit."""
    return dynamic_requirement(node, stack, state, Declared(node, state.sigma, deadline_of(node.limit, values[0], node, "D-TerminateAfter", state)))


def simulator(node: s.ChooseSimulator, stack: Stack, state: State) -> Outcome:
    """⟨simulator E, σ⟩ → ⟨pass, σ⟩: which simulator runs the scenario says whoever runs it."""
    return Next("S-Simulator", Config(PASS, stack, state), node)


def require_monitor(node: d.RequireMonitor, stack: Stack, state: State) -> Outcome:
    """`require monitor M(arguments)` of dialect `scenic-3`: the monitor runs from here on."""
    return premises(node, [node.monitor], conclude_require_monitor, stack, state)


def conclude_require_monitor(node: d.RequireMonitor, values: list[object], stack: Stack, state: State) -> Outcome:
    """Declare the monitor with its arguments."""
    found = value_in_run(values[0])
    if not (isinstance(found, Dynamic) and isinstance(found.definition, d.MonitorDefinition)):
        raise RunError(f"`require monitor` needs a monitor, not {kind_name(found)}", node.span, rule="S-Dynamic")
    return dynamic_requirement(node, stack, state, declare_monitor(found, node, state))


def dynamic_definition(node: d.BehaviorDefinition | d.MonitorDefinition | d.ScenarioDefinition, stack: Stack, state: State) -> Outcome:
    """⟨behavior b(x=E): s, σ⟩ → ⟨pass, σ[b / the behavior]⟩, where E is evaluated now; likewise for `monitor` and `scenario`."""
    return premises(node, [q.default for q in node.parameters], conclude_definition, stack, state)


def conclude_definition(
    node: d.BehaviorDefinition | d.MonitorDefinition | d.ScenarioDefinition, values: list[object], stack: Stack, state: State
) -> Outcome:
    """Bind the name; a monitor is declared as well, since it runs from its definition on (reading `monitor-structure`)."""
    defaults = {q.name: v for q, v in zip(node.parameters, values, strict=True) if q.default is not None}
    defined = Dynamic(node, state.sigma, defaults)
    state.sigma.bind(node.name, defined)
    if isinstance(node, d.MonitorDefinition) and not node.by_instance:
        state = declare(declare_monitor(defined, node, state), stack, state)
    return Next("S-Definition", Config(PASS, stack, state), node, Change("σ", node.name, defined))


def declare_monitor(monitor: Dynamic, node: Node, state: State) -> Declared:
    """A monitor that is to run, with a scope of its own in which its parameters are bound."""
    instance = with_arguments(monitor, node, state)
    return Declared(instance.definition, scope_of(instance, state))
