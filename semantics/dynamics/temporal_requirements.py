"""`require always` and `require eventually`: the conditions of a scenario that the policy looks at in each time step."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from ..machine.conditions import condition_truth
from ..machine.config import PASS, Config, Stack, State
from ..machine.outcome import Next, Observe, Outcome, Requirement, Stuck
from ..machine.simulation_state import Declared, Running, Who, simulation_of, with_scenario
from ..syntax import dynamics as d
from .coroutines import address_of

CONDITIONS = 1 << 20
"""The draws of requirements are numbered apart from those of termination conditions."""


def over_time(running: Running) -> Iterator[tuple[int, Declared]]:
    """The requirements over time of a scenario, each with its place among its kind."""
    yield from enumerate(running.always)
    yield from enumerate(running.eventually)


def decision(number: int, place: int, declared: Declared) -> Callable[..., Outcome]:
    """Return the rule that decides by the value of a requirement's condition."""
    return always if isinstance(declared.node, d.RequireAlways) else partial(eventually, number, place)


def condition_at(number: int, place: int, declared: Declared, stack: Stack, state: State) -> Outcome:
    """Reduce a condition, in the scope in which it was declared; its draws are numbered apart."""
    part = (2 * CONDITIONS if isinstance(declared.node, d.Record) else CONDITIONS) + 2 * place + isinstance(declared.node, d.RequireEventually)
    prefix = address_of(Who("condition", number, part), state)
    inner = state._replace(sigma=declared.scope, prefix=prefix, draws=0)
    return Next("", Config(declared.node.value if isinstance(declared.node, d.Record) else declared.node.condition, stack, inner))  # type: ignore[attr-defined]


def always(node: d.RequireAlways, result: object, stack: Stack, state: State) -> Outcome:
    """Section "Dynamic Scenarios", "Requirements and Monitors": "enforces that the given condition must hold at every time step of the scenario;
    if it is ever violated during a simulation, we reject that simulation and sample a new one." It is step 2 of the policy.
    """
    requirement = Requirement("always", node.span, f"`require always` on line {node.span.line}")
    holds = condition_truth(result, node.condition.span, state, "a requirement", "D-Always")
    return Observe("D-Always", requirement, Config(PASS, stack, state)) if holds else Stuck("D-Always", requirement)


def eventually(number: int, place: int, node: d.RequireEventually, result: object, stack: Stack, state: State) -> Outcome:
    """`require eventually B`: where B holds now, it has held at some time."""
    if condition_truth(result, node.condition.span, state, "a requirement", "D-Eventually"):
        running = simulation_of(state).scenarios[number]
        state = with_scenario(state, running._replace(satisfied=running.satisfied | {place}))
    return Next("", Config(PASS, stack, state))
