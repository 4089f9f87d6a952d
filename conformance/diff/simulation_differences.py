"""Simulations of a program here and in another implementation, in one world that moves as it was recorded."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from functools import cached_property

from ...api import Scenario
from ...data.simulation import to_json
from ...inference.comparison import compare
from ...inference.comparison.impossible_values import constants_of
from ...inference.comparison.known_features import Facts
from ...inference.comparison.scene_columns import features_table
from ...semantics.store.errors import AttemptsExhausted, ProgramError, RunsExhausted, UsageError
from ...testing.judge import MOST_RUNS
from ..implementations.harness_client import External
from ..implementations.line_process import ImplementationFault
from ..implementations.protocol import NeverAccepted, Refused, SimulationRecord
from ..recorded_world import RecordedWorld, World, random_walk_world
from .sequential_diff import (
    AT_ONCE,
    FIRST_LOOK,
    AskedProgram,
    DiffSettings,
    ProgramVerdict,
    of_errors,
    of_verdict,
    sequential_verdict,
)

ENOUGH_MISSED = 10
"""Simulations that are tried in vain, none having been found, after which no more are tried."""


def in_simulations(program: AskedProgram, scenario: Scenario, other: External, settings: DiffSettings) -> ProgramVerdict:
    """How simulations in one recorded world go: what agents do in each time step, and how it ends."""
    world = random_walk_world(scenario.sample(settings.seed), settings.steps, settings.seed)
    deadline = time.monotonic() + settings.seconds
    here = Replayed(scenario, world, settings)
    theirs: list[SimulationRecord] = []
    refused: list[Refused] = []
    missed: list[NeverAccepted] = []

    def grow(wanted: int) -> bool:
        before = len(theirs)
        while len(theirs) < wanted and not refused and not (theirs and missed) and len(missed) < ENOUGH_MISSED:
            if (theirs or missed) and time.monotonic() >= deadline:
                break
            count, seed = min(wanted - len(theirs), AT_ONCE), settings.seed + len(theirs) + len(missed) + 1
            try:
                theirs.extend(other.simulations(program.task, settings.steps, count, seed=seed, attempts=settings.attempts, world=world))
            except Refused as failed:
                refused.append(failed)
            except NeverAccepted as none:
                missed.append(none)
        return len(theirs) > before

    def beside(asked: Scenario | ProgramError, alpha: float) -> ProgramVerdict:
        failed = refused[0] if refused else None
        if isinstance(asked, ProgramError):
            return of_errors(program.name, asked, failed)
        replayed = here if asked is scenario else Replayed(asked, world, settings)
        return of_simulations(program.name, replayed, theirs, len(missed), failed, alpha)

    try:
        return sequential_verdict(program, scenario, other, settings, grow, beside)
    except ImplementationFault as fault:
        if fault.kind != "timed out" or theirs or not here.is_none_found:
            raise
        return ProgramVerdict(program.name, "inconclusive", "acceptance", f"no simulation is found here; there {fault}")


class Replayed:
    """Simulations here in a recorded world: those that were asked for so far."""

    def __init__(self, scenario: Scenario, world: World, settings: DiffSettings) -> None:
        self.scenario, self.world, self.settings = scenario, world, settings
        self.runs: list[SimulationRecord] = []
        self.missed: list[AttemptsExhausted] = []

    def first(self, count: int) -> list[SimulationRecord]:
        """So many of them, or fewer: those that the time of this part is enough for, but a first look's at least where none is missed; `missed` has
        the errors of those that were tried in vain. Raises `AttemptsExhausted` if all were, or one shows that none is possible.
        """
        deadline, attempts = time.monotonic() + self.settings.seconds, self.settings.attempts
        while len(self.runs) < count and ((not self.missed and len(self.runs) < FIRST_LOOK) or time.monotonic() < deadline):
            seed, steps, index = self.settings.seed, self.settings.steps, len(self.runs) + len(self.missed)
            try:
                run = self.scenario.simulate(RecordedWorld(self.world), steps, seed, index, max_attempts=attempts)
            except AttemptsExhausted as none:
                self.missed.append(none)
                if none.attempts < attempts or (not self.runs and len(self.missed) >= ENOUGH_MISSED):
                    raise
            else:
                self.runs.append(to_json(run.simulation, run.attempts))
        if not self.runs:
            raise self.missed[0]
        return self.runs[:count]

    @property
    def is_none_found(self) -> bool:
        """Whether none is found in the time of this part: whoever looks for them can take long."""
        try:
            return not self.first(1)
        except AttemptsExhausted:
            return True
        except ProgramError:
            return False

    @property
    def is_impossible(self) -> bool:
        """Whether one that was tried in vain shows that none is possible."""
        return bool(self.missed) and self.missed[-1].attempts < self.settings.attempts

    @cached_property
    def all(self) -> list[SimulationRecord]:
        """All simulations that are possible, if they are few; otherwise none."""
        if self.scenario.readings["rejected-simulation"] == "retry":
            return []
        try:
            found = self.scenario.enumerate_simulations(RecordedWorld(self.world), self.settings.steps, max_runs=MOST_RUNS)
        except (UsageError, RunsExhausted):
            return []
        return [to_json(simulation, 1) for _, simulation in found.outcomes]


def of_simulations(
    name: str, replayed: Replayed, theirs: Sequence[SimulationRecord], missed: int, refused: Refused | None, alpha: float
) -> ProgramVerdict:
    """Compare the other implementation's simulations, of which so many were `missed`, with those of the
    program here.
    """
    steps, detect_tv = replayed.settings.steps, replayed.settings.detect_tv
    try:
        ours = replayed.first(max(len(theirs), FIRST_LOOK))
    except ProgramError as error:
        return of_errors(name, error, refused)
    except AttemptsExhausted as none:
        if missed and not theirs:
            return ProgramVerdict(name, "agree", "acceptance", "no simulation is accepted")
        if theirs:
            chance = 0.0 if replayed.is_impossible else all_on_one_side(len(replayed.missed), len(theirs), missed)
            return of_acceptance(name, f"{none.message} here, and there are simulations there", chance, alpha)
        return of_refusal(name, refused)
    if refused is not None:
        return of_refusal(name, refused)
    if not theirs:
        chance = all_on_one_side(missed, len(ours), len(replayed.missed))
        return of_acceptance(name, "no simulation is accepted there, and there are simulations here", chance, alpha)
    agents = sorted({agent for run in (*theirs, *ours) for step in run["steps"] for agent in step["actions"]})  # type: ignore[attr-defined]
    rows = [[{"params": courses(run, agents, steps)} for run in runs] for runs in (theirs, ours)]
    always = constants_of(features_table({"params": courses(run, agents, steps)} for run in replayed.all))
    verdict = compare(rows[0], rows[1], alpha=alpha, detect_tv=detect_tv, facts=Facts(constants=always))
    return of_verdict(name, verdict, "actions")


def all_on_one_side(missed: int, found: int, missed_there: int) -> float:
    """The probability that one side misses all of `missed` tries, given what both sides find and miss together, if they miss equally often.

    The other side has looked until it had found enough, so that its last find says nothing.
    """
    free = max(found - 1, 0)
    return math.comb(free + missed_there, free) / math.comb(free + missed_there + missed, free)


def of_acceptance(name: str, text: str, chance: float, alpha: float) -> ProgramVerdict:
    """One side has simulations and the other none: a difference if the chance of that is small enough where there is none."""
    return ProgramVerdict(name, "differ" if chance <= alpha else "inconclusive", "acceptance", text, -math.log10(chance) if chance else math.inf)


def of_refusal(name: str, refused: Refused | None) -> ProgramVerdict:
    """An error there, in simulations only."""
    return ProgramVerdict(name, "differ", "error", f"refused there when it was simulated: {'' if refused is None else refused.message}", math.inf)


def courses(run: SimulationRecord, agents: Sequence[str], steps: int) -> dict[str, object]:
    """A simulation as features of the same names whatever happens: what each agent does in each time step, when it ends, and how."""
    taken: Sequence[Mapping[str, Mapping[str, object]]] = run["steps"]  # type: ignore[assignment]
    found: dict[str, object] = {"result": run["result"], "length": str(len(taken))}
    for number in range(steps):
        actions = taken[number]["actions"] if number < len(taken) else {}
        found |= {f"step {number}, object {agent}": actions.get(agent, "none") for agent in agents}
    return found
