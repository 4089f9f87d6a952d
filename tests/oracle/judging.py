"""The law of a program's histories as scenic-ref has it, in the terms of the oracle."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping
from fractions import Fraction

import scenic_ref
from scenic_ref.semantics.machine.outcome import Requirement
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.simulators.loop import Failed, Simulated

from .invention import STEPS
from .policy import Policy, law_of
from .programs import DynamicProgram, text_of

MOST_RUNS = 100_000


def machine_law(text: str) -> Mapping[tuple[Hashable, ...], Fraction]:
    """The probability of each history and of each rejection. Raises `AttemptsExhausted` if no run is accepted."""
    exact = scenic_ref.loads(text).enumerate_simulations("still", STEPS, timestep=1.0, max_runs=MOST_RUNS)
    law: dict[tuple[Hashable, ...], Fraction] = defaultdict(Fraction)
    for probability, simulation in exact.outcomes:
        law[history_of(simulation)] += probability * exact.acceptance
    for failed, probability in exact.stuck.items():
        law[rejection_of(failed)] += probability
    return dict(law)


def history_of(simulation: Simulated) -> tuple[Hashable, ...]:
    """A simulation in the terms of the oracle."""
    created = [body.properties["x"] for body in simulation.created]
    steps = []
    known = len(simulation.scene.objects)
    for moment in simulation.moments:
        new = len(moment.objects) - known
        known += new
        steps.append((frozenset(moment.actions.items()), tuple(created[:new])))
        del created[:new]
    return tuple(one.properties["x"] for one in simulation.scene.objects), tuple(steps), simulation.result


def rejection_of(failed: Failed) -> tuple[Hashable, ...]:
    """Why a run was rejected, and in which time step."""
    return failed.requirement.kind, -1 if failed.step is None else failed.step


def differences(program: DynamicProgram, policy: type[Policy] = Policy) -> str:
    """What the oracle and the machine say differently of a program; empty if they agree. Where all is rejected, the machine says why, not when."""
    ours = law_of(program, STEPS, policy).histories
    try:
        theirs = machine_law(text_of(program))
    except AttemptsExhausted as none:
        kinds = {requirement.kind for requirement, _ in none.stuck if isinstance(requirement, Requirement)}
        return "" if kinds == {h[0] for h in ours} else f"\n{set(ours)} by the oracle, rejected by the machine: {kinds}"
    found = [(h, ours.get(h, 0), theirs.get(h, 0)) for h in {**ours, **theirs} if ours.get(h, 0) != theirs.get(h, 0)]
    return "".join(f"\n{p} by the oracle, {q} by the machine: {h}" for h, p, q in found)


def is_accepted(history: tuple[Hashable, ...]) -> bool:
    """Whether it is a simulation, and no rejection."""
    return len(history) == 3
