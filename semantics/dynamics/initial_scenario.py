"""The scenario that a run begins with: the program itself, or a modular one, chosen by name or called Main (Section "Compositional Scenarios")."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from ..machine.conditions import condition_truth
from ..machine.config import Stack, State
from ..machine.operand_kinds import Reader
from ..machine.outcome import Outcome, Requirement
from ..machine.values import Dynamic, Instance, value_in_run
from ..python.calls import invocation
from ..python.functions import InScope
from ..scenes.statements import observe_requirement, require
from ..scenes.termination import apply_termination_rules
from ..store.errors import RunError, UsageError
from ..store.scopes import Scope, bound_by, descendants
from ..store.suggestions import nearest
from ..syntax import dynamics as d
from ..syntax.nodes import NOWHERE, Node, Span
from ..syntax.statements import ClassDefinition, Delete, For, FunctionDefinition, Handler
from .scenarios import setup

MAIN = "Main"


def main_scenario(state: State) -> Dynamic | None:
    """The modular scenario to begin with, None if the program itself is the scenario. Raises `UsageError` if there is none of the name asked for."""
    wanted = state.settings.scenario
    scenarios = scenarios_in(state)
    if wanted is not None and wanted not in scenarios:
        known = ", ".join(sorted(scenarios)) or "none"
        raise UsageError(f"the program defines no scenario {wanted}", hint=f"the scenarios of the program: {known}")
    if wanted is None and MAIN not in scenarios and state.reading("only-scenario") == "begins":
        return only_scenario({name: v for name, v in scenarios.items() if v.scope is state.sigma})
    return scenarios.get(wanted or MAIN)


def only_scenario(scenarios: dict[str, Dynamic]) -> Dynamic | None:
    """The one of the scenarios that the program itself defines, if it needs no arguments. Raises `UsageError` if there are several."""
    if len(scenarios) > 1:
        raise UsageError(f"there are several scenarios to begin with: {', '.join(scenarios)}", hint="choose one by --scenario, or call it Main")
    found = next(iter(scenarios.values()), None)
    if found is None or any(q.default is None and q.kind not in ("*args", "**kwargs") for q in found.definition.parameters):  # type: ignore[attr-defined]
        return None
    return found


def scenarios_in(state: State) -> dict[str, Dynamic]:
    """The modular scenarios that the program defines, by name."""
    defined = {name: value_in_run(v) for name, v in state.sigma.bindings.items()}
    return {name: v for name, v in defined.items() if isinstance(v, Dynamic) and isinstance(v.definition, d.ScenarioDefinition)}


class OpeningGuards(NamedTuple):
    """Frame: precondition number `i` of the initial scenario is being checked; σ is `outer` afterwards."""

    scenario: Dynamic
    i: int
    outer: Scope


def begin_initial(main: Dynamic, stack: Stack, state: State) -> Outcome:
    """Check the preconditions of the initial scenario, then run its setup block as part of the generation of the scene.

    Its invariants are checked in each time step, as those of other scenarios are; under the reading `initial-guards=first-step` its preconditions
    are so in the first one.
    """
    scenario = main if main.arguments is not None else invocation(main, (), {})
    assert scenario.space is not None
    done = len(scenario.definition.preconditions) if state.reading("initial-guards") == "first-step" else 0  # type: ignore[attr-defined]
    return check_preconditions(OpeningGuards(scenario, done, state.sigma), stack, state._replace(initial=scenario, sigma=scenario.space))


def check_preconditions(frame: OpeningGuards, stack: Stack, state: State) -> Outcome:
    """Reduce the next precondition; after the last, the setup block."""
    definition = frame.scenario.definition
    assert isinstance(definition, d.ScenarioDefinition)
    if frame.i == len(definition.preconditions):
        return enter_initial(frame, definition, stack, state)
    condition = definition.preconditions[frame.i]
    requirement = Requirement("precondition", condition.span, f"the precondition of {definition.name} on line {condition.span.line}")
    return require(requirement, condition, precondition, (frame, stack), state)


def precondition(requirement: Requirement, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Dynamic Scenarios", "Preconditions and Invariants": "like ordinary requirements, violating any precondition causes the simulation
    to be rejected." That of the initial scenario is observed.
    """
    return observe_requirement(
        "D-Initial", requirement, condition_truth(result, requirement.span, state, "a precondition", "D-Initial"), stack, state
    )


