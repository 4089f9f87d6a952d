"""Chains with companions at levels of more violation: their exchanges keep the law of each level, and lead chains from one island to another."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scenic_ref
from scenic_ref.inference import mcmc
from scenic_ref.inference.comparison.exact_laws import Continuous, contradicts
from scenic_ref.inference.mcmc import Chains, tempered_chains
from scenic_ref.inference.moves.proposals import Moves
from scenic_ref.inference.moves.states import States
from scenic_ref.inference.moves.target import Target
from scenic_ref.inference.smc import run_splitting

HALVED = "x = Range(0, 1)\nego = Object at x @ 0\nrequire x < 0.5\n"
LEVELS = (10.0, 0.25, 0.0)
"""Of x - 0.5: x is below 1, 0.75 and 0.5."""
BOUNDS = (1.0, 0.75, 0.5)
ISLANDS = """
ego = Object at Range(0, 1) @ Range(0, 1), with requireVisible False
x, y = ego.position.x, ego.position.y
require (0.3 < x and x < 0.31 and 0.3 < y and y < 0.31) or (0.7 < x and x < 0.72 and 0.7 < y and y < 0.72)
"""
"""Two squares, of which the second has four fifths of the area; to find it from the first takes a move of one in many thousands."""


def random(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.Philox(seed))


def target_of(program: str) -> Target:
    batch = scenic_ref.loads(program).batch
    assert batch is not None
    return Target(batch, 1)


def chains_in_law(count: int) -> Chains:
    """Independent chains, the state at each level from its law."""
    target = target_of(HALVED)
    parts = [target.simulate(count, random(k)) for k in range(3)]
    for part, bound in zip(parts, BOUNDS, strict=True):
        part.uniforms[0] *= bound
    states = States.joined(parts)
    chains = Chains(target, Moves(target.blocks()), states, LEVELS)
    chains.violations = target.assess(states, math.inf).violation
    return chains


def laws_are_kept(chains: Chains) -> bool:
    values = chains.states.uniforms[0].reshape(3, -1)
    return not any(
        contradicts(v.tolist(), Continuous("x", lambda x, b=b: min(max(x, 0.0), b) / b, 0.0, 1.0), 1e-6) for v, b in zip(values, BOUNDS, strict=True)
    )


def test_exchanges_and_moves_keep_the_law_of_each_level() -> None:
    chains = chains_in_law(4_000)
    before = chains.states.uniforms.copy()
    chains.exchange()
    changed = (chains.states.uniforms != before).reshape(3, -1).mean(axis=1)
    assert changed[0] == changed[1] == pytest.approx(0.75, abs=0.03) and changed[2] == 0
    chains.exchange()
    for _ in range(6):
        chains.advance(2, random(9))
    assert (chains.violations <= chains.allowed).all()
    assert laws_are_kept(chains)


def test_exchanges_that_only_bring_better_states_down_are_found_out() -> None:
    chains = chains_in_law(4_000)
    for _ in range(4):
        order = np.arange(len(chains.violations))
        for rung in (0, 1):
            high = np.arange(rung * 4_000, (rung + 1) * 4_000)
            high = high[(chains.violations[high] <= LEVELS[rung + 1]) & (chains.states.uniforms[0, high] < chains.states.uniforms[0, high + 4_000])]
            order[high], order[high + 4_000] = order[high + 4_000], order[high]
        chains.states, chains.violations = chains.states.at(order), chains.violations[order]
    assert not laws_are_kept(chains)


def test_levels_are_those_of_splitting_and_all_states_are_allowed_at_theirs() -> None:
    target = target_of(ISLANDS)
    found, moves = run_splitting(target, 2, 200, random(1))
    chains = tempered_chains(target, moves, found, random(2))
    assert chains.levels.tolist()[1:] == [level.violation for level in found[0].levels[1:]]
    assert chains.count >= mcmc.FEWEST_TEMPERED
    assert math.isfinite(chains.levels[0])
    chains.advance(3, random(3))
    assert (target.assess(chains.states, math.inf).violation <= chains.allowed).all()
    assert (target.assess(chains.accepted, math.inf).violation == 0).all()


def test_chains_on_two_islands_are_tempered_until_they_agree() -> None:
    found = scenic_ref.loads(ISLANDS).infer("mcmc", 400, 3)
    assert any("tempered" in note for note in found.notes)
    assert not found.doubts
    assert found.draws is not None
    share = float(np.mean(found.draws[found.names.index("objects[0].position[0]")] > 0.5))
    bound = 4.9 * math.sqrt(0.16 / found.diagnosis.bulk)  # 1e-6
    assert abs(share - 0.8) < bound < abs(share - 0.5)  # the rival: islands that count alike
    crossing = np.abs(np.diff(found.draws[0] > 0.5, axis=1).astype(int)).sum(axis=1)
    assert (crossing > 0).mean() > 0.9


def test_without_tempering_the_same_chains_do_not_agree_and_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mcmc, "STUCK_RHAT", math.inf)
    monkeypatch.setattr(mcmc, "SLOW", math.inf)
    batch = scenic_ref.loads(ISLANDS).batch
    assert batch is not None
    found = mcmc.draw_mcmc(batch, 400, 3, most_runs=1_000_000)
    assert found.doubts and not any("tempered" in note for note in found.notes)
