"""The implementation of a campaign against ourselves finds out what it compares."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from scenic_ref.api import Scenario
from scenic_ref.conformance import Ourselves
from scenic_ref.conformance.implementations.protocol import Task
from scenic_ref.inference.batch import block_rejection
from scenic_ref.inference.enumeration import Enumeration
from scenic_ref.inference.simulation_rejection import SampledRun

from .other_backends import Differs, OtherBackends

SCENES = Task("x = Discrete({1: 3, 2: 1})\nego = Object at (x, 0)\n", "paper")
TAKING = Task("behavior B():\n    while True:\n        take Uniform(1, 2, 3)\nego = Object with behavior B\n", "paper")


@pytest.fixture(autouse=True)
def _compiled_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_rejection, "COMPILE_LEAST", block_rejection.COMPILE_LEAST)


def drawn(count: int) -> list[object]:
    return list(OtherBackends().scenes(SCENES, count, seed=3, attempts=100))


def simulated() -> list[object]:
    return list(OtherBackends().simulations(TAKING, 5, 3, seed=1, attempts=100))


def test_it_gives_what_the_machine_gives() -> None:
    assert drawn(20) == list(Ourselves().scenes(SCENES, 20, seed=3, attempts=100))
    assert simulated() == list(Ourselves().simulations(TAKING, 5, 3, seed=1, attempts=100))


def test_other_scenes_are_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    sample = Scenario.sample
    monkeypatch.setattr(Scenario, "sample", lambda self, seed, index, **given: sample(self, seed + 1, index, **given))
    assert len(drawn(1)) == 1
    with pytest.raises(Differs, match="of seed 3 is another one than the machine's"):
        drawn(20)


def test_another_law_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    enumerate_ = Scenario.enumerate

    def turned(self: Scenario, **given: Any) -> Enumeration:
        law = enumerate_(self, **given)
        first, second = law.outcomes
        return replace(law, outcomes=(first._replace(probability=second.probability), second._replace(probability=first.probability)))

    monkeypatch.setattr(Scenario, "enumerate", turned)
    with pytest.raises(Differs, match="not distributed as enumeration says: "):
        drawn(20)


def test_other_simulations_are_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    simulate = Scenario.simulate

    def changed(self: Scenario, simulator: Any, steps: int, seed: int, index: int, **given: Any) -> SampledRun:
        return simulate(self, simulator, steps, seed + ("backend" not in given), index, **given)

    monkeypatch.setattr(Scenario, "simulate", changed)
    with pytest.raises(Differs, match="of seed 1 is another one than the machine's"):
        simulated()
