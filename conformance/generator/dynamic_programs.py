"""Random dynamic programs with finite draws: behaviors, interrupts, guards, monitors and scenarios, for the simulator in which nothing moves.

A program is a function of (seed, number). It has one or two agents, whose actions show what was drawn, in which order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ...interpreter.runtime.random_streams import fold, mix

STEPS = 3
"""Time steps for which the programs are made: within these, they have few runs."""
MOST_STATEMENTS, MOST_DEPTH = 3, 2


class ProgramWriter:
    """The text of a program, from a random generator: how many statements its blocks have at most, and how deep they are."""

    def __init__(self, random: np.random.Generator, most_statements: int = MOST_STATEMENTS, most_depth: int = MOST_DEPTH) -> None:
        self.random, self.most_statements, self.most_depth = random, most_statements, most_depth
        self.guarded = False

    def pick(self, *options: str) -> str:
        """One of some texts."""
        return options[int(self.random.integers(len(options)))]

    def value(self) -> str:
        """A value to take: drawn, or not."""
        return self.pick("1", "2", "self.x", "Uniform(1, 2)", "Discrete({3: 1, 4: 2})", "now()")

    def condition(self) -> str:
        """A condition that may depend on the time, on a property, or on a draw."""
        return self.pick("now() == 1", "now() >= 1", "self.x == 1", "self.x < 2", "Uniform(0, 1, 1) == 1", "not (now() == 2)")

    def block(self, depth: int, interruptible: bool = False) -> list[str]:
        """Some statements of a behavior."""
        return [line for _ in range(int(self.random.integers(1, self.most_statements + 1))) for line in self.statement(depth, interruptible)]

    def statement(self, depth: int, interruptible: bool) -> list[str]:
        """A statement: simple ones, and deeper ones while there is room."""
        simple: list[Callable[[], list[str]]] = [
            lambda: [f"take {self.value()}"], lambda: [f"take {self.value()}"], lambda: ["wait"], lambda: ["self.x = self.x + 1"],
            lambda: [f"require self.x < {self.pick('2', '3')}"], lambda: ["do Sub()"], lambda: [f"do Sub({self.pick('5', '6')}) for 1 steps"],
            lambda: ["do choose {Sub(7): 1, Sub(8): 2}"],
            lambda: ["y = Uniform(1, 2)", "take y, resample(y)"],
        ]  # fmt: skip
        if self.guarded:
            simple.append(lambda: ["do Guarded()"])
        if interruptible:
            simple.append(lambda: ["abort"])
        if self.random.random() < 0.07:
            return ["terminate"]
        if depth >= self.most_depth or self.random.random() < 0.6:
            return simple[int(self.random.integers(len(simple)))]()
        return self.compound(depth + 1)

    def compound(self, depth: int) -> list[str]:
        """A statement with statements inside."""
        kind = int(self.random.integers(4))
        if kind == 0:
            return [f"if {self.condition()}:", *indent_lines(self.block(depth)), "else:", *indent_lines(self.block(depth))]
        if kind == 1:
            return [f"for i{depth} in range(2):", *indent_lines(self.block(depth))]
        lines = ["try:", *indent_lines([*self.block(depth, interruptible=True)])]
        for _ in range(int(self.random.integers(1, 3))):
            lines += [f"interrupt when {self.condition()}:", *indent_lines(self.block(depth, interruptible=True))]
        if kind == 3:
            lines += ["except GuardViolation:", *indent_lines([f"take {self.pick('20', '21')}"])]
        return lines

    def program(self) -> str:
        """Return the text of a whole program."""
        lines = ["def now():", "    return simulation.currentTime"]
        lines += [
            "behavior Sub(n=4):", *indent_lines([self.pick("take n", "take n, self.x", "wait"), self.pick("take n + 10", "self.x = 1", "wait")])
        ]
        lines += ["behavior Guarded():", f"    {self.pick('precondition', 'invariant')}: self.x < {self.pick('1', '2')}"]
        lines += indent_lines(self.block(MOST_DEPTH))
        self.guarded = True
        agents = int(self.random.integers(1, 3))
        for k in range(agents):
            lines += [f"behavior B{k}():", *indent_lines(self.block(0))]
        if self.random.random() < 0.4:
            watch = self.pick("require ego.x < 3", "wait", "ego.x = 0")
            body = ["if ego.x > 1:", f"    {self.pick('terminate', 'wait')}", watch, "wait"]
            lines += ["monitor Watch:", "    while True:", *indent_lines(indent_lines(body))]
        objects = [f"Object at ({5 * k}, 0), with x {self.pick('0', 'Uniform(0, 1)')}, with behavior B{k}" for k in range(agents)]
        setup = [f"ego = {objects[0]}", *objects[1:]]
        setup += [s for s, share in (
            (f"require always ego.x < {self.pick('2', '3')}", 0.3), (f"require eventually ego.x == {self.pick('0', '1')}", 0.2),
            (f"terminate when now() == {self.pick('1', '2')}", 0.3), ("terminate when ego.x == 2", 0.2),
        ) if self.random.random() < share]  # fmt: skip
        if self.random.random() < 0.4:
            return "\n".join([*lines, *self.scenarios(setup)]) + "\n"
        return "\n".join([*lines, *setup]) + "\n"

    def scenarios(self, setup: list[str]) -> list[str]:
        """The objects in a scenario Main, which runs others."""
        lines = ["scenario Part(n=1):", f"    precondition: ego.x < {self.pick('1', '2')}", "    setup:"]
        setup_of_part = [f"override ego with x {self.pick('1', 'Uniform(0, 1)')}" if self.random.random() < 0.5 else "y = n"]
        if self.random.random() < 0.4:
            setup_of_part += [f"made = Object at ({self.pick('0', 'n')}, 9), with made {self.pick('n', 'Uniform(1, 2)')}, with allowCollisions True"]
            setup_of_part += [self.pick("pass", "made.position = (n, 12)", "made.heading = 1")]
        lines += indent_lines(indent_lines(setup_of_part))
        lines += ["    compose:", *indent_lines(indent_lines([self.pick("wait", "ego.x = ego.x + n\nwait").replace("\n", "\n        "), "wait"]))]
        choices = "do choose {Part(): 1, Part(2): 1}", "do Part(), Part(2)", "do shuffle Part(), Part(2)"
        compose = self.pick("do Part()", "do Part() for 1 steps", *choices)
        after = self.pick("wait", "terminate", "do Part() until ego.x == 1")
        body = indent_lines(indent_lines([compose, after, "wait"]))
        if self.random.random() < 0.25:  # ego is made by what Main runs
            lines += ["scenario Begin():", "    setup:", *indent_lines(indent_lines(setup)), "    compose:", f"        {self.pick('wait', 'pass')}"]
            return [*lines, "scenario Main():", "    compose:", "        do Begin()", *body]
        guards = [g for g, share in (
            (f"precondition: drawn < {self.pick('1', '2')}", 0.3),
            (f"invariant: ego.x < {self.pick('3', '4')} and now() < {self.pick('3', '4')}", 0.2),
        ) if self.random.random() < share]  # fmt: skip
        lines += ["drawn = Uniform(0, 1)", "scenario Main():", *indent_lines(guards), "    setup:", *indent_lines(indent_lines(setup))]
        return [*lines, "    compose:", *body]


def indent_lines(lines: list[str]) -> list[str]:
    """The lines, four spaces to the right."""
    return [f"    {line}" for line in lines]


def dynamic_program(seed: int, number: int, most_statements: int = MOST_STATEMENTS, most_depth: int = MOST_DEPTH) -> str:
    """Program `number` of `seed`: its text."""
    return ProgramWriter(np.random.default_rng([fold(seed), mix(number)]), most_statements, most_depth).program()


def dynamic_programs(count: int, seed: int) -> Iterator[str]:
    """The first programs of a seed."""
    return (dynamic_program(seed, number) for number in range(count))


__all__ = ["STEPS", "dynamic_program", "dynamic_programs"]
