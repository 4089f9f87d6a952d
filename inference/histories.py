"""Enumeration of simulations: the exact probability of every history of a finite program in a deterministic simulator."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ..data.simulation import Simulated, to_json
from ..interpreter.running import DEFAULT_FUEL, Beginnings
from ..pictures.notebook_views import counted
from ..semantics.kernel.config import Config
from ..semantics.kernel.errors import RunsExhausted, UsageError
from ..simulators.protocol import Simulator
from ..simulators.simulating import Failed, simulate_once
from .enumeration import DEFAULT_RUNS, Runner, Taken, following
from .simulation import exhausted


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
        return f"<{counted(len(self.outcomes), 'simulation')}, exact, of {counted(self.runs, 'run')}; {accepted}>"

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
        prefix = following(runner.choices)
    acceptance = sum(masses.values(), Fraction(0))
    if not masses:
        raise exhausted(f"no simulation is possible: all {runs:,} runs fail", runs, Counter(dict.fromkeys(stuck, 1)))
    ranked = sorted(masses, key=lambda key: -masses[key])
    outcomes = tuple(History(masses[key] / acceptance, simulations[key]) for key in ranked)
    return Histories(outcomes, acceptance, dict(stuck), runs)


def content_of_simulation(simulation: Simulated) -> str:
    """What a simulation says, whatever its number: those with the same content are one outcome."""
    found = to_json(simulation, 1)
    scene = found["scene"]
    assert isinstance(scene, dict)
    parts = [scene["params"], scene["ego"], scene["objects"], *(found[name] for name in ("created", "steps", "result", "reason"))]
    return json.dumps(parts, allow_nan=False)
