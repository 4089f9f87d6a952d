"""The matcher `simulations`: what agents do, time step by time step, how simulations end, and how likely each is.

They take place in a world in which nothing moves, any value is an action, and a time step takes one second: all that they show is the
policy.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from ...inference.comparison.exact_laws import evidence
from ..implementations.protocol import (
    Enumerated,
    EnumeratingSimulations,
    Implementation,
    NeverAccepted,
    Refused,
    Simulating,
    SimulationRecord,
    Task,
)
from ..strict_tables import VectorFields
from ..verdict import PASSED, VectorVerdict, skipped_verdict
from .common import ATTEMPTS, Disagreement, close, disagreement_verdict, requirements
from .distributions import SAME, agree, law_of, told_apart
from .errors import REQUIREMENTS, simulations_of

TERMINATED, TIME_LIMIT = "terminated", "time limit"
SIMULATIONS = 3
"""How many simulations are looked at where all must be alike, and the implementation does not enumerate."""
REJECTED_ATTEMPTS = 50
KINDS = (*REQUIREMENTS, "always", "eventually", "guard", "precondition")
"""The requirements that may reject a simulation: those of its scenes, and those of its time steps."""

Actions = Mapping[str, object]
"""The actions of a time step: a list for the number of each object that takes some."""


@dataclass(frozen=True, slots=True)
class SimulationCourse:
    """The course of a simulation: the actions of each time step that passes, how it ends, and perhaps how many objects there are at each time."""

    actions: tuple[Actions, ...]
    result: str
    objects: tuple[int, ...] | None

    def difference(self, found: SimulationRecord) -> str | None:
        """Describe the difference of a simulation from this one; None if there is none."""
        steps = found.get("steps")
        if not isinstance(steps, list) or not steps:
            return "the simulation has no steps"
        *passing, last = (taken_in(step) for step in steps)
        for number, (taken, expected) in enumerate(zip(passing, self.actions)):
            if not same_actions(taken, expected):
                return f"in time step {number} the actions are {dict(taken)}, not {dict(expected)}"
        ended = f"{len(passing)} time steps pass, and it ends with {found.get('result')!r}"
        if len(passing) != len(self.actions) or found.get("result") != self.result or last:
            return f"{ended}, not {len(self.actions)} and {self.result!r}" if not last else "there are actions after the last time step"
        counts = [len(objects) if isinstance(objects := child(step, "objects"), list) else 0 for step in steps]
        if self.objects is not None and counts != [*self.objects]:
            return f"there are {counts} objects in the time steps, not {[*self.objects]}"
        return None


def child(step: object, key: str) -> object:
    """Return the value of a time step under a key."""
    return step.get(key) if isinstance(step, Mapping) else None


def taken_in(step: object) -> Actions:
    """The actions of a time step, without agents that take none."""
    taken = child(step, "actions")
    return {str(agent): actions for agent, actions in taken.items() if actions} if isinstance(taken, Mapping) else {}


def same_actions(found: Actions, expected: Actions) -> bool:
    """Whether the same agents take the same actions in the same order."""
    return found.keys() == expected.keys() and all(close(found[agent], actions, SAME) for agent, actions in expected.items())


@dataclass(frozen=True, slots=True)
class Simulations:
    """The exact distribution of simulations of at most `steps` time steps, and perhaps the probability that a run is accepted.

    An implementation that enumerates must give exactly these fractions; any other is sampled, and its samples must contradict `rival`.
    """

    steps: int
    histories: tuple[SimulationCourse, ...]
    probabilities: tuple[Fraction | float, ...]
    rival: tuple[Fraction | float, ...]
    acceptance: Fraction | float | None
    samples: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """By enumeration where that is possible, by sampling elsewhere."""
        if not isinstance(implementation, Simulating):
            return skipped_verdict(f"{implementation.name} does not simulate")
        try:
            exact = self.enumerated(implementation, task) if all(isinstance(p, Fraction) for p in self.probabilities) else None
            if exact is None:
                self.check_samples(self.drawn(implementation, task))
            else:
                self.check_enumeration(exact)
        except Disagreement as disagreement:
            return disagreement_verdict(disagreement)
        except Refused as refused:
            return disagreement_verdict(Disagreement(f"{refused.when}: {refused.message}"))
        except NeverAccepted as never:
            return disagreement_verdict(Disagreement(f"no run was accepted: {requirements(never)}"))
        return PASSED

    def enumerated(self, implementation: Implementation, task: Task) -> Enumerated | None:
        """The exact distribution if the implementation can find it."""
        return implementation.enumerated_simulations(task, self.steps) if isinstance(implementation, EnumeratingSimulations) else None

    def drawn(self, implementation: Simulating, task: Task) -> list[SimulationRecord]:
        """As many simulations as are needed. Raises `Disagreement` if there are more or less."""
        found = list(implementation.simulations(task, self.steps, self.samples, seed=task.seed, attempts=ATTEMPTS))
        if len(found) != self.samples:
            raise Disagreement(f"gave {len(found)} simulations, and {self.samples} were asked for")
        return found

    def number(self, simulation: SimulationRecord) -> int:
        """Which history a simulation is. Raises `Disagreement` if it is none of them."""
        differences = [history.difference(simulation) for history in self.histories]
        if None in differences:
            return differences.index(None)
        if len(differences) == 1:
            raise Disagreement(str(differences[0]))
        steps = simulation.get("steps")
        course = [dict(taken_in(step)) for step in steps[:-1]] if isinstance(steps, list) else steps
        raise Disagreement(f"a simulation is not one of the histories: its actions are {course}, and it ends with {simulation.get('result')!r}")

    def check_enumeration(self, exact: Enumerated) -> None:
        """The fractions themselves. Raises `Disagreement`."""
        found = [Fraction(0)] * len(self.histories)
        for probability, simulation in exact.outcomes:
            found[self.number(simulation)] += probability
        for number, (expected, probability) in enumerate(zip(self.probabilities, found, strict=True)):
            if probability != expected:
                raise Disagreement(f"histories[{number}] has probability {probability}, not {expected}")
        if self.acceptance is not None and not agree(exact.acceptance, self.acceptance):
            raise Disagreement(f"a run is accepted with probability {exact.acceptance}, not {self.acceptance}")

    def check_samples(self, simulations: list[SimulationRecord]) -> None:
        """Frequencies must not contradict the probabilities, and must contradict the rival's. Raises `Disagreement`."""
        numbers = [self.number(simulation) for simulation in simulations]
        if len(self.histories) > 1:
            told_apart(evidence(numbers, law_of(self.probabilities)), evidence(numbers, law_of(self.rival)), "simulations")


