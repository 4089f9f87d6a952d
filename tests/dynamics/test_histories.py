"""Enumeration of simulations: exact probabilities of action histories, and sampling agrees with them."""

from __future__ import annotations

import json
import math
import os
from dataclasses import replace
from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.conformance.generator.dynamic_programs import STEPS, dynamic_programs
from scenic_ref.data.simulation import to_json
from scenic_ref.inference.comparison.exact_laws import DEFAULT_ALPHA, Categorical, evidence
from scenic_ref.inference.enumeration import enumerate_simulations
from scenic_ref.inference.simulation_rejection import sample_simulation
from scenic_ref.semantics.store.errors import AttemptsExhausted, RunsExhausted, UsageError
from scenic_ref.simulators.loop import Simulated
from scenic_ref.simulators.still import Still

COUNT = int(os.environ.get("SCENIC_REF_PROGRAMS", "60"))
SCENES = 60


def taken(simulation: Simulated) -> tuple[object, ...]:
    """What the first object did."""
    return tuple(moment.actions.get(0) for moment in simulation.moments[:-1])


def test_probabilities_of_action_histories_by_hand():
    text = """
behavior B():
    first = Discrete({1: 1, 2: 3})
    take first
    if first == 2:
        take Uniform('a', 'b')
    require Uniform(True, True, False)
    take 'end'
ego = Object at (0, 0), with behavior B
"""
    exact = scenic_ref.loads(text).enumerate_simulations(steps=3)
    assert exact.law(taken) == {
        ((1,), ("end",), None): Fraction(1, 4), ((2,), ("a",), ("end",)): Fraction(3, 8), ((2,), ("b",), ("end",)): Fraction(3, 8),
    }  # fmt: skip
    assert exact.acceptance == Fraction(2, 3)
    assert {(failed.step, p) for failed, p in exact.stuck.items()} == {(1, Fraction(1, 12)), (2, Fraction(1, 4))}
    assert exact.runs == 3 + 2 * 3


def test_do_choose_and_shuffle_have_the_weights_of_the_paper():
    """If only ParkedCar is disabled, RedLightRunner has probability 2/3; if none are, 2/4."""
    text = """
behavior P(n, ok=True):
    precondition: ok
    take n
behavior B():
    do choose {P('red'): 2, P('walk'): 1, P('parked', %s): 1}
ego = Object at (0, 0), with behavior B
"""
    law = scenic_ref.loads(text % False).enumerate_simulations(steps=1).law(taken)
    assert law == {(("red",),): Fraction(2, 3), (("walk",),): Fraction(1, 3)}
    law = scenic_ref.loads(text % True).enumerate_simulations(steps=1).law(taken)
    assert law[(("red",),)] == Fraction(2, 4)
    shuffled = text.replace("choose", "shuffle") % True
    assert scenic_ref.loads(shuffled).enumerate_simulations(steps=3).law(taken)[("red",), ("walk",), ("parked",)] == Fraction(2, 4) * Fraction(1, 2)


def test_histories_that_differ_in_created_objects_only_are_apart():
    text = """
class A:
    color: 'red'
class B:
    color: 'blue'
scenario T():
    setup: A at (10, 0)
scenario U():
    setup: B at (10, 0)
scenario Main():
    setup: ego = Object at (0, 0)
    compose:
        do choose {T(): 1, U(): 3} for 1 steps
"""
    law = scenic_ref.loads(text).enumerate_simulations(steps=2).law(lambda s: tuple(body.class_name for body in s.created))
    assert law == {("A",): Fraction(1, 4), ("B",): Fraction(3, 4)}


def whole(simulation: Simulated) -> str:
    """All that is written of a simulation but its number: what an outcome is here is not what `content_of` says."""
    unnumbered = simulation._replace(scene=replace(simulation.scene, seed=0, index=0, attempts=1))
    return json.dumps(to_json(unnumbered, 1))


def test_what_is_not_finite_or_too_large_is_refused():
    text = "behavior B():\n    while True:\n        take {}\nego = Object at (0, 0), with behavior B"
    with pytest.raises(UsageError, match="infinitely many values"):
        scenic_ref.loads(text.format("Range(0, 1)")).enumerate_simulations(steps=2)
    with pytest.raises(RunsExhausted, match="more than 50 runs"):
        scenic_ref.loads(text.format("Uniform(1, 2, 3)")).enumerate_simulations(steps=9, max_runs=50)
    with pytest.raises(AttemptsExhausted, match="all 1 runs fail"):
        scenic_ref.loads("ego = Object at (0, 0)\nrequire always False").enumerate_simulations(steps=2)


def against_the_law(number: int, text: str, **sampled: str) -> float | None:
    """The evidence (log10 of an e-value) against sampling with some readings as enumerated without them; None if that is infeasible or too large."""
    scenario = scenic_ref.loads(text)
    try:
        exact = enumerate_simulations(scenario.start, Still(), STEPS, max_runs=2000)
    except (AttemptsExhausted, RunsExhausted):
        return None
    assert sum(p for p, _ in exact.outcomes) == 1
    assert exact.acceptance + sum(exact.stuck.values()) == 1
    other = scenic_ref.loads(text, readings=sampled)
    try:
        runs = [sample_simulation(other.start, Still(), STEPS, number, k, max_attempts=3000).simulation for k in range(SCENES)]
    except AttemptsExhausted:
        return math.inf
    return evidence([whole(run) for run in runs], Categorical(exact.law(whole)))


@pytest.mark.slow
def test_random_programs_are_sampled_as_enumerated():
    """Level: `DEFAULT_ALPHA` for all programs together. `SCENIC_REF_PROGRAMS=500` runs 500."""
    found = [against_the_law(k, text) for k, text in enumerate(dynamic_programs(COUNT, 2026))]
    judged = [f for f in found if f is not None]
    assert len(judged) > 0.6 * COUNT
    assert max(judged) < -math.log10(DEFAULT_ALPHA / COUNT)


@pytest.mark.slow
def test_another_reading_of_interrupts_is_told_apart():
    found = (against_the_law(k, text, **{"interrupt-first-step": "later-steps"}) for k, text in enumerate(dynamic_programs(150, 2026)))
    assert any(f is not None and f > -math.log10(DEFAULT_ALPHA / 150) for f in found)
