"""`override` (Section "Statements", "Overrides"): properties of an object, changed until the scenario ends."""

from __future__ import annotations

from ..machine.built_in_properties import checked_property
from ..machine.config import PASS, Config, Stack, State
from ..machine.implicit_positions import expression_of, specifier_scope, waits
from ..machine.operand_kinds import is_object, kind_name
from ..machine.outcome import Change, Next, Outcome
from ..machine.premises import premises
from ..machine.simulation_state import (
    Agent,
    Overridden,
    Running,
    Setting,
    simulation_of,
    with_agent,
    with_scenario,
    with_simulation,
)
from ..machine.values import Dynamic, Instance, value_in_run
from ..python.functions import InScope
from ..scenes.resolution import Specification, specified_twice
from ..scenes.specifier_arguments import describe
from ..store.errors import RunError
from ..store.suggestions import did_you_mean
from ..syntax import dynamics as d
from ..syntax import specifiers as q
from .coroutines import Coroutine


def override(node: d.Override, stack: Stack, state: State) -> Outcome:
    """The object and the values of `override` come first; only `with` can stand in it."""
    for specifier in node.specifiers:
        if not isinstance(specifier, q.WithSpecifier):
            text = "only `with` can stand in `override`: position and heading are updated by the simulator"
            raise RunError(text, specifier.span, rule="D-Override")
    return premises(node, [node.object, *(s.value for s in node.specifiers if isinstance(s, q.WithSpecifier))], conclude_override, stack, state)


def conclude_override(node: d.Override, values: list[object], stack: Stack, state: State) -> Outcome:
    """Section "Statements", "Overrides": "Properties overridden by a scenario revert to their original values when the scenario terminates. When the
    behavior property is overridden, the original behavior is suspended, then resumed at the end of the scenario."

    The old values are remembered here; a behavior is suspended, and the new one begins.
    """
    target, assigned = value_in_run(values[0]), values[1:]
    if not (isinstance(target, Instance) and is_object(target)):
        raise RunError(f"only Objects can be overridden, not {kind_name(target)}", node.span, rule="D-Override")
    if state.simulation is None:
        raise RunError("`override` needs a scenario that runs: the initial one sets the properties themselves", node.span, rule="D-Override")
    if any(map(waits, map(value_in_run, assigned))):
        inner = state._replace(sigma=specifier_scope(target, state.sigma))
        return premises(node, list(map(expression_of, values)), conclude_override, (InScope(state.sigma), stack), inner)
    changes = changed_properties(node, target, assigned, state)
    old = {name: state.objects[target.number][name] for name in changes}
    agent = simulation_of(state).agents.get(target.number, Agent(target)) if "behavior" in changes else None
    order = simulation_of(state).overrides
    state = with_simulation(state, overrides=order + 1)
    state = remember_override(Overridden(target, old, agent, order), stack, state.with_properties(target, changes))
    state = with_agent(state, Agent(target)) if agent is not None else state
    return Next("D-Override", Config(PASS, stack, state), node, Change("O", repr(target), changes, target))


def changed_properties(node: d.Override, target: Instance, assigned: list[object], state: State) -> dict[str, object]:
    """Return the properties that `override` specifies, with the values that its specifiers give them.

    Section "Statements", "Overrides": "It has the same structure as an object definition". So a property is specified once (Algorithm 1, gather all
    specified properties), has its second spelling, and takes the values that it takes there. Raises `RunError` and `SpecifiedTwice`.
    """
    specified: dict[str, Specification] = {}
    changes: dict[str, object] = {}
    for specifier, value in zip(node.specifiers, assigned, strict=True):
        assert isinstance(specifier, q.WithSpecifier)
        specification = describe(specifier, [value], state)
        (name,) = specification.specifies
        if name in specified:
            raise specified_twice(name, specified[name], specification)
        specified[name] = specification
        if name in simulation_of(state).fixed:
            raise RunError(f"{name} is updated by the simulator: it cannot be overridden", specifier.span, rule="D-Override")
        if name not in state.objects[target.number]:
            hint = did_you_mean(name, state.objects[target.number], "")
            raise RunError(f"{target!r} has no property {name}", specifier.span, rule="D-Override", hint=hint)
        if name in target.class_.finals:
            text = f"the property {name} of {target.class_.name} is final: no specifier may specify it"
            raise RunError(text, specifier.span, rule="D-Override")
        changes[name] = checked_property(name, value, specifier.value.span, specification.name, state)
        inner = value_in_run(value)
        if name == "behavior" and inner is not None and not (isinstance(inner, Dynamic) and isinstance(inner.definition, d.BehaviorDefinition)):
            raise RunError(f"the property behavior must be a behavior, not {kind_name(inner)}", specifier.value.span, rule="D-Override")
    return changes


def remember_override(override: Overridden, stack: Stack, state: State) -> State:
    """The override belongs to the scenario that is set up, or whose compose block runs."""
    while stack:
        frame, stack = stack
        if isinstance(frame, Setting) and frame.in_block:
            number = simulation_of(state).begun
            waiting = simulation_of(state).scenarios.get(number, Running(number, None, state.sigma, None))
            return with_scenario(state, waiting._replace(overrides=(*waiting.overrides, override)))
        if isinstance(frame, Coroutine) and frame.who.kind == "compose":
            running = simulation_of(state).scenarios[frame.who.number]
            return with_scenario(state, running._replace(overrides=(*running.overrides, override)))
    raise RunError("`override` must stand in a scenario", rule="D-Override")


def revert_override(override: Overridden, number: int, state: State) -> State:
    """The object has its properties again, and goes on with the behavior that was suspended.

    Where another scenario has overridden them since, which is still running, they come back when that one ends (reading `override-overlap`).
    """
    for name, old in override.properties.items():
        heir = next(iter(later_overrides(override, number, name, state)), None) if state.reading("override-overlap") == "last-ends" else None
        agent = override.agent if name == "behavior" else None
        if heir is None:
            state = state.with_properties(override.object, {name: old})
            state = state if agent is None else with_agent(state, agent)
        else:
            running, place = heir
            other = running.overrides[place]
            changed = other._replace(properties={**other.properties, name: old}, agent=agent or other.agent)
            state = with_scenario(state, running._replace(overrides=(*running.overrides[:place], changed, *running.overrides[place + 1 :])))
    return state


def later_overrides(override: Overridden, number: int, name: str, state: State) -> list[tuple[Running, int]]:
    """Overrides of the same property by other scenarios that were made after this one, the earliest first: the scenario, and the place in it."""
    found = [
        (other.order, running, place)
        for running in simulation_of(state).scenarios.values() if running.number != number
        for place, other in enumerate(running.overrides)
        if other.order > override.order and other.object is override.object and name in other.properties
    ]  # fmt: skip
    return [(running, place) for _, running, place in sorted(found, key=lambda one: one[0])]
