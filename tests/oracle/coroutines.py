"""The dynamic rules of the paper once more, by plain Python generators: a second opinion that shares no code with the project.

A behavior, a monitor and a compose block are each a generator, as Section "Semantics of Scenic", "Dynamic Constructs", has it: "behaviors and
monitors are coroutines: they usually execute like ordinary functions, but are suspended when they take an action (or wait) until one time step
has passed." What a generator yields are the actions, and whose own code it is that waits. Leaving a block is an exception, and giving up what is
suspended is `close`. Every draw is answered with each of its values, by running the program again.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import partial
from typing import Any

from .programs import Assign, Attempt, Branch, Demand, DynamicProgram, Extent, Leave, LetStepPass, Line, Repeat, Statement, TakeActions
from .running import Discarded, GuardBroken, Left, RunningScenario, Steps, Whose, WorldObject, close, compiled

BODY = -1
"""The number of the body among the clauses of a statement with interrupts."""


class Coroutines:
    """Statements in one run of a program: the choices in `answers` are made as they say, those after them by the first value."""

    def __init__(self, program: DynamicProgram, answers: tuple[int, ...] = ()) -> None:
        self.behaviors = {one.name: one for one in program.behaviors}
        self.scenarios = {one.name: one for one in program.scenarios}
        self.program, self.answers = program, answers
        self.drawn: list[tuple[int, int]] = []
        self.probability = Fraction(1)
        self.time = -1
        self.flag = False
        self.things: list[WorldObject] = []
        self.courses: list[RunningScenario] = []
        self.active: list[RunningScenario] = []
        self.happened: Counter[str] = Counter()
        self.known: dict[str, Any] = {
            "now": lambda: self.time, "Uniform": lambda *values: self.draw([(v, 1) for v in values]), "Discrete": lambda d: self.draw(d.items()),
        }  # fmt: skip

    # Draws and expressions

    def draw(self, options: Iterable[tuple[Any, Any]]) -> Any:
        """Figure "Semantics of expressions", Distributions: each value with its probability. "Any distributions defined inside a behavior are
        sampled at simulation time", "every time control reaches" them (Section "Dynamic Scenarios", "Behavior Arguments and Random Parameters").
        """
        options = list(options)
        place = len(self.drawn)
        chosen = self.answers[place] if place < len(self.answers) else 0
        self.drawn.append((chosen, len(options)))
        self.probability *= Fraction(options[chosen][1]) / sum(Fraction(weight) for _, weight in options)
        self.happened["draw"] += 1
        return options[chosen][0]

    def value(self, expression: str, whose: Whose) -> Any:
        """What an expression is now, with the variables of whose code it is."""
        return eval(compiled(expression), self.known, whose.names)

    def require(self, kind: str, condition: str, whose: Whose) -> None:
        """Section "Semantics of Scenic": "every run where a require statement is violated gets discarded"."""
        if not self.value(condition, whose):
            raise Discarded(kind)

    # Statements

    def block(self, statements: Line, whose: Whose) -> Steps:
        """One statement after the other."""
        for statement in statements:
            self.happened[f"{type(statement).__name__} in {whose.kind}"] += 1
            yield from self.statement(statement, whose)

    def statement(self, statement: Statement, whose: Whose) -> Steps:
        """One statement."""
        match statement:
            case TakeActions() | LetStepPass():
                yield from self.suspended(statement, whose)
            case Assign(target, value):
                name, _, x = target.partition(".")
                found = self.value(value, whose)
                if x:
                    setattr(self.value(name, whose), x, found)
                else:
                    whose.names[name] = found
            case Demand(condition, probability):
                share = Fraction(probability or 1)
                if share == 1 or self.draw([(True, share), (False, 1 - share)]):
                    self.require("require", condition, whose)
            case Leave(word):
                raise Left(word)
            case Branch(condition, then, otherwise):
                yield from self.block(then if self.value(condition, whose) else otherwise, whose)
            case Repeat():
                yield from self.repeat(statement, whose)
            case Attempt():
                yield from self.attempt(statement, whose)
            case _:
                yield from self.of_scenarios(statement, whose)

    def of_scenarios(self, statement: Statement, whose: Whose) -> Steps:
        """A statement that is about behaviors, scenarios and objects: `oracle` knows those."""
        raise TypeError(f"{type(statement).__name__} in {whose.kind} is no statement that runs by itself")

    def suspended(self, statement: TakeActions | LetStepPass, whose: Whose) -> Steps:
        """Section "Statements", "Actions": "the behavior is suspended until one time step has elapsed; then its invariants are checked and it is
        resumed." Actions of monitors "are ignored" (Section "Dynamic Scenarios", "Requirements and Monitors").
        """
        values = tuple(self.value(v, whose) for v in statement.values) if isinstance(statement, TakeActions) else ()
        yield values, whose
        self.check_invariants(whose)

    def repeat(self, loop: Repeat, whose: Whose) -> Steps:
        """Loops, `break` and `continue` are Python's."""
        turns = 0
        while self.value(loop.condition, whose) if loop.condition else turns < loop.times:
            turns += 1
            try:
                yield from self.block(loop.body, whose)
            except Left as left:
                if left.args[0] not in ("break", "continue"):
                    raise
                if left.args[0] == "break":
                    return

    # Guards

    def check_invariants(self, whose: Whose) -> None:
        """Section "Dynamic Scenarios", "Preconditions and Invariants": "Scenic signals guard violations by raising a GuardViolation exception"."""
        self.check("InvariantViolation", whose.invariants, whose)

    def check(self, kind: str, conditions: tuple[str, ...], whose: Whose) -> None:
        """Guards of one kind hold, or there is an exception."""
        if not all(self.value(condition, whose) for condition in conditions):
            self.happened[kind] += 1
            raise GuardBroken(kind)

    # Interrupts

    def attempt(self, statement: Attempt, whose: Whose) -> Steps:
        """Section "Statements", "Interrupts": exceptions "can be caught by except blocks as in the Python try statement. Additionally, any block may
        execute the abort statement to immediately terminate the entire try statement." (Readings `interrupts-in-except`, `finally-of-coroutines`.)
        """
        clauses = [(partial(self.value, b, whose), partial(self.block, handler, whose)) for b, handler in statement.interrupts]
        try:
            try:
                yield from self.interruptible(self.block(statement.body, whose), clauses, whose)
            except GuardBroken as broken:
                handler = next((h for kind, h in statement.catches if kind in ("GuardViolation", broken.args[0])), None)
                if handler is None:
                    raise
                self.happened["caught"] += 1
                yield from self.block(handler, whose)
        except Left as left:
            if left.args[0] != "abort":
                raise

    def interruptible(self, body: Steps, clauses: list[tuple[Callable[[], Any], Callable[[], Steps]]], whose: Whose) -> Steps:
        """Section "Statements", "Interrupts": "While none of them are true, the try block executes. When an interrupt condition becomes true, the
        body of the corresponding block is executed (with lower blocks preempting those above), suspending any behaviors/scenarios that were
        executing in the try block until the interrupt handler completes (at which point the invariants of the suspended behavior/scenario are
        checked as usual)." Outer statements come first, since it is their generator that goes on with the inner one (Section "Dynamic Scenarios").

        `running` is what was interrupted, and last what runs: which clause, since when, and who waits in it. In a time step each condition is looked
        at once (reading `interrupt-recheck`): those of clauses from number `seen` on have been.
        """
        running: list[tuple[int, Steps, int, Whose | None]] = [(BODY, body, self.time, None)]
        seen = len(clauses)
        try:
            while True:
                clause, steps, since, waiting = running[-1]
                fired = next((k for k in self.in_order(clause + 1, seen) if clauses[k][0]()), None)
                if fired is not None:
                    if waiting is whose:  # it is not suspended, but goes on, in the handler
                        self.check_invariants(whose)
                    self.happened["interrupt" if clause == BODY else "interrupt of a handler"] += 1
                    running.append((fired, clauses[fired][1](), self.time, None))
                    seen = fired
                    continue
                try:
                    actions, waiting = next(steps)
                except StopIteration:
                    running.pop()
                    if clause == BODY:
                        return
                    seen = self.looked_at(clause, since)
                    continue
                running[-1] = (clause, steps, since, waiting)
                yield actions, waiting
                seen = len(clauses)
        finally:
            close(steps for _, steps, _, _ in running)

    def in_order(self, first: int, end: int) -> Iterable[int]:
        """ "Successive clauses take precedence over those which precede them" (Section "Dynamic Scenarios", "Interrupts")."""
        return reversed(range(first, end))

    def looked_at(self, clause: int, since: int) -> int:
        """From which clause on the conditions were looked at in this time step, when a handler completes: its own was where it began in it."""
        return clause + 1 if since < self.time else clause

    def limited(self, body: Steps, limit: Extent | None, whose: Whose) -> Steps:
        """Section "Dynamic Scenarios", "Interrupts": `until` "is a shorthand" for an interrupt that aborts, `for` likewise (`do-until-zero`)."""
        if limit is None:
            yield from body
            return
        end = self.time + limit.steps
        over = partial(self.value, limit.condition, whose) if limit.condition else lambda: self.time >= end
        try:
            yield from self.interruptible(body, [(over, partial(self.block, (Leave("abort"),), whose))], whose)
        except Left as left:
            if left.args[0] != "abort":
                raise
            self.happened["limit"] += 1
