"""Finite programs: enumeration gives probabilities, and sampled frequencies agree with them.

The null hypothesis is that all programs are sampled as enumerated; its level of 1e-9 is divided by twice the number of programs
and one. The rivals are samplers with one fault each, which the same test must find.
"""

from __future__ import annotations

import os

import pytest
from hypothesis import given
from scenic_ref.api import loads
from scenic_ref.conformance.generator import ProgramSettings
from scenic_ref.conformance.generator.hypothesis_strategies import finite_programs
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.semantics.syntax import Program

from .cases import COUNT, quick
from .frequency_agreement import Rival, agreement

SEED = int(os.environ.get("SCENIC_REF_SEED", "2026"))  # pinned, but for `make nightly`
PROCESSES = min(2, os.cpu_count() or 1)
COINS = ProgramSettings(soft=1.0, requirements=0.0, mutate=0.0, workspace=0.0, max_outcomes=16)


@pytest.mark.slow
@quick(60)
@given(finite_programs())
def test_probabilities_add_up_to_1_or_the_program_is_infeasible(program: Program):
    try:
        exact = loads(program.text).enumerate(max_runs=64)
    except AttemptsExhausted:
        return
    assert sum(outcome.probability for outcome in exact.outcomes) == 1
    assert 0 < exact.acceptance <= 1
    assert exact.acceptance + sum(exact.stuck.values()) == 1
    assert all(outcome.probability > 0 for outcome in exact.outcomes)


@pytest.mark.slow
def test_sampled_frequencies_agree_with_enumeration():
    found = agreement(COUNT, seed=SEED, processes=PROCESSES)
    assert not found.contradictions
    assert sum(x.acceptance == 0 for x in found.examined) < COUNT // 5
    assert sum(x.outcomes > 1 for x in found.examined) > COUNT // 2


@pytest.mark.slow
@pytest.mark.parametrize(("rival", "settings"), [("first value twice as likely", ProgramSettings()), ("coins once per scene", COINS)])
def test_a_wrong_sampler_is_found_out(rival: Rival, settings: ProgramSettings):
    assert agreement(max(60, COUNT // 10), seed=SEED, settings=settings, rival=rival, processes=PROCESSES).contradictions
