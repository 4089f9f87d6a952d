"""The scenario that a run begins with: the program itself, or a modular one, chosen by name or called Main (Section "Compositional Scenarios")."""

from __future__ import annotations

from functools import partial

from ..calls import invocation
from ..config import Stack, State
from ..control import block
from ..errors import UsageError
from ..functions import InScope
from ..outcome import Outcome
from ..syntax import dynamics as d
from ..syntax.nodes import Node
from ..values import Dynamic, plain
from .guards import guarded

MAIN = "Main"


def main_scenario(state: State) -> Dynamic | None:
    """The modular scenario to begin with, None if the program itself is the scenario. Raises `UsageError` if there is none of the name asked for."""
    wanted = state.settings.scenario
    scenarios = scenarios_in(state)
    if wanted is not None and wanted not in scenarios:
        known = ", ".join(sorted(scenarios)) or "none"
        raise UsageError(f"the program defines no scenario {wanted}", hint=f"the scenarios of the program: {known}")
    return scenarios.get(wanted or MAIN)


def scenarios_in(state: State) -> dict[str, Dynamic]:
    """The modular scenarios that the program defines, by name."""
    defined = {name: plain(v) for name, v in state.sigma.bindings.items()}
    return {name: v for name, v in defined.items() if isinstance(v, Dynamic) and isinstance(v.definition, d.ScenarioDefinition)}


def begin_initial(main: Dynamic, stack: Stack, state: State) -> Outcome:
    """Check the guards of the initial scenario, then run its setup block as part of the generation of the scene."""
    from .invocations import guards_of

    scenario = main if main.arguments is not None else invocation(main, (), {})
    assert scenario.space is not None
    after = state._replace(initial=scenario)
    return guarded(guards_of(scenario, scenario.space), partial(enter_initial, scenario), stack, after)


def enter_initial(scenario: Dynamic, stack: Stack, state: State) -> Outcome:
    """The guards hold: the setup block, in the scope of the scenario."""
    definition = scenario.definition
    assert isinstance(definition, d.ScenarioDefinition)
    node = Node(span=definition.span)
    return block(definition.setup or (), (InScope(state.sigma), stack), state._replace(sigma=scenario.space or state.sigma), "D-Setup", node)
