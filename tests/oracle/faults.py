"""Wrong oracles, one fault each: that each of them differs from the machine shows that the comparison can fail, and what its programs reach."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import Any

from .policy import Policy
from .programs import Extent, Invitation, LetStepPass, ModularScenario, TakeActions
from .running import Left, RunningScenario, Steps, Whose, WorldObject


class EarlierClausesFirst(Policy):
    """Clauses of a statement take precedence over those which follow them."""

    def in_order(self, first: int, end: int) -> Iterable[int]:
        return range(first, end)


class HandlersAreNotInterrupted(Policy):
    """Interrupts fire in the body only."""

    def in_order(self, first: int, end: int) -> Iterable[int]:
        return super().in_order(first, end) if first == 0 else ()


class InterruptsFromTheSecondStepOn(Policy):
    """Conditions are not looked at before the body begins."""

    def interruptible(self, body: Steps, clauses: list[tuple[Callable[[], Any], Callable[[], Steps]]], whose: Whose) -> Steps:
        begun = self.time
        later = [((lambda condition=condition: self.time > begun and condition()), handler) for condition, handler in clauses]
        return super().interruptible(body, later, whose)


class InnerInterruptsFirst(Policy):
    """A handler of a statement inside of another one is left to complete before interrupts of the outer one are looked at."""

    def interruptible(self, body: Steps, clauses: list[tuple[Callable[[], Any], Callable[[], Steps]]], whose: Whose) -> Steps:
        agent = whose.names.get("self", whose.scenario)
        around, own = [mark for mark, _ in self.handling], object()

        def free(condition: Callable[[], Any]) -> Callable[[], Any]:
            return lambda: all(mark is own or mark in around or other is not agent for mark, other in self.handling) and condition()

        def occupying(handler: Callable[[], Steps]) -> Steps:
            before = self.handling
            self.handling = [*before, (own, agent)]
            try:
                yield from handler()
            finally:
                self.handling = before

        return super().interruptible(body, [(free(condition), partial(occupying, handler)) for condition, handler in clauses], whose)

    handling: list[tuple[object, object]] = []  # noqa: RUF012


class HandlersDoNotRepeat(Policy):
    """When a handler completes, its own condition is not looked at again before the next time step."""

    def looked_at(self, clause: int, since: int) -> int:
        return clause


class OverridesStay(Policy):
    """What is overridden stays so when the scenario has ended."""

    def end(self, course: RunningScenario) -> None:
        kept = [(thing, {name: list(layers) for name, layers in thing.layers.items()}) for thing in self.things]
        super().end(course)
        for thing, layers in kept:
            thing.layers = layers


class OverridesEndWithSetup(Policy):
    """What a setup block overrides is as before when it is over."""

    def begun(self, definition: ModularScenario, names: Any, enabled: bool = False, top: bool = False) -> RunningScenario:
        course = super().begun(definition, names, enabled, top)
        for thing in self.things:
            thing.layers = {name: [layer for layer in layers if layer[0] is not course] for name, layers in thing.layers.items()}
        return course


class OverriddenBehaviorsGoOn(Policy):
    """A behavior that is overridden is not suspended: it goes on, and its actions are lost."""

    def agent(self, thing: WorldObject) -> tuple[object, ...]:
        for _, behavior in thing.layers["behavior"][:-1]:
            if behavior is not None:
                with suppress(Left):
                    next(behavior, None)
        return super().agent(thing)


class InvariantsAtTheBeginningOnly(Policy):
    """Invariants are not checked when a time step has elapsed."""

    def suspended(self, statement: TakeActions | LetStepPass, whose: Whose) -> Steps:
        kept, whose.invariants = whose.invariants, ()
        try:
            yield from super().suspended(statement, whose)
        finally:
            whose.invariants = kept


class ViolationsReject(Policy):
    """A violated guard rejects the simulation, and nothing can catch it."""

    def check(self, kind: str, conditions: tuple[str, ...], whose: Whose) -> None:
        super().check("an exception of another class", conditions, whose)


class AllAreEnabled(Policy):
    """`do choose` does not look at preconditions."""

    def is_enabled(self, one: Invitation, n: Any, whose: Whose) -> bool:
        return True


class ShuffleStopsAfterOne(Policy):
    """`do shuffle` is `do choose`."""

    def chosen(self, options: list[tuple[Invitation, Any]], shuffle: bool, whose: Whose) -> Steps:
        return super().chosen(options, False, whose)


class WeightsAreEqual(Policy):
    """All that can be drawn is equally likely."""

    def draw(self, options: Iterable[tuple[Any, Any]]) -> Any:
        return super().draw([(value, Fraction(1)) for value, _ in options])


class DrawnOnce(Policy):
    """A distribution is sampled the first time that control reaches it, and never again."""

    def value(self, expression: str, whose: Whose) -> Any:
        if "Uniform(" not in expression and "Discrete(" not in expression:
            return super().value(expression, whose)
        if expression not in self.samples:
            self.samples = {**self.samples, expression: super().value(expression, whose)}
        return self.samples[expression]

    samples: dict[str, Any] = {}  # noqa: RUF012


class LimitsAreOneStepLonger(Policy):
    """`do ... for N steps` runs N + 1 of them."""

    def limited(self, body: Steps, limit: Extent | None, whose: Whose) -> Steps:
        longer = limit if limit is None or limit.condition else Extent(limit.steps + 1)
        return super().limited(body, longer, whose)


class EventuallyIsNotLookedAtInTheEnd(Policy):
    """Whether `require eventually` holds is not seen in the last time step."""

    def look(self, course: RunningScenario) -> None:
        if not (self.flag or course.over):
            super().look(course)


class EventuallyIsForgotten(Policy):
    """A simulation may end without what it requires eventually."""

    def satisfied(self, courses: list[RunningScenario]) -> None:
        pass


class MonitorsEndWithTheirScenario(Policy):
    """Monitors do not run in the last time step of their scenario."""

    def monitors(self) -> None:
        self.active = [course for course in self.active if not course.over and not self.flag]
        super().monitors()


class MonitorsEndTheSimulation(Policy):
    """`terminate` in any monitor ends the simulation (the other alternative of the reading `terminate-who`)."""

    def terminated_by_monitor(self, course: RunningScenario) -> None:
        self.terminate()


class AgentsStopAtTheFlag(Policy):
    """Agents after one that has executed `terminate` do not run (the other alternative of the reading `behaviors-after-terminate`)."""

    def agent(self, thing: WorldObject) -> tuple[object, ...]:
        return () if self.flag else super().agent(thing)


class TerminateIsForgotten(Policy):
    """`terminate` in one of several behaviors has no effect where another one raises an exception that is caught: the fault that the oracle found."""

    def terminated_beside_others(self) -> None:
        pass


class NewObjectsWait(Policy):
    """The behavior of a new object begins one time step after the object was made."""

    def compose_blocks(self) -> None:
        self.known_before = len(self.things) if self.time else 1000
        super().compose_blocks()

    def agent(self, thing: WorldObject) -> tuple[object, ...]:
        return super().agent(thing) if self.things.index(thing) < self.known_before else ()


FAULTS = Policy.__subclasses__()
"""All of them."""
