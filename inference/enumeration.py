"""Enumeration: the exact distribution of a program whose draws have finitely many values (DESIGN, section 1).

Every draw is answered with each of its values in turn, and the weight of a run is the product of the values' exact probabilities.
Runs that get stuck are dropped, and the rest is divided by what remains: the distribution of the paper's rejection sampling,
as Fractions. Configurations are never forked: each run begins anew, with the choices of the one before as its prefix.
"""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import count
from typing import NamedTuple

from ..data.scene import Scene, scene_of
from ..data.simulation import Simulated, to_json
from ..interpreter.runtime.program_run import DEFAULT_FUEL, Accepted, Beginnings, generate_scene
from ..pictures.notebook_views import count_phrase
from ..semantics.machine.config import Config, State
from ..semantics.machine.outcome import Draw, Requirement
from ..semantics.space.distributions import Distribution, Numbers
from ..semantics.store.errors import AttemptsExhausted, RunsExhausted, UsageError
from ..simulators.loop import Failed, simulate_once
from ..simulators.protocol import Simulator
from .simulation_rejection import no_simulation_error


def quantiles(distribution: Distribution, n: int) -> tuple[object, ...]:
    """`n` values that stand for the distribution, each with probability 1/n."""
    return tuple(distribution.sample(hammersley(i, n)) for i in range(n))


def hammersley(i: int, n: int) -> Numbers:
    """The coordinates of point `i` of `n` of a Hammersley set, one per call, in as many dimensions as are asked for."""
    coordinates = _coordinates(i, n)
    return lambda: next(coordinates)


def _coordinates(i: int, n: int) -> Iterator[float]:
    yield (i + 0.5) / n
    for prime in primes():
        yield radical_inverse(i, prime)


def primes() -> Iterator[int]:
    """2, 3, 5, ..."""
    found: list[int] = []
    for candidate in count(2):
        if all(candidate % prime for prime in found):
            found.append(candidate)
            yield candidate


def radical_inverse(i: int, base: int) -> float:
    """The digits of `i` in `base`, mirrored behind the point: in [0, 1)."""
    result, scale = 0.0, 1.0 / base
    while i:
        i, digit = divmod(i, base)
        result += digit * scale
        scale /= base
    return result


DEFAULT_RUNS = 20_000

Address = tuple[int, ...]


class PossibleScene(NamedTuple):
    """A scene that the program gives, and the exact probability of just this scene."""

    probability: Fraction
    scene: Scene


class Coins(NamedTuple):
    """One result of the coins that are thrown once per scene: how likely it is, and how likely a run is then accepted."""

    probability: Fraction
    acceptance: Fraction


@dataclass(frozen=True)
class Enumeration:
    """The exact distribution of a program.

    `outcomes` are different scenes, the most likely first; their probabilities add up to 1. `acceptance` is the probability that
    a run is accepted, `stuck` that it fails at each requirement. `discretized` is None, or the N of an approximation: then
    continuous draws were replaced by N equally likely values each, and nothing here is exact.
    `coins` has one entry, of probability 1, unless there are coins thrown once per scene (reading `soft=scene`).
    """

    outcomes: tuple[PossibleScene, ...]
    acceptance: Fraction
    stuck: Mapping[Requirement, Fraction]
    coins: tuple[Coins, ...]
    runs: int
    discretized: int | None = None

    def __repr__(self) -> str:
        exact = "exact" if self.discretized is None else f"an approximation by {count_phrase(self.discretized, 'value')} for each continuous draw"
        accepted = f"a run is accepted with probability {float(self.acceptance):.6g}"
        return f"<{count_phrase(len(self.outcomes), 'outcome')}, {exact}, of {count_phrase(self.runs, 'run')}; {accepted}>"

    def law(self, read: Callable[[Scene], Hashable]) -> dict[Hashable, Fraction]:
        """The distribution of `read(scene)`."""
        found: dict[Hashable, Fraction] = defaultdict(Fraction)
        for probability, scene in self.outcomes:
            found[read(scene)] += probability
        return dict(found)

    def attempts_probability(self, attempts: int) -> Fraction:
        """The probability that a scene needs exactly `attempts` runs."""
        feasible = sum((c.probability for c in self.coins if c.acceptance), Fraction(0))
        return sum((c.probability / feasible * c.acceptance * (1 - c.acceptance) ** (attempts - 1) for c in self.coins if c.acceptance), Fraction(0))

    @cached_property
    def scenes(self) -> tuple[Scene, ...]:
        """The scenes of the outcomes."""
        return tuple(outcome.scene for outcome in self.outcomes)

    def to_json(self) -> dict[str, object]:
        """The enumeration as a JSON object; fractions are written as "p/q"."""
        return {
            "schema": "scenic-ref/enumeration/1", "runs": self.runs, "exact": self.discretized is None, "discretized": self.discretized,
            "acceptance": str(self.acceptance),
            "outcomes": [{"probability": str(p), "approximately": float(p), "scene": scene.to_json()} for p, scene in self.outcomes],
        }


