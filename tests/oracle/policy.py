"""The seven steps of the policy (Section "Semantics of Scenic", "Dynamic Constructs"), and all histories of a program with their probabilities."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Hashable, Mapping
from fractions import Fraction
from typing import NamedTuple

from .oracle import Oracle
from .programs import DynamicProgram, ModularScenario
from .running import Discarded, GuardBroken, Left, RunningScenario, WorldObject


class TooManyRuns(Exception):
    """The program has more runs than were asked for."""


class Law(NamedTuple):
    """The probability of each history, a rejected one being (kind of condition, time step); how often what happened, over all runs."""

    histories: Mapping[tuple[Hashable, ...], Fraction]
    happened: Counter[str]
    runs: int


class Policy(Oracle):
    """A run of a program from its scene to its end."""

    def history(self, limit: int) -> tuple[Hashable, ...]:
        """The values of `x` in the scene, the actions of each time step with the objects that are new in it, and the end; or why it was rejected."""
        try:
            self.top = self.scene()
            first = tuple(thing.x for thing in self.things)
            steps = []
            while True:
                known = len(self.things)
                self.time += 1
                self.happened["time step"] += 1
                actions: dict[int, tuple[object, ...]] = {}
                end = self.seven_steps(actions, self.time == limit)
                steps.append((frozenset() if end else frozenset(actions.items()), tuple(thing.x for thing in self.things[known:])))
                if end:
                    self.happened[end] += 1
                    return first, tuple(steps), end
        except Discarded as why:
            self.happened[f"rejected: {why}"] += 1
            return str(why), self.time

    def scene(self) -> RunningScenario:
        """The program itself, then Main: its preconditions are observed (reading `initial-guards`)."""
        try:
            course = self.begun(ModularScenario("", (), (), self.program.top, None), self.known, top=True)
            return self.begun(self.program.scenarios[0], {}, top=True) if self.program.scenarios else course
        except GuardBroken:
            raise Discarded("precondition") from None

    def seven_steps(self, actions: dict[int, tuple[object, ...]], last: bool) -> str:
        """ "The output of the policy of a dynamic Scenic program is defined according to the following procedure". Says how the simulation ends, if
        it does: in the last time step anyway (reading `time-limit`).
        """
        self.active.clear()
        try:
            self.compose_blocks()
            self.requirements()
            self.monitors()
            if self.ends(last):
                return "terminated" if self.flag else "time limit"
            self.agents(actions)
            return "terminated" if self.ends(False) else ""
        except GuardBroken:  # "the simulation is only rejected if the exception propagates out to the top level"
            raise Discarded("guard") from None

    def compose_blocks(self) -> None:
        """1. "Run the compose blocks of all currently-running scenarios for one time step." """
        if not self.step_of(self.top):
            self.terminate()

    def requirements(self) -> None:
        """2. "Check all require always conditions of currently-running scenarios; if any fail, discard the simulation." What must hold eventually is
        looked at as well, and missed by scenarios that are over (reading `eventually-window`).
        """
        for course in self.active:
            for condition, whose in course.conditions["require always"]:
                self.require("always", condition, whose)
            self.look(course)
        self.satisfied([course for course in self.courses if course.over])

    def look(self, course: RunningScenario) -> None:
        """Which conditions of `require eventually` hold now."""
        course.held |= {k for k, (condition, whose) in enumerate(course.conditions["require eventually"]) if self.value(condition, whose)}

    def satisfied(self, courses: list[RunningScenario]) -> None:
        """All `require eventually` of scenarios that ran have held at some time."""
        if any(course.ran and len(course.held) < len(course.conditions["require eventually"]) for course in courses):
            raise Discarded("eventually")

    def monitors(self) -> None:
        """3. "Run all monitors of currently-running scenarios for one time step." One that terminates ends its scenario (`terminate-who`)."""
        for course in self.active:
            for monitor in course.monitors:
                try:
                    next(monitor, None)
                except Left as left:
                    if left.args[0] == "terminate":
                        self.terminated_by_monitor(course)

    def terminated_by_monitor(self, course: RunningScenario) -> None:
        """The flag, or the end of a scenario that another one runs."""
        self.happened["monitor terminates"] += 1
        if course.top:
            self.terminate()
        else:
            self.end(course)

    def ends(self, last: bool) -> bool:
        """4. and 6. "If the flag is set, check that all require eventually conditions were satisfied at some time step: if so, terminate the
        simulation; otherwise, discard it."
        """
        if self.flag or last:
            self.satisfied(self.courses)
        return self.flag or last

    def agents(self, actions: dict[int, tuple[object, ...]]) -> None:
        """5. "Run all the behaviors of dynamic agents for one time step, gathering their actions"; then 7. "Return the choice of actions"."""
        for number, thing in enumerate(self.things):
            taken = self.agent(thing)
            if taken:
                actions[number] = taken

    def agent(self, thing: WorldObject) -> tuple[object, ...]:
        """The actions of an agent: those of the behavior that is in force; the flag is set if it terminates."""
        behavior = thing.layers["behavior"][-1][1]
        if behavior is None:
            return ()
        try:
            return next(behavior, ((), None))[0]
        except Left:
            self.terminate()
            return ()


def law_of(program: DynamicProgram, limit: int, policy: type[Policy] = Policy, most: int = 10_000) -> Law:
    """All histories of at most `limit` time steps: each choice is made in each way. Raises `TooManyRuns`."""
    histories: dict[tuple[Hashable, ...], Fraction] = defaultdict(Fraction)
    happened: Counter[str] = Counter()
    answers: tuple[int, ...] | None = ()
    runs = 0
    while answers is not None:
        runs += 1
        if runs > most:
            raise TooManyRuns
        run = policy(program, answers)
        histories[run.history(limit)] += run.probability
        happened += run.happened
        answers = following(run.drawn)
    return Law(dict(histories), happened, runs)


def following(drawn: list[tuple[int, int]]) -> tuple[int, ...] | None:
    """The answers of the next run: the last choice that can be made otherwise is."""
    while drawn and drawn[-1][0] + 1 == drawn[-1][1]:
        drawn = drawn[:-1]
    return (*(k for k, _ in drawn[:-1]), drawn[-1][0] + 1) if drawn else None
