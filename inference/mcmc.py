"""Markov chains on the states of accepted runs: many chains at a time, begun at states that splitting found.

Each chain makes symmetric moves (`sites.moves`) and takes those whose runs are accepted, so that the uniform distribution on the states of
accepted runs, and with it that of the scenes, stays as it is. Draws are made until they are worth as many independent ones as there are to be
scenes.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from ..interpreter.streams import fold
from .batch import Batch
from .diagnostics import Diagnosis, diagnose
from .inferred import LARGEST_RHAT, Inferred
from .sites.states import States
from .sites.target import Target
from .smc import move, moves_of, probability, some, split

POPULATIONS, CHAINS = 4, 64
"""Independent populations in which chains begin, and the chains of each."""
PASSES = 6
"""How often each block is moved, on average, at the levels of splitting; chains then move on until they agree."""
FEWEST_DRAWS = 100
"""Of each chain, of which the first half is not used."""
MOST_DRAWS = 400
"""Beyond, every other draw is dropped, and draws are made half as often."""
MOST_RUNS = 20_000_000
FEWEST_EFFECTIVE = 400.0

OnDraw = Callable[[float], None]
"""Is told how much of the work is done, as far as that is known."""


def draw_mcmc(batch: Batch, n: int, seed: int, *, share: float = 1.0, on_draw: OnDraw | None = None, most_runs: int = MOST_RUNS) -> Inferred:
    """`n` scenes from the second halves of chains that go on until these are worth `n` independent scenes, or until `most_runs` were looked at.

    `share` is as in `smc.draw_smc`. Raises `AttemptsExhausted` where no scene is found, `UsageError`, and the program's errors.
    """
    begun = time.process_time()
    target = Target(batch, seed)
    random = np.random.Generator(np.random.Philox(np.random.SeedSequence(fold(seed))))
    target.measure(random)
    target.expect(2 * FEWEST_DRAWS * len(target.blocks()), POPULATIONS * CHAINS)
    found = split(target, POPULATIONS, CHAINS, random, passes=PASSES)
    states, moves = States.joined([p.states for p in found]), moves_of(target)
    zeros = np.zeros(len(states))
    wanted = max(float(n), FEWEST_EFFECTIVE)
    draws: list[States] = []
    features: list[np.ndarray] = []
    thinning, diagnosis = 1, Diagnosis(math.inf, 0.0, 0.0, 0)
    while target.evaluations < most_runs:
        taken: dict[str, float] = {}
        for _ in range(FEWEST_DRAWS):
            states, _, taken = move(target, moves, states, zeros, zeros, thinning, random)
            draws.append(states)
            features.append(target.features(states))
        if thinning == 1:
            moves.adapt(taken.get("step"))
        diagnosis = diagnose(np.stack(features[len(draws) // 2 :], axis=2))
        if on_draw is not None:
            on_draw(min(diagnosis.bulk / wanted, (LARGEST_RHAT - 1) / max(diagnosis.rhat - 1, 1e-9), 1.0))
        if diagnosis.bulk >= wanted and diagnosis.tail >= wanted / 2 and diagnosis.rhat <= LARGEST_RHAT:
            break
        if len(draws) >= MOST_DRAWS:
            draws, features, thinning = draws[1::2], features[1::2], 2 * thinning
    kept = States.joined(draws[len(draws) // 2 :])
    chosen = kept.at(some(len(kept), n, random))
    notes = () if diagnosis.bulk >= n else (f"the {n:,} scenes are worth {diagnosis.bulk:.0f} independent ones",)
    return Inferred(
        "mcmc", list(target.scenes(chosen, seed)), probability(found, share), target.evaluations, diagnosis, target.feature_name(diagnosis.worst),
        time.process_time() - begun, notes,
    )