class Leaf(NamedTuple):
    """A finished run: the probability of its draws, what its coins thrown once per scene showed, and how it ended."""

    probability: Fraction
    coins: Mapping[Address, tuple[bool, Fraction]]
    scene: Scene | None
    requirement: Requirement | None


class Taken(NamedTuple):
    """Which of how many values a draw was answered with."""

    taken: int
    among: int


def scene_of_run(state: State) -> Scene:
    """The scene of a run that was accepted."""
    return scene_of(state, 0, 0, 1)


def enumerate_runs(
    start: Callable[[], Config], *, max_runs: int = DEFAULT_RUNS, discretize: int | None = None, fuel: int = DEFAULT_FUEL,
    on_run: Callable[[int, Fraction], None] | None = None, read: Callable[[State], Scene] = scene_of_run,
) -> Enumeration:  # fmt: skip
    """The exact distribution of the scenes of the runs that begin with `start()`; `read` gives the scene of a run that was accepted.

    Raises `UsageError` at a draw that is not finite unless `discretize` says by how many values to replace it, `RunsExhausted`
    when there are more than `max_runs` runs, `AttemptsExhausted` if no run is accepted, and the program's errors. `on_run` is told
    how many runs were made and which part of the probability they cover.
    """
    if discretize is not None and discretize < 1:
        raise UsageError("--discretize needs at least 1 value per draw")
    leaves: list[Leaf] = []
    covered = Fraction(0)
    prefix: list[Taken] | None = []
    approximated = False
    begin = Beginnings(start, fuel)
    while prefix is not None:
        if len(leaves) == max_runs:
            raise RunsExhausted(
                f"the program has more than {max_runs:,} runs: those made cover {float(covered):.3g} of the probability",
                runs=max_runs, covered=covered,
                hint="--max-runs allows more; each draw multiplies their number by that of its values",
            )
        runner = Runner(prefix, discretize, read)
        leaf = runner.run(begin(), fuel)
        approximated = approximated or runner.approximated
        leaves.append(leaf)
        covered += leaf.probability * product(share for _, share in leaf.coins.values())
        if on_run is not None:
            on_run(len(leaves), covered)
        prefix = next_prefix(runner.choices)
    return sum_leaves(leaves, discretize if approximated else None)


def product(shares: Iterable[Fraction]) -> Fraction:
    """The product of probabilities."""
    result = Fraction(1)
    for share in shares:
        result *= share
    return result


def next_prefix(choices: list[Taken]) -> list[Taken] | None:
    """The prefix of the next run: the last draw with a value left takes it; None when all are done."""
    for depth in range(len(choices) - 1, -1, -1):
        taken, among = choices[depth]
        if taken + 1 < among:
            return [*choices[:depth], Taken(taken + 1, among)]
    return None