def resume_opening_guards(frame: OpeningGuards, result: object, stack: Stack, state: State) -> Outcome:
    """A precondition holds: the next one."""
    return check_preconditions(frame._replace(i=frame.i + 1), stack, state)


def enter_initial(frame: OpeningGuards, definition: d.ScenarioDefinition, stack: Stack, state: State) -> Outcome:
    """The preconditions hold: the setup block, in the scope of the scenario."""
    return setup(definition, Node(span=definition.span), (InScope(frame.outer), stack), state)


class Finishing(NamedTuple):
    """Frame at the bottom of the program: when its statements are reduced to `pass`, the termination rules begin. `empty` is the place of a
    program without any, and `unassigned` is the statement that gives its name ego to something else, where nothing assigns ego."""

    empty: Span | None = None
    unassigned: Node | None = None


def resume_finishing(frame: Finishing, result: object, stack: Stack, state: State) -> Outcome:
    """⟨pass, σ, π, O⟩: the program has been reduced, and then the setup of its main scenario; a program without ego is ill-formed."""
    if state.initial is None:
        main = main_scenario(state)
        if main is not None:
            return begin_initial(main, (frame, stack), state)
    if state.ego is None and not may_come_later(state):
        check_without_ego(state, frame.empty, frame.unassigned)
    return apply_termination_rules(stack, order_scene_objects(state))


def unassigned_ego(statements: Iterable[Node]) -> Node | None:
    """The statement that gives the name ego to what is no object of the scene, if no other one binds it."""
    found = [node for st in statements for node in descendants(st) if not isinstance(node, Delete) and "ego" in bound_by(node)]
    return found[0] if found and all(isinstance(node, tuple(EGO_BY)) for node in found) else None


EGO_BY: Mapping[type[Node], str] = {
    For: "a `for` loop gives values to the name ego", Handler: "an `except` clause gives an exception the name ego",
    FunctionDefinition: "ego is the name of a function", ClassDefinition: "ego is the name of a class",
    d.BehaviorDefinition: "ego is the name of a behavior", d.MonitorDefinition: "ego is the name of a monitor",
    d.ScenarioDefinition: "ego is the name of a scenario",
}  # fmt: skip
"""What binds the name ego, but makes nothing the ego object."""


def check_without_ego(state: State, empty: Span | None, unassigned: Node | None = None) -> None:
    """Reading `no-ego`: it is an error, or only where an object must be visible from it."""
    if state.reading("no-ego") == "allowed":
        seen = next((o for o in state.scene if Reader(state).property(o, "requireVisible")), None)
        if seen is not None:
            raise RunError("this object must be visible from ego (its requireVisible), and there is none", seen.span, rule="T-Check")
        return
    scenarios = scenarios_in(state)
    other = f"begin with a scenario: --scenario {' or '.join(scenarios)}, or call it Main"
    text = "the program never assigns ego, the object from whose point of view the scene is"
    if empty is not None:
        raise RunError(f"the program is empty, and so {text.removeprefix('the program ')}", empty, rule="T-Mutate", hint="write ego = Object ...")
    if unassigned is not None:
        text = f"{EGO_BY[type(unassigned)]}, and no assignment makes an object the ego object"
        raise RunError(text, unassigned.span, rule="T-Mutate", hint="write ego = Object ..., and give the other one another name")
    near = nearest("ego", [name for name, found in state.sigma.bindings.items() if isinstance(value_in_run(found), Instance)])
    hint = f"write ego in place of {near}" if near else "write ego = Object ..."
    place = state.scene[0].span if state.scene else NOWHERE
    raise RunError(text, place, rule="T-Mutate", hint=other if scenarios and state.initial is None else hint)


def order_scene_objects(state: State) -> State:
    """The state whose objects stand in the order of the scene (reading `object-order`)."""
    ego = value_in_run(state.ego)
    if state.reading("object-order") == "creation" or ego not in state.scene:
        return state
    return state._replace(scene=(ego, *(o for o in state.scene if o is not ego)))


def may_come_later(state: State) -> bool:
    """Whether a scenario that the compose block of the initial one runs may make ego (reading `compose-only`)."""
    definition = None if state.initial is None else state.initial.definition
    return state.reading("compose-only") == "when-needed" and getattr(definition, "compose", None) is not None
