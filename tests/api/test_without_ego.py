"""Programs whose ego a scenario of the compose block makes: they have simulations, but no scenes, which is told in one way."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import NoEgo

PROGRAM = """
scenario Sub():
    setup:
        ego = Object at (0, 0)
scenario Main():
    compose:
        do Sub() for 2 steps
"""
WHY = "the scene has no ego: only a scenario that the compose block runs would make it"


def test_why_there_is_no_graph_is_told_and_not_raised() -> None:
    scenario = scenic_ref.loads(PROGRAM)
    assert (scenario.not_lifted, scenario.batch, scenario.impossible) == (WHY, None, None)
    assert {finding.reason for finding in scenario.pruning.findings} == {WHY}
    assert scenario.pruned().not_lifted == WHY


def test_there_are_simulations() -> None:
    scenario = scenic_ref.loads(PROGRAM)
    assert scenario.not_lifted == WHY
    assert scenario.simulate(steps=5).simulation is not None
    assert scenario.enumerate_simulations(steps=5).acceptance == 1


@pytest.mark.parametrize("backend", ["importance", "smc", "mcmc"])
def test_there_are_no_scenes_by_any_backend(backend: str) -> None:
    with pytest.raises(NoEgo):
        scenic_ref.loads(PROGRAM).infer(backend, 10)
    for drawn in ("auto", "batch", "interpreter"):
        with pytest.raises(NoEgo):
            list(scenic_ref.loads(PROGRAM).sample_many(20, backend=drawn))  # type: ignore[arg-type]


def test_where_none_is_needed_there_are_scenes() -> None:
    """Reading `no-ego`."""
    scenario = scenic_ref.loads(PROGRAM, readings={"no-ego": "allowed"})
    assert scenario.sample().ego_id is None
