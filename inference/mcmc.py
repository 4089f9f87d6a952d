"""Markov chains on the states of accepted runs: many chains at a time, begun at states that splitting found.

Each chain makes symmetric moves (`sites.moves`) and takes those whose runs are accepted, so that the uniform distribution on the states of
accepted runs, and with it that of the scenes, stays as it is. Draws are made until they are worth as many independent ones as there are to be
scenes. Chains that do not come to agree are tempered: each gets companions at the levels of violation that splitting went through, and neighbours
exchange their states where both stay within their levels (parallel tempering, Geyer 1991), so that a chain can leave where it is by being allowed
more violation for a while.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np

from ..interpreter.runtime.random_streams import fold
from .batch import Batch
from .chain_diagnostics import Diagnosis, diagnose
from .moves.proposals import Moves, MovesMade
from .moves.states import States
from .moves.target import Target
from .result import LARGEST_RHAT, Inferred
from .smc import Population, level_reports, move, probability, run_splitting, some, worst_feature

POPULATIONS, PARTICLES = 8, 128
"""Independent populations in which chains begin, and their sizes."""
CHAINS = 256
FEWEST_TEMPERED, MOST_RUNGS = 16, 24
"""Tempered chains, and the levels of each."""
FEWEST_DRAWS = 100
"""Of each chain, of which the first half is not used."""
FEWEST_KEPT, MOST_STATES = 400, 2_000_000
"""Beyond as many draws as hold four states for each that is wanted (these are the least and the most), every other draw is dropped, and draws are
made half as often."""
STUCK_RHAT, SLOW = 1.2, 4
"""Chains with a larger R-hat after so many draws are tempered; after more than SLOW times as many moves, those that do not agree."""
MOST_RUNS = 20_000_000
FEWEST_EFFECTIVE = 400.0

OnDraw = Callable[[float], None]
"""Is told how much of the work is done, as far as that is known."""


class Chains:
    """Chains at one level or more, which fall to 0: row `k` of the states is at level `k // count` of chain `k % count`."""

    def __init__(self, target: Target, moves: Moves, states: States, levels: Sequence[float]) -> None:
        self.target, self.moves, self.levels = target, moves, np.array(levels)
        self.count = len(states) // len(levels)
        self.states, self.violations = states, np.zeros(len(states))
        self.allowed = np.repeat(self.levels, self.count)
        self.first = 0

    def advance(self, passes: int, random: np.random.Generator) -> MovesMade:
        """Move each state, each block `passes` times on average; after each pass neighbours exchange. Which moves were taken."""
        if len(self.levels) == 1:
            self.states, self.violations, taken = move(self.target, self.moves, self.states, self.violations, self.allowed, passes, random)
            return taken
        taken = MovesMade(len(self.moves))
        for _ in range(passes):
            self.states, self.violations, taken = move(self.target, self.moves, self.states, self.violations, self.allowed, 1, random)
            self.exchange()
        return taken

    def exchange(self) -> None:
        """Exchange the states of neighbours, every other pair of levels at a time, where the one from the higher level is allowed at the lower."""
        order = np.arange(len(self.violations))
        for rung in range(self.first, len(self.levels) - 1, 2):
            high = np.arange(rung * self.count, (rung + 1) * self.count)
            high = high[self.violations[high] <= self.levels[rung + 1]]
            order[high], order[high + self.count] = order[high + self.count], order[high]
        self.states, self.violations = self.states.at(order), self.violations[order]
        self.first = 1 - self.first

    @property
    def accepted(self) -> States:
        """The states whose runs are accepted, of one chain after the other."""
        return self.states.at(np.arange(len(self.violations) - self.count, len(self.violations)))


def tempered_chains(target: Target, moves: Moves, populations: Sequence[Population], random: np.random.Generator) -> Chains:
    """Chains with companions at the levels that splitting went through, all begun at states of accepted runs."""
    largest = float(np.finfo(float).max)
    levels = sorted({min(level.violation, largest) for p in populations for level in p.levels}, reverse=True)
    every = -(-len(levels) // MOST_RUNGS)
    levels = [*levels[:-1:every], 0.0]
    states = States.joined([p.states for p in populations])
    count = max(FEWEST_TEMPERED, CHAINS // len(levels))
    return Chains(target, moves, states.at(random.integers(len(states), size=count * len(levels))), levels)


def draw_mcmc(batch: Batch, n: int, seed: int, *, share: float = 1.0, on_draw: OnDraw | None = None, most_runs: int = MOST_RUNS) -> Inferred:
    """`n` scenes from the second halves of chains that go on until these are worth `n` independent scenes, or until `most_runs` were looked at.

    `share` is as in `smc.draw_smc`. Raises `AttemptsExhausted` where no scene is found, `UsageError`, and the program's errors.
    """
    begun = time.process_time()
    target = Target(batch, seed)
    random = np.random.Generator(np.random.Philox(np.random.SeedSequence(fold(seed))))
    target.measure(random)
    target.expect(2 * FEWEST_DRAWS * len(target.blocks()), CHAINS)
    found, moves = run_splitting(target, POPULATIONS, PARTICLES, random)
    living = [p.states for p in found if len(p.states)]
    chains = Chains(target, moves, States.joined([s.at(np.resize(np.arange(len(s)), -(-CHAINS // len(living)))) for s in living]), [0.0])
    wanted = max(float(n), FEWEST_EFFECTIVE)
    draws: list[States] = []
    features: list[np.ndarray] = []
    notes: list[str] = []
    taken = MovesMade(len(moves))
    thinning, diagnosis = 1, Diagnosis(math.inf, 0.0, 0.0, 0)
    while not draws or target.evaluations < most_runs:
        taken, more = MovesMade(len(moves)), max(FEWEST_DRAWS, len(draws) // 4)
        for _ in range(more):
            taken = chains.advance(thinning, random)
            draws.append(chains.accepted)
        new = target.features(States.joined(draws[-more:]))
        features.extend(np.split(new, more, axis=1))
        if len(draws) == FEWEST_DRAWS and len(chains.levels) == 1:  # before any of the draws that count
            moves.adapt(taken)
        diagnosis = diagnose(np.stack(features[len(draws) // 2 :], axis=2))
        if on_draw is not None:
            on_draw(min(diagnosis.bulk / wanted, (LARGEST_RHAT - 1) / max(diagnosis.rhat - 1, 1e-9), 1.0))
        enough = len(draws) // 2 * chains.count >= n
        if enough and diagnosis.bulk >= wanted and diagnosis.tail >= wanted / 2 and diagnosis.rhat <= LARGEST_RHAT:
            break
        if len(draws) >= min(max(FEWEST_KEPT, 8 * wanted / chains.count), MOST_STATES / chains.count):
            draws, features, thinning = draws[1::2], features[1::2], 2 * thinning
            if len(chains.levels) == 1 < max(len(p.levels) for p in found) and diagnosis.rhat > (STUCK_RHAT if thinning <= SLOW else LARGEST_RHAT):
                chains, draws, features, thinning = tempered_chains(target, moves, found, random), [], [], 1
                notes.append(f"{chains.count} chains were tempered over {len(chains.levels)} levels, since plain ones did not agree")
    kept = States.joined(draws[len(draws) // 2 :])
    chosen = kept.at(some(len(kept), n, random))
    worth = min(diagnosis.bulk, len(kept))
    if worth < n:
        notes.append(f"the {n:,} scenes are worth {worth:.0f} independent ones")
    return Inferred(
        "mcmc", list(target.scenes(chosen, seed)), probability(found, share), target.evaluations, diagnosis, worst_feature(target, diagnosis),
        time.process_time() - begun, (*notes, *target.notes), target.names, np.stack(features[len(draws) // 2 :], axis=2),
        levels=level_reports(found), moves=taken.parts(),
    )
