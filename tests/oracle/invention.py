"""Random dynamic programs for the oracle: each is a function of a seed, well-formed, and ends every time step."""

from __future__ import annotations

from random import Random

from .policy import TooManyRuns, law_of
from .programs import (
    Assign,
    Attempt,
    Branch,
    Carry,
    Creation,
    Declaration,
    Demand,
    DynamicProgram,
    Extent,
    Invitation,
    Leave,
    LetStepPass,
    Line,
    ModularScenario,
    Overriding,
    Procedure,
    Repeat,
    Statement,
    TakeActions,
    Watchman,
)  # fmt: skip

STEPS = 4
"""Time steps of the histories."""
DEEPEST = 2
BEHAVIORS = [f"B{k}" for k in range(5)]
"""The first two are those that agents begin with."""


class Inventor:
    """Writes one program. Behaviors and scenarios invoke later ones only, and a `while` begins with what takes time: no time step is endless.

    Most programs have a theme, of which there is more in them than chance would give: what is rare alone is rarer still together.
    """

    def __init__(self, seed: str) -> None:
        self.random = Random(seed)
        self.kind = "behavior"
        self.later: list[str] = []
        self.behaviors: list[str] = []
        self.made = 0
        self.things = ["ego"]
        self.theme = self.pick("any", "guards", "interrupts", "scenarios", "scenarios")

    def chance(self, share: float) -> bool:
        """True with this probability."""
        return self.random.random() < share

    def pick(self, *options: str) -> str:
        """One of some texts."""
        return self.random.choice(options)

    # Expressions

    def thing(self) -> str:
        """An object whose property is read or changed."""
        return self.pick("self", "self", *self.things) if self.kind == "behavior" else self.pick(*self.things)

    def number(self) -> str:
        """A number, which may be drawn."""
        if self.chance(0.12):
            return self.pick("Uniform(1, 2)", "Uniform(0, 1)", "Discrete({3: 1, 4: 2})", "Uniform(0, 1, 1)")
        return self.pick("1", "2", "0", f"{self.thing()}.x", "now()", "n", "y", f"{self.thing()}.x + 1", "n + 10")

    def condition(self) -> str:
        """A condition about the time, a property, a variable, or a draw."""
        if self.chance(0.1):
            return self.pick("Uniform(0, 1) == 1", "Uniform(0, 1, 1) == 1", "Discrete({1: 1, 2: 3}) == n")
        time = self.pick("==", ">=", "!=", "<")
        x = f"{self.thing()}.x"
        about = f"{x} == {self.pick('0', '1', '2')}", f"{x} < {self.pick('1', '2', '3')}", f"{x} >= {self.pick('1', '2')}"
        return self.pick(f"now() {time} {self.pick('1', '2', '3')}", f"now() == {self.pick('1', '2', '3')}", *about, f"not ({about[0]})", "y < n")

    def likely(self) -> str:
        """A condition that mostly holds, so that not all is rejected."""
        return self.pick(f"{self.thing()}.x < {self.pick('2', '3', '4')}", f"now() < {self.pick('3', '4', '5')}", f"{self.thing()}.x != 2", "y < 4")

    def guard(self) -> str:
        """A guard."""
        if self.theme == "guards":
            return self.pick(f"now() < {self.pick('1', '2', '3')}", f"{self.thing()}.x < {self.pick('1', '2')}", f"now() != {self.pick('1', '2')}")
        return self.likely() if self.chance(0.6) else self.condition()

    # Statements

    def block(self, depth: int = 0, loop: bool = False, attempt: bool = False) -> Line:
        """A few statements; `loop` and `attempt` say what the last one may leave."""
        found = [self.statement(depth, loop, attempt) for _ in range(self.random.choice([1, 2, 2, 3] if depth == 0 else [1, 1, 2]))]
        leaving = [Leave("terminate")] * self.chance(0.15) + [Leave("return")] * (self.kind != "monitor" and self.chance(0.2))
        leaving += [Leave("break"), Leave("continue")] * loop + [Leave("abort")] * (2 * attempt)
        return (*found, self.random.choice(leaving)) if leaving and self.chance(0.4) else tuple(found)

    def step(self) -> Statement:
        """A statement that takes time."""
        if self.kind == "compose" or self.chance(0.2):
            return LetStepPass()
        return TakeActions(tuple(self.number() for _ in range(1 + self.chance(0.2))))

    def statement(self, depth: int, loop: bool, attempt: bool) -> Statement:
        """A statement: a simple one, or one with others inside while there is room."""
        if depth < DEEPEST and self.chance(0.42 if depth == 0 else 0.25):
            return self.compound(depth + 1, loop, attempt)
        if self.later and self.kind != "monitor" and self.chance(0.45):
            return self.carry()
        return self.simple()

    def simple(self) -> Statement:
        """A statement without others inside."""
        if self.chance(0.55):
            return self.step()
        if self.kind == "compose" and self.chance(0.6):
            return self.declaration() if self.chance(0.4) else self.replacement()
        if self.chance(0.2):
            return Demand(self.likely(), self.pick("", "", "0.5", "0.25"))
        return Assign(self.pick("y", f"{self.thing()}.x", f"{self.thing()}.x"), self.number())

    def compound(self, depth: int, loop: bool, attempt: bool) -> Statement:
        """A statement with others inside."""
        kind = self.random.choices(["if", "loop", "try"], [1, 1, 4])[0]
        if kind == "if":
            return Branch(self.condition(), self.block(depth, loop, attempt), self.block(depth, loop, attempt))
        if kind == "loop":
            if self.chance(0.6):
                return Repeat(2, "", self.block(depth, True, attempt))
            return Repeat(0, self.pick("True", self.condition()), (self.step(), *self.block(depth, True, attempt)))
        return self.attempt(depth, loop)

    def attempt(self, depth: int, loop: bool) -> Attempt:
        """`try`, most often around a `do` statement; in the theme of interrupts, handlers that are interrupted."""
        nested = self.theme == "interrupts"
        interrupts: list[tuple[str, Line]] = []
        for _ in range(self.random.choice([2, 2, 3] if nested else [1, 1, 2, 3])):
            time = f"now() == {self.pick('1', '1', '2', '3')}"
            handler = self.block(depth, loop, True)
            interrupts.append((time, (self.step(), *handler)) if nested and self.chance(0.7) else (self.condition(), handler))
        caught = self.pick("GuardViolation", "GuardViolation", "InvariantViolation", "PreconditionViolation")
        catches = ((caught, self.block(depth, loop, True)),) if self.chance(0.9 if self.theme == "guards" else 0.4) else ()
        body = self.block(depth, loop, True)
        if self.later and self.kind != "monitor" and self.chance(0.9 if self.theme == "guards" else 0.5):
            body = (self.carry(), *body)
        elif nested:
            body = (self.step(), self.step(), *body)
        return Attempt(body, tuple(interrupts), catches)

    def carry(self) -> Carry:
        """`do` with one or several, or a choice, with or without a limit."""
        way = self.pick("", "", "", "choose", "shuffle")
        count = self.random.randint(2, 3) if way else self.random.choice([2, 2, 3] if self.theme == "guards" else [1, 1, 1, 2, 2, 3])
        weighted = bool(way) and self.chance(0.5)
        what = tuple(self.invitation(self.later, self.random.randint(1, 3) if weighted else 1) for _ in range(count))
        return Carry(way, what, self.limit() if self.chance(0.4) else None)

    def limit(self) -> Extent:
        """The limit of a `do` statement."""
        return Extent(self.random.randint(0, 3)) if self.chance(0.5) else Extent(0, self.condition())

    def invitation(self, names: list[str], weight: int = 1) -> Invitation:
        """A behavior or scenario with an argument."""
        return Invitation(self.random.choice(names), self.pick("1", "2", "3", "now()", "Uniform(5, 6)" if self.chance(0.2) else "4"), weight)

    # What stands in setup blocks

    def declaration(self) -> Declaration:
        """A condition over time."""
        kind = self.pick("require always", "require eventually", "terminate when")
        return Declaration(kind, self.likely() if kind == "require always" else self.condition())

    def replacement(self) -> Overriding:
        """`override`."""
        if self.chance(0.5):
            return Overriding(self.thing(), self.number())
        return Overriding(self.thing(), "", self.invitation(self.behaviors))

    def watchman(self) -> Watchman:
        """A monitor."""
        before, self.kind = self.kind, "monitor"
        self.made += 1
        if self.theme == "scenarios" and self.chance(0.7):
            lines = [LetStepPass() if self.chance(0.5) else Assign("ego.x", self.number()) for _ in range(self.random.randint(1, 4))]
            self.kind = before
            return Watchman(f"Watch{self.made}", (Assign("y", "0"), *lines, Leave("terminate") if self.chance(0.6) else LetStepPass()))
        end = (Leave("terminate"),) if self.chance(0.3) else ()
        body = (Assign("y", "0"), *self.block(1), Repeat(0, "True", (LetStepPass(), *self.block(2, True)))) if self.chance(0.6) else self.block(0)
        found = Watchman(f"Watch{self.made}", (Assign("y", "0"), *body, *end))
        self.kind = before
        return found

    def creation(self, name: str, place: str) -> Creation:
        """An object, most often with a behavior."""
        x = "Uniform(0, 1)" if self.chance(0.2) else self.pick("0", "0", "1")
        behavior = Invitation(self.random.choice(self.behaviors[:2]), self.pick("1", "2", "Uniform(1, 2)" if self.chance(0.2) else "3"))
        return Creation(name, place, x, behavior if self.chance(0.85) else None)

    def setup(self) -> Line:
        """The setup block of a scenario that others run."""
        self.kind = "setup"
        found: list[Statement] = [Assign("y", self.pick("0", "1", "n"))]
        for _ in range(self.random.randint(1, 3) if self.theme == "scenarios" else self.random.randint(0, 2)):
            self.made += 1
            place = f"{10 * (self.made % 3 + 1)} + 2 * now()" if self.chance(0.85) else "Uniform(10, 40)"
            options = [self.replacement(), self.creation(f"made{self.made}", place), self.declaration(), self.watchman()]
            options += [Demand(self.likely()), Assign("ego.x", self.pick("0", "1", "n"))]
            found.append(self.random.choices(options, [5, 4, 2, 3, 1, 1])[0])
        return tuple(found)

    # Programs

    def procedure(self, name: str, later: list[str]) -> Procedure:
        """A behavior; those that agents begin with have few guards."""
        self.kind, self.later = "behavior", later
        often = 2 if self.theme == "guards" else 1
        guards = (0.2 * often, 0.4 * often) if name in BEHAVIORS[2:] else (0, 0.1)
        preconditions, invariants = (tuple(self.guard().replace("y <", "n <") for _ in range(self.chance(share))) for share in guards)
        first = (self.step(),) if self.chance(0.5) else ()
        body = self.block() if name in BEHAVIORS[:2] or self.chance(0.6 / often) else self.short()
        if name in BEHAVIORS[:2] and self.theme == "scenarios" and self.chance(0.8):
            body = (Repeat(0, "True", (TakeActions((self.pick("self.x", "y", "n + 10"),)), Assign("y", "y + 1"))),)
        elif name in BEHAVIORS[:2] and self.theme != "any" and self.chance(0.7):
            body = (self.attempt(1, False), *body)
        return Procedure(name, preconditions, invariants, (Assign("y", "0"), *first, *body))

    def short(self) -> Line:
        """What leads to an end soon: by `terminate`, or a guard that may be violated by now."""
        change = Assign(f"{self.thing()}.x", self.number())
        return self.random.choice([(Leave("terminate"),), (change, self.step(), self.step()), (self.step(), change, self.step()), (change,)])

    def module(self, name: str, later: list[str]) -> ModularScenario:
        """A scenario that Main, or one before it, runs."""
        setup = self.setup()
        self.kind, self.later = "compose", later
        preconditions = tuple(self.guard().replace("y <", "n <") for _ in range(self.chance(0.25)))
        invariants = tuple(self.guard() for _ in range(self.chance(0.25)))
        steps = (LetStepPass(),) * (self.random.randint(0, 2) if self.theme == "scenarios" else 0)
        return ModularScenario(name, preconditions, invariants, setup, (*steps, *self.block()) if self.chance(0.7) else None)

    def main(self, later: list[str]) -> ModularScenario:
        """The scenario to begin with."""
        self.kind, self.later = "compose", later
        setup = (Assign("n", "1"), Assign("y", "0"), *self.declarations())
        self.kind = "compose"
        first = () if self.theme == "scenarios" else self.block()
        preconditions = ("drawn < 1",) if self.chance(0.1) else ()
        invariants = tuple(self.likely() for _ in range(self.chance(0.15)))
        return ModularScenario("Main", preconditions, invariants, setup, (*first, self.carry(), *self.block()) if self.chance(0.9) else None)

    def declarations(self) -> list[Statement]:
        """What the first scenario requires, and its monitors."""
        self.kind = "setup"
        found: list[Statement] = [self.declaration() for _ in range(self.random.choice([0, 0, 1, 2]))]
        return found + [self.watchman() for _ in range(self.random.choice([0, 0, 1, 2]))]

    def program(self) -> DynamicProgram:
        """A whole program."""
        self.behaviors = names = BEHAVIORS[: self.random.randint(3, 5)]
        if self.chance(0.5):
            self.things = ["ego", "other"]
        top: list[Statement] = [Assign("drawn", "Uniform(0, 1)" if self.chance(0.15) else "0"), Assign("n", "1"), Assign("y", "0")]
        top += [self.creation(name, str(5 * k)) for k, name in enumerate(self.things)]
        behaviors = tuple(self.procedure(name, names[k + 1 :]) for k, name in enumerate(names))
        if self.theme != "scenarios" and self.chance(0.6):
            return DynamicProgram(behaviors, (), (*top, *self.declarations()))
        parts = [f"S{k}" for k in range(self.random.randint(1, 3))]
        modules = tuple(self.module(name, parts[k + 1 :]) for k, name in enumerate(parts))
        return DynamicProgram(behaviors, (self.main(parts), *modules), tuple(top))


def invented(seed: int, number: int, most: int = 60) -> DynamicProgram:
    """Program `number` of a seed: the first that this gives with at most `most` runs."""
    for attempt in range(100):
        program = Inventor(f"{seed}/{number}/{attempt}").program()
        try:
            law_of(program, STEPS, most=most)
        except TooManyRuns:
            continue
        return program
    raise AssertionError("no program has so few runs")