class Runner:
    """One run whose first draws are answered as `prefix` says and the others with their first values; `choices` are all of them."""

    def __init__(self, prefix: list[Taken], discretize: int | None, read: Callable[[State], Scene] = scene_of_run) -> None:
        self.prefix = prefix
        self.discretize = discretize
        self.read = read
        self.choices: list[Taken] = []
        self.probability = Fraction(1)
        self.coins: dict[Address, tuple[bool, Fraction]] = {}
        self.approximated = False

    def run(self, config: Config, fuel: int) -> Leaf:
        """The run to its end. Raises the program's errors, and `UsageError` at a draw that is not finite."""
        result = generate_scene(config, self.choose, fuel=fuel)
        if isinstance(result, Accepted):
            return Leaf(self.probability, self.coins, self.read(result.state), None)
        return Leaf(self.probability, self.coins, None, result.requirement)

    def choose(self, draw: Draw) -> object:
        """The value that this run takes; the values themselves belong to the run, so that only their numbers are kept."""
        support = self.support(draw)
        depth = len(self.choices)
        taken = self.prefix[depth].taken if depth < len(self.prefix) else 0
        self.choices.append(Taken(taken, len(support)))
        value, share = support[taken]
        if draw.per_scene:
            self.coins[draw.address] = (bool(value), share)
        else:
            self.probability *= share
        return value

    def support(self, draw: Draw) -> tuple[tuple[object, Fraction], ...]:
        """The values of a draw with their probabilities. Raises `UsageError` if there are not finitely many."""
        exact = draw.distribution.support()
        if exact is not None:
            return exact
        if self.discretize is None:
            raise UsageError(
                f"{draw.distribution.name} has infinitely many values, and only programs with finite draws can be enumerated", draw.node.span,
                hint="--discretize N replaces each such draw by N equally likely values, which is an approximation",
            )
        self.approximated = True
        return tuple((value, Fraction(1, self.discretize)) for value in quantiles(draw.distribution, self.discretize))


def sum_leaves(leaves: list[Leaf], discretized: int | None) -> Enumeration:
    """The distribution that the runs make up. Raises `AttemptsExhausted` if none was accepted."""
    masses: dict[str, Fraction] = defaultdict(Fraction)
    scenes: dict[str, Scene] = {}
    coins: list[Coins] = []
    stuck: dict[Requirement, Fraction] = defaultdict(Fraction)
    for probability, group in by_coins(leaves):
        acceptance = sum((leaf.probability for leaf in group if leaf.scene is not None), Fraction(0))
        coins.append(Coins(probability, acceptance))
        for leaf in group:
            if leaf.scene is not None:
                key = content_of_scene(leaf.scene)
                scenes.setdefault(key, leaf.scene)
                masses[key] += probability * leaf.probability / acceptance
            elif leaf.requirement is not None:
                stuck[leaf.requirement] += probability * leaf.probability
    if not scenes:
        counts = Counter(leaf.requirement for leaf in leaves)
        worst, _ = counts.most_common(1)[0]
        assert worst is not None
        raise AttemptsExhausted(
            f"no scene is possible: all {len(leaves):,} runs fail, most of them here: {worst.text}", worst.span, attempts=len(leaves),
            stuck=tuple(counts.most_common()),
        )
    feasible = sum(masses.values())
    ranked = sorted(masses, key=lambda key: -masses[key])
    outcomes = tuple(
        PossibleScene(masses[key] / feasible, as_numbered_outcome(scenes[key], i, masses[key] / feasible)) for i, key in enumerate(ranked)
    )
    total = sum((c.probability * c.acceptance for c in coins), Fraction(0))
    return Enumeration(outcomes, total, dict(stuck), tuple(coins), len(leaves), discretized)


def by_coins(leaves: list[Leaf], known: frozenset[Address] = frozenset()) -> Iterator[tuple[Fraction, list[Leaf]]]:
    """The runs that are possible together, for each way in which the coins thrown once per scene can come up, with its probability.

    All attempts at a scene see the same coins, so each way has a rejection loop, and a normalisation, of its own.
    """
    coin = next((address for leaf in leaves for address in leaf.coins if address not in known), None)
    if coin is None:
        yield Fraction(1), leaves
        return
    sides = {leaf.coins[coin] for leaf in leaves if coin in leaf.coins}
    for shown, share in sorted(sides, reverse=True):
        agreeing = [leaf for leaf in leaves if coin not in leaf.coins or leaf.coins[coin][0] == shown]
        for probability, group in by_coins(agreeing, known | {coin}):
            yield share * probability, group


