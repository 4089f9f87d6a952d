"""Sequential Monte Carlo by multilevel splitting: states that are allowed ever less violation, until all runs are accepted (Cérou, Del Moral,
Furon, Guyader 2012; how far they violate requirements is in `batch.evaluate.margins`).

Of the states at a level the best part is kept, copied, and moved by a kernel that leaves the distribution at the new level as it is. The product
of the parts that were kept estimates the probability that a run is accepted. Independent repetitions tell how much to trust it.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from ..interpreter.runtime.random_streams import fold
from ..semantics.machine.outcome import Requirement
from ..semantics.store.errors import AttemptsExhausted, UsageError
from .batch import Batch
from .chain_diagnostics import Diagnosis, diagnose_repetitions
from .moves.proposals import Moves, MovesMade
from .moves.states import CHUNK, States
from .moves.target import SCALED_BY, Target
from .rejection import no_scene_error
from .result import LEVEL, Inferred, Probability

KEPT = 0.3
"""The part of the states that is kept at each level, where violations differ: about that, since the levels are those of another population."""
REPETITIONS = 8
"""Independent populations."""
FEWEST_PARTICLES = 300
PASSES = 12
"""How often each block is moved at a level, on average."""
FEWEST_KEPT = 0.03
"""If a level would leave a population a smaller part of its states, there is one between."""
STALLED = 8
"""So many levels in a row at which nothing gets better: no scene is to be found."""
FEWEST_AHEAD, ENOUGH_LEFT, MOST_PARTICLES = 1024, 10, 5_000
"""Of the population that goes first; how many states are to be left at each level, by what it found; for which a population gets so many at most."""
MOST_BETWEEN = 1000
"""Levels between those that were planned."""
FEWEST_WITH_VALUES = 1e-5
"""If fewer runs than this have values for all that they compute (no empty region, no point outside a field), no scene is to be found."""


class Level(NamedTuple):
    """A level of violation, the part of the states that met it, and by kind of move the part that was taken there, by all repetitions."""

    violation: float
    kept: float
    taken: dict[str, float]


class Planned(NamedTuple):
    """A level to come, for each block the shortest steps there, and the part of its states that the population that went first kept."""

    violation: float
    smallest: np.ndarray
    kept: float


OnLevel = Callable[[float, float], None]
"""Is told which part of the states is accepted by now, and the level."""


class Population(NamedTuple):
    """States whose runs are accepted, equally likely, and the levels on the way to them; no states where none was left at the last of these.

    The first, of any violation, is met by the runs that have values for all that they compute.
    """

    states: States
    levels: tuple[Level, ...]

    @property
    def log_probability(self) -> float:
        """The logarithm of the estimated probability that a run is accepted."""
        return sum(math.log(level.kept) for level in self.levels) if len(self.states) else -math.inf


def run_splitting(
    target: Target, repetitions: int, count: int, random: np.random.Generator, *, passes: int = PASSES, on_level: OnLevel | None = None
) -> tuple[list[Population], Moves]:
    """Independent populations of `count` states of accepted runs each, or of more, all moved at the same time; and the moves, with steps as long as
    they became.

    One more population goes first, and says which levels there are, how long steps are, and how many states it takes that some are left at each
    level: levels that a population chose for itself would make its estimate too large. A population may lose all its states: its estimate is 0.
    Raises `AttemptsExhausted` where no states can be found, with the requirement that stays violated.
    """
    moves = moves_of(target)
    planned = explore(target, moves, max(count, FEWEST_AHEAD), random, passes)
    enough = math.ceil(ENOUGH_LEFT / min(p.kept for p in planned))
    found = descend(target, moves, repetitions, max(count, min(enough, MOST_PARTICLES)), random, passes, planned, on_level)
    if not any(p.log_probability > -math.inf for p in found):
        raise infeasible(target, target.simulate(SCALED_BY, random))
    return found, moves


def explore(target: Target, moves: Moves, count: int, random: np.random.Generator, passes: int) -> list[Planned]:
    """The levels on the way of one population, which chooses them as it goes."""
    states, violations, _ = begin(target, 1, count, random)
    planned: list[Planned] = []
    stalled = 0
    while violations.any():
        limit = next_level(violations)
        kept = float((violations <= limit).mean())
        stalled = stalled + 1 if kept == 1 else 0
        if stalled == STALLED:
            raise infeasible(target, states)
        order = np.resize(random.permutation(np.flatnonzero(violations <= limit)), count)
        states, violations, taken = move(target, moves, states.at(order), violations[order], np.full(count, limit), passes, random)
        moves.adapt(taken)
        if kept < 1:
            planned.append(Planned(limit, moves.smallest.copy(), kept))
    return [*planned, Planned(0.0, moves.smallest, 1.0)]


def descend(
    target: Target, moves: Moves, repetitions: int, count: int, random: np.random.Generator, passes: int, coming: Sequence[Planned],
    on_level: OnLevel | None = None,
) -> list[Population]:  # fmt: skip
    """Populations at the levels that come; where one would lose nearly all of its states, there is one between, if that helps."""
    states, violations, levels = begin(target, repetitions, count, random)
    living = list(range(repetitions))
    between = 0
    while violations.any():
        of_each = violations.reshape(len(living), count)
        limit = coming[0].violation
        few = of_each[(of_each <= limit).mean(axis=1) < FEWEST_KEPT]
        higher = max((next_level(own) for own in few if next_level(own) < own.max()), default=limit)
        if higher > limit and between < MOST_BETWEEN:
            limit, between = higher, between + 1
        else:
            moves.smallest = coming[0].smallest
            coming = coming[1:] or coming  # the last is 0
        kept = (of_each <= limit).mean(axis=1)
        rows = [k * count + np.resize(random.permutation(np.flatnonzero(v <= limit)), count) for k, v in enumerate(of_each) if kept[k] > 0]
        taken = MovesMade(len(moves))
        if rows:
            order = np.concatenate(rows)
            states, violations, taken = move(target, moves, states.at(order), violations[order], np.full(len(order), limit), passes, random)
        for number, part in zip(living, kept.tolist(), strict=True):
            levels[number].append(Level(limit, part, taken.parts()))
        living = [number for number, part in zip(living, kept.tolist(), strict=True) if part > 0]
        if not living:
            break
        if on_level is not None:
            on_level(float(np.mean(violations == 0)), limit)
    places = {number: np.arange(k * count, (k + 1) * count) for k, number in enumerate(living)}
    nothing = np.zeros(0, dtype=np.int64)
    return [Population(states.at(places.get(number, nothing)), tuple(own)) for number, own in enumerate(levels)]


def guess(batch: Batch, seed: int = 0) -> float | None:
    """About the probability that a run is accepted, by one population in few moves, in seconds; None where no accepted run is found."""
    target = Target(batch, seed)
    target.may_compile = False
    random = np.random.Generator(np.random.Philox(np.random.SeedSequence(fold(seed))))
    try:
        _, _, levels = begin(target, 1, FEWEST_AHEAD, random)
        return levels[0][0].kept * math.prod(p.kept for p in explore(target, moves_of(target), FEWEST_AHEAD, random, 4))
    except (AttemptsExhausted, UsageError):
        return None


def moves_of(target: Target) -> Moves:
    """The moves on the states of a target."""
    return Moves(target.blocks())


def begin(target: Target, repetitions: int, count: int, random: np.random.Generator) -> tuple[States, np.ndarray, list[list[Level]]]:
    """States whose runs have values for all that they compute, their violations, and for each repetition its first level."""
    if not target.scales:
        target.measure(random)
    made: list[States] = []
    of_all: list[np.ndarray] = []
    levels: list[list[Level]] = []
    for _ in range(repetitions):
        parts: list[States] = []
        found: list[np.ndarray] = []
        flags: list[np.ndarray] = []
        drawn = alive = 0
        while alive < count:
            states = target.simulate(count, random)
            violations = target.assess(states, np.inf).violation
            fine = np.isfinite(violations)
            parts.append(states.at(fine))
            found.append(violations[fine])
            flags.append(fine)
            drawn, alive = drawn + count, alive + int(fine.sum())
            if alive < FEWEST_WITH_VALUES * drawn and drawn > 1 / FEWEST_WITH_VALUES:
                raise infeasible(target, states)
        made.append(States.joined(parts).at(np.arange(count)))
        of_all.append(np.concatenate(found)[:count])
        last = int(np.flatnonzero(np.concatenate(flags))[count - 1])  # runs are drawn until so many have values: without bias, so is their part
        levels.append([Level(math.inf, 1.0 if last == count - 1 else (count - 1) / last, {})])
    return States.joined(made), np.concatenate(of_all), levels


def next_level(violations: np.ndarray) -> float:
    """The level that the best part of the states meets; where too many are alike, the best value but the worst, if there is one."""
    level = float(np.quantile(violations, KEPT, method="inverted_cdf"))
    worst = float(violations.max())
    return level if level < worst else float(violations[violations < worst].max(initial=0.0)) if (violations < worst).any() else worst


def move(
    target: Target, moves: Moves, states: States, violations: np.ndarray, levels: np.ndarray, passes: int, random: np.random.Generator
) -> tuple[States, np.ndarray, MovesMade]:
    """The states after `passes` moves of each block, on average, none of which leaves its level; which moves were taken."""
    taken = MovesMade(len(moves))
    parts: list[States] = []
    found: list[np.ndarray] = []
    for first in range(0, len(states), CHUNK):
        rows = np.arange(first, min(first + CHUNK, len(states)))
        part, own, known = states.at(rows), violations[rows], target.remember()
        for _ in range(passes * max(len(moves), 1)):
            proposed, kinds, blocks = moves.propose(part, random)
            part, own, accepted = target.update(part, own, proposed, levels[rows], known)
            taken.add(kinds, blocks, accepted)
        parts.append(part)
        found.append(own)
    return States.joined(parts), np.concatenate(found), taken


def infeasible(target: Target, states: States) -> AttemptsExhausted:
    """The error where no scene is to be found: no proof that there is none."""
    stuck: Counter[Requirement] = Counter()
    target.assess(states, 0.0, stuck)
    if not stuck:  # only the interpreter knows
        stuck[target.rejected_by(states, 0)] += 1
    worst, count = stuck.most_common(1)[0]
    text = f"no scene can be found, as far as can be seen: of the best {len(states):,} runs, {count:,} fail here: {worst.text}"
    return no_scene_error(text, target.evaluations, stuck)


def probability(populations: Sequence[Population], share: float, level: float = LEVEL) -> Probability:
    """From independent populations, by Student's t on the logarithms of their estimates, or on the estimates if some are 0; `share` is as in
    `draw_smc`.

    The spread is at least that which each level would have if its states were independent: few populations may agree by chance.
    """
    logs, count = np.array([p.log_probability for p in populations]), len(populations)
    largest = logs.max()
    relative = np.exp(logs - largest)
    estimate = share * float(np.exp(largest) * relative.mean())
    factor = float(stdtrit(count - 1, (1 + level) / 2)) / math.sqrt(count)
    if not relative.all():
        half = share * float(np.exp(largest) * relative.std(ddof=1)) * factor
        return Probability(estimate, max(estimate - half, 0.0), min(estimate + half, 1.0), level)
    least = [sum(1 / smooth_fraction(level.kept, len(p.states)) - 1 for level in p.levels) / len(p.states) for p in populations]
    half = math.sqrt(max(logs.var(ddof=1), float(np.mean(least)))) * factor
    return Probability(estimate, estimate * math.exp(-half), min(estimate * math.exp(half), 1.0), level)


def smooth_fraction(part: float, count: int) -> float:
    """A part of `count` states, as if one more had been found and one more not."""
    return (part * count + 1) / (count + 2)


def draw_smc(
    batch: Batch, n: int, seed: int, *, share: float = 1.0, particles: int = 0, on_level: OnLevel | None = None
) -> Inferred:
    """`n` scenes from independent populations of `particles` states (enough for `n`, if 0), in proportion to their probabilities.

    `share` is the probability that a run is one of those that the batch draws, where it draws from smaller regions. Raises
    `AttemptsExhausted` where no scene is found, `UsageError`, and the program's errors.
    """
    begun = time.process_time()
    target = Target(batch, seed)
    particles = particles or max(FEWEST_PARTICLES, math.ceil(2 * n / REPETITIONS))
    random = np.random.Generator(np.random.Philox(np.random.SeedSequence(fold(seed))))
    levels = math.log(max(target.measure(random), 1 / SCALED_BY)) / math.log(KEPT)
    target.expect(math.ceil(levels) * PASSES * len(target.blocks()), REPETITIONS * particles)
    every, _ = run_splitting(target, REPETITIONS, particles, random, on_level=on_level)
    found = [p for p in every if len(p.states)]
    particles = len(found[0].states)
    features = target.features(States.joined([p.states for p in found])).reshape(-1, len(found), particles)
    logs = np.array([p.log_probability for p in found])
    weights = np.exp(logs - logs.max())
    chosen = States.joined([p.states.at(some(particles, k, random)) for p, k in zip(found, systematic_counts(weights, n, random), strict=True)])
    scenes = list(target.scenes(chosen.at(random.permutation(len(chosen))), seed))
    diagnosis = diagnose_repetitions(features)
    return Inferred(
        "smc", scenes, probability(every, share), target.evaluations, diagnosis, worst_feature(target, diagnosis), time.process_time() - begun,
        target.notes, target.names, features, levels=level_reports(every),
    )


def level_reports(populations: Sequence[Population]) -> tuple[dict[str, object], ...]:
    """The levels of populations, for a report: what all of them together kept."""
    longest = max((p.levels for p in populations), key=len)
    kept = [[p.levels[k].kept for p in populations if k < len(p.levels)] for k in range(len(longest))]
    return tuple(
        {"violation": level.violation if math.isfinite(level.violation) else None, "kept": float(np.mean(own)), "taken": level.taken}
        for level, own in zip(longest, kept, strict=True)
    )


def worst_feature(target: Target, diagnosis: Diagnosis) -> str:
    """The feature about which the parts of the work agree least, if there are any features."""
    return target.names[diagnosis.worst] if target.names else ""


def some(count: int, n: int, random: np.random.Generator) -> np.ndarray:
    """`n` of `count` rows, each as often as the others, but for one."""
    return np.concatenate([random.permutation(count) for _ in range(-(-n // count))] or [np.zeros(0, dtype=np.int64)])[:n]


def systematic_counts(weights: np.ndarray, n: int, random: np.random.Generator) -> list[int]:
    """How many of `n` fall to each, in proportion to the weights: systematic resampling."""
    edges, points = np.cumsum(weights) / weights.sum() * n, np.arange(n) + random.random()
    return np.bincount(np.minimum(np.searchsorted(edges, points, side="right"), len(edges) - 1), minlength=len(edges)).tolist()