@dataclass(frozen=True, slots=True)
class AlwaysRejected:
    """No simulation of at most `steps` time steps is possible, because of requirements of these kinds."""

    steps: int
    kinds: frozenset[str]
    attempts: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """No simulation in `attempts` attempts; an implementation that reports why must name these requirements and no other."""
        if not isinstance(implementation, Simulating):
            return skipped_verdict(f"{implementation.name} does not simulate")
        wanted = ", ".join(sorted(self.kinds))
        try:
            found = simulations_of(implementation, task, self.steps, self.attempts)
        except Refused as refused:
            return disagreement_verdict(Disagreement(f"{refused.when} instead of never accepted: {refused.message}"))
        except NeverAccepted as never:
            told = never.requirements is None or never.requirements == self.kinds
            return PASSED if told else disagreement_verdict(Disagreement(f"never accepted, but not because of {wanted} alone: {requirements(never)}"))
        return disagreement_verdict(Disagreement(f"gave {len(found)} simulations, and no run may be accepted ({wanted})"))


# Reading


def read_simulations(fields: VectorFields) -> Simulations | AlwaysRejected:
    """The table `simulations` of a vector: histories, a single one without its probability, or `rejected`. Raises `UsageError`."""
    steps = fields.count("steps")
    if fields.has("rejected"):
        return read_rejected(fields, steps)
    if not fields.has("histories"):
        history = read_history(fields, steps)
        acceptance = fields.probability("acceptance") if fields.has("acceptance") else None
        fields.done()
        return Simulations(steps, (history,), (Fraction(1),), (Fraction(1),), acceptance, SIMULATIONS)
    tables = fields.tables("histories")
    histories = tuple(read_history(table, steps) for table in tables)
    probabilities = tuple(table.probability("probability") for table in tables)
    rival = tuple(fields.as_probability("rival", share) for share in fields.items("rival"))
    acceptance = fields.probability("acceptance") if fields.has("acceptance") else None
    found = Simulations(steps, histories, probabilities, rival, acceptance, fields.count("samples"))
    for table in (*tables, fields):
        table.done()
    if len(histories) < 2:
        raise fields.wrong("a single history is written without `histories`")
    for name, shares in (("histories", probabilities), ("rival", rival)):
        if len(shares) != len(histories) or abs(sum(shares) - 1) > SAME:
            raise fields.wrong(f"the probabilities of {name} must be one for each history and add up to 1")
    return found


def read_rejected(fields: VectorFields, steps: int) -> AlwaysRejected:
    """`rejected`: the kind of requirement, or the kinds. Raises `UsageError`."""
    kinds, attempts = fields.text_or_texts("rejected"), fields.count("attempts", REJECTED_ATTEMPTS)
    fields.done()
    for kind in kinds:
        if kind not in KINDS:
            raise fields.wrong(f"there is no requirement {kind!r}: there are {', '.join(KINDS)}")
    if not kinds:
        raise fields.wrong("rejected must name one kind of requirement or more")
    return AlwaysRejected(steps, frozenset(kinds), attempts)


def read_history(fields: VectorFields, steps: int) -> SimulationCourse:
    """`actions`, `result` and perhaps `objects`. Raises `UsageError`."""
    listed, result = fields.any("actions"), fields.text("result")
    if not isinstance(listed, list):
        raise fields.wrong(f"actions must be a list, not {listed!r}")
    if result not in (TERMINATED, TIME_LIMIT):
        raise fields.wrong(f"result must be {TERMINATED!r} or {TIME_LIMIT!r}, not {result!r}")
    if len(listed) != steps if result == TIME_LIMIT else len(listed) > steps:
        needed = f"those of {steps} time steps" if result == TIME_LIMIT else f"those of at most {steps} time steps"
        raise fields.wrong(f"a simulation that ends with {result!r} has {needed}, and these are {len(listed)}")
    actions = tuple(dict(read_actions(fields, entry)) for entry in listed)
    counts = fields.any("objects", None)
    if counts is None:
        return SimulationCourse(actions, result, None)
    if not isinstance(counts, list) or len(counts) != len(actions) + 1 or not all(type(count) is int and count >= 0 for count in counts):
        raise fields.wrong(f"objects must be a number for each of {len(actions) + 1} times, not {counts!r}")
    return SimulationCourse(actions, result, tuple(counts))


def read_actions(fields: VectorFields, entry: object) -> Iterator[tuple[str, object]]:
    """One time step: the action of object 0, the list of its actions, or a table of lists by object number. Raises `UsageError`."""
    if isinstance(entry, Mapping) and "none" not in entry:
        for agent, taken in entry.items():
            if not str(agent).isdecimal() or not isinstance(taken, list) or not taken:
                raise fields.wrong(f"actions of several objects are lists by the object's number, not {entry!r}")
            yield str(agent), taken
    elif entry != []:
        yield "0", entry if isinstance(entry, list) else [entry]