def content_of_scene(scene: Scene) -> str:
    """Return the content of a scene without its number: scenes with equal content are one outcome."""
    found = scene.to_json()
    return json.dumps([found["params"], found["ego"], found["objects"]], allow_nan=False)


def as_numbered_outcome(scene: Scene, index: int, probability: Fraction) -> Scene:
    """The scene as outcome number `index`, weighing its probability."""
    return replace(scene, index=index, weight=float(probability))


class History(NamedTuple):
    """A simulation, and the exact probability of just this one: its scene, its actions, its end."""

    probability: Fraction
    simulation: Simulated


@dataclass(frozen=True)
class Histories:
    """The exact distribution of the simulations of a program, the most likely first; their probabilities add up to 1.

    `acceptance` is the probability that a run is accepted, `stuck` that it fails at each requirement in each time step.
    """

    outcomes: tuple[History, ...]
    acceptance: Fraction
    stuck: Mapping[Failed, Fraction]
    runs: int

    def __repr__(self) -> str:
        accepted = f"a run is accepted with probability {float(self.acceptance):.6g}"
        return f"<{count_phrase(len(self.outcomes), 'simulation')}, exact, of {count_phrase(self.runs, 'run')}; {accepted}>"

    def law(self, read: Callable[[Simulated], Hashable]) -> dict[Hashable, Fraction]:
        """The distribution of `read(simulation)`."""
        found: dict[Hashable, Fraction] = defaultdict(Fraction)
        for probability, simulation in self.outcomes:
            found[read(simulation)] += probability
        return dict(found)


def enumerate_simulations(
    start: Callable[[], Config], simulator: Simulator, steps: int, *, max_runs: int = DEFAULT_RUNS, fuel: int = DEFAULT_FUEL
) -> Histories:
    """The exact distribution of simulations of at most `steps` time steps, in a simulator that is deterministic.

    Raises `UsageError` for a simulator that is random, and at a draw that is not finite or is made once per scene (reading `soft=scene`),
    `RunsExhausted` when there are more than `max_runs` runs, `AttemptsExhausted` if none is accepted, and the errors of the program and simulator.
    """
    if getattr(simulator, "random", False):
        raise UsageError("simulations are enumerated in a simulator that is not random", hint="sample them instead")
    masses: dict[str, Fraction] = defaultdict(Fraction)
    simulations: dict[str, Simulated] = {}
    stuck: dict[Failed, Fraction] = defaultdict(Fraction)
    prefix: list[Taken] | None = []
    runs, covered = 0, Fraction(0)
    begin = Beginnings(start, fuel)
    while prefix is not None:
        if runs == max_runs:
            text = f"the program has more than {max_runs:,} runs: those made cover {float(covered):.3g} of the probability"
            raise RunsExhausted(text, runs=max_runs, covered=covered)
        runner = Runner(prefix, None)
        ended = simulate_once(begin(), runner.choose, simulator, steps, fuel=fuel)
        if runner.coins:
            raise UsageError("simulations are enumerated under the reading soft=run only")
        runs, covered = runs + 1, covered + runner.probability
        if isinstance(ended, Simulated):
            key = content_of_simulation(ended)
            simulations.setdefault(key, ended)
            masses[key] += runner.probability
        else:
            stuck[ended] += runner.probability
        prefix = next_prefix(runner.choices)
    acceptance = sum(masses.values(), Fraction(0))
    if not masses:
        raise no_simulation_error(f"no simulation is possible: all {runs:,} runs fail", runs, Counter(dict.fromkeys(stuck, 1)))
    ranked = sorted(masses, key=lambda key: -masses[key])
    outcomes = tuple(History(masses[key] / acceptance, simulations[key]) for key in ranked)
    return Histories(outcomes, acceptance, dict(stuck), runs)


def content_of_simulation(simulation: Simulated) -> str:
    """Return the content of a simulation without its number: equal contents are one outcome."""
    found = to_json(simulation, 1)
    scene = found["scene"]
    assert isinstance(scene, dict)
    parts = [scene["params"], scene["ego"], scene["objects"], *(found[name] for name in ("created", "steps", "result", "reason"))]
    return json.dumps(parts, allow_nan=False)

